/** Flipped triangles: section 8.2 of the specification. */

import { check } from "./errors.js";
import { canonicalOrder, cross, nextOf, prevOf } from "./geometry.js";
import { Contexts } from "./range_coder.js";
import { NO_TWIN } from "./subdivision.js";

const ANGLES = [3, 7, 12, 18, 26, 38, 60];
const N_ANGLES = ANGLES.length + 1;
const N_SLOPES = 5;
const FLIPPED = [
  [
    [2, 3, 3, 4, 6],
    [9, 10, 10, 13, 17],
    [9, 10, 9, 12, 16],
    [8, 8, 8, 10, 15],
    [7, 7, 8, 9, 13],
    [6, 6, 6, 6, 11],
    [5, 4, 5, 5, 8],
    [3, 2, 2, 3, 5],
  ],
  [
    [6, 8, 9, 9, 12],
    [10, 11, 11, 13, 16],
    [7, 8, 9, 10, 14],
    [5, 7, 6, 7, 10],
    [4, 5, 6, 6, 8],
    [3, 4, 4, 4, 6],
    [2, 2, 2, 2, 4],
    [2, 1, 2, 2, 3],
  ],
];

/**
 * @param {import("./range_coder.js").RangeDecoder} decoder
 * @param {Int32Array} points
 * @param {import("./subdivision.js").HalfEdges} mesh the canonical Delaunay triangles; changed
 * @param {Int32Array} luma level of the first component of each vertex
 * @returns {Int32Array} the triangles after the coded flips, in canonical order
 */
export function readFlips(decoder, points, mesh, luma) {
  decoder.part = "triangles";
  const queue = new EdgeQueue(mesh.twin);
  mesh.twin.forEach((f, e) => e < f && queue.push(e));
  const contexts = Contexts.preset(FLIPPED.flat(2).map((share) => 2048 * share));
  const nFirst = queue.length;
  let nFlips = 0;

  for (let nLooks = 1; queue.length > 0; nLooks++) {
    const quad = convexQuadAt(mesh, points, queue.shift());
    if (!quad) continue;
    const isFirst = nLooks <= nFirst ? 1 : 0;
    const row = isFirst * N_ANGLES + angleOf(points, quad);
    if (!decoder.bit(contexts, row * N_SLOPES + slopeOf(luma, quad))) continue;
    nFlips++;
    check(nFlips <= mesh.origin.length, "triangles");
    const { e, f } = quad;
    flip(mesh, e, f);
    for (const side of [nextOf(e), f, nextOf(f), e]) queue.push(side);
  }
  return canonicalOrder(mesh.origin, luma.length);
}

/** First in, first out; each edge with a twin is in it no more than once. */
class EdgeQueue {
  #twin;
  #ring;
  #isQueued;
  #front = 0;

  /** @param {Int32Array} twin */
  constructor(twin) {
    this.#twin = twin;
    this.#ring = new Int32Array(twin.length);
    this.#isQueued = new Uint8Array(twin.length);
    this.length = 0;
  }

  /** @param {number} e */
  push(e) {
    const f = this.#twin[e];
    if (f === NO_TWIN || this.#isQueued[e] || this.#isQueued[f]) return;
    this.#ring[(this.#front + this.length) % this.#ring.length] = e;
    this.#isQueued[e] = 1;
    this.length++;
  }

  shift() {
    const e = this.#ring[this.#front];
    this.#front = (this.#front + 1) % this.#ring.length;
    this.length--;
    this.#isQueued[e] = 0;
    return e;
  }
}

/**
 * The quad a, b, d, c around an edge b-c with b < c: half-edge e from b to c, and f back.
 *
 * @typedef {{e: number, f: number, a: number, b: number, c: number, d: number}} Quad
 */

/**
 * @param {import("./subdivision.js").HalfEdges} mesh
 * @param {Int32Array} points
 * @param {number} edge
 * @returns {Quad | null} the quad around an edge, or null if it is not strictly convex
 */
function convexQuadAt({ origin, twin }, points, edge) {
  let e = edge;
  let f = twin[e];
  if (f === NO_TWIN) return null;
  if (origin[e] > origin[f]) [e, f] = [f, e];
  const b = origin[e];
  const c = origin[f];
  const a = origin[prevOf(e)];
  const d = origin[prevOf(f)];
  const isConvex = cross(points, a, d, c) > 0 && cross(points, d, a, b) > 0;
  return isConvex ? { e, f, a, b, c, d } : null;
}

/**
 * @param {Int32Array} points
 * @param {Quad} quad
 */
function angleOf(points, { a, b, c, d }) {
  const cotangents = cotangent(points, a, b, c) + cotangent(points, d, c, b);
  return ANGLES.filter((threshold) => cotangents >= threshold).length;
}

/**
 * Cotangent of the angle at a of the positive triangle a, b, c in sixteenths, rounded down.
 *
 * @param {Int32Array} points
 * @param {number} a
 * @param {number} b
 * @param {number} c
 */
function cotangent(points, a, b, c) {
  const ax = points[2 * a];
  const ay = points[2 * a + 1];
  const dot =
    (points[2 * b] - ax) * (points[2 * c] - ax) +
    (points[2 * b + 1] - ay) * (points[2 * c + 1] - ay);
  return Math.floor((16 * dot) / cross(points, a, b, c));
}

/**
 * @param {Int32Array} luma
 * @param {Quad} quad
 */
function slopeOf(luma, { a, b, c, d }) {
  const along = Math.abs(luma[b] - luma[c]);
  const across = Math.abs(luma[a] - luma[d]);
  if (2 * along < across) return 0;
  if (along <= across) return along < across ? 1 : 2;
  return along <= 2 * across ? 3 : 4;
}

/**
 * @param {import("./subdivision.js").HalfEdges} mesh
 * @param {number} e
 * @param {number} f
 */
function flip({ origin, twin }, e, f) {
  const acrossE = twin[prevOf(e)];
  const acrossF = twin[prevOf(f)];
  origin[e] = origin[prevOf(f)];
  origin[f] = origin[prevOf(e)];
  pair(twin, e, acrossF);
  pair(twin, f, acrossE);
  pair(twin, prevOf(e), prevOf(f));
}

/**
 * @param {Int32Array} twin
 * @param {number} e
 * @param {number} f
 */
function pair(twin, e, f) {
  twin[e] = f;
  if (f !== NO_TWIN) twin[f] = e;
}
