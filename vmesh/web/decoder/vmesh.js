/**
 * Decoder and renderer of `.vmesh` files, version 1.1 (spec/vmesh.md). Written from the
 * specification alone, without dependencies, for browsers and Node.
 */

import { readLevels, samplesOf } from "./colors.js";
import { readFile } from "./container.js";
import { checkCoverage } from "./coverage.js";
import { Triangulation } from "./delaunay.js";
import { VmeshError, check } from "./errors.js";
import { readFlips } from "./flips.js";
import { isCorner, sidesOf } from "./geometry.js";
import { DEFAULT_LIMITS } from "./limits.js";
import { readPositions } from "./positions.js";
import { RangeDecoder } from "./range_coder.js";
import { render } from "./render.js";
import { joinTiles } from "./tiles.js";
import { readTriangles } from "./triangle_list.js";

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
 * @property {import("./container.js").Chunk[]} chunks all but the mesh, as they are stored. The
 *   contents of `i` (an ICC profile), `e` (EXIF), `x` (XMP) are zlib streams, not looked at:
 *   `DecompressionStream("deflate")` inflates them; whoever does so should bound the length
 */

/**
 * Decodes a file.
 *
 * @param {Uint8Array} bytes
 * @param {Partial<import("./limits.js").Limits>} [limits]
 * @returns {Mesh}
 * @throws {VmeshError} if the file is invalid or exceeds a limit
 */
export function decode(bytes, limits = {}) {
  const { header, isTiled, parts, chunks } = readFile(bytes, { ...DEFAULT_LIMITS, ...limits });
  const { width, height, subdivision, depth, steps } = header;
  const meshes = parts.map((part) => readMesh(part.header, new RangeDecoder(part.content)));
  const mesh = isTiled ? joinTiles(header, parts, meshes) : meshes[0];
  const samples = samplesOf(mesh.levels, header);
  return { width, height, subdivision, depth, steps, ...mesh, samples, chunks };
}

/**
 * Decodes the mesh of a file or of a tile.
 *
 * @param {import("./container.js").Header} header
 * @param {RangeDecoder} decoder
 * @returns {import("./tiles.js").CodedMesh}
 */
function readMesh(header, decoder) {
  const { connectivity, nVertices, farX, farY, steps } = header;
  const vertices = readPositions(decoder, nVertices, farX + 1, farY + 1);
  const sides = sidesOf(vertices, farX, farY);
  check(sides.filter(isCorner).length === 4, "geometry");
  const triangulation = new Triangulation(vertices);
  const halfEdges = triangulation.halfEdges();
  const levels = readLevels(decoder, triangulation, sides, header);
  let triangles = halfEdges.origin;
  if (connectivity === LISTED) {
    triangles = readTriangles(decoder, sides);
    checkCoverage(vertices, triangles, sides, 2 * farX * farY);
  }
  if (connectivity === FLIPPED) {
    const luma = levels.filter((_, i) => i % steps.length === 0);
    triangles = readFlips(decoder, vertices, halfEdges, luma);
  }
  decoder.end();
  return { vertices, levels, triangles };
}
