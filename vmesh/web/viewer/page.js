/** The page that shows the `.vmesh` file inside it, or one that is dropped on it. */

import { decode } from "../decoder/vmesh.js";
import { elementIn } from "./dom.js";
import { bytesIn } from "./embedded.js";
import { listenToGestures } from "./gestures.js";
import { MarkingGlPainter, markingPainterFor } from "./marking_painters.js";
import { toSrgb } from "./profile.js";
import { View } from "./view.js";

/** The marks that are switched on and off, and the keys that do so. */
const TOGGLES = /** @type {const} */ ({ wireframe: "w", vertices: "v" });

/** @typedef {keyof typeof TOGGLES} Toggle */

class Page {
  constructor() {
    this.stage = elementIn(document, "#stage", HTMLElement);
    this.canvas = elementIn(document, "canvas", HTMLCanvasElement);
    this.failure = elementIn(document, "#failure", HTMLElement);
    this.zoom = elementIn(document, "#zoom", HTMLElement);
    this.marks = { wireframe: false, vertices: false };
    this.view = new View();
    this.painter = markingPainterFor(this.canvas);
    /** @type {import("../decoder/vmesh.js").Mesh | null} */
    this.mesh = null;
    /**
     * The file that is shown, or is to be.
     *
     * @type {Uint8Array | null}
     */
    this.asked = null;
    /** @type {number | null} */
    this.frame = null;
    this.listen();
  }

  listen() {
    this.canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    this.canvas.addEventListener("webglcontextrestored", () => {
      if (this.painter instanceof MarkingGlPainter) this.painter.restore();
      this.draw();
    });
    listenToGestures(this.stage, this.view, () => this.request());
    new ResizeObserver((entries) => this.resize(entries[0])).observe(this.stage);
    for (const name of /** @type {Toggle[]} */ (Object.keys(TOGGLES))) {
      const button = elementIn(document, `#${name}`, HTMLElement);
      button.addEventListener("click", () => this.toggle(name, button));
      document.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        if (event.key === TOGGLES[name]) button.click();
      });
    }
    elementIn(document, "#fit", HTMLElement).addEventListener("click", () => {
      this.view.fit();
      this.request();
    });
    addEventListener("dragover", (event) => event.preventDefault());
    addEventListener("drop", (event) => {
      event.preventDefault();
      const file = event.dataTransfer?.files[0];
      if (file) file.arrayBuffer().then((buffer) => this.show(new Uint8Array(buffer), file.name));
    });
  }

  /**
   * Shows a file under a name, or what is wrong with it.
   *
   * @param {Uint8Array} bytes
   * @param {string} name
   */
  async show(bytes, name) {
    this.asked = bytes;
    try {
      const mesh = await toSrgb(decode(bytes));
      if (this.asked !== bytes) return;
      this.painter.setMesh(mesh);
      this.mesh = mesh;
      this.view.setPicture(mesh.width, mesh.height);
      this.canvas.setAttribute("aria-label", name);
      document.title = name;
      this.failure.hidden = true;
    } catch (error) {
      if (this.asked !== bytes) return;
      this.mesh = null;
      const { message } = /** @type {Error} */ (error);
      this.failure.textContent = `${name} cannot be shown: ${message}`;
      this.failure.hidden = false;
    }
    this.canvas.hidden = !this.mesh;
    this.request();
  }

  /**
   * @param {Toggle} name
   * @param {HTMLElement} button
   */
  toggle(name, button) {
    this.marks[name] = !this.marks[name];
    button.setAttribute("aria-pressed", String(this.marks[name]));
    this.request();
  }

  /**
   * A canvas has as many pixels as the device has on the stage, however it is scaled.
   *
   * @param {ResizeObserverEntry} entry
   */
  resize(entry) {
    const box = entry.devicePixelContentBoxSize?.[0];
    const columns = exactSide(entry.contentRect.width, box?.inlineSize);
    const rows = exactSide(entry.contentRect.height, box?.blockSize);
    this.view.setStage(Math.max(columns, 1), Math.max(rows, 1));
    this.draw();
  }

  /** Draws before the next frame, once, however many changes there are. */
  request() {
    this.frame ??= requestAnimationFrame(() => this.draw());
  }

  draw() {
    if (this.frame) cancelAnimationFrame(this.frame);
    this.frame = null;
    if (!this.mesh) return;
    this.painter.draw(this.view.frame, { ...this.marks, pixelRatio: devicePixelRatio });
    this.zoom.textContent = `${Math.round(100 * this.view.scale)} %`;
  }
}

/**
 * Pixels of the device on a side of the stage: as the browser rounds them where it says so, unless
 * it speaks of another screen than the one it pretends to have.
 *
 * @param {number} length in pixels of the page
 * @param {number} [told] what the browser says
 */
function exactSide(length, told) {
  const side = length * devicePixelRatio;
  return told !== undefined && Math.abs(told - side) < 1 ? told : Math.round(side);
}

const picture = elementIn(document, "#picture", HTMLElement);
const page = new Page();
page.show(bytesIn(picture), picture.dataset.name ?? "");
