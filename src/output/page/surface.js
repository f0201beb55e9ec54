// Draws triangles, lines and points with WebGL2.

const FACES = `#version 300 es
precision highp float;
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 moved;
layout(location = 2) in float value;
uniform mat4 camera;
uniform float magnification, nearer;
uniform vec3 shift, stretch;
out float share, cut;
out vec3 at;
uniform vec4 plane;
void main() {
  cut = dot(plane.xyz, place) - plane.w;
  vec4 clip = camera * vec4(place + magnification * moved + shift, 1.0);
  gl_Position = vec4(clip.xy, clip.z - nearer, 1.0);
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

const MARKS = `#version 300 es
precision highp float;
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 moved;
layout(location = 2) in float value;
uniform mat4 camera;
uniform float magnification, size, nearer;
uniform vec4 plane;
flat out int kind;
flat out float cut;
void main() {
  cut = dot(plane.xyz, place) - plane.w;
  vec4 clip = camera * vec4(place + magnification * moved, 1.0);
  gl_Position = vec4(clip.xy, clip.z - nearer, 1.0);
  kind = int(value + 0.5);
  gl_PointSize = (kind == 1 || kind == 3) ? size : 0.8 * size;
}`;

// 0 open, 1 closed, 2 open and undecided, 3 closed and undecided, 4 a support, 5 a rigid face.
const MARKED = `#version 300 es
precision highp float;
flat in int kind;
flat in float cut;
uniform vec3 closed, open, undecided, paper, held, rigid;
out vec4 drawn;
void main() {
  vec2 off = 2.0 * gl_PointCoord - 1.0;
  float away = kind >= 4 ? 0.0 : kind >= 2 ? abs(off.x) + abs(off.y) : length(off);
  if (away > 1.0 || cut > 0.0) discard;
  vec3 ring = kind == 4 ? held : kind == 5 ? rigid : kind >= 2 ? undecided : (kind == 1 ? paper : open);
  vec3 inside = kind == 4 ? held : kind == 5 ? rigid : kind == 1 ? closed : (kind == 3 ? undecided : paper);
  drawn = vec4(away > (kind == 1 ? 0.82 : 0.62) ? ring : inside, 1.0);
}`;

class Surface {
  /** Throws if the browser has no WebGL2. */
  constructor(canvas, table) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: true, preserveDrawingBuffer: true });
    if (!gl) throw new Error("no WebGL2");
    this.gl = gl;
    this.table = table.flat();
    this.faces = program(gl, FACES, COLOURED);
    this.marks = program(gl, MARKS, MARKED);
    this.parts = {};
  }

  /** A part of the picture: vertices with their displacements and values, and the order in which they are drawn. */
  set(name, { places, moved, values, order, hidden }) {
    const { gl } = this,
      part = this.parts[name] || (this.parts[name] = { buffers: [] });
    part.hidden = Boolean(hidden);
    if (!part.array) {
      part.array = gl.createVertexArray();
      part.buffers = [0, 1, 2, 3].map(() => gl.createBuffer());
    }
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

  /** Draws all parts. `look` has the colours, `camera` the matrix. */
  draw(camera, look) {
    const { gl } = this,
      { canvas } = gl;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.useProgram(this.faces.program);
    this.uniform("faces", {
      camera,
      stretch: look.stretch,
      table: this.table,
      range: look.range,
      magnification: look.magnification,
      plane: look.plane,
    });
    const body = {
      colour: [...look.body, 1],
      coloured: look.coloured,
      lit: look.lit,
      nearer: 0,
      shift: [0, 0, 0],
    };
    this.drawPart("body", gl.TRIANGLES, body);
    const lines = { colour: look.meshColour, coloured: 0, lit: 0, nearer: 2e-5, shift: [0, 0, 0] };
    if (look.mesh) this.drawPart("mesh", gl.LINES, lines);
    const whole = [0, 0, 0, 1e30];
    this.drawPart("cap", gl.TRIANGLES, { ...body, plane: whole });
    if (look.rest) this.drawPart("rest", gl.LINES, { ...lines, plane: whole, nearer: 1e-3 });
    gl.useProgram(this.marks.program);
    this.uniform("marks", {
      camera,
      magnification: look.magnification,
      size: look.markSize,
      nearer: 0.004,
      plane: look.plane,
      ...look.marks,
    });
    this.drawPart("marks", gl.POINTS, {}, "marks");
    gl.useProgram(this.faces.program);
    gl.depthMask(false);
    for (const { name, colour, shift } of look.patches) {
      this.drawPart(name, gl.TRIANGLES, { colour, coloured: 0, lit: 1, nearer: -1e-5, shift });
    }
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
      else if (name === "table") gl.uniform3fv(place, value);
      else if (!Array.isArray(value)) gl.uniform1f(place, Number(value));
      else if (value.length === 2) gl.uniform2fv(place, value);
      else if (value.length === 3) gl.uniform3fv(place, value);
      else gl.uniform4fv(place, value);
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
