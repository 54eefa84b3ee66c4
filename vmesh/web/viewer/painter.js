/** The painter for a canvas: WebGL 2 where there is one, the decoder's raster elsewhere. */

import { contextOf, glOf } from "./dom.js";
import { GlPainter } from "./gl_painter.js";
import { RasterPainter } from "./raster_painter.js";

/** @param {HTMLCanvasElement} canvas */
export function painterFor(canvas) {
  const gl = glOf(canvas);
  return gl ? new GlPainter(gl) : new RasterPainter(contextOf(canvas));
}
