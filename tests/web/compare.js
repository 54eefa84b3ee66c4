/**
 * Compares the decoder of `dist` with the modules that it was built of, over files:
 *
 *     node compare.js FILE...
 */

import { deepStrictEqual } from "node:assert";
import { readFileSync } from "node:fs";
import * as modules from "../../vmesh/web/decoder/vmesh.js";
import * as built from "../../vmesh/web/dist/vmesh.js";

/**
 * @param {typeof modules} decoder
 * @param {Uint8Array} bytes
 */
function read(decoder, bytes) {
  try {
    const mesh = decoder.decode(bytes);
    return { mesh, picture: decoder.render(mesh) };
  } catch (error) {
    if (!(error instanceof decoder.VmeshError)) throw error;
    return { code: error.code, message: error.message };
  }
}

for (const path of process.argv.slice(2)) {
  const bytes = new Uint8Array(readFileSync(path));
  deepStrictEqual(read(built, bytes), read(modules, bytes), path);
}
console.log(`${process.argv.length - 2} files`);
