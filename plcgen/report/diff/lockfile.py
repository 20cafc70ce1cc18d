"""A lock: a state as JSON, one member a line, sorted, without dates, made to be reviewed in a pull request.

The file may come from anybody: bounded, every wrong value a diagnostic at its place.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, ValidationError, WithJsonSchema

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Report, Span
from plcgen.base.files.printed import MAX_STORED, Stored, unprintable
from plcgen.base.files.text import read_text
from plcgen.base.files.validation import FileShape, Loaded, StrictModel, problem, read_document
from plcgen.base.files.yaml import YamlNode
from plcgen.project.registry import protocols
from plcgen.s7.compare.members import offset_text
from plcgen.s7.compare.model import (
    TAG_TABLE,
    BlockState,
    DriveState,
    JobItem,
    JobState,
    MemberState,
    Snapshot,
    TelegramState,
    path_name,
)
from plcgen.s7.read.code import Code

FORMAT = 2
ABOUT = "Layout lock of plcgen. A change of this file is a change of memory: review it. plcgen lock writes it."
ACCESS: Mapping[bool | None, str] = {True: "optimized", False: "standard", None: "unspecified"}
_OPTIMIZED = {text: value for value, text in ACCESS.items()}
_HEX = r"[0-9A-Fa-f]{2}(?: [0-9A-Fa-f]{2}){0,254}"
_OFFSET = r"[0-9]{1,8}\.[0-7]"
_ENTRY = re.compile(r' *\{"(kind|path|key)": ')
_DEEPEST = 64
_SHAPE = frozenset({"PG104", "PG105", "PG106", "PG107"})
"""What is wrong with the shape of any file: of a lock, all of it is one code."""
_CODE, _HELP = "PG633", "write the lock again: plcgen lock"
_NO_MEMORY = frozenset({"FC", "OB", TAG_TABLE})


def reduced(snapshot: Snapshot) -> Snapshot:
    """Return what a lock keeps of a state: no comments, no code but its hash, no members of other types."""
    if not snapshot.complete:
        return snapshot  # that of a lock: a hash of its hashes would be another one
    blocks = [_reduced(block) for block in snapshot.blocks]
    return Snapshot(snapshot.label, blocks, snapshot.jobs, snapshot.drives, snapshot.diagnostics, complete=False)


def _reduced(block: BlockState) -> BlockState:
    code = ""
    if block.code_hash or block.locals:
        lines = [block.code_hash, *(f"{m.section} {m.name.upper()} {m.type.upper()} {m.start}" for m in block.locals)]
        code = _digest("\n".join(lines))
    return replace(
        block, instance_kind="", texts=(), members=tuple(_own(block.members, block.kind)), locals=(),
        assignments=tuple(sorted(block.assignments)), code=Code(), code_hash=code,
    )  # fmt: skip


def _own(members: Iterable[MemberState], kind: str, level: int = 0) -> Iterator[MemberState]:
    for m in members:
        if not m.foreign:
            # An instance DB whose function block has no known layout brings its sections: a lock has none for data.
            section = "" if level else ("Static" if kind in {"DB", "UDT"} else m.section)
            yield replace(m, section=section, comment="", inner=tuple(_own(m.inner, kind, level + 1)))


def lock_text(snapshot: Snapshot, sources: Sequence[str]) -> str:
    """Text of the lock of a reduced state; ``sources`` are the paths it was made from, relative to the lock."""
    parts = [f'"format": {FORMAT}', f'"about": {_json(ABOUT)}', f'"sources": {_json(sources)}']
    if snapshot.jobs is not None:
        parts.append(_list("drives", [_json(_drive(drive)) for _, drive in sorted(snapshot.drives.items())]))
        parts.append(_list("jobs", [_json(_job(job)) for _, job in sorted(snapshot.jobs.items())]))
    parts.append(_list("blocks", [_block_text(block, content_hash(block)) for block in snapshot.blocks]))
    return "{\n" + ",\n".join(parts) + "\n}\n"


def _list(key: str, entries: Sequence[str]) -> str:
    return f'"{key}": [' + "".join(f"\n{entry}," for entry in entries).rstrip(",") + "\n]"


def _json(value: object) -> str:
    return json.dumps(value, ensure_ascii=False)


def _filled(**values: object) -> dict[str, object]:
    """What is not empty."""
    return {key: value for key, value in values.items() if value not in (None, "", (), {})}


def _block_text(block: BlockState, digest: str) -> str:
    head = _filled(
        kind=block.kind, name=block.name, number=block.number, hash=digest, bytes=block.size,
        access=ACCESS[block.optimized], of=block.instance_of, code=block.code_hash, attributes=dict(block.attributes),
    )  # fmt: skip
    head |= {"retain": False} if block.non_retain else {}
    head |= _filled(start_values=dict(block.assignments))
    members = [_json(row) for member in block.members for row in _rows(member)]
    if not members:
        return _json(head)
    return _json(head)[:-1] + ', "members": [\n  ' + ",\n  ".join(members) + "]}"


def _rows(member: MemberState) -> Iterator[dict[str, object]]:
    """A member and those in it, in the order of memory."""
    placed = member.offset is not None and member.bits is not None
    yield {"path": member.path, "type": member.type} | _filled(
        section="" if member.section == "Static" else member.section,
        offset=offset_text(member.offset or 0) if placed else "", bits=member.bits if placed else None,
        start=member.start, attributes={name.upper(): value for name, value in member.attributes},
    )  # fmt: skip
    for inner in member.inner:
        yield from _rows(inner)


def _drive(drive: DriveState) -> dict[str, object]:
    return {"key": drive.key, "what": drive.what, "address": drive.address, "settings": dict(drive.settings)}


def _job(job: JobState) -> dict[str, object]:
    telegrams = [
        {"request": one.request.hex(" ").upper(), "positive": one.positive, "negative": one.negative,
         "buffer": one.buffer, "protocol": one.protocol}
        for one in job.telegrams
    ]  # fmt: skip
    return {
        "key": job.key, "drive": job.drive, "group": job.group, "block": job.block,
        "place": dict(zip(("data", "member"), job.place, strict=True)),
        "items": [item._asdict() for item in job.items],
        "timing": dict(job.timing), "trigger": dict(job.trigger), "telegrams": telegrams,
    }  # fmt: skip


def content_hash(block: BlockState) -> str:
    """``sha256:`` and 16 hexadecimal digits over everything the lock says about a block."""
    return f"sha256:{_digest(_block_text(block, ''))}"


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def unkept(snapshot: Snapshot) -> Iterator[tuple[str, Span | None]]:
    """What a lock could not be read again with, each with the place of its block: texts too long, or of no line."""
    for block in snapshot.blocks:
        title = f"{block.kind} {block.name}"[:60]
        for text in _texts(json.loads(_block_text(block, ""))):
            odd = unprintable(text)
            if odd:
                yield f"the character U+{ord(odd):04X} in {title}", block.span
            elif len(text) > MAX_STORED:
                yield f'a text of {len(text)} characters in {title}: "{text[:40]}.."', block.span


def _texts(value: object) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict | list):
        for part in [*value, *value.values()] if isinstance(value, dict) else value:
            yield from _texts(part)


# --- reading -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Lock:
    """A lock file: its state, and the sources it names, relative to its folder."""

    path: Path
    snapshot: Snapshot
    sources: tuple[str, ...]


def _offset(text: object) -> object:
    if not isinstance(text, str) or not re.fullmatch(_OFFSET, text):
        raise problem("an offset is a byte and a bit: 2.0")
    byte, _, bit = text.partition(".")
    return 8 * int(byte) + int(bit)


def _request(text: str) -> str:
    if not re.fullmatch(_HEX, text):
        raise problem("a request is 1 to 255 bytes in hexadecimal")
    return text


def _protocol(key: str) -> str:
    known = [protocol.key for protocol in protocols()]
    if key not in known:
        raise problem(f'"{key[:40]}" is not a protocol: {", ".join(known)}')
    return key


Number = Annotated[int, Field(ge=0, le=0xFFFF_FFFF)]
Texts = dict[Stored, Stored]
_None: dict[str, str] = {}


class _Drive(StrictModel):
    key: Stored
    what: Stored
    address: Number
    settings: Texts = _None


class _Telegram(StrictModel):
    request: Annotated[str, AfterValidator(_request), WithJsonSchema({"type": "string", "pattern": f"^{_HEX}$"})]
    positive: Number
    negative: Number
    buffer: Number
    protocol: Annotated[str, AfterValidator(_protocol)]


class _Place(StrictModel):
    data: Stored = ""
    member: Stored = ""


class _Item(StrictModel):
    label: Stored
    does: Stored
    value: Stored = ""


class _Job(StrictModel):
    key: Stored
    drive: Stored
    group: Stored = ""
    block: Stored = ""
    place: _Place = _Place()
    items: tuple[_Item, ...] = ()
    timing: Texts = _None
    trigger: Texts = _None
    telegrams: tuple[_Telegram, ...] = ()


class _Member(StrictModel):
    path: Stored
    type: Stored
    section: Literal["Input", "Output", "InOut", "Static", "Return"] | None = None
    offset: (
        Annotated[int, BeforeValidator(_offset), WithJsonSchema({"type": "string", "pattern": f"^{_OFFSET}$"})] | None
    ) = None
    bits: Number | None = None
    start: Stored = ""
    attributes: Texts = _None


class _Block(StrictModel):
    kind: Literal["DB", "FB", "FC", "OB", "UDT", "tag table"]
    name: Annotated[Stored, Field(min_length=1)]
    number: Annotated[int, Field(ge=0, le=0xFFFF)] | None = None
    hash: Stored
    bytes: Number | None = None
    access: Literal["optimized", "standard", "unspecified"]
    of: Stored = ""
    code: Stored = ""
    attributes: Texts = _None
    retain: Literal[False] | None = None
    start_values: Texts = _None
    members: tuple[_Member, ...] = ()


class LockKeys(StrictModel):
    """The file as a whole."""

    format: Literal[2]
    about: Stored = ""
    sources: tuple[Stored, ...] = ()
    drives: tuple[_Drive, ...] = ()
    jobs: tuple[_Job, ...] | None = None
    blocks: tuple[_Block, ...]


def _of_this_format(root: YamlNode) -> YamlNode:
    form = root.get("format") if root.kind == "map" else None
    if form is None or form.raw != str(FORMAT):
        shown = "none" if form is None else form.raw
        message = f"this is not a layout lock of format {FORMAT} (format: {shown})"
        help_ = _HELP
        if shown == "1":
            help_ = "a lock of an earlier version: write a new one, plcgen lock FOLDER, and remove this file"
        raise DiagnosticError([Diagnostic(_CODE, message, (form or root).span, help=help_)])
    return root


LOCK = FileShape(LockKeys, "the lock", "a lock is a mapping", prepare=_of_this_format)


def read_lock(path: Path) -> Lock:
    """Read a lock file.

    Raises:
        DiagnosticError: PG110, PG102, PG101.. if it cannot be read, PG633 for every value that is no part
            of a lock, PG634 for a block whose hash is not that of its lines.
    """
    file, text = path.as_posix(), read_text(path)
    try:
        keys = LockKeys.model_validate_json(text)
    except ValidationError:
        keys = _slowly(text, file).model
    reader = _Reader(_places(text, file, keys))
    snapshot = reader.snapshot(keys, file)
    reader.report.raise_on_errors()
    return Lock(path, snapshot, keys.sources)


def _slowly(text: str, file: str) -> Loaded[LockKeys]:
    """The same with the place of every value: JSON is YAML."""
    found = Report()
    loaded = read_document(text, file, LOCK, found)
    Report([replace(d, code=_CODE, help=_HELP) if d.code in _SHAPE else d for d in found]).raise_on_errors()
    assert loaded is not None  # raise_on_errors leaves only this case
    return loaded


def _places(text: str, file: str, keys: LockKeys) -> Iterator[Span]:
    """Of drives, jobs, blocks and members: each has a line of its own, unless somebody has reformatted the file."""
    lines = [number for number, line in enumerate(text.split("\n"), 1) if _ENTRY.match(line)]
    if len(lines) == len(keys.drives) + len(keys.jobs or ()) + sum(1 + len(block.members) for block in keys.blocks):
        return (Span(file, line, 1, line, 2) for line in lines)
    root = _slowly(text, file).root
    nodes = [node for key in ("drives", "jobs") for node in _nodes(root.get(key))]
    for block in _nodes(root.get("blocks")):
        nodes += [block, *_nodes(block.get("members"))]
    return (node.span for node in nodes)


def _nodes(node: YamlNode | None) -> Sequence[YamlNode]:
    return () if node is None else node.items


@dataclass(slots=True)
class _Reader:
    """Puts the parts of a valid lock together; ``places`` are theirs, in the order of the file."""

    places: Iterator[Span]
    report: Report = field(default_factory=Report)

    def snapshot(self, keys: LockKeys, file: str) -> Snapshot:
        snapshot = Snapshot(file, complete=False)
        for drive in keys.drives:
            state = DriveState(drive.key, drive.what, drive.address, tuple(drive.settings.items()), next(self.places))
            snapshot.drives[drive.key] = state
        if keys.jobs is not None:
            snapshot.jobs = {job.key: self.job(job) for job in keys.jobs}
        seen: set[tuple[str, str]] = set()
        for block in keys.blocks:
            snapshot.blocks.append(self.block(block, twice=(block.kind, block.name) in seen))
            seen.add((block.kind, block.name))
        return snapshot

    def job(self, job: _Job) -> JobState:
        telegrams = tuple(
            TelegramState(bytes.fromhex(t.request), t.positive, t.negative, t.buffer, t.protocol) for t in job.telegrams
        )
        return JobState(
            job.key, job.drive, telegrams, tuple(job.timing.items()), tuple(job.trigger.items()), next(self.places),
            job.group, tuple(JobItem(one.label, one.does, one.value) for one in job.items),
            (job.place.data, job.place.member), job.block,
        )  # fmt: skip

    def block(self, given: _Block, *, twice: bool) -> BlockState:
        span = next(self.places)
        block = BlockState(
            given.kind, given.name, given.number, given.bytes, _OPTIMIZED[given.access], given.of,
            non_retain=given.retain is False, attributes=tuple(given.attributes.items()),
            members=self.members(given), assignments=tuple(given.start_values.items()), code_hash=given.code, span=span,
        )  # fmt: skip
        title = f"{given.kind} {given.name}"
        if twice or given.hash != content_hash(block):
            why = "stands there twice" if twice else f"the lines do not match the hash {given.hash[:40] or '(none)'}"
            help_ = "the lock was edited or merged by hand: write it again with plcgen lock"
            self.report.add(Diagnostic("PG634", f"{title}: {why}", span, help=help_))
        return block

    def members(self, block: _Block) -> tuple[MemberState, ...]:
        """Nested ones follow their parent and begin with its path."""
        roots: list[_Tree] = []
        stack: list[_Tree] = []
        for row in block.members:
            while stack and not row.path.startswith((f"{stack[-1].row.path}.", f"{stack[-1].row.path}[]")):
                stack.pop()
            tree = _Tree(row, next(self.places))
            (stack[-1].inner if stack else roots).append(tree)
            if len(stack) >= _DEEPEST:
                self.report.add(Diagnostic(_CODE, f"{row.path[:60]}: nested too deeply", tree.span, help=_HELP))
                break
            stack.append(tree)
        unnamed = "" if block.kind in _NO_MEMORY else "Static"
        return tuple(tree.state(tree.row.section or unnamed) for tree in roots)


@dataclass(slots=True)
class _Tree:
    """A member while its nested ones are still being collected."""

    row: _Member
    span: Span
    inner: list[_Tree] = field(default_factory=list)

    def state(self, section: str) -> MemberState:
        """The frozen member with everything below it; only the first level has a section."""
        row, inner = self.row, tuple(tree.state("") for tree in self.inner)
        return MemberState(
            path_name(row.path), row.path, row.type, section, row.offset, row.bits, row.start,
            attributes=tuple(row.attributes.items()), inner=inner, span=self.span,
        )  # fmt: skip


def lock_schema() -> dict[str, Any]:
    """JSON schema of a lock."""
    from plcgen.project.editor import file_schema

    text = "Layouts, telegrams and interfaces as they were released; plcgen lock writes it."
    return {**file_schema("lock", text, LockKeys), "$id": f"urn:plcgen:lock:{FORMAT}"}
