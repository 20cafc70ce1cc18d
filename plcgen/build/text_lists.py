"""Text lists of an HMI as files: the workbook and the documents that the TIA Portal imports, and CSV for others.

What these formats look like was read in public exports and descriptions; docs/hmi.md names them.
"""

from __future__ import annotations

import html
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from plcgen.base.display.table import csv_table
from plcgen.base.display.workbook import workbook_bytes
from plcgen.build.document import Document
from plcgen.build.environment import RenderedFile, render

NO_TEXT = "<No value>"
"""What the TIA Portal writes for a text that there is not."""
_WORKBOOK_VERSION = "1.1"
"""Custom property TIA_Version of three of four exports."""


@dataclass(frozen=True, slots=True)
class TextEntry:
    """A value, from 0, and its text by culture."""

    value: int
    texts: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class TextList:
    """A text list: values are different and ascending."""

    name: str
    entries: Sequence[TextEntry]


TextListWriter = Callable[[Sequence[TextList], Sequence[str], str], list[RenderedFile]]
"""Lists, cultures and the version of the TIA Portal become files."""


def workbook(lists: Sequence[TextList], cultures: Sequence[str], _version: str) -> list[RenderedFile]:
    """One workbook with the sheets TextList and TextListEntry, as Import of the editor of text lists takes it."""
    head = ["Name", "ListRange", *(f"Comment [{culture}]" for culture in cultures)]
    names = [[one.name, "Decimal", *(NO_TEXT for _ in cultures)] for one in lists]
    entries = [
        ["Name", "Parent", "DefaultEntry", "Value", *(f"Text [{culture}]" for culture in cultures), "FieldInfos"]
    ]
    for one in lists:
        for number, entry in enumerate(one.entries, 1):
            texts = [entry.texts.get(culture, NO_TEXT) for culture in cultures]
            entries.append([f"Text_list_entry_{number}", one.name, "", str(entry.value), *texts, ""])
    sheets = {"TextList": [head, *names], "TextListEntry": entries}
    return [RenderedFile("HMITextLists.xlsx", workbook_bytes(sheets, {"TIA_Version": _WORKBOOK_VERSION}))]


def documents(lists: Sequence[TextList], cultures: Sequence[str], version: str) -> list[RenderedFile]:
    """One document a list for TIA Openness, which imports text lists of panels that are not Unified ones."""
    return [_document(one, cultures, version) for one in lists]


def _document(one: TextList, cultures: Sequence[str], version: str) -> RenderedFile:
    numbers = iter(range(1, 1_000_000))

    def view(entry: TextEntry) -> dict[str, Any]:
        own, text = next(numbers), next(numbers)
        texts = [
            {"id": f"{next(numbers):X}", "culture": name, "text": f"<body><p>{html.escape(found)}</p></body>"}
            for name in cultures
            if (found := entry.texts.get(name)) is not None
        ]
        return {"id": f"{own:X}", "text_id": f"{text:X}", "value": entry.value, "texts": texts}

    entries = [view(entry) for entry in one.entries]
    whole = {"version": version, "name": one.name, "entries": entries}
    return render(Document(f"{one.name}.xml", "simaticml/textlist.xml.j2", whole))


def _table(lists: Sequence[TextList], cultures: Sequence[str], _version: str) -> list[RenderedFile]:
    """One table with every entry: list, value, the same in hexadecimal digits, a column for each culture."""
    rows = [
        (one.name, str(entry.value), f"{entry.value:04X}", *(entry.texts.get(culture, "") for culture in cultures))
        for one in lists
        for entry in one.entries
    ]
    text = csv_table(("list", "value", "hex", *cultures), rows, ";")
    return [RenderedFile("text_lists.csv", text.encode("utf-8-sig"))]


WRITERS: Mapping[str, TextListWriter] = {"xlsx": workbook, "xml": documents, "csv": _table}
