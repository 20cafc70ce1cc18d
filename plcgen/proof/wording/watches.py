"""Watch tables: every signal and value of a job has a row, how it is shown, and what the table offers to write."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Sequence

from plcgen.base.diagnostics import DiagnosticError
from plcgen.project.nouns import Project
from plcgen.proof.folder import Folder
from plcgen.proof.wording.model import Shown, Wording
from plcgen.proof.wording.sheet import literal_bytes
from plcgen.s7.layout.image import image
from plcgen.s7.layout.layout import Entry, Layout, layout_block, locate
from plcgen.s7.types.address import Address
from plcgen.s7.types.blocks import Block
from plcgen.s7.types.data_types import Elementary, inner_members
from plcgen.s7.types.literals import LiteralError

_PLACE = re.compile(r'"([^"]+)"(?:\.(.+))?')
_COLUMNS = 4
_SHOWN = frozenset(
    {"BOOL", "BYTE", "WORD", "DWORD", "CHAR", "SINT", "USINT", "INT", "UINT", "DINT", "UDINT", "LINT", "ULINT", "REAL"}
    | {"LREAL"}
)
"""Types of members that have a row; times are set by the program."""
Said = tuple[int, str]


class Watches:
    """The watch tables of a folder; layouts and start values are made once."""

    def __init__(self, project: Project, folder: Folder, stated: Sequence[Wording]) -> None:
        self.folder, self.stated = folder, stated
        self.layouts: dict[str, Layout] = {}
        self.images: dict[str, bytes] = {}
        triggers = [pair for job in project.jobs for pair in job.trigger.items()]
        self.flags = {place.text(percent=False): signal for signal, place in triggers if isinstance(place, Address)}
        self.own = {place.text(): signal for signal, place in triggers if not isinstance(place, Address)}
        self.seen: set[tuple[str, str]] = set()

    def table(self, text: str) -> Iterator[Said]:
        """One table; the places themselves are looked at elsewhere."""
        lines = text.splitlines()
        rows = list(csv.reader(lines, delimiter=";" if lines and ";" in lines[0] else ","))
        names = {row[0] for row in rows[1:] if row}
        for number, row in enumerate(rows[1:], 2):
            if len(row) == _COLUMNS:
                yield from ((number, what) for what in self.row(*row))
        for block, job in sorted({(found[1], found[2].partition(".")[0]) for found in map(_PLACE.fullmatch, names)
                                  if found is not None and found[2]}):  # fmt: skip
            missing = [name for name in self.watched(block, job) if name not in names]
            yield from ((len(lines), f"there is no row for {name}") for name in missing)

    def row(self, name: str, address: str, shown: str, modify: str) -> Iterator[str]:
        """Display format and modify value of a place."""
        wanted, entry = self.wanted(name, address)
        if wanted is None:
            return
        if shown.upper() != wanted.format.upper():
            yield f"{name} is shown as {shown}, not as {wanted.format}"
        if wanted.modify is not None:
            if modify != wanted.modify:
                yield f"{name} is set to {modify or 'nothing'}, not to {wanted.modify or 'nothing'}"
        elif entry is not None and not self.starts_with(name, entry, modify):
            yield f"{name} is set to {modify or 'nothing'}, which is not its start value"

    def wanted(self, name: str, address: str) -> tuple[Shown | None, Entry | None]:
        """How a place is shown."""
        signal = self.own.get(name) or self.flags.get(address, "")
        if signal:
            return Shown("Hex" if signal == "status" else "Bool", ""), None
        found = _PLACE.fullmatch(name)
        block = self.folder.text.get(found[1].upper()) if found else None
        if found is None or block is None:
            return None, None
        try:
            entry = locate(self.layout(block), found[2] or "")
        except (KeyError, DiagnosticError):
            return None, None
        path = (found[2] or "").split(".")
        type_ = entry.type.name if isinstance(entry.type, Elementary) else ""
        return next((said for one in self.stated if (said := one.shown(block, path, type_)) is not None), None), entry

    def layout(self, block: Block) -> Layout:
        """Layout of a block."""
        if block.name not in self.layouts:
            self.layouts[block.name] = layout_block(block, self.folder.text)
        return self.layouts[block.name]

    def starts_with(self, name: str, entry: Entry, modify: str) -> bool:
        """Whether a modify value is what the place has at start."""
        block = self.folder.text[name.split('"')[1].upper()]
        if block.name not in self.images:
            try:
                self.images[block.name] = bytes(image(block, self.folder.text))
            except (DiagnosticError, LiteralError):
                self.images[block.name] = b""
        held = self.images[block.name][entry.byte : entry.byte + entry.size // 8]
        return literal_bytes(modify, len(held)) in {None, held}

    def watched(self, name: str, job: str) -> Iterator[str]:
        """Rows that the structure of a job must have: one for each elementary member of it."""
        block = self.folder.text.get(name.upper())
        for member in block.members if block is not None else ():
            inner = inner_members(member.type) if member.name == job else ()
            yield from (f'"{name}".{job}.{one.name}' for one in inner if getattr(one.type, "name", "") in _SHOWN)
