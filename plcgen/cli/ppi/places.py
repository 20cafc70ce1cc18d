"""Addresses, symbols and values on the command line of the ``ppi`` verbs: all problems at once, each at its word."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import click

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.cli.arguments import ARGUMENTS, Argument, arguments
from plcgen.ppi.wire.errors import PpiError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from plcgen.ppi.client.values import Place
    from plcgen.ppi.symbols import SymbolTable
    from plcgen.ppi.wire.model import Item, ItemWrite
    from plcgen.ppi.wire.profiles import CpuProfile

Callback = TypeVar("Callback", bound=Callable[..., object])
Result = TypeVar("Result")


def cpu_option(verb: Callback) -> Callback:
    """Add ``--cpu``; the parameter is called ``cpu``."""
    return click.option("--cpu", metavar="CPU", help="Refuse addresses that this CPU does not have: 221 ... ST40.")(
        verb
    )


def symbols_option(verb: Callback) -> Callback:
    """Add ``--symbols``; the parameter is called ``symbols``."""
    option = click.option(
        "--symbols", metavar="FILE", help="Symbol table of Micro/WIN as CSV or text: Symbol, Address, Comment."
    )
    return option(verb)


def find_profile(key: str | None) -> CpuProfile | None:
    """Return the CPU of ``--cpu``. Raises DiagnosticError if there is none of that name."""
    if key is None:
        return None
    from plcgen.base.diagnostics.suggest import did_you_mean
    from plcgen.ppi.wire.profiles import profile, profiles

    try:
        return profile(key)
    except KeyError:
        names = list(profiles())
        help_ = f"{did_you_mean(key, names)} known CPUs: {', '.join(names)}".strip()
        raise DiagnosticError([Diagnostic("PG713", f'unknown CPU "{key}"', Span(ARGUMENTS), help=help_)]) from None


def find_symbols(name: str | None) -> SymbolTable | None:
    """Return the table of ``--symbols``. Raises DiagnosticError with everything wrong in it."""
    if name is None:
        return None
    from plcgen.ppi.symbols import load_symbols

    return load_symbols(Path(name))


def read_places(
    words: Sequence[str], symbols: SymbolTable | None, cpu: CpuProfile | None, limit: int | None = None
) -> list[Place]:
    """Read what is to be read; ``limit`` is the longest value. Raises DiagnosticError with every problem."""
    from plcgen.ppi.client.values import parse_place

    def read(argument: Argument) -> Place:
        place = parse_place(argument.text, symbols)
        _require_memory(place.item, cpu)
        _require_length(place.item, limit)
        return place

    return _each(words, read)


def read_assignments(
    words: Sequence[str], symbols: SymbolTable | None, cpu: CpuProfile | None, limit: int | None = None
) -> list[tuple[Place, ItemWrite]]:
    """Read what is to be written, see ``read_places``. Raises DiagnosticError with every problem, overlaps included."""
    from plcgen.ppi.client.values import parse_assignment
    from plcgen.ppi.wire.pack import require_apart

    def read(argument: Argument) -> tuple[Place, ItemWrite]:
        place, entry = parse_assignment(argument.text, symbols)
        _require_memory(place.item, cpu)
        _require_length(place.item, limit)
        return place, entry

    found = _each(words, read)
    try:
        require_apart([place.item for place, _ in found])
    except PpiError as problem:
        raise DiagnosticError(telegram_problems(problem)) from problem
    return found


def _each(words: Sequence[str], read: Callable[[Argument], Result]) -> list[Result]:
    from plcgen.ppi.client.values import PlaceError

    found: list[Result] = []
    problems: list[Diagnostic] = []
    for argument in arguments(words):
        try:
            found.append(read(argument))
        except PlaceError as problem:
            problems.append(Diagnostic(problem.code, problem.message, argument.span, help=problem.help))
    if problems:
        raise DiagnosticError(problems)
    return found


def _require_memory(item: Item, cpu: CpuProfile | None) -> None:
    from plcgen.ppi.client.values import beyond

    error = beyond(item, cpu.sizes, cpu.title) if cpu is not None else None
    if error is not None:
        raise error


def _require_length(item: Item, limit: int | None) -> None:
    from plcgen.ppi.client.values import too_long

    error = too_long(item, limit) if limit is not None else None
    if error is not None:
        raise error


def telegram_problems(problem: PpiError) -> tuple[Diagnostic, ...]:
    """Return what keeps a telegram from being built, as diagnostics without a word to point at."""
    from plcgen.ppi.wire.errors import Kind

    code = {Kind.LIMIT: "PG715"}
    help_ = {Kind.LIMIT: "plcgen ppi read and write, and encode --pack, use as many telegrams as needed"}
    return tuple(
        Diagnostic(code.get(found.kind, "PG716"), found.message, Span(ARGUMENTS), help=help_.get(found.kind, ""))
        for found in problem.violations
    )
