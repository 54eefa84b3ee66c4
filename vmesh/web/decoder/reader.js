/** Bytes, numbers and checksums: sections 2 and 3 of the specification. */

import { VmeshError, check } from "./errors.js";

const CRC_TABLE = Uint32Array.from({ length: 256 }, (_, byte) => {
  let crc = byte;
  for (let bit = 0; bit < 8; bit++) crc = crc & 1 ? (crc >>> 1) ^ 0xedb88320 : crc >>> 1;
  return crc;
});

/** @param {Uint8Array} bytes */
function crc32(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = CRC_TABLE[(crc ^ byte) & 255] ^ (crc >>> 8);
  return ~crc >>> 0;
}

/** Reads fields one after the other. */
export class Reader {
  #bytes;
  #short;

  /**
   * @param {Uint8Array} bytes
   * @param {import("./errors.js").ErrorCode} short code of the error if they end too early
   */
  constructor(bytes, short) {
    this.#bytes = bytes;
    this.#short = short;
    this.position = 0;
  }

  atEnd() {
    return this.position === this.#bytes.length;
  }

  /** @param {number} length */
  take(length) {
    const end = this.position + length;
    check(end <= this.#bytes.length, this.#short);
    const taken = this.#bytes.subarray(this.position, end);
    this.position = end;
    return taken;
  }

  rest() {
    return this.#bytes.subarray(this.position);
  }

  byte() {
    return this.take(1)[0];
  }

  /**
   * A number below 2**31 in its shortest form.
   *
   * @param {import("./errors.js").ErrorCode} code of the error of any other
   */
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

  /**
   * Reads the CRC-32 of the bytes from a place to here.
   *
   * @param {number} start
   */
  checksum(start) {
    const covered = this.#bytes.subarray(start, this.position);
    const [b0, b1, b2, b3] = this.take(4);
    const stored = (b0 | (b1 << 8) | (b2 << 16) | (b3 << 24)) >>> 0;
    check(stored === crc32(covered), "checksum");
  }
}
