/**
 * The canonical Delaunay triangulation (section 6.2 of the specification), by the divide and
 * conquer of Guibas and Stolfi, "Primitives for the manipulation of general subdivisions", 1985,
 * in O(n log n) steps for any vertices. It needs no step for the tie rule: `isInCircle` decides
 * ties as if the vertices were lifted by that rule.
 *
 * Vertices are in raster order. With y for the axis along which Guibas and Stolfi sort, and -x for
 * the other, their left and right are the earlier and the later vertices, and their
 * counterclockwise is the positive turn.
 */

import { cross, isInCircle } from "./geometry.js";
import { Subdivision } from "./subdivision.js";

/**
 * The edge of a hull from its first vertex, with the hull on the left, and that from its last
 * vertex, with the hull on the right.
 *
 * @typedef {[number, number]} Hull
 */

export class Triangulation extends Subdivision {
  /** @param {Int32Array} points x and y of distinct vertices in raster order, at least two */
  constructor(points) {
    super(points);
    this.divide(0, points.length / 2);
  }

  /**
   * Triangulates the vertices from `start` to before `end`.
   *
   * @param {number} start
   * @param {number} end
   * @returns {Hull}
   */
  divide(start, end) {
    if (end - start === 2) return this.makeSegment(start);
    if (end - start === 3) return this.makeTriangle(start);
    const middle = (start + end) >> 1;
    const earlier = this.divide(start, middle);
    const later = this.divide(middle, end);
    return this.merge(earlier, later);
  }

  /**
   * @param {number} v the first of two vertices
   * @returns {Hull}
   */
  makeSegment(v) {
    const e = this.makeEdge(v, v + 1);
    return [e, e ^ 1];
  }

  /**
   * @param {number} v the first of three vertices
   * @returns {Hull}
   */
  makeTriangle(v) {
    const e = this.makeEdge(v, v + 1);
    const f = this.makeEdge(v + 1, v + 2);
    this.splice(e ^ 1, f);
    const turn = cross(this.points, v, v + 1, v + 2);
    if (turn === 0) return [e, f ^ 1];
    const g = this.connect(f, e);
    return turn > 0 ? [e, f ^ 1] : [g ^ 1, g];
  }

  /**
   * @param {Hull} earlier
   * @param {Hull} later
   * @returns {Hull}
   */
  merge([earlierOuter, earlierInner], [laterInner, laterOuter]) {
    let base = this.connectHulls(earlierInner, laterInner);
    if (this.destOf(base) === this.originOf[earlierOuter]) earlierOuter = base ^ 1;
    if (this.originOf[base] === this.originOf[laterOuter]) laterOuter = base;
    while (base >= 0) base = this.rise(base);
    return [earlierOuter, laterOuter];
  }

  /**
   * The lower common tangent, from the later vertices to the earlier ones.
   *
   * @param {number} earlier an edge of their hull
   * @param {number} later
   */
  connectHulls(earlier, later) {
    for (;;) {
      if (this.isLeftOf(this.originOf[later], earlier)) earlier = this.nextOfFace(earlier);
      else if (this.isRightOf(this.originOf[earlier], later)) later = this.nextAround[later ^ 1];
      else return this.connect(later ^ 1, earlier);
    }
  }

  /**
   * Adds the triangle above an edge between the two sets.
   *
   * @param {number} base
   * @returns {number} its upper edge between them, or -1 if the edge is the upper tangent
   */
  rise(base) {
    const origin = this.originOf[base];
    const dest = this.destOf(base);
    const earlier = this.candidate(base, this.nextAround[base ^ 1], this.nextAround);
    const later = this.candidate(base, this.prevAround[base], this.prevAround);
    const hasEarlier = this.isRightOf(this.destOf(earlier), base);
    const hasLater = this.isRightOf(this.destOf(later), base);
    if (!hasEarlier && !hasLater) return -1;
    const usesLater =
      !hasEarlier ||
      (hasLater &&
        isInCircle(this.points, this.destOf(earlier), dest, origin, this.destOf(later)));
    return usesLater ? this.connect(later, base ^ 1) : this.connect(base ^ 1, earlier ^ 1);
  }

  /**
   * Deletes the edges, from e on in the order `after`, that the triangulation of all lacks.
   *
   * @param {number} base
   * @param {number} e
   * @param {Int32Array} after
   * @returns {number} the first edge that is left
   */
  candidate(base, e, after) {
    const origin = this.originOf[base];
    const dest = this.destOf(base);
    if (!this.isRightOf(this.destOf(e), base)) return e;
    while (isInCircle(this.points, dest, origin, this.destOf(e), this.destOf(after[e]))) {
      const following = after[e];
      this.deleteEdge(e);
      e = following;
    }
    return e;
  }

  /**
   * Removes a vertex that is no corner of the canvas; its neighbours stay triangulated.
   *
   * @param {number} v
   */
  remove(v) {
    const spokes = this.edgesAround(v);
    // On the border of the canvas, begin behind the face outside.
    const outside = spokes.findIndex((e) => !this.hasTriangle(e));
    if (outside >= 0) spokes.push(...spokes.splice(0, outside + 1));
    const firstSide = this.nextOfFace(spokes[0]);
    const lastSide = this.nextOfFace(spokes[spokes.length - 2]);
    for (const e of spokes) this.deleteEdge(e);
    this.fill(outside >= 0 ? this.connect(lastSide, firstSide) : firstSide);
  }

  /**
   * Triangulates the face on the left of an edge: the triangle at the edge, then what is left.
   *
   * @param {number} base
   */
  fill(base) {
    const afterBase = this.nextOfFace(base);
    const beforeBase = this.prevOfFace(base);
    if (this.nextOfFace(afterBase) === beforeBase) return;
    const toApex = this.edgeToApex(base);
    const fromApex = this.nextOfFace(toApex);
    if (toApex !== afterBase) this.fill(this.connect(toApex, afterBase));
    if (fromApex !== beforeBase) this.fill(this.connect(beforeBase, fromApex));
  }

  /** @param {number} base */
  edgeToApex(base) {
    const origin = this.originOf[base];
    const dest = this.destOf(base);
    let best = -1;
    for (let e = this.nextOfFace(base); this.destOf(e) !== origin; e = this.nextOfFace(e)) {
      const v = this.destOf(e);
      if (!this.isLeftOf(v, base)) continue;
      const apex = best < 0 ? -1 : this.destOf(best);
      if (best < 0 || isInCircle(this.points, origin, dest, apex, v)) best = e;
    }
    return best;
  }
}
