"""Offsets that an export states of its members, against the layout that is computed of them.

Exports with read-only attributes have ``Offset`` at each member of a block with standard access, an informative
IntegerAttribute in bits (so a public reader of such documents describes it; of members inside a structure it is not
said from where it counts, so that from the block and that from the structure are taken).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Note, Severity, Span
from plcgen.s7.layout.layout import layout_block, locate
from plcgen.s7.xml.reading.documents import KINDS
from plcgen.s7.xml.reading.xml import child, children, local, span, text

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

    from plcgen.s7.types.blocks import Block

MAX_DEPTH = 64
_SHOWN = 5
Stated = tuple[str, str, int, Span]
"""Path of the structure around a member, its own path, bits, place in the document."""


def compare_offsets(
    blocks: Iterable[Block], types: Mapping[str, Block], documents: Mapping[str, Mapping[str, Sequence[Stated]]]
) -> tuple[list[Diagnostic], int]:
    """PG838 for each block whose export states other offsets than the layout has, and how many offsets agree.

    ``documents`` are the stated offsets of blocks by file and name.
    """
    found: list[Diagnostic] = []
    agreed = 0
    for block in blocks:
        stated = documents.get(block.span.file if block.span else "", {}).get(block.name, ())
        if not stated or block.optimized:
            continue
        try:
            layout = layout_block(block, types)
        except DiagnosticError:
            continue
        wrong: list[tuple[str, int, int, Span]] = []
        for above, path, bits, place in stated:
            try:
                own, base = locate(layout, path).offset, locate(layout, above).offset if above else 0
            except KeyError:
                continue
            if bits in {own, own - base}:
                agreed += 1
            else:
                wrong.append((path, bits, own, place))
        if wrong:
            path, bits, own, place = wrong[0]
            message = f"{path} of {block.name} lies at {_place(bits)} in the export, at {_place(own)} here"
            notes = [Note(f"{name}: {_place(there)}, here {_place(here)}", where)
                     for name, there, here, where in wrong[1 : _SHOWN + 1]]  # fmt: skip
            help_ = "the layout of this block is not to be relied on: please report it with the declaration"
            found.append(Diagnostic("PG838", message, place, Severity.WARNING, help=help_, notes=tuple(notes)))
    return found, agreed


def _place(bits: int) -> str:
    return f"{bits // 8}.{bits % 8}"


def document_offsets(file: str, root: Element) -> dict[str, list[Stated]]:
    """Paths, bits and places by the name of the block."""
    if all(attribute.get("Name") != "Offset" for attribute in root.iter("{*}IntegerAttribute")):
        return {}
    return {
        text(child(child(element, "AttributeList"), "Name")).strip(): list(_offsets(element, file))
        for element in children(root)
        if local(element) in KINDS
    }


def _offsets(element: Element, file: str) -> Iterator[Stated]:
    interface = child(child(child(element, "AttributeList"), "Interface"), "Sections")
    pending = deque(("", member, 0) for section in children(interface) for member in children(section, "Member"))
    while pending:
        prefix, member, depth = pending.popleft()
        path = f'{prefix}"{member.get("Name", "")}"'
        for attribute in children(child(member, "AttributeList")):
            value = text(attribute).strip()
            if attribute.get("Name") == "Offset" and value.isdecimal() and len(value) < 10:
                yield prefix.removesuffix("."), path, int(value), span(member, file)
        if depth < MAX_DEPTH and member.get("Datatype") == "Struct":
            pending += [(f"{path}.", inner, depth + 1) for inner in children(member, "Member")]
