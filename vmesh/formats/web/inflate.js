/**
 * Inflates a zlib stream (RFC 1950 and 1951). Browsers have no synchronous call for this. Codes
 * are walked bit by bit, which is slow but short; metadata are small.
 */

import { check } from "./errors.js";

const LENGTH_BASE = [
  3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 15, 17, 19, 23, 27, 31, 35, 43, 51, 59, 67, 83, 99, 115, 131,
  163, 195, 227, 258,
];
const LENGTH_EXTRA = [
  0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0,
];
const DISTANCE_BASE = [
  1, 2, 3, 4, 5, 7, 9, 13, 17, 25, 33, 49, 65, 97, 129, 193, 257, 385, 513, 769, 1025, 1537, 2049,
  3073, 4097, 6145, 8193, 12289, 16385, 24577,
];
const DISTANCE_EXTRA = [
  0, 0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8, 8, 9, 9, 10, 10, 11, 11, 12, 12, 13, 13,
];
const CODE_LENGTH_ORDER = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];
const LONGEST_CODE = 15;
const END_OF_BLOCK = 256;

/** Bits from the lowest of each byte on; what is missing makes the metadata invalid. */
class BitReader {
  constructor(bytes) {
    this.bytes = bytes;
    this.position = 0;
    this.buffer = 0;
    this.nBuffered = 0;
  }

  bits(n) {
    while (this.nBuffered < n) {
      check(this.position < this.bytes.length, "metadata");
      this.buffer |= this.bytes[this.position++] << this.nBuffered;
      this.nBuffered += 8;
    }
    const value = this.buffer & ((1 << n) - 1);
    this.buffer >>>= n;
    this.nBuffered -= n;
    return value;
  }

  skipToByte() {
    this.buffer = 0;
    this.nBuffered = 0;
  }
}

/** Bytes that grow up to a limit. */
class Output {
  constructor(limit) {
    this.limit = limit;
    this.bytes = new Uint8Array(Math.min(limit, 1024));
    this.length = 0;
  }

  push(byte) {
    if (this.length === this.bytes.length) this.grow();
    this.bytes[this.length++] = byte;
  }

  grow() {
    check(this.length < this.limit, "limit");
    const grown = new Uint8Array(Math.min(2 * this.length, this.limit));
    grown.set(this.bytes);
    this.bytes = grown;
  }

  repeat(distance, length) {
    check(distance <= this.length, "metadata");
    for (let i = 0; i < length; i++) this.push(this.bytes[this.length - distance]);
  }
}

/** A canonical Huffman code: how many symbols have each length, and the symbols in order. */
class HuffmanCode {
  constructor(lengths) {
    this.counts = new Uint16Array(LONGEST_CODE + 1);
    for (const length of lengths) this.counts[length]++;
    this.counts[0] = 0;
    const next = new Uint16Array(LONGEST_CODE + 2);
    for (let length = 1; length <= LONGEST_CODE; length++) {
      next[length + 1] = next[length] + this.counts[length];
    }
    this.symbols = new Uint16Array(next[LONGEST_CODE + 1]);
    lengths.forEach((length, symbol) => {
      if (length > 0) this.symbols[next[length]++] = symbol;
    });
  }

  /** Like zlib: no code is oversubscribed, and none leaves bits unused but one of one symbol. */
  checkComplete(mayBeSingle) {
    let unused = 1;
    for (let length = 1; length <= LONGEST_CODE; length++) {
      unused = 2 * unused - this.counts[length];
      check(unused >= 0, "metadata");
    }
    const isSingle = this.symbols.length <= 1 && this.symbols.length === this.counts[1];
    check(unused === 0 || (mayBeSingle && isSingle), "metadata");
  }

  read(reader) {
    let code = 0;
    let first = 0;
    let index = 0;
    for (let length = 1; length <= LONGEST_CODE; length++) {
      code = 2 * code + reader.bits(1);
      const count = this.counts[length];
      if (code < first + count) return this.symbols[index + code - first];
      index += count;
      first = 2 * (first + count);
    }
    return check(false, "metadata");
  }
}

function makeFixedCodes() {
  const literals = new Array(288).fill(8);
  literals.fill(9, 144, 256);
  literals.fill(7, 256, 280);
  const distances = new Array(32).fill(5);
  return { literals: new HuffmanCode(literals), distances: new HuffmanCode(distances) };
}

const FIXED_CODES = makeFixedCodes();

function readCodes(reader) {
  const nLiterals = reader.bits(5) + 257;
  const nDistances = reader.bits(5) + 1;
  const nCodeLengths = reader.bits(4) + 4;
  check(nLiterals <= 286 && nDistances <= 30, "metadata");
  const codeLengths = new Array(19).fill(0);
  for (let i = 0; i < nCodeLengths; i++) codeLengths[CODE_LENGTH_ORDER[i]] = reader.bits(3);
  const lengthCode = new HuffmanCode(codeLengths);
  lengthCode.checkComplete(false);

  const lengths = readCodeLengths(reader, lengthCode, nLiterals + nDistances);
  check(lengths[END_OF_BLOCK] > 0, "metadata");
  const literals = new HuffmanCode(lengths.slice(0, nLiterals));
  const distances = new HuffmanCode(lengths.slice(nLiterals));
  literals.checkComplete(true);
  distances.checkComplete(true);
  return { literals, distances };
}

function readCodeLengths(reader, lengthCode, n) {
  const lengths = [];
  const repeat = (length, times) => {
    for (let i = 0; i < times; i++) lengths.push(length);
  };
  while (lengths.length < n) {
    const symbol = lengthCode.read(reader);
    if (symbol < 16) {
      lengths.push(symbol);
    } else if (symbol === 16) {
      check(lengths.length > 0, "metadata");
      repeat(lengths[lengths.length - 1], 3 + reader.bits(2));
    } else {
      repeat(0, symbol === 17 ? 3 + reader.bits(3) : 11 + reader.bits(7));
    }
  }
  check(lengths.length === n, "metadata");
  return lengths;
}

function inflateCodes(reader, output, { literals, distances }) {
  for (;;) {
    const symbol = literals.read(reader);
    if (symbol === END_OF_BLOCK) return;
    if (symbol < END_OF_BLOCK) {
      output.push(symbol);
      continue;
    }
    const i = symbol - END_OF_BLOCK - 1;
    check(i < LENGTH_BASE.length, "metadata");
    const length = LENGTH_BASE[i] + reader.bits(LENGTH_EXTRA[i]);
    const j = distances.read(reader);
    check(j < DISTANCE_BASE.length, "metadata");
    output.repeat(DISTANCE_BASE[j] + reader.bits(DISTANCE_EXTRA[j]), length);
  }
}

function inflateStored(reader, output) {
  reader.skipToByte();
  const length = reader.bits(16);
  check((length ^ reader.bits(16)) === 0xffff, "metadata");
  for (let i = 0; i < length; i++) output.push(reader.bits(8));
}

function inflateBlocks(reader, output) {
  let isLast;
  do {
    isLast = reader.bits(1);
    const type = reader.bits(2);
    check(type < 3, "metadata");
    if (type === 0) inflateStored(reader, output);
    else inflateCodes(reader, output, type === 1 ? FIXED_CODES : readCodes(reader));
  } while (!isLast);
}

function adler32(bytes) {
  let a = 1;
  let b = 0;
  for (const byte of bytes) {
    a = (a + byte) % 65521;
    b = (b + a) % 65521;
  }
  return b * 65536 + a;
}

/**
 * @param {Uint8Array} stream one complete zlib stream and nothing else
 * @param {number} limit of the bytes it may inflate to; more throws "limit"
 * @returns {Uint8Array} at least one byte; anything else throws "metadata"
 */
export function inflate(stream, limit) {
  const reader = new BitReader(stream);
  const [method, flags] = [reader.bits(8), reader.bits(8)];
  const hasDictionary = (flags & 32) !== 0;
  check((method & 15) === 8 && method >> 4 <= 7, "metadata");
  check((256 * method + flags) % 31 === 0 && !hasDictionary, "metadata");

  const output = new Output(limit);
  inflateBlocks(reader, output);
  reader.skipToByte();
  const content = output.bytes.slice(0, output.length);
  let checksum = 0;
  for (let i = 0; i < 4; i++) checksum = 256 * checksum + reader.bits(8);
  check(checksum === adler32(content), "metadata");
  check(reader.position === stream.length && content.length > 0, "metadata");
  return content;
}
