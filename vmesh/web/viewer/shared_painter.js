/** One painter for many canvases of a page: browsers keep no more than 16 WebGL contexts. */

import { contextOf } from "./dom.js";

const MOST_SIDE = 8192; // of a canvas

/**
 * What a painter does.
 *
 * @template Marks
 * @typedef {object} Painter
 * @property {HTMLCanvasElement | OffscreenCanvas} canvas
 * @property {(mesh: import("../decoder/vmesh.js").Mesh) => void} setMesh
 * @property {(frame: import("./view.js").Frame, marks?: Marks) => void} draw
 */

/** @template [Marks=never] */
export class SharedPainter {
  /** @type {Painter<Marks> | undefined} */
  #painter;
  #make;

  /** @param {(canvas: HTMLCanvasElement) => Painter<Marks>} make makes the painter, when needed */
  constructor(make) {
    this.#make = make;
  }

  /**
   * Makes a mesh fill a canvas, which gets so many columns and rows; fewer where they are too many.
   *
   * @param {import("../decoder/vmesh.js").Mesh} mesh
   * @param {HTMLCanvasElement} canvas
   * @param {number} columns
   * @param {number} rows
   * @param {Marks} [marks]
   */
  paint(mesh, canvas, columns, rows, marks) {
    const shrink = Math.min(1, MOST_SIDE / Math.max(columns, rows));
    [columns, rows] = [columns, rows].map((side) => Math.max(1, Math.round(side * shrink)));
    canvas.width = columns;
    canvas.height = rows;
    const painter = (this.#painter ??= this.#make(document.createElement("canvas")));
    painter.setMesh(mesh);
    const [scaleX, scaleY] = [columns / mesh.width, rows / mesh.height];
    painter.draw({ columns, rows, left: 0, top: 0, scaleX, scaleY }, marks);
    contextOf(canvas).drawImage(painter.canvas, 0, 0);
  }
}
