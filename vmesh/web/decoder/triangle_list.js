/** Listed triangles: section 8.3 of the specification. */

import { check } from "./errors.js";
import { Contexts } from "./range_coder.js";

const LONGEST_INDEX = 31;

/**
 * @param {import("./range_coder.js").RangeDecoder} decoder
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
  #decoder;
  #lengths = Contexts.even(LONGEST_INDEX + 1);
  // For each length the prefixes 1, 2 and 3 of the first two bits, and 0 for the rest.
  #bits = Contexts.even(4 * (LONGEST_INDEX + 1));

  /** @param {import("./range_coder.js").RangeDecoder} decoder */
  constructor(decoder) {
    this.#decoder = decoder;
  }

  read() {
    let length = 0;
    while (this.#decoder.bit(this.#lengths, length)) {
      length++;
      check(length <= LONGEST_INDEX, "triangles");
    }
    let value = 1;
    for (let i = 0; i < length; i++) {
      const prefix = i < 2 ? value : 0;
      value = 2 * value + this.#decoder.bit(this.#bits, 4 * length + prefix);
    }
    return value - 1;
  }
}
