/** What each error code means (section 12 of the specification), and "limit" of this decoder. */
const MEANINGS = {
  signature: "the file does not begin with the signature",
  version: "the major version is not 1",
  truncated: "the file ends too early",
  header: "a field of the header is out of range",
  checksum: "a CRC-32 is wrong",
  chunk: "a chunk is not allowed",
  trailing: "bytes follow the mesh",
  tiles: "a tile is out of range, or tiles do not fit each other",
  metadata: "a metadata chunk is not one complete zlib stream with content",
  positions: "the coded positions are invalid",
  geometry: "the triangles do not cover the canvas exactly once",
  colors: "the coded colours are invalid",
  triangles: "the coded triangles are invalid",
  limit: "the file exceeds a limit of this decoder",
};

/** @typedef {keyof typeof MEANINGS} ErrorCode */

/** A file that is invalid (`code` of section 12) or that exceeds a limit (`code` "limit"). */
export class VmeshError extends Error {
  /** @param {ErrorCode} code */
  constructor(code) {
    super(`${code}: ${MEANINGS[code]}`);
    this.name = "VmeshError";
    this.code = code;
  }
}

/**
 * @param {boolean} condition
 * @param {ErrorCode} code of the error that is thrown if the condition does not hold
 */
export function check(condition, code) {
  if (!condition) throw new VmeshError(code);
}
