/** Draws meshes without WebGL: the decoder's own raster, or triangle by triangle if enlarged. */

import { render } from "../decoder/vmesh.js";
import { contextOf } from "./dom.js";
import { drawEnlarged, placesOf } from "./enlarge.js";
import { fillRgba } from "./rgba.js";

export class RasterPainter {
  /** @param {CanvasRenderingContext2D} context */
  constructor(context) {
    this.context = context;
    this.canvas = context.canvas;
    this.picture = document.createElement("canvas");
    /** @type {import("../decoder/vmesh.js").Mesh | null} */
    this.mesh = null;
  }

  /** @param {import("../decoder/vmesh.js").Mesh} mesh */
  setMesh(mesh) {
    this.mesh = mesh;
    this.picture.width = mesh.width;
    this.picture.height = mesh.height;
    contextOf(this.picture).putImageData(imageOf(render(mesh)), 0, 0);
  }

  /**
   * Draws the mesh, which must have been set.
   *
   * @param {import("./view.js").Frame} frame
   */
  draw(frame) {
    const { context, mesh } = this;
    if (!mesh) return;
    const { columns, rows, left, top, scaleX, scaleY } = frame;
    if (this.canvas.width !== columns) this.canvas.width = columns;
    if (this.canvas.height !== rows) this.canvas.height = rows;
    if (scaleX > 1 || scaleY > 1) {
      const image = context.createImageData(columns, rows);
      drawEnlarged(mesh, placesOf(mesh, frame), image);
      context.putImageData(image, 0, 0);
    } else {
      context.clearRect(0, 0, columns, rows);
      context.drawImage(this.picture, left, top, mesh.width * scaleX, mesh.height * scaleY);
    }
  }
}

/**
 * A raster in 8 bits with alpha, as a canvas takes it.
 *
 * @param {import("../decoder/render.js").Picture} picture
 */
function imageOf({ width, height, components, depth, data }) {
  const image = new ImageData(width, height);
  fillRgba(image.data, data, components, depth, 255); // which is rounded, and clamped
  return image;
}
