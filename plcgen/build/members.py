"""Members of types and data blocks: from fields of a telegram, or from name, type and text alone."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import groupby

from plcgen.build.nouns import MemberRow, StartAssignment, WatchRow
from plcgen.build.phrases import translated
from plcgen.build.spelling import array_elements, culture, declared_type, literal, one_line, type_words
from plcgen.build.voice import voice_of
from plcgen.project.nouns import BlockRef, BufferField, Frame
from plcgen.s7.types.data_types import ArrayType, DataType, Elementary
from plcgen.s7.types.values import SIGNED, UNSIGNED

WATCHED = 8
"""Elements of an array that a watch table shows."""

_INTEGERS = SIGNED | UNSIGNED
_LETTER = {8: "DBB", 16: "DBW", 32: "DBD"}


def plain(frame: Frame, name: str, type_: str, text: str, start: str = "") -> MemberRow:
    """A member with a comment of the templates or of the spec: a source has it as it is, a document by language."""
    found = () if frame.target.xml_version is None else voice_of(frame).texts(one_line(text))
    return MemberRow(name, type_, text, start, comments=found)


def _translated(texts: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Texts with their cultures; one that only repeats the English one is no translation, unless it is meant so."""
    english = next((text for language, text in texts.items() if language.startswith("en")), None)
    return (
        (culture(name), text)
        for name, text in texts.items()
        if name.startswith("en") or text != english or name[:2] in translated(text)
    )


def fixed(frame: Frame, rows: Iterable[tuple[str, str, str]]) -> list[MemberRow]:
    """Members of a type that every project has: name, elementary type, text."""
    words = type_words(tia=not frame.target.v5)
    return [plain(frame, name, words[type_], text) for name, type_, text in rows]


def initializer(type_: DataType, data: bytes, *, v5: bool, runs: bool = True) -> str:
    """Literal of a start value; of an array ``[3(10.0), 5.0]``, STEP 7 V5: ``3(10.0), 5.0``; none for zeros.

    Without ``runs`` elements that are not all alike stand for themselves, as they come back from a document.
    """
    if not isinstance(type_, ArrayType):
        return literal(type_, data, v5=v5) if isinstance(type_, Elementary) else ""
    others, element = dict(array_elements(type_, data, v5=v5)), type_.element
    if not others or not isinstance(element, Elementary):
        return ""
    default = literal(element, b" " if element.name == "CHAR" else bytes(element.bits // 8), v5=v5)
    low, high = type_.bounds[0]
    texts = [others.get(index, default) for index in range(low, high + 1)]
    if runs or len(set(texts)) == 1:
        same = ((text, len([*each])) for text, each in groupby(texts))
        texts = [text if count == 1 else f"{count}({text})" for text, count in same]
    found = ", ".join(texts)
    return found if v5 else f"[{found}]"


def display_format(type_: Elementary) -> str:
    """Display format of a watch table."""
    if type_.name in {"REAL", "LREAL"}:
        return "FloatingPoint"
    return "DEC" if type_.name in _INTEGERS else "Hex"


def buffer_member(
    frame: Frame,
    db: BlockRef | None,
    field: BufferField,
    texts: Mapping[str, str],
    text: str,
    *,
    starts: bool,
    path: str = "",
    shown: Callable[[Elementary], str] | None = display_format,
    modify: Callable[[Elementary, bytes], str] | None = None,
) -> MemberRow:
    """A member of a buffer, worked out once for all documents.

    ``texts`` is its comment by language, ``text`` that of the sources; ``starts`` whether array elements have start
    values; ``path`` what stands before the name inside the block; ``shown`` gives the display format (None: not
    watched), ``modify`` the modify value of wire bytes.
    """
    v5 = frame.target.v5
    type_, start = field.type, ""
    subs: tuple[tuple[int, str], ...] = ()
    if isinstance(type_, Elementary) and any(field.data):
        start = literal(type_, field.data, v5=v5)
    elif isinstance(type_, ArrayType) and starts:
        subs = tuple(array_elements(type_, field.data, v5=v5))
    return MemberRow(
        name=field.name,
        type=declared_type(type_, tia=not v5),
        text=text,
        start=start,
        subs=subs,
        comments=tuple(_translated(texts)),
        offset=field.offset,
        size=field.size,
        address=absolute_address(db, type_, field.offset),
        watch=tuple(_watch(db, field, path, shown, modify)) if shown and db is not None else (),
    )


def absolute_address(db: BlockRef | None, type_: DataType, offset: int) -> str:
    """Absolute address of a member, ``DB3.DBW6``; others by their first byte; none inside an instance."""
    if db is None:
        return ""
    width = type_.bits if isinstance(type_, Elementary) else 8
    return f"DB{db.number}.{_LETTER.get(width, 'DBB')}{offset}"


def _watch(
    db: BlockRef,
    field: BufferField,
    path: str,
    shown: Callable[[Elementary], str],
    modify: Callable[[Elementary, bytes], str] | None,
) -> Iterable[WatchRow]:
    """Watch lines of a member: one, or one per array element up to ``WATCHED``."""
    type_ = field.type
    name = f'"{db.name}".{path}{field.name}'
    if isinstance(type_, Elementary):
        value = modify(type_, field.data) if modify else ""
        yield WatchRow(name, absolute_address(db, type_, field.offset), shown(type_), value)
    elif isinstance(type_, ArrayType) and isinstance(type_.element, Elementary):
        element, (low, high) = type_.element, type_.bounds[0]
        step = element.bits // 8
        for number in range(min(high - low + 1, WATCHED)):
            value = modify(element, field.data[number * step : (number + 1) * step]) if modify else ""
            address = absolute_address(db, element, field.offset + number * step)
            yield WatchRow(f"{name}[{low + number}]", address, shown(element), value)


def assignments(members: Iterable[MemberRow]) -> list[StartAssignment]:
    """Start values of array elements."""
    return [StartAssignment(f"{member.name}[{index}]", value) for member in members for index, value in member.subs]
