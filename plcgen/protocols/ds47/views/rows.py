"""What every document says about a buffer member, worked out once: declaration, start value, comment, address."""

from __future__ import annotations

from typing import NamedTuple

from plcgen.documents.recent import recent
from plcgen.documents.spelling import comment_text, culture, elements, literal, one_line, type_text
from plcgen.project.nouns import BlockRef
from plcgen.protocols.ds47.plan.nouns import DriveField, DrivePlan, DriveTelegram
from plcgen.protocols.ds47.views.texts import field_texts
from plcgen.s7.types import ArrayType, Elementary
from plcgen.s7.values import SIGNED, UNSIGNED

_INTEGERS = SIGNED | UNSIGNED
WATCHED = 8
"""Elements of an array that a watch table shows."""

_LETTER = {8: "DBB", 16: "DBW", 32: "DBD"}


class Row(NamedTuple):
    """A buffer member as the templates write it.

    ``start`` is the literal of a start value other than zero, ``subs`` those of array elements; ``text`` the
    comment for sources, ``comments`` the same per culture; ``watch`` its lines of a
    watch table: name, address, display format, modify value.
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
    watch: tuple[tuple[str, str, str, str], ...]


@recent
def telegram_rows(plan: DrivePlan, telegram: DriveTelegram) -> tuple[list[Row], list[Row]]:
    """Rows of the request DB and of the response DB of one telegram."""
    return (
        [_row(plan, telegram.request.db, field, response=False) for field in telegram.request.fields],
        [_row(plan, telegram.response.db, field, response=True) for field in telegram.response.fields],
    )


def _row(plan: DrivePlan, db: BlockRef, field: DriveField, *, response: bool) -> Row:
    where = plan.target
    type_ = field.type
    start = ""
    subs: tuple[tuple[int, str], ...] = ()
    if isinstance(type_, Elementary) and any(field.data):
        start = literal(type_, field.data, v5=where.v5)
    elif isinstance(type_, ArrayType) and not response:
        subs = tuple(elements(type_, field.data, v5=where.v5))
    texts = {language: one_line(text) for language, text in field_texts(field, plan.languages, response=response)}
    text = texts[plan.languages[0]]
    if where.v5:
        fallback = dict(field_texts(field, ("en",), response=response))["en"]
        text = comment_text(texts, plan.languages, where, fallback)
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
        watch=_watch(plan, db, field, response=response),
    )


def _address(db: BlockRef, field: DriveField) -> str:
    """Absolute address of a member, ``DB3.DBW6``; wider or array members by their first byte."""
    width = field.type.bits if isinstance(field.type, Elementary) else 8
    return f"DB{db.number}.{_LETTER.get(width, 'DBB')}{field.offset}"


def _watch(
    plan: DrivePlan, db: BlockRef, field: DriveField, *, response: bool
) -> tuple[tuple[str, str, str, str], ...]:
    """Watch lines of a member: one, or one per array element up to ``WATCHED``; inputs have no modify value."""
    if field.role in {"pad", "reserve"}:
        return ()
    fixed = not response and (field.role != "value" or field.part is None or field.part.use.constant)
    type_ = field.type
    if isinstance(type_, Elementary):
        value = _modify(plan, field, type_, field.data) if fixed else ""
        return ((f'"{db.name}".{field.name}', _address(db, field), _format(field, type_), value),)
    if not isinstance(type_, ArrayType) or not isinstance(type_.element, Elementary):
        return ()
    element, (low, high) = type_.element, type_.bounds[0]
    step = element.bits // 8
    lines = []
    for number in range(min(high - low + 1, WATCHED)):
        piece = field.data[number * step : (number + 1) * step]
        address = f"DB{db.number}.{_LETTER.get(element.bits, 'DBB')}{field.offset + number * step}"
        value = _modify(plan, field, element, piece) if fixed else ""
        lines.append((f'"{db.name}".{field.name}[{low + number}]', address, _format(field, element), value))
    return tuple(lines)


def _format(field: DriveField, type_: Elementary) -> str:
    if type_.name in {"REAL", "LREAL"}:
        return "FloatingPoint"
    return "DEC" if field.role == "pnu" or type_.name in _INTEGERS else "Hex"


def _modify(plan: DrivePlan, field: DriveField, type_: Elementary, data: bytes) -> str:
    return str(int.from_bytes(data)) if field.role == "pnu" else literal(type_, data, v5=plan.target.v5)
