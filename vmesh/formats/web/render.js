/** The pixels of a mesh at its native size: section 11 of the specification. */

import { check } from "./errors.js";
import { cross } from "./geometry.js";
import { DEFAULT_LIMITS } from "./limits.js";

/**
 * @param {import("./vmesh.js").Mesh} mesh
 * @param {{pixels?: number, triangleRows?: number}} [limits] see DEFAULT_LIMITS
 * @returns {{width: number, height: number, depth: number, data: Uint8Array}} `data` holds
 *   `depth` samples for each pixel, row by row: grey, or RGB, or RGB and alpha (not multiplied)
 */
export function render(mesh, limits = {}) {
  const { pixels, triangleRows } = { ...DEFAULT_LIMITS, ...limits };
  const { width, height } = mesh;
  const depth = mesh.steps.length;
  check(width * height <= pixels, "limit");
  check(countRows(mesh) <= triangleRows, "limit");
  const data = new Uint8Array(width * height * depth);
  const rasterizer = new Rasterizer(mesh, { width, height, depth, data });
  for (let at = 0; at < mesh.triangles.length; at += 3) rasterizer.draw(at);
  return { width, height, depth, data };
}

/** The rows of all triangles: without the pixels, the work of rendering. */
function countRows({ vertices, triangles, subdivision, height }) {
  let count = 0;
  for (let at = 0; at < triangles.length; at += 3) {
    const [first, last] = rowsOf(vertices, triangles, at, 2 ** (subdivision + 1), height);
    count += Math.max(0, last - first + 1);
  }
  return count;
}

/** The first and the last row whose pixel centres are within the height of a triangle. */
function rowsOf(vertices, triangles, at, pixel, height) {
  const ys = [0, 1, 2].map((i) => 2 * vertices[2 * triangles[at + i] + 1]);
  const first = Math.ceil((Math.min(...ys) - pixel / 2) / pixel);
  const last = Math.floor((Math.max(...ys) - pixel / 2) / pixel);
  return [first, Math.min(last, height - 1)];
}

/**
 * Fills triangles row by row. Coordinates are in half lattice units, where centres of pixels are
 * integers. All numbers are integers below 2**53, and so exact: coordinates are at most 2**20,
 * doubled areas below 2**42, their sums with samples below 2**51.
 *
 * Weight i of a pixel is the doubled area that its centre forms with the side opposite to corner
 * i. It is linear: `atOrigin[i] + perColumn[i] * x + perRow[i] * y`.
 */
class Rasterizer {
  constructor(mesh, picture) {
    this.mesh = mesh;
    this.picture = picture;
    this.pixel = 2 ** (mesh.subdivision + 1);
    this.atOrigin = new Float64Array(3);
    this.perColumn = new Float64Array(3);
    this.perRow = new Float64Array(3);
    /** Weights at column 0 of the current row. */
    this.atRow = new Float64Array(3);
    /** The least weights of the pixels of the triangle. */
    this.least = new Float64Array(3);
  }

  /** @param {number} at place of the triangle's first corner */
  draw(at) {
    const { vertices, triangles } = this.mesh;
    for (let i = 0; i < 3; i++) {
      this.setSide(i, triangles[at + ((i + 1) % 3)], triangles[at + ((i + 2) % 3)]);
    }
    const det = 4 * cross(vertices, triangles[at], triangles[at + 1], triangles[at + 2]);
    const [first, last] = rowsOf(vertices, triangles, at, this.pixel, this.picture.height);
    for (let y = first; y <= last; y++) {
      for (let i = 0; i < 3; i++) this.atRow[i] = this.atOrigin[i] + this.perRow[i] * y;
      this.drawRow(at, det, y);
    }
  }

  /** Prepares the weight i, of the side from vertex u to v. */
  setSide(i, u, v) {
    const { vertices } = this.mesh;
    const ux = 2 * vertices[2 * u];
    const uy = 2 * vertices[2 * u + 1];
    const dx = 2 * vertices[2 * v] - ux;
    const dy = 2 * vertices[2 * v + 1] - uy;
    const centre = this.pixel / 2;
    this.atOrigin[i] = dx * (centre - uy) - dy * (centre - ux);
    this.perColumn[i] = -dy * this.pixel;
    this.perRow[i] = dx * this.pixel;
    const isTopLeft = dy < 0 || (dy === 0 && dx > 0);
    this.least[i] = isTopLeft ? 0 : 1;
  }

  drawRow(at, det, y) {
    const { atRow, perColumn, least } = this;
    let start = 0;
    let end = this.picture.width - 1;
    for (let i = 0; i < 3; i++) {
      const spare = atRow[i] - least[i];
      if (perColumn[i] > 0) start = Math.max(start, Math.ceil(-spare / perColumn[i]));
      else if (perColumn[i] < 0) end = Math.min(end, Math.floor(spare / -perColumn[i]));
      else if (spare < 0) return;
    }
    if (start <= end) this.fill(at, det, y, start, end);
  }

  /** Interpolates the samples of the pixels from `start` to `end` in a row. */
  fill(at, det, y, start, end) {
    const { mesh, picture, atRow, perColumn } = this;
    const { width, depth, data } = picture;
    for (let component = 0; component < depth; component++) {
      let total = 0;
      let step = 0;
      for (let i = 0; i < 3; i++) {
        const sample = mesh.samples[mesh.triangles[at + i] * depth + component];
        total += sample * (atRow[i] + perColumn[i] * start);
        step += sample * perColumn[i];
      }
      let numerator = 2 * total + det;
      let place = (y * width + start) * depth + component;
      for (let x = start; x <= end; x++) {
        data[place] = Math.floor(numerator / (2 * det));
        numerator += 2 * step;
        place += depth;
      }
    }
  }
}
