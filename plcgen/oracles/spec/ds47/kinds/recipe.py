"""``write_recipe``, ``read_recipe``, ``compare_recipe``: what would be inputs or outputs are members of a record.

Before anything is sent, a job that writes refuses a record that does not exist (8540) and values outside the limits of
their parameter, NaN and infinity (8541).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from plcgen.oracles.spec.ds47.accesses import JobReader, SpecItem, items
from plcgen.oracles.spec.ds47.kinds.write import writing
from plcgen.oracles.spec.ds47.parameters import WrittenParameter
from plcgen.oracles.spec.ds47.statement import FromRecord, Number, Source, StatedAccess, StatedStep
from plcgen.oracles.spec.ds47.values import counts, number_meant, start_of
from plcgen.oracles.spec.place import NotStatedError


def write_record_steps(job: JobReader) -> Iterator[StatedStep]:
    """The record is written, and what a job that writes does besides."""
    found = [(replace(access, write=True, values=values), name) for access, values, name in _members(job, "write")]
    yield from writing(job, found)


def read_record_steps(job: JobReader) -> Iterator[StatedStep]:
    """The record gets the values of the drive."""
    members = _members(job, "read")
    yield StatedStep("reads into the record", tuple(replace(a, output=name) for a, _, name in members))


def compare_record_steps(job: JobReader) -> Iterator[StatedStep]:
    """Values that differ from the record are listed."""
    yield StatedStep("compares", tuple(replace(a, values=values) for a, values, _ in _members(job, "compare")))


def of_job(job: Mapping[str, Any]) -> str:
    """The recipe of a job; empty if it has none."""
    return next((str(job[key]) for key in ("write_recipe", "read_recipe", "compare_recipe") if key in job), "")


def records(recipe: Mapping[str, Any]) -> int:
    """How many records there are."""
    given = recipe["records"]
    return len(given) if isinstance(given, Mapping) else int(given)


def _members(job: JobReader, service: str) -> Iterator[tuple[StatedAccess, tuple[Source, ...], str]]:
    """Each parameter of the recipe: access, values, name of the member."""
    key = str(job.job[f"{service}_recipe"])
    recipe = (job.source.data.get("recipes") or {}).get(key)
    if recipe is None:
        raise NotStatedError(f"there is no recipe {key}")
    given = recipe["records"]
    named = list(given.values()) if isinstance(given, Mapping) else [{}] * int(given)
    for item in items(recipe["parameters"], job.source, ("recipes", key, "parameters")):
        parameter = job.parameter(item)
        name = job.name(item, parameter)
        access = job.access(item, parameter, write=service == "write", output="")
        yield access, _values(job, item, parameter, key, name, named), name


def _values(
    job: JobReader,
    item: SpecItem,
    parameter: WrittenParameter,
    recipe: str,
    name: str,
    records: list[Mapping[str, Any]],
) -> tuple[Source, ...]:
    delivered = [_delivered(job, item, parameter, name, record) for record in records]
    ends = (parameter.facts.get("min"), parameter.facts.get("max"))
    low, high = (None if end is None else counts(end, parameter.facts) for end in ends)
    whole = parameter.count == 1
    return tuple(
        FromRecord(recipe, name, None if whole else parameter.first + at, tuple(v[at] for v in delivered), low, high)
        for at in range(parameter.count)
    )


def _delivered(
    job: JobReader, item: SpecItem, parameter: WrittenParameter, name: str, record: Mapping[str, Any]
) -> list[Number | str]:
    """The values of one record: its own, else the start value."""
    for key, value in (record or {}).items():
        if str(key) in {name, item.text, str(parameter.facts.get("name"))} or _same(job, str(key), parameter):
            given = list(value) if isinstance(value, list | tuple) else [value] * parameter.count
            return [number_meant(one, parameter, job.drive.profile) for one in given]
    return start_of(parameter, item.settings.get("start"), job.drive.profile)


def _same(job: JobReader, key: str, parameter: WrittenParameter) -> bool:
    try:
        other = job.drive.catalogue.read(key)
    except NotStatedError:
        return False
    return (other.number, other.first, other.count) == (parameter.number, parameter.first, parameter.count)


STATEMENTS = {
    "write_recipe": write_record_steps,
    "read_recipe": read_record_steps,
    "compare_recipe": compare_record_steps,
}
