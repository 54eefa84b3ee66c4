#!/usr/bin/env node
/**
 * Decodes IN and writes OUT.mesh, the canonical text of the mesh, and OUT.pam, the picture, as
 * spec/conformance/README.md says:
 *
 *     node decode.js IN OUT
 *
 * Of a file that is refused the code is printed; the exit status is 1 and nothing is written.
 */

import { readFileSync, writeFileSync } from "node:fs";
import { inflateSync } from "node:zlib";
import { METADATA_TAGS, readFile } from "./container.js";
import { check } from "./errors.js";
import { DEFAULT_LIMITS, VmeshError, decode, render } from "./vmesh.js";

/** Bytes to which a metadata chunk may inflate. */
const MOST_METADATA = 2 ** 24;
/**
 * What `inflateSync` returns with the option `info`.
 *
 * @typedef {{buffer: Uint8Array, engine: import("node:zlib").Inflate}} InflatedWithInfo
 */
/** @type {Record<number, string>} */
const TUPLE_TYPES = { 1: "GRAYSCALE", 3: "RGB", 4: "RGB_ALPHA" };

/**
 * @param {Int32Array} array
 * @param {number} row
 * @param {number} length of a row
 */
function rowText(array, row, length) {
  return array.subarray(row * length, (row + 1) * length).join(" ");
}

/** @param {import("./vmesh.js").Mesh} mesh */
function meshText({ width, height, subdivision, depth, steps, vertices, levels, triangles }) {
  const [nVertices, nTriangles] = [vertices.length / 2, triangles.length / 3];
  const lines = [
    "vmesh 1.0",
    `canvas ${width} ${height}`,
    `subdivision ${subdivision}`,
    `depth ${depth}`,
    `steps ${steps.join(" ")}`,
    `vertices ${nVertices}`,
  ];
  for (let v = 0; v < nVertices; v++) {
    lines.push(`${rowText(vertices, v, 2)} ${rowText(levels, v, steps.length)}`);
  }
  lines.push(`triangles ${nTriangles}`);
  for (let t = 0; t < nTriangles; t++) lines.push(rowText(triangles, t, 3));
  return `${lines.join("\n")}\n`;
}

/** @param {import("./render.js").Picture} picture */
function pamFile({ width, height, components, depth, data }) {
  const header = [
    "P7",
    `WIDTH ${width}`,
    `HEIGHT ${height}`,
    `DEPTH ${components}`,
    `MAXVAL ${2 ** depth - 1}`,
    `TUPLTYPE ${TUPLE_TYPES[components]}`,
    "ENDHDR",
  ];
  return Buffer.concat([Buffer.from(`${header.join("\n")}\n`), bytesOf(data)]);
}

/**
 * Pictures need no metadata, so that `decode` leaves them alone; a whole file is checked here.
 *
 * @param {Uint8Array} bytes
 */
function checkMetadata(bytes) {
  for (const { tag, content } of readFile(bytes, DEFAULT_LIMITS).chunks) {
    if (METADATA_TAGS.includes(tag)) checkStream(content);
  }
}

/**
 * Checks that a content is one complete zlib stream of one byte or more.
 *
 * @param {Uint8Array} content
 */
function checkStream(content) {
  try {
    const inflated = inflateSync(content, { info: true, maxOutputLength: MOST_METADATA });
    const { buffer, engine } = /** @type {InflatedWithInfo} */ (/** @type {unknown} */ (inflated));
    check(buffer.length > 0 && engine.bytesWritten === content.length, "metadata");
  } catch (error) {
    const { code } = /** @type {NodeJS.ErrnoException} */ (error);
    throw new VmeshError(code === "ERR_BUFFER_TOO_LARGE" ? "limit" : "metadata");
  }
}

/**
 * The samples in bytes, the upper one first.
 *
 * @param {Uint8Array | Uint16Array} data
 */
function bytesOf(data) {
  if (data instanceof Uint8Array) return data;
  const bytes = new Uint8Array(2 * data.length);
  data.forEach((sample, i) => bytes.set([sample >> 8, sample & 255], 2 * i));
  return bytes;
}

/**
 * @param {string[]} paths
 * @returns {number} the exit status
 */
function main([input, output]) {
  if (output === undefined) {
    console.error("usage: node decode.js IN OUT");
    return 2;
  }
  try {
    const bytes = readFileSync(input);
    checkMetadata(bytes);
    const mesh = decode(bytes);
    const picture = render(mesh);
    writeFileSync(`${output}.mesh`, meshText(mesh));
    writeFileSync(`${output}.pam`, pamFile(picture));
    return 0;
  } catch (error) {
    if (!(error instanceof VmeshError)) throw error;
    console.log(error.code);
    return 1;
  }
}

process.exitCode = main(process.argv.slice(2));
