// Takes from elsewhere: dropped or chosen folders, zips, BVH files and frames, sent one by one.

import { $, $select, el, icon, setStyle, takesChanged, text, toast } from "./dom.js";
import { baseOf, jobsOf } from "./files.js";
import { capital, spoken } from "./words.js";

/** @import { Found, Job } from "./files.js" */
/** @import { Imported } from "../types/page.js" */
/** @import { Studio } from "./studio.js" */

const WANTED = "folders of takes, a .zip of them, a .bvh or human frames (.jsonl)";
const ACCEPTED = ".zip,.bvh,.jsonl,.json,.ndjson,.mcap";
const BESIDE = "What a motion file's person is put beside";
const ALONE = ["", "Motions: robot stands by"];
const OFFERED = 200; // takes to put a motion beside

export class Importer {
  /** Ends when all that was asked for is sent. @type {Promise<void>} */
  #busy = Promise.resolve();

  /** @param {Studio} studio @param {(take: string) => void} openReview */
  constructor(studio, openReview) {
    this.studio = studio;
    this.openReview = openReview;
  }

  /** Where takes are dropped and chosen, for a panel. */
  zone() {
    const onchange = (/** @type {Event} */ event) =>
      this.#chosen(/** @type {HTMLInputElement} */ (event.target));
    const files = { type: "file", id: "import-files", multiple: true, accept: ACCEPTED, onchange };
    const folder = {
      type: "file",
      id: "import-dir",
      hidden: true,
      webkitdirectory: true,
      onchange,
    };
    return el(
      "div",
      { class: "imports" },
      el(
        "label",
        { class: "dropzone slim", id: "import-zone" },
        el("input", { ...files, "aria-label": "Import takes or motions" }),
        el("b", {}, "Import takes"),
        el("span", {}, "drop a folder, zip, BVH or frames, or click"),
      ),
      el(
        "div",
        { class: "row" },
        el(
          "button",
          {
            id: "import-folder",
            title: "Choose a take's folder, or a folder of takes",
            onclick: () => $("#import-dir").click(),
          },
          "Folder …",
        ),
        el("input", folder),
        el(
          "select",
          {
            id: "import-robot",
            title: BESIDE,
            "aria-label": BESIDE,
            onfocus: () => this.#offerTakes(),
          },
          el("option", { value: ALONE[0] }, ALONE[1]),
        ),
      ),
      el("ul", { class: "takes", id: "imports", "aria-live": "polite" }),
    );
  }

  /** @param {HTMLInputElement} input */
  #chosen(input) {
    const chosen = [...(input.files ?? [])];
    const files = chosen.map((file) => ({ path: file.webkitRelativePath || file.name, file }));
    input.value = "";
    this.take(files);
  }

  /** Whose robot an imported person is put beside: any take. */
  async #offerTakes() {
    const select = $select("#import-robot");
    const was = select.value;
    const takes = await this.studio.api.get("/api/takes").catch(() => []);
    const option = ([value, words] = ALONE) => el("option", { value }, words);
    select.replaceChildren(
      option(),
      ...takes
        .reverse()
        .slice(0, OFFERED)
        .map((take) => {
          const name = spoken(take.label || take.name);
          return option([take.name, `Beside ${name} (${take.seconds.toFixed(1)} s)`]);
        }),
    );
    select.value = takes.some((take) => take.name === was) ? was : "";
  }

  /** Import what can be of these files, after what is under way. @param {Found[]} files */
  take(files) {
    if (!files.length) return;
    const jobs = jobsOf(files);
    if (!jobs.length) {
      const what =
        files.length === 1 ? baseOf(files[0].path) : `None of these ${files.length} files`;
      new Row(what).fail(`${what} cannot be imported: give ${WANTED}`);
    }
    for (const job of jobs) {
      const row = new Row(job.name);
      this.#busy = this.#busy.then(() => this.#send(job, row));
    }
  }

  /**
   * Not with fetch, which does not say how much has been sent.
   *
   * @param {Job} job
   * @param {Row} row
   * @returns {Promise<void>}
   */
  #send(job, row) {
    const form = new FormData();
    for (const file of job.files) form.append("files", file, file.name);
    form.append("name", job.name);
    const beside = $select("#import-robot").value;
    if (job.single && beside && !/\.zip$/i.test(job.name)) form.append("robot", beside);
    return new Promise((done) => {
      const request = new XMLHttpRequest();
      request.open("POST", "/api/takes/import");
      for (const [name, value] of Object.entries(this.studio.api.headers()))
        request.setRequestHeader(name, value);
      request.upload.onprogress = ({ loaded, total }) => row.sent(loaded, total);
      request.onerror = () => {
        row.fail("the studio does not answer");
        done();
      };
      request.onload = () => {
        this.#ended(request, row);
        done();
      };
      request.send(form);
    });
  }

  /** @param {XMLHttpRequest} request @param {Row} row */
  #ended(request, row) {
    const answer = parsed(request.responseText);
    if (request.status !== 200) {
      row.fail(answer.why ?? answer.error ?? `refused (${request.status})`);
      return;
    }
    row.done(answer, this.openReview);
    for (const [name, why] of Object.entries(answer.refused ?? {})) new Row(name).fail(why);
    takesChanged();
  }
}

/** @param {string} json @returns {Imported & { why?: string, error?: string }} */
function parsed(json) {
  try {
    return JSON.parse(json);
  } catch {
    return { takes: [], refused: {}, rejected: 0 }; // the status says it
  }
}

/** A line of the list: what is imported, how far it is, what became of it. */
class Row {
  /** @param {string} name */
  constructor(name) {
    this.name = name;
    this.away = el(
      "button",
      { class: "away", title: "Clear", "aria-label": `Clear ${name}`, hidden: true },
      icon("close"),
    );
    this.away.addEventListener("click", () => this.node.remove());
    this.words = el("span", {}, "waiting");
    this.bar = el("i");
    this.meter = el("div", { class: "meter" }, this.bar);
    const about = el("div", { class: "name" }, el("b", { title: name }, name), this.words);
    about.append(this.meter);
    this.node = el("li", { class: "import" }, about, this.away);
    $("#imports").append(this.node);
    this.node.scrollIntoView({ block: "nearest" });
  }

  /** Bytes so far, of all. @param {number} loaded @param {number} total */
  sent(loaded, total) {
    const share = total ? loaded / total : 0;
    setStyle(this.bar, { transform: `scaleX(${share})` });
    text(this.words, share < 1 ? `sending, ${Math.round(100 * share)} %` : "reading …");
    this.node.classList.toggle("reading", share >= 1);
  }

  /** @param {Imported} answer @param {(take: string) => void} openReview */
  done({ takes, refused, rejected }, openReview) {
    const count = Object.keys(refused ?? {}).length;
    const said = [
      takes.length === 1 ? `is take ${takes[0]}` : `${takes.length} takes`,
      rejected ? `${rejected} bad frames left out` : "",
      count ? `${count} refused` : "",
    ];
    this.#end("done", said.filter(Boolean).join(" · "));
    setStyle(this.bar, { transform: "scaleX(1)" });
    if (takes.length === 1) {
      const onclick = () => openReview(takes[0]);
      this.away.before(el("button", { title: "Scrub, trim, align, judge", onclick }, "Review"));
    }
    if (!this.seen) toast(`${takes.join(", ")}: in Collect, under Takes`, "good");
  }

  /** @param {string} why */
  fail(why) {
    this.node.setAttribute("role", "alert");
    // Its name stands above: what is wrong with it is enough.
    const rest = why.startsWith(this.name) ? why.slice(this.name.length) : why;
    this.#end("failed", capital(rest.replace(/^[\s,:]+/, "")));
    this.meter.hidden = true;
    if (!this.seen) toast(why);
  }

  /** @param {"done" | "failed"} how @param {string} words */
  #end(how, words) {
    this.node.classList.remove("reading");
    this.node.classList.add(how);
    text(this.words, words);
    this.away.hidden = false;
  }

  /** Whether the list is on the screen. */
  get seen() {
    return this.node.offsetParent !== null;
  }
}
