// What a spec becomes: telegrams with member, address and line; what a panel connects; files; the write list; the lock.
import { fill, h, table } from "./dom.js";
import { ask, attempt } from "./ask.js";
import { said, word } from "./words.js";
import { markdown } from "./markdown.js";
import { panelView } from "./panel.js";
import { lockView } from "./lock.js";

const VIEWS = ["telegrams", "panel", "files", "workList", "lock"];

export function becomesTab(desk, written) {
  const side = h("div", { class: "side", id: "side" });
  const body = h("div", { class: "body", id: "body" });
  const switcher = h("div", { class: "bar views" });
  const told = h("span", { class: "quiet" });
  const seen = (one) => () => one === view;
  let view = "telegrams", made = null, asked = null, chosen = "", marked = 0, asking = new AbortController();

  async function load() {
    if (!desk.name || !desk.checked) return;
    if (desk.errors().length) {
      made = asked = null;
      fill(side);
      fill(body, h("p", { class: "empty" }, word("hasErrors")));
      return;
    }
    const now = desk.now;
    if (asked && asked.text === now.text && asked.name === now.name && asked.writes === desk.writes) return draw();
    asking.abort();
    asking = new AbortController();
    body.setAttribute("aria-busy", "true");
    const found = await attempt(() => ask("becomes", now, asking.signal));
    if (!found || now.text !== desk.text) return;
    body.removeAttribute("aria-busy");
    made = found;
    const depth = (path) => path.split("/").length - (path.endsWith(".scl") ? 0.5 : 0);
    made.files.sort((a, b) => depth(a.path) - depth(b.path) || a.path.localeCompare(b.path));
    asked = { ...now, writes: desk.writes };
    draw();
  }

  function draw() {
    fill(switcher, VIEWS.map((one) => h("button", { "aria-pressed": one === view ? "true" : "false", onclick: () => { view = one; marked = 0; draw(); } }, word(one))),
      h("span", { class: "space" }), told);
    if (!made) return;
    fill(told, `${made.project}, ${made.target}`);
    if (view === "telegrams") telegrams();
    else if (view === "files") files();
    else if (view === "panel") panelView(desk, side, body, seen(view));
    else if (view === "lock") lockView(desk, side, body, written, seen(view));
    else workList();
  }

  function pick(key, label, detail, act) {
    return h("button", { class: "row", "data-key": key, "aria-pressed": key === chosen ? "true" : "false", onclick: () => { chosen = key; act(); } }, h("b", {}, label), h("small", {}, detail));
  }

  function telegrams() {
    const key = (one) => `${one.job}/${one.number}`;
    if (!made.telegrams.some((one) => key(one) === chosen)) chosen = made.telegrams.length ? key(made.telegrams[0]) : "";
    fill(side, made.telegrams.map((one) => pick(key(one), one.job, made.telegrams.filter((other) => other.job === one.job).length > 1 ? `${one.number}` : one.block, telegrams)));
    const one = made.telegrams.find((each) => key(each) === chosen);
    if (!one) return fill(body);
    fill(body, h("p", { class: "quiet hint" }, word("hoverByte")), [one.request, ...one.answers].map((each) => message(each, made.excerpts)),
      h("dl", { class: "figures" }, Object.entries(one.lengths).map(([name, text]) => [h("dt", {}, said(name)), h("dd", {}, said(text))])));
  }

  function files() {
    if (!made.files.some((one) => one.path === chosen)) chosen = made.files.find((one) => one.state !== "same")?.path ?? made.files[0].path;
    const within = (path) => path.split("/").slice(0, -1).join("/");
    const folders = Map.groupBy(made.files, (one) => within(one.path));
    fill(side, [...folders].map(([folder, list]) => [folder ? h("h4", {}, `${folder}/`) : null, list.map((one) => h("button", {
      class: `row file ${one.state}`, title: `${one.path}: ${word(one.state)}`, "data-key": one.path, "aria-pressed": one.path === chosen ? "true" : "false", onclick: () => { chosen = one.path; marked = 0; files(); },
    }, h("b", {}, one.path.slice(folder ? folder.length + 1 : 0)), h("small", {}, one.state === "same" ? "=" : word(one.state))))]));
    side.querySelector("[aria-pressed=true]")?.scrollIntoView({ block: "nearest" });
    part(chosen);
  }

  async function part(path) {
    const found = await attempt(() => ask("part", { ...desk.now, path }));
    if (!found || path !== chosen || view !== "files") return;
    const text = () => h("pre", { class: "code" }, (marked && found.disk ? found.disk : found.text).split("\n").map((line, place) => h("div", { class: place + 1 === marked ? "marked" : "" }, h("i", {}, String(place + 1)), line || " ")));
    const page = () => h("div", { class: "guide" }, markdown(found.text));
    const shown = path.endsWith(".md") && !marked ? page : text;
    const diff = () => h("pre", { class: "code" }, found.diff.split("\n").map((line) => h("div", {
      class: line.startsWith("+") ? "plus" : line.startsWith("-") ? "minus" : line.startsWith("@") ? "at" : "" }, line || " ")));
    const room = h("div", {}, found.diff && !marked ? diff() : shown());
    const flip = (make) => () => fill(room, make());
    fill(body, h("div", { class: "bar" }, h("b", {}, path), h("span", { class: `chip ${found.state}` }, word(found.state)), h("span", { class: "space" }),
      found.diff ? [h("button", { onclick: flip(diff) }, word("diff")), h("button", { onclick: flip(shown) }, word("text"))] : null), room);
    room.querySelector(".marked")?.scrollIntoView({ block: "center" });
  }

  function workList() {
    fill(side, made.instances.map((one) => h("div", { class: "row" }, h("b", {}, one.job), h("small", {}, `${one.partner}, ${one.address}`))));
    if (!made.writes.length) return fill(body, h("p", { class: "empty" }, word("nothingWritten")));
    const heads = ["job", "partners", "parameter", "value", "limits", "trigger", "memory", "danger"].map((key) => word(key));
    const rows = made.writes.map((one) => h("tr", { class: one.danger ? "danger" : "" }, [
      one.job, one.partners.join(", "), [h("b", {}, one.parameter), ` ${one.text}`], [one.value, /^[-\d[]/.test(one.value) ? ` ${one.unit}` : null, one.input ? h("small", {}, ` ${word("input")}`) : null],
      [one.limits, one.limits && ` ${one.unit}`], one.trigger, one.memory.split("; ").map(said).join("; "), [one.danger, one.signed ? h("div", { class: "good" }, `${word("signed")}: ${one.signed}`) : null],
    ].map((cell, place) => h("td", { "data-head": heads[place] }, h("div", {}, cell)))));
    fill(body, h("h3", {}, word("writes")), table(heads, rows, "dense cards"));
  }

  return {
    key: "becomes", title: "tabBecomes",
    content: h("div", { class: "becomes" }, switcher, h("div", { class: "split" }, side, body)),
    shown: load,
    cleared() { made = asked = null; chosen = ""; fill(side); fill(body); fill(told); },
    // A line of a generated source.
    async source(file, line) {
      await load();
      view = "files";
      marked = line;
      chosen = made?.files.find((one) => file === one.path || file.endsWith(`/${one.path}`))?.path ?? chosen;
      draw();
    },
  };
}

// One telegram: cells of its bytes, rows of its members, lines of the sources; what belongs together is marked together.
function message(one, excerpts) {
  const box = h("article", { class: "message" });
  const mark = (offset, on) => {
    for (const each of box.querySelectorAll(`[data-offset="${offset}"]`)) each.classList.toggle("marked", on);
  };
  const live = (offset) => ({
    "data-offset": offset, tabindex: 0,
    onmouseenter: () => mark(offset, true), onmouseleave: () => mark(offset, false), onfocus: () => mark(offset, true), onblur: () => mark(offset, false),
  });
  const hex = (byte) => (byte === null ? "\u00b7\u00b7" : byte.toString(16).toUpperCase().padStart(2, "0"));
  const length = one.fields.reduce((sum, each) => sum + each.bytes.length, 0);
  const cells = one.fields.flatMap((each) => each.bytes.slice(0, 64).map((byte, place) => h("span", {
    ...live(each.offset), class: `byte r-${each.role} ${place === 0 ? "first" : ""}`, title: `${each.offset + place}: ${each.name}`, tabindex: place === 0 ? 0 : -1,
  }, hex(byte))));
  const placed = one.fields.some((each) => each.address);
  const rows = one.fields.map((each) => h("tr", live(each.offset), h("td", { class: "n" }, String(each.offset)),
    h("td", { class: "hex" }, each.bytes.slice(0, 8).map(hex).join(" "), each.bytes.length > 8 ? " \u2026" : ""),
    h("td", {}, h("b", {}, each.name)), placed ? h("td", { class: "hex place" }, each.address) : null, h("td", {}, each.value), h("td", {}, each.meaning)));
  const lines = excerpts.filter((each) => each.block === one.block).map((each) => h("div", {}, h("small", { class: "quiet" }, each.file),
    each.lines.map((line) => h("div", { ...(line.member === null ? {} : live(line.member)), class: "line" }, h("i", {}, String(line.number)), h("code", {}, line.text)))));
  fill(box, h("h3", { class: "title" }, said(one.title), h("small", {}, ` ${one.block}, ${said(`${length} bytes`)}`)),
    h("div", { class: "grid" }, cells),
    h("div", { class: "beside" }, table([word("offset"), word("bytes"), word("member"), placed ? word("address") : [], word("value"), word("meaning")].flat(), rows, "dense"),
      lines.length ? h("div", { class: "lines" }, h("h4", {}, word("sclLines")), lines) : null));
  return box;
}
