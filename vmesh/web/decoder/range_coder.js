/** The adaptive binary range decoder of section 5 of the specification. */

import { check } from "./errors.js";

const EVEN = 32768;
const LEAST = 64;
const MOST = 65472;
const MOST_SEEN = 250;
const SEEN_AT_START = 16;
const BYTES_AHEAD = 4;

/** A table of contexts: the probability of a 1 in units of 2**-16, and how many bits each saw. */
export class Contexts {
  /**
   * @param {Uint16Array} probabilities
   * @param {Uint8Array} seen
   */
  constructor(probabilities, seen) {
    this.probabilities = probabilities;
    this.seen = seen;
  }

  /** @param {number} n contexts that have seen nothing yet */
  static even(n) {
    return new Contexts(new Uint16Array(n).fill(EVEN), new Uint8Array(n));
  }

  /** @param {number[]} probabilities at the start, one for each context */
  static preset(probabilities) {
    const seen = new Uint8Array(probabilities.length).fill(SEEN_AT_START);
    return new Contexts(Uint16Array.from(probabilities), seen);
  }
}

export class RangeDecoder {
  #content;
  #position = 0;
  // The range may be 2**32, so that both are doubles that hold integers.
  #range = 2 ** 32;
  #code = 0;

  /** @param {Uint8Array} content of the chunk `M` */
  constructor(content) {
    this.#content = content;
    /**
     * What is being decoded: the code of the error if the content ends.
     *
     * @type {import("./errors.js").ErrorCode}
     */
    this.part = "positions";
    for (let i = 0; i < BYTES_AHEAD; i++) this.#code = 256 * this.#code + this.#nextByte();
  }

  #nextByte() {
    const at = this.#position++;
    if (at < this.#content.length) return this.#content[at];
    check(at < this.#content.length + BYTES_AHEAD, this.part);
    return 0;
  }

  /**
   * @param {Contexts} contexts
   * @param {number} i the context within the table
   * @returns {0 | 1}
   */
  bit(contexts, i) {
    const p = contexts.probabilities[i];
    const n = contexts.seen[i];
    const split = Math.floor(this.#range / 4096) * (p >> 4);
    const bit = this.#code < split ? 1 : 0;
    if (bit) {
      this.#range = split;
    } else {
      this.#range -= split;
      this.#code -= split;
    }
    const moved = p + Math.floor((65536 * bit - p) / (n + 2));
    contexts.probabilities[i] = Math.min(Math.max(moved, LEAST), MOST);
    if (n < MOST_SEEN) contexts.seen[i] = n + 1;
    while (this.#range < 2 ** 24) {
      this.#range *= 256;
      this.#code = 256 * this.#code + this.#nextByte();
    }
    return bit;
  }

  /** Everything is decoded: no byte may be left. */
  end() {
    check(this.#position >= this.#content.length, this.part);
  }
}
