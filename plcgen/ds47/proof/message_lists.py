"""Lists of messages, stated by hand after the manuals: which parameter each column is, what comes first, what is empty.

TIA Portal information system, parameters of SINAMICS S210 (r0945): indexes 0 to 7 are the present fault case, the
oldest fault first; 8 to 15 the case that was acknowledged last, in the same order, and so on. Alarms (r2122): 0 is the
oldest of those present, 7 the latest; from 8 on those that have gone, the latest first.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof import deviation_lists
from plcgen.ds47.proof.contents import held
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.wire.formats import Format, Value, pack_values, padded, unpack_values
from plcgen.proof.rig import Members

COLUMNS = {
    "code": ("code", 945, 2122),
    "value": ("value", 949, 2124),
    "received": ("received", 948, 2123),
    "received_days": ("receivedDays", 2130, 2145),
    "removed": ("removed", 2109, 2125),
    "removed_days": ("removedDays", 2136, 2146),
    "float_value": ("floatValue", 2133, 2134),
    "component": ("component", 3120, 3121),
    "drive_object": ("driveObject", 3115, 0),
}
"""Member of an entry, parameter of faults and of alarms, by the word that a spec has for a column."""
COUNTERS = {"faults": 944, "alarms": 2121}
"""What counts the changes of a buffer."""
GROUP = 8
"""Places of the present, and of each group of the history."""


@dataclass(frozen=True, slots=True)
class Messages:
    """A scenario with so many ``messages`` in each group of a buffer; None: as the values are.

    ``rounds`` is how often all telegrams are sent; what a round has not answered has the result of the one before.
    """

    messages: int | None = None
    rounds: int = 1


def columns(job: DriveJob) -> list[tuple[str, int]]:
    """Member and parameter of every column; none of another kind of job."""
    if job.messages is None:
        return []
    which = 1 if job.messages.member == "faults" else 2
    return [(COLUMNS[name][0], COLUMNS[name][which]) for name in job.messages.settings.columns]  # type: ignore[misc]


def counted(job: DriveJob) -> bool:
    """Whether the job reads what counts the changes; else it reads the codes twice."""
    return any(use.parameter.pnu == COUNTERS[job.kind] for use in job.uses)


def groups(job: DriveJob) -> int:
    """The present, and what there is of the history."""
    return len(job.messages.settings.latest_last) if job.messages is not None else 0


def paths(job: DriveJob) -> Iterator[str]:
    """Members of the block that have the list."""
    if job.deviations is not None:
        yield from deviation_lists.deviation_members(job)
    if job.messages is None:
        return
    for place in range(1, GROUP * groups(job) + 1):
        for name, _ in columns(job):
            yield f"{job.messages.member}[{place}].{name}"
    yield "faultCount" if job.messages.member == "faults" else "alarmCount"


def shown_list(job: DriveJob, db: Members, prefix: str = "") -> bytes:
    """The list as the block has it."""
    return b"".join(db.bytes(prefix + path) for path in paths(job))


def wanted(job: DriveJob, drive: Drive, drive_object: int, given: Mapping[int, bytes]) -> bytes:
    """The list that a drive makes; nothing for another kind of job.

    ``given`` are the wire bytes that the drive should have, by position of the use. Raises KeyError.
    """
    if job.deviations is not None:
        return deviation_lists.deviation_list(
            job, given, {use.position: held(drive, drive_object, use) for use in job.uses}
        )
    parameters = drive.objects[drive_object].parameters
    return _entries(job, {pnu: (parameters[pnu].format, parameters[pnu].values) for _, pnu in columns(job)})


def answered(job: DriveJob, answers: Sequence[bytes], given: Mapping[int, bytes]) -> bytes:
    """The list that good answers make, one to each telegram."""
    if job.deviations is not None:
        return deviation_lists.deviation_list(job, given, came(job, answers))
    found: dict[int, tuple[Format, list[Value]]] = {}
    for telegram, answer in zip(job.telegrams[:-1], answers, strict=False):  # the last one only asks for changes
        at = 4
        for part in telegram.parts:
            at += 2
            if part.use.parameter.pnu in dict(columns(job)).values():
                format_, values = found.setdefault(part.use.parameter.pnu, (part.use.format, []))
                values += unpack_values(format_, part.count, answer[at : at + part.size])
            at += padded(part.size)
    return _entries(job, found)


def came(job: DriveJob, answers: Sequence[bytes]) -> dict[int, bytes]:
    """Wire bytes of every use in good answers, by its position."""
    found: dict[int, bytes] = {}
    for telegram, answer in zip(job.telegrams, answers, strict=True):
        at = 4
        for part in telegram.parts:
            found[part.use.position] = found.get(part.use.position, b"") + answer[at + 2 : at + 2 + part.size]
            at += 2 + padded(part.size)
    return found


def _entries(job: DriveJob, held: Mapping[int, tuple[Format, Sequence[Value]]]) -> bytes:
    """The list, from the values of every column."""
    if job.messages is None:
        return b""
    found = b""
    present = 0
    for group in range(groups(job)):
        indexes = range(GROUP * group, GROUP * group + GROUP)
        reads = indexes if job.messages.member == "alarms" and group else indexes[::-1]
        _, codes = held[dict(columns(job))["code"]]
        used = [index for index in reads if codes[index]]
        for index in used:
            found += b"".join(pack_values(held[pnu][0], [held[pnu][1][index]]) for _, pnu in columns(job))
        empty = b"".join(bytes(held[pnu][0].size) for _, pnu in columns(job))
        found += empty * (GROUP - len(used))
        present = len(used) if group == 0 else present
    return found + present.to_bytes(2)


def fill(job: DriveJob, drive: Drive, drive_object: int, messages: int) -> None:
    """So many messages in every group, those that are there first."""
    code = drive.objects[drive_object].parameters[dict(columns(job))["code"]]
    for group in range(groups(job)):
        for index in range(GROUP * group + messages, GROUP * group + GROUP):
            code.values[index] = 0
