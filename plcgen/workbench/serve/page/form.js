// The form beside the editor: drives, stations, jobs and parameters; it edits the same text at one place.
import { fill, h, later, option, field } from "./dom.js";
import { ask, attempt } from "./ask.js";
import { named, said, word } from "./words.js";

export function specForm(desk) {
  const drives = h("div", { class: "list", id: "drives" });
  const jobs = h("div", { class: "list", id: "jobs" });
  const results = h("div", { class: "results", id: "results" });
  const target = h("select", { id: "target" });
  const words = h("input", { id: "search", type: "search", placeholder: word("searchHint"), autocomplete: "off" });
  const partners = h("h3", {}, word("drives"));
  const every = h("input", { id: "cycle", size: 8, placeholder: `${word("example")} 1s`, "aria-label": word("every") });
  const cycle = h("form", { class: "one", onsubmit: (event) => { event.preventDefault(); change("cycle", { job: target.value, cycle: every.value.trim() }); } },
    h("span", { class: "quiet" }, `${word("onCycle")}, ${word("every")}`), every, h("button", { id: "set-cycle" }, word("set")));
  const value = h("input", { id: "record-value", size: 8 }), values = field(word("recordValue"), value);
  const has = h("div", { class: "chips", id: "has" });
  const catalogue = h("div", {}, h("h3", {}, word("catalogue")), field(word("addTo"), target), has, cycle, values, words, results);
  let asking = new AbortController(), added = "", repeated = "";

  async function change(what, given, into = undefined) {
    const found = await attempt(() => ask("change", { ...desk.now, what, given }), into);
    if (!found) return false;
    desk.editor.apply(found.edits);
    for (const one of document.querySelectorAll("#notices .error")) one.remove();  // it has been done after all
    return true;
  }

  const search = later(120, async () => {
    if (!desk.name || !words.value.trim()) return fill(results);
    asking.abort();
    asking = new AbortController();
    const found = await attempt(() => ask("search", { ...desk.now, job: target.value, words: words.value }, asking.signal));
    if (found) fill(results, rows(found));
  });

  function rows(found) {
    const messages = found.messages.map((one) => h("article", { class: "hit" },
      h("details", { open: found.messages.length === 1 }, h("summary", {}, h("b", {}, one.key), ` ${one.title} `, h("small", {}, one.device)), h("div", { class: "pre quiet" }, one.text))));
    const list = [];
    for (const one of found.parameters) {
      const put = (access) => change("parameter", { job: target.value, parameter: one.parameter, access, value: value.value.trim() });
      list.push(h("article", { class: "hit" },
        h("details", {}, h("summary", {}, h("b", {}, one.parameter), ` ${one.text}`, one.danger ? h("em", { class: "bad", title: one.danger }, ` ${word("dangerous")}`) : null),
          h("dl", {}, one.facts.map(([name, text]) => [h("dt", {}, name), h("dd", {}, text)]))),
        putting(put, one.writable)));
    }
    list.push(...messages);
    for (const one of found.nothing) list.push(h("p", { class: "quiet" }, `${one.device}: ${said(one.why)}`, h("small", {}, ` ${said(one.help)}`)));
    if (!found.parameters.length && /^[pr]?\d{1,5}$/i.test(words.value.trim())) list.push(unknown());
    if (!list.length) list.push(h("p", { class: "quiet" }, word("nothingFound")));
    if (found.more) list.push(h("p", { class: "quiet" }, word("more")));
    return list;
  }

  // A parameter that the catalogue does not have: its type and unit are said with it.
  function unknown() {
    const { type, unit, fields } = typing();
    const put = (access) => change("parameter", { job: target.value, parameter: words.value.trim(), access, type: type.value, unit: unit.value, value: value.value.trim() });
    return h("div", { class: "hit typed" }, fields, putting(put, true));
  }

  function typing() {
    const type = h("select", { id: "job-type", "aria-label": word("type") }, desk.folder.types.map((one) => option(one, one, one === "FloatingPoint")));
    const unit = h("input", { size: 6, "aria-label": word("unit") });
    unit.setAttribute("list", "units");
    return { type, unit, fields: [field(word("type"), type), field(word("unit"), unit), h("datalist", { id: "units" }, desk.folder.units.map((one) => option(one)))] };
  }

  // Buttons for what the chosen job can take: it reads or writes, a recipe holds.
  function putting(put, writable) {
    const does = desk.checked?.jobs.find((one) => one.path.join("/") === target.value)?.does ?? [];
    const button = (access, label) => h("button", { type: "button", disabled: !target.value, onclick: () => put(access) }, word(label));
    if (target.value.startsWith("recipes/")) return writable ? [button("write", "addIt")] : [];
    return [!does.length || does.includes("read") ? button("read", "readIt") : null, writable && (!does.length || does.includes("write")) ? button("write", "writeIt") : null];
  }

  function addDrive() {
    const name = h("input", { required: true, value: free("drive", desk.checked?.drives), size: 10 });
    const { device, rule, object } = deviceFields(desk, desk.checked?.drives.at(-1)?.device || "sinamics-s120");
    const address = h("input", { value: desk.checked?.next_address || "270", inputmode: "numeric", size: 6, pattern: "[0-9]+" });
    const label = /300|400/.test(desk.checked?.family ?? "") ? "logicalAddress" : "hardwareId";
    return adding(word("addDrive"), [field(word("name"), name), field(word("device"), device), field(word(label), address), field(word("driveObject"), object), rule],
      (into) => change("drive", { key: name.value, device: device.value, address: address.value, drive_object: object.value }, into));
  }

  function addStation() {
    const lines = desk.checked?.lines ?? [];
    const line = h("input", { required: true, value: lines[0] ?? "line1", size: 10, list: "lines" });
    line.setAttribute("list", "lines");
    const name = h("input", { required: true, value: free("station", desk.checked?.stations), size: 10 });
    const address = h("input", { value: String(2 + (desk.checked?.stations.length ?? 0)), inputmode: "numeric", size: 4, pattern: "[0-9]+" });
    const cpu = h("select", {}, option("", word("anyCpu")), desk.folder.cpus.map((one) => option(one)));
    const port = h("input", { placeholder: "270", inputmode: "numeric", size: 6, pattern: "[0-9]*" });
    const first = h("input", { value: "VW100", size: 8 });
    const fresh = [field(word("port"), port), field(word("reads"), first)];
    const known = () => { for (const one of fresh) one.hidden = lines.includes(line.value); };
    line.addEventListener("input", known);
    known();
    return adding(word("addStation"), [field(word("line"), line), h("datalist", { id: "lines" }, lines.map((one) => option(one))), fresh, field(word("name"), name), field(word("ppiAddress"), address), field("CPU", cpu)],
      (into) => change("station", { line: line.value, key: name.value, address: address.value, cpu: cpu.value, port: port.value, parameter: first.value }, into));
  }

  function addJob() {
    const name = h("input", { required: true, value: free("job", desk.checked?.jobs), size: 10 });
    const all = [
      ...(desk.checked?.drives ?? []).map((one) => option(`drive:${one.key}`, one.key)),
      ...(desk.checked?.stations ?? []).map((one) => option(`station:${one.line}/${one.key}`, `${one.line} / ${one.key}`)),
    ];
    const several = (desk.checked?.drives.length ?? 0) > 1;
    const partner = h("select", { id: "job-partner", multiple: several, title: several ? word("several") : "" }, all);
    if (several) Object.assign(partner, { size: Math.min(4, all.length), selectedIndex: 0 });
    const start = h("select", { id: "job-start" }, option("", word("onEdge")), option("cycle", word("onCycle")), option("trigger", word("onFlag")));
    const when = h("input", { id: "job-when", size: 8 });
    const recipe = h("input", { id: "job-recipe", size: 12, value: desk.checked?.recipes[0] ?? "recipe1" });
    const recipeField = field(word("recipe"), recipe), whenField = field(word("every"), when);
    const kinds = h("div", { class: "kinds", id: "job-kinds", role: "radiogroup", "aria-label": word("kind") });
    const parameter = h("input", { id: "job-parameter", size: 8 }), { type, unit, fields: typed } = typing();
    const which = field(word("parameter"), parameter), ofJob = () => offered.find((each) => each.kind === kind);
    let wanted = new AbortController(), kind = "read", offered = [];
    const partner_ = () => [partner.value.split(":")[0], [...partner.selectedOptions].map((one) => one.value.split(":")[1]).join(",")];
    const given = () => {
      const [sort, key] = partner_();
      const put = { [sort || "drive"]: key, ...(kind.endsWith("_recipe") ? { recipe: recipe.value } : {}) };
      if (!which.hidden) put.parameter = parameter.value;
      if (ofJob()?.asks) Object.assign(put, { type: type.value, unit: unit.value });
      return start.value ? { ...put, [start.value]: when.value.trim() || when.placeholder } : put;
    };
    const reason = (one) => one.lacks || (start.value === "cycle" && !one.cycle ? word("noCycle") : "");
    const draw = () => {
      whenField.hidden = start.value === "";
      whenField.firstChild.textContent = word(start.value === "trigger" ? "flag" : "every");
      when.placeholder = start.value === "trigger" ? "M50.0" : "1s";
      recipeField.hidden = !kind.endsWith("_recipe");
      const offer = ofJob();
      which.hidden = (offer?.parameter ?? null) === null || (kind.endsWith("_recipe") && (desk.checked?.recipes ?? []).includes(recipe.value));
      which.firstChild.textContent = word(partner_()[0] === "station" ? "address" : "parameter");
      parameter.value = parameter.placeholder = offer?.parameter ?? "";
      for (const one of typed) one.hidden = which.hidden || !offer?.asks;
    };
    const list = () => {
      if (!offered.some((one) => one.kind === kind && !reason(one))) kind = offered.find((one) => !reason(one))?.kind ?? "";
      fill(kinds, offered.map((one) => h("label", { class: reason(one) ? "off" : "", title: reason(one) ? `${reason(one)}\n${one.help}` : "" },
        h("input", { type: "radio", name: "kind", value: one.kind, disabled: reason(one) !== "", checked: one.kind === kind, onchange: () => { kind = one.kind; draw(); } }),
        h("span", {}, h("b", {}, named("kind", one.kind)), h("small", {}, said(reason(one)) || named("is", one.kind, one.title))))));
      draw();
    };
    const offer = async () => {
      draw();
      if (!all.length) return fill(kinds, h("p", { class: "quiet" }, word("noPartner")));
      wanted.abort();
      wanted = new AbortController();
      const found = await attempt(() => ask("kinds", { ...desk.now, partner: partner_()[1] }, wanted.signal));
      if (!found) return;
      offered = found.kinds;
      list();
    };
    partner.addEventListener("change", offer);
    start.addEventListener("change", list);
    recipe.addEventListener("input", draw);
    const made = adding(word("addJob"), [field(word("name"), name), field(word("partner"), partner), field(word("start"), start), whenField, kinds, recipeField, which, typed], (into) => {
      const [sort, key] = partner_();
      added = sort === "station" ? `ppi/${key.split("/")[0]}/jobs/${name.value}` : `jobs/${name.value}`;
      return change("job", { key: name.value, kind, ...given() }, into);
    });
    draw();
    made.addEventListener("toggle", () => { if (made.open) offer(); });
    return made;
  }

  function adding(title, fields, add) {
    const wrong = h("div", { role: "alert" });
    const send = async (event) => {
      event.preventDefault();
      fill(wrong);
      if (await add(wrong)) { event.target.closest("details").open = false; outline(desk.checked); }
    };
    return h("details", { class: "adding" }, h("summary", {}, title), h("form", { onsubmit: send, novalidate: true }, fields, wrong, h("button", { class: "main", type: "submit" }, word("create"))));
  }

  const goTo = (one) => { if (one.place) desk.editor.go(...one.place); };
  const remove = (one) => change("remove", { path: one.path.join("/") });
  const small = (label, text, onclick) => h("button", { class: "plain", title: label, "aria-label": label, onclick }, text);

  // A drive, station or job: to its line, another name, away with it; Delete removes the row that has the focus.
  function entry(one, detail, more = () => {}) {
    const key = (event) => { if (event.key === "Delete") remove(one); };
    const row = h("button", { class: "row", onclick: () => { goTo(one); more(); }, onkeydown: key }, h("b", {}, one.key), detail);
    return h("div", { class: "entry" }, row, one.place ? [
      small(`${word("rename")}: ${one.key}`, "\u270e", () => { goTo(one); desk.rename(one.key); }), small(`${word("remove")}: ${one.key}`, "\u00d7", () => remove(one))] : null);
  }

  function outline(found) {
    if (!found) return;
    const open = [...form.querySelectorAll("details.adding[open] summary")].map((one) => one.textContent);
    fill(drives, found.drives.map((one) => entry(one, h("small", {}, one.title || "?"))), found.stations.map((one) => entry(one, h("small", {}, one.line))),
      h("div", { class: "adders" }, addDrive(), addStation()));
    fill(jobs, found.jobs.map((one) => entry(one, h("small", { title: one.drives.join(", ") }, one.drives.length > 3 ? `${one.drives.length} ${word("drives")}` : one.drives.join(", ")),
      () => { target.value = one.path.join("/"); chosen(); })), addJob());
    for (const one of form.querySelectorAll("details.adding")) one.open = open.includes(one.firstChild.textContent);
    const stations = found.stations.length > 0;
    partners.textContent = [found.drives.length || !stations ? word("drives") : "", stations ? word("stations") : ""].filter(Boolean).join(", ");
    catalogue.hidden = found.jobs.length === 0;
    const before = target.value;
    fill(target, found.jobs.map((one) => option(one.path.join("/"), one.key)), found.recipes.map((one) => option(`recipes/${one}`, `${word("recipe")} ${one}`)));
    const fresh = [...target.options].some((one) => one.value === added) ? added : "";  // what is added goes into the new job
    if (fresh) added = "";
    if (fresh || [...target.options].some((one) => one.value === before)) target.value = fresh || before;
    held();
  }

  // What the job that is chosen has, each with a button to remove it.
  function held() {
    const job = desk.checked?.jobs.find((one) => one.path.join("/") === target.value);
    cycle.hidden = !job?.place || !(job.repeats || job.cycle);  // one that the rules refuse can be removed
    if (repeated !== (repeated = `${target.value} ${job?.cycle}`)) every.value = job?.cycle ?? "";
    values.hidden = !target.value.startsWith("recipes/");
    words.placeholder = word(target.value.startsWith("ppi/") ? "itemHint" : "searchHint");
    fill(has, (job?.parameters ?? []).map((one) => h("span", { class: "chip" }, one.label, small(`${word("remove")}: ${one.label}`, "\u00d7", () => remove(one)))));
  }
  const chosen = () => { held(); search(); };

  words.addEventListener("input", search);
  held();
  target.addEventListener("change", chosen);
  const form = h("aside", { class: "form" },
    h("div", { class: "bar ways" }, h("button", { class: "plain", id: "undo", title: `${word("undo")} (Ctrl+Z)`, onclick: () => desk.editor.undo() }, "\u21b6"),
      h("button", { class: "plain", id: "redo", title: `${word("redo")} (Ctrl+Y)`, onclick: () => desk.editor.redo() }, "\u21b7")),
    partners, drives, h("h3", {}, word("jobs")), jobs, catalogue);
  return {
    element: form,
    checked(found) {
      if (!document.activeElement?.closest(".adding form")) outline(found);
      search();
    },
  };
}

// A device, the number of its drive object, and the rule for that.
export function deviceFields(desk, chosen) {
  const { devices } = desk.folder;
  const device = h("select", { name: "device" }, devices.map((one) => option(one.key, `${one.title} (${one.key})`, one.key === chosen)));
  const object = h("input", { name: "drive_object", inputmode: "numeric", size: 4, pattern: "[0-9]*" });
  const rule = h("small", { class: "rule" });
  const draw = () => {
    const one = devices.find((each) => each.key === device.value);
    object.value = one?.drive_object ?? "";
    rule.textContent = said(one?.rule ?? "");
  };
  device.addEventListener("change", draw);
  draw();
  return { device, object, rule };
}

function free(stem, known = []) {
  const names = new Set(known.map((one) => one.key));
  let number = 1;
  while (names.has(`${stem}${number}`)) number += 1;
  return `${stem}${number}`;
}
