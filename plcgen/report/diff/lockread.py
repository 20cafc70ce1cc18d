"""A lock file back to a state. The file may come from anybody: bounded, every wrong value a diagnostic at its place.

Every value is read as the text that ``lockfile`` wrote; only numbers become numbers.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, PlainValidator, WithJsonSchema, model_validator

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Report
from plcgen.base.files.printed import MAX_STORED, Stored, printed
from plcgen.base.files.text import read_text
from plcgen.base.files.validation import FileShape, Problems, StrictModel, problem, read_document
from plcgen.base.files.yaml import YamlNode
from plcgen.project.registry import protocols
from plcgen.s7.compare.lockfile import ACCESS, FORMAT, content_hash
from plcgen.s7.compare.model import BlockState, DriveState, JobState, MemberState, Snapshot, TelegramState, path_name

_VALUE = re.compile(
    r"(?:(?P<byte>[0-9]{1,8})\.(?P<bit>[0-7]) (?P<size>[0-9]{1,9}) (?P<unit>B|bit) )?"
    r'(?P<type>(?:"[^"\n]*"|[^"\n])+?)(?: := (?P<start>.*?))?(?: \{(?P<braces>[^{}]*)\})?\Z'
)
_HIDDEN = re.compile("%([0-9A-F]{2})")
_SECTIONS = {"members": "Static", "input": "Input", "output": "Output", "inout": "InOut", "static": "Static"}
_SECTIONS |= {"return": "Return"}
_KINDS = ("DB", "FB", "FC", "OB", "UDT")
_HEX = re.compile(r"[0-9A-Fa-f]{2}(?: [0-9A-Fa-f]{2}){0,254}\Z")
_OPTIMIZED = {text: value for value, text in ACCESS.items()}
_DEEPEST = 64
_SHAPE = frozenset({"PG104", "PG105", "PG106", "PG107"})
"""What is wrong with the shape of any file: of a lock, all of it is one code."""
_CODE, _HELP = "PG633", "write the lock again: plcgen lock"


@dataclass(frozen=True, slots=True)
class Lock:
    """A lock file: its state, and the sources it names, relative to its folder."""

    path: Path
    snapshot: Snapshot
    sources: tuple[str, ...]


class _Line(NamedTuple):
    """What a lock says about one member."""

    offset: int | None
    bits: int | None
    type: str
    start: str
    attributes: tuple[tuple[str, str], ...]


def _line(text: object) -> _Line:
    match = _VALUE.match(printed(text)) if isinstance(text, str) and len(text) <= MAX_STORED else None
    if match is None:
        raise problem("this is not a member: offset, size, type, start value")
    offset = bits = None
    if match["byte"] is not None:
        offset = 8 * int(match["byte"]) + int(match["bit"])
        bits = int(match["size"]) * (8 if match["unit"] == "B" else 1)
    parts = (part.partition("=") for part in (match["braces"] or "").split(", "))
    return _Line(
        offset,
        bits,
        match["type"],
        match["start"] or "",
        tuple((name, _HIDDEN.sub(_shown, value)) for name, _, value in parts if name),
    )


def _shown(match: re.Match[str]) -> str:
    """A mark that stands as its code in a lock."""
    return chr(int(match[1], 16))


def _key(text: str) -> None:
    if len(printed(text)) > MAX_STORED:
        raise problem(f"a name has at most {MAX_STORED} characters")


def _number(text: object) -> object:
    if isinstance(text, str) and re.fullmatch(r"[0-9]{1,10}", text):
        return int(text)
    raise problem(f'"{text}" is not a number' if isinstance(text, str) else "a number is needed")


def _request(text: str) -> str:
    if not _HEX.match(text):
        raise problem("a request is 1 to 255 bytes in hexadecimal")
    return text


def _protocol(key: str) -> str:
    known = [protocol.key for protocol in protocols()]
    if key not in known:
        raise problem(f'"{key[:40]}" is not a protocol: {", ".join(known)}')
    return key


def _block_key(key: str) -> str:
    kind, _, name = key.partition(" ")
    if kind not in _KINDS or not name:
        raise problem(f'"{key[:60]}" is not a block: kind ({", ".join(_KINDS)}) and name')
    return key


_MEMBER = {"type": "string", "maxLength": MAX_STORED, "description": "offset, size, type, start value"}
Number = Annotated[int, BeforeValidator(_number), Field(le=0xFFFF_FFFF)]
Texts = dict[Stored, Stored]
Members = Annotated[
    dict[Stored, Annotated[_Line, PlainValidator(_line), WithJsonSchema(_MEMBER)]], Field(default_factory=dict)
]


class _Drive(StrictModel):
    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, Stored]

    what: Stored
    address: Number

    @model_validator(mode="before")
    @classmethod
    def _name_settings(cls, given: Any) -> Any:
        """Their names are texts, too, which pydantic does not look at."""
        problems = Problems()
        for name in given if isinstance(given, dict) else ():
            with problems.at(name):
                _key(name)
        problems.raise_any()
        return given


class _Telegram(StrictModel):
    request: Annotated[str, AfterValidator(_request)]
    positive: Number
    negative: Number
    buffer: Number
    protocol: Annotated[str, AfterValidator(_protocol)] = "ds47"

    def state(self) -> TelegramState:
        return TelegramState(bytes.fromhex(self.request), self.positive, self.negative, self.buffer, self.protocol)


class _Job(StrictModel):
    drive: Stored
    timing: Texts = Field(default_factory=dict)
    trigger: Texts = Field(default_factory=dict)
    telegrams: tuple[_Telegram, ...] = ()


class _Block(StrictModel):
    hash: Stored = ""
    number: Annotated[Number, Field(le=0xFFFF)] | None = None
    bytes: Number | None = None
    access: Literal["optimized", "standard", "unspecified"]
    of: Stored = ""
    retain: Literal["false"] | None = None
    code: Stored = ""
    attributes: Texts = Field(default_factory=dict)
    members: Members
    input: Members
    output: Members
    inout: Members
    static: Members
    return_: Members = Field(alias="return")
    start_values: Texts = Field(default_factory=dict)

    def section(self, name: str) -> Mapping[str, _Line]:
        lines: Mapping[str, _Line] = getattr(self, "return_" if name == "return" else name)
        return lines


class _Lock(StrictModel):
    format: Stored
    sources: tuple[Stored, ...] = ()
    drives: dict[Stored, _Drive] = Field(default_factory=dict)
    jobs: dict[Stored, _Job] | None = None
    blocks: dict[Annotated[Stored, AfterValidator(_block_key)], _Block]


def _as_text(root: YamlNode) -> YamlNode:
    """Check the format, and make the text of every scalar its value: 16#0A is a word here, not the number 10."""
    form = root.get("format") if root.kind == "map" else None
    if form is None or form.raw != str(FORMAT):
        shown = "none" if form is None else form.raw
        message = f"this is not a layout lock of format {FORMAT} (format: {shown})"
        raise DiagnosticError([Diagnostic(_CODE, message, (form or root).span, help=_HELP)])
    for node in root.walk():
        if node.kind == "scalar":
            node.value = node.raw
    return root


_LOCK = FileShape(_Lock, "the lock", "a lock is a mapping", prepare=_as_text)


def lock_schema() -> dict[str, Any]:
    """JSON schema of a lock for programs that read its YAML: every text may be a scalar of another type there."""
    found = _scalars(_Lock.model_json_schema(by_alias=True))
    found["properties"]["format"] = {"const": FORMAT}
    found["properties"]["blocks"]["propertyNames"] = {"pattern": f"^({'|'.join(_KINDS)}) ."}
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": f"urn:plcgen:lock:{FORMAT}"}
    text = "Layouts, telegrams and interfaces as they were released; plcgen lock writes it."
    return {**head, **found, "title": "plcgen lock", "description": text}


def _scalars(schema: Any) -> Any:
    """Texts as YAML reads them, and without titles that repeat their keys."""
    if isinstance(schema, list):
        return [_scalars(each) for each in schema]
    if not isinstance(schema, dict):
        return schema
    found = {key: _scalars(value) for key, value in schema.items() if key != "title" or not isinstance(value, str)}
    if found.get("type") == "string":
        found["type"] = ["string", "number", "boolean", "null"]
    return {"enum": ["false", False]} if found.get("const") == "false" else found


def read_lock(path: Path) -> Lock:
    """Read a lock file.

    Raises:
        DiagnosticError: PG110, PG102, PG101.. if it is no readable YAML, PG633 for every value that is no part
            of a lock, PG634 for a block whose hash is not that of its lines.
    """
    file = path.as_posix()
    found = Report()
    loaded = read_document(read_text(path), file, _LOCK, found)
    report = Report([replace(d, code=_CODE, help=_HELP) if d.code in _SHAPE else d for d in found])
    report.raise_on_errors()
    assert loaded is not None  # noqa: S101 - raise_on_errors leaves only this case
    snapshot = _Reader(loaded.root, report).snapshot(file, loaded.model)
    report.raise_on_errors()
    return Lock(path, snapshot, loaded.model.sources)


@dataclass(frozen=True, slots=True)
class _Reader:
    """Puts the parts of a valid lock together, each with its place."""

    tree: YamlNode
    report: Report

    def snapshot(self, file: str, lock: _Lock) -> Snapshot:
        snapshot = Snapshot(file, complete=False)
        if lock.jobs is not None:
            snapshot.jobs = {key: self.job(key, job) for key, job in lock.jobs.items()}
            snapshot.drives = {key: self.drive(key, drive) for key, drive in lock.drives.items()}
        snapshot.blocks = [self.block(key, block) for key, block in lock.blocks.items()]
        return snapshot

    def drive(self, key: str, drive: _Drive) -> DriveState:
        settings = tuple((drive.model_extra or {}).items())
        return DriveState(key, drive.what, drive.address, settings, self.tree.find(("drives", key)).span)

    def job(self, key: str, job: _Job) -> JobState:
        telegrams = tuple(telegram.state() for telegram in job.telegrams)
        timing, trigger = tuple(job.timing.items()), tuple(job.trigger.items())
        return JobState(key, job.drive, telegrams, timing, trigger, self.tree.find(("jobs", key)).span)

    def block(self, key: str, given: _Block) -> BlockState:
        kind, _, name = key.partition(" ")
        node = self.tree.find(("blocks", key))
        members = [member for section in _SECTIONS for member in self.members(node, given, section, kind)]
        block = BlockState(
            kind, name, given.number, given.bytes, _OPTIMIZED[given.access], given.of, "", given.retain is not None,
            attributes=tuple(given.attributes.items()), members=tuple(members),
            assignments=tuple(given.start_values.items()), code_hash=given.code.removeprefix("sha256:"), span=node.span,
        )  # fmt: skip
        if given.hash != content_hash(block):
            message = f"{key}: the lines do not match the hash {given.hash[:40] or '(none)'}"
            help_ = "the lock was edited or merged by hand: write it again with plcgen lock"
            self.report.add(Diagnostic("PG634", message, node.find(["hash"]).span, help=help_))
        return block

    def members(self, block: YamlNode, given: _Block, section: str, kind: str) -> Iterator[MemberState]:
        """Members of one section; nested ones follow their parent and begin with its path."""
        roots: list[_Tree] = []
        stack: list[_Tree] = []
        node = block.get(section)
        for path, line in given.section(section).items():
            while stack and not path.startswith((f"{stack[-1].path}.", f"{stack[-1].path}[]")):
                stack.pop()
            tree = _Tree(path, line, node.find([path]) if node else block)
            (stack[-1].inner if stack else roots).append(tree)
            if len(stack) >= _DEEPEST:
                message = f"{path[:60]}: nested too deeply"
                self.report.add(Diagnostic(_CODE, message, tree.node.span, help=_HELP))
                return
            stack.append(tree)
        for tree in roots:
            yield tree.state("" if section == "members" and kind in {"FC", "OB"} else _SECTIONS[section])


@dataclass(slots=True)
class _Tree:
    """A member while its nested ones are still being collected."""

    path: str
    line: _Line
    node: YamlNode
    inner: list[_Tree] = field(default_factory=list)

    def state(self, section: str) -> MemberState:
        """The frozen member with everything below it; only the first level has a section."""
        inner = tuple(tree.state("") for tree in self.inner)
        offset, bits, type_, start, attributes = self.line
        name = path_name(self.path)
        return MemberState(
            name, self.path, type_, section, offset, bits, start, "", attributes, inner, span=self.node.span
        )
