// Labels of the page. Messages, titles and facts come from the server and are English.
const WORDS = {
  spec: ["Spec", "Spec"], newSpec: ["New…", "Neu…"], newTitle: ["New spec", "Neue Spec"], save: ["Save", "Speichern"], write: ["Write files…", "Dateien schreiben…"], writeNow: ["Write", "Schreiben"],
  zip: ["As ZIP", "Als ZIP"], theme: ["light / dark", "hell / dunkel"], close: ["close", "schließen"],
  gone: ["the server does not answer: is plcgen serve still running?", "der Server antwortet nicht: läuft plcgen serve noch?"],
  unsaved: ["not saved", "nicht gespeichert"], saved: ["saved", "gespeichert"], fresh: ["new, not saved", "neu, nicht gespeichert"],
  plainEditor: ["plain text field: this checkout has no editor bundle (make editor)",
    "einfaches Textfeld: dieser Checkout hat kein Editor-Paket (make editor)"],
  tabSpec: ["Spec", "Spec"], tabBecomes: ["What it becomes", "Was daraus wird"], tabRun: ["Run", "Lauf"],
  tabVerify: ["Verify", "Prüfen"], tabReview: ["Review", "Review"], tabTools: ["Tools", "Werkzeuge"],
  problems: ["Problems", "Probleme"], noProblems: ["No problems", "Keine Probleme"],
  rename: ["Rename", "Umbenennen"], remove: ["Remove", "Entfernen"],
  inEnglish: ["", "Meldungen und Titel auf Englisch, wie im Terminal"], undo: ["Undo", "Rückgängig"], redo: ["Redo", "Wiederherstellen"],
  why: ["Why", "Warum"], remedy: ["Remedy", "Abhilfe"],
  drives: ["Drives", "Antriebe"], jobs: ["Jobs", "Aufträge"], addDrive: ["Add drive", "Antrieb hinzufügen"],
  addJob: ["Add job", "Auftrag hinzufügen"], name: ["Name", "Name"], device: ["Device", "Gerät"],
  address: ["Address", "Adresse"], kind: ["Kind", "Art"], drive: ["Drive", "Antrieb"], station: ["Station", "Station"],
  hardwareId: ["Hardware identifier", "HW-Kennung"], logicalAddress: ["Logical address", "Logische Adresse"], driveObject: ["Drive object", "Antriebsobjekt"],
  ppiAddress: ["PPI address", "PPI-Adresse"], port: ["HW identifier of the port", "HW-Kennung des Ports"], line: ["Line (master)", "Strang (Master)"],
  addStation: ["Add station (S7-200)", "Station hinzufügen (S7-200)"], anyCpu: ["not said", "keine Angabe"], partner: ["For", "Für"], station_: ["Station name", "Stationsname"],
  whereAddress: ["see the hardware configuration; it can be corrected later", "siehe Hardwarekonfiguration; lässt sich später ändern"],
  whereStation: ["as set in the system block of the S7-200; 2 as delivered", "wie im Systemdatenbaustein der S7-200; ab Werk 2"],
  noCycle: ["it writes, or cannot be repeated: only jobs that read or compare have a cycle", "schreibt oder lässt sich nicht wiederholen: nur lesende und vergleichende Aufträge laufen zyklisch"],
  noPartner: ["Add a drive or a station first.", "Zuerst einen Antrieb oder eine Station hinzufügen."],
  start: ["Started", "Start"], onEdge: ["by an edge of execute", "durch Flanke an execute"], onCycle: ["again and again", "zyklisch"], onFlag: ["by a flag of your own", "durch eigenen Merker"],
  every: ["every", "alle"], flag: ["Flag", "Merker"], recipe: ["Recipe", "Rezeptur"],
  kind_read: ["Read", "Lesen"], kind_write: ["Write", "Schreiben"], kind_bits: ["Write single bits", "Einzelne Bits schreiben"], kind_readback: ["Write, read back", "Schreiben und zurücklesen"],
  kind_restore: ["Write, restore on error", "Schreiben, bei Fehler wiederherstellen"], kind_save: ["Save to ROM", "In ROM speichern"], kind_compare: ["Compare", "Vergleichen"],
  kind_sequence: ["Sequence of steps", "Schrittkette"], kind_messages: ["Faults and alarms", "Störungen und Warnungen"], kind_acknowledge: ["Acknowledge faults", "Störungen quittieren"],
  kind_activate: ["Activate, deactivate", "Aktivieren, deaktivieren"], kind_clock: ["Set the clock", "Uhr stellen"], kind_write_recipe: ["Recipe to the drive", "Rezeptur in den Antrieb"],
  kind_read_recipe: ["Drive to the recipe", "Antrieb in die Rezeptur"], kind_compare_recipe: ["Compare with a recipe", "Mit Rezeptur vergleichen"],
  kind_alarms: ["Alarms", "Warnungen"], kind_service: ["Any parameter", "Beliebiger Parameter"],
  is_read: ["values of the drive or the station", "Werte des Antriebs oder der Station"], is_write: ["constants, or inputs of the block", "Konstanten oder Eingänge des Bausteins"],
  is_bits: ["the word is read first; its other bits stay", "das Wort wird zuerst gelesen; seine anderen Bits bleiben"], is_readback: ["what is written is read again and compared", "Geschriebenes wird zurückgelesen und verglichen"],
  is_restore: ["the old value comes back if the job fails", "der alte Wert kommt zurück, wenn der Auftrag scheitert"], is_save: ["copies the values from RAM to ROM; not in a cycle", "kopiert die Werte vom RAM ins ROM; nicht zyklisch"],
  is_compare: ["lists the values that differ", "listet abweichende Werte auf"], is_sequence: ["several steps of reading, writing and waiting", "mehrere Schritte: lesen, schreiben, warten"],
  is_messages: ["the faults that are present, with value and time", "anstehende Störungen mit Wert und Zeit"], is_alarms: ["the alarms that are present", "anstehende Warnungen"],
  is_service: ["number, index, count and drive object are inputs of the block", "Nummer, Index, Anzahl und Antriebsobjekt sind Eingänge des Bausteins"], is_acknowledge: ["as by the button of the drive", "wie mit der Taste des Antriebs"],
  is_activate: ["takes the drive object out of operation, and back", "nimmt das Antriebsobjekt außer Betrieb und zurück"], is_clock: ["of the control unit, to the time of the CPU", "der Control Unit, nach der Zeit der CPU"],
  is_write_recipe: ["the record with the number at an input", "den Datensatz mit der Nummer am Eingang"], is_read_recipe: ["fills the record with the number at an input", "füllt den Datensatz mit der Nummer am Eingang"],
  is_compare_recipe: ["what the drive has, with one record", "Werte des Antriebs mit einem Datensatz"],
  beginWith: ["Jobs to begin with", "Aufträge zu Beginn"], start_actual_values: ["Read actual values", "Istwerte lesen"], start_ramps: ["Set ramps", "Rampen setzen"], start_faults: ["Read faults", "Störungen lesen"],
  kind_run: ["RUN", "RUN"], kind_stop: ["STOP", "STOP"],
  stations: ["Stations", "Stationen"], catalogue: ["Parameters", "Parameter"],
  searchHint: ["ramp, motor temperature, P1120, F30001", "Drehzahl, Motortemperatur, P1120, F30001"],
  addTo: ["Job", "Auftrag"], addIt: ["+ add", "+ hinzufügen"], readIt: ["+ read", "+ lesen"], writeIt: ["+ write", "+ schreiben"],
  nothingFound: ["nothing found", "nichts gefunden"], dangerous: ["needs a sign-off", "Freigabe nötig"], reasonAsked: ["Why is this intended? The reason is written into the spec.", "Warum ist das so gewollt? Der Grund steht dann in der Spec."], more: ["more: be more precise", "weitere: genauer suchen"],
  family: ["CPU family", "CPU-Familie"], toolchain: ["Toolchain", "Werkzeug"], create: ["Create", "Anlegen"], cancel: ["Cancel", "Abbrechen"],
  file: ["File", "Datei"], ppiMaster: ["S7-200 stations (PPI)", "S7-200-Stationen (PPI)"], format: ["Format", "Formatieren"],
  telegrams: ["Telegrams", "Telegramme"], panel: ["Panel", "Panel"], lock: ["Lock", "Sperrdatei"], folder: ["Folder", "Ordner"], files: ["Files", "Dateien"], workList: ["Work list", "Schreibliste"],
  request: ["Request", "Anfrage"], answer: ["Answer", "Antwort"], member: ["Member", "Element"], value: ["Value", "Wert"],
  meaning: ["Meaning", "Bedeutung"], bytes: ["Bytes", "Bytes"], offset: ["Offset", "Offset"], sclLines: ["Lines in the sources", "Zeilen in den Quellen"],
  hoverByte: ["Point at a byte or a row: the member, its address and its line are marked.",
    "Auf ein Byte oder eine Zeile zeigen: Element, Adresse und Quellzeile werden markiert."],
  new: ["new", "neu"], changed: ["changed", "geändert"], same: ["as on disk", "wie auf der Platte"], manifest: ["list of files", "Dateiliste"],
  all: ["all", "alle"], tagName: ["Name", "Name"], type: ["Type", "Typ"],
  panelHint: ["Connect a tag by its name: the data blocks have standard access, so that the address works as well, as long as the data block has this number (SimaticML files carry it; look it up after an import of the text source). execute starts a job with a rising edge.",
    "Variable über den Namen anbinden: Die Datenbausteine haben Standardzugriff, daher geht auch die Adresse, solange der Baustein diese Nummer hat (SimaticML-Dateien bringen sie mit; nach Import der Textquelle nachsehen). execute startet den Auftrag mit steigender Flanke."],
  textList: ["text list", "Textliste"], textLists: ["Text lists", "Textlisten"],
  textsHint: ["status, errors, faults and alarms of the drives; xlsx for the editor of text lists, xml for Openness",
    "Status, Fehler, Störungen und Warnungen der Antriebe; xlsx für den Textlisten-Editor, xml für Openness"],
  lockHint: ["A lock holds where every member of the blocks is. Written once and kept with the project, it shows what a later change of the spec moves for panels and other programs.",
    "Eine Sperrdatei hält fest, wo jedes Element der Bausteine liegt. Einmal geschrieben und beim Projekt abgelegt, zeigt sie, was eine spätere Änderung für Panels und andere Programme verschiebt."],
  noLock: ["There is no lock yet.", "Es gibt noch keine Sperrdatei."], lockSame: ["Nothing has moved.", "Nichts hat sich verschoben."], lockMoved: ["The spec makes other blocks than the lock has.", "Die Spec ergibt andere Bausteine als die Sperrdatei."],
  lockProblem: ["The lock cannot be compared.", "Die Sperrdatei lässt sich nicht vergleichen."],
  lockWrite: ["Save the spec and write the lock", "Spec speichern und Sperrdatei schreiben"], lockAgain: ["Save the spec and renew the lock", "Spec speichern und Sperrdatei erneuern"],
  lockAsk: ["Save the spec and write", "Spec speichern und schreiben:"],
  text: ["Text", "Text"], diff: ["Difference", "Unterschied"], writes: ["What is written", "Was geschrieben wird"],
  nothingWritten: ["Nothing is written: all jobs only read.", "Es wird nichts geschrieben: alle Aufträge lesen nur."],
  parameter: ["Parameter", "Parameter"], limits: ["Limits", "Grenzen"], trigger: ["Started by", "Start durch"], memory: ["Ends up in", "Landet in"],
  danger: ["Danger", "Gefahr"], signed: ["Signed off", "Freigegeben"], partners: ["Drives", "Antriebe"], input: ["input", "Eingang"],
  hasErrors: ["The spec has errors: nothing is made of it yet.", "Die Spec hat Fehler: noch wird nichts daraus."],
  writeAsk: ["Save the spec and write its files?", "Spec speichern und Dateien schreiben?"],
  writeAskSaved: ["Write the files of this spec?", "Dateien dieser Spec schreiben?"],
  blockedAsk: ["Nothing was written: overwrite these files?", "Nichts wurde geschrieben: Diese Dateien überschreiben?"],
  blockedRule: ["What somebody has changed in them is lost then. The spec is saved.", "Was jemand darin geändert hat, geht dann verloren. Die Spec ist gespeichert."],
  keepMine: ["Keep them", "Behalten"], overwrite: ["Overwrite them", "Überschreiben"],
  written: ["written", "geschrieben"], unchanged: ["unchanged", "unverändert"], removed: ["removed", "entfernt"],
  writeRule: ["Nothing that plcgen did not write, or that was changed since, is overwritten.",
    "Nichts, was plcgen nicht geschrieben hat oder was seither geändert wurde, wird überschrieben."],
  zipInstead: ["Download ZIP instead", "Stattdessen ZIP herunterladen"], copy: ["Copy path", "Pfad kopieren"], copied: ["copied", "kopiert"],
  begin: ["Start", "Start"], effort: ["Faults", "Fehlerfälle"], faultsNone: ["none", "keine"], faultsQuick: ["quick", "schnell"], faultsFull: ["all", "alle"], source: ["Files", "Dateien"],
  asMade: ["as the spec makes them now", "wie die Spec sie jetzt macht"], onDisk: ["as they lie on disk", "wie sie auf der Platte liegen"],
  running: ["running", "läuft"], check: ["Check", "Prüfung"], result: ["Result", "Ergebnis"], subject: ["Subject", "Gegenstand"],
  o_ok: ["ok", "in Ordnung"], o_error: ["failed", "fehlgeschlagen"], o_warning: ["with a warning", "mit Warnung"], o_not_run: ["not run", "nicht ausgeführt"],
  notRun: ["what was left out, and why", "was ausgelassen wurde, und warum"], notAsked: ["left out because of the choice of faults above", "ausgelassen wegen der Auswahl der Fehlerfälle oben"],
  verifyHint: ["Verification compiles the files, runs every job against simulated drives and stations and compares what they send with the spec. It reads the text of the editor; nothing is written.",
    "Die Prüfung übersetzt die Dateien, führt jeden Auftrag gegen simulierte Antriebe und Stationen aus und vergleicht, was gesendet wird, mit der Spec. Grundlage ist der Text im Editor; geschrieben wird nichts."],
  reviewHint: ["One page with everything that a reviewer must see, to be signed. With a git revision, folder or spec in the field above it says what has changed.",
    "Eine Seite mit allem, was ein Prüfer sehen muss, zum Unterschreiben. Mit Git-Revision, Ordner oder Spec im Feld oben sagt sie, was sich geändert hat."],
  madeOnly: ["Verified: the files as the spec makes them now. What lies on disk was not looked at; choose it above.", "Geprüft: die Dateien, wie die Spec sie jetzt macht. Was auf der Platte liegt, wurde nicht angesehen; oben wählbar."],
  diskOnly: ["Verified: the files as they lie on disk.", "Geprüft: die Dateien, wie sie auf der Platte liegen."],
  openLine: ["Open line", "Zeile öffnen"], notAgain: ["alone, on a CPU of its own, it does not fail", "allein, auf einer eigenen CPU, schlägt es nicht fehl"],
  not_started: ["not started", "nicht gestartet"], done: ["done", "fertig"], error: ["error", "Fehler"],
  openRun: ["Open run", "Lauf öffnen"], cancelled: ["cancelled", "abgebrochen"], ledger: ["What the result rests on", "Worauf das Ergebnis beruht"],
  load: ["Load program", "Programm laden"], run: ["Run", "Starten"], pause: ["Pause", "Pause"], step: ["Step", "Schritt"], restart: ["Restart", "Neustart"],
  scan: ["scan", "Zyklus"], set: ["Set", "Setzen"], fault: ["Fault", "Fehler"], inject: ["Inject", "Einspeisen"],
  driveValues: ["Values of drives and stations", "Werte von Antrieben und Stationen"], lanes: ["Lanes", "Spuren"],
  exchanges: ["Telegrams on the wire", "Telegramme auf der Leitung"], noExchange: ["nothing yet", "noch nichts"],
  loadFirst: ["Load the program: then each job has a button that sets execute, its inputs, and the values of its drive; faults are chosen from a list.",
    "Programm laden: Dann hat jeder Auftrag einen Knopf für execute, seine Eingänge und die Werte seines Antriebs; Fehler werden aus einer Liste gewählt."],
  goesWrong: ["Let something go wrong", "Fehler einspeisen"], left: ["times left:", "noch so oft:"], withdraw: ["Remove this fault", "Diesen Fehler aufheben"], setHint: ["any member, tag or address: NAME=VALUE", "beliebiges Element, Variable oder Adresse: NAME=WERT"],
  against: ["Compare with (git revision, folder or spec; empty: none)", "Vergleichen mit (Git-Revision, Ordner oder Spec; leer: nichts)"],
  makeReview: ["Make review page", "Review-Seite erstellen"], keep: ["Download", "Herunterladen"],
  drop: ["Drop a file anywhere (SCL, XML, SD, AWL, DB, UDT, specs, hex telegrams), or drop or paste a telegram, a STATUS, a code: blocks are laid out, telegrams explained.",
    "Datei irgendwo ablegen (SCL, XML, SD, AWL, DB, UDT, Specs, Hex-Telegramme) oder Telegramm, STATUS, Code ablegen oder einfügen: Bausteine werden aufgeschlüsselt, Telegramme erklärt."],
  explain: ["Explain", "Erklären"], layout: ["Layout", "Layout"], convert: ["Convert", "Umwandeln"], compare: ["Compare", "Vergleichen"],
  audit: ["Audit with the spec", "Mit der Spec prüfen"], tooLarge: ["larger than 12 MiB", "größer als 12 MiB"],
  auditHint: ["hand-written request and response blocks, and the calls that send them, against the spec that is open", "handgeschriebene Anfrage- und Antwortbausteine und ihre Aufrufe gegen die offene Spec"],
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

// A word of the server with a label of the page, if it has one.
export function named(group, key, otherwise = key.replace(/_/g, " ")) {
  return WORDS[`${group}_${key}`] === undefined ? otherwise : word(`${group}_${key}`);
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
