/** Draws meshes without WebGL: the decoder's own raster, or triangle by triangle if enlarged. */

import { render } from "../vmesh.js";
import { endsOf } from "./edges.js";
import { drawEnlarged } from "./enlarge.js";

export class RasterPainter {
  /** @param {CanvasRenderingContext2D} context */
  constructor(context) {
    this.context = context;
    this.canvas = context.canvas;
  }

  /** @param {import("../vmesh.js").Mesh} mesh */
  setMesh(mesh) {
    this.mesh = mesh;
    this.ends = null;
    this.picture = document.createElement("canvas");
    this.picture.width = mesh.width;
    this.picture.height = mesh.height;
    this.picture.getContext("2d").putImageData(imageOf(render(mesh)), 0, 0);
  }

  /** As that of GlPainter. */
  draw(frame, { wireframe = false, vertices = false, pixelRatio = 1 } = {}) {
    const { context, mesh } = this;
    const { columns, rows, left, top, scaleX, scaleY } = frame;
    if (this.canvas.width !== columns) this.canvas.width = columns;
    if (this.canvas.height !== rows) this.canvas.height = rows;
    if (scaleX > 1 || scaleY > 1) {
      const image = context.createImageData(columns, rows);
      drawEnlarged(mesh, frame, image);
      context.putImageData(image, 0, 0);
    } else {
      context.clearRect(0, 0, columns, rows);
      context.drawImage(this.picture, left, top, mesh.width * scaleX, mesh.height * scaleY);
    }
    const unit = 2 ** mesh.subdivision;
    const place = (v) => [
      left + (mesh.vertices[2 * v] / unit) * scaleX,
      top + (mesh.vertices[2 * v + 1] / unit) * scaleY,
    ];
    if (wireframe) this.drawEdges(place);
    if (vertices) this.drawVertices(place, 4 * pixelRatio);
  }

  drawEdges(place) {
    this.ends ??= endsOf(this.mesh);
    this.context.beginPath();
    for (let at = 0; at < this.ends.length; at += 2) {
      this.context.moveTo(...place(this.ends[at]));
      this.context.lineTo(...place(this.ends[at + 1]));
    }
    this.context.strokeStyle = "rgb(0 217 255 / 75%)";
    this.context.stroke();
  }

  drawVertices(place, size) {
    this.context.fillStyle = "rgb(255 217 0)";
    for (let v = 0; v < this.mesh.vertices.length / 2; v++) {
      const [x, y] = place(v);
      this.context.fillRect(x - size / 2, y - size / 2, size, size);
    }
  }
}

/** A raster in 8 bits with alpha, as a canvas takes it. */
function imageOf({ width, height, components, depth, data }) {
  const image = new ImageData(width, height);
  const gain = 255 / (2 ** depth - 1);
  image.data.fill(255);
  for (let pixel = 0; pixel < width * height; pixel++) {
    for (let i = 0; i < Math.max(components, 3); i++) {
      const sample = data[pixel * components + (components === 1 ? 0 : i)];
      image.data[4 * pixel + i] = sample * gain; // which is rounded, and clamped
    }
  }
  return image;
}
