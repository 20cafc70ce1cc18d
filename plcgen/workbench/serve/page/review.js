// The page that a reviewer signs, made by plcgen review, in a frame of its own.
import { fill, h, option, field } from "./dom.js";
import { ask, attempt } from "./ask.js";
import { word } from "./words.js";
import { working } from "./verify.js";

export function reviewTab(desk) {
  const origin = h("select", {}, option("made", word("asMade")), option("disk", word("onDisk")));
  const bases = h("datalist", { id: "bases" });
  const base = h("input", { id: "base", size: 24, placeholder: word("nothingChosen"), title: word("against") });
  base.setAttribute("list", "bases");
  const keep = h("a", { class: "button", hidden: true }, word("keep"));
  const body = h("div", { class: "framed", id: "review" });
  const empty = () => {
    fill(body, h("p", { class: "empty" }, word("reviewHint")));
    keep.hidden = true;
  };
  function show(found, asked) {
    base.value = asked.base;
    origin.value = asked.origin;
    fill(body, h("iframe", { src: `made/${found.page}`, title: word("tabReview"), sandbox: "allow-scripts allow-modals allow-downloads" }));
    keep.hidden = false;
    keep.href = `made/${found.page}`;
    keep.setAttribute("download", found.name);
  }
  empty();
  const work = working(desk, "review", word("makeReview"), () => ({ origin: origin.value, base: base.value.trim() }), show, empty);
  return {
    key: "review", title: "tabReview", ...work,
    content: h("div", { class: "stack" }, h("div", { class: "bar views" }, field(word("source"), origin), field(word("compareWith"), base), bases, work.controls, keep), body),
    async shown() {
      const found = desk.name ? await attempt(() => ask("bases", { name: desk.name })) : null;
      fill(bases, (found?.bases ?? []).map(([name, text]) => option(name, text || name)));
    },
  };
}
