/** The colours of the vertices: section 7 of the specification. */

import { check } from "./errors.js";
import { MOST_PARENTS, NO_PARENT, hierarchyOf } from "./hierarchy.js";
import { Contexts } from "./range_coder.js";

const FULL_WEIGHT = 4096;
const MOST_DEVIATION = 511;
const SPREADS = [11, 64, 214, 576, 1388, 3136, 6808, 14400, 29936, 61504, 125346, 254016];
const N_SPREADS = SPREADS.length + 2;
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
 * @param {import("./range_coder.js").RangeDecoder} decoder
 * @param {import("./delaunay.js").Triangulation} triangulation the implied one; it is used up
 * @param {Uint8Array} sides of the canvas that each vertex is on
 * @param {{steps: number[], depth: number}} header
 * @returns {Int32Array} the levels of each vertex in turn
 */
export function readLevels(decoder, triangulation, sides, { steps, depth }) {
  decoder.part = "colors";
  const { order, parents } = hierarchyOf(triangulation, sides);
  const nComponents = steps.length;
  const levels = new Int32Array(order.length * nComponents);
  const readers = steps.map((step, component) => {
    return new LevelReader(decoder, component, Math.ceil((2 ** depth - 1) / step));
  });
  const weights = new Float64Array(MOST_PARENTS);
  const known = new Float64Array(MOST_PARENTS);

  for (const v of order) {
    const own = v * nComponents;
    for (let component = 0; component < nComponents; component++) {
      let n = 0;
      for (; n < MOST_PARENTS && parents[MOST_PARENTS * v + n] !== NO_PARENT; n++) {
        const parent = parents[MOST_PARENTS * v + n] * nComponents;
        weights[n] = component === 0 ? FULL_WEIGHT : weightOf(levels[parent] - levels[own]);
        known[n] = levels[parent + component];
      }
      levels[own + component] = readers[component].read(predict(weights, known, n));
    }
  }
  return levels;
}

/** @param {number} difference of the first components of two vertices */
function weightOf(difference) {
  return Math.max(Math.floor(FULL_WEIGHT / (1 + 2 * Math.abs(difference))), 1);
}

/**
 * What is expected of a level; spread and lean choose the contexts.
 *
 * @typedef {object} Expectation
 * @property {number} prediction
 * @property {number} spread
 * @property {number} lean
 */

/**
 * The expectation from the levels of n parents and their weights.
 *
 * @param {Float64Array} weights
 * @param {Float64Array} known levels
 * @param {number} n
 * @returns {Expectation}
 */
function predict(weights, known, n) {
  if (n === 0) return { prediction: 0, spread: N_SPREADS - 1, lean: 0 };
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
 * How many thresholds the variance reaches. No quotient is needed: the floor of a / b reaches an
 * integer if a reaches b times it. All is exact: W is at most 9 * 4096 and a deviation at most 511,
 * so S * W and D * D are at most (9 * 4096 * 511)**2 < 2**49, as is their difference; 1024 is a
 * power of two; and the largest threshold times W * W is below 2**49.
 *
 * @param {Float64Array} weights
 * @param {Float64Array} known levels
 * @param {number} n
 * @param {number} w sum of the weights
 * @param {number} prediction
 */
function spreadOf(weights, known, n, w, prediction) {
  let d = 0;
  let s = 0;
  for (let i = 0; i < n; i++) {
    const deviation = clamp(known[i] - prediction, -MOST_DEVIATION, MOST_DEVIATION);
    d += weights[i] * deviation;
    s += weights[i] * deviation * deviation;
  }
  const numerator = 1024 * (s * w - d * d);
  let spread = 0;
  while (spread < SPREADS.length && numerator >= SPREADS[spread] * (w * w)) spread++;
  return spread;
}

/**
 * @param {number} value
 * @param {number} least
 * @param {number} most
 */
function clamp(value, least, most) {
  return Math.min(Math.max(value, least), most);
}

/** Reads the levels of one component. */
class LevelReader {
  #decoder;
  #highest;
  #lowest;
  #sizes;
  #lengths = Contexts.even(N_SPREADS);
  #bits = Contexts.even(N_SPREADS);
  #signs = Contexts.even(3);

  /**
   * @param {import("./range_coder.js").RangeDecoder} decoder
   * @param {number} component
   * @param {number} highest level
   */
  constructor(decoder, component, highest) {
    this.#decoder = decoder;
    this.#highest = highest;
    this.#lowest = component === 1 || component === 2 ? -highest : 0;
    this.#sizes = sizeContexts(MORE_THAN[Math.min(component, 1)]);
  }

  /** @param {Expectation} expectation */
  read({ prediction, spread, lean }) {
    const size = this.#readSize(spread);
    const isNegative = size > 0 && this.#decoder.bit(this.#signs, lean);
    const level = isNegative ? prediction - size : prediction + size;
    check(this.#lowest <= level && level <= this.#highest, "colors");
    return level;
  }

  /** @param {number} spread */
  #readSize(spread) {
    for (let size = 0; size < MOST_UNARY; size++) {
      if (!this.#decoder.bit(this.#sizes, spread * MOST_UNARY + size)) return size;
    }
    let length = 0;
    while (this.#decoder.bit(this.#lengths, spread)) {
      length++;
      check(length <= LONGEST_REST, "colors");
    }
    let value = 1;
    for (let i = 0; i < length; i++) value = 2 * value + this.#decoder.bit(this.#bits, spread);
    return MOST_UNARY - 1 + value;
  }
}

/**
 * Contexts of the bits in unary: for each spread MOST_UNARY, the last ones with the same start.
 *
 * @param {number[][]} moreThan of a component
 */
function sizeContexts(moreThan) {
  const columns = Array.from({ length: MOST_UNARY }, (_, size) => moreThan[Math.min(size, 2)]);
  const rows = moreThan[0].map((_, spread) => columns.map((column) => 2048 * column[spread]));
  return Contexts.preset(rows.flat());
}

/**
 * @param {Int32Array} levels of each vertex in turn
 * @param {{steps: number[], depth: number}} header
 * @returns {Uint8Array | Uint16Array} the samples of each vertex in turn (section 7.5)
 */
export function samplesOf(levels, { steps, depth }) {
  const n = steps.length;
  const largest = 2 ** depth - 1;
  const values = levels.map((level, at) => level * steps[at % n]);
  for (let at = 0; n >= 3 && at < levels.length; at += n) {
    const middle = values[at] - (values[at + 2] >> 1);
    const blue = middle - (values[at + 1] >> 1);
    values[at] = blue + values[at + 1];
    values[at + 1] = values[at + 2] + middle;
    values[at + 2] = blue;
  }
  const samples = depth === 8 ? new Uint8Array(values.length) : new Uint16Array(values.length);
  for (let at = 0; at < values.length; at++) samples[at] = clamp(values[at], 0, largest);
  return samples;
}
