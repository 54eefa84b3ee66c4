/** The pixels of a mesh at its native size: section 11 of the specification. */

import { check } from "./errors.js";
import { cross } from "./geometry.js";
import { DEFAULT_LIMITS } from "./limits.js";

/**
 * A raster.
 *
 * @typedef {object} Picture
 * @property {number} width
 * @property {number} height
 * @property {number} components
 * @property {number} depth bits of a sample
 * @property {Uint8Array | Uint16Array} data the samples of each pixel, row by row: grey, or RGB, or
 *   RGB and alpha (not multiplied); those of more than 8 bits are 16 bits wide
 */

/**
 * @param {import("./vmesh.js").Mesh} mesh
 * @param {Partial<Pick<import("./limits.js").Limits, "pixels" | "triangleRows">>} [limits]
 * @returns {Picture}
 */
export function render(mesh, limits = {}) {
  const { pixels, triangleRows } = { ...DEFAULT_LIMITS, ...limits };
  const { width, height, depth, triangles } = mesh;
  const components = mesh.steps.length;
  check(width * height <= pixels, "limit");
  check(countRows(mesh) <= triangleRows, "limit");
  const length = width * height * components;
  const data = depth === 8 ? new Uint8Array(length) : new Uint16Array(length);
  const rasterizer = new Rasterizer(mesh, data);
  for (let at = 0; at < triangles.length; at += 3) rasterizer.draw(at);
  return { width, height, components, depth, data };
}

/**
 * The rows of all triangles: without the pixels, the work of rendering.
 *
 * @param {import("./vmesh.js").Mesh} mesh
 */
function countRows(mesh) {
  let count = 0;
  for (let at = 0; at < mesh.triangles.length; at += 3) {
    const [first, last] = rowsOf(mesh, at);
    count += Math.max(0, last - first + 1);
  }
  return count;
}

/**
 * The first and the last row whose pixel centres are within the height of a triangle.
 *
 * @param {import("./vmesh.js").Mesh} mesh
 * @param {number} at place of the triangle's first corner
 */
function rowsOf({ vertices, triangles, subdivision, height }, at) {
  const pixel = 1 << subdivision;
  const y0 = vertices[2 * triangles[at] + 1];
  const y1 = vertices[2 * triangles[at + 1] + 1];
  const y2 = vertices[2 * triangles[at + 2] + 1];
  const first = Math.ceil(Math.min(y0, y1, y2) / pixel - 0.5);
  const last = Math.floor(Math.max(y0, y1, y2) / pixel - 0.5);
  return [first, Math.min(last, height - 1)];
}

/**
 * Fills triangles row by row. Coordinates are in half lattice units, where centres of pixels are
 * integers of at most 2**20. Weight i of a pixel is the doubled area that its centre forms with the
 * side opposite to corner i, so at most 2**40. It is linear: `atOrigin[i] + perColumn[i] * x +
 * perRow[i] * y`.
 */
class Rasterizer {
  #mesh;
  #mostDet;
  #components;
  #data;
  #pixel;
  #atOrigin = new Float64Array(3);
  #perColumn = new Float64Array(3);
  #perRow = new Float64Array(3);
  /** The least weights of the pixels of the triangle: by the top-left rule 0 or 1. */
  #least = new Float64Array(3);
  /** Weights at column 0 of the current row. */
  #atRow = new Float64Array(3);
  /** Weights at the first pixel of the current row. */
  #weights = new Float64Array(3);

  /**
   * @param {import("./vmesh.js").Mesh} mesh
   * @param {Uint8Array | Uint16Array} data
   */
  constructor(mesh, data) {
    this.#mesh = mesh;
    this.#mostDet = 2 ** (52 - mesh.depth);
    this.#components = mesh.steps.length;
    this.#data = data;
    this.#pixel = 2 ** (mesh.subdivision + 1);
  }

  /** @param {number} at place of the triangle's first corner */
  draw(at) {
    const { vertices, triangles } = this.#mesh;
    const [a, b, c] = [triangles[at], triangles[at + 1], triangles[at + 2]];
    this.#setSide(0, b, c);
    this.#setSide(1, c, a);
    this.#setSide(2, a, b);
    const det = 4 * cross(vertices, a, b, c);
    const [first, last] = rowsOf(this.#mesh, at);
    for (let y = first; y <= last; y++) {
      for (let i = 0; i < 3; i++) this.#atRow[i] = this.#atOrigin[i] + this.#perRow[i] * y;
      this.#drawRow(at, det, y);
    }
  }

  /**
   * Prepares the weight i, of the side from vertex u to v.
   *
   * @param {number} i
   * @param {number} u
   * @param {number} v
   */
  #setSide(i, u, v) {
    const { vertices } = this.#mesh;
    const ux = 2 * vertices[2 * u];
    const uy = 2 * vertices[2 * u + 1];
    const dx = 2 * vertices[2 * v] - ux;
    const dy = 2 * vertices[2 * v + 1] - uy;
    const centre = this.#pixel / 2;
    this.#atOrigin[i] = dx * (centre - uy) - dy * (centre - ux);
    this.#perColumn[i] = -dy * this.#pixel;
    this.#perRow[i] = dx * this.#pixel;
    this.#least[i] = dy < 0 || (dy === 0 && dx > 0) ? 0 : 1;
  }

  /**
   * @param {number} at place of the triangle's first corner
   * @param {number} det
   * @param {number} y
   */
  #drawRow(at, det, y) {
    const perColumn = this.#perColumn;
    let start = 0;
    let end = this.#mesh.width - 1;
    for (let i = 0; i < 3; i++) {
      const spare = this.#atRow[i] - this.#least[i];
      if (perColumn[i] > 0) start = Math.max(start, Math.ceil(-spare / perColumn[i]));
      else if (perColumn[i] < 0) end = Math.min(end, Math.floor(spare / -perColumn[i]));
      else if (spare < 0) return;
    }
    if (start <= end) this.#fill(at, det, y, start, end);
  }

  /**
   * Interpolates the samples of the pixels from `start` to `end` in a row. Numerators are below
   * det * 2**(depth + 1). Up to 2**53 they are exact, and so is the floor of a quotient.
   *
   * @param {number} at place of the triangle's first corner
   * @param {number} det
   * @param {number} y
   * @param {number} start
   * @param {number} end
   */
  #fill(at, det, y, start, end) {
    const components = this.#components;
    const data = this.#data;
    const perColumn = this.#perColumn;
    const weights = this.#weights;
    const { samples, triangles, width } = this.#mesh;
    for (let i = 0; i < 3; i++) weights[i] = this.#atRow[i] + perColumn[i] * start;
    for (let component = 0; component < components; component++) {
      const c0 = samples[triangles[at] * components + component];
      const c1 = samples[triangles[at + 1] * components + component];
      const c2 = samples[triangles[at + 2] * components + component];
      let place = (y * width + start) * components + component;
      if (det > this.#mostDet) {
        this.#fillInParts([c0, c1, c2], det, place, start, end);
        continue;
      }
      let numerator = 2 * (c0 * weights[0] + c1 * weights[1] + c2 * weights[2]) + det;
      const step = 2 * (c0 * perColumn[0] + c1 * perColumn[1] + c2 * perColumn[2]);
      for (let x = start; x <= end; x++) {
        data[place] = Math.floor(numerator / (2 * det));
        numerator += step;
        place += components;
      }
    }
  }

  /**
   * Sums the upper and the lower bytes of the samples apart: both sums are at most 255 * 2**40, and
   * with the remainder of the upper one, which is below det, all numbers stay below 2**51.
   *
   * @param {number[]} corners samples of one component
   * @param {number} det
   * @param {number} place in the data
   * @param {number} start
   * @param {number} end
   */
  #fillInParts(corners, det, place, start, end) {
    for (let x = start; x <= end; x++) {
      let upper = 0;
      let lower = 0;
      corners.forEach((sample, i) => {
        const weight = this.#atRow[i] + this.#perColumn[i] * x;
        upper += weight * (sample >> 8);
        lower += weight * (sample & 255);
      });
      const whole = Math.floor(upper / det);
      const rest = 256 * (upper - whole * det) + lower;
      this.#data[place] = 256 * whole + Math.floor((2 * rest + det) / (2 * det));
      place += this.#components;
    }
  }
}
