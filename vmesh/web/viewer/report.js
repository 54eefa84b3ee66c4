/** A report: meshes beside their photographs, with a divider to drag. */

import { decode } from "../decoder/vmesh.js";
import { elementIn } from "./dom.js";
import { bytesIn } from "./embedded.js";
import { markingPainterFor } from "./marking_painters.js";
import { SharedPainter } from "./shared_painter.js";

const PAINTER = new SharedPainter(markingPainterFor);

class Comparison {
  /** @param {Element} section */
  constructor(section) {
    this.stage = elementIn(section, ".stage", HTMLElement);
    this.canvas = elementIn(section, "canvas", HTMLCanvasElement);
    this.photographColumns = this.canvas.width;
    this.wireframe = false;
    this.mesh = decode(bytesIn(elementIn(section, "script", HTMLElement)));
    const divider = elementIn(section, "input", HTMLInputElement);
    divider.addEventListener("input", () => this.divide(divider.value));
    const button = elementIn(section, "button", HTMLElement);
    button.addEventListener("click", () => this.toggle(button));
    new ResizeObserver(() => this.draw()).observe(this.stage);
    this.divide(divider.value); // where the browser kept it when the page was loaded again
  }

  /**
   * Shows the photograph on the left of a place, in percent, and the mesh on the right of it.
   *
   * @param {string} place
   */
  divide(place) {
    this.stage.style.setProperty("--place", `${place}%`);
  }

  /** @param {HTMLElement} button */
  toggle(button) {
    this.wireframe = !this.wireframe;
    button.setAttribute("aria-pressed", String(this.wireframe));
    this.draw();
  }

  draw() {
    const { mesh, canvas, wireframe } = this;
    const shown = Math.round(this.stage.clientWidth * devicePixelRatio);
    // The browser reduces the mesh as the photograph, but lines should not fade by that.
    const columns = wireframe ? shown : Math.max(shown, this.photographColumns);
    const rows = (columns * mesh.height) / mesh.width;
    PAINTER.paint(mesh, canvas, columns, rows, { wireframe });
  }
}

for (const section of document.querySelectorAll("section")) new Comparison(section);
