"""Expressions between bytes of a telegram and typed values, and what every document says about a member."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from importlib.resources import files
from typing import Any

from plcgen.build.members import buffer_member, display_format, plain
from plcgen.build.nouns import DataBlock, MemberRow, StartAssignment, TypeBlock
from plcgen.build.spelling import comment_text, encodable, one_line, spelling_of
from plcgen.ppi.plan.nouns import Placed, PpiField, PpiJob, PpiPlan, PpiTelegram, PpiValue, WireItem
from plcgen.ppi.wire.areas import Area, TransportSize
from plcgen.project.nouns import BlockRef
from plcgen.s7.scl.classic import respell_expression
from plcgen.s7.types.data_types import ArrayType, Elementary
from plcgen.s7.types.names import first_upper, shorten

_WIDE = {1: "BYTE", 2: "WORD", 4: "DWORD"}
Bytes = Callable[[str], str]
"""A byte by the text of its index."""


def stat_name(job: PpiJob, value: PpiValue) -> str:
    """Copy of an input inside the block, taken when the job starts."""
    pin = job.pin(value.member)
    return shorten(f"stat{first_upper(pin)}", job.longest_name)


def assemble(byte: Bytes, at: str, size: int, first: int = 0) -> str:
    """BYTE, WORD or DWORD of ``size`` big-endian bytes from index ``at`` on."""
    names = [byte(_index(at, first + k)) for k in range(size)]
    if size == 1:
        return names[0]
    wide = _WIDE[size]
    parts = [
        f"SHL(IN := BYTE_TO_{wide}({name}), N := {8 * (size - 1 - k)})" if k < size - 1 else f"BYTE_TO_{wide}({name})"
        for k, name in enumerate(names)
    ]
    return " OR ".join(parts)


def _index(at: str, offset: int) -> str:
    if not at:
        return str(offset)
    return at if not offset else f"{at} + {offset}" if offset > 0 else f"{at} - {-offset}"


def typed(text: str, element: Elementary) -> str:
    """Convert a BYTE, WORD or DWORD expression to the type of a value."""
    wide = _WIDE[element.bits // 8]
    return text if element.name == wide else f"{wide}_TO_{element.name}({text})"


def into_response(plan: PpiPlan, rx: Bytes, field: PpiField, wire: WireItem) -> dict[str, Any]:
    """How the walker stores one value in the response DB; ``tempAt`` is the index of its first byte."""
    at, single, type_ = "#tempAt", wire.single, field.type
    view: dict[str, Any] = {"member": field.name, "loop": isinstance(type_, ArrayType), "last": 0}
    if not isinstance(type_, ArrayType):
        element = single.element if single is not None and not single.bit else None
        text = assemble(rx, at, 1 if element is None else element.bits // 8)
        return {**view, "value": _spelled(plan, text if element is None else typed(text, element))}
    element = type_.element if isinstance(type_.element, Elementary) else None
    size = element.bits // 8 if element is not None else 1
    view["last"] = wire.item.octets // size - 1
    step = f"{at} + {size if size > 1 else ''}{' * ' if size > 1 else ''}#tempIndex"
    text = assemble(rx, step, size)
    return {**view, "value": _spelled(plan, typed(text, element) if element is not None else text)}


def _spelled(plan: PpiPlan, text: str) -> str:
    """A TIA expression as the target writes it."""
    return respell_expression(text, spelling_of(plan.target))


def output_moves(plan: PpiPlan, job: PpiJob, value: PpiValue) -> list[dict[str, Any]]:
    """Expressions of an output over the members of the response DBs; in arrays over ``tempIndex``, part by part."""
    moves = []
    for telegram in job.telegrams:
        for field in telegram.response.fields if telegram.response else ():
            for placed in field.placed:
                if placed.value is value:
                    first = placed.start // value.stride
                    last = first + placed.length // value.stride - 1
                    text = _source(telegram, field, placed)
                    moves.append(
                        {"loop": value.count > 1, "first": first, "last": last, "source": _spelled(plan, text)}
                    )
    return moves


def _source(telegram: PpiTelegram, field: PpiField, placed: Placed) -> str:
    """Expression of a value, or of one element by ``tempIndex``, over one member of a response DB."""
    value = placed.value
    assert telegram.response is not None  # a read has one
    member = f'"{telegram.response.home.name}".{field.name}'
    if field.type == value.type and len(field.placed) == 1:
        return f"{member}[#tempIndex]" if value.count > 1 else member
    array = isinstance(field.type, ArrayType)

    def byte(index: str) -> str:
        return f"{member}[{index}]" if array else member

    if value.bit:
        text = byte(str(placed.offset))
        if placed.bit is None:
            return f"{text} <> B#16#00"
        return f"({text} AND B#16#{1 << placed.bit:02X}) <> B#16#00"
    first = placed.offset - placed.start + value.skip
    if value.count == 1:
        return typed(assemble(byte, "", value.size, first), value.element)
    step = f"{value.stride} * #tempIndex" if value.stride > 1 else "#tempIndex"
    return typed(assemble(byte, step, value.size, first), value.element)


def into_table(plan: PpiPlan, job: PpiJob, telegram: PpiTelegram) -> list[dict[str, Any]]:
    """Assignments of a job's inputs to the members of its telegram table."""
    lines: list[dict[str, Any]] = []
    for field in telegram.request.fields:
        if field.role != "value":
            continue
        target = f'"{telegram.request.home.name}".telegram.{field.name}'
        for placed in field.placed:
            value = placed.value
            if value.constant:
                continue
            stat = stat_name(job, value)
            line = {"bool": value.bit, "loop": value.count > 1, "stat": stat, "target": target, "last": value.count - 1}
            if value.bit or field.type == value.type:
                element = "[#tempIndex]" if line["loop"] else ""
                one = _move(plan, target + element, f"#{stat}{element}")
                lines.append({**line, **one, "first": 0, "lines": [one]})
            elif value.count > 1:
                lines.append(_array_bytes(plan, stat, target, placed))
            else:
                lines += _scalar_bytes(plan, f"#{stat}", target, placed.offset, value)
    return lines


def _move(plan: PpiPlan, target: str, source: str) -> dict[str, Any]:
    return {"target": _spelled(plan, target), "source": _spelled(plan, source)}


def _scalar_bytes(plan: PpiPlan, source: str, target: str, offset: int | str, value: PpiValue) -> list[dict[str, Any]]:
    """One assignment a byte: a value that shares its item with others; ``target`` may be a single byte."""
    size, name = value.size, value.element.name
    wide = _WIDE[size]
    text = source if name == wide else f"{name}_TO_{wide}({source})"
    lines = []
    for k in range(size):
        shift = 8 * (size - 1 - k)
        part = text if size == 1 else f"{wide}_TO_BYTE({f'SHR(IN := {text}, N := {shift})' if shift else text})"
        index = offset + k if isinstance(offset, int) else f"{offset} + {k}" if k else offset
        lines.append({"bool": False, "loop": False, **_move(plan, f"{target}[{index}]", part)})
    return lines


def _array_bytes(plan: PpiPlan, stat: str, target: str, placed: Placed) -> dict[str, Any]:
    value = placed.value
    first = placed.start // value.size
    base = placed.offset - placed.start
    step = f"{value.size} * #tempIndex" if value.size > 1 else "#tempIndex"
    index = f"{step} + {base}" if base > 0 else f"{step} - {-base}" if base else step
    lines = _scalar_bytes(plan, f"#{stat}[#tempIndex]", target, index, value)
    last = first + placed.length // value.size - 1
    return {"bool": False, "loop": True, "first": first, "last": last, "lines": lines}


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
