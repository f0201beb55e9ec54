// A view of answers with its controls: colours, magnification of the displacement, marks.

/** If there are more rows than this, only closed or undecided rows are marked, until the reader asks for all. */
const MOST_OPEN_MARKS = 3000;

/** If there are more marks than this, they are small. */
const MANY_MARKS = 300;

/** If the lines of a mesh have more ends than this, they would hide the colours: the mesh is left out until the reader asks for it. */
const MOST_LINES = 200000;

/** Displacement (three a vertex), stress and fields between two states. */
function mixed(shape, [lower, upper, share]) {
  const { dimension, count } = shape,
    moved = new Float32Array(3 * count);
  const [a, b] = [lower.displacement, upper.displacement];
  for (let i = 0; i < count; i++) {
    for (let k = 0; k < dimension; k++) moved[3 * i + k] = between(a[dimension * i + k], b[dimension * i + k], share);
  }
  const mix = (a, b) => (share === 0 ? a : a.map((value, i) => between(value, b[i], share)));
  const squares = (name, own) => mix(own, upper.roots[name]).map(root => root * root);
  const values = Object.entries(lower.roots).map(([name, own]) => [name, squares(name, own)]);
  return { moved, stress: mix(lower.stress, upper.stress), values: Object.fromEntries(values) };
}

/** The values by which a body is coloured, one a vertex. */
function valuesOf(quantity, shape, { moved, stress, values: fields }, frame, data) {
  if (fields[quantity]) return fields[quantity];
  const values = new Float32Array(shape.count);
  if (quantity === "pressure") {
    frame.rows.forEach((row, i) => {
      values[data.rows.vertices[row]] += frame.pressure[i];
    });
    if (shape.dimension === 1) for (let i = 0; i + 1 < values.length; i += 2) values[i + 1] = values[i];
  } else if (quantity === "displacement") {
    for (let i = 0; i < shape.count; i++) values[i] = Math.hypot(moved[3 * i], moved[3 * i + 1], moved[3 * i + 2]);
  } else if (quantity !== "none") {
    const components = stress.length / shape.count,
      value = FROM_STRESS[quantity];
    for (let i = 0; i < shape.count; i++) values[i] = value(stress, components * i, components);
  }
  return values;
}

/** The lowest and the highest value. */
function rangeOf(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values)
    if (Number.isFinite(value)) {
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
  return low <= high ? [low, high] : [0, 1];
}

class Panel {
  /** `frames` are some of those that will be shown: colours and magnification are the same for all. */
  constructor(host, data, shape, { label, frames, resultants }) {
    Object.assign(this, { host, data, shape, resultants, ranges: {}, showsForces: false });
    this.frames = evenly(frames, MOST_FRAMES);
    this.quantities = quantitiesOf(data);
    this.quantity = shape.flat ? "sigma_2" : "von_mises";
    this.box = element("div", host, null, "view");
    this.view = bodyView(this.box, data, shape, {
      label,
      paint: (view, brush) => this.paint(view, brush),
      asked: vertex => this.described(vertex),
    });
    this.view.coloured = true;
    this.marksOpen = (data.rows?.count ?? 0) <= MOST_OPEN_MARKS;
    this.view.spacing = spacingOf(data.rows, shape);
    this.bar = element("div", host, null, "bar");
    this.addLegend();
    this.addControls(this.fit());
  }

  /** The window holds body and moved body, and the near part of the obstacles. Returns the largest scale of the displacement. */
  fit() {
    const { shape, data } = this;
    const boxes = this.frames.map(({ states }) => {
      const { moved } = mixed(shape, states),
        ends = rangeOf(moved).map(Math.abs);
      return { ...boxOf(shape.places.map((place, i) => place + moved[i])), largest: Math.max(...ends) };
    });
    const outermost = (end, most) => [0, 1, 2].map(k => most(...[shape, ...boxes].map(box => box[end][k]))),
      whole = { low: outermost("low", Math.min), high: outermost("high", Math.max) },
      largest = Math.max(...boxes.map(box => box.largest));
    this.view.window = windowOf(shape, data.question.obstacles, whole);
    return Math.max(2, largest > 0 ? Number(((0.25 * shape.size) / largest).toPrecision(2)) : 1);
  }

  range(quantity) {
    if (!this.ranges[quantity]) {
      const ranges = of =>
        this.frames.map(frame => {
          const values = valuesOf(of, this.shape, mixed(this.shape, frame.states), frame, this.data);
          // The stress under a point load has no limit.
          const skips = this.data.fields.some(({ name }) => name === of);
          return rangeOf(skips ? values.filter((_, vertex) => !this.shape.singular[vertex]) : values);
        });
      const all = ranges(quantity),
        low = Math.min(...all.map(range => range[0])),
        high = Math.max(...all.map(range => range[1]));
      // A stress that is rounding beside the whole stress has one colour.
      const least = quantity === "sigma_2" ? 1e-9 * Math.max(...ranges("von_mises").map(range => range[1])) : 0;
      this.ranges[quantity] = high - low < least ? [low - least, high + least] : [low, high];
    }
    return this.ranges[quantity];
  }

  show(frame) {
    this.frame = frame;
    this.field = mixed(this.shape, frame.states);
    const range = this.range(this.quantity),
      values = valuesOf(this.quantity, this.shape, this.field, frame, this.data);
    Object.assign(this.view, { coloured: this.quantity !== "none", range, magnification: Number(this.scale.value) });
    this.view.state(this.field.moved, values);
    this.view.patches.forEach(patch => Object.assign(patch, { shift: this.shiftOf(patch.obstacle) }));
    this.mark(frame);
    this.showBar(rangeOf(values), range);
  }

  /** The colours, their limits, which a reader may change, and what lies outside. */
  showBar([least, most], limits) {
    const slack = 0.02 * (limits[1] - limits[0]),
      again = () => this.show(this.frame);
    this.bar.hidden = this.quantity === "none";
    this.bar.replaceChildren();
    const outside = [
      least < limits[0] - slack ? `; below the scale: down to ${shown(least, 4)}` : "",
      most > limits[1] + slack ? `; above the scale: up to ${shown(most, 4)}` : "",
    ];
    element("div", this.bar, `${titled(this.quantities[this.quantity])}${outside.join("")}`);
    element("div", this.bar, null, "ramp").style.background =
      `linear-gradient(to right, ${this.data.colours.field.join(", ")})`;
    const ends = element("div", this.bar, null, "ends");
    ["lowest", "highest"].forEach((end, k) => {
      const field = input(ends, "number", { step: "any", value: shown(limits[k], 4) }, `${end} value of the colours`);
      field.addEventListener("change", () => {
        const next = limits.with(k, field.valueAsNumber);
        if (next[0] < next[1]) this.ranges[this.quantity] = next;
        again();
      });
      if (k > 0) return;
      pressed(ends, "all values", () => {
        delete this.ranges[this.quantity];
        again();
      });
    });
  }

  /** Shift of an obstacle from its position in the question; it moves with its contact, which may be magnified. */
  shiftOf(obstacle) {
    const [lower, upper, share] = this.frame.states,
      { shift, approach } = this.data.question.obstacles[obstacle];
    const by = between(lower.shifts[obstacle], upper.shifts[obstacle], share) - shift,
      carried = lower.carried[obstacle].map((part, k) => between(part, upper.carried[obstacle][k], share));
    return approach.map((part, k) => part * by + (this.view.magnification - 1) * carried[k]);
  }

  mark({ closed, proven }) {
    const { rows } = this.data;
    const all = Array.from({ length: rows?.count ?? 0 }, (_, row) => ({
      vertex: rows.vertices[row],
      kind: (closed[row] ? 1 : 0) + (proven?.[row] === 0 ? 2 : 0),
    }));
    const seen = all.filter(({ vertex, kind }) => (kind > 0 || this.marksOpen) && !this.view.hides(vertex));
    // A node may have an open row of another obstacle: the mark of the closed one is drawn over it.
    seen.sort((a, b) => (a.kind % 2) - (b.kind % 2));
    this.marks = [seen.map(({ vertex }) => vertex), seen.map(({ kind }) => kind)];
    this.view.markSize = seen.length > MANY_MARKS ? 5 : 9;
    if (!this.shape.flat) this.view.setMarks(...this.marks);
  }

  paint(view, brush) {
    if (!this.frame) return;
    const { data, shape } = this,
      times = view.magnification;
    if (view.obstacles && shape.flat)
      data.question.obstacles.forEach((obstacle, index) => {
        if (obstacle.outline) paintOutline(view, brush, obstacle, this.shiftOf(index));
      });
    if (shape.flat && this.marks) paintMarks(view, brush, ...this.marks);
    if (this.showsForces)
      for (const resultant of this.resultants ?? []) {
        const from = paintForce(view, brush, resultant, view.ink("force"), 70);
        if (from) paintText(view, brush, resultant.of, from[0] + 6, from[1] - 4, view.ink("force"));
      }
    paintScale(view, brush, data.units.length);
    if (times !== 1) {
      const beside = view.patches.length || data.question.obstacles.some(({ outline }) => outline);
      const words = `displacement × ${shown(times, 3)}${beside ? "; obstacles are rigid and shift with the mean of their contact" : ""}`;
      paintText(view, brush, words, 10, 18, view.ink("soft"));
    }
  }

  described(vertex) {
    const { shape, data, field, frame } = this,
      { units } = data,
      components = field.stress.length / shape.count,
      vector = values => vectorShown([...values.subarray(3 * vertex, 3 * vertex + shape.dimension)], units.length, 4);
    const lines = [`node ${shape.nodes[vertex]} at ${vector(shape.places)}`, `u = ${vector(field.moved)}`];
    for (const { name, words, symbol, unit } of data.fields) {
      const value = field.values[name]?.[vertex] ?? FROM_STRESS[name](field.stress, components * vertex, components);
      lines.push(`${symbol || words} ${inUnit(value, unit, 4)}`);
    }
    for (let row = 0; row < (data.rows?.count ?? 0); row++) {
      if (shape.nodes[data.rows.vertices[row]] !== shape.nodes[vertex]) continue;
      const place = frame.rows.indexOf(row),
        gap = data.rows.means?.[row] ? "mean gap" : "gap",
        of = gap === "gap" ? "" : `${gap} `,
        proof = frame.proven ? of + ["undecided", "proven open", "proven closed"][frame.proven[row]] : null;
      lines.push(
        `row ${row}: ${frame.closed[row] ? "closed" : "open"}${proof ? `, ${proof}` : ""}, pressure ${inUnit(place < 0 ? 0 : frame.pressure[place], units.pressure, 8)}`,
      );
      if (frame.remaining) lines.push(`${gap} left ${inUnit(frame.remaining[row], units.length, 6)}`);
    }
    return lines.join("\n");
  }

  /** A plane across a coordinate axis, of which the part behind is shown. */
  addSection(host, again) {
    const { low, high, eye } = this.shape,
      line = element("label", host, "section ", "slider"),
      select = element("select", line),
      range = input(line, "range", { min: 0, max: 1, step: "any", value: 0.5 }, "position of the section"),
      output = element("output", line);
    ["none", "x", "y", "z"].forEach(name => element("option", select, name));
    const change = () => {
      const axis = select.selectedIndex - 1,
        at = between(low[axis], high[axis], range.valueAsNumber);
      this.view.cut = axis < 0 ? null : { axis, at, side: Math.sign(eye[axis]) };
      output.textContent = axis < 0 ? "" : inUnit(at, this.data.units.length, 4);
      again();
    };
    [select, range].forEach(part => part.addEventListener("input", change));
  }

  addLegend() {
    const { rows, contact } = this.data,
      rim = name => ({ fill: "var(--paper)", stroke: `var(--${name})`, "stroke-width": 2 });
    const entries = [
      ["closed row", ["circle", { cx: 10, cy: 10, r: 7, fill: "var(--closed)" }]],
      ["open row", ["circle", { cx: 10, cy: 10, r: 6, ...rim("open") }]],
      ["closed, undecided by the proof", ["path", { d: "M10 2 18 10 10 18 2 10Z", fill: "var(--undecided)" }]],
      ["open, undecided by the proof", ["path", { d: "M10 3 17 10 10 17 3 10Z", ...rim("undecided") }]],
    ];
    const count = contact?.proven?.includes(0) ? 4 : 2;
    legendOf(this.host, rows?.count ? entries.slice(0, count) : []);
  }

  addControls(most) {
    const controls = element("div", this.host, null, "controls"),
      again = () => this.frame && this.show(this.frame);
    const colour = element("label", controls, "colours "),
      select = element("select", colour);
    for (const [name, about] of Object.entries(this.quantities)) {
      if (name !== "pressure" || this.data.rows?.count)
        Object.assign(element("option", select, about.name), { value: name });
    }
    select.value = this.quantity;
    select.addEventListener("change", () => {
      this.quantity = select.value;
      again();
    });
    const slider = element("label", controls, "displacement × ", "slider");
    this.scale = input(slider, "range", { min: 0, max: most, step: "any", value: 1 }, "scale of the displacement");
    const output = element("output", slider, "1");
    const moved = () => {
      output.textContent = shown(Number(this.scale.value), 3);
      again();
    };
    this.scale.addEventListener("input", moved);
    pressed(slider, "as it is", () => {
      this.scale.value = 1;
      moved();
    });
    const check = (text, value, change) => {
      const box = input(element("label", controls, `${text} `), "checkbox", { checked: value });
      box.addEventListener("change", () => {
        change(box.checked);
        again();
      });
    };
    const toggle = (text, of, key) => check(text, of[key], on => Object.assign(of, { [key]: on }));
    const { view, data, shape } = this;
    toggle("mesh", view, "mesh");
    toggle("undeformed body", view, "rest");
    if (shape.regions.length > 1)
      shape.regions.forEach((name, region) => check(name || "first body", true, on => view.showRegion(region, on)));
    if (!shape.flat) this.addSection(controls, again);
    if (data.question.obstacles.some(obstacle => !obstacle.is_body)) toggle("obstacle", view, "obstacles");
    if (data.rows?.count) toggle("open rows", this, "marksOpen");
    if (this.resultants?.length) toggle("resultants", this, "showsForces");
  }
}

/** A view of the body of a page in a box, with the obstacles in space. */
function bodyView(box, data, shape, settings) {
  const view = new View(box, shape, { table: data.colours.field.map(channels), ...settings });
  view.mesh = shape.lines.length < MOST_LINES;
  addPatches(view, data);
  return view;
}

/** The corners of a window on a box of a body; in the plane it holds the near part of the obstacles. */
function windowOf({ flat, size }, obstacles, { low, high }) {
  const corners = [[...low], [...high]];
  for (const { approach } of flat ? obstacles : [])
    for (let k = 0; k < 2; k++) corners[approach[k] < 0 ? 0 : 1][k] += 0.1 * size * approach[k];
  return corners;
}

/** The mean distance of neighbouring contact rows, from the extent of them all. */
function spacingOf(rows, { places, dimension }) {
  if (!rows?.count) return undefined;
  const ends = [0, 1, 2].map(k => rangeOf(Array.from(rows.vertices, vertex => places[3 * vertex + k])));
  const [long, wide] = ends.map(([low, high]) => high - low).sort((a, b) => b - a);
  const count = new Set(rows.vertices).size;
  return dimension === 3 ? Math.sqrt((long * wide) / count) : Math.hypot(long, wide) / count;
}

/** The obstacles in space, as parts of a view. */
function addPatches(view, data) {
  data.question.obstacles.forEach(({ patch }, obstacle) => {
    if (!patch) return;
    const order = [];
    for (let i = 0; i < patch.cells.length; i += 4) {
      const [a, b, c, d] = patch.cells.subarray(i, i + 4);
      order.push(a, b, c);
      if (c !== d) order.push(a, c, d);
    }
    const name = `obstacle ${obstacle}`;
    view.surface.set(name, { places: patch.places, order: new Uint32Array(order) });
    view.patches.push({ name, obstacle, shift: [0, 0, 0] });
  });
}
