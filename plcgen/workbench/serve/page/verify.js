// Verification with progress; a check that failed opens its run, at its scan.
import { fill, h, option, field, table } from "./dom.js";
import { ask, attempt } from "./ask.js";
import { named, word } from "./words.js";
import { Lanes, telegramTable } from "./lanes.js";

// The work of a tab: begun by its button, shown when it ends, kept while the page changes its language.
export function working(desk, question, label, given, show, empty) {
  const start = h("button", { class: "main", id: `${question}-start` }, label);
  const cancel = h("button", { id: `${question}-cancel`, disabled: true, onclick: () => attempt(() => ask("cancel")) }, word("cancel"));
  const bar = h("progress", { hidden: true });
  const told = h("span", { class: "quiet", role: "status" });
  let now = null;  // what was asked, and what came of it

  async function work(begin, asked) {
    const mine = now = { asked, started: attempt(begin) };
    empty();
    const started = await mine.started;
    if (!started) return;
    bar.hidden = cancel.disabled = !(start.disabled = true);
    for (;;) {
      const state = await attempt(() => ask("state"));
      if (!state || state.number !== started.number) break;
      bar.max = state.total || 1;
      bar.value = state.done;
      fill(told, state.ended ? (state.cancelled ? word("cancelled") : "") : `${named("step", state.what.split(" ")[0], state.what)} ${state.total ? `${state.done} / ${state.total}` : ""}`);
      if (state.ended) mine.found = state.result;
      if (state.ended) break;
      await new Promise((wake) => setTimeout(wake, 200));
    }
    bar.hidden = cancel.disabled = !(start.disabled = false);
    if (mine.found && now === mine) show(mine.found, asked);
  }
  start.addEventListener("click", () => {
    const asked = { ...desk.now, ...given() };
    work(() => ask(question, asked), asked);
  });
  return {
    controls: [start, cancel, bar, told],
    kept: () => now,
    resume(before) {
      if (!before) return;
      now = before;
      if (now.found) show(now.found, now.asked);
      else work(() => before.started, now.asked);
    },
    cleared() {
      now = null;
      fill(told);
      empty();
    },
  };
}

export function verifyTab(desk, source) {
  const origin = h("select", { id: "verify-files" }, option("made", word("asMade")), option("disk", word("onDisk")));
  const effort = h("select", { id: "effort" }, option("none", word("faultsNone")), option("quick", word("faultsQuick"), true), option("full", word("faultsFull")));
  const body = h("div", { class: "body", id: "verified" });

  const empty = () => fill(body, h("p", { class: "empty" }, word("verifyHint")));
  empty();

  function show(found, asked) {
    origin.value = asked.origin;
    effort.value = asked.faults;
    const outcomes = Object.entries(found.summary).map(([name, count]) => h("span", { class: `chip o-${name}` }, `${count} ${word(`o_${name}`)}`));
    const left = found.groups.flatMap((group) => group.checks).filter((one) => one.outcome === "not run");
    const problems = found.diagnostics.filter((one) => one.severity !== "note");
    fill(body, found.stale ? h("p", { class: "bad", id: "stale" }, word("staleFolder")) : null, h("p", { class: "verdict" }, h("b", { class: found.ok ? "good" : "bad" }, found.ok ? "\u2713 ok" : `\u2717 ${word("o_error")}`), " ", `${[found.project, found.target].filter(Boolean).join(", ")} `, outcomes),
      h("p", { class: "quiet", id: "verified-files" }, word(asked.origin === "made" ? "madeOnly" : "diskOnly")),
      left.length ? h("details", { id: "left-out" }, h("summary", {}, `${left.length} ${word("o_not_run")}: ${word("notRun")}`),
        h("ul", {}, left.map((one) => h("li", {}, h("b", {}, one.subject), ` ${one.text} `, h("span", { class: "quiet" }, one.verdict === "not asked for" ? word("notAsked") : one.verdict))))) : null,
      problems.map((one) => h("p", { class: one.severity === "error" ? "bad" : "" }, `${one.code}: ${one.message}`, h("small", {}, ` ${one.help}`))),
      found.groups.map((group) => h("details", { open: group.checks.some((one) => one.outcome === "error") || group.name === "execution" },
        h("summary", {}, h("b", {}, named("group", group.name, group.title)), h("small", {}, ` ${group.checks.length}, ${group.checks.filter((one) => one.outcome === "error").length} ${word("o_error")}`)),
        table([word("subject"), word("check"), word("result")], group.checks.map((one) => row(one, asked)), "dense"))),
      h("details", {}, h("summary", {}, word("ledger")), table([word("subject"), word("meaning"), word("source"), ""], found.ledger.map((one) => h("tr", {},
        h("td", {}, one.subject), h("td", {}, one.text), h("td", {}, one.source), h("td", {}, one.grade))), "dense")));
  }

  function row(one, asked) {
    const room = h("td", { colSpan: 3 }), below = h("tr", { hidden: true }, room);
    const opened = async (scenario) => {
      const given = { name: asked.name, text: asked.text, origin: asked.origin, check: one.id, scenario };
      const found = await attempt(() => ask("replay", given));
      below.hidden = !found;
      if (found) fill(room, replayed(found));
    };
    const button = (scenario) => h("button", { class: "open-run", onclick: () => opened(scenario) }, `${word("openRun")}${scenario ? `: ${scenario}` : ""}`);
    return [h("tr", { class: one.outcome === "error" ? "danger" : "" }, h("td", {}, one.subject),
      h("td", {}, one.text, one.diagnostic ? h("div", { class: "bad" }, `${one.diagnostic.code}: `, differing(one.diagnostic.message), h("small", {}, ` ${one.diagnostic.help}`)) : null,
        one.runs ? h("div", {}, (one.failed.length ? one.failed : [""]).map(button)) : null,
        one.outcome === "error" && SHOWN.test(one.diagnostic?.file)
          ? h("button", { class: "open-line", onclick: () => source(one.diagnostic.file, one.diagnostic.line) }, one.diagnostic.line ? `${word("openLine")} ${one.diagnostic.line}` : word("openDiff")) : null),
      h("td", { class: `o-${one.outcome.replace(" ", "_")}` }, one.outcome === "error" ? word("o_error") : one.verdict)), one.runs ? below : null];
  }

  const work = working(desk, "verify", word("begin"), () => ({ origin: origin.value, faults: effort.value }), show, empty);
  return {
    key: "verify", title: "tabVerify", ...work,
    content: h("div", { class: "stack" }, h("div", { class: "bar views" }, field(word("source"), origin), field(word("effort"), effort), work.controls), body),
  };
}

const SHOWN = /\.(scl|udt|db|awl|csv|md)$/i;

// Of two rows of bytes in a message those that differ are marked.
function differing(text) {
  const rows = [...text.matchAll(/\b[0-9A-F]{2}(?: [0-9A-F]{2})+\b/gi)];
  if (rows.length !== 2) return text;
  const [one, two] = rows.map((row) => row[0].split(" "));
  const shown = (row, other) => row.map((byte, at) => [at ? " " : "", byte === other[at] ? byte : h("span", { class: "marked" }, byte)]);
  const end = (row) => row.index + row[0].length;
  return [text.slice(0, rows[0].index), shown(one, two), text.slice(end(rows[0]), rows[1].index), shown(two, one), text.slice(end(rows[1]))];
}

function replayed(found) {
  const decoded = h("div", { class: "zones pair" });
  const lanes = new Lanes((scan) => {
    lanes.go(scan);
    decode(contacts.findLast((each) => each.scan === scan));
  });
  const explained = async (hex, title) => {
    const told = await attempt(() => ask("explain", { text: hex }));
    return h("article", {}, h("h4", {}, title), told?.telegrams?.map((each) => telegramTable(each, word)));
  };
  const decode = async (one) => {
    if (one?.hex) fill(decoded, await explained(one.hex, `${word("scan")} ${one.scan}`), one.stated ? await explained(one.stated, word("stated")) : null);
  };
  const at = found.failure?.scan ?? found.scans, [hex, stated] = found.telegrams;
  const contacts = hex ? [...found.exchanges, { scan: at, direction: "write", hex, stated, failing: true }] : found.exchanges;
  const list = Object.entries(found.jobs).flatMap(([group, calls]) => {
    const series = (place) => calls.map((call) => [call[0], call[place]]);
    return [...[["execute", 1, "main"], ["busy", 2, "note"], ["done", 3, "good"], ["error", 4, "bad"]].map(([title, place, style]) => ({ title, group, kind: "bool", style, series: series(place) })),
      { title: "status", group, kind: "state", series: series(5) }];
  });
  list.push({ title: word("telegrams"), group: "", kind: "mark", style: "main", series: contacts.map((one) => [one.scan, true]) });
  const room = h("div", { class: "replay" },
    h("p", {}, h("b", {}, found.scenario), " ", found.failure ? h("span", { class: "bad" }, `${word("scan")} ${found.failure.scan}: `, differing(found.failure.text), ` (${found.failure.file}:${found.failure.line})`) : word("notAgain")),
    lanes.box, h("div", { class: "wire" }, contacts.slice(-40).map((one) => h("button", { class: `row ${one.failing ? "failing" : ""}`, onclick: () => { lanes.go(one.scan); decode(one); } },
      h("span", { class: "n" }, String(one.scan)), h("span", {}, one.direction === "write" || one.direction === ">" ? "\u2192" : "\u2190"), one.failing ? h("b", {}, word("o_error")) : null, h("span", { class: "hex" }, one.hex || "\u2026")))), decoded);
  requestAnimationFrame(() => {
    lanes.show(list, found.scans, false);
    lanes.spread();
    lanes.go(at);
    decode(contacts.findLast((each) => each.scan <= at));
  });
  return room;
}
