/** The painter for a canvas: WebGL 2 where there is one, the decoder's raster elsewhere. */

import { GlPainter } from "./glpainter.js";
import { RasterPainter } from "./rasterpainter.js";

/** @param {HTMLCanvasElement} canvas */
export function painterFor(canvas) {
  // Edges between triangles need no smoothing: colours are the same on both sides.
  const gl = canvas.getContext("webgl2", { antialias: false, depth: false });
  return gl ? new GlPainter(gl) : new RasterPainter(canvas.getContext("2d"));
}
