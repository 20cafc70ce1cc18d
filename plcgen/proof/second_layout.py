"""The layouts of all types and data blocks once more, by a calculator that shares nothing with the first."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError
from plcgen.base.files.files import read_bounded
from plcgen.oracles.offsets import NotKnownError, WrittenBlocks
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.folder import Folder
from plcgen.s7.layout.layout import Layout, layout_block
from plcgen.s7.types.blocks import BlockKind

MAX_SOURCE = 64 * 1024 * 1024


def check_second_layout(folder: Folder) -> Iterator[Check]:
    """One check of all blocks; left out are instances of function blocks, and what one of the two cannot lay out."""
    blocks = [block for block in folder.text.values() if block.kind in {BlockKind.DB, BlockKind.UDT}]
    name, subject = "layouts", "all layouts"
    try:
        known = WrittenBlocks(map(_text, dict.fromkeys(folder.files.values())))
    except (NotKnownError, OSError) as problem:
        yield Check(name, subject, "", Outcome.NOT_RUN, f"not run: the second calculator does not read {problem}")
        return
    places, compared, left = 0, 0, 0
    for block in blocks:
        try:
            layout = layout_block(block, folder.text)  # what is too large for the first is nothing for the second
            found, size = known.places(block.name)
        except (DiagnosticError, NotKnownError):
            left += 1
            continue
        message = _difference(layout, {place.path: place.bit for place in found}, size)
        if message:
            text = f'{block.kind} "{block.name}": {message}'
            yield Check(name, subject, "", Outcome.ERROR, text, Diagnostic("PG640", text, folder.place(block.name)))
            return
        compared, places = compared + 1, places + len(found)
    text = f"{places} members of {compared} types and data blocks"
    text += f"; {left} left out: instances, types that it does not know" if left else ""
    yield Check(name, subject, text, Outcome.OK, "a second calculator puts every member in the same place")


def _difference(layout: Layout, places: dict[str, int], size: int) -> str:
    """The first member that the two put at different places; empty if there is none."""
    for entry in layout.entries:
        other = places.pop(entry.path.replace('"', ""), None)
        if other != entry.offset:
            there = "nowhere" if other is None else f"at {other // 8}.{other % 8}"
            return f"{entry.path} is at {entry.byte}.{entry.bit}, {there} for the second calculator"
    if places:
        return f"the second calculator knows a member {min(places)}"
    return "" if size == layout.size else f"{layout.size} bytes, {size} for the second calculator"


def _text(path: Path) -> str:
    data = read_bounded(path, MAX_SOURCE)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", "replace")
