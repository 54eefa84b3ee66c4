/**
 * Colours by the ICC profile of a picture, as those of sRGB. Profiles of a matrix and curves, which
 * are those of displays and cameras, and of grey are understood; a picture with any other is left
 * as it is. As in ICC.1:2022, sections 9.2, 10.6, 10.18 and F.3; by the relative colorimetric intent.
 */

/** Bytes to which a profile may inflate. */
const MOST_BYTES = 2 ** 24;
/** From the XYZ of D50, in which profiles connect, to sRGB before its curve (B. Lindbloom). */
const FROM_XYZ = [
  [3.1338561, -1.6168667, -0.4906146],
  [-0.9787684, 1.9161415, 0.033454],
  [0.0719453, -0.2289914, 1.4052427],
];
const TAG_TABLE = 128;
const MOST_TAGS = 100;
/** Of the formulas of curves. */
const N_PARAMETERS = [1, 3, 4, 5, 7];
/** A little more than half a level of 8 bits: as far from each other are curves of one kind. */
const SAME = 0.0025;

/** @typedef {import("../decoder/vmesh.js").Mesh} Mesh */

/**
 * The ICC profile of a picture.
 *
 * @param {Pick<Mesh, "chunks">} mesh
 * @returns {Promise<Uint8Array | null>} null if there is none
 * @throws if it is damaged, or of more than 16 MiB
 */
export async function iccProfile({ chunks }) {
  const chunk = chunks.find(({ tag }) => tag === "i");
  if (!chunk) return null;
  const stored = new Blob([/** @type {Uint8Array<ArrayBuffer>} */ (chunk.content)]);
  const reader = stored.stream().pipeThrough(new DecompressionStream("deflate")).getReader();
  const parts = [];
  for (let length = 0; ;) {
    const { done, value } = await reader.read();
    if (done) return new Uint8Array(await new Blob(parts).arrayBuffer());
    length += value.length;
    if (length > MOST_BYTES) {
      await reader.cancel();
      throw new RangeError("the profile is too long");
    }
    parts.push(value);
  }
}

/**
 * A mesh with the colours of its vertices in sRGB, by its profile.
 *
 * @param {Mesh} mesh
 * @returns {Promise<Mesh>} with samples of 16 bits, of which its levels and steps say nothing; or the
 *   very mesh, if it has no profile, one that is not understood, or that of sRGB
 */
export async function toSrgb(mesh) {
  try {
    const profile = await iccProfile(mesh);
    return profile ? converted(mesh, new DataView(profile.buffer)) : mesh;
  } catch {
    return mesh;
  }
}

/**
 * @param {Mesh} mesh
 * @param {DataView} profile reading beyond its end throws
 */
function converted(mesh, profile) {
  const { samples, steps } = mesh;
  const largest = 2 ** mesh.depth - 1;
  const n = steps.length;
  const convert = conversionOf(profile, n, largest);
  const made = Uint16Array.from(samples, (sample) => (sample / largest) * 65535 + 0.5);
  let isSame = true;
  for (let at = 0; at < samples.length; at += n) {
    convert(samples.subarray(at, at + n)).forEach((light, i) => {
      const value = encoded(light);
      isSame &&= Math.abs(value - samples[at + i] / largest) < SAME;
      made[at + i] = value * 65535 + 0.5;
    });
  }
  return isSame ? mesh : { ...mesh, depth: 16, samples: made };
}

/**
 * What makes the light of sRGB of a colour.
 *
 * @param {DataView} profile
 * @param {number} n components of a colour
 * @param {number} largest sample
 * @returns {(color: Uint8Array | Uint16Array) => number[]}
 */
function conversionOf(profile, n, largest) {
  const kind = textAt(profile, 16) + textAt(profile, 20);
  const nTags = Math.min(profile.getUint32(TAG_TABLE), MOST_TAGS);
  /** @param {string} name */
  const tagOf = (name) => {
    let at = TAG_TABLE + 4;
    for (let i = 0; textAt(profile, at) !== name; at += 12) {
      if (++i >= nTags) throw new RangeError(`the profile has no ${name}`);
    }
    return new DataView(profile.buffer, profile.getUint32(at + 4), profile.getUint32(at + 8));
  };
  /** @param {string} name */
  const tableOf = (name) => {
    const curve = curveIn(tagOf(name));
    return Float64Array.from({ length: largest + 1 }, (_, sample) => curve(sample / largest));
  };
  if (n === 1 && kind.startsWith("GRAY")) {
    const table = tableOf("kTRC");
    const isLab = kind.endsWith("Lab ");
    return ([grey]) => [isLab ? lightOf(table[grey]) : table[grey]];
  }
  if (n === 1 || kind !== "RGB XYZ ") throw new RangeError("the profile is of another kind");
  const tables = ["rTRC", "gTRC", "bTRC"].map(tableOf);
  const columns = ["rXYZ", "gXYZ", "bXYZ"].map((tag) => fixedAt(tagOf(tag), 8, 3));
  const matrix = FROM_XYZ.map((row) => columns.map((column) => dot(row, column)));
  return (color) => {
    const light = tables.map((table, i) => table[color[i]]);
    return matrix.map((row) => dot(row, light));
  };
}

/**
 * A curve from samples to light, both from 0 to 1.
 *
 * @param {DataView} tag
 * @returns {(sample: number) => number}
 */
function curveIn(tag) {
  const kind = textAt(tag, 0);
  if (kind === "para") {
    const nParameters = N_PARAMETERS[tag.getUint16(8)];
    if (!nParameters) throw new RangeError("the curve has another formula");
    const [g, a = 1, b = 0, ...rest] = fixedAt(tag, 12, nParameters);
    const [c, d, e = 0, f = 0] = nParameters > 4 ? rest : [0, -b / a, rest[0], rest[0]];
    return (x) => (x >= d ? Math.max(a * x + b, 0) ** g + e : c * x + f);
  }
  const n = tag.getUint32(8);
  if (kind !== "curv") throw new RangeError("the curve is of another kind");
  if (n === 0) return (x) => x;
  if (n === 1) return (x) => x ** (tag.getUint16(12) / 256);
  /** @param {number} i */
  const entry = (i) => tag.getUint16(12 + 2 * i) / 65535;
  return (x) => {
    const i = Math.min(Math.floor(x * (n - 1)), n - 2);
    return entry(i) + (x * (n - 1) - i) * (entry(i + 1) - entry(i));
  };
}

/**
 * Numbers of 16 bits before and 16 after the point.
 *
 * @param {DataView} tag
 * @param {number} at
 * @param {number} n
 */
function fixedAt(tag, at, n) {
  return Array.from({ length: n }, (_, i) => tag.getInt32(at + 4 * i) / 65536);
}

/**
 * @param {DataView} bytes
 * @param {number} at
 */
function textAt(bytes, at) {
  return String.fromCharCode(...[0, 1, 2, 3].map((i) => bytes.getUint8(at + i)));
}

/**
 * @param {number[]} row
 * @param {number[]} column
 */
function dot(row, column) {
  return row[0] * column[0] + row[1] * column[1] + row[2] * column[2];
}

/**
 * The light of a grey by its lightness, both from 0 to 1 (CIE L*).
 *
 * @param {number} lightness
 */
function lightOf(lightness) {
  return lightness > 0.08 ? ((lightness + 0.16) / 1.16) ** 3 : lightness / 9.033;
}

/**
 * By the curve of sRGB.
 *
 * @param {number} light
 */
function encoded(light) {
  const y = Math.min(Math.max(light, 0), 1);
  return y > 0.0031308 ? 1.055 * y ** (1 / 2.4) - 0.055 : 12.92 * y;
}
