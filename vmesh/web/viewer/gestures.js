/** Mouse, touch and keyboard on a stage, as changes of its view. */

const KEY_STEP = 64; // pixels of the page
const KEY_FACTOR = 1.25;

/** @typedef {[number, number]} Place */

/**
 * @param {HTMLElement} stage
 * @param {import("./view.js").View} view
 * @param {() => void} changed called after each change
 */
export function listenToGestures(stage, view, changed) {
  listenToPointers(stage, view, changed);
  stage.addEventListener("wheel", (event) => {
    event.preventDefault();
    // Lines and pages of a wheel count as 16 and 400 pixels.
    const distance = event.deltaY * [1, 16, 400][event.deltaMode];
    view.zoomAt(2 ** (-distance / 240), ...placeOf(stage, event));
    changed();
  }, { passive: false });
  stage.addEventListener("dblclick", (event) => {
    view.zoomAt(2, ...placeOf(stage, event));
    changed();
  });
  stage.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !act(view, event.key)) return;
    event.preventDefault();
    changed();
  });
}

/**
 * Changes the view as a key says; whether it says anything.
 *
 * @param {import("./view.js").View} view
 * @param {string} key
 */
function act(view, key) {
  const step = KEY_STEP * devicePixelRatio;
  /** @type {Record<string, number[]>} */
  const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  if (key in moves) view.pan(moves[key][0] * step, moves[key][1] * step);
  else if (key === "+" || key === "=") view.zoomAt(KEY_FACTOR, view.columns / 2, view.rows / 2);
  else if (key === "-") view.zoomAt(1 / KEY_FACTOR, view.columns / 2, view.rows / 2);
  else if (key === "0") view.fit();
  else if (key === "1") view.center(1);
  else return false;
  return true;
}

/**
 * One pointer moves the picture; two also zoom by their distance.
 *
 * @param {HTMLElement} stage
 * @param {import("./view.js").View} view
 * @param {() => void} changed
 */
function listenToPointers(stage, view, changed) {
  /** @type {Map<number, Place>} */
  const places = new Map();
  stage.addEventListener("pointerdown", (event) => {
    stage.setPointerCapture(event.pointerId);
    places.set(event.pointerId, placeOf(stage, event));
  });
  stage.addEventListener("pointermove", (event) => {
    if (!places.has(event.pointerId)) return;
    const before = spanOf([...places.values()]);
    places.set(event.pointerId, placeOf(stage, event));
    const after = spanOf([...places.values()]);
    view.pan(before.x - after.x, before.y - after.y);
    if (before.length > 0) view.zoomAt(after.length / before.length, after.x, after.y);
    changed();
  });
  for (const type of /** @type {const} */ (["pointerup", "pointercancel"])) {
    stage.addEventListener(type, (event) => places.delete(event.pointerId));
  }
}

/**
 * The middle of the first two places, and the distance between them; 0 of a single one.
 *
 * @param {Place[]} places
 */
function spanOf([first, second = first]) {
  const [dx, dy] = [second[0] - first[0], second[1] - first[1]];
  return { x: first[0] + dx / 2, y: first[1] + dy / 2, length: Math.hypot(dx, dy) };
}

/**
 * Where an event is on the stage, in pixels of the device.
 *
 * @param {HTMLElement} stage
 * @param {MouseEvent} event
 * @returns {Place}
 */
function placeOf(stage, event) {
  const box = stage.getBoundingClientRect();
  return [
    (event.clientX - box.left) * devicePixelRatio,
    (event.clientY - box.top) * devicePixelRatio,
  ];
}
