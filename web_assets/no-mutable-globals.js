// A rule: what a file keeps at its top level is never changed. State belongs to an object that
// somebody makes; a class of which one is made there changes itself, by its own methods.

const GLOBAL = "state belongs to an object that somebody makes, not to a file";
const CONTAINERS = /^(Map|Set|WeakMap|WeakSet|Array)$/;
const CHANGES =
  /^(push|pop|shift|unshift|splice|sort|reverse|fill|copyWithin|set|add|delete|clear)$/;

/** Whether an expression makes a plain object, a list or a container. @param {any} node */
const plain = (node) =>
  ["ObjectExpression", "ArrayExpression"].includes(node?.type) ||
  (node?.type === "NewExpression" && CONTAINERS.test(node.callee.name)) ||
  (node?.type === "CallExpression" &&
    ["freeze", "fromEntries", "assign"].includes(node.callee.property?.name));

/** Whether what a name refers to is changed where the name stands. @param {any} node */
function changed(node) {
  let inner = node;
  while (inner.parent.type === "MemberExpression" && inner.parent.object === inner)
    inner = inner.parent;
  const { parent } = inner;
  if (inner !== node) {
    if (parent.type === "AssignmentExpression") return parent.left === inner;
    if (parent.type === "UpdateExpression") return true;
    if (parent.type === "UnaryExpression") return parent.operator === "delete";
    if (parent.type === "CallExpression" && parent.callee === inner)
      return CHANGES.test(inner.property.name);
  }
  return (
    parent.type === "CallExpression" &&
    parent.arguments[0] === inner &&
    parent.callee.object?.name === "Object" &&
    ["assign", "defineProperty"].includes(parent.callee.property.name)
  );
}

/** @type {import("eslint").Rule.RuleModule} */
export default {
  meta: { type: "problem", messages: { global: GLOBAL }, schema: [] },
  create: (context) => ({
    "Program:exit": () => {
      const { globalScope } = context.sourceCode.scopeManager;
      const scope = globalScope?.childScopes.find(({ type }) => type === "module");
      for (const variable of scope?.variables ?? []) {
        const [definition] = variable.defs;
        if (definition?.type !== "Variable") continue;
        if (definition.parent?.kind !== "const") {
          context.report({ node: definition.node, messageId: "global" });
          continue;
        }
        if (!plain(definition.node.init)) continue;
        for (const { identifier } of variable.references)
          if (changed(identifier)) context.report({ node: identifier, messageId: "global" });
      }
    },
  }),
};
