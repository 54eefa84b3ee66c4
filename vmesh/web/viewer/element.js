/**
 * `<vmesh-image src="photo.vmesh" alt="...">`: a mesh in a page as `<img>` shows a picture.
 *
 * Attributes: `src` (also a data URI), `alt`, `loading="lazy"`. Events: `load`, `error`. The CSS
 * properties `object-fit` and `object-position` do what they do for `<img>`.
 */

import { decode } from "../decoder/vmesh.js";
import { paintWhole } from "./shared_painter.js";

class VmeshImage extends HTMLElement {
  static observedAttributes = ["src", "alt"];

  constructor() {
    super();
    /** @type {import("../decoder/vmesh.js").Mesh | null} */
    this.mesh = null;
    /**
     * What is shown, or was to be.
     *
     * @type {string | null}
     */
    this.source = null;
    this.failed = false;
    this.internals = this.attachInternals();
    const root = this.attachShadow({ mode: "open" });
    this.sheet = document.createElement("style");
    this.canvas = document.createElement("canvas");
    this.text = document.createElement("span");
    root.append(this.sheet, this.canvas, this.text);
    this.setSheet("");
    this.sizes = new ResizeObserver(() => this.draw());
    this.sight = new IntersectionObserver((entries) => {
      if (entries.some((entry) => entry.isIntersecting)) this.load();
    }, { rootMargin: "256px" });
  }

  get src() {
    return this.getAttribute("src") ?? "";
  }

  set src(source) {
    this.setAttribute("src", source);
  }

  get alt() {
    return this.getAttribute("alt") ?? "";
  }

  set alt(text) {
    this.setAttribute("alt", text);
  }

  connectedCallback() {
    this.sizes.observe(this);
    this.start();
  }

  disconnectedCallback() {
    this.sizes.disconnect();
    this.sight.disconnect();
  }

  /** @param {string} name */
  attributeChangedCallback(name) {
    this.internals.role = this.alt === "" ? "presentation" : "img";
    this.internals.ariaLabel = this.alt;
    if (this.failed) this.text.textContent = this.alt;
    if (name === "src" && this.isConnected) this.start();
  }

  /** Loads the source, or waits until it is nearly in sight. */
  start() {
    this.sight.disconnect();
    if (this.getAttribute("loading") === "lazy") this.sight.observe(this);
    else this.load();
  }

  async load() {
    this.sight.disconnect();
    const source = this.src;
    if (!source || source === this.source) return;
    this.source = source;
    try {
      const response = await fetch(source);
      if (!response.ok) throw new Error(`${source}: ${response.status}`);
      const bytes = new Uint8Array(await response.arrayBuffer());
      if (source === this.source) this.show(decode(bytes));
    } catch (error) {
      if (source === this.source) this.fail(/** @type {Error} */ (error));
    }
  }

  /** @param {import("../decoder/vmesh.js").Mesh} mesh */
  show(mesh) {
    this.mesh = mesh;
    this.failed = false;
    this.text.textContent = "";
    this.setSheet(`width: ${mesh.width}px; aspect-ratio: ${mesh.width} / ${mesh.height};`);
    this.draw();
    this.dispatchEvent(new Event("load"));
  }

  /**
   * Shows the alternative text; the event says what was wrong.
   *
   * @param {Error} error
   */
  fail(error) {
    this.mesh = null;
    this.failed = true;
    this.setSheet("");
    this.text.textContent = this.alt;
    this.dispatchEvent(new ErrorEvent("error", { message: error.message, error }));
  }

  /**
   * The page's own rules for the element come before these.
   *
   * @param {string} size
   */
  setSheet(size) {
    this.sheet.textContent = `:host { display: inline-block; ${size} }
canvas { display: ${this.mesh ? "block" : "none"}; width: 100%; height: 100%;
  object-fit: inherit; object-position: inherit; }`;
  }

  draw() {
    if (!this.mesh || this.clientWidth === 0 || this.clientHeight === 0) return;
    const [columns, rows] = sizeFor(this.mesh, this, getComputedStyle(this).objectFit);
    paintWhole(this.mesh, this.canvas, columns, rows);
  }
}

/**
 * Columns and rows for the picture, one for each pixel of the device where it is shown.
 *
 * @param {import("../decoder/vmesh.js").Mesh} mesh
 * @param {Element} element
 * @param {string} fit
 */
function sizeFor({ width, height }, { clientWidth, clientHeight }, fit) {
  const [x, y] = [clientWidth / width, clientHeight / height];
  const contained = Math.min(x, y);
  const isNative = fit === "none" || (fit === "scale-down" && contained >= 1);
  /** @type {Record<string, number[]>} */
  const scales = { fill: [x, y], cover: [Math.max(x, y), Math.max(x, y)] };
  if (isNative) return [width, height];
  return (scales[fit] ?? [contained, contained]).map((scale, axis) => {
    return (axis === 0 ? width : height) * scale * devicePixelRatio;
  });
}

customElements.define("vmesh-image", VmeshImage);
