/**
 * Exact predicates and orders of vertices (section 6.2 of the specification). `points` holds x and
 * y of each vertex in turn, as integers of at most 2**19; vertices are named by their numbers.
 */

/**
 * Doubled area of the triangle a, b, c, positive if it turns from x towards y; at most 2**38.
 *
 * @param {Int32Array} points
 * @param {number} a
 * @param {number} b
 * @param {number} c
 */
export function cross(points, a, b, c) {
  const ax = points[2 * a];
  const ay = points[2 * a + 1];
  const bx = points[2 * b] - ax;
  const by = points[2 * b + 1] - ay;
  const cx = points[2 * c] - ax;
  const cy = points[2 * c + 1] - ay;
  return bx * cy - by * cx;
}

/**
 * A number of the sign of the in-circle determinant of the positive triangle a, b, c and d.
 *
 * @param {Int32Array} points
 * @param {number} a
 * @param {number} b
 * @param {number} c
 * @param {number} d
 */
function inCircleSign(points, a, b, c, d) {
  const dx = points[2 * d];
  const dy = points[2 * d + 1];
  const ax = points[2 * a] - dx;
  const ay = points[2 * a + 1] - dy;
  const bx = points[2 * b] - dx;
  const by = points[2 * b + 1] - dy;
  const cx = points[2 * c] - dx;
  const cy = points[2 * c + 1] - dy;

  // Squares and minors are below 2**40, so exact as doubles; their products need not be.
  const aLift = ax * ax + ay * ay;
  const bLift = bx * bx + by * by;
  const cLift = cx * cx + cy * cy;
  const aMinor = bx * cy - by * cx;
  const bMinor = cx * ay - cy * ax;
  const cMinor = ax * by - ay * bx;
  const sum = aLift * aMinor + bLift * bMinor + cLift * cMinor;
  const size = aLift * Math.abs(aMinor) + bLift * Math.abs(bMinor) + cLift * Math.abs(cMinor);
  // Three products and two sums are rounded, each by no more than size * 2**-53, if at all.
  if (size < 2 ** 53 || Math.abs(sum) > size * 2 ** -50) return sum;
  return Number(product(aLift, aMinor) + product(bLift, bMinor) + product(cLift, cMinor));
}

/**
 * @param {number} lift
 * @param {number} minor
 */
function product(lift, minor) {
  return BigInt(lift) * BigInt(minor);
}

/**
 * Whether d is inside the circle of the positive triangle a, b, c. On the circle the tie rule
 * decides: the four are a convex quad, of which the diagonal at the highest number is kept. So d
 * counts as inside if it is the highest, or if it lies beyond the side opposite to the highest.
 *
 * @param {Int32Array} points
 * @param {number} a
 * @param {number} b
 * @param {number} c
 * @param {number} d
 */
export function isInCircle(points, a, b, c, d) {
  const sign = inCircleSign(points, a, b, c, d);
  if (sign !== 0) return sign > 0;
  const highest = Math.max(a, b, c, d);
  if (highest === a) return cross(points, b, c, d) < 0;
  if (highest === b) return cross(points, c, a, d) < 0;
  if (highest === c) return cross(points, a, b, d) < 0;
  return true;
}

/**
 * The sides of the canvas that each vertex is on: the sum of 1 left, 2 right, 4 top, 8 bottom.
 *
 * @param {Int32Array} points
 * @param {number} farX
 * @param {number} farY
 */
export function sidesOf(points, farX, farY) {
  return Uint8Array.from({ length: points.length / 2 }, (_, v) => {
    const x = points[2 * v];
    const y = points[2 * v + 1];
    const across = (x === 0 ? 1 : 0) + (x === farX ? 2 : 0);
    return across + (y === 0 ? 4 : 0) + (y === farY ? 8 : 0);
  });
}

/** @param {number} sides that a vertex is on */
export function isCorner(sides) {
  return (sides & 3) > 0 && (sides & 12) > 0;
}

/**
 * Numbers of edges, sorted by origin and then by destination.
 *
 * @param {ArrayLike<number> & Iterable<number>} edges
 * @param {(e: number) => number} originOf
 * @param {(e: number) => number} destOf
 * @param {number} nVertices
 */
export function sortedByEnds(edges, originOf, destOf, nVertices) {
  return sortedBy(sortedBy(edges, destOf, nVertices), originOf, nVertices);
}

/**
 * A counting sort, which keeps the order of those whose keys, below `nKeys`, are the same.
 *
 * @param {ArrayLike<number> & Iterable<number>} edges
 * @param {(e: number) => number} keyOf
 * @param {number} nKeys
 */
function sortedBy(edges, keyOf, nKeys) {
  const next = new Int32Array(nKeys + 1);
  for (const e of edges) next[keyOf(e) + 1]++;
  for (let key = 0; key < nKeys; key++) next[key + 1] += next[key];
  const sorted = new Int32Array(edges.length);
  for (const e of edges) sorted[next[keyOf(e)]++] = e;
  return sorted;
}

/**
 * Three vertices for each triangle, by their canonical order, of triangles in any other order.
 *
 * @param {Int32Array} origin
 * @param {number} nVertices
 */
export function canonicalOrder(origin, nVertices) {
  /** @type {number[]} */
  const starts = [];
  origin.forEach((v, e) => {
    if (v < origin[nextOf(e)] && v < origin[prevOf(e)]) starts.push(e);
  });
  /** @param {number} e */
  const destOf = (e) => origin[nextOf(e)];
  const triangles = new Int32Array(origin.length);
  sortedByEnds(starts, (e) => origin[e], destOf, nVertices).forEach((e, t) => {
    triangles.set([origin[e], destOf(e), origin[prevOf(e)]], 3 * t);
  });
  return triangles;
}

/**
 * The half-edge after e in its triangle: triangle t has the half-edges 3 t, 3 t + 1 and 3 t + 2.
 *
 * @param {number} e
 */
export function nextOf(e) {
  return e % 3 === 2 ? e - 2 : e + 1;
}

/** @param {number} e */
export function prevOf(e) {
  return e % 3 === 0 ? e + 2 : e - 1;
}
