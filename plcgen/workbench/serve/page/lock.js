// The layout lock of the spec: whether what panels and other programs go by has moved.
import { fill, h } from "./dom.js";
import { ask, attempt, tell } from "./ask.js";
import { word } from "./words.js";
import { changesView } from "./changes.js";

export async function lockView(desk, side, body, written, seen) {
  fill(side);
  const found = await attempt(() => ask("lock", desk.now));
  if (!seen()) return undefined;
  if (!found) return fill(body);
  const moved = found.changes?.rows.length > 0;
  const write = async () => {
    if (!confirm(`${word("lockAsk")} ${found.lock}`)) return;
    const asked = { ...desk.now, known: desk.known };
    const done = await attempt(() => ask("relock", asked));
    if (!done) return;
    await written(asked.text, done.known);
    for (const one of done.problems) tell(`${one.code}: ${one.message}`, one.severity, one.help);
    lockView(desk, side, body, written, seen);
  };
  fill(side, h("div", { class: "row" }, h("b", {}, found.lock)));
  fill(body, h("p", { class: "quiet hint" }, word("lockHint")),
    h("p", { id: "lock-state" }, h("b", { class: !found.there ? "" : !moved && !found.problems.length ? "good" : "bad" }, word(!found.there ? "noLock" : moved ? "lockMoved" : found.problems.length ? "lockProblem" : "lockSame"))),
    found.problems.map((one) => h("p", { class: "bad" }, `${one.code}: ${one.message}`, h("small", {}, ` ${one.help}`))),
    moved ? changesView(found.changes) : null,
    h("button", { id: "relock", onclick: write }, word(found.there ? "lockAgain" : "lockWrite")));
}
