// Labels of the page. Messages, titles and facts come from the server and are English.
const WORDS = {
  spec: ["Spec", "Spec"], newSpec: ["New…", "Neu…"], save: ["Save", "Speichern"], write: ["Write files…", "Dateien schreiben…"],
  zip: ["ZIP", "ZIP"], theme: ["light / dark", "hell / dunkel"], close: ["close", "schließen"],
  gone: ["the server does not answer: is plcgen serve still running?", "der Server antwortet nicht: läuft plcgen serve noch?"],
  unsaved: ["not saved", "nicht gespeichert"], saved: ["saved", "gespeichert"], fresh: ["new, not saved", "neu, nicht gespeichert"],
  plainEditor: ["plain text field: this checkout has no editor bundle (make editor)",
    "einfaches Textfeld: dieser Checkout hat kein Editor-Paket (make editor)"],
  tabSpec: ["Spec", "Spec"], tabBecomes: ["What it becomes", "Was daraus wird"], tabRun: ["Run", "Lauf"],
  tabVerify: ["Verify", "Prüfen"], tabReview: ["Review", "Review"], tabTools: ["Tools", "Werkzeuge"],
  problems: ["Problems", "Probleme"], noProblems: ["No problems", "Keine Probleme"],
  rename: ["Rename", "Umbenennen"],
  fix: ["Fix", "Beheben"], why: ["Why", "Warum"], remedy: ["Remedy", "Abhilfe"],
  drives: ["Drives", "Antriebe"], jobs: ["Jobs", "Aufträge"], addDrive: ["Add drive", "Antrieb hinzufügen"],
  addJob: ["Add job", "Auftrag hinzufügen"], name: ["Name", "Name"], device: ["Device", "Gerät"],
  address: ["Hardware identifier / address", "HW-Kennung / Adresse"], kind: ["Kind", "Art"], drive: ["Drive", "Antrieb"],
  stations: ["Stations", "Stationen"], catalogue: ["Parameters", "Parameter"],
  searchHint: ["ramp, motor temperature, P1120, F30001", "ramp, motor temperature, P1120, F30001"],
  addTo: ["Job", "Auftrag"], readIt: ["+ read", "+ lesen"], writeIt: ["+ write", "+ schreiben"],
  nothingFound: ["nothing found", "nichts gefunden"], dangerous: ["dangerous", "gefährlich"], more: ["more: be more precise", "weitere: genauer suchen"],
  family: ["CPU family", "CPU-Familie"], toolchain: ["Toolchain", "Werkzeug"], create: ["Create", "Anlegen"], cancel: ["Cancel", "Abbrechen"],
  file: ["File", "Datei"], ppiMaster: ["S7-200 stations (PPI)", "S7-200-Stationen (PPI)"], format: ["Format", "Formatieren"],
  telegrams: ["Telegrams", "Telegramme"], files: ["Files", "Dateien"], workList: ["Work list", "Schreibliste"],
  request: ["Request", "Anfrage"], answer: ["Answer", "Antwort"], member: ["Member", "Element"], value: ["Value", "Wert"],
  meaning: ["Meaning", "Bedeutung"], bytes: ["Bytes", "Bytes"], offset: ["Offset", "Offset"], sclLines: ["Lines in the sources", "Zeilen in den Quellen"],
  hoverByte: ["Point at a byte or a row: the member, its address and its line are marked.",
    "Auf ein Byte oder eine Zeile zeigen: Element, Adresse und Quellzeile werden markiert."],
  new: ["new", "neu"], changed: ["changed", "geändert"], same: ["as on disk", "wie auf der Platte"], manifest: ["list of files", "Dateiliste"],
  text: ["Text", "Text"], diff: ["Difference", "Unterschied"], writes: ["What is written", "Was geschrieben wird"],
  nothingWritten: ["Nothing is written: all jobs only read.", "Es wird nichts geschrieben: alle Aufträge lesen nur."],
  parameter: ["Parameter", "Parameter"], limits: ["Limits", "Grenzen"], trigger: ["Started by", "Start durch"], memory: ["Ends up in", "Landet in"],
  danger: ["Danger", "Gefahr"], signed: ["Signed off", "Freigegeben"], partners: ["Drives", "Antriebe"], input: ["input", "Eingang"],
  hasErrors: ["The spec has errors: nothing is made of it yet.", "Die Spec hat Fehler: noch wird nichts daraus."],
  writeAsk: ["Save the spec and write its files?", "Spec speichern und Dateien schreiben?"],
  writeInto: ["into", "nach"], written: ["written", "geschrieben"], unchanged: ["unchanged", "unverändert"], removed: ["removed", "entfernt"],
  writeRule: ["Nothing that plcgen did not write, or that was changed since, is overwritten.",
    "Nichts, was plcgen nicht geschrieben hat oder was seither geändert wurde, wird überschrieben."],
  start: ["Start", "Start"], effort: ["Faults", "Fehler"], source: ["Files", "Dateien"],
  asMade: ["as the spec makes them now", "wie die Spec sie jetzt macht"], onDisk: ["as they lie on disk", "wie sie auf der Platte liegen"],
  running: ["running", "läuft"], check: ["Check", "Prüfung"], result: ["Result", "Ergebnis"], subject: ["Subject", "Gegenstand"],
  openRun: ["Open run", "Lauf öffnen"], cancelled: ["cancelled", "abgebrochen"], ledger: ["What the result rests on", "Worauf das Ergebnis beruht"],
  load: ["Load program", "Programm laden"], run: ["Run", "Lauf"], pause: ["Pause", "Pause"], step: ["Step", "Schritt"], restart: ["Restart", "Neustart"],
  scan: ["scan", "Zyklus"], set: ["Set", "Setzen"], fault: ["Fault", "Fehler"], inject: ["Inject", "Einspeisen"],
  driveValues: ["Values of drives and stations", "Werte von Antrieben und Stationen"], lanes: ["Lanes", "Spuren"],
  exchanges: ["Telegrams on the wire", "Telegramme auf der Leitung"], noExchange: ["nothing yet", "noch nichts"],
  against: ["Compare with (git revision, folder or spec; empty: none)", "Vergleichen mit (Git-Revision, Ordner oder Spec; leer: nichts)"],
  makeReview: ["Make review page", "Review-Seite erstellen"], keep: ["Download", "Herunterladen"],
  drop: ["Drop a file anywhere (SCL, XML, SD, AWL, DB, UDT), or paste a hex telegram, a STATUS, a code",
    "Eine Datei irgendwo ablegen (SCL, XML, SD, AWL, DB, UDT) oder ein Hex-Telegramm, einen STATUS, einen Code einfügen"],
  explain: ["Explain", "Erklären"], layout: ["Layout", "Layout"], convert: ["Convert", "Umwandeln"], compare: ["Compare", "Vergleichen"],
  toScl: ["to SCL", "nach SCL"], toXml: ["to SimaticML", "nach SimaticML"], pick: ["Choose files…", "Dateien wählen…"], clear: ["Clear", "Leeren"],
  old: ["old", "alt"],
  leave: ["There are changes that are not saved. Leave them?", "Es gibt nicht gespeicherte Änderungen. Verwerfen?"],
};

const asked = (() => {
  try {
    return localStorage.getItem("plcgen.language");
  } catch {
    return null;
  }
})();
export let language = asked ?? (navigator.language.startsWith("de") ? "de" : "en");

export function word(key) {
  const found = WORDS[key];
  return found === undefined ? key : found[language === "de" ? 1 : 0];
}

export function speak(next) {
  language = next;
  try {
    localStorage.setItem("plcgen.language", next);
  } catch { /* a browser without storage forgets it */ }
  label(document);
}

export function label(within) {
  document.documentElement.lang = language;
  for (const one of within.querySelectorAll("[data-word]")) one.textContent = word(one.dataset.word);
  for (const one of within.querySelectorAll("[data-title]")) one.title = word(one.dataset.title);
}
