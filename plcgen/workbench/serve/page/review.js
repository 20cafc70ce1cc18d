// The page that a reviewer signs, made by plcgen review, in a frame of its own.
import { fill, h, option, field } from "./dom.js";
import { ask, attempt } from "./ask.js";
import { word } from "./words.js";
import { follow } from "./verify.js";

export function reviewTab(desk) {
  const origin = h("select", {}, option("made", word("asMade")), option("disk", word("onDisk")));
  const bases = h("datalist", { id: "bases" });
  const base = h("input", { id: "base", size: 24, placeholder: word("nothingChosen"), title: word("against") });
  base.setAttribute("list", "bases");
  const start = h("button", { class: "main", id: "review-start" }, word("makeReview"));
  const cancel = h("button", { disabled: true, onclick: () => attempt(() => ask("cancel")) }, word("cancel"));
  const bar = h("progress", { hidden: true });
  const told = h("span", { class: "quiet", role: "status" });
  const keep = h("a", { class: "button", hidden: true }, word("keep"));
  const body = h("div", { class: "framed", id: "review" }, h("p", { class: "empty" }, word("reviewHint")));
  let now = null;  // what is shown, or worked at
  start.addEventListener("click", () => {
    const asked = { ...desk.now, origin: origin.value, base: base.value.trim() };
    work(() => ask("review", asked), asked);
  });
  async function work(begin, asked) {
    start.disabled = true;
    cancel.disabled = false;
    now = { asked };
    const found = await follow(begin, bar, told);
    start.disabled = false;
    cancel.disabled = true;
    if (found && asked.name === desk.name) show(found, asked);
  }
  function show(found, asked) {
    now = { found, asked };
    base.value = asked.base;
    origin.value = asked.origin;
    fill(body, h("iframe", { src: `made/${found.page}`, title: word("tabReview"), sandbox: "allow-scripts allow-modals allow-downloads" }));
    keep.hidden = false;
    keep.href = `made/${found.page}`;
    keep.setAttribute("download", found.name);
  }
  return {
    key: "review", title: "tabReview",
    content: h("div", { class: "stack" }, h("div", { class: "bar views" }, field(word("source"), origin), field(word("compareWith"), base), bases, start, cancel, keep, bar, told), body),
    async shown() {
      const found = desk.name ? await attempt(() => ask("bases", { name: desk.name })) : null;
      fill(bases, (found?.bases ?? []).map(([name, text]) => option(name, text || name)));
    },
    kept: () => now,
    resume(before) {
      if (before?.found) show(before.found, before.asked);
      else if (before) work(() => ask("state"), before.asked);
    },
    cleared() {
      now = null;
      fill(body, h("p", { class: "empty" }, word("reviewHint")));
      keep.hidden = true;
    },
  };
}
