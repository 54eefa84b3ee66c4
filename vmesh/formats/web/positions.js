/** The positions of the vertices: section 6.1 of the specification. */

import { Contexts } from "./rangecoder.js";

const FEW = 8;
const LONGEST_LOG_AREA = 39;
const MOST_BITS = 23;
const ODDS_OF_SMALL_HALF = 2048;

/**
 * @param {import("./rangecoder.js").RangeDecoder} decoder
 * @param {number} nVertices
 * @param {number} columns of the lattice
 * @param {number} rows
 * @returns {Int32Array} x and y of each vertex in raster order
 */
export function readPositions(decoder, nVertices, columns, rows) {
  decoder.part = "positions";
  const counts = new CountReader(decoder);
  const sites = new Float64Array(nVertices);
  let nFound = 0;

  function room(x, y, across, down) {
    const width = Math.min(x + 2 ** across, columns) - x;
    const height = Math.min(y + 2 ** down, rows) - y;
    return Math.max(0, width) * Math.max(0, height);
  }

  /** Reads `count` vertices in the box at x, y with sides 2**across and 2**down. */
  function visit(x, y, across, down, count) {
    if (count === 0) return;
    if (across === 0 && down === 0) {
      sites[nFound++] = y * columns + x;
      return;
    }
    let x2 = x;
    let y2 = y;
    if (across >= down) x2 += 2 ** --across;
    else y2 += 2 ** --down;
    const least = Math.max(0, count - room(x2, y2, across, down));
    const most = Math.min(count, room(x, y, across, down));
    const first = counts.read(count, across + down, least, most);
    visit(x, y, across, down, first);
    visit(x2, y2, across, down, count - first);
  }

  visit(0, 0, bitLength(columns - 1), bitLength(rows - 1), nVertices);
  return rasterOrder(sites, columns);
}

function rasterOrder(sites, columns) {
  sites.sort();
  const points = new Int32Array(2 * sites.length);
  sites.forEach((site, v) => {
    points[2 * v] = site % columns;
    points[2 * v + 1] = Math.floor(site / columns);
  });
  return points;
}

function bitLength(number) {
  return 32 - Math.clz32(number);
}

/** Reads how many of the vertices of a box are in its first half. */
class CountReader {
  constructor(decoder) {
    this.decoder = decoder;
    this.few = fewContexts();
    this.many = Contexts.even((MOST_BITS + 1) ** 2);
  }

  read(count, logArea, low, high) {
    for (let depth = 0; low < high; depth++) {
      const middle = Math.floor((low + high) / 2);
      const isMore =
        count < FEW
          ? this.decoder.bit(this.few, fewContext(logArea, count, middle))
          : this.decoder.bit(this.many, manyContext(count, depth));
      if (isMore) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}

function fewContext(logArea, count, middle) {
  return (Math.min(logArea, LONGEST_LOG_AREA) * FEW + count) * FEW + middle;
}

function manyContext(count, depth) {
  const log = bitLength(count) - 1;
  return Math.min(log, MOST_BITS) * (MOST_BITS + 1) + Math.min(depth, MOST_BITS);
}

function fewContexts() {
  const odds = new Array((LONGEST_LOG_AREA + 1) * FEW * FEW).fill(0);
  for (let count = 1; count < FEW; count++) {
    for (let middle = 0; middle < count; middle++) {
      const share = binomialShare(count, middle);
      for (let logArea = 0; logArea <= LONGEST_LOG_AREA; logArea++) {
        odds[fewContext(logArea, count, middle)] = logArea < 2 ? ODDS_OF_SMALL_HALF : share;
      }
    }
  }
  return Contexts.preset(odds);
}

/** Share of the counts above a middle of the bisection of 0 to `count`, in units of 2**-16. */
function binomialShare(count, middle) {
  let low = 0;
  let high = count;
  for (let mean = count >> 1; mean !== middle; mean = (low + high) >> 1) {
    if (mean < middle) low = mean + 1;
    else high = mean;
  }
  const above = binomialSum(count, middle + 1, high);
  return Math.floor((65536 * above) / binomialSum(count, low, high));
}

/** Sum of the binomial coefficients (count over k) for k from `first` to `last`. */
function binomialSum(count, first, last) {
  let coefficient = 1;
  let sum = 0;
  for (let k = 0; k <= last; k++) {
    if (k >= first) sum += coefficient;
    coefficient = (coefficient * (count - k)) / (k + 1);
  }
  return sum;
}
