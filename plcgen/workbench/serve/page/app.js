// The page: one spec that is open, its tabs, keyboard, language and colours.
import { $, fill, h, later, option, field } from "./dom.js";
import { ask, attempt, download, tell } from "./ask.js";
import { label, language, speak, word } from "./words.js";
import { makeEditor } from "./editor.js";
import { specTab } from "./spec.js";
import { becomesTab } from "./becomes.js";
import { runTab } from "./run.js";
import { verifyTab } from "./verify.js";
import { reviewTab } from "./review.js";
import { toolsTab } from "./tools.js";

export const desk = {
  folder: null, name: "", known: "", saved: "", editor: null, checked: null, writes: 0,
  get text() { return this.editor.text; },
  get dirty() { return this.name !== "" && (this.known === "" || this.text !== this.saved); },
  get now() { return { name: this.name, text: this.text }; },
  errors: () => desk.checked?.findings.filter((one) => one.severity === "error") ?? [],
};

const tabs = [];
let current = 0;
let checking = new AbortController();

function show(number) {
  current = number;
  tabs.forEach((tab, place) => {
    tab.button.setAttribute("aria-selected", place === number ? "true" : "false");
    tab.button.tabIndex = place === number ? 0 : -1;
    tab.panel.hidden = place !== number;
  });
  try { history.replaceState(null, "", `#${tabs[number].key}`); } catch { /* too many in a second */ }
  tabs[number].shown?.();
}

export const goTo = (key) => show(tabs.findIndex((tab) => tab.key === key));

function state() {
  const text = desk.name === "" ? "" : desk.known === "" ? word("fresh") : desk.dirty ? word("unsaved") : word("saved");
  fill($("#state"), text).className = desk.dirty ? "dirty" : "";
  $("#save").disabled = !desk.dirty;
  $("#write").disabled = $("#zip").disabled = desk.name === "" || desk.errors().length > 0;
  document.title = `${desk.dirty ? "\u2022 " : ""}${desk.name ? `${desk.name} - ` : ""}plcgen`;
}

// The answer to a text that is no longer there is dropped.
const check = later(90, async () => {
  if (!desk.name) return;
  checking.abort();
  checking = new AbortController();
  const asked = desk.now;
  const found = await attempt(() => ask("check", asked, checking.signal));
  if (found === undefined || asked.text !== desk.text || asked.name !== desk.name) return;
  desk.checked = found;
  desk.editor.problems(found.findings);
  state();
  for (const tab of tabs) tab.checked?.(found);
  if (tabs[current].key !== "spec") tabs[current].shown?.();
});

function changed() {
  state();
  check();
}

export async function open(name) {
  if (desk.dirty && !confirm(word("leave"))) {
    $("#file").value = desk.name;
    return;
  }
  const found = await attempt(() => ask("read", { name }));
  if (found) take(found);
}

function take(found) {
  if (desk.name && desk.name !== found.name) for (const tab of tabs) tab.cleared?.();
  Object.assign(desk, { name: found.name, known: found.known, saved: found.text, checked: null });
  desk.editor.open(found.text);
  files();
  changed();
}

function files() {
  const names = desk.folder.specs.includes(desk.name) || !desk.name ? desk.folder.specs : [...desk.folder.specs, desk.name];
  fill($("#file"), names.map((name) => option(name, name, name === desk.name)));
  $("#file").disabled = names.length === 0;
}

async function save() {
  if (!desk.dirty) return;
  const asked = { ...desk.now, known: desk.known };
  const found = await attempt(() => ask("save", asked));
  if (!found) return;
  await written(asked.text, found.known);
}

async function written(text, known) {
  const fresh = desk.known === "";
  Object.assign(desk, { known, saved: text });
  if (fresh) {
    desk.folder = await ask("folder");
    files();
  }
  state();
}

async function write() {
  const made = await attempt(() => ask("becomes", desk.now));
  if (!made) return;
  const count = (kind) => made.files.filter((one) => one.state === kind).length;
  const dialog = $("#dialog");
  const go = async () => {
    dialog.close();
    const asked = { ...desk.now, known: desk.known };
    const done = await attempt(() => ask("write", asked));
    if (!done) return;
    desk.writes += 1;
    await written(asked.text, done.known);
    for (const one of done.problems) tell(`${one.code}: ${one.message}${one.file ? ` (${one.file})` : ""}`, one.severity, one.help);
    if (done.ok) tell(`${done.folder}: ${done.written.length} ${word("written")}, ${done.unchanged} ${word("unchanged")}, ${done.removed.length} ${word("removed")}`);
    tabs[current].shown?.();
  };
  fill(dialog, h("h2", {}, word("writeAsk")),
    h("p", {}, desk.name, " ", word("writeInto"), " ", h("code", {}, made.folder), ": ",
      `${count("new")} ${word("new")}, ${count("changed")} ${word("changed")}, ${count("same")} ${word("same")}`),
    h("p", { class: "quiet" }, word("writeRule")),
    h("form", { method: "dialog", class: "buttons" },
      h("button", { class: "main", type: "button", id: "write-now", onclick: go }, word("write")),
      h("button", {}, word("cancel"))));
  dialog.showModal();
}

function newSpec() {
  const { devices, families, toolchains } = desk.folder;
  const name = h("input", { name: "name", value: free(), required: true, pattern: ".+\\.ya?ml", size: 24 });
  const device = h("select", { name: "device" }, option("ppi", word("ppiMaster")),
    devices.map((one) => option(one.key, `${one.title} (${one.key})`, one.key === "sinamics-s120")));
  const family = h("select", { name: "family" }, families.map((one) => option(one, one, one === "s7-1500")));
  const toolchain = h("select", { name: "toolchain" }, toolchains.map((one) => option(one, one, one === "tia-v17")));
  const dialog = $("#dialog");
  const create = async (event) => {
    event.preventDefault();
    const given = { device: device.value, family: family.value, toolchain: toolchain.value };
    const found = await attempt(() => ask("new", { name: name.value, given }));
    if (!found || (desk.dirty && !confirm(word("leave")))) return;
    dialog.close();
    take({ ...found, text: found.text });
    show(0);
  };
  fill(dialog, h("h2", {}, word("newSpec")), h("form", { onsubmit: create },
    field(word("file"), name), field(word("device"), device), field(word("family"), family), field(word("toolchain"), toolchain),
    h("div", { class: "buttons" }, h("button", { class: "main", type: "submit" }, word("create")),
      h("button", { type: "button", onclick: () => dialog.close() }, word("cancel")))));
  dialog.showModal();
}

// A job, a drive: its new name goes wherever it is named.
function rename() {
  const place = desk.editor.place, dialog = $("#dialog");
  const name = h("input", { id: "new-name", required: true, size: 24 });
  const go = async (event) => {
    event.preventDefault();
    const found = await attempt(() => ask("rename", { ...desk.now, ...place, word: name.value.trim() }));
    if (!found) return;
    dialog.close();
    desk.editor.apply(found.edits);
  };
  fill(dialog, h("h2", {}, word("rename")), h("form", { onsubmit: go }, field(word("name"), name),
    h("div", { class: "buttons" }, h("button", { class: "main", type: "submit" }, word("rename")),
      h("button", { type: "button", onclick: () => dialog.close() }, word("cancel")))));
  dialog.showModal();
}

function free() {
  let number = 1;
  while (desk.folder.specs.includes(number === 1 ? "job.yaml" : `job${number}.yaml`)) number += 1;
  return number === 1 ? "job.yaml" : `job${number}.yaml`;
}

function theme(next) {
  document.documentElement.dataset.theme = next;
  try { localStorage.setItem("plcgen.theme", next); } catch { /* forgotten */ }
}

function themed() {
  try {
    const known = localStorage.getItem("plcgen.theme");
    if (known) return known;
  } catch { /* as the system has it */ }
  return matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
}

function keys(event) {
  const control = event.ctrlKey || event.metaKey;
  if (control && event.key === "s") {
    event.preventDefault();
    save();
  } else if (event.altKey && /^[1-9]$/.test(event.key) && tabs[Number(event.key) - 1]) {
    event.preventDefault();
    show(Number(event.key) - 1);
  } else if (event.key === "F2" && tabs[current].key === "spec" && desk.name) {
    event.preventDefault();
    rename();
  } else if (event.key === "F8" && desk.checked?.findings.length) {
    event.preventDefault();
    desk.next = ((desk.next ?? -1) + (event.shiftKey ? desk.checked.findings.length - 1 : 1)) % desk.checked.findings.length;
    const one = desk.checked.findings[desk.next];
    if (one.here) { show(0); desk.editor.go(one.place[0], one.place[1]); }
  }
}

function build(list) {
  fill($("#tabs"));
  fill($("#main"));
  tabs.length = 0;
  list.forEach((tab, place) => {
    tab.button = h("button", {
      role: "tab", type: "button", id: `tab-${tab.key}`, title: `Alt+${place + 1}`, "aria-controls": `panel-${tab.key}`, onclick: () => show(place),
    }, word(tab.title));
    tab.panel = h("section", { role: "tabpanel", id: `panel-${tab.key}`, "aria-labelledby": `tab-${tab.key}`, hidden: true }, tab.content);
    tabs.push(tab);
    $("#tabs").append(tab.button);
    $("#main").append(tab.panel);
  });
}

async function begin() {
  theme(themed());
  desk.folder = await attempt(() => ask("folder"));
  if (!desk.folder) return;
  const room = h("div", { class: "editor", id: "editor" });
  desk.editor = await makeEditor(room, {
    changed, complete: (at) => attempt(() => ask("complete", { ...desk.now, ...at })), hover: (at) => attempt(() => ask("hover", { ...desk.now, ...at })),
  }, desk.folder.editor);
  const draw = () => {
    label(document);
    $("#language").textContent = language === "de" ? "EN" : "DE";
    build([specTab(desk, room), becomesTab(desk), runTab(desk), verifyTab(desk), reviewTab(desk), toolsTab(() => goTo("tools"))]);
    if (desk.checked) for (const tab of tabs) tab.checked?.(desk.checked);
  };
  draw();
  $("#language").addEventListener("click", () => {
    speak(language === "de" ? "en" : "de");
    draw();
    show(current);
    state();
  });
  $("#theme").addEventListener("click", () => theme(document.documentElement.dataset.theme === "dark" ? "light" : "dark"));
  $("#file").addEventListener("change", (event) => open(event.target.value));
  $("#save").addEventListener("click", save);
  $("#write").addEventListener("click", write);
  $("#new").addEventListener("click", newSpec);
  $("#zip").addEventListener("click", () => attempt(() => download("zip", desk.now, `${desk.name.split("/").pop().replace(/\.ya?ml$/, "")}.zip`)));
  addEventListener("keydown", keys);
  addEventListener("beforeunload", (event) => { if (desk.dirty) event.preventDefault(); });
  files();
  const wanted = tabs.findIndex((tab) => `#${tab.key}` === location.hash);
  show(Math.max(wanted, 0));
  if (desk.folder.specs.length) await open(desk.folder.specs[0]);
  else newSpec();
  state();
  document.body.dataset.ready = "true";
}

begin();
