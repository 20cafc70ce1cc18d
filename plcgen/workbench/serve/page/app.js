// The page: one spec that is open, its tabs, keyboard, language and colours.
import { $, fill, h, later, option, field } from "./dom.js";
import { ask, attempt } from "./ask.js";
import { label, language, speak, word } from "./words.js";
import { makeEditor } from "./editor.js";
import { reasoned, specTab } from "./spec.js";
import { becomesTab } from "./becomes.js";
import { runTab } from "./run.js";
import { verifyTab } from "./verify.js";
import { reviewTab } from "./review.js";
import { toolsTab } from "./tools.js";
import { newSpec } from "./newspec.js";
import { writeFiles, zip } from "./writing.js";

export const desk = {
  rename: (old) => rename(old),
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

// A job, a drive: its new name goes wherever it is named.
function rename(old = "") {
  const place = desk.editor.place, dialog = $("#dialog");
  const name = h("input", { id: "new-name", value: old, required: true, size: 24 });
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

function theme(next) {
  document.documentElement.dataset.theme = next;
  for (const one of document.querySelectorAll(".lanes")) one.dispatchEvent(new Event("scroll"));  // drawn in its colours
  try { localStorage.setItem("plcgen.theme", next); } catch { /* forgotten */ }
}

function themed() {
  try {
    const known = localStorage.getItem("plcgen.theme");
    if (known) return known;
  } catch { /* as the system has it */ }
  return matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
}

// Whether a field has a way back of its own: the editor's is the one of the form, too.
const typing = (target) => target.closest("dialog, .editor") !== null || (target.matches("input, textarea") && target.value !== target.defaultValue && target.type !== "search");

function keys(event) {
  const control = event.ctrlKey || event.metaKey;
  if (control && event.key === "s") {
    event.preventDefault();
    save();
  } else if (event.altKey && /^[1-9]$/.test(event.key) && tabs[Number(event.key) - 1]) {
    event.preventDefault();
    show(Number(event.key) - 1);
  } else if (control && /^[zy]$/i.test(event.key) && tabs[current].key === "spec" && !typing(event.target)) {
    event.preventDefault();
    if (event.key.toLowerCase() === "y" || event.shiftKey) desk.editor.redo();
    else desk.editor.undo();
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
    changed, reasoned, complete: (at) => attempt(() => ask("complete", { ...desk.now, ...at })), hover: (at) => attempt(() => ask("hover", { ...desk.now, ...at })),
  }, desk.folder.editor);
  const draw = () => {
    label(document);
    $("#language").textContent = language === "de" ? "EN" : "DE";
    const source = (file, line) => { goTo("becomes"); views.source(file, line); }, views = becomesTab(desk, written);
    const before = Object.fromEntries(tabs.map((tab) => [tab.key, tab.kept?.()]));
    build([specTab(desk, room), views, runTab(desk), verifyTab(desk, source), reviewTab(desk), toolsTab(desk, () => goTo("tools"))]);
    for (const tab of tabs) tab.resume?.(before[tab.key]);
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
  $("#write").addEventListener("click", () => writeFiles(desk, async (...saved) => {
    desk.writes += 1;
    await written(...saved);
    tabs[current].shown?.();
  }));
  const begun = (found) => { take(found); show(0); };
  $("#new").addEventListener("click", () => newSpec(desk, begun));
  $("#zip").addEventListener("click", () => zip(desk));
  addEventListener("keydown", keys);
  addEventListener("beforeunload", (event) => { if (desk.dirty) event.preventDefault(); });
  files();
  const wanted = tabs.findIndex((tab) => `#${tab.key}` === location.hash);
  show(Math.max(wanted, 0));
  if (desk.folder.specs.length) await open(desk.folder.specs[0]);
  else newSpec(desk, begun);
  state();
  document.body.dataset.ready = "true";
}

begin();
