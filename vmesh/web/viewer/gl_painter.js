/** Draws meshes with WebGL 2, whose graphics hardware interpolates the colours of the corners. */

import { fillRgba } from "./rgba.js";

const VERTEX_SHADER = `#version 300 es
uniform vec2 centre;
uniform vec2 scale;
uniform float pointSize;
in vec2 position;
in vec4 color;
out vec4 tint;
void main() {
gl_Position = vec4((position - centre) * scale, 0.0, 1.0);
gl_PointSize = pointSize;
tint = color;
}`;

/** Colours are interpolated as a file means them, and multiplied by alpha for the page. */
const PICTURE_SHADER = `#version 300 es
precision highp float;
in vec4 tint;
out vec4 shade;
void main() {
shade = vec4(tint.rgb * tint.a, tint.a);
}`;

const POSITION = 0;
const COLOR = 1;

export class GlPainter {
  /** @param {WebGL2RenderingContext} gl of a canvas without anti-aliasing */
  constructor(gl) {
    this.gl = gl;
    this.canvas = gl.canvas;
    /** @type {import("../decoder/vmesh.js").Mesh | null} */
    this.mesh = null;
    this.resources = this.prepare();
  }

  /** Makes what lives in the graphics hardware. */
  prepare() {
    const { gl } = this;
    gl.enableVertexAttribArray(POSITION);
    gl.enableVertexAttribArray(COLOR);
    return {
      picture: programOf(gl, PICTURE_SHADER),
      positions: gl.createBuffer(),
      colors: gl.createBuffer(),
      corners: gl.createBuffer(),
    };
  }

  /** Makes anew what was lost. */
  restore() {
    this.resources = this.prepare();
    if (this.mesh) this.setMesh(this.mesh);
  }

  /** @param {import("../decoder/vmesh.js").Mesh} mesh */
  setMesh(mesh) {
    const { gl, resources } = this;
    this.mesh = mesh;
    fill(gl, gl.ARRAY_BUFFER, resources.positions, Float32Array.from(mesh.vertices));
    gl.vertexAttribPointer(POSITION, 2, gl.FLOAT, false, 0, 0);
    fill(gl, gl.ARRAY_BUFFER, resources.colors, colorsOf(mesh));
    gl.vertexAttribPointer(COLOR, 4, gl.UNSIGNED_SHORT, true, 0, 0);
    fill(gl, gl.ELEMENT_ARRAY_BUFFER, resources.corners, Uint32Array.from(mesh.triangles));
  }

  /**
   * Draws the mesh, which must have been set.
   *
   * @param {import("./view.js").Frame} frame
   */
  draw(frame) {
    const { gl, mesh, resources } = this;
    if (!mesh) return;
    if (this.canvas.width !== frame.columns) this.canvas.width = frame.columns;
    if (this.canvas.height !== frame.rows) this.canvas.height = frame.rows;
    gl.viewport(0, 0, frame.columns, frame.rows);
    gl.clear(gl.COLOR_BUFFER_BIT);
    this.use(resources.picture, frame, mesh.subdivision);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, resources.corners);
    gl.drawElements(gl.TRIANGLES, mesh.triangles.length, gl.UNSIGNED_INT, 0);
  }

  /**
   * Chooses a program and tells it where the picture is.
   *
   * The shader takes the difference to the centre first: it is exact where single precision would
   * not hold a place at 64 times.
   *
   * @param {WebGLProgram} program
   * @param {import("./view.js").Frame} frame
   * @param {number} subdivision
   */
  use(program, { columns, rows, left, top, scaleX, scaleY }, subdivision) {
    const { gl } = this;
    const unit = 2 ** subdivision;
    gl.useProgram(program);
    const centreX = ((columns / 2 - left) / scaleX) * unit;
    const centreY = ((rows / 2 - top) / scaleY) * unit;
    gl.uniform2f(gl.getUniformLocation(program, "centre"), centreX, centreY);
    const [clipX, clipY] = [(2 * scaleX) / (unit * columns), (-2 * scaleY) / (unit * rows)];
    gl.uniform2f(gl.getUniformLocation(program, "scale"), clipX, clipY);
  }
}

/**
 * A program over the vertices of a mesh.
 *
 * @param {WebGL2RenderingContext} gl
 * @param {string} fragmentShader
 */
export function programOf(gl, fragmentShader) {
  const program = gl.createProgram();
  for (const { type, source } of [
    { type: gl.VERTEX_SHADER, source: VERTEX_SHADER },
    { type: gl.FRAGMENT_SHADER, source: fragmentShader },
  ]) {
    const shader = /** @type {WebGLShader} */ (gl.createShader(type));
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.bindAttribLocation(program, POSITION, "position");
  gl.bindAttribLocation(program, COLOR, "color");
  gl.linkProgram(program);
  return program;
}

/**
 * @param {WebGL2RenderingContext} gl
 * @param {number} target
 * @param {WebGLBuffer} buffer
 * @param {Float32Array | Uint16Array | Uint32Array} array
 */
export function fill(gl, target, buffer, array) {
  gl.bindBuffer(target, buffer);
  gl.bufferData(target, array, gl.STATIC_DRAW);
}

/**
 * Red, green, blue and alpha of each vertex, 65535 for the largest sample.
 *
 * @param {import("../decoder/vmesh.js").Mesh} mesh
 */
function colorsOf({ vertices, samples, steps, depth }) {
  const colors = new Float64Array(2 * vertices.length);
  return Uint16Array.from(fillRgba(colors, samples, steps.length, depth, 65535), Math.round);
}
