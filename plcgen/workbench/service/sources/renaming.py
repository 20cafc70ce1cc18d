"""Another name for a block or a member, in every source of the folder that names it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.s7.read.generated import foreign_files
from plcgen.s7.types.names import check_name, is_identifier
from plcgen.workbench.service.results import Edit
from plcgen.workbench.service.sources.names import Meant, definition, meant_at, members_of
from plcgen.workbench.service.sources.references import MOST, source_references

if TYPE_CHECKING:
    from collections.abc import Sequence

    from plcgen.s7.types.data_types import Member
    from plcgen.workbench.service.documents import Document
    from plcgen.workbench.service.sources.state import Sources
    from plcgen.workbench.service.sources.version import SourceState

BROKEN = "PG801"
"""A text that is no SCL: what is named behind the mistake may not be found."""


def name_place(state: SourceState, line: int, column: int) -> Span | None:
    """Where the name stands that would be changed, without ``#`` and quotes; None where no source declares it."""
    found = meant_at(state, state.offset(line, column))
    return None if found is None or definition(state, line, column) is None else _bare(state.document, found[1])


def rename(sources: Sources, document: Document, line: int, column: int, new: str) -> tuple[Edit, ...]:
    """Edits that give what is named at a place another name.

    Raises:
        DiagnosticError: why that cannot be done.
    """
    state, own = sources.at(document, line)
    here = Span(document.file, line, column, line, column)
    found, home = meant_at(state, state.offset(own, column)), definition(state, own, column)
    if found is None:
        raise _refused("there is no name that could be changed", here, "put the cursor on a block or a variable")
    meant, place = found[0], sources.real(found[1])
    if home is None:
        raise _refused("it comes with the system, not from a source of this folder", place, "choose another name")
    new = new.strip().removeprefix("#").strip('"')
    problem = check_name(new, toolchain_is_v5=False, role="symbol" if meant.member is None else "identifier")
    if problem is not None:
        raise _refused(f'"{new}" is not a name here: {problem}', place, "choose another name")
    _expect_free(sources, state, meant, new, place)
    places = source_references(sources, document, line, column)
    if len(places) >= MOST:
        raise _refused(f"it is named at {MOST} places or more", place, "change it with the tools of the TIA Portal")
    _expect_ours(sources, places)
    return tuple(edit for each in places if (edit := _edit(sources, each, new)) is not None)


def _expect_free(sources: Sources, state: SourceState, meant: Meant, new: str, place: Span) -> None:
    """The name is free where it is declared, and what is renamed is declared once."""
    head = (meant.owner or (meant.root.name,))[0].upper()
    files = dict.fromkeys([state.document.path, *sources.files()])
    homes = [path for path in files if any(one.name.upper() == head for one in sources.blocks_of(path))]
    if len(homes) > 1:
        both = " and ".join(path.name for path in homes[:2])
        raise _refused(f'"{head}" is declared more than once: {both}', place, "open the folder of one program alone")
    if new.upper() == (meant.root.name if meant.member is None else meant.member.name).upper():
        return
    if meant.member is None:
        taken = state.types.get(new.upper()) is not None
    else:
        taken = any(one.name.upper() == new.upper() for one in _siblings(state, meant))
    if taken:
        raise _refused(f'there is "{new}" already', place, "choose another name")


def _siblings(state: SourceState, meant: Meant) -> Sequence[Member]:
    """The members beside one: of its block, or of the structure in which it is declared."""
    block = state.types[meant.owner[0]]
    members: Sequence[Member] = block.members
    owner = meant.owner[:1]
    for step in meant.owner[1:]:
        inner = next(one for one in members if one.name.upper() == step)
        owner, members = members_of(inner, owner, state.types)
    return members


def _expect_ours(sources: Sources, places: tuple[Span, ...]) -> None:
    """Every file may be changed: it is in the folder, can be read whole, and is nobody's result."""
    for file, place in {place.file: place for place in reversed(places)}.items():
        path = Path(file)
        if not sources.documents.writable(path):
            raise _refused("it is named in a file outside the workspace", place, "change it there by hand")
        if not foreign_files([path]):
            raise _refused("the file is generated from a spec", place, "change the name in the spec, and generate")
        document = sources.documents.get(path)
        broken = None if document is None else sources.file(document).diagnostics
        if broken is None or any(one.code == BROKEN for one in broken):
            raise _refused("a file that names it cannot be read whole", place, "correct it first")


def _edit(sources: Sources, place: Span, new: str) -> Edit | None:
    """The name at a place: in its quotes if it has any, in new ones if it needs them."""
    document = sources.documents.get(place.file)
    if document is None:
        return None
    inner = _bare(document, place)
    if document.part(place).endswith('"') or is_identifier(new):
        return Edit(inner, new)
    return Edit(inner, f'"{new}"')


def _bare(document: Document, place: Span) -> Span:
    """A place without ``#`` and quotes."""
    text = document.part(place)
    first, last = place.column, place.end_column
    if text.startswith("#"):
        text, first = text[1:], first + 1
    if len(text) > 1 and text[0] == text[-1] == '"':
        first, last = first + 1, last - 1
    return Span(place.file, place.line, first, place.end_line, last)


def _refused(message: str, place: Span, help_: str) -> DiagnosticError:
    return DiagnosticError([Diagnostic("PG901", message, place, help=help_)])
