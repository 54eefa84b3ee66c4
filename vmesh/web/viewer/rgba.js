/** Samples as red, green, blue and alpha. */

/**
 * @template {Float64Array | Uint8ClampedArray} T
 * @param {T} target gets four numbers a colour
 * @param {Uint8Array | Uint16Array} samples grey, RGB, or RGB and alpha of each
 * @param {number} components
 * @param {number} depth bits of a sample
 * @param {number} largest what the largest sample becomes, and alpha where there is none
 * @returns {T} the target
 */
export function fillRgba(target, samples, components, depth, largest) {
  const gain = largest / (2 ** depth - 1);
  target.fill(largest);
  for (let at = 0, place = 0; at < samples.length; at += components, place += 4) {
    for (let i = 0; i < Math.max(components, 3); i++) {
      target[place + i] = samples[at + (components === 1 ? 0 : i)] * gain;
    }
  }
  return target;
}
