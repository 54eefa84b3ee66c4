/** Signature, header and chunks of a file: sections 3 and 4 of the specification. */

import { VmeshError, check } from "./errors.js";

const SIGNATURE = [0x8b, 0x56, 0x4d, 0x0d, 0x0a];
const MAJOR_VERSION = 1;
/** Chunks of these tags occur once at most. */
export const METADATA_TAGS = "iex";
const LEVELS_PER_BYTE = 5700;

const CRC_TABLE = Uint32Array.from({ length: 256 }, (_, byte) => {
  let crc = byte;
  for (let bit = 0; bit < 8; bit++) crc = crc & 1 ? (crc >>> 1) ^ 0xedb88320 : crc >>> 1;
  return crc;
});

function crc32(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = CRC_TABLE[(crc ^ byte) & 255] ^ (crc >>> 8);
  return ~crc >>> 0;
}

/** Reads the fields of a file one after the other; what is missing is "truncated". */
class Reader {
  constructor(bytes) {
    this.bytes = bytes;
    this.position = 0;
  }

  atEnd() {
    return this.position === this.bytes.length;
  }

  take(length) {
    const end = this.position + length;
    check(end <= this.bytes.length, "truncated");
    const taken = this.bytes.subarray(this.position, end);
    this.position = end;
    return taken;
  }

  byte() {
    return this.take(1)[0];
  }

  /** A number below 2**31 in its shortest form; `code` is the error of any other. */
  varint(code) {
    let number = 0;
    for (let i = 0; i < 5; i++) {
      const byte = this.byte();
      number += (byte % 128) * 2 ** (7 * i);
      if (byte < 128) {
        check(number < 2 ** 31 && (byte > 0 || i === 0), code);
        return number;
      }
    }
    throw new VmeshError(code);
  }

  /** Reads the CRC-32 of the bytes from `start` to here. */
  checksum(start) {
    const covered = this.bytes.subarray(start, this.position);
    const [b0, b1, b2, b3] = this.take(4);
    const stored = (b0 | (b1 << 8) | (b2 << 16) | (b3 << 24)) >>> 0;
    check(stored === crc32(covered), "checksum");
  }
}

/**
 * @typedef {object} Header
 * @property {number} width canvas in pixels
 * @property {number} height
 * @property {number} subdivision a pixel is 2**subdivision lattice units wide
 * @property {number} connectivity 0 implied, 1 listed, 2 flipped triangles
 * @property {number} nVertices
 * @property {number[]} steps one for each colour component
 * @property {number} depth bits of a sample, 8 to 16
 * @property {number} farX x of the right border of the canvas, in lattice units
 * @property {number} farY y of the lower border
 */

/** @returns {Header} */
function readHeader(reader) {
  for (const expected of SIGNATURE) check(reader.byte() === expected, "signature");
  check(reader.byte() >> 4 === MAJOR_VERSION, "version");
  const format = reader.byte();
  const isDeep = (format & 3) === 1;
  const components = isDeep ? reader.byte() : format & 3;
  const width = reader.varint("header");
  const height = reader.varint("header");
  const nVertices = reader.varint("header");
  const nComponents = (components & 3) + 1;
  const steps = Array.from({ length: nComponents }, () => reader.varint("header"));
  reader.checksum(0);

  const subdivision = (format >> 2) & 15;
  const connectivity = format >> 6;
  const depth = 8 + (components >> 2);
  const farX = width * 2 ** subdivision;
  const farY = height * 2 ** subdivision;
  check(1 <= width && width <= 65535 && 1 <= height && height <= 65535, "header");
  check(subdivision <= 8 && Math.max(farX, farY) <= 2 ** 19, "header");
  check(nComponents !== 2 && connectivity !== 3, "header");
  check(4 <= nVertices && nVertices <= (farX + 1) * (farY + 1), "header");
  check(!isDeep || (9 <= depth && depth <= 16), "header");
  check(steps.every((step) => 1 <= step && step < 2 ** depth), "header");
  return { width, height, subdivision, connectivity, nVertices, steps, depth, farX, farY };
}

/** All chunks; the last one is `M`, with which the file must end. */
function readChunks(reader) {
  const chunks = [];
  let tag;
  do {
    const start = reader.position;
    tag = String.fromCharCode(reader.byte());
    check(/^[A-Za-z]$/.test(tag), "chunk");
    const content = reader.take(reader.varint("chunk"));
    reader.checksum(start);
    check(tag === "M" || /[a-z]/.test(tag), "chunk");
    check(!METADATA_TAGS.includes(tag) || chunks.every((chunk) => chunk.tag !== tag), "chunk");
    chunks.push({ tag, content });
  } while (tag !== "M");
  check(reader.atEnd(), "trailing");
  return chunks;
}

/**
 * @param {Uint8Array} bytes a file
 * @param {{pixels: number, vertices: number, verticesPerByte: number}} limits
 * @returns {{header: Header, content: Uint8Array, chunks: {tag: string, content: Uint8Array}[]}}
 *   `content` is that of the chunk `M`; it and the others share memory with `bytes`
 */
export function readFile(bytes, limits) {
  const reader = new Reader(bytes);
  const header = readHeader(reader);
  check(header.width * header.height <= limits.pixels, "limit");
  check(header.nVertices <= limits.vertices, "limit");

  const chunks = readChunks(reader);
  const { content } = chunks.pop();
  const nLevels = header.nVertices * header.steps.length;
  check(nLevels <= LEVELS_PER_BYTE * (content.length + 1), "header");
  check(header.nVertices <= 65536 + limits.verticesPerByte * content.length, "limit");
  return { header, content, chunks };
}
