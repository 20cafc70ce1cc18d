// Verification with progress; a check that failed opens its run, at its scan.
import { fill, h, option, field, table } from "./dom.js";
import { ask, attempt } from "./ask.js";
import { named, word } from "./words.js";
import { Lanes, telegramTable } from "./lanes.js";

// Follow the work of the server until it ends: its result, or nothing if it was cancelled or failed.
export async function follow(begin, bar, told) {
  const started = await attempt(begin);
  if (!started) return undefined;
  bar.hidden = false;
  try {
    for (;;) {
      const now = await attempt(() => ask("state"));
      if (!now || now.number !== started.number) return undefined;
      bar.max = now.total || 1;
      bar.value = now.done;
      fill(told, now.ended ? "" : `${named("step", now.what.split(" ")[0], now.what)} ${now.total ? `${now.done} / ${now.total}` : ""}`);
      if (now.ended) {
        if (now.cancelled) fill(told, word("cancelled"));
        return now.result ?? undefined;
      }
      await new Promise((wake) => setTimeout(wake, 200));
    }
  } finally {
    bar.hidden = true;
  }
}

export function verifyTab(desk, source) {
  const origin = h("select", { id: "verify-files" }, option("made", word("asMade")), option("disk", word("onDisk")));
  const effort = h("select", { id: "effort" }, option("none", word("faultsNone")), option("quick", word("faultsQuick"), true), option("full", word("faultsFull")));
  const start = h("button", { class: "main", id: "verify-start" }, word("begin"));
  const cancel = h("button", { id: "verify-cancel", disabled: true, onclick: () => attempt(() => ask("cancel")) }, word("cancel"));
  const bar = h("progress", { hidden: true });
  const told = h("span", { class: "quiet", id: "verify-told", role: "status" });
  const body = h("div", { class: "body", id: "verified" });
  let last = null;

  start.addEventListener("click", async () => {
    start.disabled = true;
    cancel.disabled = false;
    fill(body);
    const asked = { ...desk.now, origin: origin.value, faults: effort.value };
    const found = await follow(() => ask("verify", asked), bar, told);
    start.disabled = false;
    cancel.disabled = true;
    if (found && asked.name === desk.name) show(found, asked);
    else if (!found) empty();
  });
  const empty = () => fill(body, h("p", { class: "empty" }, word("verifyHint")));
  empty();

  function show(found, asked) {
    last = [found, asked];
    const outcomes = Object.entries(found.summary).map(([name, count]) => h("span", { class: `chip o-${name}` }, `${count} ${word(`o_${name}`)}`));
    const left = found.groups.flatMap((group) => group.checks).filter((one) => one.outcome === "not run");
    const problems = found.diagnostics.filter((one) => one.severity !== "note");
    fill(body, h("p", { class: "verdict" }, h("b", { class: found.ok ? "good" : "bad" }, found.ok ? "\u2713 ok" : `\u2717 ${word("o_error")}`), " ", `${[found.project, found.target].filter(Boolean).join(", ")} `, outcomes),
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
    const room = h("div", {});
    const opened = async (scenario) => {
      const given = { name: asked.name, text: asked.text, origin: asked.origin, check: one.id, scenario };
      const found = await attempt(() => ask("replay", given));
      if (found) fill(room, replayed(found));
    };
    const button = (scenario) => h("button", { class: "open-run", onclick: () => opened(scenario) }, `${word("openRun")}${scenario ? `: ${scenario}` : ""}`);
    return h("tr", { class: one.outcome === "error" ? "danger" : "" }, h("td", {}, one.subject),
      h("td", {}, one.text, one.diagnostic ? h("div", { class: "bad" }, `${one.diagnostic.code}: `, differing(one.diagnostic.message), h("small", {}, ` ${one.diagnostic.help}`)) : null,
        one.runs ? h("div", {}, (one.failed.length ? one.failed : [""]).map(button), room) : null,
        one.outcome === "error" && one.diagnostic?.line && /\.(scl|udt|db|awl)$/i.test(one.diagnostic.file)
          ? h("button", { class: "open-line", onclick: () => source(one.diagnostic.file, one.diagnostic.line) }, `${word("openLine")} ${one.diagnostic.line}`) : null),
      h("td", { class: `o-${one.outcome.replace(" ", "_")}` }, one.outcome === "error" ? word("o_error") : one.verdict));
  }

  return {
    key: "verify", title: "tabVerify",
    content: h("div", { class: "stack" }, h("div", { class: "bar views" }, field(word("source"), origin), field(word("effort"), effort), start, cancel, bar, told), body),
    cleared() { empty(); fill(told); last = null; },
    kept: () => last,
    again: (one) => show(...one),
  };
}

// Of two rows of bytes in a message those that differ are marked.
function differing(text) {
  const rows = [...text.matchAll(/[0-9A-F]{2}(?: [0-9A-F]{2})+/gi)];
  if (rows.length !== 2) return text;
  const [one, two] = rows.map((row) => row[0].split(" "));
  const shown = (row, other) => row.map((byte, at) => (byte === other[at] ? `${byte} ` : [h("span", { class: "marked" }, byte), " "]));
  const end = (row) => row.index + row[0].length;
  return [text.slice(0, rows[0].index), shown(one, two), text.slice(end(rows[0]), rows[1].index), shown(two, one), text.slice(end(rows[1]))];
}

function replayed(found) {
  const decoded = h("div", {});
  const lanes = new Lanes((scan) => {
    lanes.go(scan);
    const one = found.exchanges.findLast((each) => each.scan === scan);
    if (one) decode(one);
  });
  const decode = async (one) => {
    if (!one.hex) return;
    const told = await attempt(() => ask("explain", { text: one.hex }));
    if (told?.telegrams) fill(decoded, told.telegrams.map((each) => telegramTable(each, word)));
  };
  const list = Object.entries(found.jobs).flatMap(([group, calls]) => {
    const series = (place) => calls.map((call) => [call[0], call[place]]);
    return [...[["execute", 1, "main"], ["busy", 2, "note"], ["done", 3, "good"], ["error", 4, "bad"]].map(([title, place, style]) => ({ title, group, kind: "bool", style, series: series(place) })),
      { title: "status", group, kind: "state", series: series(5) }];
  });
  list.push({ title: word("telegrams"), group: "", kind: "mark", style: "main", series: found.exchanges.map((one) => [one.scan, true]) });
  const room = h("div", { class: "replay" },
    h("p", {}, h("b", {}, found.scenario), " ", found.failure ? h("span", { class: "bad" }, `${word("scan")} ${found.failure.scan}: ${found.failure.text} (${found.failure.file}:${found.failure.line})`) : word("notAgain")),
    lanes.box, h("div", { class: "wire" }, found.exchanges.slice(-40).map((one) => h("button", { class: "row", onclick: () => { lanes.go(one.scan); decode(one); } },
      h("span", { class: "n" }, String(one.scan)), h("span", {}, one.direction === "write" || one.direction === ">" ? "\u2192" : "\u2190"), h("span", { class: "hex" }, one.hex || "\u2026")))), decoded);
  requestAnimationFrame(() => {
    lanes.show(list, found.scans, false);
    lanes.go(found.failure ? found.scans : 1);
  });
  return room;
}
