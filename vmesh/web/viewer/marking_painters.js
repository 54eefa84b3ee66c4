/** Painters that draw the mesh itself over its picture: wireframe and vertices. */

import { contextOf, glOf } from "./dom.js";
import { endsOf } from "./edges.js";
import { placesOf } from "./enlarge.js";
import { GlPainter, fill, programOf } from "./gl_painter.js";
import { RasterPainter } from "./raster_painter.js";

/**
 * What is drawn over a picture: wireframe, vertices, and how many pixels of the device one of the
 * page is wide.
 *
 * @typedef {{wireframe?: boolean, vertices?: boolean, pixelRatio?: number}} Marks
 */

const INK_SHADER = `#version 300 es
precision highp float;
uniform vec4 ink;
uniform bool isRound;
out vec4 shade;
void main() {
if (isRound && distance(gl_PointCoord, vec2(0.5)) > 0.5) discard;
shade = vec4(ink.rgb * ink.a, ink.a);
}`;

const LINE_INK = [0, 0.85, 1, 0.75];
const RIM_INK = [0, 0, 0, 0.8];
const DOT_INK = [1, 0.85, 0, 1];

export class MarkingGlPainter extends GlPainter {
  /** @type {ReturnType<MarkingGlPainter["prepareInks"]> | null} */
  marking = null;
  nEnds = 0;

  prepareInks() {
    const { gl } = this;
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    return { inks: programOf(gl, INK_SHADER), ends: gl.createBuffer() };
  }

  /** @override */
  restore() {
    this.marking = null;
    super.restore();
  }

  /**
   * @override
   * @param {import("../decoder/vmesh.js").Mesh} mesh
   */
  setMesh(mesh) {
    this.nEnds = 0;
    super.setMesh(mesh);
  }

  /**
   * @override
   * @param {import("./view.js").Frame} frame
   * @param {Marks} [marks]
   */
  draw(frame, { wireframe = false, vertices = false, pixelRatio = 1 } = {}) {
    super.draw(frame);
    const { gl, mesh } = this;
    if (!mesh || (!wireframe && !vertices)) return;
    const { inks, ends } = (this.marking ??= this.prepareInks());
    gl.enable(gl.BLEND);
    this.use(inks, frame, mesh.subdivision);
    if (wireframe) this.drawEdges(mesh, inks, ends);
    if (vertices) this.drawVertices(mesh, inks, pixelRatio);
    gl.disable(gl.BLEND);
  }

  /**
   * @param {import("../decoder/vmesh.js").Mesh} mesh
   * @param {WebGLProgram} inks
   * @param {WebGLBuffer} buffer of the ends of edges
   */
  drawEdges(mesh, inks, buffer) {
    const { gl } = this;
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
    if (this.nEnds === 0) {
      const ends = endsOf(mesh);
      fill(gl, gl.ELEMENT_ARRAY_BUFFER, buffer, ends);
      this.nEnds = ends.length;
    }
    this.setInk(inks, LINE_INK, 1, false);
    gl.drawElements(gl.LINES, this.nEnds, gl.UNSIGNED_INT, 0);
  }

  /**
   * @param {import("../decoder/vmesh.js").Mesh} mesh
   * @param {WebGLProgram} inks
   * @param {number} pixelRatio
   */
  drawVertices(mesh, inks, pixelRatio) {
    const { gl } = this;
    for (const { ink, size } of [{ ink: RIM_INK, size: 6 }, { ink: DOT_INK, size: 4 }]) {
      this.setInk(inks, ink, size * pixelRatio, true);
      gl.drawArrays(gl.POINTS, 0, mesh.vertices.length / 2);
    }
  }

  /**
   * @param {WebGLProgram} inks
   * @param {number[]} ink
   * @param {number} pointSize
   * @param {boolean} isRound
   */
  setInk(inks, ink, pointSize, isRound) {
    const { gl } = this;
    gl.uniform4fv(gl.getUniformLocation(inks, "ink"), ink);
    gl.uniform1f(gl.getUniformLocation(inks, "pointSize"), pointSize);
    gl.uniform1i(gl.getUniformLocation(inks, "isRound"), isRound ? 1 : 0);
  }
}

class MarkingRasterPainter extends RasterPainter {
  /** @type {Uint32Array | null} */
  ends = null;

  /**
   * @override
   * @param {import("../decoder/vmesh.js").Mesh} mesh
   */
  setMesh(mesh) {
    this.ends = null;
    super.setMesh(mesh);
  }

  /**
   * @override
   * @param {import("./view.js").Frame} frame
   * @param {Marks} [marks]
   */
  draw(frame, { wireframe = false, vertices = false, pixelRatio = 1 } = {}) {
    super.draw(frame);
    if (!this.mesh || (!wireframe && !vertices)) return;
    const places = placesOf(this.mesh, frame);
    if (wireframe) this.drawEdges((this.ends ??= endsOf(this.mesh)), places);
    if (vertices) this.drawVertices(places, 4 * pixelRatio);
  }

  /**
   * @param {Uint32Array} ends
   * @param {Float64Array} places
   */
  drawEdges(ends, places) {
    const { context } = this;
    context.beginPath();
    for (let at = 0; at < ends.length; at += 2) {
      const [u, v] = [2 * ends[at], 2 * ends[at + 1]];
      context.moveTo(places[u], places[u + 1]);
      context.lineTo(places[v], places[v + 1]);
    }
    context.strokeStyle = "rgb(0 217 255 / 75%)";
    context.stroke();
  }

  /**
   * @param {Float64Array} places
   * @param {number} size
   */
  drawVertices(places, size) {
    this.context.fillStyle = "rgb(255 217 0)";
    for (let at = 0; at < places.length; at += 2) {
      this.context.fillRect(places[at] - size / 2, places[at + 1] - size / 2, size, size);
    }
  }
}

/**
 * The painter for a canvas, as `painterFor` chooses it.
 *
 * @param {HTMLCanvasElement} canvas
 */
export function markingPainterFor(canvas) {
  const gl = glOf(canvas);
  return gl ? new MarkingGlPainter(gl) : new MarkingRasterPainter(contextOf(canvas));
}
