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
import { VmeshError, decode, render } from "./vmesh.js";

const TUPLE_TYPES = { 1: "GRAYSCALE", 3: "RGB", 4: "RGB_ALPHA" };

function* rowsOf(array, length) {
  for (let at = 0; at < array.length; at += length) yield array.subarray(at, at + length);
}

function meshText({ width, height, subdivision, steps, vertices, levels, triangles }) {
  const lines = [
    "vmesh 0.1",
    `canvas ${width} ${height}`,
    `subdivision ${subdivision}`,
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

function pamFile({ width, height, depth, data }) {
  const header = [
    "P7",
    `WIDTH ${width}`,
    `HEIGHT ${height}`,
    `DEPTH ${depth}`,
    "MAXVAL 255",
    `TUPLTYPE ${TUPLE_TYPES[depth]}`,
    "ENDHDR",
  ];
  return Buffer.concat([Buffer.from(`${header.join("\n")}\n`), data]);
}

function main([input, output]) {
  if (output === undefined) {
    console.error("usage: node decode.js IN OUT");
    return 2;
  }
  try {
    const mesh = decode(readFileSync(input));
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
