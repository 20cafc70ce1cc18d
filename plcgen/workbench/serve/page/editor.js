// The editor: CodeMirror if its bundle is there, else a text field with the same face.
import { h } from "./dom.js";

class Field {
  constructor(parent, hooks) {
    this.area = h("textarea", { class: "plain-editor", spellcheck: "false", autocomplete: "off", wrap: "off", "aria-label": "YAML" });
    this.area.addEventListener("input", () => hooks.changed());
    parent.append(this.area);
  }
  get text() { return this.area.value; }
  open(text) { this.area.value = text; }
  undo() { this.area.focus(); document.execCommand("undo"); }
  redo() { this.area.focus(); document.execCommand("redo"); }
  // As typed, so that the browser's own way back has it.
  apply(edits) {
    const lines = this.text.split("\n");
    const at = (line, character) => lines.slice(0, line).reduce((sum, one) => sum + one.length + 1, 0) + character;
    this.area.focus({ preventScroll: true });
    for (const one of sorted(edits)) {
      const from = at(one.place[0], one.place[1]), to = at(one.place[2], one.place[3]);
      this.area.setSelectionRange(from, to);
      if (document.execCommand(one.text ? "insertText" : "delete", false, one.text)) continue;
      this.area.setRangeText(one.text, from, to, "end");
      this.area.dispatchEvent(new Event("input"));
    }
  }
  problems() {}
  get place() {
    const before = this.text.slice(0, this.area.selectionStart).split("\n");
    return { line: before.length - 1, character: before.at(-1).length };
  }
  go(line, character = 0) {
    const lines = this.text.split("\n");
    const place = lines.slice(0, line).reduce((sum, one) => sum + one.length + 1, 0) + character;
    this.area.focus();
    this.area.setSelectionRange(place, place);
  }
  focus() { this.area.focus({ preventScroll: true }); }
  measure() {}
}

const sorted = (edits) => [...edits].sort((a, b) => b.place[0] - a.place[0] || b.place[1] - a.place[1]);

class Code {
  constructor(parent, hooks, cm) {
    this.cm = cm;
    this.hooks = hooks;
    const style = cm.HighlightStyle.define([
      { tag: [cm.tags.propertyName, cm.tags.definition(cm.tags.propertyName)], class: "y-key" },
      { tag: [cm.tags.string, cm.tags.content], class: "y-text" },
      { tag: [cm.tags.comment, cm.tags.lineComment], class: "y-comment" },
      { tag: [cm.tags.number, cm.tags.bool, cm.tags.null], class: "y-number" },
    ]);
    this.extensions = [
      cm.EditorView.cspNonce.of(document.documentElement.dataset.nonce),
      cm.lineNumbers(), cm.history(), cm.drawSelection(), cm.highlightActiveLine(), cm.highlightActiveLineGutter(),
      cm.highlightSelectionMatches(), cm.yaml(), cm.syntaxHighlighting(style), cm.indentUnit.of("  "), cm.lintGutter(),
      cm.autocompletion({ override: [(context) => this.offers(context)], activateOnTypingDelay: 60 }),
      cm.hoverTooltip((view, position) => this.hover(view, position), { hoverTime: 250 }),
      cm.keymap.of([
        ...cm.completionKeymap, ...cm.searchKeymap, ...cm.lintKeymap, ...cm.historyKeymap, ...cm.defaultKeymap, cm.indentWithTab,
      ]),
      cm.EditorView.updateListener.of((update) => { if (update.docChanged) hooks.changed(); }),
      cm.EditorView.contentAttributes.of({ "aria-label": "YAML" }),
    ];
    this.view = new cm.EditorView({ parent, state: this.state("") });
  }
  state(text) { return this.cm.EditorState.create({ doc: text, extensions: this.extensions }); }
  get text() { return this.view.state.doc.toString(); }
  open(text) { this.view.setState(this.state(text)); }
  at(line, character) {
    const doc = this.view.state.doc;
    if (line >= doc.lines) return doc.length;
    const found = doc.line(line + 1);
    return Math.min(found.from + character, found.to);
  }
  range(place) { return { from: this.at(place[0], place[1]), to: this.at(place[2], place[3]) }; }
  apply(edits) {
    const changes = sorted(edits).reverse().map((one) => ({ ...this.range(one.place), insert: one.text }));
    if (!changes.length) return;
    const made = this.view.state.changes(changes);
    const selection = { anchor: made.mapPos(changes[0].to, 1) };  // behind what is new
    this.view.dispatch({ changes: made, selection, scrollIntoView: true, annotations: this.cm.isolateHistory.of("full") });
  }
  problems(found) {
    const marks = found.filter((one) => one.here && one.line).map((one) => {
      const { from, to } = this.range(one.place);
      const severity = { error: "error", warning: "warning", note: "info" }[one.severity];
      const actions = one.fixes.map((fix) => ({ name: fix.title, apply: () => this.apply(this.hooks.reasoned(fix.edits) ?? []) }));
      const say = () => h("div", { class: "say" }, h("b", {}, one.code), ` ${one.message}`, one.help ? h("small", {}, one.help) : null);
      return { from, to: Math.max(to, from), severity, message: one.message, renderMessage: say, actions };
    });
    this.view.dispatch(this.cm.setDiagnostics(this.view.state, marks));
  }
  go(line, character = 0) {
    const place = this.at(line, character);
    this.view.dispatch({ selection: { anchor: place }, effects: this.cm.EditorView.scrollIntoView(place, { y: "center" }) });
    this.view.focus();
  }
  focus() { this.view.focus(); }
  undo() { this.cm.undo(this.view); }
  redo() { this.cm.redo(this.view); }
  measure() { this.view.requestMeasure(); }
  get place() { return this.caret(this.view.state.selection.main.head); }
  caret(position) {
    const line = this.view.state.doc.lineAt(position);
    return { line: line.number - 1, character: position - line.from };
  }
  async offers(context) {
    const before = context.matchBefore(/[^\s:,{}[\]]*/);
    if (!context.explicit && before.from === before.to && !/[\s,{[]$/.test(context.state.sliceDoc(Math.max(0, context.pos - 1), context.pos))) return null;
    const found = await this.hooks.complete(this.caret(context.pos));
    if (!found?.offers.length || context.aborted) return null;
    const start = Math.min(...found.offers.map((one) => this.range(one.place).from));
    return {
      from: start,
      options: found.offers.map((one, place) => ({
        label: one.label, detail: one.detail, type: one.kind, boost: 99 - Math.min(place, 98),
        info: one.text ? () => h("div", { class: "say pre" }, one.text) : undefined,
        apply: (view) => {
          const { from, to } = this.range(one.place);
          const end = Math.max(to, view.state.selection.main.head);
          view.dispatch({ changes: { from, to: end, insert: one.insert }, selection: { anchor: from + one.insert.length } });
        },
      })),
      validFor: /^[\w.-]*$/,
    };
  }
  async hover(view, position) {
    const found = await this.hooks.hover(this.caret(position));
    if (!found?.page) return null;
    const { from, to } = this.range(found.place);
    const { key, title, sections } = found.page;
    return { pos: from, end: to, above: true, create: () => ({
      dom: h("div", { class: "card" }, h("b", {}, key), ` ${title}`,
        sections.map((one) => h("div", {}, h("h4", {}, one.heading), h("div", { class: "pre" }, one.text)))),
    }) };
  }
}

export async function makeEditor(parent, hooks, bundled) {
  if (!bundled) return new Field(parent, hooks);
  return new Code(parent, hooks, await import("./codemirror.bundle.js"));
}
