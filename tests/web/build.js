/**
 * Builds the scripts of `vmesh/web/dist`, or of another folder:
 *
 *     node tests/web/build.js [FOLDER]
 */

import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const WEB = fileURLToPath(new URL("../../vmesh/web", import.meta.url));

/**
 * What pages run as it is: a module for the decoder, which has exports, and plain scripts.
 *
 * @type {{format: import("esbuild").Format, entryPoints: Record<string, string>}[]}
 */
const KINDS = [
  { format: "esm", entryPoints: { vmesh: "decoder/vmesh.js" } },
  {
    format: "iife",
    entryPoints: {
      "vmesh-image": "viewer/element.js",
      page: "viewer/page.js",
      report: "viewer/report.js",
    },
  },
];

for (const kind of KINDS) {
  await build({
    ...kind,
    absWorkingDir: WEB,
    outdir: process.argv[2] ?? "dist",
    banner: { js: "/* vmesh, MIT License */" },
    bundle: true,
    charset: "utf8",
    minify: true,
    target: "es2022",
  });
}
