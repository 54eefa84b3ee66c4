/** Draws meshes without WebGL: the decoder's own raster, or triangle by triangle if enlarged. */

import { render } from "../decoder/vmesh.js";
import { contextOf } from "./dom.js";
import { endsOf } from "./edges.js";
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
    /** @type {Uint32Array | null} */
    this.ends = null;
  }

  /** @param {import("../decoder/vmesh.js").Mesh} mesh */
  setMesh(mesh) {
    this.mesh = mesh;
    this.ends = null;
    this.picture.width = mesh.width;
    this.picture.height = mesh.height;
    contextOf(this.picture).putImageData(imageOf(render(mesh)), 0, 0);
  }

  /**
   * Draws the mesh, which must have been set.
   *
   * @param {import("./view.js").Frame} frame
   * @param {import("./painter.js").Marks} [marks]
   */
  draw(frame, { wireframe = false, vertices = false, pixelRatio = 1 } = {}) {
    const { context, mesh } = this;
    if (!mesh) return;
    const { columns, rows, left, top, scaleX, scaleY } = frame;
    if (this.canvas.width !== columns) this.canvas.width = columns;
    if (this.canvas.height !== rows) this.canvas.height = rows;
    const places = placesOf(mesh, frame);
    if (scaleX > 1 || scaleY > 1) {
      const image = context.createImageData(columns, rows);
      drawEnlarged(mesh, places, image);
      context.putImageData(image, 0, 0);
    } else {
      context.clearRect(0, 0, columns, rows);
      context.drawImage(this.picture, left, top, mesh.width * scaleX, mesh.height * scaleY);
    }
    if (wireframe) this.drawEdges((this.ends ??= endsOf(mesh)), places);
    if (vertices) this.drawVertices(places, 4 * pixelRatio);
  }

  /**
   * @param {Uint32Array} ends
   * @param {Float64Array} places
   */
  drawEdges(ends, places) {
    const { context } = this;
    context.beginPath();
    for (let at = 0; at < ends.length; at += 2) {
      const [u, v] = [2 * ends[at], 2 * ends[at + 1]];
      context.moveTo(places[u], places[u + 1]);
      context.lineTo(places[v], places[v + 1]);
    }
    context.strokeStyle = "rgb(0 217 255 / 75%)";
    context.stroke();
  }

  /**
   * @param {Float64Array} places
   * @param {number} size
   */
  drawVertices(places, size) {
    this.context.fillStyle = "rgb(255 217 0)";
    for (let at = 0; at < places.length; at += 2) {
      this.context.fillRect(places[at] - size / 2, places[at + 1] - size / 2, size, size);
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
