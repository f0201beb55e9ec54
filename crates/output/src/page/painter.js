// The same picture without WebGL2: triangles painted from back to front, each in one colour.

/** If there are more triangles than this, only some are painted. */
const MOST_PAINTED = 60000;

class Painter {
  constructor(canvas, table) {
    Object.assign(this, { canvas, table, brush: canvas.getContext("2d"), parts: {} });
  }

  set(name, part) {
    this.parts[name] = { ...this.parts[name], hidden: false, ...part };
  }

  draw(look) {
    const { brush, canvas } = this;
    this.look = look;
    brush.clearRect(0, 0, canvas.width, canvas.height);
    this.faces("body", value => this.colour(value), look.plane);
    this.faces("cap", value => this.colour(value));
    if (look.mesh && !look.lit) this.lines("mesh");
    if (look.rest) this.lines("rest");
    for (const { name, colour, shift } of look.patches) this.faces(name, () => css(colour, colour[3]), UNCUT, shift);
    this.marks();
  }

  colour(value, { coloured, range, body } = this.look) {
    return css(coloured ? colourAt(this.table, (value - range[0]) / (range[1] - range[0])) : body);
  }

  /** The places of the vertices of a part in the picture, and their depths. */
  placed({ places, moved }, shift = [0, 0, 0]) {
    const { camera, magnification } = this.look,
      { width, height } = this.canvas,
      rows = [0, 1, 2].map(row => [0, 4, 8, 12].map(column => camera[column + row]));
    return Array.from({ length: places.length / 3 }, (_, i) => {
      const point = shift.map((by, k) => places[3 * i + k] + (moved ? magnification * moved[3 * i + k] : 0) + by),
        [x, y, depth] = rows.map(row => dot(point, row) + row[3]);
      return [((x + 1) / 2) * width, ((1 - y) / 2) * height, depth];
    });
  }

  faces(name, colour, plane = UNCUT, shift = [0, 0, 0]) {
    const part = this.parts[name];
    if (!part?.order || part.hidden) return;
    const at = this.placed(part, shift),
      { order, values, places } = part,
      count = order.length / 3;
    const depth = i => at[order[3 * i]][2] + at[order[3 * i + 1]][2] + at[order[3 * i + 2]][2],
      depths = Array.from({ length: count }, (_, i) => depth(i)),
      turns = [...depths.keys()];
    if (this.look.lit) turns.sort((a, b) => depths[b] - depths[a]);
    const { brush } = this;
    for (const turn of some(count, MOST_PAINTED)) {
      const corners = Array.from(order.subarray(3 * turns[turn], 3 * turns[turn] + 3)),
        triangle = corners.map(corner => at[corner]);
      if (corners.some(corner => beyond(places, corner, plane))) continue;
      const value = values ? corners.reduce((sum, corner) => sum + values[corner] / 3, 0) : 0;
      paintArea(brush, triangle, colour(value));
      if (name !== "body") continue;
      brush.strokeStyle = brush.fillStyle;
      brush.lineWidth = 1;
      brush.closePath();
      brush.stroke();
    }
  }

  lines(name) {
    const { order, ...part } = this.parts[name],
      at = this.placed(part),
      { brush } = this;
    brush.strokeStyle = css(this.look.meshColour, 0.35);
    brush.lineWidth = 1;
    brush.beginPath();
    for (let i = 0; i < order.length; i += 2) {
      const [[x, y], [toX, toY]] = [at[order[i]], at[order[i + 1]]];
      brush.moveTo(x, y);
      brush.lineTo(toX, toY);
    }
    brush.stroke();
  }

  marks() {
    const part = this.parts.marks,
      { plane, size, ink } = this.look;
    if (!part || part.hidden) return;
    this.placed(part).forEach((place, i) => {
      const kind = part.values[i];
      if (!beyond(part.places, i, plane)) paintMark(this.brush, place, kind, radiusOf(kind, size), ink, true);
    });
  }
}

/** Whether a vertex is on the side of a section that is cut away. */
function beyond(places, i, [x, y, z, at]) {
  return x * places[3 * i] + y * places[3 * i + 1] + z * places[3 * i + 2] > at;
}

function css([red, green, blue], opacity = 1) {
  return `rgba(${[red, green, blue].map(part => Math.round(255 * part)).join(", ")}, ${opacity})`;
}
