/** What the scripts need of a page and a browser, or an error. */

/**
 * The element of a page that a selector finds.
 *
 * @template {Element} T
 * @param {ParentNode} root
 * @param {string} selector
 * @param {new () => T} kind
 * @returns {T}
 */
export function elementIn(root, selector, kind) {
  const found = root.querySelector(selector);
  if (found instanceof kind) return found;
  throw new Error(`there is no ${kind.name} ${selector}`);
}

/** @param {HTMLCanvasElement} canvas that has no context of another kind */
export function contextOf(canvas) {
  const context = canvas.getContext("2d");
  if (context) return context;
  throw new Error("there is no context to draw with");
}

/**
 * WebGL 2, or null where there is none.
 *
 * @param {HTMLCanvasElement} canvas that has no context of another kind
 */
export function glOf(canvas) {
  // Edges between triangles need no smoothing: colours are the same on both sides.
  return canvas.getContext("webgl2", { antialias: false, depth: false });
}
