/** Which part of a picture a stage shows, and how large. */

const MOST_SCALE = 64;

/**
 * Where a painter shows the picture, in pixels of the device.
 *
 * @typedef {object} Frame
 * @property {number} columns of the canvas
 * @property {number} rows
 * @property {number} left side of the picture
 * @property {number} top
 * @property {number} scaleX pixels of the device for each of the picture
 * @property {number} scaleY
 */

export class View {
  constructor() {
    /** The picture, in its pixels. */
    this.width = 1;
    this.height = 1;
    /** The stage, in pixels of the device. */
    this.columns = 1;
    this.rows = 1;
    /** Pixels of the device for each of the picture. */
    this.scale = 1;
    /** The point of the picture in the middle of the stage. */
    this.x = 0;
    this.y = 0;
    /** Whether the picture fills the stage, also when that changes its size. */
    this.isFitted = true;
  }

  /**
   * @param {number} width
   * @param {number} height
   */
  setPicture(width, height) {
    this.width = width;
    this.height = height;
    this.fit();
  }

  /**
   * @param {number} columns
   * @param {number} rows
   */
  setStage(columns, rows) {
    this.columns = columns;
    this.rows = rows;
    if (this.isFitted) this.fit();
  }

  get fittedScale() {
    return Math.min(this.columns / this.width, this.rows / this.height);
  }

  /** Shows all of the picture as large as the stage allows. */
  fit() {
    this.center(this.fittedScale);
    this.isFitted = true;
  }

  /** @param {number} scale */
  center(scale) {
    this.scale = scale;
    this.x = this.width / 2;
    this.y = this.height / 2;
    this.isFitted = false;
  }

  /**
   * Enlarges by a factor; the picture stays where it is at a place of the stage.
   *
   * @param {number} factor
   * @param {number} column
   * @param {number} row
   */
  zoomAt(factor, column, row) {
    const least = Math.min(this.fittedScale, 1) / 4;
    const most = Math.max(this.fittedScale, MOST_SCALE);
    const scale = clamp(this.scale * factor, least, most);
    const gain = 1 / this.scale - 1 / scale;
    this.scale = scale;
    this.pan((column - this.columns / 2) * gain * scale, (row - this.rows / 2) * gain * scale);
  }

  /**
   * Moves the stage over the picture by pixels of the device.
   *
   * @param {number} columns
   * @param {number} rows
   */
  pan(columns, rows) {
    this.x = clamp(this.x + columns / this.scale, 0, this.width);
    this.y = clamp(this.y + rows / this.scale, 0, this.height);
    this.isFitted = false;
  }

  /**
   * The picture starts at a whole pixel of the device.
   *
   * @returns {Frame}
   */
  get frame() {
    const { columns, rows, scale } = this;
    const left = Math.round(columns / 2 - this.x * scale);
    const top = Math.round(rows / 2 - this.y * scale);
    return { columns, rows, left, top, scaleX: scale, scaleY: scale };
  }
}

/**
 * @param {number} value
 * @param {number} least
 * @param {number} most
 */
function clamp(value, least, most) {
  return Math.min(Math.max(value, least), most);
}
