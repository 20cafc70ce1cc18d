"""Rules about where the spec places signals of the calls: absolute flags (bit memory), symbols."""

from __future__ import annotations

from operator import itemgetter
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Note, Span
from plcgen.project.nouns import OwnSymbol, flag_name
from plcgen.project.rules.places import node_at
from plcgen.project.spec import SpecPath
from plcgen.s7.types.address import Address

if TYPE_CHECKING:
    from collections.abc import Iterator

    from plcgen.project.nouns import Project

_Flag = tuple[int, int, str, SpecPath, Address]


def overlap(project: Project) -> Iterator[Diagnostic]:
    """PG403: two signals share bits of the flag memory."""
    flags = sorted(_flags(project), key=itemgetter(0, 1))
    furthest: _Flag | None = None
    for flag in flags:
        if furthest is not None and flag[4].overlaps(furthest[4]):
            earlier, later = sorted((furthest, flag), key=itemgetter(1))
            yield Diagnostic(
                "PG403",
                f"{later[4]} ({later[2]}) overlaps {earlier[4]} ({earlier[2]})",
                _span(project, later[3]),
                help="one signal would overwrite the other: use another address",
                notes=(Note(f"{earlier[4]} is used here", _span(project, earlier[3])),),
            )
        if furthest is None or flag[4].offset + flag[4].width_bits > furthest[4].offset + furthest[4].width_bits:
            furthest = flag


def symbols(project: Project) -> Iterator[Diagnostic]:
    """PG403 and PG404: two signals have one symbol; a symbol is a block that plcgen makes."""
    made = {block.name.lower(): block for block in project.blocks}
    first: dict[str, tuple[str, Span]] = {}
    for job in project.jobs:
        for signal, symbol in job.trigger.symbols():
            span = _span(project, (*job.path, "trigger", signal))
            block = made.get(symbol.name.lower())
            if block is not None:
                message = f'{symbol} ({signal} of {job.key}) is in {block.kind} "{block.name}", which plcgen generates'
                help_ = "name a tag or data block of your own program, or leave the signal out"
                yield Diagnostic("PG404", message, span, help=help_)
            known, place = first.setdefault(symbol.text().lower(), (f"{signal} of {job.key}", span))
            if place is not span:
                yield Diagnostic(
                    "PG403",
                    f"{symbol} ({signal} of {job.key}) is also {known}",
                    span,
                    help="one signal would overwrite the other: use another tag",
                    notes=(Note("first use", place),),
                )


def tags(project: Project) -> Iterator[Diagnostic]:
    """PG406: the tag that a flag gets has the name of another one, or of a tag of the user's own program."""
    named = [(job, signal, flag) for job in project.jobs for signal, flag in job.trigger.items()]
    first: dict[str, tuple[str, Span]] = {}
    for job, signal, flag in named:
        if isinstance(flag, OwnSymbol) and not flag.members:
            place = _span(project, (*job.path, "trigger", signal))
            first.setdefault(flag.name.lower(), (f"a tag of your own program, {signal} of {job.key}", place))
    for job, signal, flag in named:
        if not isinstance(flag, Address):
            continue
        name, span = flag_name(project.prefix, job.member, signal), _span(project, (*job.path, "trigger", signal))
        what, place = first.setdefault(name.lower(), (f"{signal} of {job.key}", span))
        if place is not span:
            yield Diagnostic(
                "PG406",
                f'the tag of {flag} ({signal} of {job.key}) is called "{name}", and so is {what}',
                span,
                help="rename one of the jobs",
                notes=(Note("first use", place),),
            )


def flags_out_of_range(project: Project) -> Iterator[Diagnostic]:
    """PG404: a flag lies behind the end of the CPU's flag memory."""
    size = project.target.flag_bytes
    for _, _, signal, path, address in _flags(project):
        if address.offset + address.width_bits > size * 8:
            yield Diagnostic(
                "PG404",
                f"{address} ({signal}) does not exist: "
                f"the flags of an {project.target.family.upper()} end with MB{size - 1}",
                _span(project, path),
                help="use a lower address; smaller CPUs have fewer flags than the largest one of the family",
            )


def _flags(project: Project) -> Iterator[_Flag]:
    """Every flag: first bit, position in the spec, signal, path, address."""
    found = ((job, signal, address) for job in project.jobs for signal, address in job.trigger.flags())
    for position, (job, signal, address) in enumerate(found):
        yield address.offset, position, f"{signal} of {job.key}", (*job.path, "trigger", signal), address


def _span(project: Project, path: SpecPath) -> Span:
    node = node_at(project, path) or node_at(project, path[:-1])
    return node.span if node is not None else project.loaded.span(path)
