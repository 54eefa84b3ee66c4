/** Signature, header, chunks and tiles of a file: sections 3 and 4 of the specification. */

import { check } from "./errors.js";
import { Reader } from "./reader.js";

const SIGNATURE = [0x8b, 0x56, 0x4d, 0x0d, 0x0a];
const MAJOR_VERSION = 1;
/** Chunks of these tags occur once at most. */
export const METADATA_TAGS = "iex";
const LEVELS_PER_BYTE = 5700;
const MOST_TILE_SIDE = 4096;

/**
 * Of a file, or of a tile of it.
 *
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

/**
 * @param {Reader} reader
 * @returns {Header}
 */
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
  check(1 <= width && width <= 65535 && 1 <= height && height <= 65535, "header");
  check(subdivision <= 8 && Math.max(width, height) * 2 ** subdivision <= 2 ** 19, "header");
  check(nComponents !== 2 && connectivity !== 3, "header");
  check(!isDeep || (9 <= depth && depth <= 16), "header");
  check(steps.every((step) => 1 <= step && step < 2 ** depth), "header");
  return sized({ subdivision, connectivity, steps, depth }, width, height, nVertices, "header");
}

/**
 * A header with a size and a number of vertices that fits it.
 *
 * @param {Pick<Header, "subdivision" | "connectivity" | "steps" | "depth">} header
 * @param {number} width
 * @param {number} height
 * @param {number} nVertices
 * @param {import("./errors.js").ErrorCode} code of the error if it does not fit
 * @returns {Header}
 */
function sized(header, width, height, nVertices, code) {
  const farX = width * 2 ** header.subdivision;
  const farY = height * 2 ** header.subdivision;
  check(4 <= nVertices && nVertices <= (farX + 1) * (farY + 1), code);
  return { ...header, width, height, nVertices, farX, farY };
}

/** @typedef {{tag: string, content: Uint8Array}} Chunk */

/**
 * The next chunk. A letter that is not allowed is refused after all else.
 *
 * @param {Reader} reader
 * @param {RegExp} allowed
 * @returns {Chunk}
 */
function readChunk(reader, allowed) {
  const start = reader.position;
  const tag = String.fromCharCode(reader.byte());
  check(/^[A-Za-z]$/.test(tag), "chunk");
  const content = reader.take(reader.varint("chunk"));
  reader.checksum(start);
  check(allowed.test(tag), "chunk");
  return { tag, content };
}

/**
 * The chunks before `M` or `G`, and that one.
 *
 * @param {Reader} reader
 */
function readChunks(reader) {
  /** @type {Chunk[]} */
  const chunks = [];
  for (;;) {
    const chunk = readChunk(reader, /[MGa-z]/);
    const { tag } = chunk;
    check(!METADATA_TAGS.includes(tag) || chunks.every((other) => other.tag !== tag), "chunk");
    if (!/[a-z]/.test(tag)) return { chunks, last: chunk };
    chunks.push(chunk);
  }
}

/**
 * What is coded as one mesh: all, or a tile.
 *
 * @typedef {object} Part
 * @property {Header} header
 * @property {Uint8Array} content positions, colours and triangles; shares memory with the file
 * @property {number} x its left side in lattice units
 * @property {number} y its upper side
 */

/**
 * @param {Reader} reader
 * @param {Header} header of the file
 * @param {Uint8Array} content of `G`
 * @param {import("./limits.js").Limits} limits
 * @returns {Part[]} the tiles that it stands for, from the chunks that follow
 */
function readTiles(reader, header, content, limits) {
  const grid = new Reader(content, "tiles");
  const side = grid.varint("tiles");
  check(grid.atEnd() && 1 <= side && side * 2 ** header.subdivision <= MOST_TILE_SIDE, "tiles");
  const nAcross = Math.ceil(header.width / side);
  const nDown = Math.ceil(header.height / side);
  check((nAcross + 1) * (nDown + 1) <= header.nVertices, "tiles");
  check(nAcross * nDown <= limits.tiles, "limit");
  const contents = Array.from({ length: nAcross * nDown }, () => readChunk(reader, /T/).content);
  check(reader.atEnd(), "trailing");
  return contents.map((own, i) => {
    return openTile(header, side, side * (i % nAcross), side * Math.floor(i / nAcross), own);
  });
}

/**
 * The tile at a place in pixels.
 *
 * @param {Header} file
 * @param {number} side
 * @param {number} left
 * @param {number} top
 * @param {Uint8Array} bytes
 * @returns {Part}
 */
function openTile(file, side, left, top, bytes) {
  const width = Math.min(side, file.width - left);
  const height = Math.min(side, file.height - top);
  const reader = new Reader(bytes, "tiles");
  const header = sized(file, width, height, reader.varint("tiles"), "tiles");
  const content = reader.rest();
  check(isPossible(header, content), "tiles");
  return { header, content, x: left * 2 ** file.subdivision, y: top * 2 ** file.subdivision };
}

/**
 * @param {Reader} reader
 * @param {Header} header
 * @param {Uint8Array} content of `M`
 * @returns {Part[]}
 */
function readWhole(reader, header, content) {
  check(reader.atEnd(), "trailing");
  check(isPossible(header, content), "header");
  return [{ header, content, x: 0, y: 0 }];
}

/**
 * Whether so many bytes may hold so many levels.
 *
 * @param {Header} header
 * @param {Uint8Array} content
 */
function isPossible({ nVertices, steps }, content) {
  return nVertices * steps.length <= LEVELS_PER_BYTE * (content.length + 1);
}

/**
 * @param {Uint8Array} bytes a file
 * @param {import("./limits.js").Limits} limits
 * @returns {{header: Header, isTiled: boolean, parts: Part[], chunks: Chunk[]}} `chunks` are those
 *   that are not of the mesh
 */
export function readFile(bytes, limits) {
  const reader = new Reader(bytes, "truncated");
  const header = readHeader(reader);
  check(header.width * header.height <= limits.pixels, "limit");
  check(header.nVertices <= limits.vertices, "limit");

  const { chunks, last } = readChunks(reader);
  const isTiled = last.tag === "G";
  const parts = isTiled
    ? readTiles(reader, header, last.content, limits)
    : readWhole(reader, header, last.content);
  // Tiles may have more vertices than the header says, until they are joined.
  const nVertices = parts.reduce((sum, part) => sum + part.header.nVertices, 0);
  const nBytes = parts.reduce((sum, part) => sum + part.content.length, 0);
  check(nVertices <= Math.min(limits.vertices, 65536 + limits.verticesPerByte * nBytes), "limit");
  return { header, isTiled, parts, chunks };
}
