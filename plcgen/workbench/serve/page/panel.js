// What a panel connects: commands and results by name and address, and text lists for its fields.
import { fill, h, table } from "./dom.js";
import { ask, attempt, download } from "./ask.js";
import { word } from "./words.js";

const MOST = 1000;  // rows that are drawn

export async function panelView(desk, side, body, seen) {
  const found = await attempt(() => ask("tags", desk.now));
  if (!found || !seen()) return;
  const tags = [...found.flags, ...found.blocks.flatMap((one) => one.tags)];
  const group = (one) => (one.symbolic.startsWith('"') ? one.symbolic.split(".").slice(0, 2).join(".") : word("flag"));
  const last = (one) => one.split(".").at(-1), mine = (one) => found.jobs.some((job) => last(job) === last(one));
  const all = [...new Set(tags.map(group))], groups = [...all.filter(mine), ...all.filter((one) => !mine(one))];  // jobs first: what drives and gates have is internal
  const rows = h("div", {});
  const show = (chosen) => {
    for (const one of side.querySelectorAll("button")) one.setAttribute("aria-pressed", one.dataset.key === chosen ? "true" : "false");
    fill(rows, table(["tagName", "address", "type", "meaning"].map((key) => word(key)),
      tags.filter((one) => chosen === "" || group(one) === chosen).slice(0, MOST).map((one) => h("tr", {}, h("td", {}, h("b", {}, one.symbolic.split(".").flatMap((part, place) => (place ? [".", h("wbr"), part] : [part])))),
        h("td", { class: "hex" }, one.absolute), h("td", {}, one.type), h("td", {}, one.comment, one.list ? h("small", { class: "quiet" }, ` ${word("textList")} ${one.list}`) : null))), "dense"));
  };
  fill(side, ["", ...groups].map((key) => h("button", { class: "row", "data-key": key, onclick: () => show(key) }, h("b", {}, last(key) || word("all")))));
  const tick = (name, value, on) => h("label", {}, h("input", { type: "checkbox", name, value, checked: on }), ` ${value} `);
  const send = (event) => {
    event.preventDefault();
    const all = (name) => [...event.target.querySelectorAll(`[name=${name}]:checked`)].map((one) => one.value);
    attempt(() => download("ask/texts", { ...desk.now, languages: all("languages"), formats: all("formats") }, "HMITextLists.zip"));
  };
  fill(body, h("p", { class: "quiet hint" }, word("panelHint")),
    h("form", { class: "bar texts", id: "texts", onsubmit: send }, h("b", {}, word("textLists")), desk.folder.languages.map((one) => tick("languages", one, true)), h("span", { class: "quiet" }, "|"),
      [["xlsx", true], ["xml", false], ["csv", false]].map(([one, on]) => tick("formats", one, on)), h("button", { id: "get-texts" }, word("keep")), h("small", {}, word("textsHint"))),
    rows);
  show(groups.length > 1 && tags.length > 60 ? groups[0] : "");
}
