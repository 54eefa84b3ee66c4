/**
 * Pixels of a mesh at any scale: each has the colour of the mesh at its centre, in floating point.
 *
 *             .  a        A triangle is drawn row by row, between the places where its sides cross
 *           . |  \        the middle of the row. A side is followed from its upper end to its lower
 *     - - -+--+---+- -    one for both of its triangles, so that they meet in the same place and no
 *        .     |   \      pixel is left out.
 *      c . . . . .  b
 */

import { fillRgba } from "./rgba.js";

/**
 * @param {import("../decoder/vmesh.js").Mesh} mesh
 * @param {Float64Array} places x and y of each vertex in the image
 * @param {ImageData} image transparent
 */
export function drawEnlarged({ vertices, triangles, samples, steps, depth }, places, image) {
  const colors = fillRgba(new Float64Array(2 * vertices.length), samples, steps.length, depth, 255);
  const corners = [0, 0, 0];
  for (let at = 0; at < triangles.length; at += 3) {
    for (let i = 0; i < 3; i++) corners[i] = triangles[at + i];
    drawTriangle(corners, places, colors, image);
  }
}

/**
 * Where a frame shows the vertices: x and y of each.
 *
 * @param {import("../decoder/vmesh.js").Mesh} mesh
 * @param {import("./view.js").Frame} frame
 */
export function placesOf({ vertices, subdivision }, { left, top, scaleX, scaleY }) {
  const unit = 2 ** subdivision;
  const places = new Float64Array(vertices.length);
  for (let i = 0; i < vertices.length; i += 2) {
    places[i] = left + (vertices[i] / unit) * scaleX;
    places[i + 1] = top + (vertices[i + 1] / unit) * scaleY;
  }
  return places;
}

/**
 * @param {number[]} corners
 * @param {Float64Array} places
 * @param {Float64Array} colors red, green, blue and alpha of each vertex
 * @param {ImageData} image
 */
function drawTriangle(corners, places, colors, image) {
  const [a, b, c] = corners.map((v) => [places[2 * v], places[2 * v + 1]]);
  const first = firstCentre(Math.min(a[1], b[1], c[1]), image.height);
  const end = firstCentre(Math.max(a[1], b[1], c[1]), image.height);
  const isBeside = Math.max(a[0], b[0], c[0]) < 0 || Math.min(a[0], b[0], c[0]) > image.width;
  if (first === end || isBeside) return;
  const [bx, by, cx, cy] = [b[0] - a[0], b[1] - a[1], c[0] - a[0], c[1] - a[1]];
  const det = bx * cy - by * cx;
  const planes = [0, 1, 2, 3].map((i) => {
    const base = colors[4 * corners[0] + i];
    const toB = colors[4 * corners[1] + i] - base;
    const toC = colors[4 * corners[2] + i] - base;
    const perColumn = (toB * cy - toC * by) / det;
    const perRow = (toC * bx - toB * cx) / det;
    return { perColumn, perRow, atOrigin: base - perColumn * a[0] - perRow * a[1] };
  });
  for (let y = first; y < end; y++) {
    const crossings = [crossing(a, b, y + 0.5), crossing(b, c, y + 0.5), crossing(c, a, y + 0.5)];
    const [low, high] = crossings.filter((x) => x !== null).sort((x, other) => x - other);
    fillRow(planes, y, firstCentre(low, image.width), firstCentre(high, image.width), image);
  }
}

/**
 * The first pixel of so many whose centre is not before a place; their number if there is none.
 *
 * @param {number} place
 * @param {number} count
 */
function firstCentre(place, count) {
  return Math.min(Math.max(Math.ceil(place - 0.5), 0), count);
}

/**
 * Where the side from u to v crosses a row, or null where it does not; its upper end is on it.
 *
 * @param {number[]} u
 * @param {number[]} v
 * @param {number} y
 */
function crossing(u, v, y) {
  const [upper, lower] = u[1] < v[1] ? [u, v] : [v, u];
  if (y < upper[1] || y >= lower[1]) return null;
  const share = (y - upper[1]) / (lower[1] - upper[1]);
  return upper[0] + share * (lower[0] - upper[0]);
}

/**
 * A component as a function of the place.
 *
 * @typedef {{perColumn: number, perRow: number, atOrigin: number}} Plane
 */

/**
 * @param {Plane[]} planes of red, green, blue and alpha
 * @param {number} y
 * @param {number} start
 * @param {number} end
 * @param {ImageData} image
 */
function fillRow(planes, y, start, end, { data, width }) {
  planes.forEach(({ perColumn, perRow, atOrigin }, i) => {
    const atRow = atOrigin + perRow * (y + 0.5);
    for (let x = start; x < end; x++) {
      // Which is rounded, and clamped.
      data[4 * (y * width + x) + i] = atRow + perColumn * (x + 0.5);
    }
  });
}
