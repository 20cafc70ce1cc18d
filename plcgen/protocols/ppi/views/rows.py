"""What every document says about a member of a telegram table or response DB, worked out once."""

from __future__ import annotations

from plcgen.documents.recent import recent
from plcgen.documents.spelling import culture, elements, literal, one_line, type_text
from plcgen.project.nouns import BlockRef
from plcgen.protocols.ds47.views.rows import Row
from plcgen.protocols.ppi.plan.nouns import PpiField, PpiPlan, PpiTelegram
from plcgen.protocols.ppi.views.masters import value_text
from plcgen.protocols.ppi.views.texts import FIELD_TEXTS
from plcgen.protocols.ppi.wire.areas import Area, TransportSize
from plcgen.s7.types import ArrayType, Elementary
from plcgen.s7.values import SIGNED, UNSIGNED

_COLUMN = {"en": 0, "de": 1, "zh": 2}
_LETTER = {8: "DBB", 16: "DBW", 32: "DBD"}
_INTEGERS = SIGNED | UNSIGNED
WATCHED = 8


@recent
def table_rows(plan: PpiPlan, telegram: PpiTelegram) -> list[Row]:
    """Rows of the telegram table."""
    return [_row(plan, telegram, telegram.request.db, f, "telegram.") for f in telegram.request.fields]


@recent
def answer_rows(plan: PpiPlan, telegram: PpiTelegram) -> list[Row]:
    """Rows of the response DB; none if the reply has no data."""
    if telegram.response is None:
        return []
    return [_row(plan, telegram, telegram.response.db, f, "") for f in telegram.response.fields]


def _row(plan: PpiPlan, telegram: PpiTelegram, db: BlockRef, field: PpiField, prefix: str) -> Row:
    where = plan.target
    type_, start = field.type, ""
    subs: tuple[tuple[int, str], ...] = ()
    if isinstance(type_, Elementary) and any(field.data):
        start = literal(type_, field.data, v5=where.v5)
    elif isinstance(type_, ArrayType) and any(field.data):
        subs = tuple(elements(type_, field.data, v5=where.v5))
    texts = {language: _text(plan, telegram, field, language) for language in plan.languages}
    main = _text(plan, telegram, field, "en") if where.v5 else texts[plan.languages[0]]
    return Row(
        name=field.name,
        type=type_text(type_, tia=not where.v5),
        start=start,
        subs=subs,
        text=main,
        comments=tuple((culture(language), text) for language, text in texts.items()),
        offset=field.offset,
        size=field.size,
        address=f"DB{db.number}.{_LETTER.get(_bits(field), 'DBB')}{field.offset}",
        watch=_watch(db, field, prefix),
    )


def _bits(field: PpiField) -> int:
    return field.type.bits if isinstance(field.type, Elementary) else 8


def _text(plan: PpiPlan, telegram: PpiTelegram, field: PpiField, language: str) -> str:
    """Comment of a member in a language, with the addresses where it belongs to an item."""
    text = FIELD_TEXTS[field.role][_COLUMN.get(language[:2].lower(), 0)]
    if not field.item:
        return text
    if field.role == "value" and len(field.placed) == 1:
        return value_text(plan, field.placed[0].value)
    wire = telegram.items[field.item - 1]
    labels = ", ".join(placed.value.label for placed in wire.values) or Area(wire.item.area).title
    if field.role == "transport_size":
        text = f"{wire.item.size:02X}h = {TransportSize(wire.item.size).name.lower().replace('_', ' ')}"
    if field.role == "area":
        text = f"{wire.item.area:02X}h = {Area(wire.item.area).name}"
    return one_line(f"{labels}: {text}")


def _watch(db: BlockRef, field: PpiField, prefix: str) -> tuple[tuple[str, str, str, str], ...]:
    """Watch lines of a member: one, or one per array element up to ``WATCHED``; nothing is to be modified."""
    if field.role == "pad":
        return ()
    type_ = field.type
    element = type_.element if isinstance(type_, ArrayType) else type_
    if not isinstance(element, Elementary):
        return ()
    shown = "FloatingPoint" if element.name == "REAL" else "DEC" if element.name in _INTEGERS else "Hex"
    shown = "Character" if element.name == "CHAR" else shown
    letter = _LETTER.get(element.bits, "DBB")
    name = f'"{db.name}".{prefix}{field.name}'
    if not isinstance(type_, ArrayType):
        return ((name, f"DB{db.number}.{letter}{field.offset}", shown, ""),)
    low, high = type_.bounds[0]
    step = element.bits // 8
    count = min(high - low + 1, WATCHED)
    return tuple(
        (f"{name}[{low + n}]", f"DB{db.number}.{letter}{field.offset + n * step}", shown, "") for n in range(count)
    )
