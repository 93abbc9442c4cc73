// Beyond the recommended rules: short lines, and no state that outlives whoever made it.

import js from "@eslint/js";
import globals from "globals";

const TOP = ":matches(Program, Program > ExportNamedDeclaration) > VariableDeclaration";
const EMPTY = "[init.callee.name=/^(Map|Set|Array)$/][init.arguments.length=0]";
const GLOBAL = "state belongs to an object that somebody makes, not to a file";

export default [
  { ignores: ["cache/", "node_modules/", "types/", "vendor/"] },
  js.configs.recommended,
  {
    rules: {
      eqeqeq: ["error", "always", { null: "ignore" }],
      "max-len": ["error", 99],
      "max-lines": ["error", 250],
      "no-console": "error",
      "no-var": "error",
      "prefer-const": "error",
      "no-restricted-syntax": [
        "error",
        { selector: `${TOP}[kind="let"]`, message: GLOBAL },
        // What is empty at first is there to be filled.
        { selector: `${TOP} > [init.elements.length=0]`, message: GLOBAL },
        { selector: `${TOP} > [init.properties.length=0]`, message: GLOBAL },
        {
          selector: `${TOP} > ${EMPTY}`,
          message: GLOBAL,
        },
      ],
    },
  },
  { files: ["js/**"], languageOptions: { globals: globals.browser } },
  { files: ["js/pace.js", "js/webcam-worker.js"], languageOptions: { globals: globals.worker } },
  { files: ["tests/**", "*.js"], languageOptions: { globals: globals.node } },
];
