/**
 * The positions of the vertices by a kd-tree (section 6.1 of the specification): boxes are halved,
 * and the vertices in the first half counted, as in O. Devillers, P.-M. Gandoin, "Geometric
 * compression for interactive transmission", IEEE Visualization 2000.
 */

import { Contexts } from "./range_coder.js";

const FEW = 8;
const LONGEST_LOG_AREA = 39;
const MOST_BITS = 23;
const PROBABILITY_OF_SMALL_HALF = 2048;
/** For each count and middle, the probability of more vertices than that in the first half. */
const SHARES = [
  [],
  [32768],
  [43690, 16384],
  [49152, 32768, 16384],
  [52428, 35746, 20480, 13107],
  [54613, 40960, 32768, 21845, 4096],
  [56173, 54613, 37449, 22528, 18724, 2978],
  [57344, 57344, 40960, 32768, 24576, 8192, 8192],
];

/** For each logarithm of an area and each count below FEW, the probability for each middle. */
const PROBABILITIES_OF_FEW = Array.from({ length: LONGEST_LOG_AREA + 1 }, (_, logArea) => {
  return SHARES.map((shares) => probabilitiesFor(shares, logArea));
}).flat(2);

/**
 * @param {number[]} shares of a count
 * @param {number} logArea
 * @returns {number[]} one for each middle
 */
function probabilitiesFor(shares, logArea) {
  if (logArea < 2) return new Array(FEW).fill(PROBABILITY_OF_SMALL_HALF);
  return Array.from({ length: FEW }, (_, middle) => shares[middle] ?? 0);
}

/**
 * @param {import("./range_coder.js").RangeDecoder} decoder
 * @param {number} nVertices
 * @param {number} columns of the lattice
 * @param {number} rows
 * @returns {Int32Array} x and y of each vertex in raster order
 */
export function readPositions(decoder, nVertices, columns, rows) {
  decoder.part = "positions";
  const few = Contexts.preset(PROBABILITIES_OF_FEW);
  const many = Contexts.even((MOST_BITS + 1) ** 2);
  const sites = new Float64Array(nVertices);
  let nFound = 0;

  /**
   * The number of lattice sites in the box at x, y with sides 2**across and 2**down.
   *
   * @param {number} x
   * @param {number} y
   * @param {number} across
   * @param {number} down
   */
  function countSites(x, y, across, down) {
    const width = Math.min(x + (1 << across), columns) - x;
    const height = Math.min(y + (1 << down), rows) - y;
    return Math.max(0, width) * Math.max(0, height);
  }

  /**
   * Reads how many of the vertices of a box are in its first half.
   *
   * @param {number} count of the vertices of the box
   * @param {number} logArea
   * @param {number} low the fewest that may be in the first half
   * @param {number} high the most
   */
  function readFirst(count, logArea, low, high) {
    for (let depth = 0; low < high; depth++) {
      const middle = Math.floor((low + high) / 2);
      const isMore =
        count < FEW
          ? decoder.bit(few, (logArea * FEW + count) * FEW + middle)
          : decoder.bit(many, manyContext(count, depth));
      if (isMore) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /**
   * Reads `count` vertices in the box at x, y with sides 2**across and 2**down.
   *
   * @param {number} x
   * @param {number} y
   * @param {number} across
   * @param {number} down
   * @param {number} count
   */
  function visit(x, y, across, down, count) {
    if (count === 0) return;
    if (across === 0 && down === 0) {
      sites[nFound++] = y * columns + x;
      return;
    }
    let x2 = x;
    let y2 = y;
    if (across >= down) x2 += 1 << --across;
    else y2 += 1 << --down;
    const least = Math.max(0, count - countSites(x2, y2, across, down));
    const most = Math.min(count, countSites(x, y, across, down));
    const first = readFirst(count, across + down, least, most);
    visit(x, y, across, down, first);
    visit(x2, y2, across, down, count - first);
  }

  visit(0, 0, bitLength(columns - 1), bitLength(rows - 1), nVertices);
  return rasterOrder(sites, columns);
}

/**
 * @param {Float64Array} sites numbers of places, row by row; they are sorted
 * @param {number} columns
 */
function rasterOrder(sites, columns) {
  sites.sort();
  const points = new Int32Array(2 * sites.length);
  sites.forEach((site, v) => {
    points[2 * v] = site % columns;
    points[2 * v + 1] = Math.floor(site / columns);
  });
  return points;
}

/** @param {number} number */
function bitLength(number) {
  return 32 - Math.clz32(number);
}

/**
 * @param {number} count of the vertices of a box
 * @param {number} depth how many bits were read of the number in its first half
 */
function manyContext(count, depth) {
  const log = bitLength(count) - 1;
  return Math.min(log, MOST_BITS) * (MOST_BITS + 1) + Math.min(depth, MOST_BITS);
}
