/** Listed triangles and the check of their geometry: sections 8.3 and 10 of the specification. */

import { check } from "./errors.js";
import { cross, nextOf } from "./geometry.js";
import { Contexts } from "./rangecoder.js";

const LONGEST_INDEX = 31;

/**
 * @param {import("./rangecoder.js").RangeDecoder} decoder
 * @param {Uint8Array} sides of the canvas that each vertex is on
 * @returns {Int32Array} the listed triangles; their geometry is still to be checked
 */
export function readTriangles(decoder, sides) {
  decoder.part = "triangles";
  const nBorder = sides.filter((own) => own > 0).length;
  const triangles = new Int32Array(3 * (2 * sides.length - 2 - nBorder));
  const [firsts, seconds, thirds] = [1, 2, 3].map(() => new IndexReader(decoder));
  let firstBefore = 0;
  let secondBefore = 0;
  for (let at = 0; at < triangles.length; at += 3) {
    const first = firstBefore + firsts.read();
    const second = first + 1 + seconds.read();
    const third = first + 1 + thirds.read();
    check(Math.max(second, third) < sides.length, "triangles");
    check(first > firstBefore || second > secondBefore, "triangles");
    triangles.set([first, second, third], at);
    firstBefore = first;
    secondBefore = second;
  }
  return triangles;
}

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

/** Checks that triangles cover a canvas of this doubled area exactly once. */
export function checkGeometry(points, triangles, sides, doubledArea) {
  checkAreas(points, triangles, doubledArea);
  checkEdges(triangles, sides);
  const isUsed = new Uint8Array(sides.length);
  for (const v of triangles) isUsed[v] = 1;
  check(!isUsed.includes(0), "geometry");
}

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

/** Edges without a triangle on either side must be on a side of the canvas. */
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
