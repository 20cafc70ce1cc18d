"""What has drifted: two versions of a catalogue, or a list of a drive against what a spec does with that drive."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass, replace

from plcgen.protocols.ds47 import guards
from plcgen.protocols.ds47.catalogue.lists import ListedParameter
from plcgen.protocols.ds47.catalogue.pages import label
from plcgen.protocols.ds47.device import Device, facts
from plcgen.protocols.ds47.plan.nouns import DriveJob, DrivePlan, Use
from plcgen.protocols.ds47.wire.formats import FormatKind, unpack_values

EQUAL, DEVIATES, MISSING, OUTSIDE, UNKNOWN = "equal", "deviates", "not in the list", "outside", "no value"
_NUMERIC = {FormatKind.SIGNED, FormatKind.UNSIGNED, FormatKind.FLOAT}
_LISTED = 1e-6
"""Share of a value that a list may have rounded away."""


@dataclass(frozen=True, slots=True)
class FactChange:
    """A fact of two versions of a catalogue; empty where one of them lacks it. ``grade`` is that of the new one."""

    parameter: str
    fact: str
    old: str
    new: str
    grade: str


@dataclass(frozen=True, slots=True)
class DriftRow:
    """An access of a job and what the list of the drive says about it."""

    parameter: str
    job: str
    wanted: str
    listed: str
    verdict: str


def changes(old: Device, new: Device) -> Iterator[FactChange]:
    """Every fact that differs, by number; a parameter that one of them lacks is one change."""
    for pnu in sorted(old.parameters.keys() | new.parameters.keys()):
        one, two = old.parameters.get(pnu), new.parameters.get(pnu)
        if one is None or two is None:
            known = one or two
            assert known is not None  # noqa: S101 - the number is of one of them
            gone, came = ("", known.title) if one is None else (known.title, "")
            yield FactChange(label(known), "parameter", gone, came, "")
            continue
        before, after = facts(one), facts(two)
        for fact in {**before, **after}:
            had, has = before.get(fact, ("", "")), after.get(fact, ("", ""))
            if had != has:
                yield FactChange(label(two), fact, _told(had), _told(has), has[1])


def _told(fact: tuple[object, str]) -> str:
    value, grade = fact
    text = f"{value:g}" if isinstance(value, float) else str(value)
    return f"{text} ({grade})" if grade else ""


def drift(
    plan: DrivePlan, drive: str, listed: Mapping[int, ListedParameter], silent: Container[int] = ()
) -> Iterator[DriftRow]:
    """Every parameter that a job accesses in a drive, against the list of that drive.

    A list has values of index 0 alone, and rounds them; enumerations and sources are no numbers in it. Of ``silent``
    numbers it says nothing.
    """
    for job in plan.jobs:
        if job.drive.key != drive:
            continue
        for use in job.own:
            if use.verifies is None and use.poll is None and not use.precedes and not use.state:
                row = _row(job, use, listed.get(use.parameter.pnu))
                unsaid = row.verdict == MISSING and use.parameter.pnu in silent
                yield replace(row, verdict=UNKNOWN) if unsaid else row


def _row(job: DriveJob, use: Use, one: ListedParameter | None) -> DriftRow:
    wanted = _constant(use)
    shown = "" if wanted is None else f"{wanted:g}"
    if one is None:
        return DriftRow(use.label, job.key, shown, "", MISSING)
    bounds = "" if one.minimum is None and one.maximum is None else f" ({_limit(one.minimum)}..{_limit(one.maximum)})"
    told = ("" if one.value is None else f"{one.value:g}") + bounds
    if use.bits:
        shown = ", ".join(str(int(any(bit.data))) for bit in use.bits if bit.constant)
        return DriftRow(use.label, job.key, shown, told.strip(), _of_bits(use, one.value))
    if wanted is None:
        return DriftRow(use.label, job.key, "", told.strip(), EQUAL)
    low, high = one.minimum, one.maximum
    if (low is not None and wanted < low) or (high is not None and wanted > high):
        return DriftRow(use.label, job.key, shown, told.strip(), OUTSIDE)
    if one.value is None or use.subindex or use.parameter.pnu in guards.SET_BACK:
        return DriftRow(use.label, job.key, shown, told.strip(), UNKNOWN)
    same = abs(one.value - wanted) <= _LISTED * max(abs(wanted), abs(one.value))
    return DriftRow(use.label, job.key, shown, told.strip(), EQUAL if same else DEVIATES)


def _of_bits(use: Use, value: float | None) -> str:
    """Whether a number of a list has those bits that are constants."""
    wanted = [(bit.bit or 0, any(bit.data)) for bit in use.bits if bit.constant]
    if not wanted:
        return EQUAL
    if value is None or use.subindex or not value.is_integer():
        return UNKNOWN
    return EQUAL if all(bool(int(value) >> number & 1) is on for number, on in wanted) else DEVIATES


def _constant(use: Use) -> float | None:
    """The first value that a job writes or wants, if it is a number and not an input."""
    if (
        use.bits
        or not ((use.writes or use.compared) and use.constant)
        or use.format.kind not in _NUMERIC
        or use.sources
    ):
        return None
    value = unpack_values(use.format, 1, use.data[: use.format.size])[0]
    return value if isinstance(value, int | float) else None


def _limit(limit: float | None) -> str:
    return "" if limit is None else f"{limit:g}"
