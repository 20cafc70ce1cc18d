"""The statement about all drive jobs of a spec."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from types import MappingProxyType
from typing import Any

from plcgen.oracles.spec.ds47.accesses import JobReader, camel
from plcgen.oracles.spec.ds47.drives import KnownDrive, known_drives
from plcgen.oracles.spec.ds47.kinds import messages, recipe, save
from plcgen.oracles.spec.ds47.settings import outside_signals, restores, times
from plcgen.oracles.spec.ds47.statement import StatedJob, StatedStep, Statement, Unstated
from plcgen.oracles.spec.place import NotStatedError, SpecSource, milliseconds, texts

StatesKind = Callable[[JobReader], Iterator[StatedStep]]
"""What a kind of job demands, step by step."""


@cache
def shipped_statements() -> Mapping[str, StatesKind]:
    """Statements by the key that names the kind: the ``STATEMENTS`` of every module of ``kinds``, which are found."""
    folder = import_module("plcgen.oracles.spec.ds47.kinds")
    modules = [import_module(f"{folder.__name__}.{one.name}") for one in iter_modules(folder.__path__)]
    return MappingProxyType({key: steps for one in modules for key, steps in one.STATEMENTS.items()})


WRITERS = frozenset({"write", "write_recipe"})
"""``save`` beside one of them belongs to it."""


@dataclass(frozen=True, slots=True)
class _Entry:
    """A job of the spec: its kind, and its keys."""

    key: str
    kind: str
    job: Mapping[str, Any]


def state_jobs(
    source: SpecSource,
    more: Mapping[str, StatesKind] = MappingProxyType({}),
    known: Mapping[str, KnownDrive] | None = None,
) -> Statement:
    """State every job; ``more`` are kinds of others by their keys, ``known`` the drives if they were read before."""
    kinds = {**more, **shipped_statements()}
    drives = known_drives(source) if known is None else known
    jobs: list[StatedJob] = []
    unstated: list[Unstated] = []
    for key, job in (source.data.get("jobs") or {}).items():
        entry = _Entry(str(key), kind_of(job, kinds), job)
        try:
            jobs += job_on_drives(entry, source, drives, kinds)
        except (NotStatedError, KeyError, TypeError, ValueError) as problem:
            unstated.append(Unstated(entry.key, entry.kind, source.place(("jobs", key)), str(problem)))
    prefix = source.data["plc"].get("prefix", "")
    return Statement(tuple(jobs), tuple(unstated), tuple(drive.stated for drive in drives.values()), prefix)


def kind_of(job: Mapping[str, Any], kinds: Mapping[str, StatesKind]) -> str:
    """The key that says what the job does; empty if nobody knows it."""
    return next((kind for kind in kinds if kind in job and not (kind == "save" and WRITERS & set(job))), "")


def job_on_drives(
    entry: _Entry, source: SpecSource, drives: Mapping[str, KnownDrive], kinds: Mapping[str, StatesKind]
) -> Iterator[StatedJob]:
    """One job on each of its drives."""
    if entry.kind not in kinds:
        raise NotStatedError("no statement says what jobs of this kind demand")
    asked = entry.job["drive"]
    keys = [asked] if isinstance(asked, str) else asked
    several = len(keys) > 1
    for key in keys:
        if key not in drives:
            raise NotStatedError(f"there is no drive {key}")
        reader = JobReader(source, entry.job, ("jobs", entry.key), drives[key])
        steps = tuple(kinds[entry.kind](reader))
        own, restore = times(entry.job), restores(entry.job)
        polling = sum(step.limit_ms + step.interval_ms for step in steps if step.pause_first)
        timeout = own.timeout_ms * (2 if restore else 1) + polling
        saves = entry.job.get("save")
        yield StatedJob(
            key=entry.key,
            kind=entry.kind,
            place=source.place(reader.way),
            drive=drives[key].stated,
            member=camel(f"{entry.key}_{key}" if several else entry.key),
            steps=steps,
            timeout_ms=timeout,
            pause_ms=own.pause_ms,
            retries=own.counted(own.timeout_ms if restore else timeout),
            signals=tuple(outside_signals(entry.job)),
            wear_ms=save.distance_ms(saves) if save.saves(saves) else 0,
            cycle_ms=milliseconds(entry.job.get("cycle"), 0),
            restore=restore,
            verify=entry.job.get("verify") == "readback",
            comments=texts(entry.job.get("comment")),
            **_of_kind(entry, source),
        )


def _of_kind(entry: _Entry, source: SpecSource) -> dict[str, Any]:
    """What only jobs with messages or recipes have."""
    name = recipe.of_job(entry.job)
    if name:
        return {"recipe": name, "records": recipe.records(source.data["recipes"][name])}
    if entry.kind in messages.NUMBERS:
        given = entry.job[entry.kind]
        return {"listing": messages.stated_list(entry.kind, given), "tries": messages.tries(given)}
    return {}
