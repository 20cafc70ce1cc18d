"""The text of a layout lock: one line a member, sorted, without dates, made to be reviewed in a pull request."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

from plcgen.base.diagnostics import Span
from plcgen.base.files.printed import MAX_STORED, unprintable
from plcgen.s7.compare.members import offset_text
from plcgen.s7.compare.model import BlockState, DriveState, JobState, MemberState, Snapshot

HEADER = (
    "# Layout lock of plcgen. A change of this file is a change of memory: review it.\n"
    "# plcgen lock writes it, plcgen lock --check compares it with the sources.\n"
)
FORMAT = 1
ACCESS: Mapping[bool | None, str] = {True: "optimized", False: "standard", None: "unspecified"}

_PLAIN_KEY = re.compile(r"[A-Za-z_][A-Za-z0-9_]*\Z")
_PLAIN_TEXT = re.compile(r"[A-Za-z0-9][^\x00-\x1f\x7f-\x9f\u2028\u2029\ufeff]*\Z")
_TRAPS = frozenset({"y", "n", "yes", "no", "on", "off", "true", "false", "null"})
_UNSAFE = re.compile(r": |:\Z| #|\s\Z")
_NUMBER = re.compile(r"[0-9.eExo_:,+-]+\Z")


def reduced(snapshot: Snapshot) -> Snapshot:
    """Return what a lock keeps of a state: no comments, no code but its hash, no members of other types."""
    return Snapshot(
        snapshot.label,
        [_reduced(block) for block in snapshot.blocks],
        snapshot.jobs,
        snapshot.drives,
        snapshot.diagnostics,
        complete=False,
        mirrored=frozenset(),
    )


def _reduced(block: BlockState) -> BlockState:
    code = ""
    if block.code_hash or block.locals:
        lines = [block.code_hash, *(f"{m.section} {m.name.upper()} {m.type.upper()} {m.start}" for m in block.locals)]
        code = _digest(lines)
    return BlockState(
        block.kind, block.name, block.number, block.size, block.optimized, block.instance_of, "", block.non_retain,
        attributes=block.attributes, members=tuple(_own(block.members, block.kind)), assignments=block.assignments,
        code_hash=code, span=block.span,
    )  # fmt: skip


def _own(members: Iterable[MemberState], kind: str) -> Iterator[MemberState]:
    for m in members:
        if not m.foreign:
            inner = tuple(_own(m.inner, kind))
            # An instance DB whose function block has no known layout brings its sections: a lock has none for data.
            section = "Static" if m.section and section_key(m.section, kind) == "members" else m.section
            yield MemberState(
                m.name, m.path, m.type, section, m.offset, m.bits, m.start, "", m.attributes, inner, span=m.span
            )


def lock_text(snapshot: Snapshot, sources: Sequence[str]) -> str:
    """Text of the lock of a reduced state; ``sources`` are the paths it was made from, relative to the lock."""
    lines = [HEADER.rstrip("\n"), f"format: {FORMAT}", f"sources: [{', '.join(map(_text, sources))}]"]
    if snapshot.jobs is not None:
        lines += ["drives:", *(_drive(drive) for _, drive in sorted(snapshot.drives.items()))]
        lines += ["jobs:", *(line for _, job in sorted(snapshot.jobs.items()) for line in _job(job))]
    lines += ["blocks:"] if snapshot.blocks else ["blocks: {}"]
    for block in snapshot.blocks:
        lines += _block(block)
    return "\n".join(lines) + "\n"


def unkept(snapshot: Snapshot) -> Iterator[tuple[str, Span | None]]:
    """What a lock could not be read again with, each with the place of its block: texts too long, or of no line."""
    for block in snapshot.blocks:
        texts = [block_key(block), block.instance_of, *(text for row in _rows(block) for text in row[1:])]
        for text in filter(None, texts):
            odd = unprintable(text)
            if odd:
                yield f"the character U+{ord(odd):04X} in {block_key(block)[:60]}", block.span
            elif len(text) > MAX_STORED:
                yield f'a text of {len(text)} characters in {block_key(block)[:60]}: "{text[:40]}.."', block.span


def content_hash(block: BlockState) -> str:
    """``sha256:`` and 16 hexadecimal digits over everything the lock says about a block."""
    return f"sha256:{_digest(_content(block))}"


def _content(block: BlockState) -> list[str]:
    return [line.strip() for line in _head(block)] + [
        f"{section} {key} {value}" for section, key, value in _rows(block)
    ]


def _digest(lines: Iterable[str]) -> str:
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()[:16]


def _block(block: BlockState) -> Iterator[str]:
    yield f"  {_key(block_key(block))}:"
    yield f"    hash: {content_hash(block)}"
    yield from _head(block)
    opened = ""
    for section, key, value in _rows(block):
        if section != opened:
            opened = section
            yield f"    {section}:"
        yield f"      {_key(key)}: {_text(value)}"


def block_key(block: BlockState) -> str:
    """``DB WR_DataBuffer``: kind and name, which together are unique."""
    return f"{block.kind} {block.name}"


def _head(block: BlockState) -> Iterator[str]:
    if block.number is not None:
        yield f"    number: {block.number}"
    if block.size is not None:
        yield f"    bytes: {block.size}"
    yield f"    access: {ACCESS[block.optimized]}"
    if block.instance_of:
        yield f"    of: {_text(block.instance_of)}"
    if block.non_retain:
        yield "    retain: false"
    if block.code_hash:
        yield f"    code: sha256:{block.code_hash}"


def _rows(block: BlockState) -> Iterator[tuple[str, str, str]]:
    """Section of the lock, key and value; members in the order of memory."""
    for name, value in block.attributes:
        yield "attributes", name, value
    for member in block.members:
        yield from _members(member, section_key(member.section, block.kind))
    for path, literal in sorted(block.assignments):
        yield "start_values", path, literal


def section_key(section: str, kind: str) -> str:
    """``input`` .. ``return`` for code blocks, ``members`` for data and types."""
    return "members" if kind in {"DB", "UDT"} or not section else section.lower()


def _members(member: MemberState, section: str) -> Iterator[tuple[str, str, str]]:
    where = ""
    if member.offset is not None and member.bits is not None:
        size = f"{member.bits} bit" if member.bits % 8 else f"{member.bits // 8} B"
        where = f"{offset_text(member.offset)} {size} "
    start = f" := {member.start}" if member.start else ""
    braces = ", ".join(f"{name.upper()}={_MARKS.sub(_hidden, value)}" for name, value in member.attributes)
    yield section, member.path, f"{where}{member.type}{start}{f' {{{braces}}}' if braces else ''}"
    for inner in member.inner:
        yield from _members(inner, section)


_MARKS = re.compile("[{},]|%(?=[0-9A-F]{2})")
"""What would end the value of an attribute, and what would look like the code of such a mark."""


def _hidden(match: re.Match[str]) -> str:
    return f"%{ord(match[0]):02X}"


def _drive(drive: DriveState) -> str:
    settings = "".join(f", {_key(name)}: {_text(value)}" for name, value in drive.settings)
    return f"  {_key(drive.key)}: {{what: {_text(drive.what)}, address: {drive.address}{settings}}}"


def _job(job: JobState) -> Iterator[str]:
    yield f"  {_key(job.key)}:"
    yield f"    drive: {_text(job.drive)}"
    for group, pairs in (("timing", job.timing), ("trigger", job.trigger)):
        if pairs:
            inner = ", ".join(f"{_key(name)}: {_text(value)}" for name, value in pairs)
            yield f"    {group}: {{{inner}}}"
    yield "    telegrams:"
    for telegram in job.telegrams:
        lengths = f"positive: {telegram.positive}, negative: {telegram.negative}, buffer: {telegram.buffer}"
        protocol = "" if telegram.protocol == "ds47" else f", protocol: {telegram.protocol}"
        yield f'      - {{request: "{telegram.request.hex(" ").upper()}", {lengths}{protocol}}}'


def _key(text: str) -> str:
    return text if _PLAIN_KEY.match(text) and text.lower() not in _TRAPS else _text(text)


def _text(text: str) -> str:
    """A plain scalar where every YAML reader sees the same text in it, else one in double quotes."""
    plain = _PLAIN_TEXT.match(text) and not _UNSAFE.search(text) and not _NUMBER.match(text)
    inside_flow = any(mark in text for mark in "[]{},")
    if plain and text.lower() not in _TRAPS and (not inside_flow or _MEMBER.match(text)):
        return text
    return json.dumps(text, ensure_ascii=False)


_MEMBER = re.compile(r"[0-9]+\.[0-7] [0-9]+ (?:B|bit) ")
"""Values of members stand in block style, where brackets and commas are plain text."""
