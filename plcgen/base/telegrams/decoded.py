"""A decoded telegram, of any protocol, as a table and as data."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

from plcgen.base.diagnostics.counting import quantity
from plcgen.base.display.cells import clean, cut
from plcgen.base.display.table import text_table
from plcgen.base.display.view import View

HEADER = ("offset", "bytes", "field", "value", "meaning")
_SHOWN = 8
_PARAMETER = re.compile(r"((?:parameter|item|value) [0-9]+(?: \([^)]*\))?) (.+)")


@dataclass(frozen=True, slots=True)
class TelegramField:
    """One field: byte ``offset`` and bytes, name, value as text, meaning; ``problem`` marks a wrong one."""

    offset: int
    data: bytes
    name: str
    value: str
    note: str
    problem: bool


@dataclass(frozen=True, slots=True)
class DecodedTelegram:
    """A telegram taken apart: ``kind`` request or response, every field, what is wrong as (offset, message)."""

    kind: str
    data: bytes
    fields: tuple[TelegramField, ...]
    problems: tuple[tuple[int, str], ...]

    @property
    def ok(self) -> bool:
        """Whether the telegram is valid."""
        return not self.problems


def telegram_text(telegram: DecodedTelegram, view: View) -> str:
    """Table of all fields; ``!`` marks the wrong ones."""
    rows: list[tuple[str, ...]] = []
    wrong: list[bool] = []
    section = ""
    for field in telegram.fields:
        found = _PARAMETER.match(field.name)
        if found and found[1] != section:
            section = found[1]
            rows.append(("", "", section, "", ""))
            wrong.append(False)
        name = f"  {found[2]}" if found else field.name
        offset = f"{'! ' if field.problem else ''}{field.offset}"
        rows.append((offset, _bytes(field.data), name, cut(clean(field.value), 40), field.note))
        wrong.append(field.problem)
    header, *lines = text_table(HEADER, rows, right=frozenset({0}), limit=view.width)
    shown = [view.paint(line, "error" if bad else "") for line, bad in zip(lines, wrong, strict=True)]
    count = len(telegram.data)
    title = f"{view.paint(telegram.kind, 'bold')}, {quantity(count, 'byte')}"
    return "\n".join([title, view.paint(header, "dim"), *shown]) + "\n"


def _bytes(data: bytes) -> str:
    text = data[:_SHOWN].hex(" ").upper()
    return f"{text} ..." if len(data) > _SHOWN else text


def telegram_data(telegram: DecodedTelegram) -> dict[str, Any]:
    """One telegram as plain data."""
    return {
        "kind": telegram.kind,
        "ok": telegram.ok,
        "hex": telegram.data.hex().upper(),
        "length": len(telegram.data),
        "fields": [
            {
                "offset": f.offset,
                "length": len(f.data),
                "hex": f.data.hex().upper(),
                "name": f.name,
                "value": f.value,
                "meaning": f.note,
                "problem": f.problem,
            }
            for f in telegram.fields
        ],
        "problems": [{"offset": offset, "message": message} for offset, message in telegram.problems],
    }
