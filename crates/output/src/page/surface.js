// Draws triangles, lines and points with WebGL2.

/** All parts, whose values are shares of a range of colours or, for marks, their kinds. */
const VERTICES = `#version 300 es
precision highp float;
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 moved;
layout(location = 2) in float value;
uniform mat4 camera;
uniform float magnification, nearer, size;
uniform vec3 shift, stretch;
uniform vec4 plane;
out float share, cut;
out vec3 at;
void main() {
  cut = dot(plane.xyz, place) - plane.w;
  vec4 clip = camera * vec4(place + magnification * moved + shift, 1.0);
  gl_Position = vec4(clip.xy, clip.z - nearer, 1.0);
  gl_PointSize = value == 1.0 || value == 3.0 ? size : 0.8 * size;
  share = value;
  at = clip.xyz * stretch;
}`;

const COLOURED = `#version 300 es
precision highp float;
in float share, cut;
in vec3 at;
uniform vec4 colour;
uniform vec3 table[17];
uniform float coloured, lit;
uniform vec2 range;
out vec4 drawn;
void main() {
  if (cut > 0.0) discard;
  vec3 base = colour.rgb;
  if (coloured > 0.5) {
    float place = clamp((share - range.x) / max(range.y - range.x, 1e-30), 0.0, 1.0) * 16.0;
    int below = min(int(place), 15);
    base = isnan(share) ? vec3(0.72) : mix(table[below], table[below + 1], place - float(below));
  }
  if (lit > 0.5) {
    vec3 normal = normalize(cross(dFdx(at), dFdy(at)));
    base *= 0.62 + 0.38 * abs(dot(normal, normalize(vec3(0.25, 0.4, 0.88))));
  }
  drawn = vec4(base * colour.a, colour.a);
}`;

/** Kinds of marks: 0 open, 1 closed, 2 open and undecided, 3 closed and undecided, 4 a support, 5 a rigid face. */
const [CLOSED, UNDECIDED, CLOSED_UNDECIDED, HELD, RIGID] = [1, 2, 3, 4, 5];

/** The colours of the kinds of marks. */
const INSIDES = ["paper", "closed", "paper", "undecided", "held", "rigid"],
  RIMS = ["open", "paper", "undecided", "undecided", "held", "rigid"];

/** A plane that cuts nothing away. */
const UNCUT = [0, 0, 0, 1e30];

const MARKED = `#version 300 es
precision highp float;
in float share, cut;
uniform vec3 insides[6], rims[6];
out vec4 drawn;
void main() {
  int kind = int(share + 0.5);
  vec2 off = 2.0 * gl_PointCoord - 1.0;
  float away = kind >= 4 ? 0.0 : kind >= 2 ? abs(off.x) + abs(off.y) : length(off);
  if (away > 1.0 || cut > 0.0) discard;
  drawn = vec4(away > (kind == 1 ? 0.82 : 0.62) ? rims[kind] : insides[kind], 1.0);
}`;

class Surface {
  /** Throws if the browser has no WebGL2. */
  constructor(canvas, table) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: true, preserveDrawingBuffer: true });
    if (!gl) throw new Error("no WebGL2");
    const [faces, marks] = [program(gl, VERTICES, COLOURED), program(gl, VERTICES, MARKED)];
    Object.assign(this, { gl, table, faces, marks, parts: {} });
  }

  /** A part of the picture: vertices with their displacements and values, and the order in which they are drawn. */
  set(name, { places, moved, values, order, hidden }) {
    const { gl } = this,
      part = (this.parts[name] ??= {
        array: gl.createVertexArray(),
        buffers: [0, 1, 2, 3].map(() => gl.createBuffer()),
      });
    part.hidden = Boolean(hidden);
    gl.bindVertexArray(part.array);
    const put = (index, data, components) => {
      if (!data) return;
      gl.bindBuffer(gl.ARRAY_BUFFER, part.buffers[index]);
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
      gl.enableVertexAttribArray(index);
      gl.vertexAttribPointer(index, components, gl.FLOAT, false, 0, 0);
    };
    put(0, places, 3);
    put(1, moved, 3);
    put(2, values, 1);
    if (places) part.count = places.length / 3;
    if (order) {
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, part.buffers[3]);
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, order, gl.STATIC_DRAW);
      part.count = order.length;
    }
    gl.bindVertexArray(null);
  }

  /** Draws all parts. `look` has the colours and, as `camera`, the matrix. */
  draw(look) {
    const { gl } = this,
      { canvas } = gl;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    const { camera, stretch, plane, magnification, range, coloured, lit, size } = look,
      shift = [0, 0, 0],
      body = { colour: [...look.body, 1], coloured, lit, nearer: 0, shift },
      lines = { colour: look.meshColour, coloured: 0, lit: 0, nearer: 2e-5, shift };
    gl.useProgram(this.faces.program);
    this.uniform("faces", { table: this.table, camera, stretch, plane, magnification, range });
    this.drawPart("body", gl.TRIANGLES, body);
    if (look.mesh) this.drawPart("mesh", gl.LINES, lines);
    this.uniform("faces", { plane: UNCUT });
    this.drawPart("cap", gl.TRIANGLES, body);
    if (look.rest) this.drawPart("rest", gl.LINES, { ...lines, nearer: 1e-3 });
    gl.useProgram(this.marks.program);
    const marks = { camera, magnification, size, plane, nearer: 0.004, insides: look.insides, rims: look.rims };
    this.drawPart("marks", gl.POINTS, marks, "marks");
    gl.useProgram(this.faces.program);
    gl.depthMask(false);
    for (const { name, colour, shift } of look.patches)
      this.drawPart(name, gl.TRIANGLES, { colour, coloured: 0, lit: 1, nearer: -1e-5, shift });
    gl.depthMask(true);
  }

  drawPart(name, mode, uniforms, of = "faces") {
    const { gl } = this,
      part = this.parts[name];
    if (!part || part.hidden || !part.count) return;
    this.uniform(of, uniforms);
    gl.bindVertexArray(part.array);
    if (mode === gl.POINTS) gl.drawArrays(mode, 0, part.count);
    else gl.drawElements(mode, part.count, gl.UNSIGNED_INT, 0);
    gl.bindVertexArray(null);
  }

  uniform(of, values) {
    const { gl } = this,
      places = this[of].places;
    for (const [name, value] of Object.entries(values)) {
      const place = places[name];
      if (!place) continue;
      if (name === "camera") gl.uniformMatrix4fv(place, false, value);
      else if (Array.isArray(value[0])) gl.uniform3fv(place, value.flat());
      else gl[`uniform${value.length ?? 1}fv`](place, [value].flat());
    }
  }
}

function program(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [kind, text] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  const places = {};
  for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i++) {
    const { name } = gl.getActiveUniform(program, i);
    places[name.replace("[0]", "")] = gl.getUniformLocation(program, name);
  }
  return { program, places };
}
