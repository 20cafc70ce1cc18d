// The spec: the text, what is wrong with it, and the form beside it.
import { fill, h } from "./dom.js";
import { ask, attempt } from "./ask.js";
import { language, word } from "./words.js";
import { specForm } from "./form.js";

// The edits of a fix, with the reason that a sign-off needs; undefined if nobody gives one.
export function reasoned(edits) {
  const open = /(allow(?:_safety)?: \{P\d+: )(?=\})|(# plcgen: allow PG\d+ )(?=\n)/;
  if (!edits.some((one) => open.test(one.text))) return edits;
  const why = prompt(word("reasonAsked"))?.replace(/\s+/g, " ").trim();
  return why ? edits.map((one) => ({ ...one, text: one.text.replace(open, (_, key, comment) => (key ? key + JSON.stringify(why) : comment + why)) })) : undefined;
}

export function specTab(desk, room) {
  const problems = h("div", { class: "problems", id: "problems" });
  const form = specForm(desk);

  function list(found) {
    if (!found.findings.length) return fill(problems, h("p", { class: "good" }, `\u2713 ${word("noProblems")}`));
    fill(problems, found.findings.map((one) => h("article", { class: one.severity },
      h("button", { class: "row", onclick: () => one.here && desk.editor.go(one.place[0], one.place[1]) },
        h("i", {}), h("span", { class: "where" }, one.line ? `${one.here ? "" : `${one.file}:`}${one.line}` : ""), h("b", {}, one.code), h("span", {}, one.message)),
      one.help ? h("div", { class: "help" }, one.help) : null,
      h("div", { class: "help" }, one.fixes.map((fix) => h("button", { class: "fix", onclick: () => take(fix) }, fix.title)),
        h("details", {}, h("summary", {}, word("why")), h("p", {}, one.reason), one.remedy ? h("p", {}, h("b", {}, `${word("remedy")}: `), one.remedy) : null)))));
  }

  const take = (fix) => {
    const edits = reasoned(fix.edits);
    if (!edits) return;
    desk.editor.apply(edits);
    desk.editor.focus();
  };
  const tidy = async () => {
    const found = await attempt(() => ask("format", desk.now));
    if (found) desk.editor.apply(found.edits);
  };
  const bar = h("div", { class: "bar" }, h("h3", {}, word("problems")), language === "en" ? null : h("small", {}, word("inEnglish")), h("span", { class: "space" }),
    desk.folder.editor ? null : h("small", { class: "quiet" }, word("plainEditor")), h("button", { class: "plain", onclick: tidy }, word("format")));
  return {
    key: "spec", title: "tabSpec",
    content: h("div", { class: "spec" }, h("div", { class: "left" }, room, bar, problems), form.element),
    checked(found) { list(found); form.checked(found); },
    shown() { desk.editor.measure(); },
  };
}
