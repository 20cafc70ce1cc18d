// The soft CPU live: run, pause, step; everything that can be set by hand; lanes, telegrams, partners.
import { fill, h, option, field } from "./dom.js";
import { ask, attempt } from "./ask.js";
import { word } from "./words.js";
import { Lanes, telegramTable } from "./lanes.js";
import { faultForm, renew, valueFields } from "./hand.js";

const FEW = 6;  // jobs whose lanes are all shown; of more those that have run
const BOOLS = [["execute", "main"], ["busy", "note"], ["done", "good"], ["error", "bad"]];

export function runTab(desk) {
  const origin = h("select", {}, option("made", word("asMade")), option("disk", word("onDisk")));
  const time = h("input", { type: "number", value: "10", min: 1, max: 1000, size: 4 });
  const load = h("button", { class: "main", id: "load" }, word("load"));
  const run = h("button", { id: "run", disabled: true }, word("run"));
  const step = h("button", { id: "step", disabled: true }, word("step"));
  const ten = h("button", { id: "ten", disabled: true }, `${word("step")} \u00d710`);
  const where = h("span", { id: "scan", class: "quiet", role: "status" });
  const jobs = h("div", { id: "run-jobs" });
  const partners = h("div", { id: "partners" });
  const wire = h("div", { id: "wire", class: "wire" });
  const decoded = h("div", { id: "decoded" });
  const members = h("datalist", { id: "members" });
  const setting = h("input", { id: "set", list: "members" });
  setting.setAttribute("list", "members");
  const faults = h("div", {});
  const struck = h("div", { id: "struck" });
  const lanes = new Lanes((scan) => mark(scan));
  let state = null, going = false, timer = 0;

  // What is shown is of another spec.
  function cleared() {
    pause();
    state = null;
    load.textContent = word("load");
    for (const one of [run, step, ten]) one.disabled = true;
    for (const one of [where, jobs, partners, wire, decoded, faults, struck]) fill(one);
    for (const one of [hand, setting.form, driven]) one.hidden = true;
    fill(wire, h("p", { class: "quiet" }, word("loadFirst")));
    lanes.show([], 0);
  }

  function start(found) {
    state = { ...found, series: new Map(), known: [], contacts: [] };
    prepare(found);
    take(found);
  }

  function prepare(found) {
    load.textContent = word("restart");
    state.drawn = 0;
    fill(members, found.members.map((path) => option(path.replace(/"/g, ""))));
    fill(faults, faultForm(found.faults, (given, form) => act(() => ask("strike", given), form)));
    fill(partners, valueFields(found.partners.map((one) => ({ ...one, path: one.name })), held(found), put, true));
    for (const one of [hand, setting.form, driven]) one.hidden = false;
    setting.placeholder = found.members.length ? `${found.members[0].replace(/"/g, "")}=` : "";
    fill(decoded);
    fill(wire, h("p", { class: "quiet" }, word("noExchange")));
    for (const one of [run, step, ten]) one.disabled = false;
    buildJobs(found);
  }

  function take(found) {
    for (const one of found.signals) {
      state.known.push(one);
      state.series.set(one.id, [[1, one.start]]);
    }
    for (const each of found.steps) {
      for (const [id, value] of Object.entries(each.changes)) state.series.get(id)?.push([each.scan, value]);
      for (const one of each.exchanges) state.contacts.push({ ...one, scan: each.scan, time: each.time });
    }
    state.last = found;
    show(found);
  }

  function show(found) {
    fill(where, `${word("scan")} ${found.scan}, ${found.time} ms`, found.stopped ? h("b", { class: "bad" }, " STOP") : null);
    if (found.stopped || found.full) pause();
    for (const one of found.diagnostics.filter((each) => each.severity === "error")) fill(decoded, h("p", { class: "bad" }, `${one.code}: ${one.message}`));
    lanes.show(chosen(), found.scan, true);
    drawJobs(found);
    renew(partners, held(found));
    fill(struck, found.struck.map((one) => h("div", { class: "row" }, h("span", {}, `${one.text}${one.left === null ? "" : `, ${word("left")} ${one.left}`}`),
      h("button", { class: "plain", title: word("withdraw"), "aria-label": `${word("withdraw")}: ${one.text}`, onclick: () => act(() => ask("withdraw", { number: one.number })) }, "\u00d7"))));
    drawWire();
  }

  function chosen() {
    const list = [];
    const ran = (job) => ["execute", "busy"].some((name) => (state.series.get(`${job.key}.${name}`) ?? []).some(([, value]) => value === true));
    const many = state.jobs.length > FEW, seen = many ? state.jobs.filter(ran) : state.jobs;
    for (const job of seen.length ? seen : state.jobs.slice(0, FEW)) {
      const named = (name) => state.known.find((one) => one.id === `${job.key}.${name}`);
      for (const [name, style] of BOOLS) if (named(name)) list.push({ title: name, group: job.key, kind: "bool", style, series: state.series.get(`${job.key}.${name}`) });
      const found = named("state");
      if (found) list.push({ title: "state", group: job.key, kind: "state", names: found.names, series: state.series.get(found.id) });
      for (const one of state.known.filter((each) => each.group === job.key && each.name.endsWith(".BUSY"))) {
        list.push({ title: one.name.replace(".BUSY", ""), group: job.key, kind: "bool", style: "warn", series: state.series.get(one.id) });
      }
      const sent = state.contacts.filter((one) => one.group === job.key).map((one) => [one.scan, true]);
      if (sent.length) list.push({ title: word("telegrams"), group: job.key, kind: "mark", style: "main", series: sent });
    }
    return list;
  }

  const isOn = (job) => state.series.get(`${job.key}.execute`)?.at(-1)?.[1] === true;

  function buildJobs(found) {
    fill(jobs, state.jobs.map((job) => h("div", { class: "row job", "data-row": job.key },
      h("button", { title: job.execute, "aria-label": `execute ${job.key}`, "data-job": job.key, onclick: () => put(`${job.execute.replace(/"/g, "")}=${isOn(job) ? "FALSE" : "TRUE"}`) }),
      h("b", {}, job.key), h("small", {}), h("p", { class: "meaning" }), job.inputs.length ? h("div", { class: "inputs" }, valueFields(job.inputs, found.inputs, put)) : null)));
  }

  function drawJobs(found) {
    for (const job of state.jobs) {
      const row = jobs.querySelector(`[data-row="${CSS.escape(job.key)}"]`), [button, told, meaning] = ["button", "small", ".meaning"].map((one) => row.querySelector(one));
      const last = found.results.find((one) => one.job === job.key), on = isOn(job);
      button.setAttribute("aria-pressed", on ? "true" : "false");
      button.textContent = on ? "\u25a0" : "\u25b6";
      told.className = last?.ending === "error" ? "bad" : "";
      meaning.textContent = last?.ending === "error" ? last.text : "";
      told.textContent = last && last.ending !== "not_started" ? `${word(last.ending)} ${last.status}` : "";
    }
    renew(jobs, found.inputs);
  }

  const held = (found) => Object.fromEntries(found.partners.map((one) => [one.name, one.value]));

  function drawWire() {
    if (state.contacts.length === state.drawn) return;  // a click on what stays is not lost
    state.drawn = state.contacts.length;
    fill(wire, state.contacts.slice(-300).reverse().map((one) => h("button", { class: `row ${one.direction}`, "data-scan": String(one.scan), onclick: () => open(one) },
      h("span", { class: "n" }, String(one.scan)), h("span", {}, one.direction === "write" ? "\u2192" : "\u2190"), h("small", {}, one.drive), h("span", {}, one.text))));
  }

  function open(one) {
    lanes.go(one.scan);
    fill(decoded, h("h4", {}, `${word("scan")} ${one.scan}, ${one.drive}`), h("p", {}, one.text), one.telegram ? telegramTable(one.telegram, word) : null);
  }

  function mark(scan) {
    lanes.go(scan);
    const near = state.contacts.filter((one) => one.scan <= scan).at(-1);
    if (near && near.scan === scan) open(near);
  }

  async function act(call, into) {
    into?.querySelector(":scope > p.bad")?.remove();
    const found = await attempt(call, into);
    if (found) take(found);
    return found;
  }
  const put = async (text, into) => {
    const found = await act(() => ask("put", { text }), into);
    if (found && !going) act(() => ask("step", { scans: 1 }));
    return found;
  };

  function pause() {
    going = false;
    clearTimeout(timer);
    run.textContent = word("run");
  }

  async function tick() {
    if (!going) return;
    const found = await act(() => ask("step", { scans: 5 }));
    if (found && going) timer = setTimeout(tick, 100);
    else pause();
  }

  load.addEventListener("click", async () => {
    pause();
    load.disabled = true;
    const found = await attempt(() => ask("load", { ...desk.now, origin: origin.value, scan_time: Number(time.value) || 10 }));
    load.disabled = false;
    if (found) start(found);
  });
  run.addEventListener("click", () => {
    if (going) return pause();
    going = true;
    run.textContent = word("pause");
    tick();
  });
  step.addEventListener("click", () => act(() => ask("step", { scans: 1 })));
  ten.addEventListener("click", () => act(() => ask("step", { scans: 10 })));
  const send = async (event) => {
    event.preventDefault();
    if (setting.value.trim() && state && await act(() => ask("put", { text: setting.value.trim() }), event.target)) setting.value = "";
  };

  const hand = h("h3", { hidden: true }, word("goesWrong")), driven = h("h3", { hidden: true }, word("driveValues"));
  fill(wire, h("p", { class: "quiet" }, word("loadFirst")));
  return {
    key: "run", title: "tabRun",
    content: h("div", { class: "stack" },
      h("div", { class: "bar views" }, field(word("source"), origin), field("ms", time), load, run, step, ten, where),
      h("div", { class: "running" },
        h("div", { class: "side" }, h("h3", {}, word("jobs"), h("small", {}, " execute")), jobs,
          h("form", { class: "one", hidden: true, title: word("setHint"), onsubmit: send }, setting, h("button", {}, word("set"))), members,
          driven, partners, hand, struck, faults),
        h("div", { class: "middle" }, lanes.box, h("div", { class: "below" }, h("div", {}, h("h3", {}, word("exchanges")), wire), decoded)))),
    shown() { lanes.size(); },
    cleared,
    // The same run in the other language.
    kept() {
      pause();
      return state;
    },
    resume(before) {
      if (!before) return;
      state = before;
      prepare(state);
      show(state.last);
    },
  };
}
