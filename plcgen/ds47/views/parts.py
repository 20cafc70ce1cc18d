"""What a kind of job adds to the function block of a job: lines at the places of ``job.scl.j2``, members, constants."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from plcgen.build.nouns import CallerValue, DataBlock, MemberRow, TypeBlock
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan, DriveTelegram
from plcgen.ds47.registry import brought

Constant = tuple[str, int, str]
"""Name, number, text."""


def nothing(*_: object) -> tuple[()]:
    """Nothing for any job."""
    return ()


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockParts:
    """The parts of one kind.

    ``name`` is that of its ``view`` in the templates, ``job.save``; ``telegram`` is what it says of each telegram,
    ``telegram.save``. ``template`` has its lines for every place that it has something for. Of all parts of a job the
    ones with the lowest ``precedence`` come first; the one with the lowest ``ends`` says how the job has ended.

    ``times`` are constants in ms; ``words`` those of status and errors, made of the view. ``inputs`` stand in front of
    the values of the job, ``last_inputs`` behind them, likewise outputs; ``arguments`` are named at every call.
    ``results`` are the comments of ``errors`` and ``errorInfos`` if they may say more than usual.

    ``members`` are names, in lower case, that no value of such a job may have, ``reserved`` those that no value of any
    job may have.

    ``fails``: the job may fail although every telegram was answered well; ``ends_early``: its last telegram is known
    only while it runs; ``counts``: its telegrams are not counted as they are sent; ``takes_inputs``: its lines take the
    inputs over. ``types`` are those of one job, ``shared_types`` and ``shared_data`` are made once for all.
    """

    name: str
    precedence: int
    has: Callable[[DriveJob], bool]
    template: str
    view: Callable[[DrivePlan, DriveJob], Any]
    telegram: Callable[[DrivePlan, DriveJob, DriveTelegram], Any] = nothing
    ends: int = 0
    times: Callable[[DriveJob], Iterable[Constant]] = nothing
    words: Callable[[Any], Iterable[Constant]] = nothing
    inputs: Callable[[DrivePlan, DriveJob], Iterable[CallerValue]] = nothing
    last_inputs: Callable[[DrivePlan, DriveJob], Iterable[MemberRow]] = nothing
    outputs: Callable[[DrivePlan, DriveJob], Iterable[CallerValue]] = nothing
    last_outputs: Callable[[DrivePlan, DriveJob], Iterable[CallerValue]] = nothing
    arguments: Callable[[DriveJob], Iterable[tuple[str, str]]] = nothing
    results: tuple[str, str] | None = None
    members: frozenset[str] = frozenset()
    reserved: frozenset[str] = frozenset()
    fails: bool = False
    ends_early: Callable[[DriveJob], bool] = lambda _: False
    counts: Callable[[DriveJob], bool] = lambda _: False
    takes_inputs: bool = False
    types: Callable[[DrivePlan, DriveJob], Iterable[TypeBlock]] = nothing
    shared_types: Callable[[DrivePlan], Iterable[TypeBlock]] = nothing
    shared_data: Callable[[DrivePlan], Iterable[DataBlock]] = nothing


def all_parts() -> Sequence[BlockParts]:
    """Those of all kinds."""
    return sorted(brought("block", "PARTS"), key=lambda part: part.precedence)


def parts_of(job: DriveJob) -> list[BlockParts]:
    """Those of the block of a job."""
    return [part for part in all_parts() if part.has(job)]
