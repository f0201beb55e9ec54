// Drawings over a body: obstacles in the plane, supports, loads, forces, gaps, a scale.

/** The outline of an obstacle in the plane, filled on its own side. */
function paintOutline(view, brush, { outline, approach }, [x, y] = [0, 0]) {
  const at = view.measure(),
    points = [];
  for (let i = 0; i < outline.length; i += 2) points.push(view.place([outline[i] + x, outline[i + 1] + y, 0], at));
  const closed =
    points.length > 3 && Math.hypot(points[0][0] - points.at(-1)[0], points[0][1] - points.at(-1)[1]) < 1e-6;
  const far = 4 * (at.width + at.height),
    away = [far * approach[0], -far * approach[1]];
  const trace = list => list.forEach(([x, y], i) => (i ? brush.lineTo(x, y) : brush.moveTo(x, y)));
  brush.fillStyle = css(channels(view.ink("solid")), 0.4);
  brush.beginPath();
  trace(closed ? points : [...points, ...points.map(([x, y]) => [x + away[0], y + away[1]]).reverse()]);
  brush.closePath();
  brush.fill();
  brush.strokeStyle = view.ink("edge");
  brush.lineWidth = 1.8;
  brush.beginPath();
  trace(points);
  brush.stroke();
}

/** An arrow from one place of the screen to another. */
function paintArrow(brush, from, to, colour, width = 1.6) {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]],
    long = Math.hypot(dx, dy);
  if (long < 2) return;
  const head = Math.min(9, 0.6 * long),
    [ux, uy] = [dx / long, dy / long];
  brush.strokeStyle = brush.fillStyle = colour;
  brush.lineWidth = width;
  brush.beginPath();
  brush.moveTo(from[0], from[1]);
  brush.lineTo(to[0] - 0.7 * head * ux, to[1] - 0.7 * head * uy);
  brush.stroke();
  brush.beginPath();
  brush.moveTo(to[0], to[1]);
  brush.lineTo(to[0] - head * ux + 0.4 * head * uy, to[1] - head * uy - 0.4 * head * ux);
  brush.lineTo(to[0] - head * ux - 0.4 * head * uy, to[1] - head * uy + 0.4 * head * ux);
  brush.fill();
}

/** A text with a halo of the colour of the paper, kept inside the view. */
function paintText(view, brush, text, x, y, colour) {
  const at = view.measure(),
    width = brush.measureText(text).width;
  const [left, base] = [Math.max(4, Math.min(x, at.width - width - 4)), Math.max(14, Math.min(y, at.height - 6))];
  brush.lineWidth = 4;
  brush.strokeStyle = view.ink("paper");
  brush.strokeText(text, left, base);
  brush.fillStyle = colour;
  brush.fillText(text, left, base);
}

/** Evenly chosen entries, at most `most`. */
function some(count, most) {
  const every = Math.max(1, Math.ceil(count / most));
  return Array.from({ length: Math.ceil(count / every) }, (_, i) => i * every);
}

/** Supports: squares if all directions are held or a face is rigid, a plate across each other held direction, a zigzag along each spring. */
function paintHolds(view, brush, { fixed, guided, springs, rigid }, dimension) {
  // In space the surface hides those behind it: squares are marks of the view there.
  if (view.shape.flat) {
    paintSquares(view, brush, rigid, view.ink("rigid"), 2.4);
    paintSquares(view, brush, fixed, view.ink("held"), 3.2);
  }
  paintDirected(view, brush, guided, dimension, { colour: view.ink("held"), line: PLATE, most: 4000 });
  // More springs would overlap.
  paintDirected(view, brush, springs, dimension, { colour: view.ink("spring"), line: SPRING, most: 40 });
}

/** Points [along, aside] in pixels of a plate across a direction, and of a spring along it. */
const PLATE = [
  [0, -6],
  [0, 6],
];
const SPRING = [
  [0, 0],
  [3, 0],
  [5, 4],
  [8, -4],
  [11, 4],
  [14, -4],
  [16, 0],
  [19, 0],
];

function paintSquares(view, brush, vertices, colour, size) {
  const at = view.measure();
  brush.fillStyle = colour;
  for (const i of some(vertices.length, 4000)) {
    const [x, y] = view.place(view.vertex(vertices[i]), at);
    brush.fillRect(x - size, y - size, 2 * size, 2 * size);
  }
}

/** The same line at each vertex, laid along its direction as the view sees it. */
function paintDirected(view, brush, { vertices, directions }, dimension, { colour, line, most }) {
  const at = view.measure();
  brush.strokeStyle = colour;
  brush.lineWidth = 2.4;
  for (const i of some(vertices.length, most)) {
    const point = view.vertex(vertices[i]),
      [x, y] = view.place(point, at);
    const along = [0, 1, 2].map(k => (k < dimension ? directions[dimension * i + k] : 0));
    const [tx, ty] = view.place(
      point.map((value, k) => value + along[k]),
      at,
    );
    const long = Math.hypot(tx - x, ty - y) || 1,
      [ux, uy] = [(tx - x) / long, (ty - y) / long];
    brush.beginPath();
    line.forEach(([out, aside], k) =>
      brush[k ? "lineTo" : "moveTo"](x + out * ux - aside * uy, y + out * uy + aside * ux),
    );
    brush.stroke();
  }
}

/** Loads: an arrow at each loaded node of the boundary, or the resultant if the whole body is loaded. */
function paintLoads(view, brush, loads, resultant, dimension) {
  const { vertices, forces, inside } = loads,
    colour = view.ink("load"),
    at = view.measure();
  if (!vertices.length && !inside) return;
  const force = i => [0, 1, 2].map(k => (k < dimension ? forces[dimension * i + k] : 0));
  if (!inside && vertices.length < 0.6 * view.shape.count) {
    let largest = 0;
    for (let i = 0; i < vertices.length; i++) largest = Math.max(largest, Math.hypot(...force(i)));
    for (const i of some(vertices.length, 60)) {
      const f = force(i),
        point = view.vertex(vertices[i]),
        long = 38 / at.scale / largest;
      paintArrow(
        brush,
        view.place(
          point.map((value, k) => value - long * f[k]),
          at,
        ),
        view.place(point, at),
        colour,
        1.4,
      );
    }
  } else paintForce(view, brush, resultant?.centre ? resultant : wholeLoad(view, loads, dimension), colour, 60);
}

/** The arrow of a resultant, of this length in pixels; it ends at the centre. */
function paintForce(view, brush, { force, centre }, colour, pixels) {
  const full = values => [0, 1, 2].map(k => values[k] || 0),
    size = Math.hypot(...force);
  if (!(size > 0) || !centre) return null;
  const at = view.measure(),
    end = full(centre),
    long = pixels / at.scale / size;
  const from = view.place(
      end.map((value, k) => value - long * full(force)[k]),
      at,
    ),
    to = view.place(end, at);
  paintArrow(brush, from, to, colour, 2.4);
  return from;
}

/** A length on the screen and the directions of the axes. */
function paintScale(view, brush, unit) {
  const at = view.measure(),
    colour = view.ink("ink"),
    y = at.height - 12;
  const length = ticks(0, (0.3 * Math.min(at.width, 500)) / at.scale, 4).at(-1),
    wide = length * at.scale;
  brush.strokeStyle = colour;
  brush.lineWidth = 1.5;
  brush.beginPath();
  const rule = [
    [12, y - 4],
    [12, y],
    [12 + wide, y],
    [12 + wide, y - 4],
  ];
  rule.forEach(([x, v], i) => (i ? brush.lineTo(x, v) : brush.moveTo(x, v)));
  brush.stroke();
  paintText(view, brush, inUnit(length, unit), 16, y - 6, colour);
  const corner = [at.width - 44, at.height - 34];
  ["x", "y", "z"].slice(0, view.shape.flat ? 2 : 3).forEach((name, axis) => {
    const way = [view.axes[0][axis], -view.axes[1][axis]].map(part => 26 * part);
    paintArrow(brush, corner, [corner[0] + way[0], corner[1] + way[1]], colour, 1.2);
    paintText(view, brush, name, corner[0] + 1.3 * way[0] - 3, corner[1] + 1.3 * way[1] + 4, colour);
  });
}

/** The smallest gap, from its node to the obstacle. */
function paintGap(view, brush, rows, unit, dimension) {
  if (!rows || !rows.count) return;
  let least = 0;
  for (let row = 1; row < rows.count; row++) if (rows.gaps[row] < rows.gaps[least]) least = row;
  const gap = rows.gaps[least],
    point = view.vertex(rows.vertices[least]);
  if (!Number.isFinite(gap)) return;
  const foot = point.map((value, k) => value + (k < dimension ? gap * rows.normals[dimension * least + k] : 0));
  const [a, b] = [view.place(point), view.place(foot)],
    colour = view.ink("closed");
  brush.strokeStyle = colour;
  brush.lineWidth = 2;
  brush.beginPath();
  brush.moveTo(a[0], a[1]);
  brush.lineTo(b[0], b[1]);
  brush.stroke();
  for (const [x, y] of [a, b]) {
    brush.beginPath();
    brush.moveTo(x - 5, y);
    brush.lineTo(x + 5, y);
    brush.stroke();
  }
  paintText(
    view,
    brush,
    `smallest gap ${inUnit(gap, unit, 4)}`,
    Math.max(a[0], b[0]) + 10,
    Math.abs(a[1] - b[1]) > 30 ? (a[1] + b[1]) / 2 + 4 : Math.max(a[1], b[1]) + 18,
    colour,
  );
}

/** The sum of nodal forces of a body that is loaded everywhere, at its middle. */
function wholeLoad(view, { vertices, forces }, dimension) {
  const force = Array.from({ length: dimension }, () => 0);
  for (let i = 0; i < dimension * vertices.length; i++) force[i % dimension] += forces[i];
  return { force, centre: view.shape.low.map((value, k) => (value + view.shape.high[k]) / 2) };
}

/** Contact rows in the plane, over the obstacle that they touch. The rims of close marks do not cover those of closed rows. */
function paintMarks(view, brush, vertices, kinds) {
  const at = view.measure();
  const paint = (i, hasRim) => {
    const [x, y] = view.place(view.vertex(vertices[i]), at),
      closed = kinds[i] === 1 || kinds[i] === 3,
      undecided = kinds[i] >= 2,
      size = (closed ? 0.5 : 0.38) * view.mark;
    brush.fillStyle = closed ? view.ink(undecided ? "undecided" : "closed") : view.ink("paper");
    brush.strokeStyle = view.ink(undecided ? "undecided" : closed ? "paper" : "open");
    brush.lineWidth = 1.1;
    brush.beginPath();
    if (undecided)
      [0, 1, 2, 3].forEach(k => brush.lineTo(x + 1.3 * size * [1, 0, -1, 0][k], y + 1.3 * size * [0, 1, 0, -1][k]));
    else brush.arc(x, y, size, 0, 7);
    brush.closePath();
    brush.fill();
    if (hasRim) brush.stroke();
  };
  kinds.forEach((_, i) => paint(i, true));
  kinds.forEach((kind, i) => kind === 1 && paint(i, false));
}
