// Draws solids, their shadows on the floor, and the floor, with WebGL 2.

/** @import { Solid } from "./solids.js" */

/** @typedef {{ array: WebGLVertexArrayObject, count: number }} Mesh */
/** @typedef {{ mesh: Mesh, model: Float32Array, color: number[], casts?: boolean }} Thing */

const LIGHT = [0.42, -0.36, 0.83]; // towards it
const VERTEX = `#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 model, view;
uniform vec3 light;
uniform float shadow;
out vec3 n;
void main() {
  vec4 at = model * vec4(position, 1.0);
  // Columns of the model are turned and scaled axes: the inverse scale makes normals right.
  mat3 m = mat3(model);
  vec3 s = vec3(dot(m[0], m[0]), dot(m[1], m[1]), dot(m[2], m[2]));
  n = m * (normal / max(s, 1e-9));
  if (shadow > 0.0) at.xyz = vec3(at.xy - light.xy * at.z / light.z, 0.001);
  gl_Position = view * at;
}`;
const FRAGMENT = `#version 300 es
precision highp float;
in vec3 n;
uniform vec3 light;
uniform vec4 color;
uniform float shadow;
out vec4 drawn;
void main() {
  if (shadow > 0.0) { drawn = vec4(0.0, 0.0, 0.0, shadow); return; }
  vec3 u = normalize(n);
  float sky = mix(0.42, 0.78, 0.5 + 0.5 * u.z), key = max(dot(u, light), 0.0);
  float back = 0.16 * max(dot(u, vec3(-0.6, 0.5, 0.3)), 0.0);
  vec3 lit = color.rgb * (sky + 0.55 * key + back) + 0.07 * pow(key, 24.0);
  drawn = vec4(lit * color.a, color.a);
}`;
const FLOOR_VERTEX = `#version 300 es
layout(location = 0) in vec3 position;
uniform mat4 view;
out vec2 at;
void main() { at = 8.0 * position.xy; gl_Position = view * vec4(at, 0.0, 1.0); }`;
const FLOOR_FRAGMENT = `#version 300 es
precision highp float;
in vec2 at;
uniform vec2 shift;
uniform vec3 line;
out vec4 drawn;
float grid(vec2 p, float cell) {
  vec2 q = p / cell, far = abs(fract(q - 0.5) - 0.5) / fwidth(q);
  return 1.0 - min(min(far.x, far.y), 1.0);
}
void main() {
  vec2 p = at + shift;
  float a = max(0.5 * grid(p, 0.5), 0.18 * grid(p, 0.1)) * smoothstep(4.0, 0.6, length(at));
  drawn = vec4(line * a, a);
}`;

export class Painter {
  /** @param {HTMLCanvasElement} canvas @returns {Painter | null} null where WebGL 2 is missing */
  static on(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: true, stencil: true });
    return gl && new Painter(canvas, gl);
  }

  /** @param {HTMLCanvasElement} canvas @param {WebGL2RenderingContext} gl */
  constructor(canvas, gl) {
    this.canvas = canvas;
    this.gl = gl;
    this.solids = program(gl, VERTEX, FRAGMENT);
    this.floor = program(gl, FLOOR_VERTEX, FLOOR_FRAGMENT);
    this.square = this.mesh({
      vertices: new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]),
      normals: new Float32Array(12),
      faces: new Uint16Array([0, 1, 2, 0, 2, 3]),
    });
  }

  /** @param {Solid} solid @returns {Mesh} */
  mesh({ vertices, normals, faces }) {
    const { gl } = this;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    [vertices, normals].forEach((data, place) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 0, 0);
    });
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, faces, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    return { array, count: faces.length };
  }

  /** As wide and high in pixels as it is shown. */
  fit() {
    const ratio = Math.min(2, devicePixelRatio || 1);
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    this.canvas.width = Math.max(1, Math.round(width * ratio));
    this.canvas.height = Math.max(1, Math.round(height * ratio));
    this.gl.viewport(0, 0, this.canvas.width, this.canvas.height);
  }

  /**
   * @param {Float32Array} view
   * @param {Thing[]} things those that shine through come last
   * @param {number[]} shift of the floor, m
   * @param {number[]} line the grid's colour
   */
  draw(view, things, shift, line) {
    const { gl } = this;
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.disable(gl.DEPTH_TEST);
    gl.useProgram(this.floor.program);
    gl.uniformMatrix4fv(this.floor.at("view"), false, view);
    gl.uniform2fv(this.floor.at("shift"), shift);
    gl.uniform3fv(this.floor.at("line"), line);
    this.#mesh(this.square);
    gl.useProgram(this.solids.program);
    gl.uniformMatrix4fv(this.solids.at("view"), false, view);
    gl.uniform3fv(this.solids.at("light"), LIGHT);
    // Each point of the floor is shaded once, however many parts lie over it.
    gl.enable(gl.STENCIL_TEST);
    gl.stencilFunc(gl.EQUAL, 0, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    gl.uniform1f(this.solids.at("shadow"), 0.28);
    for (const thing of things) if (thing.casts) this.#thing(thing);
    gl.disable(gl.STENCIL_TEST);
    gl.enable(gl.DEPTH_TEST);
    gl.uniform1f(this.solids.at("shadow"), 0);
    for (const thing of things) this.#thing(thing);
  }

  /** @param {Thing} thing */
  #thing({ mesh, model, color }) {
    this.gl.uniformMatrix4fv(this.solids.at("model"), false, model);
    this.gl.uniform4fv(this.solids.at("color"), color);
    this.#mesh(mesh);
  }

  /** @param {Mesh} mesh */
  #mesh({ array, count }) {
    this.gl.bindVertexArray(array);
    this.gl.drawElements(this.gl.TRIANGLES, count, this.gl.UNSIGNED_SHORT, 0);
  }
}

/** @param {WebGL2RenderingContext} gl @param {string} vertex @param {string} fragment */
function program(gl, vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, text] of /** @type {[number, string][]} */ ([
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ])) {
    const shader = /** @type {WebGLShader} */ (gl.createShader(kind));
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS))
    throw new Error(gl.getProgramInfoLog(made) ?? "the shaders do not fit");
  /** @type {Map<string, WebGLUniformLocation | null>} */
  const places = new Map();
  const at = (/** @type {string} */ name) => {
    if (!places.has(name)) places.set(name, gl.getUniformLocation(made, name));
    return places.get(name) ?? null;
  };
  return { program: made, at };
}
