// Writing the files of a spec: what will happen and where, then what an engineer does with them.
import { $, fill, h } from "./dom.js";
import { ask, attempt, download, tell } from "./ask.js";
import { word } from "./words.js";
import { markdown } from "./markdown.js";

export const zip = (desk) => attempt(() => download("zip", desk.now, `${desk.name.split("/").pop().replace(/\.ya?ml$/, "")}.zip`));

export async function writeFiles(desk, written) {
  const made = await attempt(() => ask("becomes", desk.now));
  if (!made) return;
  const count = (kind) => made.files.filter((one) => one.state === kind).length;
  const foreign = made.files.filter((one) => one.foreign).length;
  const dialog = $("#dialog");
  const go = async (overwrite) => {
    dialog.close();
    const asked = { ...desk.now, known: desk.known };
    const done = await attempt(() => ask("write", { ...asked, overwrite }));
    if (!done) return;
    await written(asked.text, done.known);
    if (done.in_the_way.length) return blocked(done.in_the_way);
    for (const one of done.problems) tell(`${one.code}: ${one.message}${one.file ? ` (${one.file})` : ""}`, one.severity, one.help);
    if (done.ok) finished(desk, done);
  };
  // Only the files that are named here are overwritten, and only after this second question.
  const blocked = (files) => {
    fill(dialog, h("h2", { class: "bad" }, word("blockedAsk")), h("p", {}, word("blockedRule")),
      h("ul", { id: "in-the-way" }, files.map((one) => h("li", {}, h("code", {}, one.path), h("small", {}, ` ${one.why}`)))),
      h("form", { method: "dialog", class: "buttons" },
        h("button", { class: "main" }, word("keepMine")),
        h("button", { type: "button", id: "overwrite", onclick: () => go(Object.fromEntries(files.map((one) => [one.path, one.held]))) }, word("overwrite")),
        h("button", { type: "button", onclick: () => { dialog.close(); zip(desk); } }, word("zipInstead"))));
    dialog.showModal();
  };
  fill(dialog, h("h2", {}, word(desk.dirty ? "writeAsk" : "writeAskSaved")),
    h("dl", {}, h("dt", {}, word("spec")), h("dd", {}, h("code", {}, made.spec)),
      h("dt", {}, word("folder")), h("dd", {}, h("code", {}, made.path)),
      h("dt", {}, word("files")), h("dd", {}, `${count("new")} ${word("new")}, ${count("changed")} ${word("changed")}${foreign ? ` (${foreign} ${word("foreign")})` : ""}, ${count("same")} ${word("same")}`)),
    h("p", { class: "quiet" }, word("writeRule")),
    h("form", { method: "dialog", class: "buttons" },
      h("button", { class: "main", type: "button", id: "write-now", onclick: () => go({}) }, word("writeNow")),
      h("button", { type: "button", onclick: () => { dialog.close(); zip(desk); } }, word("zipInstead")),
      h("button", {}, word("cancel"))));
  dialog.showModal();
}

function finished(desk, done) {
  const dialog = $("#dialog");
  const text = `${done.written.length} ${word("written")}, ${done.unchanged} ${word("unchanged")}, ${done.removed.length} ${word("removed")}`;
  const copy = h("button", { class: "plain", type: "button", onclick: async () => {
    try {
      await navigator.clipboard.writeText(done.path);
      copy.textContent = word("copied");
    } catch { /* it can be marked and copied by hand */ }
  } }, word("copy"));
  fill(dialog, h("h2", { class: "good" }, `\u2713 ${text}`),
    h("p", {}, h("code", { id: "written-path" }, done.path), " ", copy),
    h("div", { class: "guide", id: "guide" }, markdown(done.guide)),
    h("form", { method: "dialog", class: "buttons" }, h("button", { class: "main", id: "written-close" }, word("close")),
      h("button", { type: "button", onclick: () => zip(desk) }, word("zip"))));
  dialog.showModal();
}
