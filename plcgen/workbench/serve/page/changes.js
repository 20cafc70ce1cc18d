// What two versions differ in: what somebody notices of each job, then every change by subject.
import { h, table } from "./dom.js";
import { named, word } from "./words.js";

const MOST = 6;  // subjects that are open

export function changesView(found) {
  const chip = (level) => h("span", { class: `chip l-${level}` }, named("level", level));
  const subjects = [...new Set(found.rows.map((one) => one.subject))];
  return h("div", { class: "changes" },
    h("p", { class: "verdict" }, h("b", {}, found.counts)),
    found.sentences.length ? [h("h3", {}, word("noticed")), table([word("effect"), word("jobs"), word("meaning")], found.sentences.map(([level, who, text]) => h("tr", {}, h("td", {}, chip(level)), h("td", {}, h("b", {}, who)), h("td", {}, text))), "dense")] : null,
    subjects.length ? h("h3", {}, word("inDetail")) : null,
    subjects.map((subject) => {
      const rows = found.rows.filter((one) => one.subject === subject);
      return h("details", { open: subjects.length <= MOST }, h("summary", {}, h("b", {}, subject), ` ${rows.length} `, chip(rows[0].level)),
        table([word("effect"), word("kind"), word("change")], rows.map((one) => h("tr", {}, h("td", {}, chip(one.level)), h("td", {}, one.id.replaceAll("-", " ")),
          h("td", {}, one.text, one.details.length ? h("details", {}, h("summary", {}, `${one.details.length + one.more}`), h("pre", { class: "said" }, one.details.join("\n"), one.more ? "\n.." : "")) : null))), "dense"));
    }),
    found.more ? h("p", { class: "quiet" }, `.. ${found.more}`) : null,
    found.inside ? h("p", { class: "quiet" }, `${word("inside")} ${found.inside}`) : null);
}
