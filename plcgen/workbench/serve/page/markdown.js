// The Markdown that plcgen writes (headings, paragraphs, lists, tables, code) as elements.
import { h } from "./dom.js";

function inline(text) {
  return text.split(/(`[^`]+`|\*\*[^*]+\*\*)/).map((part) => (part.startsWith("`") ? h("code", {}, part.slice(1, -1)) : part.startsWith("**") ? h("b", {}, part.slice(2, -2)) : part));
}

const ITEM = /^\s*(?:[-*]|\d+\.)\s+/;
const cells = (line) => line.replace(/^\||\|$/g, "").split("|").map((one) => one.trim());

export function markdown(text) {
  const lines = text.split("\n"), found = [];
  for (let at = 0; at < lines.length;) {
    const line = lines[at], block = [];
    if (!line.trim()) { at += 1; continue; }
    if (line.startsWith("```")) {
      for (at += 1; at < lines.length && !lines[at].startsWith("```"); at += 1) block.push(lines[at]);
      at += 1;
      found.push(h("pre", { class: "said" }, block.join("\n")));
    } else if (/^#+ /.test(line)) {
      found.push(h(line.startsWith("# ") ? "h3" : "h4", {}, inline(line.replace(/^#+ /, ""))));
      at += 1;
    } else if (line.startsWith("|")) {
      while (at < lines.length && lines[at].startsWith("|")) block.push(cells(lines[at++]));
      found.push(h("table", {}, h("thead", {}, h("tr", {}, block[0].map((one) => h("th", {}, inline(one))))),
        h("tbody", {}, block.slice(2).map((row) => h("tr", {}, row.map((one) => h("td", {}, inline(one))))))));
    } else if (ITEM.test(line)) {
      while (at < lines.length && lines[at].trim() && !lines[at].startsWith("|")) {
        if (ITEM.test(lines[at])) block.push(lines[at].replace(ITEM, ""));
        else block[block.length - 1] += ` ${lines[at].trim()}`;
        at += 1;
      }
      found.push(h(/^\s*\d/.test(line) ? "ol" : "ul", {}, block.map((one) => h("li", {}, inline(one)))));
    } else {
      while (at < lines.length && lines[at].trim() && !/^[#|]/.test(lines[at]) && !ITEM.test(lines[at])) block.push(lines[at++].trim());
      found.push(h("p", {}, inline(block.join(" "))));
    }
  }
  return found;
}
