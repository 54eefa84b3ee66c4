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
const TUPLE_TYPES = { 1: "GRAYSCALE", 3: "RGB", 4: "RGB_ALPHA" };

function* rowsOf(array, length) {
  for (let at = 0; at < array.length; at += length) yield array.subarray(at, at + length);
}

function meshText({ width, height, subdivision, depth, steps, vertices, levels, triangles }) {
  const lines = [
    "vmesh 1.0",
    `canvas ${width} ${height}`,
    `subdivision ${subdivision}`,
    `depth ${depth}`,
    `steps ${steps.join(" ")}`,
    `vertices ${vertices.length / 2}`,
  ];
  const levelRows = rowsOf(levels, steps.length);
  for (const point of rowsOf(vertices, 2)) {
    lines.push(`${point.join(" ")} ${levelRows.next().value.join(" ")}`);
  }
  lines.push(`triangles ${triangles.length / 3}`);
  for (const triangle of rowsOf(triangles, 3)) lines.push(triangle.join(" "));
  return `${lines.join("\n")}\n`;
}

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
  return Buffer.concat([Buffer.from(`${header.join("\n")}\n`), bytesOf(data, depth)]);
}

/** Pictures need no metadata, so that `decode` leaves them alone; a whole file is checked here. */
function checkMetadata(bytes) {
  for (const { tag, content } of readFile(bytes, DEFAULT_LIMITS).chunks) {
    if (METADATA_TAGS.includes(tag)) checkStream(content);
  }
}

/** Checks that a content is one complete zlib stream of one byte or more. */
function checkStream(content) {
  try {
    const { buffer, engine } = inflateSync(content, { info: true, maxOutputLength: MOST_METADATA });
    check(buffer.length > 0 && engine.bytesWritten === content.length, "metadata");
  } catch (error) {
    throw new VmeshError(error.code === "ERR_BUFFER_TOO_LARGE" ? "limit" : "metadata");
  }
}

/** The samples in bytes, the upper one first. */
function bytesOf(data, depth) {
  if (depth === 8) return data;
  const bytes = new Uint8Array(2 * data.length);
  data.forEach((sample, i) => bytes.set([sample >> 8, sample & 255], 2 * i));
  return bytes;
}

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
