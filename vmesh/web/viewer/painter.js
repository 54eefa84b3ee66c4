/** The painter for a canvas: WebGL 2 where there is one, the decoder's raster elsewhere. */

import { contextOf } from "./dom.js";
import { GlPainter } from "./gl_painter.js";
import { RasterPainter } from "./raster_painter.js";

/**
 * What is drawn over a picture: wireframe, vertices, and how many pixels of the device one of the
 * page is wide.
 *
 * @typedef {{wireframe?: boolean, vertices?: boolean, pixelRatio?: number}} Marks
 */

/** @param {HTMLCanvasElement} canvas */
export function painterFor(canvas) {
  // Edges between triangles need no smoothing: colours are the same on both sides.
  const gl = canvas.getContext("webgl2", { antialias: false, depth: false });
  return gl ? new GlPainter(gl) : new RasterPainter(contextOf(canvas));
}
