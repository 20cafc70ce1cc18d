"""Telegrams of a program against the jobs of a spec: the same station, the same kind of request, no other addresses."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from plcgen.base.diagnostics import Severity
from plcgen.base.diagnostics.counting import shortlist
from plcgen.ppi.audit.model import FoundTelegram
from plcgen.ppi.plan.nouns import PlannedMaster, PpiJob, PpiPlan
from plcgen.ppi.wire.address import address_text
from plcgen.ppi.wire.areas import TransportSize
from plcgen.ppi.wire.model import (
    REQUEST,
    FixedFrame,
    Item,
    ReadRequest,
    RunRequest,
    StopRequest,
    VariableFrame,
    WriteRequest,
)

_Bits = frozenset[tuple[int, int, int]]
"""Area, data block, and bit or element."""


def match_jobs(plan: PpiPlan, telegrams: Iterable[FoundTelegram]) -> None:
    """Find the job of every request; a request of no job is a warning."""
    for found in telegrams:
        if any(problem.code != "PG671" for problem in found.findings.found):
            continue  # what it asks for is not what its author meant
        frame = found.frame
        if isinstance(frame, FixedFrame) or not isinstance(frame, VariableFrame) or not frame.function & REQUEST:
            _known(plan, found)
            continue
        kind, items = _request(found)
        if not kind:
            continue
        masters = _known(plan, found)
        jobs = [job for master in masters for job in master.jobs if job.station.address == frame.destination]
        found.job = next((job for job in jobs if job.kind == kind and bits(items) <= _job_bits(job)), None)
        if found.job is None and masters and not _harmless(masters, found):
            what = shortlist([address_text(item) for item in items], 4)
            message = f"{found.title}: a telegram that {_VERBS[kind]} {what or ''}".rstrip()
            message += f" of station {frame.destination}; no job of the spec does"
            _warn(found, message, "add the job to the spec, or the address to the job")


_VERBS = {"read": "reads", "write": "writes", "run": "starts the CPU", "stop": "stops the CPU"}


def _request(found: FoundTelegram) -> tuple[str, tuple[Item, ...]]:
    """Kind of a job and the items of the telegram; no kind if the spec has no such jobs."""
    pdu = found.pdu
    if isinstance(pdu, ReadRequest):
        return "read", pdu.items
    if isinstance(pdu, WriteRequest):
        return "write", tuple(entry.item for entry in pdu.items)
    if isinstance(pdu, RunRequest | StopRequest):
        return "run" if isinstance(pdu, RunRequest) else "stop", ()
    return "", ()


def bits(items: Iterable[Item]) -> _Bits:
    """Every bit that items cover; timers and counters by their elements."""
    return frozenset(key for item in items for key in _item_bits(item))


def _item_bits(item: Item) -> Iterator[tuple[int, int, int]]:
    bit_count = 1 if item.size == TransportSize.BIT else 8 * item.octets
    count = item.count if item.by_element else bit_count
    return ((item.area, item.db, item.address + n) for n in range(count))


def _job_bits(job: PpiJob) -> _Bits:
    return bits(wired.item for telegram in job.telegrams for wired in telegram.items)


def _harmless(masters: Sequence[PlannedMaster], found: FoundTelegram) -> bool:
    """The read that tells a station the frame count bit."""
    return any(telegram.request.data == found.data for one in masters for telegram in one.syncs)


def _known(plan: PpiPlan, found: FoundTelegram) -> list[PlannedMaster]:
    """Masters that have the station; none is a warning."""
    frame = found.frame
    if not isinstance(frame, FixedFrame | VariableFrame) or not frame.function & REQUEST:
        return []
    at = 4 if isinstance(frame, VariableFrame) else 1
    if found.start + at not in found.memory.given:
        return list(plan.masters)
    masters = [m for m in plan.masters if any(station.address == frame.destination for station in m.stations)]
    if not masters:
        stations = sorted({station.address for master in plan.masters for station in master.stations})
        message = f"{found.title}: the telegram goes to station {frame.destination}, which the spec does not have"
        _warn(found, message, f"the stations are {', '.join(map(str, stations))}")
    return masters


def _warn(found: FoundTelegram, message: str, help_: str) -> None:
    found.findings.report("PG676", message, found.span(0), help_, severity=Severity.WARNING)
