// A view of answers with its controls: colours, magnification of the displacement, marks.

/** If there are more rows than this, only closed or undecided rows are marked, until the reader asks for all. */
const MOST_OPEN_MARKS = 3000;

/** If there are more marks than this, they are small. */
const MANY_MARKS = 300;

/** If the lines of a mesh have more ends than this, they would hide the colours: the mesh is left out until the reader asks for it. */
const MOST_LINES = 200000;

/** Displacement (three a vertex), stress and fields between two states. */
function mixed(data, shape, [lower, upper, share]) {
  const { dimension, count } = shape,
    moved = new Float32Array(3 * count);
  const a = lower.displacement,
    b = upper.displacement;
  for (let i = 0; i < count; i++) {
    for (let k = 0; k < dimension; k++)
      moved[3 * i + k] = a[dimension * i + k] * (1 - share) + b[dimension * i + k] * share;
  }
  const between = (a, b) => (share === 0 ? a : a.map((value, i) => value * (1 - share) + b[i] * share));
  const values = Object.entries(lower.values).map(([name, own]) => [name, between(own, upper.values[name])]);
  return { moved, stress: between(lower.stress, upper.stress), values: Object.fromEntries(values) };
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
    Object.assign(this, { host, data, shape, frames, resultants, ranges: {}, showsForces: false });
    this.quantities = quantitiesOf(data);
    this.quantity = shape.flat ? "sigma_2" : "von_mises";
    this.box = element("div", host, null, "view");
    this.view = new View(this.box, shape, {
      table: data.colours.field.map(channels),
      label,
      paint: (view, brush) => this.paint(view, brush),
      asked: vertex => this.described(vertex),
    });
    this.view.coloured = true;
    this.view.mesh = shape.lines.length < MOST_LINES;
    this.marksOpen = (data.rows?.count ?? 0) <= MOST_OPEN_MARKS;
    this.view.spacing = spacingOf(data.rows, shape);
    addPatches(this.view, data);
    this.bar = element("div", host, null, "bar");
    this.addLegend();
    this.addControls();
    this.fit();
  }

  /** The window holds body and moved body, and the near part of the obstacles. */
  fit() {
    const { low, high, size, flat } = this.shape,
      all = [...low, ...high].length && [[...low], [...high]];
    let largest = 0;
    for (const frame of this.frames) {
      const { moved } = mixed(this.data, this.shape, frame.states),
        at = new Float32Array(3 * this.shape.count);
      for (let i = 0; i < at.length; i++) {
        at[i] = this.shape.places[i] + moved[i];
        largest = Math.max(largest, Math.abs(moved[i]));
      }
      const box = boxOf(at);
      for (let k = 0; k < 3; k++) {
        all[0][k] = Math.min(all[0][k], box.low[k]);
        all[1][k] = Math.max(all[1][k], box.high[k]);
      }
    }
    if (flat)
      for (const { approach } of this.data.question.obstacles) {
        for (let k = 0; k < 2; k++) all[approach[k] < 0 ? 0 : 1][k] += 0.1 * size * approach[k];
      }
    this.view.window = all;
    const most = largest > 0 ? Number(((0.25 * size) / largest).toPrecision(2)) : 1;
    this.most = Math.max(2, most);
    this.scale.max = this.most;
    this.scale.step = "any";
    this.scale.value = 1;
  }

  range(quantity) {
    if (!this.ranges[quantity]) {
      const ranges = of =>
        this.frames.map(frame => {
          const values = valuesOf(of, this.shape, mixed(this.data, this.shape, frame.states), frame, this.data);
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
    const field = mixed(this.data, this.shape, frame.states);
    this.field = field;
    const [low, high] = this.range(this.quantity);
    Object.assign(this.view, {
      coloured: this.quantity !== "none",
      range: [low, high],
      magnification: Number(this.scale.value),
    });
    const values = valuesOf(this.quantity, this.shape, field, frame, this.data);
    this.view.state(field.moved, values);
    this.view.patches.forEach(patch => {
      patch.shift = this.shiftOf(patch.obstacle);
    });
    this.mark(frame);
    this.showBar(rangeOf(values), [low, high]);
  }

  /** The colours, their limits, which a reader may change, and what lies outside. */
  showBar([least, most], limits) {
    const { name, unit } = this.quantities[this.quantity],
      slack = 0.02 * (limits[1] - limits[0]),
      again = () => this.show(this.frame);
    this.bar.hidden = this.quantity === "none";
    this.bar.replaceChildren();
    const outside = [
      least < limits[0] - slack ? `; below the scale: down to ${shown(least, 4)}` : "",
      most > limits[1] + slack ? `; above the scale: up to ${shown(most, 4)}` : "",
    ];
    element("div", this.bar, `${name}${unit && ` [${unit}]`}${outside.join("")}`);
    element("div", this.bar, null, "ramp").style.background =
      `linear-gradient(to right, ${this.data.colours.field.join(", ")})`;
    const ends = element("div", this.bar, null, "ends");
    ["lowest", "highest"].forEach((end, k) => {
      const field = element("input", ends);
      Object.assign(field, { type: "number", step: "any", value: shown(limits[k], 4) });
      field.setAttribute("aria-label", `${end} value of the colours`);
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
    const mix = (a, b) => a * (1 - share) + b * share,
      by = mix(lower.shifts[obstacle], upper.shifts[obstacle]) - shift,
      more = this.view.magnification - 1;
    return approach.map((part, k) => part * by + more * mix(lower.carried[obstacle][k], upper.carried[obstacle][k]));
  }

  mark({ closed, proven }) {
    const { rows } = this.data,
      vertices = [],
      kinds = [];
    // A node may have an open row of another obstacle: the mark of the closed one is drawn over it.
    const all = Array.from({ length: rows?.count ?? 0 }, (_, row) => row);
    for (const row of [...all.filter(row => !closed[row]), ...all.filter(row => closed[row])]) {
      const kind = (closed[row] ? 1 : 0) + (proven && proven[row] === 0 ? 2 : 0);
      if ((kind === 0 && !this.marksOpen) || this.view.hides(rows.vertices[row])) continue;
      vertices.push(rows.vertices[row]);
      kinds.push(kind);
    }
    this.marks = [vertices, kinds];
    this.view.markSize = vertices.length > MANY_MARKS ? 5 : 9;
    if (!this.shape.flat) this.view.setMarks(vertices, kinds);
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
      dimension = shape.dimension;
    const place = [0, 1, 2].slice(0, dimension).map(k => shape.places[3 * vertex + k]),
      moved = [0, 1, 2].slice(0, dimension).map(k => field.moved[3 * vertex + k]);
    const lines = [
      `node ${shape.nodes[vertex]} at ${vectorShown(place, units.length, 4)}`,
      `u = ${vectorShown(moved, units.length, 4)}`,
    ];
    for (const { name, words, symbol, unit } of data.fields) {
      const value = field.values[name]?.[vertex] ?? FROM_STRESS[name](field.stress, components * vertex, components);
      lines.push(`${symbol || words} ${inUnit(value, unit, 4)}`);
    }
    for (let row = 0; row < (data.rows?.count ?? 0); row++) {
      if (shape.nodes[data.rows.vertices[row]] !== shape.nodes[vertex]) continue;
      const place = frame.rows.indexOf(row),
        proof = frame.proven ? ["undecided", "proven open", "proven closed"][frame.proven[row]] : null;
      lines.push(
        `row ${row}: ${frame.closed[row] ? "closed" : "open"}${proof ? `, ${proof}` : ""}, pressure ${inUnit(place < 0 ? 0 : frame.pressure[place], units.pressure, 8)}`,
      );
      if (frame.remaining) lines.push(`gap left ${inUnit(frame.remaining[row], units.length, 6)}`);
    }
    return lines.join("\n");
  }

  /** A plane across a coordinate axis, of which the part behind is shown. */
  addSection(host, again) {
    const { low, high, eye } = this.shape,
      line = element("label", host, "section ", "slider"),
      select = element("select", line),
      range = Object.assign(element("input", line), { type: "range", min: 0, max: 1, step: "any", value: 0.5 });
    ["none", "x", "y", "z"].forEach(name => element("option", select, name));
    range.setAttribute("aria-label", "position of the section");
    const output = element("output", line);
    const change = () => {
      const axis = select.selectedIndex - 1,
        at = axis < 0 ? 0 : low[axis] + range.valueAsNumber * (high[axis] - low[axis]);
      this.view.cut = axis < 0 ? null : { axis, at, side: Math.sign(eye[axis]) };
      output.textContent = axis < 0 ? "" : inUnit(at, this.data.units.length, 4);
      again();
    };
    [select, range].forEach(part => part.addEventListener("input", change));
  }

  addLegend() {
    const legend = element("div", this.host, null, "legend");
    const entry = (text, draw) => {
      const span = element("span", legend),
        mark = svg("svg", { viewBox: "0 0 20 20" }, span);
      draw(mark);
      span.append(text);
    };
    if (this.data.rows?.count) {
      entry("closed row", mark => svg("circle", { cx: 10, cy: 10, r: 7, fill: "var(--closed)" }, mark));
      entry("open row", mark =>
        svg("circle", { cx: 10, cy: 10, r: 6, fill: "var(--paper)", stroke: "var(--open)", "stroke-width": 2 }, mark),
      );
      if (this.data.contact?.proven?.includes(0)) {
        entry("closed, undecided by the proof", mark =>
          svg("path", { d: "M10 2 18 10 10 18 2 10Z", fill: "var(--undecided)" }, mark),
        );
        entry("open, undecided by the proof", mark =>
          svg(
            "path",
            { d: "M10 3 17 10 10 17 3 10Z", fill: "var(--paper)", stroke: "var(--undecided)", "stroke-width": 2 },
            mark,
          ),
        );
      }
    }
  }

  addControls() {
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
    this.select = select;
    const slider = element("label", controls, "displacement × ", "slider");
    this.scale = Object.assign(element("input", slider), { type: "range", min: 0, max: 2, value: 1 });
    this.scale.setAttribute("aria-label", "scale of the displacement");
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
      const box = Object.assign(element("input", element("label", controls, `${text} `)), {
        type: "checkbox",
        checked: value,
      });
      box.addEventListener("change", () => {
        change(box.checked);
        again();
      });
    };
    check("mesh", this.view.mesh, on => {
      this.view.mesh = on;
    });
    check("undeformed body", false, on => {
      this.view.rest = on;
    });
    if (this.shape.regions.length > 1)
      this.shape.regions.forEach((name, region) =>
        check(name || "first body", true, on => this.view.showRegion(region, on)),
      );
    if (!this.shape.flat) this.addSection(controls, again);
    if (this.data.question.obstacles.some(obstacle => !obstacle.is_body))
      check("obstacle", true, on => {
        this.view.obstacles = on;
      });
    if (this.data.rows?.count)
      check("open rows", this.marksOpen, on => {
        this.marksOpen = on;
      });
    if (this.resultants?.length)
      check("resultants", false, on => {
        this.showsForces = on;
      });
  }
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
