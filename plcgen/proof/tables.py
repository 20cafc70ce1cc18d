"""Tables and lists around the blocks, against the plan and against each other: tags, symbols, orders, watch tables."""

from __future__ import annotations

import csv
import hashlib
import json
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.base.files.files import read_bounded
from plcgen.base.files.workbook import read_sheets
from plcgen.base.resources import templates_dir
from plcgen.project.nouns import Project
from plcgen.proof.checks import Check, file_check
from plcgen.proof.folder import Folder
from plcgen.proof.headers import MAIN
from plcgen.proof.making import attempted
from plcgen.proof.wording.languages import read_back
from plcgen.s7.layout.image import image
from plcgen.s7.layout.layout import Layout, layout_block, locate
from plcgen.s7.types.address import Address
from plcgen.s7.types.blocks import Block, BlockKind
from plcgen.s7.xml.reading.documents import read_tag_table, read_watch_table

MAX_BYTES = 16 * 1024 * 1024
MAX_TAGS = 1_000_000
SCRIPT = "8dc968e6d33cfaf219929d78162a488432ae4a02b44b04b73f566990a68ff520"
"""SHA-256 of the text of ``xml/import.ps1``: the same for every project, with ``{{ version }}`` for that of the
documents."""
_QUOTED = re.compile(r'"([^"\n]+)"')
_ITEM = re.compile(r"^\d+\. `+ ?(.+?) ?`+$", re.MULTILINE)
_PLACE = re.compile(r'"([^"]+)"(?:\.(.+))?')
_LITERAL = re.compile(r"(?:(?:[A-Z]+#)?16#([0-9A-F]+)|(?:[A-Z]+#)?(-?\d+(?:\.\d+)?))?")
_ADDRESS = re.compile(r"DB(\d+)\.DB[XBWDL](\d+)(?:\.\d)?")

Look = Callable[[], Iterator[str]]


class _WrongError(Exception):
    """A file cannot be looked at."""


@dataclass(frozen=True, slots=True)
class Flag:
    """A tag: name, type in capitals, address without percent sign."""

    name: str
    type: str
    address: str


def check_tables(project: Project, folder: Folder) -> Iterator[Check]:
    """One check over all of them."""
    problems: list[Diagnostic] = []
    looks = dict(_Tables(project, folder).looks())
    for name, look in looks.items():
        place = Span(str(folder.path / name))
        problems += attempted(partial(_looked, look, place), place)
    yield file_check("files.tables", "tables", f"{len(looks)} files", problems, "say what plan and blocks say")


def _looked(look: Look, place: Span) -> Iterator[Diagnostic]:
    try:
        yield from (Diagnostic("PG614", text, place) for text in look())
    except _WrongError as wrong:
        yield Diagnostic("PG614", str(wrong), place)


class _Tables:
    """The tables of one folder."""

    def __init__(self, project: Project, folder: Folder) -> None:
        self.project, self.folder = project, folder
        self.v5 = project.target.v5
        self.per_block = project.loaded.spec.plc.sources == "per_block"
        self.numbers = {ref.name: ref.number for ref in project.blocks}
        self.known = set(folder.text)
        self.layouts: dict[str, Layout] = {}
        self.images: dict[str, bytes] = {}

    def looks(self) -> Iterator[tuple[str, Look]]:
        """Every file that is looked at, and how."""
        flags = self.wanted()
        if self.v5:
            yield "symbols.sdf", self.symbols
            if self.per_block:
                yield "compile.inp", partial(self.order, "compile.inp")
        elif flags:
            yield "tags.csv", partial(self.tags, "tags.csv", self.csv_flags)
            yield "tags.xlsx", partial(self.tags, "tags.xlsx", self.xlsx_flags)
        if self.per_block:
            yield "IMPORT.md", partial(self.order, "IMPORT.md")
        for file in dict.fromkeys(self.folder.files.values()):
            yield file.relative_to(self.folder.path).as_posix(), partial(self.within, file)
        for path in sorted(self.folder.path.glob("watch/*.csv")):
            yield f"watch/{path.name}", partial(self.watch, path.stem)
        if self.project.target.xml_version is not None:
            for path in sorted(self.folder.path.glob("xml/*Tags.xml")):
                yield f"xml/{path.name}", partial(self.tags, f"xml/{path.name}", self.xml_flags)
        if self.project.target.t15 and self.project.target.xml_version is not None:
            yield "xml/import.json", self.imports
            yield "xml/import.ps1", self.script

    def data(self, name: str) -> bytes:
        """Bytes of a file of the folder."""
        try:
            return read_bounded(self.folder.path / name, MAX_BYTES)
        except OSError as problem:
            raise _WrongError(f"cannot be read: {problem.strerror or problem}") from problem

    def text(self, name: str) -> str:
        """Text of a file of the folder."""
        data = self.data(name)
        encoding = "cp1252" if self.v5 and name.endswith((".sdf", ".inp")) else "utf-8-sig"
        return data.decode(encoding, "replace").replace("\r\n", "\n")

    def layout(self, block: Block) -> Layout:
        """Layout of a block, made once however many rows name it."""
        if block.name not in self.layouts:
            self.layouts[block.name] = layout_block(block, self.folder.text)
        return self.layouts[block.name]

    def image(self, block: Block) -> bytes:
        """Bytes of a block as delivered, likewise."""
        if block.name not in self.images:
            self.images[block.name] = bytes(image(block, self.folder.text))
        return self.images[block.name]

    # ---- tags

    def wanted(self) -> dict[str, str]:
        """Type of every flag that the spec asks for, by its address."""
        return {
            address.text(percent=False): "BOOL" if address.width_bits == 1 else "WORD"
            for job in self.project.jobs
            for _, address in job.trigger.items()
            if isinstance(address, Address)
        }

    @cached_property
    def own(self) -> set[str]:
        """Places of the user's own program."""
        places = (place for job in self.project.jobs for _, place in job.trigger.items())
        return {place.text() for place in places if not isinstance(place, Address)}

    def csv_flags(self, name: str) -> list[Flag]:
        """Rows of ``tags.csv``."""
        rows = _rows(self.text(name))
        if not rows or rows[0] != ["Name", "Data Type", "Logical Address", "Comment"]:
            raise _WrongError("the header is not that of a tag table")
        return [Flag(row[0], row[1].upper(), row[2].removeprefix("%")) for row in rows[1:] if len(row) == 4]

    def xlsx_flags(self, name: str) -> list[Flag]:
        """Rows of ``tags.xlsx``; columns are found by their titles, as the TIA Portal does."""
        try:
            rows = [cells for _, cells in next(read_sheets(self.data(name), MAX_TAGS))]
            columns = [rows[0].index(title) for title in ("Name", "Data Type", "Logical Address")]
            cells = [[row[column] for column in columns] for row in rows[1:]]
        except (ValueError, IndexError) as problem:
            raise _WrongError(f"it is not a workbook of tags: {problem}") from problem
        return [Flag(name, type_.upper(), address.removeprefix("%")) for name, type_, address in cells]

    def xml_flags(self, name: str) -> list[Flag]:
        """Tags of a tag table document."""
        tables, _ = read_tag_table(self.folder.path / name)
        return [Flag(tag.name, tag.type.upper(), tag.address.removeprefix("%")) for one in tables for tag in one.tags]

    def tags(self, name: str, read: Callable[[str], list[Flag]]) -> Iterator[str]:
        """Exactly the flags of the spec, each under the name by which the caller knows it."""
        yield from self.flags(read(name))

    def flags(self, found: Sequence[Flag]) -> Iterator[str]:
        """Flags against those of the spec."""
        wanted = self.wanted()
        used = {name for block in self.folder.text.values() for name in _QUOTED.findall(block.code or "")}
        seen: dict[str, Flag] = {}
        for flag in found:
            if wanted.get(flag.address) != flag.type:
                said = wanted.get(flag.address, "no flag")
                yield f"{flag.name} is {flag.type} at {flag.address}, the spec has {said} there"
            if flag.address in seen:
                yield f"{flag.address} has two names: {seen[flag.address].name} and {flag.name}"
            if flag.name not in used:
                yield f"no block uses {flag.name}"
            seen[flag.address] = flag
        yield from (f"no tag has the address {address}" for address in wanted if address not in seen)
        for job in self.project.jobs:
            for signal, address in job.trigger.items():
                known = seen.get(address.text(percent=False)) if isinstance(address, Address) else None
                if known is not None and known.name.lower() != f"{self.project.prefix}{job.member}{signal}".lower():
                    yield f"{known.address} is {signal} of {job.key}, and called {known.name}"

    def symbols(self) -> Iterator[str]:
        """The symbol table of STEP 7 V5: every block with its number, every flag."""
        numbers = {ref.name: f"{ref.kind} {ref.number}" for ref in self.project.blocks}
        flags = []
        seen = set()
        for row in csv.reader(self.text("symbols.sdf").splitlines()):
            if len(row) != 4:
                yield f"a row has {len(row)} columns"
                continue
            name, address, type_, _ = (" ".join(cell.split()) for cell in row)  # columns are filled up
            if address.startswith("M"):
                flags.append(Flag(name, type_, address.replace(" ", "")))
            elif name in numbers:
                seen.add(name)
                if address != numbers[name]:
                    yield f"{name} is {address}, the plan has {numbers[name]}"
                block = self.folder.text.get(name.upper())
                of = (block.instance_of or "") if block is not None else ""
                if type_ != numbers.get(of, address) and of.upper() in self.folder.text:
                    yield f"{name} is made of {type_}, the source of {of}"
                if not of and type_ != address:
                    yield f"{name} has the type {type_}"
        yield from (f"{name} is missing" for name in numbers if name not in seen)
        yield from self.flags(flags)

    # ---- orders

    def order(self, name: str) -> Iterator[str]:
        """Every source once, and behind what it needs; the example of OB1 last, or not at all."""
        text = self.text(name)
        if name == "IMPORT.md":
            text = read_back(text, self.project.languages[0])
            listed = [item.rsplit("/", 1)[-1].rsplit(".", 1)[0] for item in _ITEM.findall(_section(text, "## Order"))]
        else:
            listed = text.split()
        wanted = {path.stem for path in self.folder.files.values()} - ({MAIN} if name == "compile.inp" else set())
        yield from _differences(listed, wanted)
        yield from self.behind(listed)

    def within(self, file: Path) -> Iterator[str]:
        """The blocks of a source: each behind what it needs of the others there."""
        names = [name for name, path in self.folder.files.items() if path == file]
        names.sort(key=lambda name: self.folder.place(name).line)
        yield from self.behind(names, frozenset(names))

    def behind(self, names: Iterable[str], among: frozenset[str] | None = None) -> Iterator[str]:
        """Blocks in front of something that they need; ``among`` are the blocks that matter, all without it."""
        seen: set[str] = set()
        for name in map(str.upper, names):
            block = self.folder.text.get(name)
            if block is None or name not in self.folder.files:
                continue
            seen.add(name)
            used = {found.upper() for found in _QUOTED.findall(self.folder.text_of(name))}
            if block.instance_of:
                used.add(block.instance_of.upper())
            for one in sorted((used & (self.known if among is None else among)) - seen):
                yield f"{block.name} comes before {self.folder.text[one].name}, which it needs"

    def imports(self) -> Iterator[str]:
        """The steps of the import script: every document once, in an order that compiles."""
        try:
            steps = json.loads(self.text("xml/import.json"))["steps"]
            listed = [(step["kind"], step["switch"], name) for step in steps for name in step["files"]]
        except (ValueError, KeyError, TypeError) as problem:
            raise _WrongError(f"is not a list of steps: {problem}") from problem
        found = {path.name for path in self.folder.path.glob("xml/*.xml")}
        yield from _differences([name for *_, name in listed], found)
        yield from self.behind(name.removesuffix(".xml") for *_, name in listed)
        for kind, switch, name in listed:
            block = self.folder.xml.get(name.removesuffix(".xml").upper())
            right = "type" if block is not None and block.kind is BlockKind.UDT else "block"
            if block is not None and kind != right:
                yield f"{name} is imported as {kind}"
            asked = MAIN if name == f"{MAIN}.xml" else "WatchTables" if name.startswith("Watch_") else ""
            if switch != asked:
                yield f"{name} is imported {f'with -{switch}' if switch else 'without being asked for'}"

    def script(self) -> Iterator[str]:
        """The text that all projects share, with the version of the documents in it."""
        shared = (templates_dir() / "text" / "import.ps1.j2").read_text("utf-8")
        made = shared.replace("{{ version }}", self.project.target.xml_version or "")
        if hashlib.sha256(shared.encode()).hexdigest() != SCRIPT or self.text("xml/import.ps1") != made:
            yield "is not the script of this version of plcgen"

    # ---- watch tables

    def watch(self, stem: str) -> Iterator[str]:
        """Rows of a watch table: places that exist, their addresses, and the document beside it."""
        rows = _rows(self.text(f"watch/{stem}.csv"))
        if not rows or rows[0] != ["name", "address", "display format", "modify value"]:
            raise _WrongError("the header is not that of a watch table")
        flags = self.wanted()
        for row in rows[1:]:
            if len(row) != 4:
                yield f"a row has {len(row)} columns"
                continue
            yield from self.place(row[0], row[1], row[3], flags)
        document = self.folder.path / "xml" / f"Watch_{stem}.xml"
        if self.project.target.xml_version is not None:
            tables, _ = read_watch_table(document) if document.is_file() else ([], [])
            names = [entry.name for table in tables for entry in table.entries]
            if names != [row[0] for row in rows[1:]]:
                yield "the document beside it has other rows"

    def place(self, name: str, address: str, modify: str, flags: dict[str, str]) -> Iterator[str]:
        """One row."""
        found = _PLACE.fullmatch(name)
        block = self.folder.text.get(found[1].upper()) if found else None
        if name in self.own:
            return  # in the user's own program
        if found is None:
            yield f"{name} is not a place"
        elif block is None:
            if address not in flags:
                yield f"{name} at {address} is neither in a block nor a flag of the spec"
            elif modify:
                yield f"{name} is set to {modify}"
        else:
            try:
                entry = locate(self.layout(block), found[2] or "")
            except KeyError:
                yield f"{name} does not exist"
                return
            said = _ADDRESS.fullmatch(address)
            number = self.numbers.get(block.name)
            if address and (said is None or (int(said[1]), int(said[2])) != (number, entry.byte)):
                yield f"{name} lies at DB{number}, byte {entry.byte}, not at {address}"
            start = self.image(block)[entry.byte : entry.byte + max(1, entry.size // 8)]
            if modify and not any(start) and not _nothing(modify):
                yield f"{name} is set to {modify}, which has no start value"


def _nothing(text: str) -> bool:
    """Whether a value is what a member without a start value has; what is no number is not judged."""
    found = _LITERAL.fullmatch(text)
    if found is None:
        return text != "TRUE"
    return not (int(found[1], 16) if found[1] else float(found[2] or 0))


def _rows(text: str) -> list[list[str]]:
    """Rows of a table, divided by what divides its header."""
    lines = text.splitlines()
    return list(csv.reader(lines, delimiter=";" if lines and ";" in lines[0] else ","))


def _section(text: str, heading: str) -> str:
    """What stands below a heading, up to the next one."""
    behind = text.partition(f"\n{heading}\n")[2]
    return behind.split("\n## ", 1)[0]


def _differences(listed: Sequence[str], wanted: set[str]) -> Iterator[str]:
    yield from (f"{name} is missing" for name in sorted(wanted - set(listed)))
    yield from (f"{name} does not exist" for name in sorted(set(listed) - wanted))
    yield from (f"{name} is listed twice" for name, count in sorted(Counter(listed).items()) if count > 1)
