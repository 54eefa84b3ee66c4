/** The page that shows the `.vmesh` file inside it, or one that is dropped on it. */

import { decode } from "../decoder/vmesh.js";
import { bytesIn } from "./embedded.js";
import { listenToGestures } from "./gestures.js";
import { painterFor } from "./painter.js";
import { View } from "./view.js";

const TOGGLES = { wireframe: "w", vertices: "v" };

class Page {
  constructor() {
    this.stage = document.getElementById("stage");
    this.canvas = document.querySelector("canvas");
    this.failure = document.getElementById("failure");
    this.zoom = document.getElementById("zoom");
    this.marks = {};
    this.view = new View();
    this.painter = painterFor(this.canvas);
    this.canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    this.canvas.addEventListener("webglcontextrestored", () => {
      this.painter.prepare();
      this.draw();
    });
    this.listen();
  }

  listen() {
    listenToGestures(this.stage, this.view, () => this.request());
    new ResizeObserver((entries) => this.resize(entries[0])).observe(this.stage);
    for (const [name, key] of Object.entries(TOGGLES)) {
      const button = document.getElementById(name);
      button.addEventListener("click", () => this.toggle(name, button));
      document.addEventListener("keydown", (event) => {
        if (event.key === key && !event.ctrlKey && !event.metaKey && !event.altKey) button.click();
      });
    }
    document.getElementById("fit").addEventListener("click", () => {
      this.view.fit();
      this.request();
    });
    addEventListener("dragover", (event) => event.preventDefault());
    addEventListener("drop", (event) => {
      event.preventDefault();
      const file = event.dataTransfer.files[0];
      if (file) file.arrayBuffer().then((buffer) => this.show(new Uint8Array(buffer), file.name));
    });
  }

  /** Shows a file under a name, or what is wrong with it. */
  show(bytes, name) {
    try {
      const mesh = decode(bytes);
      this.painter.setMesh(mesh);
      this.mesh = mesh;
      this.view.setPicture(mesh.width, mesh.height);
      this.canvas.setAttribute("aria-label", name);
      document.title = name;
      this.failure.hidden = true;
    } catch (error) {
      this.mesh = null;
      this.failure.textContent = `${name} cannot be shown: ${error.message}`;
      this.failure.hidden = false;
    }
    this.canvas.hidden = !this.mesh;
    this.request();
  }

  toggle(name, button) {
    this.marks[name] = !this.marks[name];
    button.setAttribute("aria-pressed", this.marks[name]);
    this.request();
  }

  /** A canvas has as many pixels as the device has on the stage, however it is scaled. */
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
 */
function exactSide(length, told) {
  const side = length * devicePixelRatio;
  return Math.abs(told - side) < 1 ? told : Math.round(side);
}

const picture = document.getElementById("picture");
const page = new Page();
page.show(bytesIn(picture), picture.dataset.name);
