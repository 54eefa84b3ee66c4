/**
 * The order in which colours are coded, from coarse to fine (section 7.2 of the specification). It
 * is that of a Kirkpatrick hierarchy: D. Kirkpatrick, "Optimal search in planar subdivisions", SIAM
 * Journal on Computing 12(1), 1983.
 */

import { isCorner } from "./geometry.js";

const MOST_TRIANGLES = 8;
/** A vertex on the border of the canvas has one neighbour more than triangles. */
export const MOST_PARENTS = MOST_TRIANGLES + 1;
/** Fills the rows of vertices that have fewer parents. */
export const NO_PARENT = -1;

/**
 * Thins the triangulation layer by layer. A layer is an independent set: no two of its vertices are
 * neighbours, so to remove one after the other gives the Delaunay triangulation of those that are
 * left.
 *
 * @param {import("./delaunay.js").Triangulation} triangulation is used up: four corners are left
 * @param {Uint8Array} sides of the canvas that each vertex is on
 * @returns {{order: Int32Array, parents: Int32Array}} vertices in the order in which their colours
 *   are coded, and a row of MOST_PARENTS for each vertex
 */
export function hierarchyOf(triangulation, sides) {
  const order = new Int32Array(sides.length);
  const parents = new Int32Array(MOST_PARENTS * sides.length).fill(NO_PARENT);
  const isTaken = new Uint8Array(sides.length);
  let left = order.map((_, v) => v);
  while (left.length > 4) {
    for (const v of left) isTaken[v] = mayBeTaken(triangulation, v, sides, isTaken) ? 1 : 0;
    const layer = left.filter((v) => isTaken[v]);
    // The layer that is taken first comes last.
    order.set(layer, left.length - layer.length);
    for (const v of layer) {
      parents.set(triangulation.neighboursOf(v), MOST_PARENTS * v);
      triangulation.remove(v);
    }
    left = left.filter((v) => !isTaken[v]);
  }
  order.set(left);
  for (let i = 1; i < 4; i++) parents[MOST_PARENTS * left[i]] = left[i - 1];
  return { order, parents };
}

/**
 * Whether a vertex has few enough triangles, and no neighbour of it has been taken.
 *
 * @param {import("./delaunay.js").Triangulation} triangulation
 * @param {number} v
 * @param {Uint8Array} sides
 * @param {Uint8Array} isTaken
 */
function mayBeTaken(triangulation, v, sides, isTaken) {
  if (isCorner(sides[v])) return false;
  const neighbours = triangulation.neighboursOf(v);
  const most = sides[v] > 0 ? MOST_PARENTS : MOST_TRIANGLES;
  return neighbours.length <= most && neighbours.every((other) => !isTaken[other]);
}
