/** A subdivision of the plane: its edges, and what the algorithms on it read and change. */

import { cross, sortedByEnds } from "./geometry.js";

/** The twin of a half-edge on the border of the canvas. */
export const NO_TWIN = -1;

/**
 * Triangle t has the half-edges 3 t, 3 t + 1 and 3 t + 2.
 *
 * @typedef {object} HalfEdges
 * @property {Int32Array} origin the vertex at which each half-edge starts
 * @property {Int32Array} twin the half-edge on the other side, or NO_TWIN
 */

/**
 * Directed edges around their origins: edge e and its reverse e ^ 1 are next to each other in the
 * tables. "Next" is in the direction of the positive turn.
 */
export class Subdivision {
  /** @param {Int32Array} points x and y of each vertex; no edge is there yet */
  constructor(points) {
    const nVertices = points.length / 2;
    this.points = points;
    this.nEdges = 0;
    /** @type {number[]} */
    this.freeEdges = [];
    this.originOf = new Int32Array(6 * nVertices);
    this.nextAround = new Int32Array(6 * nVertices);
    this.prevAround = new Int32Array(6 * nVertices);
    /** An edge that starts at each vertex. */
    this.edgeFrom = new Int32Array(nVertices);
  }

  /** @param {number} e */
  destOf(e) {
    return this.originOf[e ^ 1];
  }

  /**
   * The edge after e around the face on its left.
   *
   * @param {number} e
   */
  nextOfFace(e) {
    return this.prevAround[e ^ 1];
  }

  /**
   * The edge before e around the face on its left.
   *
   * @param {number} e
   */
  prevOfFace(e) {
    return this.nextAround[e] ^ 1;
  }

  /**
   * @param {number} v
   * @param {number} e
   */
  isLeftOf(v, e) {
    return cross(this.points, v, this.originOf[e], this.destOf(e)) > 0;
  }

  /**
   * @param {number} v
   * @param {number} e
   */
  isRightOf(v, e) {
    return cross(this.points, v, this.destOf(e), this.originOf[e]) > 0;
  }

  /**
   * Whether the face on the left of e is a triangle; the face outside the canvas is not.
   *
   * @param {number} e
   */
  hasTriangle(e) {
    const after = this.nextAround[e];
    return cross(this.points, this.originOf[e], this.destOf(e), this.destOf(after)) > 0;
  }

  /**
   * The triangles of a canvas with all its corners, in canonical order.
   *
   * @returns {HalfEdges}
   */
  halfEdges() {
    const starts = [];
    for (let e = 0; e < this.nEdges; e++) {
      const [a, b, c] = [this.originOf[e], this.destOf(e), this.destOf(this.nextAround[e])];
      if (a < b && a < c && this.hasTriangle(e)) starts.push(e);
    }
    const nVertices = this.points.length / 2;
    const sorted = sortedByEnds(starts, (e) => this.originOf[e], (e) => this.destOf(e), nVertices);
    const origin = new Int32Array(3 * sorted.length);
    const twin = new Int32Array(3 * sorted.length);
    const numberOf = new Int32Array(this.nEdges).fill(NO_TWIN);
    let number = 0;
    for (const start of sorted) {
      for (const e of [start, this.nextOfFace(start), this.prevOfFace(start)]) {
        origin[number] = this.originOf[e];
        numberOf[e] = number++;
      }
    }
    numberOf.forEach((h, e) => {
      if (h !== NO_TWIN) twin[h] = numberOf[e ^ 1];
    });
    return { origin, twin };
  }

  /**
   * The edges that start at a vertex, in the direction of the positive turn.
   *
   * @param {number} v
   */
  edgesAround(v) {
    const edges = [];
    let e = this.edgeFrom[v];
    do {
      edges.push(e);
      e = this.nextAround[e];
    } while (e !== edges[0]);
    return edges;
  }

  /** @param {number} v */
  neighboursOf(v) {
    return this.edgesAround(v).map((e) => this.destOf(e));
  }

  /**
   * @param {number} origin
   * @param {number} dest
   */
  makeEdge(origin, dest) {
    let e = this.freeEdges.pop();
    if (e === undefined) {
      e = this.nEdges;
      this.nEdges += 2;
    }
    this.addEnd(e, origin);
    this.addEnd(e ^ 1, dest);
    return e;
  }

  /**
   * @param {number} e
   * @param {number} origin
   */
  addEnd(e, origin) {
    this.originOf[e] = origin;
    this.nextAround[e] = e;
    this.prevAround[e] = e;
    this.edgeFrom[origin] = e;
  }

  /**
   * Joins the rings of edges around two origins, or divides one ring in two.
   *
   * @param {number} e
   * @param {number} f
   */
  splice(e, f) {
    const afterE = this.nextAround[e];
    const afterF = this.nextAround[f];
    this.nextAround[e] = afterF;
    this.nextAround[f] = afterE;
    this.prevAround[afterF] = e;
    this.prevAround[afterE] = f;
  }

  /**
   * A new edge from the end of e to the origin of f, which have the same face on their left.
   *
   * @param {number} e
   * @param {number} f
   */
  connect(e, f) {
    const made = this.makeEdge(this.destOf(e), this.originOf[f]);
    this.splice(made, this.nextOfFace(e));
    this.splice(made ^ 1, f);
    return made;
  }

  /** @param {number} e */
  deleteEdge(e) {
    this.removeEnd(e);
    this.removeEnd(e ^ 1);
    // No triangle starts with an edge from a vertex to itself.
    this.originOf[e] = this.originOf[e ^ 1];
    this.freeEdges.push(e & ~1);
  }

  /** @param {number} e */
  removeEnd(e) {
    this.edgeFrom[this.originOf[e]] = this.nextAround[e];
    this.splice(e, this.prevAround[e]);
  }
}
