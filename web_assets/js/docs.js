// The API's schema for people, from /api/openapi.json.
import { $, el } from "./ui.js";

const schema = await (await fetch("/api/openapi.json")).json();
$("#version").textContent = schema.info.version;
const resolve = (node) => (node?.$ref ? node.$ref.slice(2).split("/").reduce((at, key) => at[key], schema) : node);
const kind = (p) => p.type ?? (p.anyOf ?? []).map((option) => option.type ?? "object").join(" or ");

for (const [path, methods] of Object.entries(schema.paths))
  for (const [method, route] of Object.entries(methods)) {
    const fields = [];
    for (const p of route.parameters ?? []) fields.push([`${p.name} (${p.in})`, kind(p.schema)]);
    let body = resolve(route.requestBody?.content?.["application/json"]?.schema);
    if (body?.anyOf) body = resolve(body.anyOf[0]);
    for (const [name, p] of Object.entries(body?.properties ?? {}))
      fields.push([name + (body.required?.includes(name) ? "" : " (optional)"), kind(p)]);
    $("#routes").append(el("div", { class: "route" }, el("b", {}, method.toUpperCase()), el("code", {}, path),
      el("p", {}, route.description ?? route.summary ?? ""),
      fields.length ? el("ul", {}, ...fields.map(([name, type]) => el("li", {}, el("code", {}, name), ` ${type}`))) : null));
  }
