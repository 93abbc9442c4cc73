// Takes from elsewhere: dropped or chosen folders, zips, BVH files and frames, sent one by one.

import { $, capital, el, text, toast } from "./ui.js";
import { get, pageName } from "./net.js";
import { openReview } from "./review.js";

const PARTS = ["tape.mcap", "meta.json", "edits.jsonl"];
const SINGLE = /\.(zip|bvh|jsonl|json|ndjson)$/i;
const WANTED = "folders of takes, a .zip of them, a .bvh or human frames (.jsonl)";
let busy = Promise.resolve();

export const importZone = () => el("div", { class: "imports" },
  el("label", { class: "dropzone slim", id: "import-zone" },
    el("input", { type: "file", id: "import-files", multiple: true, accept: ".zip,.bvh,.jsonl,.json,.ndjson,.mcap", "aria-label": "Import takes or motions",
      onchange: (event) => chosen(event.target) }),
    el("b", {}, "Import takes"), el("span", {}, "drop a folder, zip, BVH or frames, or click")),
  el("div", { class: "row" },
    el("button", { id: "import-folder", title: "Choose a take's folder, or a folder of takes", onclick: () => $("#import-dir").click() }, "Folder …"),
    el("input", { type: "file", id: "import-dir", hidden: true, webkitdirectory: true, onchange: (event) => chosen(event.target) }),
    el("select", { id: "import-robot", title: "What a motion file's person is put beside", "aria-label": "What a motion file's person is put beside", onfocus: beside },
      el("option", { value: "" }, "Motions: robot stands by"))),
  el("ul", { class: "takes", id: "imports", "aria-live": "polite" }));

function chosen(input) {
  const files = [...input.files].map((file) => ({ path: file.webkitRelativePath || file.name, file }));
  input.value = "";
  importFiles(files);
}

// Whose robot an imported person is put beside: any take.
async function beside() {
  const select = $("#import-robot"), was = select.value;
  const takes = await get("/api/takes").catch(() => []);
  select.replaceChildren(el("option", { value: "" }, "Motions: robot stands by"),
    ...takes.reverse().slice(0, 200).map((take) => el("option", { value: take.name },
      `Beside ${(take.label || take.name).replaceAll("_", " ")} (${take.seconds.toFixed(1)} s)`)));
  select.value = takes.some((take) => take.name === was) ? was : "";
}

// What was dropped, folders and all. To be called while the event lasts.
export function importDrop(transfer) {
  const entries = [...(transfer?.items ?? [])].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
  const plain = [...(transfer?.files ?? [])].map((file) => ({ path: file.name, file }));
  if (!entries.length) return importFiles(plain);
  return Promise.all(entries.map(walk)).then((found) => importFiles(found.flat())).catch(() => importFiles(plain));
}

export const wantsImport = (transfer) =>
  [...(transfer?.items ?? [])].some((item) => item.webkitGetAsEntry?.()?.isDirectory) ||
  [...(transfer?.files ?? [])].some((file) => /\.(zip|mcap)$/i.test(file.name)) ||
  (transfer?.files?.length ?? 0) > 1;

async function walk(entry) {
  if (entry.isFile) {
    const file = await new Promise((done, fail) => entry.file(done, fail));
    return [{ path: entry.fullPath.replace(/^\//, ""), file }];
  }
  const reader = entry.createReader(), inside = [];
  for (;;) { // a reader gives a hundred at a time
    const some = await new Promise((done, fail) => reader.readEntries(done, fail));
    if (!some.length) break;
    inside.push(...some);
  }
  return (await Promise.all(inside.map(walk))).flat();
}

const folderOf = (path) => path.includes("/") ? path.slice(0, path.lastIndexOf("/")) : "";
const baseOf = (path) => path.slice(path.lastIndexOf("/") + 1);

// A job a take, a zip or a motion; what lies about beside them is left alone.
function jobsOf(files) {
  const folders = new Set(files.filter(({ path }) => baseOf(path) === "tape.mcap").map(({ path }) => folderOf(path)));
  const jobs = [...folders].map((folder) => ({
    name: baseOf(folder) || "take",
    files: files.filter(({ path }) => folderOf(path) === folder && PARTS.includes(baseOf(path))).map(({ file }) => file),
  }));
  for (const { path, file } of files)
    if (SINGLE.test(path) && !PARTS.includes(baseOf(path))) jobs.push({ name: baseOf(path), files: [file], single: true });
  return jobs;
}

export function importFiles(files) {
  if (!files.length) return busy;
  const jobs = jobsOf(files);
  if (!jobs.length) {
    const what = files.length === 1 ? baseOf(files[0].path) : `None of these ${files.length} files`;
    fail(row(what), `${what} cannot be imported: give ${WANTED}`);
    return busy;
  }
  for (const job of jobs) {
    const line = row(job.name);
    busy = busy.then(() => send(job, line));
  }
  return busy;
}

function row(name) {
  const line = el("li", { class: "import" },
    el("div", { class: "name" }, el("b", { title: name }, name), el("span", {}, "waiting"), el("div", { class: "meter" }, el("i", {}))),
    el("button", { class: "away", title: "Clear", "aria-label": `Clear ${name}`, hidden: true, onclick: () => line.remove() }, "✕"));
  $("#imports").append(line);
  line.scrollIntoView({ block: "nearest" });
  return line;
}

const say = (line, words) => text($("span", line), words);
const fill = (line, share) => { $(".meter i", line).style.transform = `scaleX(${share})`; };

function fail(line, why) {
  line.classList.add("failed");
  line.setAttribute("role", "alert");
  const name = $("b", line).textContent; // it stands above: what is wrong with it is enough
  say(line, capital(why.startsWith(name) ? why.slice(name.length).replace(/^[\s,:]+/, "") : why));
  $(".meter", line).hidden = true;
  $(".away", line).hidden = false;
  if (!line.offsetParent) toast(why); // the list is not on the screen
}

function send(job, line) {
  const form = new FormData();
  for (const file of job.files) form.append("files", file, file.name);
  form.append("name", job.name);
  if (job.single && $("#import-robot").value) form.append("robot", /\.zip$/i.test(job.name) ? "" : $("#import-robot").value);
  return new Promise((done) => {
    const request = new XMLHttpRequest();
    request.open("POST", "/api/takes/import");
    if (pageName()) request.setRequestHeader("X-Studio-Page", pageName());
    request.upload.onprogress = ({ loaded, total }) => {
      fill(line, total ? loaded / total : 0);
      say(line, loaded < total ? `sending, ${Math.round((100 * loaded) / total)} %` : "reading …");
      line.classList.toggle("reading", loaded >= total);
    };
    request.onerror = () => { fail(line, "the studio does not answer"); done(); };
    request.onload = () => { line.classList.remove("reading"); ended(request, line); done(); };
    request.send(form);
  });
}

function ended(request, line) {
  let answer = {};
  try { answer = JSON.parse(request.responseText); } catch { /* no JSON: the status says it */ }
  if (request.status !== 200) return fail(line, answer.why ?? answer.error ?? `refused (${request.status})`);
  const { takes, refused = {}, rejected = 0 } = answer;
  const not = Object.entries(refused);
  line.classList.add("done");
  fill(line, 1);
  say(line, [takes.length === 1 ? `is take ${takes[0]}` : `${takes.length} takes`,
    rejected ? `${rejected} bad frames left out` : "", not.length ? `${not.length} refused` : ""].filter(Boolean).join(" · "));
  if (takes.length === 1)
    line.insertBefore(el("button", { title: "Scrub, trim, align, judge", onclick: () => openReview(takes[0]) }, "Review"), $(".away", line));
  $(".away", line).hidden = false;
  for (const [name, why] of not) fail(row(name), why);
  if (!line.offsetParent) toast(`${takes.join(", ")}: in Collect, under Takes`, "good");
  document.dispatchEvent(new CustomEvent("takes-changed"));
}
