import js from "@eslint/js";
import globals from "globals";

export default [
  js.configs.recommended,
  {
    linterOptions: { reportUnusedDisableDirectives: "error" },
    rules: {
      curly: ["error", "multi-line"],
      eqeqeq: "error",
      "no-shadow": "error",
      "no-useless-return": "error",
      "no-var": "error",
      "object-shorthand": "error",
      "prefer-arrow-callback": "error",
      "prefer-const": "error",
      "prefer-template": "error",
    },
  },
  { ignores: ["vmesh/web/dist/", "vmesh/web/types/"] },
  { files: ["tests/web/*.js"], languageOptions: { globals: globals.node } },
  // The decoder itself uses nothing but the language: it runs in browsers and in Node.
  { files: ["vmesh/web/decoder/decode.js"], languageOptions: { globals: globals.node } },
  { files: ["vmesh/web/viewer/*.js"], languageOptions: { globals: globals.browser } },
];
