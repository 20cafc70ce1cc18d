"""What has drifted: two versions of a catalogue, or a list of a drive against what a spec does with that drive."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from plcgen.ds47 import guards
from plcgen.ds47.catalogue.lists import ListedParameter, cell_text
from plcgen.ds47.catalogue.pages import label, told_value
from plcgen.ds47.device import Device, facts, limit_text
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan, Use
from plcgen.ds47.wire.formats import FormatKind, unpack_values

EQUAL, DEVIATES, MISSING, OUTSIDE = "equal", "deviates", "not in the list", "outside"
UNREADABLE, UNKNOWN, UNCOMPARED = "not readable", "no value", "not compared"
DRIFTED = {DEVIATES, MISSING, OUTSIDE, UNREADABLE}
"""What is a finding. Without a value nothing can be said: not every list has one of each parameter."""
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
    return f"{told_value(value)} ({grade})" if grade else ""


def drift(
    plan: DrivePlan, drive: str, listed: Mapping[int, ListedParameter], silent: Container[int] = ()
) -> Iterator[DriftRow]:
    """Every parameter that a job accesses in a drive, against the list of that drive.

    A list rounds its values; sources and texts are not compared. Of ``silent`` numbers it says nothing.
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
    wanted = _constants(use)
    shown = ", ".join(f"{value:g}" for value in wanted)
    if use.bits:
        shown = ", ".join(str(int(any(bit.data))) for bit in use.bits if bit.constant)
    if one is None:
        return DriftRow(use.label, job.key, shown, "", MISSING)
    bounds = f" ({limit_text(one.minimum)}..{limit_text(one.maximum)})"
    bounds = "" if one.minimum is None and one.maximum is None else bounds
    values = [one.values.get(index) for index in range(use.subindex, use.subindex + max(len(wanted), 1))]
    told = ", ".join(_told_value(value) for value in values) + bounds
    verdict = _of_bits(use, values[0]) if use.bits else _verdict(use, one, wanted, values)
    return DriftRow(use.label, job.key, shown, told.strip(", "), verdict)


def _told_value(value: float | str | None) -> str:
    return "" if value is None else cell_text(value)[:40] if isinstance(value, str) else f"{value:g}"


def _verdict(use: Use, one: ListedParameter, wanted: Sequence[float], values: Sequence[float | str | None]) -> str:
    """The worst that is to be said of the elements of an access."""
    if not wanted:
        return UNCOMPARED if (use.writes or use.compared) and use.constant else EQUAL
    low, high = one.minimum, one.maximum
    if any((low is not None and value < low) or (high is not None and value > high) for value in wanted):
        return OUTSIDE
    if use.parameter.pnu in guards.SET_BACK:
        return UNKNOWN
    verdicts = {_of_value(number, value) for number, value in zip(wanted, values, strict=True)}
    return next(verdict for verdict in (DEVIATES, UNREADABLE, UNKNOWN, EQUAL) if verdict in verdicts)


def _of_value(wanted: float, value: float | str | None) -> str:
    if value is None:
        return UNKNOWN
    if isinstance(value, str):
        return UNREADABLE
    return EQUAL if abs(value - wanted) <= _LISTED * max(abs(wanted), abs(value)) else DEVIATES


def _of_bits(use: Use, value: float | str | None) -> str:
    """Whether a number of a list has those bits that are constants."""
    wanted = [(bit.bit or 0, any(bit.data)) for bit in use.bits if bit.constant]
    if not wanted:
        return EQUAL
    if value is None:
        return UNKNOWN
    if isinstance(value, str) or not value.is_integer():
        return UNREADABLE
    return EQUAL if all(bool(int(value) >> number & 1) is on for number, on in wanted) else DEVIATES


def _constants(use: Use) -> Sequence[float]:
    """The values that a job writes or wants, if they are numbers and no inputs."""
    if (
        use.bits
        or not ((use.writes or use.compared) and use.constant)
        or use.format.kind not in _NUMERIC
        or use.sources
    ):
        return []
    return [value for value in unpack_values(use.format, use.count, use.data) if isinstance(value, int | float)]
