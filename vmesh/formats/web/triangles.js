/** Flipped and listed triangles, and their geometry: sections 8 and 10 of the specification. */

import { check } from "./errors.js";
import { canonicalOrder, cross, halfEdgesByEdge, nextOf, prevOf } from "./geometry.js";
import { Contexts } from "./rangecoder.js";

const NO_TWIN = -1;
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
 * @param {import("./rangecoder.js").RangeDecoder} decoder
 * @param {Int32Array} points
 * @param {Int32Array} triangles the canonical Delaunay triangles
 * @param {Int16Array} luma level of the first component of each vertex
 * @returns {Int32Array} the triangles after the coded flips, in canonical order
 */
export function readFlips(decoder, points, triangles, luma) {
  decoder.part = "triangles";
  const nVertices = points.length / 2;
  const mesh = { origin: triangles.slice(), twin: twinsOf(triangles, nVertices) };
  const queue = new EdgeQueue(mesh.twin);
  mesh.twin.forEach((f, e) => e < f && queue.push(e));
  const contexts = Contexts.preset(FLIPPED.flat(2).map((odds) => 2048 * odds));
  const nFirst = queue.length;
  let nFlips = 0;

  for (let nLooks = 1; queue.length > 0; nLooks++) {
    const quad = convexQuadAt(mesh, points, queue.shift());
    if (!quad) continue;
    const isFirst = nLooks <= nFirst ? 1 : 0;
    const row = isFirst * N_ANGLES + angleOf(points, quad);
    if (!decoder.bit(contexts, row * N_SLOPES + slopeOf(luma, quad))) continue;
    nFlips++;
    check(nFlips <= triangles.length, "triangles");
    const { e, f } = quad;
    flip(mesh, e, f);
    for (const side of [nextOf(e), f, nextOf(f), e]) queue.push(side);
  }
  return canonicalOrder(mesh.origin, nVertices);
}

/** The half-edge on the other side of each half-edge, or NO_TWIN on the border. */
function twinsOf(triangles, nVertices) {
  const { order, low, high } = halfEdgesByEdge(triangles, nVertices);
  const twin = new Int32Array(triangles.length).fill(NO_TWIN);
  for (let i = 1; i < order.length; i++) {
    const [e, f] = [order[i - 1], order[i]];
    if (low[e] === low[f] && high[e] === high[f]) {
      twin[e] = f;
      twin[f] = e;
    }
  }
  return twin;
}

/** First in, first out; each edge with a twin is in it no more than once. */
class EdgeQueue {
  constructor(twin) {
    this.twin = twin;
    this.ring = new Int32Array(twin.length);
    this.isQueued = new Uint8Array(twin.length);
    this.front = 0;
    this.length = 0;
  }

  push(e) {
    const f = this.twin[e];
    if (f === NO_TWIN || this.isQueued[e] || this.isQueued[f]) return;
    this.ring[(this.front + this.length) % this.ring.length] = e;
    this.isQueued[e] = 1;
    this.length++;
  }

  shift() {
    const e = this.ring[this.front];
    this.front = (this.front + 1) % this.ring.length;
    this.length--;
    this.isQueued[e] = 0;
    return e;
  }
}

/** The quad a, b, d, c around an edge b-c with b < c, or null if it is not strictly convex. */
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

function angleOf(points, { a, b, c, d }) {
  const cotangents = cotangent(points, a, b, c) + cotangent(points, d, c, b);
  return ANGLES.filter((threshold) => cotangents >= threshold).length;
}

/** Cotangent of the angle at a of the positive triangle a, b, c in sixteenths, rounded down. */
function cotangent(points, a, b, c) {
  const ax = points[2 * a];
  const ay = points[2 * a + 1];
  const dot =
    (points[2 * b] - ax) * (points[2 * c] - ax) +
    (points[2 * b + 1] - ay) * (points[2 * c + 1] - ay);
  return Math.floor((16 * dot) / cross(points, a, b, c));
}

function slopeOf(luma, { a, b, c, d }) {
  const along = Math.abs(luma[b] - luma[c]);
  const across = Math.abs(luma[a] - luma[d]);
  if (2 * along < across) return 0;
  if (along < across) return 1;
  if (along === across) return 2;
  return along <= 2 * across ? 3 : 4;
}

function flip({ origin, twin }, e, f) {
  const acrossE = twin[prevOf(e)];
  const acrossF = twin[prevOf(f)];
  origin[e] = origin[prevOf(f)];
  origin[f] = origin[prevOf(e)];
  pair(twin, e, acrossF);
  pair(twin, f, acrossE);
  pair(twin, prevOf(e), prevOf(f));
}

function pair(twin, e, f) {
  twin[e] = f;
  if (f !== NO_TWIN) twin[f] = e;
}

/**
 * @param {import("./rangecoder.js").RangeDecoder} decoder
 * @param {Int32Array} points
 * @param {number} farX
 * @param {number} farY
 * @returns {Int32Array} the listed triangles; their geometry is still to be checked
 */
export function readTriangles(decoder, points, farX, farY) {
  decoder.part = "triangles";
  const nVertices = points.length / 2;
  let nBorder = 0;
  for (let v = 0; v < nVertices; v++) {
    const [x, y] = [points[2 * v], points[2 * v + 1]];
    if (x === 0 || x === farX || y === 0 || y === farY) nBorder++;
  }
  const triangles = new Int32Array(3 * (2 * nVertices - 2 - nBorder));
  const [firsts, seconds, thirds] = [1, 2, 3].map(() => new IndexReader(decoder));
  let firstBefore = 0;
  let secondBefore = 0;
  for (let at = 0; at < triangles.length; at += 3) {
    const first = firstBefore + firsts.read();
    const second = first + 1 + seconds.read();
    const third = first + 1 + thirds.read();
    check(Math.max(second, third) < nVertices, "triangles");
    check(first > firstBefore || second > secondBefore, "triangles");
    triangles.set([first, second, third], at);
    firstBefore = first;
    secondBefore = second;
  }
  return triangles;
}

const LONGEST_INDEX = 31;

/** Reads the numbers of one kind, 0 or more. */
class IndexReader {
  constructor(decoder) {
    this.decoder = decoder;
    this.lengths = Contexts.even(LONGEST_INDEX + 1);
    // For each length the prefixes 1, 2 and 3 of the first two bits, and 0 for the rest.
    this.bits = Contexts.even(4 * (LONGEST_INDEX + 1));
  }

  read() {
    let length = 0;
    while (this.decoder.bit(this.lengths, length)) {
      length++;
      check(length <= LONGEST_INDEX, "triangles");
    }
    let value = 1;
    for (let i = 0; i < length; i++) {
      const prefix = i < 2 ? value : 0;
      value = 2 * value + this.decoder.bit(this.bits, 4 * length + prefix);
    }
    return value - 1;
  }
}

/**
 * Checks that triangles cover the canvas exactly once (section 10).
 *
 * @param {Int32Array} points
 * @param {Int32Array} triangles
 * @param {number} farX
 * @param {number} farY
 */
export function checkGeometry(points, triangles, farX, farY) {
  const isUsed = new Uint8Array(points.length / 2);
  for (const v of triangles) isUsed[v] = 1;
  check(!isUsed.includes(0), "geometry");
  checkAreas(points, triangles, 2 * farX * farY);
  checkBorder(points, triangles, farX, farY);
}

function checkAreas(points, triangles, target) {
  let sum = 0;
  for (let at = 0; at < triangles.length; at += 3) {
    const area = cross(points, triangles[at], triangles[at + 1], triangles[at + 2]);
    sum += area;
    // To stop as soon as there is too much keeps the sum exact.
    check(area > 0 && sum <= target, "geometry");
  }
  check(sum === target, "geometry");
}

/** Edges with triangles on one side only must be on a side of the canvas. */
function checkBorder(points, triangles, farX, farY) {
  const { order, low, high } = halfEdgesByEdge(triangles, points.length / 2);
  let at = 0;
  while (at < order.length) {
    const u = low[order[at]];
    const v = high[order[at]];
    let isForward = false;
    let isBackward = false;
    for (; at < order.length && low[order[at]] === u && high[order[at]] === v; at++) {
      if (triangles[order[at]] === u) isForward = true;
      else isBackward = true;
    }
    const isInner = isForward && isBackward;
    check(isInner || isOnOneSide(points, u, v, farX, farY), "geometry");
  }
}

function isOnOneSide(points, u, v, farX, farY) {
  const [ux, uy] = [points[2 * u], points[2 * u + 1]];
  const [vx, vy] = [points[2 * v], points[2 * v + 1]];
  const isUpright = ux === vx && (ux === 0 || ux === farX);
  const isLevel = uy === vy && (uy === 0 || uy === farY);
  return isUpright || isLevel;
}
