/**
 * Decoder and renderer of `.vmesh` files, version 1.0 (spec/vmesh.md). Written from the specification
 * alone, without dependencies, for browsers and Node.
 */

import { readLevels, samplesOf } from "./colors.js";
import { readFile } from "./container.js";
import { Triangulation } from "./delaunay.js";
import { VmeshError, check } from "./errors.js";
import { DEFAULT_LIMITS } from "./limits.js";
import { readPositions } from "./positions.js";
import { RangeDecoder } from "./rangecoder.js";
import { render } from "./render.js";
import { checkGeometry, readFlips, readTriangles } from "./triangles.js";

export { DEFAULT_LIMITS, VmeshError, render };

const LISTED = 1;
const FLIPPED = 2;

/**
 * A mesh of n vertices with c colour components and m triangles.
 *
 * @typedef {object} Mesh
 * @property {number} width canvas in pixels
 * @property {number} height
 * @property {number} subdivision a pixel is 2**subdivision lattice units wide
 * @property {number} depth bits of a sample, 8 to 16
 * @property {number[]} steps c of them; a level times its step is a value
 * @property {Int32Array} vertices 2 n: x, y in lattice units, in raster order
 * @property {Int32Array} levels c n: as stored
 * @property {Uint8Array | Uint16Array} samples c n: grey, or RGB, or RGB and alpha (not multiplied)
 * @property {Int32Array} triangles 3 m: vertex numbers, in canonical order
 * @property {{icc?: Uint8Array, exif?: Uint8Array, xmp?: Uint8Array}} metadata inflated
 * @property {{tag: string, content: Uint8Array}[]} otherChunks of unknown ancillary tags
 */

/**
 * Decodes a file.
 *
 * @param {Uint8Array} bytes
 * @param {Partial<typeof DEFAULT_LIMITS>} [limits]
 * @returns {Mesh}
 * @throws {VmeshError} if the file is invalid or exceeds a limit
 */
export function decode(bytes, limits = {}) {
  const { header, content, metadata, otherChunks } = readFile(bytes, {
    ...DEFAULT_LIMITS,
    ...limits,
  });
  const { width, height, subdivision, depth, steps } = header;
  const mesh = readMesh(header, new RangeDecoder(content));
  return { width, height, subdivision, depth, steps, ...mesh, metadata, otherChunks };
}

/** Decodes the content of the chunk `M`. */
function readMesh({ connectivity, nVertices, steps, depth, farX, farY }, decoder) {
  const vertices = readPositions(decoder, nVertices, farX + 1, farY + 1);
  checkCorners(vertices, farX, farY);
  const triangulation = new Triangulation(vertices);
  let triangles = triangulation.triangles();
  const levels = readLevels(decoder, triangulation, steps, depth, farX, farY);
  if (connectivity === LISTED) {
    triangles = readTriangles(decoder, vertices, farX, farY);
    checkGeometry(vertices, triangles, farX, farY);
  }
  if (connectivity === FLIPPED) {
    const luma = levels.filter((_, i) => i % steps.length === 0);
    triangles = readFlips(decoder, vertices, triangles, luma);
  }
  decoder.end();
  return { vertices, levels, samples: samplesOf(levels, steps, depth), triangles };
}

function checkCorners(vertices, farX, farY) {
  let nCorners = 0;
  for (let at = 0; at < vertices.length; at += 2) {
    const isX = vertices[at] === 0 || vertices[at] === farX;
    const isY = vertices[at + 1] === 0 || vertices[at + 1] === farY;
    if (isX && isY) nCorners++;
  }
  check(nCorners === 4, "geometry");
}
