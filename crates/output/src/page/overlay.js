// Drawings over a body: obstacles in the plane, supports, loads, forces, gaps, a scale.

/** A path through places of the screen. */
function trace(brush, places) {
  brush.beginPath();
  for (const [x, y] of places) brush.lineTo(x, y);
}

function paintLine(brush, places, colour, width) {
  brush.strokeStyle = colour;
  brush.lineWidth = width;
  trace(brush, places);
  brush.stroke();
}

function paintArea(brush, places, colour) {
  brush.fillStyle = colour;
  trace(brush, places);
  brush.fill();
}

/** The direction from one place of the screen to another, and their distance. */
function wayTo([x, y], [toX, toY]) {
  const long = Math.hypot(toX - x, toY - y);
  return [[(toX - x) / (long || 1), (toY - y) / (long || 1)], long];
}

/** The place at a distance along a direction of the screen, and aside from it. */
function laid([x, y], [ux, uy], along, aside = 0) {
  return [x + along * ux - aside * uy, y + along * uy + aside * ux];
}

/** A point after a multiple of a vector, whose missing components are 0. */
function movedBy(point, vector, times = 1) {
  return point.map((value, k) => value + times * (vector[k] || 0));
}

/** The outline of an obstacle in the plane, filled on its own side. */
function paintOutline(view, brush, { outline, approach }, shift = []) {
  const at = view.measure(),
    points = Array.from({ length: outline.length / 2 }, (_, i) =>
      view.place(movedBy([outline[2 * i], outline[2 * i + 1], 0], shift), at),
    );
  const isClosed = points.length > 3 && wayTo(points[0], points.at(-1))[1] < 1e-6,
    far = 4 * (at.width + at.height),
    away = points.map(([x, y]) => [x + far * approach[0], y - far * approach[1]]);
  paintArea(brush, isClosed ? points : [...points, ...away.reverse()], css(channels(view.ink("solid")), 0.4));
  paintLine(brush, points, view.ink("edge"), 1.8);
}

/** An arrow from one place of the screen to another. */
function paintArrow(brush, from, to, colour, width) {
  const [way, long] = wayTo(from, to),
    head = Math.min(9, 0.6 * long);
  if (long < 2) return;
  paintLine(brush, [from, laid(to, way, -0.7 * head)], colour, width);
  paintArea(brush, [to, laid(to, way, -head, -0.4 * head), laid(to, way, -head, 0.4 * head)], colour);
}

/** A text with a halo of the colour of the paper, kept inside the view. */
function paintText(view, brush, text, x, y, colour) {
  const at = view.measure(),
    width = brush.measureText(text).width;
  const [left, base] = [clamped(x, 4, at.width - width - 4), clamped(y, 14, at.height - 6)];
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
function paintHolds(view, brush, { fixed, guided, springs, rigid }) {
  // In space the surface hides those behind it: squares are marks of the view there.
  if (view.shape.flat) {
    paintSquares(view, brush, rigid, RIGID, 2.4);
    paintSquares(view, brush, fixed, HELD, 3.2);
  }
  paintDirected(view, brush, guided, view.ink("held"), PLATE, 4000);
  // More springs would overlap.
  paintDirected(view, brush, springs, view.ink("spring"), SPRING, 40);
}

/** Places in pixels of a plate across a direction, and of a spring along it. */
const PLATE = { along: [0, 0], aside: [-6, 6] },
  SPRING = { along: [0, 3, 5, 8, 11, 14, 16, 19], aside: [0, 0, 4, -4, 4, -4, 0, 0] };

function paintSquares(view, brush, vertices, kind, size) {
  const at = view.measure();
  for (const i of some(vertices.length, 4000))
    paintMark(brush, view.place(view.vertex(vertices[i]), at), kind, size, view.ink, false);
}

/** The same line at each vertex, laid along its direction as the view sees it. */
function paintDirected(view, brush, { vertices, directions }, colour, line, most) {
  const at = view.measure();
  for (const i of some(vertices.length, most)) {
    const point = view.vertex(vertices[i]),
      place = view.place(point, at),
      [way] = wayTo(place, view.place(movedBy(point, view.vector(directions, i)), at));
    const places = line.along.map((along, k) => laid(place, way, along, line.aside[k]));
    paintLine(brush, places, colour, 2.4);
  }
}

/** Loads: an arrow at each loaded node of the boundary, or the resultant if the whole body is loaded. */
function paintLoads(view, brush, loads, resultant) {
  const { vertices, forces, inside } = loads,
    colour = view.ink("load");
  if (!vertices.length && !inside) return;
  if (inside || vertices.length >= 0.6 * view.shape.count) {
    paintForce(view, brush, resultant?.centre ? resultant : wholeLoad(view, loads), colour, 60);
    return;
  }
  const sizes = Array.from(vertices, (_, i) => Math.hypot(...view.vector(forces, i))),
    [, largest] = rangeOf(sizes);
  for (const i of some(vertices.length, 60)) {
    const load = { force: view.vector(forces, i), centre: view.vertex(vertices[i]) };
    paintForce(view, brush, load, colour, (38 * sizes[i]) / largest, 1.4);
  }
}

/** The arrow of a resultant, of this length in pixels; it ends at the centre. Returns where it begins. */
function paintForce(view, brush, { force, centre }, colour, pixels, width = 2.4) {
  const size = Math.hypot(...force);
  if (!(size > 0) || !centre) return null;
  const at = view.measure(),
    end = movedBy([0, 0, 0], centre),
    from = view.place(movedBy(end, force, -pixels / at.scale / size), at);
  paintArrow(brush, from, view.place(end, at), colour, width);
  return from;
}

/** A length on the screen and the directions of the axes. */
function paintScale(view, brush, unit) {
  const at = view.measure(),
    colour = view.ink("ink"),
    y = at.height - 12;
  const length = ticks(0, (0.3 * Math.min(at.width, 500)) / at.scale, 4).at(-1),
    right = 12 + length * at.scale,
    rises = [4, 0, 0, 4];
  const rule = [12, 12, right, right].map((x, i) => [x, y - rises[i]]);
  paintLine(brush, rule, colour, 1.5);
  paintText(view, brush, inUnit(length, unit), 16, y - 6, colour);
  const corner = [at.width - 44, at.height - 34];
  ["x", "y", "z"].slice(0, view.shape.flat ? 2 : 3).forEach((name, axis) => {
    const way = [26 * view.axes[0][axis], -26 * view.axes[1][axis]],
      [x, y] = movedBy(corner, way, 1.3);
    paintArrow(brush, corner, movedBy(corner, way), colour, 1.2);
    paintText(view, brush, name, x - 3, y + 4, colour);
  });
}

/** The smallest gap, from its node to the obstacle. */
function paintGap(view, brush, rows, unit) {
  const least = rows ? rows.gaps.indexOf(rangeOf(rows.gaps)[0]) : -1;
  if (least < 0) return;
  const gap = rows.gaps[least],
    point = view.vertex(rows.vertices[least]),
    colour = view.ink("closed");
  const ends = [point, movedBy(point, view.vector(rows.normals, least), gap)].map(end => view.place(end)),
    [[ax, ay], [bx, by]] = ends;
  paintLine(brush, ends, colour, 2);
  for (const end of ends) paintLine(brush, [movedBy(end, [-5, 0]), movedBy(end, [5, 0])], colour, 2);
  const below = Math.abs(ay - by) > 30 ? (ay + by) / 2 + 4 : Math.max(ay, by) + 18;
  paintText(view, brush, `smallest gap ${inUnit(gap, unit, 4)}`, Math.max(ax, bx) + 10, below, colour);
}

/** The sum of nodal forces of a body that is loaded everywhere, at its middle. */
function wholeLoad({ shape: { low, high, dimension } }, { vertices, forces }) {
  const force = Array.from({ length: dimension }, () => 0);
  for (let i = 0; i < dimension * vertices.length; i++) force[i % dimension] += forces[i];
  return { force, centre: low.map((value, k) => (value + high[k]) / 2) };
}

/** Contact rows in the plane, over the obstacle that they touch. The rims of close marks do not cover those of closed rows. */
function paintMarks(view, brush, vertices, kinds) {
  const at = view.measure(),
    places = vertices.map(vertex => view.place(view.vertex(vertex), at));
  const paint = (kind, i, hasRim) => paintMark(brush, places[i], kind, radiusOf(kind, view.mark), view.ink, hasRim);
  kinds.forEach((kind, i) => paint(kind, i, true));
  kinds.forEach((kind, i) => kind === CLOSED && paint(kind, i, false));
}

/** Half the width of a mark: open rows are smaller. */
function radiusOf(kind, size) {
  return (kind === CLOSED || kind === CLOSED_UNDECIDED ? 0.5 : 0.38) * size;
}

/** The corners of the mark of an undecided row, for a disc of radius 1. */
const DIAMOND = [
  [1.3, 0],
  [0, 1.3],
  [-1.3, 0],
  [0, -1.3],
];

/** A mark at a place of the screen: a square for a support or a rigid face, a diamond for an undecided row, else a disc. */
function paintMark(brush, [x, y], kind, size, ink, hasRim) {
  brush.strokeStyle = ink(RIMS[kind]);
  brush.fillStyle = ink(INSIDES[kind]);
  brush.lineWidth = 1.1;
  brush.beginPath();
  if (kind >= HELD) brush.rect(x - size, y - size, 2 * size, 2 * size);
  else if (kind >= UNDECIDED)
    trace(
      brush,
      DIAMOND.map(([right, down]) => [x + size * right, y + size * down]),
    );
  else brush.arc(x, y, size, 0, 7);
  brush.closePath();
  brush.fill();
  if (hasRim) brush.stroke();
}
