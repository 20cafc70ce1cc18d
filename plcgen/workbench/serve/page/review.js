// The page that a reviewer signs, made by plcgen review, in a frame of its own.
import { fill, h, option, field } from "./dom.js";
import { ask, attempt } from "./ask.js";
import { word } from "./words.js";
import { follow } from "./verify.js";

export function reviewTab(desk) {
  const origin = h("select", {}, option("made", word("asMade")), option("disk", word("onDisk")));
  const base = h("input", { id: "base", size: 16, placeholder: "HEAD", title: word("against") });
  const start = h("button", { class: "main", id: "review-start" }, word("makeReview"));
  const cancel = h("button", { disabled: true, onclick: () => attempt(() => ask("cancel")) }, word("cancel"));
  const bar = h("progress", { hidden: true });
  const told = h("span", { class: "quiet", role: "status" });
  const keep = h("a", { class: "button", hidden: true }, word("keep"));
  const body = h("div", { class: "framed", id: "review" }, h("p", { class: "empty" }, word("reviewHint")));
  let last = null;
  start.addEventListener("click", async () => {
    start.disabled = true;
    cancel.disabled = false;
    const asked = { ...desk.now, origin: origin.value, base: base.value.trim() };
    const found = await follow(() => ask("review", asked), bar, told);
    start.disabled = false;
    cancel.disabled = true;
    if (!found || asked.name !== desk.name) return;
    show(found);
  });
  function show(found) {
    last = found;
    fill(body, h("iframe", { src: `made/${found.page}`, title: word("tabReview"), sandbox: "allow-scripts allow-modals allow-downloads" }));
    keep.hidden = false;
    keep.href = `made/${found.page}`;
    keep.setAttribute("download", found.name);
  }
  return {
    key: "review", title: "tabReview",
    content: h("div", { class: "stack" }, h("div", { class: "bar views" }, field(word("source"), origin), field(word("compare"), base), start, cancel, keep, bar, told), body),
    cleared() {
      fill(body, h("p", { class: "empty" }, word("reviewHint")));
      keep.hidden = true;
      last = null;
    },
    kept: () => last,
    again: show,
  };
}
