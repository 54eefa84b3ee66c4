/** Whether triangles cover the canvas exactly once: section 10 of the specification. */

import { check } from "./errors.js";
import { cross, nextOf } from "./geometry.js";

/**
 * @param {Int32Array} points
 * @param {Int32Array} triangles
 * @param {Uint8Array} sides of the canvas that each vertex is on
 * @param {number} doubledArea of the canvas
 */
export function checkCoverage(points, triangles, sides, doubledArea) {
  checkAreas(points, triangles, doubledArea);
  checkEdges(triangles, sides);
  const isUsed = new Uint8Array(sides.length);
  for (const v of triangles) isUsed[v] = 1;
  check(!isUsed.includes(0), "geometry");
}

/**
 * @param {Int32Array} points
 * @param {Int32Array} triangles
 * @param {number} doubledArea of the canvas
 */
function checkAreas(points, triangles, doubledArea) {
  let left = doubledArea;
  for (let at = 0; at < triangles.length; at += 3) {
    const area = cross(points, triangles[at], triangles[at + 1], triangles[at + 2]);
    // To stop as soon as there is too much keeps the sum exact.
    check(area > 0 && area <= left, "geometry");
    left -= area;
  }
  check(left === 0, "geometry");
}

/**
 * Edges without a triangle on either side must be on a side of the canvas.
 *
 * @param {Int32Array} triangles
 * @param {Uint8Array} sides of the canvas that each vertex is on
 */
function checkEdges(triangles, sides) {
  const n = sides.length;
  // Sorted, the two directions of an edge u-v with u < v are next to each other: even, then odd.
  const keys = new Float64Array(triangles.length);
  triangles.forEach((u, e) => {
    const v = triangles[nextOf(e)];
    keys[e] = u < v ? 2 * (u * n + v) : 2 * (v * n + u) + 1;
  });
  keys.sort();
  let end = 0;
  for (let start = 0; start < keys.length; start = end) {
    const edge = Math.floor(keys[start] / 2);
    while (end < keys.length && Math.floor(keys[end] / 2) === edge) end++;
    const isInner = keys[start] !== keys[end - 1];
    const shared = sides[Math.floor(edge / n)] & sides[edge % n];
    check(isInner || shared > 0, "geometry");
  }
}
