"""Specs of one run: what two of them for one PLC have in common, which the second import would replace."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Note, Report, Severity, Span
from plcgen.base.diagnostics.counting import quantity
from plcgen.base.files.text import read_text
from plcgen.project.composing import compose
from plcgen.project.nouns import BlockRef, Project
from plcgen.project.opening import open_spec
from plcgen.project.rules.numbers import numbered
from plcgen.project.rules.places import by_importance, name_span, number_span

_SHOWN = 3


def same_plc(specs: Sequence[Path]) -> dict[Path, tuple[Diagnostic, ...]]:
    """PG511 and PG513 by spec: it has blocks, devices or ports that an earlier spec for the same PLC has.

    A PLC is known by its name and family. Specs of which nothing can be planned are left to :func:`open_spec`.
    """
    groups: dict[tuple[str, str], list[Path]] = {}
    for path in specs if len(specs) > 1 else ():
        if plc := _plc(path):
            groups.setdefault(plc, []).append(path)
    return {path: found for group in groups.values() if len(group) > 1 for path, found in _collisions(group)}


def _plc(path: Path) -> tuple[str, str] | None:
    try:
        composed = compose(read_text(path), path.as_posix(), Report())
    except DiagnosticError:
        return None
    if composed is None or composed.root.kind != "map":
        return None
    name, family = (composed.root.find(("plc", key)).value for key in ("name", "family"))
    return (str(name).strip().casefold(), str(family)) if name else None


def _collisions(specs: Sequence[Path]) -> Iterator[tuple[Path, tuple[Diagnostic, ...]]]:
    names: dict[str, tuple[Project, BlockRef]] = {}
    numbers: dict[tuple[str, int], tuple[Project, BlockRef]] = {}
    partners: dict[str, tuple[Project, Span]] = {}
    for path in specs:
        project = open_spec(path).project
        if project is None:
            continue
        same_name, same_number = list[_Pair](), list[_Pair]()
        for block in by_importance(project.blocks):
            other = names.setdefault(block.name.lower(), (project, block))
            if other[0] is not project:
                same_name.append((block, *other))
        for block in numbered(project):
            other = numbers.setdefault((block.kind, block.number), (project, block))
            if other[0] is not project:
                same_number.append((block, *other))
        found = [_told(project, same_name, same_number)] if same_name or same_number else []
        for address, what, place in chain.from_iterable(plan.protocol.rules().partners(plan) for plan in project.plans):
            owner, theirs = partners.setdefault(address.casefold(), (project, place))
            if owner is not project:
                message = f"{owner.loaded.file} is for the same PLC, and its jobs use {what} too"
                help_ = "make one spec of them: a file with plc of its own that includes both"
                notes = (Note("the other one", theirs),)
                found.append(Diagnostic("PG513", message, place, _severity(project, owner), help=help_, notes=notes))
        if found:
            yield path, tuple(found)


def _severity(project: Project, other: Project) -> Severity:
    # in folders of their own they may be machines with a project each, whose PLC has the name of all
    same = Path(other.loaded.file).parent == Path(project.loaded.file).parent
    return Severity.ERROR if same else Severity.WARNING


_Pair = tuple[BlockRef, Project, BlockRef]
"""A block, and the earlier one with the project that has it."""


def _told(project: Project, names: Sequence[_Pair], numbers: Sequence[_Pair]) -> Diagnostic:
    """One diagnostic for all blocks, at one that the spec speaks of if there is any."""
    pairs, span = (names, name_span) if names else (numbers, number_span)
    block, other, theirs = min(pairs, key=lambda pair: pair[0].path == ("plc",))
    shown = [f'"{pair[0].name}"' if names else f"{pair[0].kind}{pair[0].number}" for pair in pairs]
    first = f'"{block.name}"' if names else f"{block.kind}{block.number}"
    shown = [first, *(each for each in shown if each != first)][:_SHOWN]
    more = ", .." if len(pairs) > _SHOWN else ""
    what = "names" if names else "numbers"
    help_ = (
        "give one of them a plc.prefix; or make one spec of them: a file with plc of its own that includes both; "
        "or give another PLC another plc.name"
        if names
        else "let plc.numbers of one of them start higher; or give another PLC another plc.name"
    )
    return Diagnostic(
        "PG511",
        f'{other.loaded.file} is for the same PLC "{project.name}" and has the {what} of '
        f"{quantity(len(pairs), 'block')} of this spec: {', '.join(shown)}{more}",
        span(project, block),
        _severity(project, other),
        help=help_,
        notes=(Note(f'the other one: "{theirs.name}"', span(other, theirs)),),
    )
