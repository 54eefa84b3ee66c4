/** What `decode` and `render` accept unless told otherwise. More throws the code "limit". */
export const DEFAULT_LIMITS = Object.freeze({
  /** Pixels of the canvas. */
  pixels: 2 ** 26,
  vertices: 2 ** 22,
  /** Bytes to which each metadata chunk may inflate. */
  metadataBytes: 2 ** 24,
  /** Sum over all triangles of the rows of pixels that each one spans. */
  triangleRows: 2 ** 26,
});
