"""What every document says about a member of a telegram table or response DB, worked out once."""

from __future__ import annotations

import tomllib
from importlib.resources import files

from plcgen.build.members import buffer_member, display_format, plain
from plcgen.build.nouns import DataBlock, MemberRow, StartAssignment, TypeBlock
from plcgen.build.spelling import comment_text, encodable, one_line
from plcgen.ppi.plan.nouns import PpiField, PpiPlan, PpiTelegram, PpiValue
from plcgen.ppi.wire.areas import Area, TransportSize
from plcgen.project.nouns import BlockRef
from plcgen.s7.types.data_types import Elementary

FIELD_TEXTS: dict[str, tuple[str, str, str]] = tomllib.loads(
    files("plcgen.ppi.views").joinpath("fields.toml").read_text("utf-8")
)
"""What a field means, by its role: in English, German, Chinese. Other languages get English."""
_COLUMN = {"en": 0, "de": 1, "zh": 2}
_LEAD = "telegram"
"""The member of a table that holds the telegram."""


def buffer_blocks(plan: PpiPlan, telegram: PpiTelegram, title: str) -> list[tuple[TypeBlock, DataBlock]]:
    """Telegram table and response DB, if the reply has data; ``title`` is that of the telegram's job."""
    table, answer = telegram.request, telegram.response
    members = [_member(plan, telegram, table.home, field, f"{_LEAD}.") for field in table.fields]
    whole = plain(plan, _LEAD, f'"{table.type.name}"', "the telegram behind its length")
    whole = whole._replace(text="", expanded=tuple(members))
    data = DataBlock(table.home, f"Telegram table: {title}", (whole,), _start_values(members))
    found = [(TypeBlock(table.type, members), data)]
    if answer is not None:
        members = [_member(plan, telegram, answer.home, field, "") for field in answer.fields]
        found.append((TypeBlock(answer.type, members), DataBlock(answer.home, f"Response: {title}", members)))
    return found


def _start_values(members: list[MemberRow]) -> list[StartAssignment]:
    """All start values of a table: what the user type cannot hold."""
    found = []
    for member in members:
        values = [(member.name, member.start)] if member.start else []
        values += [(f"{member.name}[{index}]", text) for index, text in member.subs]
        found += [StartAssignment(f"{_LEAD}.{path}", value, member.text) for path, value in values]
    return found


def _member(plan: PpiPlan, telegram: PpiTelegram, db: BlockRef, field: PpiField, path: str) -> MemberRow:
    texts = {language: _text(plan, telegram, field, language) for language in plan.languages}
    return buffer_member(
        plan,
        db,
        field,
        texts,
        _text(plan, telegram, field, "en") if plan.target.v5 else texts[plan.languages[0]],
        starts=any(field.data),
        path=path,
        shown=None if field.role == "pad" else _shown,
    )


def _shown(type_: Elementary) -> str:
    return "Character" if type_.name == "CHAR" else display_format(type_)


def value_comment(plan: PpiPlan, value: PpiValue) -> str:
    """Comment of a value: address or symbol, and what the spec or the symbol table says about it."""
    title = value.title if encodable(value.title, plan.target) else ""
    return one_line(f"{value.label} {comment_text(value.comment, plan.languages, plan.target, title)}".strip())


def _text(plan: PpiPlan, telegram: PpiTelegram, field: PpiField, language: str) -> str:
    """Comment of a member in a language, with the addresses where it belongs to an item."""
    text = FIELD_TEXTS[field.role][_COLUMN.get(language[:2].lower(), 0)]
    if not field.item:
        return text
    if field.role == "value" and len(field.placed) == 1:
        return value_comment(plan, field.placed[0].value)
    wire = telegram.items[field.item - 1]
    labels = ", ".join(placed.value.label for placed in wire.values) or Area(wire.item.area).title
    if field.role == "transport_size":
        text = f"{wire.item.size:02X}h = {TransportSize(wire.item.size).name.lower().replace('_', ' ')}"
    if field.role == "area":
        text = f"{wire.item.area:02X}h = {Area(wire.item.area).name}"
    return one_line(f"{labels}: {text}")
