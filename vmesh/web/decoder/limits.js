/** What `decode` and `render` accept unless told otherwise. More throws the code "limit". */
export const DEFAULT_LIMITS = Object.freeze({
  /** Pixels of the canvas. */
  pixels: 2 ** 26,
  /** Vertices of the mesh, and the sum of those of its tiles. */
  vertices: 2 ** 22,
  /** Vertices for each byte of the coded mesh, beyond the first 65,536. */
  verticesPerByte: 8,
  tiles: 2048,
  /** Sum over all triangles of the rows of pixels that each one spans. */
  triangleRows: 2 ** 26,
});

/** @typedef {typeof DEFAULT_LIMITS} Limits */
