"""Titles, comments and start values of the blocks in the text sources, against what the protocols state."""

from __future__ import annotations

import hashlib
import itertools
import re
from collections.abc import Iterator

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.proof.folder import Folder, plain
from plcgen.proof.wording.model import GENERATOR, Wording, agrees, stated_facts
from plcgen.s7.layout.image import image
from plcgen.s7.layout.layout import layout_block
from plcgen.s7.types.blocks import Block, BlockKind, Section, SectionKind
from plcgen.s7.types.data_types import Member, inner_members
from plcgen.s7.types.literals import LiteralError

EMPTY = "every signal of every job is a flag"
"""What stands at the only member of a control DB in which no job has anything."""
_REMARK = re.compile(r"^(.*?)//(.*)$", re.MULTILINE)
_ASSIGNED = re.compile(r"\s*(?P<path>[\w.\[\],\"]+) := .*?;(?:\s*// (?P<text>.*))?")
_INTERFACE = (SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.IN_OUT)
Way = tuple[str, ...]


def check_block(block: Block, folder: Folder, stated: Wording, *, english: bool) -> Iterator[Diagnostic]:
    """Everything that a block of the text sources says; nothing if the protocol has no such block."""
    titles = stated.title(block)
    if titles is None:
        return
    place = block.span or folder.place(block.name)
    if not agrees(block.title, titles, english=english):
        yield _wrong(block, f'its title is "{block.title}"', titles, place)
    yield from (Diagnostic("PG614", f'{block.kind} "{block.name}": {said}', place) for said in stated.head(block))
    offsets = _offsets(block, folder)
    for path, member in _members(block):
        texts = stated.member(block, path, offsets.get(".".join(path)))
        if texts is None:
            yield _wrong(block, f"no source for {'.'.join(path)}", frozenset(), member.span or place)
        elif not agrees(member.comment, texts, english=english):
            said = f'{".".join(path)} says "{member.comment}"' if member.comment else f"{'.'.join(path)} says nothing"
            yield _wrong(block, said, texts, member.span or place)
    yield from _remarks(block, stated, place, english=english)
    yield from _assigned(block, folder, stated, english=english)
    yield from _starts(block, folder, stated, place)
    yield from (_wrong(block, said, frozenset(), place) for said in _header(block, folder, stated))


def _header(block: Block, folder: Folder, stated: Wording) -> Iterator[str]:
    """Family and version, retentivity, versions of instructions."""
    version, wanted = block.attributes.get("VERSION"), stated.version(block)
    if version is not None and version.strip("'") != wanted:
        yield f"its version is {version}, not {wanted}"
    if wanted == GENERATOR and block is folder.text.get(block.name.upper()):
        yield from _own_hash(block, folder.text_of(block.name))
    if block.attributes.get("FAMILY", stated.family) != stated.family:
        yield f"its family is {block.attributes['FAMILY']}, not {stated.family}"
    if block.kind is BlockKind.DB and folder.encoding != "cp1252" and block.non_retain == stated.retains(block):
        yield "keeps its values (RETAIN)" if not block.non_retain else "does not keep its values (NON_RETAIN)"
    library = stated.instructions()
    for section in block.sections if block.kind is BlockKind.FB else ():
        for member in section.members:
            found = dict(member.attributes)
            right = {"InstructionName": name, "LibVersion": library.get(name, "")} if (
                name := found.get("InstructionName", "")
            ) else {}  # fmt: skip
            if found != right:
                yield f"{member.name} has {found}, not {right}"


def _own_hash(block: Block, source: str) -> Iterator[str]:
    """NAME: H and the first seven digits of the SHA-256 of all lines of the block but NAME and VERSION, as UTF-8."""
    lines = itertools.takewhile(lambda line: line != "END_FUNCTION_BLOCK", source.splitlines())
    kept = [line for line in lines if not line.startswith(("NAME :", "VERSION :"))]
    digest = hashlib.sha256("\n".join([*kept, "END_FUNCTION_BLOCK", ""]).encode()).hexdigest()
    right, name = f"H{digest[:7].upper()}", block.attributes.get("NAME", "").strip("'")
    if name != right:
        yield f"its hash (NAME) is {name or 'missing'}, that of its text {right}: the text was changed"


def _wrong(block: Block, what: str, texts: frozenset[str], place: Span) -> Diagnostic:
    wanted = " or ".join(f'"{text}"' for text in sorted(texts)) or "nothing is known of it"
    return Diagnostic(
        "PG614", f'{block.kind} "{block.name}": {what}', place, help=f"stated by spec and telegrams: {wanted}"
    )


def _members(block: Block) -> Iterator[tuple[Way, Member]]:
    """Every member with its path; those that a type has stand in the type."""
    pending: list[tuple[Way, Member]] = [((member.name,), member) for member in block.members]
    while pending:
        path, member = pending.pop(0)
        yield path, member
        pending += [((*path, inner.name), inner) for inner in inner_members(member.type)]


def _offsets(block: Block, folder: Folder) -> dict[str, int]:
    """Byte of every member of a type or data block."""
    if block.kind not in {BlockKind.UDT, BlockKind.DB}:
        return {}
    try:
        return {entry.path.replace('"', ""): entry.byte for entry in layout_block(block, folder.text).entries}
    except DiagnosticError:
        return {}  # told where it is laid out


def _remarks(block: Block, stated: Wording, place: Span, *, english: bool) -> Iterator[Diagnostic]:
    """Comments in the code that state something; those in another language than English are not understood."""
    for code, text in _REMARK.findall(block.code or "") if english else ():
        if stated_facts(text) and not stated.remark(block, code.strip(), plain(text)):
            yield _wrong(block, f'no source for the comment "{text.strip()}"', frozenset(), place)


def _assigned(block: Block, folder: Folder, stated: Wording, *, english: bool) -> Iterator[Diagnostic]:
    """What stands behind the start values below BEGIN; the model of a block has no place for it."""
    if block.kind is not BlockKind.DB or not block.assignments or block.span is None:
        return
    for number, line in enumerate(folder.text_of(block.name).splitlines(), block.span.line):
        found = _ASSIGNED.fullmatch(line)
        if found is None:
            continue
        texts = stated.assigned(block, found["path"].replace('"', ""))
        if texts is not None and not agrees(found["text"] or "", texts, english=english):
            place = Span(block.span.file, number, 1)
            yield _wrong(block, f'{found["path"]} says "{found["text"] or ""}"', texts, place)


def _starts(block: Block, folder: Folder, stated: Wording, place: Span) -> Iterator[Diagnostic]:
    """Start values of the pins: those that are stated, and no others; nothing keeps its value without power."""
    wanted = stated.starts(block)
    if wanted is None:
        return
    for section in block.sections:
        if section.retain:
            yield _wrong(block, f"{section.kind} is {section.retain}", frozenset(), place)
        for member in section.members if section.kind in _INTERFACE else ():
            said = wanted.get(member.name, "")
            if not _same_start(member, said, folder):
                shown = said if isinstance(said, str) else said.hex(" ").upper()
                what = f"{member.name} starts with {member.start or 'nothing'}"
                yield _wrong(block, what, frozenset({shown or "nothing"}), member.span or place)


def _same_start(member: Member, wanted: bytes | str, folder: Folder) -> bool:
    if isinstance(wanted, str):
        return (member.start or "") == wanted
    alone = Block(BlockKind.UDT, member.name, (Section(SectionKind.STATIC, (member,)),))
    try:
        found = bytes(image(alone, folder.text))
    except (DiagnosticError, LiteralError):
        return False
    return found[: len(wanted)] == wanted and not any(found[len(wanted) :])
