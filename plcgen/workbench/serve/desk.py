"""The questions of the page and their answers: a method for each, with what it may be given; plain data comes back."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from plcgen import api
from plcgen._version import __version__
from plcgen.base.diagnostics import has_errors
from plcgen.base.display.data import diagnostics_data
from plcgen.base.files.files import below, refusal
from plcgen.project.below import specs_below
from plcgen.report.revision import revisions
from plcgen.report.trace.run import Simulation
from plcgen.workbench.serve import becomes, guarding, proving, spec, starting, tools
from plcgen.workbench.serve.becomes import Made, Maker
from plcgen.workbench.serve.page import has_editor
from plcgen.workbench.serve.proving import Typed
from plcgen.workbench.serve.room import MAX_LISTED, Room, digest, wrong
from plcgen.workbench.serve.running import MAX_SCANS, Live
from plcgen.workbench.serve.tools import MAX_DROPPED
from plcgen.workbench.serve.working import Worker
from plcgen.workbench.service.documents import Document
from plcgen.workbench.service.specs.form import put_in
from plcgen.workbench.service.workspace import Workspace

MAX_REVISIONS = 20


class Body(BaseModel):
    """What a request holds: known keys only."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class Nothing(Body):
    """No arguments."""


class File(Body):
    """A file of the folder."""

    name: str = Field(max_length=400)


class Text(File):
    """A file as the editor has it."""

    text: str = Field(max_length=4 * 1024 * 1024)


class At(Text):
    """A place in it: line and character from 0, in UTF-16 units; ``word`` is a new name there."""

    line: int = Field(ge=0)
    character: int = Field(ge=0)
    word: str = Field("", max_length=200)


class Save(Text):
    """``known`` is the hash of the file when it was read, "" for a new one."""

    known: str = Field(max_length=64)


class Write(Save):
    """``overwrite``: files in the way that somebody has agreed to lose, by name in the output, with what they held."""

    overwrite: dict[str, str] = Field({}, max_length=2000)


class Change(Text):
    """What the form adds or removes."""

    what: Literal["drive", "job", "parameter", "cycle", "recipe", "station", "remove"]
    given: dict[str, str] = Field(max_length=12)


class Partner(Text):
    """A drive by its key, or a station as ``line/station``."""

    partner: str = Field(max_length=400)


class Search(Text):
    """Words, for the drives of a job, or of all."""

    job: str = Field("", max_length=400)
    words: str = Field(max_length=200)


class Part(Text):
    """A generated file."""

    path: str = Field(max_length=400)


class New(File):
    """A spec to begin with."""

    given: dict[str, str] = Field(max_length=12)


class Load(Text):
    """A program to run: which files, and the length of a scan in ms."""

    origin: Literal["made", "disk"] = "made"
    scan_time: int = Field(10, ge=1, le=1000)


class Steps(Body):
    """So many scans."""

    scans: int = Field(ge=1, le=MAX_SCANS)


class Words(Body):
    """Something typed."""

    text: str = Field(max_length=200_000)


class Strike(Body):
    """A kind of fault with its keys, as they were typed."""

    kind: str = Field(max_length=40)
    keys: dict[str, str] = Field(max_length=12)


class Withdraw(Body):
    """A fault by its number."""

    number: int = Field(ge=0)


class Prove(Text):
    """What is verified, and how much."""

    origin: Literal["made", "disk"] = "made"
    faults: Literal["none", "quick", "full"] = "quick"


class Again(Text):
    """A check that failed, and one of its scenarios."""

    origin: Literal["made", "disk"] = "made"
    check: str = Field(max_length=400)
    scenario: str = Field("", max_length=400)


class Against(Text):
    """What is reviewed, and what it is compared with: a folder, a spec, or a git revision."""

    origin: Literal["made", "disk"] = "made"
    base: str = Field("", max_length=400)


class Files(Body):
    """Files dropped: names with their bytes in Base64."""

    files: dict[str, str] = Field(max_length=MAX_DROPPED)


class Pair(Files):
    """Old and new files."""

    old: dict[str, str] = Field(max_length=MAX_DROPPED)


class Audit(Text):
    """Files that are held against a spec."""

    files: dict[str, str] = Field(max_length=MAX_DROPPED)


class Lists(Text):
    """Text lists for a panel: languages and formats."""

    languages: list[str] = Field(max_length=20)
    formats: list[Literal["xlsx", "xml", "csv"]] = Field(max_length=3)


class Convert(Files):
    """Files, and what becomes of them."""

    to: Literal["scl", "xml"]
    version: str = Field("V19", max_length=10)
    classic: bool = False


class Desk:
    """What one page works on: the folder, its documents and what was made of them last.

    ``bench`` is a folder of the server's own for files that are run and verified without being written.
    """

    def __init__(self, room: Room, bench: Path) -> None:
        self.bench = bench
        self.room, self.workspace, self.maker = room, Workspace(room.folder), Maker()
        self.live, self.worker = Live(), Worker()
        self.pages: dict[int, str] = {}
        """Pages that reports have made, by number: the last ones."""
        self._lock = threading.RLock()

    # --- files -----------------------------------------------------------------------------------------------

    def folder(self, _: Nothing) -> dict[str, Any]:
        """The specs of the folder, and what forms offer."""
        found = specs_below(self.room.folder)
        names = [path.relative_to(self.room.folder).as_posix() for path in (*found.specs, *found.parts)]
        return {
            "folder": str(self.room.folder),
            "specs": names[:MAX_LISTED],
            "version": __version__,
            "editor": has_editor(),
            **starting.choices(),
        }

    def read(self, asked: File) -> dict[str, Any]:
        """The text of a spec."""
        text, path = self.room.read(asked.name), self.room.find(asked.name)
        with self._lock:
            for other in (one.path for one in self.workspace.documents if one.path != path):
                self.workspace.close(other)  # what was typed there and not saved is given up
        return {"name": asked.name, "text": text, "known": digest(path.read_bytes())}

    def save(self, asked: Save) -> dict[str, Any]:
        """Save a spec."""
        known = self.room.save(asked.name, asked.text, asked.known)
        self.workspace.changed()
        return {"known": known}

    def new(self, asked: New) -> dict[str, Any]:
        """The text of a new spec; nothing is written."""
        path = self.room.find(asked.name)
        if path.exists():
            raise wrong(asked.name, "the file exists", "choose another name")
        return {"name": asked.name, "text": starting.new_spec(path.name, asked.given, path.parent), "known": ""}

    # --- the text --------------------------------------------------------------------------------------------

    def _open(self, asked: Text) -> Document:
        return self.workspace.open(self.room.find(asked.name), asked.text)

    def check(self, asked: Text) -> dict[str, Any]:
        """Problems of the text, and what the form shows of it."""
        with self._lock:
            document = self._open(asked)
            found = spec.findings(self.room, document, self.workspace.diagnostics(document))
            return {"findings": found, **spec.outline(self.workspace.specs.state(document))}

    def complete(self, asked: At) -> dict[str, Any]:
        """What may stand at a place."""
        with self._lock:
            document = self._open(asked)
            found = self.workspace.complete(document, *spec.caret(document, asked.line, asked.character))
        return {
            "offers": [
                {
                    "label": one.label, "kind": one.kind, "detail": one.detail, "text": one.text,
                    "insert": one.edit.text, "place": spec.place(document.lines, one.edit.span),
                }
                for one in found
            ]
        }  # fmt: skip

    def hover(self, asked: At) -> dict[str, Any]:
        """What stands at a place."""
        with self._lock:
            document = self._open(asked)
            found = self.workspace.hover(document, *spec.caret(document, asked.line, asked.character))
        if found is None:
            return {"page": None}
        page = found.page
        sections = [{"heading": heading, "text": text} for heading, text in page.sections if text.strip()]
        return {
            "page": {"key": page.key, "title": page.title, "sections": sections},
            "place": spec.place(document.lines, found.span),
        }

    def rename(self, asked: At) -> dict[str, Any]:
        """Edits that give what stands at a place another name."""
        with self._lock:
            document = self._open(asked)
            where = spec.caret(document, asked.line, asked.character)
            return {"edits": spec.edits(document, self.workspace.rename(document, *where, asked.word))}

    def format(self, asked: Text) -> dict[str, Any]:
        """Edits that lay the text out evenly."""
        with self._lock:
            document = self._open(asked)
            return {"edits": spec.edits(document, self.workspace.format(document))}

    def search(self, asked: Search) -> dict[str, Any]:
        """Parameters by words."""
        with self._lock:
            return spec.search(self.workspace.specs.state(self._open(asked)), asked.job, asked.words)

    def kinds(self, asked: Partner) -> dict[str, Any]:
        """What a drive or a station can do, and why not the rest."""
        with self._lock:
            return {"kinds": spec.kinds(self.workspace.specs.state(self._open(asked)), asked.partner)}

    def change(self, asked: Change) -> dict[str, Any]:
        """Edits that put something into the text."""
        with self._lock:
            document = self._open(asked)
            found = put_in(self.workspace.specs.state(document), asked.what, asked.given)
            return {"edits": spec.edits(document, found)}

    # --- what it becomes -------------------------------------------------------------------------------------

    def made(self, asked: Text) -> Made:
        """The files of the text. Raises DiagnosticError with the errors of the text."""
        with self._lock:
            state = self.workspace.specs.state(self._open(asked))
            project = state.checked.project
            if project is None or has_errors(state.checked.diagnostics):
                raise wrong(asked.name, "the spec has errors: nothing is made of it", "correct them on the tab Spec")
        return self.maker.make(self.room.find(asked.name), asked.text, project)

    def becomes(self, asked: Text) -> dict[str, Any]:
        """Telegrams, write list and files."""
        made, path = self.made(asked), self.room.find(asked.name)
        folder = self.room.shown(api.default_folder(path).as_posix())
        return {
            **becomes.sheet(made),
            "folder": folder,
            "path": str(api.default_folder(path)),
            "spec": str(path),
            "files": becomes.listed(made, path),
        }

    def part(self, asked: Part) -> dict[str, Any]:
        """One generated file."""
        found = becomes.shown(self.made(asked), self.room.find(asked.name), asked.path)
        if found is None:
            raise wrong(asked.path, "there is no such file")
        return found

    def tags(self, asked: Text) -> dict[str, Any]:
        """What a panel needs."""
        return becomes.panel(self.made(asked))

    def write(self, asked: Write) -> dict[str, Any]:
        """Save the spec and generate its folder; a file of the user is overwritten only as ``overwrite`` has it."""
        known, path = self.save(asked), self.room.find(asked.name)
        done = api.generate(path)
        blocked = becomes.in_the_way(done)
        if blocked and all(asked.overwrite.get(one["path"]) == one["held"] for one in blocked):
            done, blocked = api.generate(path, force=True), []
        self.workspace.changed()
        return {
            **known,
            **diagnostics_data("generate", done.diagnostics),
            "problems": [spec.problem_data(one, self.room.shown) for one in done.diagnostics],
            "folder": self.room.shown(done.folder.as_posix()),
            "path": str(done.folder),
            "guide": proving.on_the_page(becomes.guide(done.folder)) if done.ok else "",
            "written": list(done.written),
            "unchanged": len(done.unchanged),
            "removed": list(done.removed),
            "in_the_way": blocked,
        }

    # --- run, verify, review ---------------------------------------------------------------------------------

    def _typed(self, asked: Text) -> Typed:
        return Typed(self.room.find(asked.name), asked.text)

    def _files(self, asked: Load | Prove | Again | Against) -> Path:
        return proving.folder_of(self.room.find(asked.name), asked.origin, lambda: self.made(asked), self.bench)

    def load(self, asked: Load) -> dict[str, Any]:
        """Load the program into the soft CPU."""
        typed = self._typed(asked)
        return self.live.load(Simulation(typed.path, self._files(asked), read=typed.read), asked.scan_time)

    def step(self, asked: Steps) -> dict[str, Any]:
        """Some scans."""
        return self.live.step(asked.scans)

    def put(self, asked: Words) -> dict[str, Any]:
        """Set a value."""
        return self.live.put(asked.text)

    def strike(self, asked: Strike) -> dict[str, Any]:
        """Let something go wrong."""
        return self.live.strike(asked.kind, asked.keys)

    def withdraw(self, asked: Withdraw) -> dict[str, Any]:
        """Let it go right again."""
        return self.live.withdraw(asked.number)

    def verify(self, asked: Prove) -> dict[str, Any]:
        """Begin to verify."""
        typed, folder = self._typed(asked), self._files(asked)
        return self.worker.start(lambda progress: proving.verified(typed, folder, asked.faults, progress))

    def review(self, asked: Against) -> dict[str, Any]:
        """Begin to make the page of a review."""
        typed, folder, base = self._typed(asked), self._files(asked), self._base(asked.base)
        return self.worker.start(lambda progress: self._kept(proving.reviewed(typed, folder, base, progress)))

    def _kept(self, found: dict[str, Any]) -> dict[str, Any]:
        """The page of a result gets an address of its own: its policy is another one."""
        number = max(self.pages, default=0) + 1
        self.pages = {**dict(list(self.pages.items())[-3:]), number: found["page"]}
        return {**found, "page": number if found["page"] else None}

    def _base(self, text: str) -> str:
        """A base of a review: files are those of the folder, everything else is a revision. Raises DiagnosticError."""
        path = self.room.folder / text
        if not text or not path.exists():
            return text
        if below(self.room.folder, text) is None:
            raise wrong(text, f'"{text}" {refusal(text, "the folder that is served")}')
        return str(path)

    def bases(self, asked: File) -> dict[str, Any]:
        """What a review may be compared with, each with what it is: folders, other specs, revisions."""
        path = self.room.find(asked.name)
        specs = specs_below(self.room.folder).specs
        folders = [*(one.parent for one in specs if one.name == path.name), *map(api.default_folder, specs)]
        found = [one for one in dict.fromkeys((*folders, *specs)) if one not in {path, path.parent} and one.exists()]
        names = [one.relative_to(self.room.folder).as_posix() for one in found]
        return {"bases": [*((name, "") for name in names[:MAX_LISTED]), *revisions(path.parent, MAX_REVISIONS)]}

    def state(self, _: Nothing) -> dict[str, Any]:
        """How far the work is."""
        return self.worker.state()

    def cancel(self, _: Nothing) -> dict[str, Any]:
        """End it."""
        return self.worker.cancel()

    def replay(self, asked: Again) -> dict[str, Any]:
        """The run of a check that failed."""
        found = proving.replayed(self._typed(asked), self._files(asked), asked.check, asked.scenario)
        if found is None:
            raise wrong(asked.check, "there is no such run", "verify again")
        return found

    # --- the lock, texts -------------------------------------------------------------------------------------

    def lock(self, asked: Text) -> dict[str, Any]:
        """How the text stands to the layout lock beside the spec."""
        return guarding.compared(self._typed(asked), self.room)

    def relock(self, asked: Save) -> dict[str, Any]:
        """Save the spec and write the lock of it."""
        known = self.save(asked)
        done = api.lock(self.room.find(asked.name), out=guarding.lock_of(self.room.find(asked.name)))
        problems = [spec.problem_data(one, self.room.shown) for one in done.diagnostics]
        return {**known, "ok": done.ok, "blocks": done.blocks, "changed": done.changed, "problems": problems}

    def texts(self, asked: Lists) -> dict[str, Any]:
        """Text lists for a panel, as an archive."""
        made = self.made(asked)
        return {"data": guarding.text_archive(made, asked.languages, asked.formats), "name": "HMITextLists.zip"}

    # --- tools -----------------------------------------------------------------------------------------------

    def look(self, asked: Files) -> dict[str, Any]:
        """What dropped files are, and the lines of those that hold telegrams or codes."""
        return tools.look(asked.files)

    def audit(self, asked: Audit) -> dict[str, Any]:
        """Hand-written blocks against the spec of the editor."""
        return tools.audit(self._typed(asked), asked.files)

    def explain(self, asked: Words) -> dict[str, Any]:
        """What a telegram, a STATUS, a code, a message or a parameter means."""
        return tools.explain(asked.text)

    def layout(self, asked: Files) -> dict[str, Any]:
        """The blocks of files byte by byte."""
        return self._kept(tools.layout(asked.files))

    def diff(self, asked: Pair) -> dict[str, Any]:
        """Two versions of files."""
        return tools.diff(asked.old, asked.files)

    def convert(self, asked: Convert) -> dict[str, Any]:
        """Files in the other form."""
        return tools.convert(asked.files, asked.to, asked.version, classic=asked.classic)
