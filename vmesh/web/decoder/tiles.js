/** Tiles joined to one mesh: section 10.2 of the specification. */

import { check } from "./errors.js";
import { canonicalOrder, sortedByEnds } from "./geometry.js";

/**
 * What is decoded of a file, or of a tile of it; see Mesh.
 *
 * @typedef {{vertices: Int32Array, levels: Int32Array, triangles: Int32Array}} CodedMesh
 */

/**
 * @param {import("./container.js").Header} header of the file
 * @param {import("./container.js").Part[]} tiles
 * @param {CodedMesh[]} meshes of the tiles
 * @returns {CodedMesh}
 */
export function joinTiles(header, tiles, meshes) {
  const { farX, farY, nVertices } = header;
  const nComponents = header.steps.length;
  const all = placed(tiles, meshes, nComponents);
  const nPlaced = all.vertices.length / 2;
  const vertices = new Int32Array(2 * nVertices);
  const levels = new Int32Array(nComponents * nVertices);
  const numberOf = new Int32Array(nPlaced);
  /** @param {number} i */
  const xOf = (i) => all.vertices[2 * i];
  /** @param {number} i */
  const yOf = (i) => all.vertices[2 * i + 1];
  const order = sortedByEnds(numberOf.map((_, i) => i), yOf, xOf, Math.max(farX, farY) + 1);

  // Vertices at one place follow each other. There must be one from each tile that has the place.
  let n = 0;
  for (let at = 0; at < nPlaced; n++) {
    const first = order[at];
    const across = countAt(xOf(first), tiles[0].header.farX, farX);
    const down = countAt(yOf(first), tiles[0].header.farY, farY);
    const end = at + across * down;
    check(end <= nPlaced && n < nVertices, "tiles");
    for (; at < end; at++) {
      const v = order[at];
      check(isSameRow(all.vertices, first, v, 2), "tiles");
      check(isSameRow(all.levels, first, v, nComponents), "tiles");
      numberOf[v] = n;
    }
    copyRow(all.vertices, first, vertices, n, 2);
    copyRow(all.levels, first, levels, n, nComponents);
  }
  check(n === nVertices, "tiles");
  const triangles = all.triangles.map((v) => numberOf[v]);
  return { vertices, levels, triangles: canonicalOrder(triangles, nVertices) };
}

/**
 * The meshes of all tiles one after the other, at their places and with their own vertices.
 *
 * @param {import("./container.js").Part[]} tiles
 * @param {CodedMesh[]} meshes
 * @param {number} nComponents
 * @returns {CodedMesh}
 */
function placed(tiles, meshes, nComponents) {
  /** @param {keyof CodedMesh} name */
  const total = (name) => meshes.reduce((sum, mesh) => sum + mesh[name].length, 0);
  const vertices = new Int32Array(total("vertices"));
  const levels = new Int32Array(total("levels"));
  const triangles = new Int32Array(total("triangles"));
  let n = 0;
  let nCorners = 0;
  tiles.forEach(({ x, y }, i) => {
    const mesh = meshes[i];
    vertices.set(mesh.vertices.map((own, at) => own + (at % 2 === 0 ? x : y)), 2 * n);
    levels.set(mesh.levels, nComponents * n);
    triangles.set(mesh.triangles.map((v) => n + v), nCorners);
    n += mesh.vertices.length / 2;
    nCorners += mesh.triangles.length;
  });
  return { vertices, levels, triangles };
}

/**
 * How many tiles of a side have a coordinate within them or on their border.
 *
 * @param {number} coordinate
 * @param {number} side
 * @param {number} far the largest coordinate
 */
function countAt(coordinate, side, far) {
  return coordinate % side === 0 && coordinate > 0 && coordinate < far ? 2 : 1;
}

/**
 * @param {Int32Array} array
 * @param {number} row
 * @param {number} other
 * @param {number} length of a row
 */
function isSameRow(array, row, other, length) {
  for (let i = 0; i < length; i++) {
    if (array[row * length + i] !== array[other * length + i]) return false;
  }
  return true;
}

/**
 * @param {Int32Array} from
 * @param {number} row
 * @param {Int32Array} to
 * @param {number} other
 * @param {number} length of a row
 */
function copyRow(from, row, to, other, length) {
  for (let i = 0; i < length; i++) to[other * length + i] = from[row * length + i];
}
