/** The colours of the vertices: section 7 of the specification. */

import { check } from "./errors.js";
import { Contexts } from "./rangecoder.js";

const MOST_TRIANGLES = 8;
/** A vertex on the border of the canvas has one neighbour more than triangles. */
const MOST_PARENTS = MOST_TRIANGLES + 1;
const FULL_WEIGHT = 4096;
const SPREADS = [11, 64, 214, 576, 1388, 3136, 6808, 14400, 29936, 61504, 125346, 254016];
const N_SPREADS = SPREADS.length + 2;
const SPREAD_WITHOUT_PARENTS = N_SPREADS - 1;
const MOST_UNARY = 14;
const LONGEST_REST = 16;
const MORE_THAN = [
  [
    [20, 25, 23, 26, 27, 27, 28, 29, 30, 31, 31, 31, 31, 31],
    [19, 25, 19, 18, 21, 22, 24, 26, 29, 30, 30, 31, 31, 31],
    [18, 25, 20, 22, 20, 18, 19, 21, 24, 26, 28, 30, 31, 25],
  ],
  [
    [2, 1, 5, 12, 15, 19, 23, 26, 28, 29, 28, 25, 19, 5],
    [8, 5, 4, 3, 6, 11, 17, 23, 25, 28, 27, 22, 17, 10],
    [15, 10, 15, 13, 14, 13, 16, 18, 22, 24, 27, 27, 27, 6],
  ],
];

/**
 * The vertices in the order in which their colours are coded, and the parents of each.
 * @typedef {object} Hierarchy
 * @property {Int32Array} order vertex numbers
 * @property {Uint8Array} nParents of each place in the order
 * @property {Int32Array} parents a row of MOST_PARENTS for each place in the order
 */

/**
 * Thins the triangulation layer by layer (section 7.2). A layer's vertices are no neighbours, so
 * to remove one after the other gives the Delaunay triangulation of the others.
 *
 * @param {import("./delaunay.js").Triangulation} triangulation is used up: four corners are left
 * @param {number} farX
 * @param {number} farY
 * @returns {Hierarchy}
 */
function hierarchyOf(triangulation, farX, farY) {
  const { points } = triangulation;
  const n = points.length / 2;
  const hierarchy = {
    order: new Int32Array(n),
    nParents: new Uint8Array(n),
    parents: new Int32Array(MOST_PARENTS * n),
  };
  const isTaken = new Uint8Array(n);
  let left = Int32Array.from({ length: n }, (_, v) => v);
  while (left.length > 4) {
    const layer = left.filter((v) => {
      const isX = points[2 * v] === 0 || points[2 * v] === farX;
      const isY = points[2 * v + 1] === 0 || points[2 * v + 1] === farY;
      const isCorner = isX && isY;
      isTaken[v] = !isCorner && mayBeTaken(triangulation, v, isTaken);
      return isTaken[v];
    });
    // The layer that is taken first comes last.
    let place = left.length - layer.length;
    for (const v of layer) placeVertex(hierarchy, place++, v, neighboursOf(triangulation, v));
    for (const v of layer) triangulation.remove(v);
    left = left.filter((v) => !isTaken[v]);
  }
  left.forEach((v, i) => placeVertex(hierarchy, i, v, left.subarray(Math.max(i - 1, 0), i)));
  return hierarchy;
}

/** Whether a vertex has few enough triangles, and no neighbour of it has been taken. */
function mayBeTaken(triangulation, v, isTaken) {
  let nTriangles = 0;
  for (const e of triangulation.edgesAround(v)) {
    if (isTaken[triangulation.destOf(e)]) return false;
    if (triangulation.hasTriangle(e)) nTriangles++;
    if (nTriangles > MOST_TRIANGLES) return false;
  }
  return true;
}

function neighboursOf(triangulation, v) {
  return triangulation.edgesAround(v).map((e) => triangulation.destOf(e));
}

function placeVertex(hierarchy, place, v, parents) {
  hierarchy.order[place] = v;
  hierarchy.nParents[place] = parents.length;
  hierarchy.parents.set(parents, MOST_PARENTS * place);
}

/**
 * @param {import("./rangecoder.js").RangeDecoder} decoder
 * @param {import("./delaunay.js").Triangulation} triangulation the implied one; it is used up
 * @param {Uint8Array} steps one for each component
 * @param {number} farX
 * @param {number} farY
 * @returns {Int32Array} the levels of each vertex in turn
 */
export function readLevels(decoder, triangulation, steps, depth, farX, farY) {
  decoder.part = "colors";
  const { order, nParents, parents } = hierarchyOf(triangulation, farX, farY);
  const nComponents = steps.length;
  const levels = new Int32Array(order.length * nComponents);
  const readers = Array.from(steps, (step, component) => new LevelReader(decoder, component, Math.ceil((2 ** depth - 1) / step)));
  const weights = new Float64Array(MOST_PARENTS);
  const known = new Float64Array(MOST_PARENTS);

  order.forEach((v, place) => {
    const own = v * nComponents;
    const n = nParents[place];
    for (let component = 0; component < nComponents; component++) {
      for (let i = 0; i < n; i++) {
        const parent = parents[MOST_PARENTS * place + i] * nComponents;
        const difference = component === 0 ? 0 : Math.abs(levels[parent] - levels[own]);
        weights[i] = Math.max(Math.floor(FULL_WEIGHT / (1 + 2 * difference)), 1);
        known[i] = levels[parent + component];
      }
      levels[own + component] = readers[component].read(predict(weights, known, n));
    }
  });
  return levels;
}

/** Prediction, spread and lean from the levels of n parents and their weights. */
function predict(weights, known, n) {
  if (n === 0) return { prediction: 0, spread: SPREAD_WITHOUT_PARENTS, lean: 0 };
  let w = 0;
  let t = 0;
  for (let i = 0; i < n; i++) {
    w += weights[i];
    t += weights[i] * known[i];
  }
  const prediction = Math.floor((2 * t + w) / (2 * w));
  const rest = 20 * (t - prediction * w);
  const lean = rest > 3 * w ? 1 : rest < -3 * w ? 2 : 0;
  return { prediction, spread: spreadOf(weights, known, n, w, prediction), lean };
}

/**
 * How many thresholds the variance reaches. No quotient is needed: floor(a / b) reaches an integer
 * if a reaches b times it. Both sides are exact: W is at most 9 * 4096 and a deviation at most 511,
 * so S * W and D * D are at most (9 * 4096 * 511)**2 < 2**49, as is their difference; 1024 is a
 * power of two, and the largest threshold times W * W is below 2**49.
 */
function spreadOf(weights, known, n, w, prediction) {
  let d = 0;
  let s = 0;
  for (let i = 0; i < n; i++) {
    const deviation = Math.min(Math.max(known[i] - prediction, -511), 511);
    d += weights[i] * deviation;
    s += weights[i] * deviation * deviation;
  }
  const numerator = 1024 * (s * w - d * d);
  let spread = 0;
  while (spread < SPREADS.length && numerator >= SPREADS[spread] * (w * w)) spread++;
  return spread;
}

/** Reads the levels of one component. */
class LevelReader {
  constructor(decoder, component, highest) {
    this.decoder = decoder;
    this.highest = highest;
    this.lowest = component === 1 || component === 2 ? -this.highest : 0;
    this.sizes = sizeContexts(component);
    this.lengths = Contexts.even(N_SPREADS);
    this.bits = Contexts.even(N_SPREADS);
    this.signs = Contexts.even(3);
  }

  read({ prediction, spread, lean }) {
    const size = this.readSize(spread);
    const isNegative = size > 0 && this.decoder.bit(this.signs, lean);
    const level = isNegative ? prediction - size : prediction + size;
    check(this.lowest <= level && level <= this.highest, "colors");
    return level;
  }

  readSize(spread) {
    for (let size = 0; size < MOST_UNARY; size++) {
      if (!this.decoder.bit(this.sizes, spread * MOST_UNARY + size)) return size;
    }
    let length = 0;
    while (this.decoder.bit(this.lengths, spread)) {
      length++;
      check(length <= LONGEST_REST, "colors");
    }
    let value = 1;
    for (let i = 0; i < length; i++) value = 2 * value + this.decoder.bit(this.bits, spread);
    return MOST_UNARY - 1 + value;
  }
}

function sizeContexts(component) {
  const rows = MORE_THAN[Math.min(component, 1)];
  const odds = [];
  for (let spread = 0; spread < N_SPREADS; spread++) {
    for (let size = 0; size < MOST_UNARY; size++) odds.push(2048 * rows[Math.min(size, 2)][spread]);
  }
  return Contexts.preset(odds);
}

/**
 * @param {Int32Array} levels
 * @param {number[]} steps
 * @param {number} depth
 * @returns {Uint8ClampedArray | Uint16Array} the samples of each vertex in turn (section 7.5)
 */
export function samplesOf(levels, steps, depth) {
  const n = steps.length;
  const values = levels.map((level, at) => level * steps[at % n]);
  for (let at = 0; n >= 3 && at < levels.length; at += n) {
    const [luma, orange, green] = values.subarray(at, at + 3);
    const middle = luma - (green >> 1);
    const blue = middle - (orange >> 1);
    values[at] = blue + orange;
    values[at + 1] = green + middle;
    values[at + 2] = blue;
  }
  const clipped = values.map((value) => Math.min(Math.max(value, 0), 2 ** depth - 1));
  return depth === 8 ? Uint8Array.from(clipped) : Uint16Array.from(clipped);
}
