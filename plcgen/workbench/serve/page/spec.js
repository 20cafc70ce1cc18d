// The spec: the text, what is wrong with it, and a form beside it that edits the same text.
import { fill, h, later, option, field } from "./dom.js";
import { ask, attempt } from "./ask.js";
import { word } from "./words.js";

export function specTab(desk, room) {
  const problems = h("div", { class: "problems", id: "problems" });
  const form = h("aside", { class: "form" });
  const drives = h("div", { class: "list", id: "drives" });
  const jobs = h("div", { class: "list", id: "jobs" });
  const results = h("div", { class: "results", id: "results" });
  const target = h("select", { id: "target" });
  const words = h("input", { id: "search", type: "search", placeholder: word("searchHint"), autocomplete: "off" });
  let asking = new AbortController(), added = "";

  async function change(what, given) {
    const found = await attempt(() => ask("change", { ...desk.now, what, given }));
    if (!found) return false;
    desk.editor.apply(found.edits);
    return true;
  }

  const search = later(120, async () => {
    if (!desk.name || !words.value.trim()) return fill(results);
    asking.abort();
    asking = new AbortController();
    const job = target.value.startsWith("jobs/") ? target.value.slice(5) : "";
    const found = await attempt(() => ask("search", { ...desk.now, job, words: words.value }, asking.signal));
    if (found) fill(results, rows(found));
  });

  function rows(found) {
    const list = found.messages.map((one) => h("article", { class: "hit" }, h("b", {}, one.key), ` ${one.title} `,
      h("small", {}, one.device), h("div", { class: "pre quiet" }, one.text)));
    for (const one of found.parameters) {
      const put = (access) => change("parameter", { job: target.value, parameter: one.parameter, access });
      list.push(h("article", { class: "hit" },
        h("details", {}, h("summary", {}, h("b", {}, one.parameter), ` ${one.text}`, one.danger ? h("em", { class: "bad", title: one.danger }, ` ${word("dangerous")}`) : null),
          h("dl", {}, one.facts.map(([name, text]) => [h("dt", {}, name), h("dd", {}, text)]))),
        h("button", { disabled: !target.value, onclick: () => put("read") }, word("readIt")),
        one.writable ? h("button", { disabled: !target.value, onclick: () => put("write") }, word("writeIt")) : null));
    }
    if (!list.length) list.push(h("p", { class: "quiet" }, word("nothingFound")));
    if (found.more) list.push(h("p", { class: "quiet" }, word("more")));
    return list;
  }

  function addDrive() {
    const name = h("input", { required: true, value: free("drive", desk.checked?.drives), size: 10 });
    const device = h("select", {}, desk.folder.devices.map((one) => option(one.key, one.title, one.key === "sinamics-s120")));
    const address = h("input", { value: "270", inputmode: "numeric", size: 6, pattern: "[0-9]+" });
    return adding(word("addDrive"), [field(word("name"), name), field(word("device"), device), field(word("address"), address)],
      () => change("drive", { key: name.value, device: device.value, address: address.value }));
  }

  function addJob() {
    const name = h("input", { required: true, value: free("job", desk.checked?.jobs), size: 10 });
    const kind = h("select", {}, desk.folder.kinds.map((one) => option(one)));
    const partners = [
      ...(desk.checked?.drives ?? []).map((one) => option(`drive:${one.key}`, one.key)),
      ...(desk.checked?.stations ?? []).map((one) => option(`station:${one.line}/${one.key}`, `${one.line} / ${one.key}`)),
    ];
    const partner = h("select", {}, partners);
    return adding(word("addJob"), [field(word("name"), name), field(word("drive"), partner), field(word("kind"), kind)], () => {
      const [sort, key] = partner.value.split(":");
      added = `jobs/${name.value}`;
      return change("job", { key: name.value, kind: kind.value, [sort || "drive"]: key ?? "" });
    });
  }

  function adding(title, fields, add) {
    const send = async (event) => {
      event.preventDefault();
      if (await add()) event.target.closest("details").open = false;
    };
    return h("details", { class: "adding" }, h("summary", {}, title), h("form", { onsubmit: send }, fields, h("button", { class: "main", type: "submit" }, word("create"))));
  }

  const goTo = (key) => {
    const line = desk.text.split("\n").findIndex((one) => one.match(new RegExp(`^\\s*["']?${key}["']?\\s*:`)));
    if (line >= 0) desk.editor.go(line, 2);
  };

  function outline(found) {
    fill(drives, found.drives.map((one) => h("button", { class: "row", onclick: () => goTo(one.key) }, h("b", {}, one.key), h("small", {}, one.title || "?"))),
      found.stations.map((one) => h("button", { class: "row", onclick: () => goTo(one.key) }, h("b", {}, one.key), h("small", {}, one.line))), addDrive());
    fill(jobs, found.jobs.map((one) => h("button", { class: "row", onclick: () => { goTo(one.key); target.value = one.path.join("/"); search(); } },
      h("b", {}, one.key), h("small", { title: one.drives.join(", ") }, one.drives.length > 3 ? `${one.drives.length} ${word("drives")}` : one.drives.join(", ")))), addJob());
    const stations = found.stations.length > 0;
    partners.textContent = [found.drives.length || !stations ? word("drives") : "", stations ? word("stations") : ""].filter(Boolean).join(", ");
    catalogue.hidden = found.drives.length === 0;
    const before = target.value;
    fill(target, found.jobs.filter((one) => one.path[0] === "jobs").map((one) => option(one.path.join("/"), one.key)));
    const fresh = [...target.options].some((one) => one.value === added) ? added : "";  // what is added goes into the new job
    if (fresh) added = "";
    if (fresh || before) target.value = fresh || before;
  }

  function list(found) {
    if (!found.findings.length) return fill(problems, h("p", { class: "good" }, `\u2713 ${word("noProblems")}`));
    fill(problems, found.findings.map((one) => h("article", { class: one.severity },
      h("button", { class: "row", onclick: () => one.here && desk.editor.go(one.place[0], one.place[1]) },
        h("i", {}), h("span", { class: "where" }, one.line ? `${one.here ? "" : `${one.file}:`}${one.line}` : ""), h("b", {}, one.code), h("span", {}, one.message)),
      one.help ? h("div", { class: "help" }, one.help) : null,
      h("div", { class: "help" }, one.fixes.map((fix) => h("button", { class: "fix", onclick: () => desk.editor.apply(fix.edits) }, fix.title)),
        h("details", {}, h("summary", {}, word("why")), h("p", {}, one.reason), one.remedy ? h("p", {}, h("b", {}, `${word("remedy")}: `), one.remedy) : null)))));
  }

  words.addEventListener("input", search);
  target.addEventListener("change", search);
  const partners = h("h3", {}, word("drives"));
  const catalogue = h("div", {}, h("h3", {}, word("catalogue")), field(word("addTo"), target), words, results);
  fill(form, partners, drives, h("h3", {}, word("jobs")), jobs, catalogue);
  const tidy = async () => {
    const found = await attempt(() => ask("format", desk.now));
    if (found) desk.editor.apply(found.edits);
  };
  const bar = h("div", { class: "bar" }, h("h3", {}, word("problems")), h("span", { class: "space" }),
    desk.folder.editor ? null : h("small", { class: "quiet" }, word("plainEditor")), h("button", { class: "plain", onclick: tidy }, word("format")));
  return {
    key: "spec", title: "tabSpec",
    content: h("div", { class: "spec" }, h("div", { class: "left" }, room, bar, problems), form),
    checked(found) { list(found); if (!form.contains(document.activeElement) || !document.activeElement.closest("form")) outline(found); search(); },
    shown() { desk.editor.measure(); },
  };
}

function free(stem, known = []) {
  const names = new Set(known.map((one) => one.key));
  let number = 1;
  while (names.has(`${stem}${number}`)) number += 1;
  return `${stem}${number}`;
}
