// A body in its frame: drawing, turning, moving, and the values at a point.

/** A value, kept between two limits. */
function clamped(value, low, high) {
  return Math.max(low, Math.min(value, high));
}

function dot(one, other) {
  return one.reduce((sum, part, k) => sum + part * other[k], 0);
}

/** The shape that all views of a page share, from the packed body. */
function shapeOf(body) {
  const flat = body.dimension < 3,
    width = flat ? 2 : 3,
    count = body.nodes.length;
  const places = new Float32Array(3 * count);
  for (let i = 0; i < count; i++) for (let k = 0; k < width; k++) places[3 * i + k] = body.places[width * i + k];
  const { dimension, nodes, regions, surface, solids, singular, region_of: regionOf } = body,
    cut = body.cells.map(cells => cutCells(cells, count)),
    faces = joined(Uint32Array, cut.map(part => part.faces)),
    edges = joined(Float64Array, cut.map(part => part.edges));
  const own = { dimension, nodes, regions, surface, solids, singular, regionOf };
  return { flat, count, places, faces, ...own, ...linesOf(edges, count), ...boxOf(places) };
}

/** One array from several. */
function joined(Type, parts) {
  const whole = new Type(parts.reduce((length, part) => length + part.length, 0));
  parts.reduce((place, part) => {
    whole.set(part, place);
    return place + part.length;
  }, 0);
  return whole;
}

/** Triangles, and the key of every edge of every cell. */
function cutCells({ vertices, corners, mids }, count) {
  const each = corners + mids.length,
    number = vertices.length / each;
  // The vertices around a cell, and those of its triangles: around each corner between two middles, and inside.
  const isBetween = (pair, a, b) => pair.includes(a) && pair.includes(b),
    middle = k => corners + mids.findIndex(pair => isBetween(pair, k, (k + 1) % corners));
  const all = Array.from({ length: corners }, (_, k) => k),
    ring = mids.length ? all.flatMap(k => [k, middle(k)]) : all,
    inside = mids.length ? all.map(middle) : all;
  const outer = mids.length ? all.flatMap(k => [middle((k + corners - 1) % corners), k, middle(k)]) : [],
    triangles = [...outer, ...inside.slice(2).flatMap((vertex, k) => [inside[0], inside[k + 1], vertex])];
  const faces = new Uint32Array(triangles.length * number),
    edges = new Float64Array(ring.length * number);
  for (let cell = 0; cell < number; cell++) {
    const vertex = k => vertices[each * cell + k];
    triangles.forEach((k, i) => {
      faces[triangles.length * cell + i] = vertex(k);
    });
    ring.forEach((k, i) => {
      const [a, b] = [vertex(k), vertex(ring[(i + 1) % ring.length])];
      edges[ring.length * cell + i] = Math.min(a, b) * count + Math.max(a, b);
    });
  }
  return { faces, edges };
}

/** The ends of each edge, once, and of each edge of one cell alone. */
function linesOf(edges, count) {
  edges.sort();
  const [lines, outline] = [[], []];
  for (let i = 0; i < edges.length; i++) {
    if (edges[i] === edges[i - 1]) continue;
    const low = Math.floor(edges[i] / count),
      ends = [low, edges[i] - low * count];
    lines.push(...ends);
    if (edges[i] !== edges[i + 1]) outline.push(...ends);
  }
  return { lines: Uint32Array.from(lines), outline: Uint32Array.from(outline) };
}

function boxOf(places) {
  const low = [Infinity, Infinity, Infinity],
    high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < places.length; i += 3) {
    for (let k = 0; k < 3; k++) {
      const value = places[i + k];
      if (value < low[k]) low[k] = value;
      if (value > high[k]) high[k] = value;
    }
  }
  return { low, high, size: Math.hypot(...high.map((value, k) => value - low[k])) };
}

class View {
  /** All views of the page. */
  static all = [];

  /** A view in `host`, of a shape; `paint(view, brush)` draws over it everything that is not a surface. */
  constructor(host, shape, { table, label, paint, asked }) {
    Object.assign(this, {
      host,
      shape,
      paint,
      asked,
      magnification: 1,
      coloured: false,
      range: [0, 1],
      mesh: true,
      markSize: 9,
      patches: [],
      obstacles: true,
      hidden: new Set(),
      cut: null,
      rest: false,
    });
    this.under = element("canvas", host);
    try {
      if (location.hash === "#painter") throw new Error("asked for");
      this.surface = new Surface(this.under, table);
    } catch {
      this.under.remove();
      this.under = element("canvas", host);
      this.surface = new Painter(this.under, table);
    }
    this.over = element("canvas", host, null, "top");
    this.over.tabIndex = 0;
    this.over.setAttribute("role", "img");
    this.over.setAttribute("aria-label", label);
    this.tip = tipIn(host);
    this.moved = new Float32Array(3 * shape.count);
    const { places, faces, lines, outline } = shape;
    this.surface.set("body", { places, moved: this.moved, order: faces });
    this.surface.set("mesh", { places, moved: this.moved, order: lines });
    // The undeformed body: in space a surface has no outline, and all its lines are drawn.
    this.surface.set("rest", { places, order: outline.length ? outline : lines });
    this.window = [shape.low, shape.high];
    this.home();
    this.listen();
    new ResizeObserver(() => this.redraw()).observe(host);
    View.all.push(this);
  }

  /** Displacements (three a vertex) and values (one a vertex) of the state shown. */
  state(moved, values) {
    Object.assign(this, { moved, values });
    this.surface.set("body", { moved, values });
    this.surface.set("mesh", { moved });
    this.section();
    this.redraw();
  }

  /** Shows or hides a body of several. */
  showRegion(region, on) {
    if (on) this.hidden.delete(region);
    else this.hidden.add(region);
    const kept = (order, each) => order.filter((_, i) => !this.hides(order[i - (i % each)]));
    this.surface.set("body", { order: kept(this.shape.faces, 3) });
    this.surface.set("mesh", { order: kept(this.shape.lines, 2) });
  }

  hides(vertex) {
    return this.hidden.has(this.shape.regionOf[vertex]);
  }

  /** Fills the section of `cut`: { axis, at, side }, of which the part with side (x - at) <= 0 is shown. */
  section() {
    this.surface.set("cap", this.cut ? capOf(this) : { hidden: true });
  }

  /** Contact nodes: vertices and the kind of each mark. */
  setMarks(vertices, kinds) {
    const own = list => Float32Array.from(vertices.flatMap(i => [...list.subarray(3 * i, 3 * i + 3)])),
      [places, moved] = [own(this.shape.places), own(this.moved)];
    this.surface.set("marks", { places, moved, values: Float32Array.from(kinds), hidden: vertices.length === 0 });
    this.redraw();
  }

  home() {
    // In space, seen from the side of the contact, with the third coordinate upwards.
    this.axes = this.shape.flat
      ? [
          [1, 0, 0],
          [0, 1, 0],
          [0, 0, 1],
        ]
      : lookingFrom(this.shape.eye);
    this.zoom = 1;
    this.pan = [0, 0];
    this.redraw();
  }

  /** Units of the screen, in pixels of CSS, for one of the body, and where its middle lies. */
  measure() {
    const width = this.host.clientWidth || 1,
      height = this.host.clientHeight || 1,
      [low, high] = this.window;
    const middle = low.map((value, k) => (value + high[k]) / 2),
      extent = low.map((value, k) => high[k] - value);
    const [wide, tall] = this.axes.map(axis => dot(axis.map(Math.abs), extent) || this.shape.size / 10);
    return { width, height, middle, scale: 0.9 * this.zoom * Math.min(width / wide, height / tall) };
  }

  /** A point of the body in pixels of CSS from the upper left corner, and its depth. */
  place(point, at = this.measure()) {
    const away = point.map((value, k) => value - at.middle[k]),
      [right, up, near] = this.axes.map(axis => dot(axis, away));
    return [at.width / 2 + at.scale * (right + this.pan[0]), at.height / 2 - at.scale * (up + this.pan[1]), near];
  }

  vertex(vertex) {
    return [0, 1, 2].map(k => this.shape.places[3 * vertex + k] + this.magnification * this.moved[3 * vertex + k]);
  }

  /** A vector of a list that has as many components as the body. */
  vector(list, i) {
    const { dimension } = this.shape;
    return list.subarray(dimension * i, dimension * i + dimension);
  }

  camera() {
    const at = this.measure(),
      scales = [(2 * at.scale) / at.width, (2 * at.scale) / at.height, -0.2 / (this.shape.size || 1)];
    const rows = this.axes.map((axis, row) => axis.map(part => scales[row] * part)),
      offset = rows.map((row, k) => scales[k] * (this.pan[k] ?? 0) - dot(row, at.middle));
    const columns = [0, 1, 2].map(k => [...rows.map(row => row[k]), 0]);
    return {
      camera: Float32Array.from([...columns.flat(), ...offset, 1]),
      stretch: scales.map(scale => 1 / scale),
    };
  }

  redraw() {
    if (this.waiting) return;
    this.waiting = requestAnimationFrame(() => {
      this.waiting = 0;
      this.drawNow();
    });
  }

  drawNow() {
    const { clientWidth: width, clientHeight: height } = this.host,
      dense = Math.min(window.devicePixelRatio || 1, 3);
    if (!width || !height) return;
    for (const canvas of [this.under, this.over]) {
      const [w, h] = [Math.round(width * dense), Math.round(height * dense)];
      if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, { width: w, height: h });
    }
    const style = getComputedStyle(document.documentElement);
    this.ink = name => style.getPropertyValue(`--${name}`).trim();
    const of = name => channels(this.ink(name));
    const plane = [...UNCUT],
      isFlat = this.shape.flat;
    if (this.cut) [plane[this.cut.axis], plane[3]] = [this.cut.side, this.cut.side * this.cut.at];
    // Marks as large as their distances would hide the colours of a surface; in the plane they are on its edge.
    const [share, least] = isFlat ? [0.8, 5] : [0.35, 2.5];
    this.mark = Math.min(Math.max(share * (this.spacing ?? Infinity) * this.measure().scale, least), this.markSize);
    const { rest, magnification, range, mesh, ink } = this;
    this.surface.draw({
      ...this.camera(),
      plane,
      rest,
      magnification,
      range,
      mesh,
      ink,
      coloured: this.coloured ? 1 : 0,
      lit: isFlat ? 0 : 1,
      body: of("body"),
      meshColour: [...of("mesh"), isFlat ? 0.28 : 0.2],
      size: this.mark * dense,
      insides: INSIDES.map(of),
      rims: RIMS.map(of),
      patches: this.obstacles ? this.patches.map(patch => ({ ...patch, colour: [...of("solid"), 0.4] })) : [],
    });
    const brush = this.over.getContext("2d");
    brush.setTransform(dense, 0, 0, dense, 0, 0);
    brush.clearRect(0, 0, width, height);
    // Drawings of WebGL are not printed by themselves.
    const prints = document.documentElement.hasAttribute("data-print");
    this.under.style.visibility = prints ? "hidden" : "";
    if (prints) brush.drawImage(this.under, 0, 0, width, height);
    brush.font = "12px system-ui, sans-serif";
    brush.lineJoin = brush.lineCap = "round";
    this.paint(this, brush);
  }

  listen() {
    const { over, tip } = this,
      down = new Map(),
      hide = () => Object.assign(tip, { hidden: true });
    let apart = 0;
    over.addEventListener("pointerdown", event => {
      over.setPointerCapture(event.pointerId);
      down.set(event.pointerId, event);
      apart = 0;
    });
    over.addEventListener("pointermove", event => {
      const last = down.get(event.pointerId);
      if (!last) return this.ask(event.offsetX, event.offsetY);
      down.set(event.pointerId, event);
      const [dx, dy] = [event.offsetX - last.offsetX, event.offsetY - last.offsetY];
      if (down.size > 1) {
        const [a, b] = [...down.values()],
          now = Math.hypot(a.offsetX - b.offsetX, a.offsetY - b.offsetY);
        if (apart) this.closer(now / apart);
        apart = now;
        this.slide(dx / 2, dy / 2);
      } else if (this.shape.flat || event.shiftKey || event.buttons === 2) this.slide(dx, dy);
      else this.turn(dx, dy);
      hide();
    });
    const up = event => {
      down.delete(event.pointerId);
      apart = 0;
    };
    over.addEventListener("pointerup", event => {
      up(event);
      this.ask(event.offsetX, event.offsetY);
    });
    over.addEventListener("pointercancel", up);
    over.addEventListener("pointerleave", hide);
    over.addEventListener("contextmenu", event => event.preventDefault());
    // The wheel scrolls the page unless the view has the focus.
    over.addEventListener(
      "wheel",
      event => {
        if (document.activeElement !== over) return;
        event.preventDefault();
        this.closer(Math.exp(-event.deltaY / 500), event.offsetX, event.offsetY);
      },
      { passive: false },
    );
    over.addEventListener("dblclick", () => this.home());
    over.addEventListener("keydown", event => this.key(event));
  }

  key(event) {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (way && (this.shape.flat || event.shiftKey)) this.slide(30 * way[0], 30 * way[1]);
    else if (way) this.turn(30 * way[0], 30 * way[1]);
    else if (event.key === "+" || event.key === "=") this.closer(1.25);
    else if (event.key === "-") this.closer(0.8);
    else if (event.key === "0" || event.key === "Home") this.home();
    else return;
    event.preventDefault();
  }

  turn(dx, dy) {
    // About the third coordinate axis of the body, then about the horizontal one of the screen.
    const [sine, cosine] = [Math.sin(0.008 * dx), Math.cos(0.008 * dx)];
    this.axes = this.axes.map(([x, y, z]) => [cosine * x + sine * y, cosine * y - sine * x, z]);
    this.axes = turned(this.axes, 0, -0.008 * dy);
    this.redraw();
  }

  slide(dx, dy) {
    const { scale } = this.measure();
    this.pan = [this.pan[0] + dx / scale, this.pan[1] - dy / scale];
    this.redraw();
  }

  closer(factor, x, y) {
    const before = this.measure(),
      next = clamped(this.zoom * factor, 0.2, 500);
    const share = (1 - this.zoom / next) / before.scale;
    if (x !== undefined)
      this.pan = [this.pan[0] - share * (x - before.width / 2), this.pan[1] + share * (y - before.height / 2)];
    this.zoom = next;
    this.redraw();
  }

  /** Shows the values of the vertex at a position on the screen. */
  ask(x, y) {
    if (!this.asked) return;
    const at = this.measure();
    let [best, least] = [-1, Infinity];
    for (let vertex = 0; vertex < this.shape.surface; vertex++) {
      if (this.hides(vertex)) continue;
      const [px, py, near] = this.place(this.vertex(vertex), at),
        away = Math.hypot(px - x, py - y);
      if (away > 14) continue;
      const rank = away - (20 * near) / (this.shape.size || 1);
      if (rank < least) [best, least] = [vertex, rank];
    }
    this.tip.hidden = best < 0;
    if (best < 0) return;
    const [px, py] = this.place(this.vertex(best), at);
    tell(this.tip, this.asked(best), (width, height) => [
      clamped(px + 12, 4, at.width - width - 4),
      py + 14 + height > at.height ? Math.max(4, py - height - 10) : py + 14,
    ]);
  }
}

/** The polygons in which a plane cuts the tetrahedra of a body, with displacements and values. */
function capOf({ shape, moved, values, cut: { axis, at }, hidden }) {
  const { places, solids, regionOf } = shape,
    cap = { places: [], moved: [], values: [], order: [] },
    height = vertex => places[3 * vertex + axis] - at;
  const cut = (a, b) => {
    const share = height(a) / (height(a) - height(b));
    for (let k = 0; k < 3; k++) {
      cap.places.push(between(places[3 * a + k], places[3 * b + k], share));
      cap.moved.push(between(moved[3 * a + k], moved[3 * b + k], share));
    }
    return cap.values.push(between(values[a], values[b], share)) - 1;
  };
  for (let i = 0; i < solids.length; i += 4) {
    const corners = solids.subarray(i, i + 4),
      above = corners.filter(vertex => height(vertex) > 0),
      below = corners.filter(vertex => height(vertex) <= 0);
    if (above.length % 4 === 0 || hidden.has(regionOf[corners[0]])) continue;
    const [a, b, c, d] = ring(above, below).map(ends => cut(...ends));
    cap.order.push(a, b, c);
    if (d !== undefined) cap.order.push(a, c, d);
  }
  const made = Object.fromEntries(["places", "moved", "values"].map(name => [name, Float32Array.from(cap[name])]));
  return { ...made, order: Uint32Array.from(cap.order) };
}

/** The edges between the corners of a tetrahedron above and below a plane, in order around the section. */
function ring([a, b, c], [d, e, f]) {
  if (c !== undefined) return [a, b, c].map(above => [above, d]);
  if (b === undefined) return [d, e, f].map(below => [a, below]);
  return [
    [a, d],
    [a, e],
    [b, e],
    [b, d],
  ];
}

/** To the right, upwards and to the eye. */
function lookingFrom(eye) {
  const long = Math.hypot(...eye),
    [x, y, z] = eye.map(part => part / long),
    across = Math.hypot(x, y);
  return [
    [-y / across, x / across, 0],
    [(-x * z) / across, (-y * z) / across, across],
    [x, y, z],
  ];
}

/** Axes turned by an angle about one of their own. */
function turned(axes, about, angle) {
  const [sine, cosine] = [Math.sin(angle), Math.cos(angle)],
    [one, other] = [(about + 1) % 3, (about + 2) % 3];
  const result = [...axes];
  result[one] = axes[one].map((value, k) => cosine * value + sine * axes[other][k]);
  result[other] = axes[other].map((value, k) => cosine * value - sine * axes[one][k]);
  return result;
}
