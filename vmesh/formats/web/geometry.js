/**
 * Exact predicates and orders of vertices (section 6.2 of the specification). `points` holds x and
 * y of each vertex in turn, as integers of at most 2**19; vertices are named by their numbers.
 */

/**
 * @param {Int32Array} points
 * @returns {number} doubled area of the triangle a, b, c; positive if it turns from x towards y.
 *   It is below 2**40 and so exact.
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

/** A number of the sign of the in-circle determinant of the positive triangle a, b, c and d. */
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
  const exact =
    BigInt(aLift) * BigInt(aMinor) +
    BigInt(bLift) * BigInt(bMinor) +
    BigInt(cLift) * BigInt(cMinor);
  return Number(exact);
}

/**
 * Whether d is inside the circle of the positive triangle a, b, c. On the circle the tie rule
 * decides: the four are a convex quad, of which the diagonal at the highest number is kept. So d
 * counts as inside if it is the highest, or if it lies beyond the side opposite to the highest.
 *
 * @param {Int32Array} points
 * @returns {boolean}
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
 * The places of pairs in ascending order of the pairs, by a counting sort.
 *
 * @param {Int32Array} first numbers from 0 to nKeys - 1
 * @param {Int32Array} second likewise
 * @param {number} nKeys
 * @returns {Int32Array}
 */
export function orderOfPairs(first, second, nKeys) {
  const places = new Int32Array(first.length);
  for (let i = 0; i < places.length; i++) places[i] = i;
  return sortedByKey(sortedByKey(places, second, nKeys), first, nKeys);
}

function sortedByKey(places, keys, nKeys) {
  const next = new Int32Array(nKeys + 1);
  for (const place of places) next[keys[place] + 1]++;
  for (let key = 0; key < nKeys; key++) next[key + 1] += next[key];
  const sorted = new Int32Array(places.length);
  for (const place of places) sorted[next[keys[place]]++] = place;
  return sorted;
}

/**
 * @param {Int32Array} triangles three vertices each, of positive turn
 * @param {number} nVertices
 * @returns {Int32Array} the same triangles in canonical order
 */
export function canonicalOrder(triangles, nVertices) {
  const n = triangles.length / 3;
  const firstPlace = new Int32Array(n);
  const first = new Int32Array(n);
  const second = new Int32Array(n);
  for (let t = 0; t < n; t++) {
    let e = 3 * t;
    if (triangles[3 * t + 1] < triangles[e]) e = 3 * t + 1;
    if (triangles[3 * t + 2] < triangles[e]) e = 3 * t + 2;
    firstPlace[t] = e;
    first[t] = triangles[e];
    second[t] = triangles[nextOf(e)];
  }
  const sorted = new Int32Array(3 * n);
  // First and second vertex tell triangles apart: each directed edge has one triangle.
  orderOfPairs(first, second, nVertices).forEach((t, place) => {
    sorted[3 * place] = first[t];
    sorted[3 * place + 1] = second[t];
    sorted[3 * place + 2] = triangles[prevOf(firstPlace[t])];
  });
  return sorted;
}

/**
 * The half-edges of triangles, in the order of the edges they belong to: those of one edge, in
 * either direction, are next to each other.
 *
 * @param {Int32Array} triangles three vertices each
 * @param {number} nVertices
 * @returns {{order: Int32Array, low: Int32Array, high: Int32Array}} `order` of the half-edges, and
 *   the lower and the higher end of each
 */
export function halfEdgesByEdge(triangles, nVertices) {
  const low = new Int32Array(triangles.length);
  const high = new Int32Array(triangles.length);
  for (let e = 0; e < triangles.length; e++) {
    const u = triangles[e];
    const v = triangles[nextOf(e)];
    low[e] = Math.min(u, v);
    high[e] = Math.max(u, v);
  }
  return { order: orderOfPairs(low, high, nVertices), low, high };
}

/** The half-edge after e in its triangle; triangle t has 3 t, 3 t + 1 and 3 t + 2. */
export function nextOf(e) {
  return e % 3 === 2 ? e - 2 : e + 1;
}

/** The half-edge before e in its triangle. */
export function prevOf(e) {
  return e % 3 === 0 ? e + 2 : e - 1;
}
