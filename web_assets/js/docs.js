// The API's schema for people, from /api/openapi.json.

import { $, el } from "./dom.js";

/** A part of a JSON schema. @typedef {Record<string, any>} Part */

/** @type {Part} */
const schema = await (await fetch("/api/openapi.json")).json();
$("#version").textContent = schema.info.version;

/** A part, or what it refers to. @param {Part | undefined} part @returns {Part | undefined} */
const resolved = (part) =>
  part?.$ref ? part.$ref.slice(2).split("/").reduce(inside, schema) : part;
/** @param {Part} part @param {string} key */
const inside = (part, key) => part[key];

/** Its type, in words. @param {Part} part @returns {string} */
const kind = ({ type, anyOf = [] }) =>
  type ?? anyOf.map((/** @type {Part} */ option) => option.type ?? "object").join(" or ");

/** Name and type of each parameter and field of a route. @param {Part} route */
function fields({ parameters = [], requestBody }) {
  const found = parameters.map((/** @type {Part} */ p) => [`${p.name} (${p.in})`, kind(p.schema)]);
  const sent = resolved(requestBody?.content?.["application/json"]?.schema);
  const body = sent?.anyOf ? resolved(sent.anyOf[0]) : sent;
  for (const [name, part] of Object.entries(body?.properties ?? {})) {
    const optional = body?.required?.includes(name) ? "" : " (optional)";
    found.push([name + optional, kind(part)]);
  }
  return found;
}

for (const [path, methods] of Object.entries(schema.paths))
  for (const [method, route] of Object.entries(/** @type {Part} */ (methods))) {
    const rows = fields(route).map((/** @type {string[]} */ [name, type]) =>
      el("li", {}, el("code", {}, name), ` ${type}`),
    );
    $("#routes").append(
      el(
        "div",
        { class: "route" },
        el("b", {}, method.toUpperCase()),
        el("code", {}, path),
        el("p", {}, route.description ?? route.summary ?? ""),
        rows.length ? el("ul", {}, ...rows) : null,
      ),
    );
  }
