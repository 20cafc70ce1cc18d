"""What every document says about a buffer member, worked out once: declaration, start value, comment, address."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

from plcgen.emit.spelling import comment_text, culture, elements, literal, one_line, type_text
from plcgen.emit.texts import field_texts
from plcgen.plan.model import BlockRef, Field, Project, Telegram
from plcgen.s7.types import ArrayType, Elementary
from plcgen.s7.values import SIGNED, UNSIGNED

_INTEGERS = SIGNED | UNSIGNED
_LETTER = {8: "DBB", 16: "DBW", 32: "DBD"}


class Row(NamedTuple):
    """A buffer member as the templates write it.

    ``start`` is the literal of a start value other than zero, ``subs`` those of array elements; ``text`` the
    comment for sources, ``comments`` the same per culture; ``watch`` the name, format and value of a watch line.
    """

    name: str
    type: str
    start: str
    subs: tuple[tuple[int, str], ...]
    text: str
    comments: tuple[tuple[str, str], ...]
    offset: int
    size: int
    address: str
    watch: tuple[str, str, str] | None


@lru_cache(maxsize=8)
def telegram_rows(project: Project, telegram: Telegram) -> tuple[list[Row], list[Row]]:
    """Rows of the request DB and of the response DB of one telegram."""
    return (
        [_row(project, telegram.request_db, field, response=False) for field in telegram.request_fields],
        [_row(project, telegram.response_db, field, response=True) for field in telegram.response_fields],
    )


def _row(project: Project, db: BlockRef, field: Field, *, response: bool) -> Row:
    where = project.target
    type_ = field.type
    start = ""
    subs: tuple[tuple[int, str], ...] = ()
    if isinstance(type_, Elementary) and any(field.data):
        start = literal(type_, field.data, v5=where.v5)
    elif isinstance(type_, ArrayType) and not response:
        subs = tuple(elements(type_, field.data, v5=where.v5))
    texts = {language: one_line(text) for language, text in field_texts(field, project.languages, response=response)}
    text = texts[project.languages[0]]
    if where.v5:
        fallback = dict(field_texts(field, ("en",), response=response))["en"]
        text = comment_text(texts, project.languages, where, fallback)
    return Row(
        name=field.name,
        type=type_text(type_, tia=not where.v5),
        start=start,
        subs=subs,
        text=text,
        comments=tuple(zip(map(culture, texts), texts.values(), strict=True)),
        offset=field.offset,
        size=field.size,
        address=_address(db, field),
        watch=_watch(project, db, field, response=response),
    )


def _address(db: BlockRef, field: Field) -> str:
    """Absolute address of a member, ``DB3.DBW6``; wider or array members by their first byte."""
    width = field.type.bits if isinstance(field.type, Elementary) else 8
    return f"DB{db.number}.{_LETTER.get(width, 'DBB')}{field.offset}"


def _watch(project: Project, db: BlockRef, field: Field, *, response: bool) -> tuple[str, str, str] | None:
    """Name, display format and modify value of a member's watch line; an array shows its first element."""
    if field.role in {"pad", "reserve"}:
        return None
    name, type_, data = field.name, field.type, field.data
    if isinstance(type_, ArrayType) and isinstance(type_.element, Elementary):
        name = f"{name}[{type_.bounds[0][0]}]"
        data = data[: type_.element.bits // 8]
        type_ = type_.element
    if not isinstance(type_, Elementary):
        return None
    shown, modify = "Hex", "" if response else literal(type_, data, v5=project.target.v5)
    if type_.name in {"REAL", "LREAL"}:
        shown = "FloatingPoint"
    elif field.role == "pnu":
        shown, modify = "DEC", "" if response else str(int.from_bytes(data))
    elif type_.name in _INTEGERS:
        shown = "DEC"
    return f'"{db.name}".{name}', shown, modify
