// Whatever is dropped onto the page or pasted: layout, comparison, conversion, explanation.
import { fill, h, option, field } from "./dom.js";
import { ask, attempt, tell } from "./ask.js";
import { word } from "./words.js";
import { telegramTable } from "./lanes.js";
import { changesView } from "./changes.js";

const MOST = 12 * 1024 * 1024;

let listening = new AbortController();

export function toolsTab(desk, show) {
  listening.abort();  // of the page in the other language
  listening = new AbortController();
  const heard = { signal: listening.signal };
  const sets = { files: new Map(), old: new Map() };
  const shown = { files: h("div", { class: "files", id: "dropped" }), old: h("div", { class: "files", id: "dropped-old" }) };
  const text = h("textarea", { id: "paste", rows: 3, spellcheck: "false", placeholder: "03 01 02 01 10 01 C4 7F 00 00\nDF80B500\nF30001\nPG209" });
  const version = h("select", {}, ["V14 SP1", "V15", "V15.1", "V16", "V17", "V18", "V19", "V20", "V21"].map((one) => option(one, one, one === "V19")));
  const classic = h("input", { type: "checkbox" });
  const body = h("div", { class: "body", id: "tool-result" });

  function draw() {
    for (const [key, set] of Object.entries(sets)) {
      fill(shown[key], [...set.keys()].map((name) => h("span", { class: "chip" }, name)), set.size ? h("button", { class: "plain", onclick: () => { set.clear(); draw(); } }, word("clear")) : null);
    }
  }

  async function take(list, key = "files") {
    for (const file of list) {
      if (file.size > MOST) {
        tell(`${file.name}: ${word("tooLarge")}`, "error");
        continue;
      }
      const bytes = new Uint8Array(await file.arrayBuffer());
      let binary = "";
      for (let at = 0; at < bytes.length; at += 0x8000) binary += String.fromCharCode(...bytes.subarray(at, at + 0x8000));
      sets[key].set(file.webkitRelativePath || file.name, btoa(binary));
    }
    draw();
    if (key === "files" && list.length) await look();
  }

  const picked = (key) => h("label", { class: "button" }, word("pick"), h("input", { type: "file", multiple: true, "aria-label": word("pick"), onchange: (event) => take(event.target.files, key) }));
  const given = (key) => Object.fromEntries(sets[key]);
  const problems = (list) => list.map((one) => h("p", { class: one.severity === "error" ? "bad" : "quiet" }, `${one.file ? `${one.file}${one.line ? `:${one.line}` : ""} ` : ""}${one.code ?? ""} ${one.message}`, one.help ? h("small", {}, ` ${one.help}`) : null));

  async function layout() {
    const found = await attempt(() => ask("layout", { files: given("files") }));
    if (found) fill(body, problems(found.problems), found.page ? h("iframe", { src: `made/${found.page}`, title: word("layout"), sandbox: "allow-scripts allow-modals allow-downloads" }) : null);
  }

  async function convert(to) {
    const found = await attempt(() => ask("convert", { files: given("files"), to, version: version.value, classic: classic.checked }));
    if (!found) return;
    const link = found.archive ? h("a", { class: "button", href: `data:application/zip;base64,${found.archive}`, download: "converted.zip" }, word("keep")) : null;
    fill(body, problems(found.problems), link, found.files.map((one) => h("details", { open: found.files.length === 1 }, h("summary", {}, one.path), h("pre", { class: "code" }, one.text.split("\n").map((line) => h("div", {}, line || " "))))));
  }

  async function audit() {
    const found = await attempt(() => ask("audit", { ...desk.now, files: given("files") }));
    if (found) fill(body, problems(found.problems), h("pre", { class: "said" }, found.text));
  }

  // What was dropped shows itself: telegrams and codes are explained, blocks laid out.
  async function look() {
    const found = await attempt(() => ask("look", { files: given("files") }));
    if (!found) return;
    if (found.lines.length) {
      text.value = found.lines.join("\n");
      for (const [name, kind] of Object.entries(found.files)) if (kind === "lines") sets.files.delete(name);
      draw();
    }
    if (sets.files.size) await layout();
    else if (found.lines.length) await explain();
  }

  async function compare() {
    const found = await attempt(() => ask("diff", { files: given("files"), old: given("old") }));
    if (found) fill(body, problems(found.problems), changesView(found.changes));
  }

  async function explain() {
    const rooms = [];
    for (const line of text.value.split("\n").filter((one) => one.trim())) {
      const found = await attempt(() => ask("explain", { text: line }));
      if (found) rooms.push(h("article", {}, found.text ? h("pre", { class: "said" }, found.text) : found.telegrams.map((one) => [h("h4", {}, word(one.kind === "response" ? "answer" : one.kind)), telegramTable(one, word)])));
    }
    fill(body, rooms);
  }

  text.addEventListener("keydown", (event) => { if (event.key === "Enter" && event.ctrlKey) explain(); });
  addEventListener("dragover", (event) => { if (!event.target.closest?.(".editor, input, textarea") || event.dataTransfer.types.includes("Files")) event.preventDefault(); }, heard);
  addEventListener("drop", (event) => {
    const words = event.dataTransfer.getData("text/plain").trim();
    if (event.target.closest(".editor, input, textarea") && !event.dataTransfer.files.length) return;
    event.preventDefault();
    if (!event.dataTransfer.files.length && !words) return;
    show();
    if (!event.dataTransfer.files.length) {
      text.value = words;
      explain();
      return;
    }
    take(event.dataTransfer.files, event.target.closest("[data-drop]")?.dataset.drop ?? "files");
  }, heard);
  return {
    key: "tools", title: "tabTools",
    content: h("div", { class: "stack" }, h("div", { class: "tools views" }, h("p", { class: "quiet" }, word("drop")),
      h("div", { class: "zones" },
        h("div", { class: "zone", "data-drop": "files" }, h("b", {}, word("files")), picked("files"), shown.files,
          h("div", { class: "bar" }, h("button", { id: "do-layout", onclick: layout }, word("layout")), field("TIA", version), h("label", {}, classic, "S7-300/400"), h("button", { id: "do-scl", onclick: () => convert("scl") }, word("toScl")), h("button", { id: "do-xml", onclick: () => convert("xml") }, word("toXml")), h("button", { id: "do-audit", title: word("auditHint"), onclick: audit }, word("audit")))),
        h("div", { class: "zone", "data-drop": "old" }, h("b", {}, `${word("files")} (${word("old")})`), picked("old"), shown.old, h("div", { class: "bar" }, h("button", { id: "do-diff", onclick: compare }, word("compare")))),
        h("div", { class: "zone" }, text, h("div", { class: "bar" }, h("button", { class: "main", id: "do-explain", title: "Ctrl+Enter", onclick: explain }, word("explain")))))),
      body),
    kept: () => [given("files"), given("old"), text.value, [...body.childNodes]],
    again([files, old, typed, result]) {
      for (const [set, one] of [[sets.files, files], [sets.old, old]]) for (const [name, data] of Object.entries(one)) set.set(name, data);
      text.value = typed;
      draw();
      fill(body, result);
    },
  };
}
