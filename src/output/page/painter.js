// The same picture without WebGL2: triangles painted from back to front, each in one colour.

/** If there are more triangles than this, only some are painted. */
const MOST_PAINTED = 60000;

class Painter {
  constructor(canvas, table) {
    this.canvas = canvas;
    this.brush = canvas.getContext("2d");
    this.table = table;
    this.parts = {};
  }

  set(name, part) {
    this.parts[name] = { ...this.parts[name], hidden: false, ...part };
  }

  draw(camera, look) {
    const { brush, canvas } = this;
    brush.clearRect(0, 0, canvas.width, canvas.height);
    this.faces("body", camera, look.magnification, [0, 0, 0], look, share => this.colour(share, look));
    this.faces("cap", camera, look.magnification, [0, 0, 0], { ...look, plane: null }, share => this.colour(share, look));
    if (look.mesh && !look.lit) this.lines("mesh", camera, look.magnification, look);
    if (look.rest) this.lines("rest", camera, 0, look);
    for (const { name, colour, shift } of look.patches)
      this.faces(name, camera, 0, shift, { ...look, plane: null }, () => css(colour, colour[3]));
    this.points(camera, look);
  }

  colour(share, { coloured, range, body }) {
    return css(coloured ? colourAt(this.table, (share - range[0]) / (range[1] - range[0])) : body);
  }

  placed(part, camera, magnification, shift) {
    const { places, moved } = part,
      count = places.length / 3,
      at = new Float32Array(3 * count);
    for (let i = 0; i < count; i++) {
      const p = [0, 1, 2].map(
        k => places[3 * i + k] + (moved && magnification ? magnification * moved[3 * i + k] : 0) + shift[k],
      );
      for (let k = 0; k < 3; k++)
        at[3 * i + k] = camera[k] * p[0] + camera[4 + k] * p[1] + camera[8 + k] * p[2] + camera[12 + k];
      at[3 * i] = ((at[3 * i] + 1) / 2) * this.canvas.width;
      at[3 * i + 1] = ((1 - at[3 * i + 1]) / 2) * this.canvas.height;
    }
    return at;
  }

  faces(name, camera, magnification, shift, look, colour) {
    const part = this.parts[name];
    if (!part || !part.order || part.hidden) return;
    const at = this.placed(part, camera, magnification, shift),
      { order, values } = part,
      count = order.length / 3;
    const depth = new Float32Array(count),
      turns = Array.from({ length: count }, (_, i) => i);
    for (let i = 0; i < count; i++)
      depth[i] = at[3 * order[3 * i] + 2] + at[3 * order[3 * i + 1] + 2] + at[3 * order[3 * i + 2] + 2];
    if (look.lit) turns.sort((a, b) => depth[b] - depth[a]);
    const every = Math.max(1, Math.ceil(count / MOST_PAINTED)),
      { brush } = this;
    for (let turn = 0; turn < count; turn += every) {
      const corners = [0, 1, 2].map(k => order[3 * turns[turn] + k]);
      if (look.plane && corners.some(c => beyond(part.places, c, look.plane))) continue;
      const share = values ? corners.reduce((sum, c) => sum + values[c] / 3, 0) : 0;
      brush.fillStyle = brush.strokeStyle = colour(share);
      brush.beginPath();
      corners.forEach((c, k) => (k ? brush.lineTo(at[3 * c], at[3 * c + 1]) : brush.moveTo(at[3 * c], at[3 * c + 1])));
      brush.closePath();
      brush.fill();
      if (name === "body") brush.stroke();
    }
  }

  lines(name, camera, magnification, look) {
    const part = this.parts[name];
    if (!part || !part.order) return;
    const at = this.placed(part, camera, magnification, [0, 0, 0]),
      { brush } = this;
    brush.strokeStyle = css(look.meshColour, 0.35);
    brush.beginPath();
    for (let i = 0; i < part.order.length; i += 2) {
      brush.moveTo(at[3 * part.order[i]], at[3 * part.order[i] + 1]);
      brush.lineTo(at[3 * part.order[i + 1]], at[3 * part.order[i + 1] + 1]);
    }
    brush.stroke();
  }

  points(camera, look) {
    const part = this.parts.marks;
    if (!part || part.hidden || !part.places) return;
    const at = this.placed(part, camera, look.magnification, [0, 0, 0]),
      { brush } = this,
      size = look.markSize;
    part.values.forEach((kind, i) => {
      if (beyond(part.places, i, look.plane)) return;
      const { closed, open, undecided, paper, held, rigid } = look.marks,
        solid = kind === 4 ? held : kind === 5 ? rigid : null,
        radius = (kind === 1 || kind === 3 ? 0.5 : 0.4) * size;
      brush.fillStyle = css(solid ?? (kind === 1 ? closed : kind === 3 ? undecided : paper));
      brush.strokeStyle = css(solid ?? (kind >= 2 ? undecided : kind === 1 ? paper : open));
      brush.beginPath();
      brush.arc(at[3 * i], at[3 * i + 1], radius, 0, 7);
      brush.fill();
      brush.stroke();
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
