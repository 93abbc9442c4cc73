// Beyond the recommended rules: short lines, and no state that outlives whoever made it.

import js from "@eslint/js";
import globals from "globals";

import noMutableGlobals from "./no-mutable-globals.js";

export default [
  { ignores: ["cache/", "node_modules/", "types/", "vendor/"] },
  js.configs.recommended,
  {
    plugins: { studio: { rules: { "no-mutable-globals": noMutableGlobals } } },
    rules: {
      eqeqeq: ["error", "always", { null: "ignore" }],
      "max-len": ["error", 99],
      "max-lines": ["error", 250],
      "no-console": "error",
      "no-var": "error",
      "prefer-const": "error",
      "studio/no-mutable-globals": "error",
    },
  },
  { files: ["js/**", "replay/**"], languageOptions: { globals: globals.browser } },
  { files: ["js/pace.js", "js/webcam-worker.js"], languageOptions: { globals: globals.worker } },
  { files: ["tests/**", "*.js"], languageOptions: { globals: globals.node } },
];
