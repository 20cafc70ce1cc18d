// Whatever is dropped onto the page or pasted: layout, comparison, conversion, explanation.
import { fill, h, option, field } from "./dom.js";
import { ask, attempt } from "./ask.js";
import { word } from "./words.js";
import { telegramTable } from "./lanes.js";

const MOST = 12 * 1024 * 1024;

export function toolsTab(show) {
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
      if (file.size > MOST) continue;
      const bytes = new Uint8Array(await file.arrayBuffer());
      let binary = "";
      for (let at = 0; at < bytes.length; at += 0x8000) binary += String.fromCharCode(...bytes.subarray(at, at + 0x8000));
      sets[key].set(file.webkitRelativePath || file.name, btoa(binary));
    }
    draw();
  }

  const picked = (key) => h("input", { type: "file", multiple: true, "aria-label": word("pick"), onchange: (event) => take(event.target.files, key) });
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

  async function compare() {
    const found = await attempt(() => ask("diff", { files: given("files"), old: given("old") }));
    if (found) fill(body, problems(found.problems), h("pre", { class: "code pre" }, found.text));
  }

  async function explain() {
    const rooms = [];
    for (const line of text.value.split("\n").filter((one) => one.trim())) {
      const found = await attempt(() => ask("explain", { text: line }));
      if (found) rooms.push(h("article", {}, found.text ? h("pre", { class: "said" }, found.text) : found.telegrams.map((one) => [h("h4", {}, one.kind), telegramTable(one, word)])));
    }
    fill(body, rooms);
  }

  text.addEventListener("keydown", (event) => { if (event.key === "Enter" && event.ctrlKey) explain(); });
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    event.preventDefault();
    if (!event.dataTransfer.files.length) return;
    show();
    take(event.dataTransfer.files, event.target.closest("[data-drop]")?.dataset.drop ?? "files");
  });
  return {
    key: "tools", title: "tabTools",
    content: h("div", { class: "stack" }, h("div", { class: "tools views" }, h("p", { class: "quiet" }, word("drop")),
      h("div", { class: "zones" },
        h("div", { class: "zone", "data-drop": "files" }, h("b", {}, word("files")), picked("files"), shown.files,
          h("div", { class: "bar" }, h("button", { id: "do-layout", onclick: layout }, word("layout")), field("TIA", version), h("label", {}, classic, "S7-300/400"), h("button", { id: "do-scl", onclick: () => convert("scl") }, word("toScl")), h("button", { id: "do-xml", onclick: () => convert("xml") }, word("toXml")))),
        h("div", { class: "zone", "data-drop": "old" }, h("b", {}, `${word("files")} (${word("old")})`), picked("old"), shown.old, h("div", { class: "bar" }, h("button", { id: "do-diff", onclick: compare }, word("compare")))),
        h("div", { class: "zone" }, text, h("div", { class: "bar" }, h("button", { class: "main", id: "do-explain", title: "Ctrl+Enter", onclick: explain }, word("explain")))))),
      body),
  };
}
