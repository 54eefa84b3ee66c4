/**
 * `<vmesh-image src="photo.vmesh" alt="...">`: a mesh in a page as `<img>` shows a picture.
 *
 * Attributes: `src` (also a data URI), `alt`, `width`, `height`, `loading="lazy"`. Events: `load`,
 * `error`. The CSS properties `object-fit` and `object-position` do what they do for `<img>`. What
 * stands in the element is shown until there is a picture, and where there is none.
 *
 * The script may run more than once in a page, and where there are no pages, such as on a server.
 */

import { decode } from "../decoder/vmesh.js";
import { painterFor } from "./painter.js";
import { toSrgb } from "./profile.js";
import { SharedPainter } from "./shared_painter.js";

const PAINTER = new SharedPainter(painterFor);

/** Where there are no elements the class is not used. */
const Base = globalThis.HTMLElement ?? class {};

/** The element; it is defined where this module is imported, unless it is already. */
export class VmeshImage extends Base {
  static observedAttributes = ["src", "alt", "width", "height", "loading"];

  /** @type {import("../decoder/vmesh.js").Mesh | null} */
  #mesh = null;
  /** What is shown, or is to be. */
  #source = "";
  #internals = this.attachInternals();
  // A style element is what a content security policy may forbid.
  #sheet = new CSSStyleSheet();
  #canvas = document.createElement("canvas");
  #text = document.createElement("span");
  #sizes = new ResizeObserver(() => this.#draw());
  #sight = new IntersectionObserver((entries) => {
    if (entries.some((entry) => entry.isIntersecting)) this.#load();
  }, { rootMargin: "256px" });

  constructor() {
    super();
    const root = this.attachShadow({ mode: "open" });
    root.adoptedStyleSheets = [this.#sheet];
    root.append(this.#canvas, document.createElement("slot"), this.#text);
    this.#setMesh(null);
    // What a script has set before the element was defined.
    for (const name of /** @type {const} */ (["src", "alt"])) {
      if (!Object.hasOwn(this, name)) continue;
      const value = this[name];
      delete (/** @type {Partial<VmeshImage>} */ (this)[name]);
      this[name] = value;
    }
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
    this.#sizes.observe(this);
    this.#start();
  }

  disconnectedCallback() {
    this.#sizes.disconnect();
    this.#sight.disconnect();
  }

  /** @param {string} name */
  attributeChangedCallback(name) {
    this.#internals.role = this.alt === "" ? "presentation" : "img";
    this.#internals.ariaLabel = this.alt;
    if (this.#text.textContent) this.#text.textContent = this.alt;
    this.#setStyle();
    if ((name === "src" || name === "loading") && this.isConnected) this.#start();
  }

  /** Loads the source, or waits until it is nearly in sight. */
  #start() {
    this.#sight.disconnect();
    if (this.getAttribute("loading") === "lazy") this.#sight.observe(this);
    else this.#load();
  }

  async #load() {
    this.#sight.disconnect();
    const source = this.src;
    if (source === this.#source) return;
    this.#source = source;
    if (!source) return this.#setMesh(null);
    try {
      const response = await fetch(source);
      if (!response.ok) throw new Error(`${source}: ${response.status}`);
      const mesh = await toSrgb(decode(new Uint8Array(await response.arrayBuffer())));
      if (source === this.#source) this.#show(mesh);
    } catch (error) {
      if (source === this.#source) this.#fail(/** @type {Error} */ (error));
    }
  }

  /** @param {import("../decoder/vmesh.js").Mesh} mesh */
  #show(mesh) {
    this.#setMesh(mesh);
    this.dispatchEvent(new Event("load"));
  }

  /**
   * Shows what stands in the element, or the alternative text; the event says what was wrong.
   *
   * @param {Error} error
   */
  #fail(error) {
    this.#source = ""; // which may be tried again
    this.#setMesh(null);
    const isEmpty = !this.firstElementChild && !this.textContent?.trim();
    if (isEmpty) this.#text.textContent = this.alt;
    this.dispatchEvent(new ErrorEvent("error", { message: error.message, error }));
  }

  /** @param {import("../decoder/vmesh.js").Mesh | null} mesh */
  #setMesh(mesh) {
    this.#mesh = mesh;
    this.#text.textContent = "";
    this.#setStyle();
    this.#draw();
  }

  /** The page's own rules for the element come before these. */
  #setStyle() {
    const mesh = this.#mesh;
    const [width, height] = ["width", "height"].map((name) => lengthOf(this.getAttribute(name)));
    const [across, down] = mesh ? [mesh.width, mesh.height] : [width, height].map(parseFloat);
    this.#sheet.replaceSync(`
:host { display: inline-block; aspect-ratio: ${across} / ${down};
  width: ${width || (mesh && !height ? `${across}px` : "auto")}; height: ${height || "auto"}; }
:host([hidden]) { display: none; }
canvas, ::slotted(img) { display: block; width: 100%; height: 100%;
  object-fit: inherit; object-position: inherit; }
${mesh ? "slot" : "canvas"} { display: none; }`);
  }

  #draw() {
    const mesh = this.#mesh;
    if (!mesh || this.clientWidth === 0 || this.clientHeight === 0) return;
    const [columns, rows] = sizeFor(mesh, this, getComputedStyle(this).objectFit);
    PAINTER.paint(mesh, this.#canvas, columns, rows);
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

/**
 * A length of CSS by an attribute as those of `<img>`: pixels, or percent.
 *
 * @param {string | null} text
 */
function lengthOf(text) {
  const [, number, percent] = /^\s*(\d+(?:\.\d+)?)(%?)/.exec(text ?? "") ?? [];
  return number ? number + (percent || "px") : "";
}

if (globalThis.customElements && !customElements.get("vmesh-image")) {
  customElements.define("vmesh-image", VmeshImage);
}
