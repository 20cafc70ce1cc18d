"""Text source and SimaticML document of one block: the same interface, the same tokens of code, the same comments."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import zip_longest

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.project.nouns import Project
from plcgen.project.ownership import is_owned
from plcgen.proof.checks import Check, file_check
from plcgen.proof.folder import Folder
from plcgen.proof.wording.envelopes import said_in_spec
from plcgen.proof.wording.model import stated_facts
from plcgen.s7.layout.image import image, start_place
from plcgen.s7.layout.layout import layout_block
from plcgen.s7.scl.lexer import KEYWORDS, Tokens, tokenize
from plcgen.s7.types.blocks import Block, BlockKind, SectionKind
from plcgen.s7.types.data_types import DataType, Member, inner_members
from plcgen.s7.types.literals import LiteralError, flatten, parse_initializer

_CODE = frozenset({BlockKind.FB, BlockKind.FC, BlockKind.OB})
_REMARK = re.compile(r"(?://|\bREGION\b)(.*)$", re.MULTILINE)
"""Comments and titles of regions, which are no tokens."""
Same = Callable[[str, str], bool]
_SHOWN = 30
MOST_VALUES = 100_000
"""Longest list of start values that is written out."""


def check_twins(project: Project, folder: Folder) -> Iterator[Check]:
    """One check over every block, for targets that get documents; those of the user's own are left out."""
    if project.target.xml_version is None:
        return
    problems: list[Diagnostic] = []
    same = _words_of(project)
    tokens = blocks = 0
    for name, block in folder.text.items():
        if block.instance_of and block.instance_of.upper() not in folder.text:
            continue  # instances of blocks that the compiler brings have no document
        if is_owned(block.name, project.loaded.spec.plc.user_owned):
            continue
        blocks += 1
        other = folder.xml.get(name)
        if other is None:
            message = f'{block.kind} "{block.name}" is missing from the SimaticML documents'
            problems.append(Diagnostic("PG608", message, folder.place(name), help="run plcgen generate"))
            continue
        found, count, line = difference(block, other, folder.text, folder.xml, same=same)
        tokens += count
        if found:
            message = f'{block.kind} "{block.name}": {found}'
            place = line if isinstance(line, Span) else _line(folder, name, line)
            problems.append(Diagnostic("PG612", message, place, help="run plcgen generate"))
    text = f"{blocks} blocks, {tokens:,} tokens of code"
    yield file_check("files.twins", "text and SimaticML", text, problems, "agree")


def _line(folder: Folder, name: str, line: int) -> Span:
    """A line of the code of a block in its source; 0 is the block."""
    head = folder.place(name)
    before, begin, _ = folder.text_of(name).partition("\nBEGIN\n")
    return replace(head, line=head.line + before.count("\n") + 1 + line, column=1) if line and begin else head


def difference(
    text: Block,
    document: Block,
    known: dict[str, Block],
    documents: dict[str, Block] | None = None,
    *,
    same: Same = str.__eq__,
) -> tuple[str, int, Span | int]:
    """What differs between the two spellings of a block (empty if nothing), the tokens compared, the place in the text.

    The place is a line of the code, which counts from 1, if it is no Span.

    ``known`` and ``documents`` are all blocks, from the text sources and from the documents; ``same`` says whether two
    comments are one.
    """
    if (text.kind, text.instance_of) != (document.kind, document.instance_of):
        return "the document is another kind of block", 0, 0
    if text.kind not in _CODE and not text.instance_of:
        said, place = _stored(text, document, known, documents or known)
        if not said:
            said, place = _spoken(text.members, document.members, same=same)
        return said, 0, place or 0
    words = ((text.title, document.title), (text.comment, document.comment))
    if any(not same(one.strip(), two.strip()) for one, two in words):
        return "title or comment differ", 0, 0
    declared = known.get((text.instance_of or "").upper(), text)
    for kind in SectionKind:
        if text.instance_of and kind in {SectionKind.TEMP, SectionKind.CONSTANT, SectionKind.RETURN}:
            continue
        problem, place = _members(declared.section(kind), document.section(kind), kind.value, same=same)
        if problem:
            return problem, 0, place or 0
    if text.code is None:
        return "", 0, 0
    if document.code is None:
        return "the document has no SCL", 0, 0
    found, count, line = _tokens(tokenize(text.code, "text"), tokenize(document.code, "document"))
    return found or _remarks(text.code, document.code), count, line


def _remarks(text: str, document: str) -> str:
    """The first comment of two codes with the same tokens that differs."""
    remarks = ([one.strip() for one in _REMARK.findall(code)] for code in (text, document))
    for one, two in zip_longest(*remarks, fillvalue=""):
        if one != two:
            return f'the code says "{one}", the document "{two}"'
    return ""


def _stored(
    text: Block, document: Block, known: dict[str, Block], documents: dict[str, Block]
) -> tuple[str, Span | None]:
    """A data block or type: the same places, the same bytes at start."""
    try:
        places = [_places(text, known)]
        starts = [bytes(image(text, known))]
    except (DiagnosticError, LiteralError):
        return "", None  # the checks of layout and telegrams tell
    try:
        places += [_places(document, documents)]
        starts += [bytes(image(document, documents))]
    except (DiagnosticError, LiteralError) as problem:
        return f"the document cannot be laid out: {problem}", None
    for one, two in zip_longest(*places):
        if one != two:
            return f"{(one or two)[0]} is declared differently in the document", None
    at = next((at for at, pair in enumerate(zip(*starts, strict=True)) if pair[0] != pair[1]), None)
    if at is None:
        return "", None
    return f"byte {at} has another start value in the document", start_place(text, known, at)


def _places(block: Block, known: dict[str, Block]) -> list[tuple[object, ...]]:
    return [(one.path, one.offset, one.size, _plain(one.type)) for one in layout_block(block, known).entries]


def _spoken(first: tuple[Member, ...], second: tuple[Member, ...], *, same: Same) -> tuple[str, Span | None]:
    """The first member of two lists of the same places whose comments differ."""
    for one, two in zip(first, second, strict=False):
        alone = not (one.comment and two.comment)  # only the source or only the document has words for it
        silent = alone and not stated_facts(one.comment + two.comment)
        if not silent and not same(one.comment.strip(), two.comment.strip()):
            return f'{one.name} says "{one.comment}", in the document "{two.comment}"', one.span
        if (said := _spoken(inner_members(one.type), inner_members(two.type), same=same))[0]:
            return said
    return "", None


def _plain(type_: DataType) -> object:
    """A type without the members of a structure, whose places say enough."""
    return str(getattr(type_, "bounds", "")) if inner_members(type_) else type_


def _words_of(project: Project) -> Same:
    """Whether a comment of a source and one of a document are one: the same, or the spec's in another language.

    Documents of a project without English leave out what nobody translated. Where the first language is none that
    plcgen speaks, the source is in a later one: numbers, parameters and units must agree.
    """
    spoken = project.languages[0].lower().startswith(("en", "de", "zh"))
    english = any(language.lower().startswith("en") for language in project.languages)
    said = {text: min(one.values()) for one in said_in_spec(project) for text in one.values() if text}

    def meant(text: str) -> list[str]:
        found = []
        for line in text.strip().split("\n"):
            own = next((one for one in sorted(said, key=len, reverse=True) if line.endswith(one)), "")
            found.append(line.removesuffix(own) + said.get(own, ""))
        return found

    def same(text: str, document: str) -> bool:
        if text.split() == document.split() or not (english or document):
            return True
        if not spoken and stated_facts(text) == stated_facts(document):
            return True
        return bool(said) and meant(text) == meant(document)

    return same


def _members(
    first: tuple[Member, ...], second: tuple[Member, ...], where: str, *, same: Same
) -> tuple[str, Span | None]:
    names = [m.name for m in first], [m.name for m in second]
    if names[0] != names[1]:
        return f"{where} has other members in the document", None
    for one, two in zip(first, second, strict=True):
        if _facts(one) != _facts(two) or not same(one.comment.strip(), two.comment.strip()):
            return f"{where} {one.name} is declared differently in the document", one.span
        inner = _members(inner_members(one.type), inner_members(two.type), one.name, same=same)
        if inner[0]:
            return inner
    return "", None


def _facts(member: Member) -> tuple[object, ...]:
    """What a declaration says but for its comment, without the members of a structure."""
    type_ = member.type if not inner_members(member.type) else str(getattr(member.type, "bounds", ""))
    return type_, _start(member.start), member.at, member.attributes


def _start(text: str | None) -> object:
    """A start value, whatever the spelling of a list: ``2(30.0)`` is ``30.0, 30.0``."""
    if text is None or not text.lstrip().startswith("["):
        return "".join(text.split()) if text is not None else None
    try:
        return [str(item) for item in flatten(parse_initializer(text), MOST_VALUES)]
    except LiteralError:
        return "".join(text.split())


def _tokens(text: Tokens, document: Tokens) -> tuple[str, int, int]:
    """First token in which two codes differ, how many there are, its line; keywords count in any case."""
    count = len(text.kinds) - 1
    first, second = _spelling(text), _spelling(document)
    if first == second:
        return "", count, 0
    for number, (one, two) in enumerate(zip(first, second, strict=False)):
        if one != two:
            line, _ = text.position(text.starts[number])
            return f"line {line} of the code has {_short(one)}, the document {_short(two)}", count, line
    return f"the document has {len(second) - 1} tokens of code, the text {len(first) - 1}", count, 0


def _spelling(tokens: Tokens) -> list[str]:
    pairs = zip(tokens.kinds, tokens.texts, strict=True)
    return [kind if kind in KEYWORDS else text for kind, text in pairs]


def _short(text: str) -> str:
    return text if len(text) <= _SHOWN else f"{text[: _SHOWN - 2]}.."
