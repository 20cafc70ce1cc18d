"""Every assumption that a green verification of a PPI master rests on: who says so, and how well that is known."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from plcgen.ppi.plan.nouns import PlannedMaster, PlannedStation, PpiJob, PpiPlan
from plcgen.ppi.wire.areas import Area
from plcgen.proof.ledger import Assumption, Grade

_RECORDED = "telegrams between STEP 7-Micro/WIN and a CPU 226"
_LIBNODAVE = "libnodave, nodave.h and testPPI"
_FDL = "EN 50170 volume 2 (FDL)"
_HELP = "TIA Portal information system"
_CP341 = "manual CP 341, A5E02191071-01, table 6-15"
_NOBODY = "no document was found"
_AREAS = {
    **dict.fromkeys((Area.I, Area.Q, Area.M, Area.V, Area.SM), (_RECORDED, Grade.OBSERVED)),
    **dict.fromkeys((Area.T, Area.C, Area.AI, Area.AQ, Area.SYS), (_LIBNODAVE, Grade.SECOND)),
    **dict.fromkeys((Area.S, Area.HC), (_NOBODY, Grade.GENERAL)),
}
"""Who has seen or printed an address of an area on the line."""
_SERVICES = {
    "read": "function 04h: items of 12 bytes; the reply has return code, size code and length for each",
    "write": "function 05h: the items, then their values, the last one without a fill byte",
    "run": "function 28h with P_PROGRAM starts the CPU",
    "stop": "function 29h stops the CPU",
}
_MEMORY = {"S": "S7-200 SMART system manual, A5E03822230", "2": "S7-200 system manual, A5E00307987"}
"""By the first letter of a CPU; the pages are not named in the table of CPUs."""


def ledger(plan: PpiPlan) -> Iterator[Assumption]:
    """The line, services and areas, stations, modules and times."""
    jobs = [job for master in plan.masters for job in master.jobs]
    if not jobs:
        return
    yield from _line()
    for kind in dict.fromkeys(job.kind for job in jobs):
        yield Assumption(f"PPI {kind}", _SERVICES[kind], _RECORDED, Grade.OBSERVED)
    yield from _areas(jobs)
    for master in plan.masters:
        for station in master.stations:
            yield from _station(master, station)
        yield from _module(master)
        yield from _times(plan, master)


def _line() -> Iterator[Assumption]:
    subject = "PPI"
    for text, source, grade in (
        ("a request is acknowledged with E5, the reply comes when it is polled", _RECORDED, Grade.OBSERVED),
        ("frames SD1, SD2 and E5; FCS is the sum of the bytes from DA on", _FDL, Grade.SECOND),
        (
            "6Ch first, then 5Ch and 7Ch in turn; a repetition is answered again and not executed twice",
            _FDL,
            Grade.SECOND,
        ),
        ("E5 instead of a reply: not ready, to be polled again", _LIBNODAVE, Grade.SECOND),
        ("a PDU has 240 bytes: 19 items, 222 bytes read, 212 written", _LIBNODAVE, Grade.SECOND),
        ("return code FFh is good; an item with another one has no value", _LIBNODAVE, Grade.SECOND),
    ):
        yield Assumption(subject, text, source, grade)


def _areas(jobs: list[PpiJob]) -> Iterator[Assumption]:
    """Codes of the areas, and the layout of a value where it is not just bytes."""
    for area in _used(jobs):
        text = f"area {area:02X}h, {area.title}"
        if area in {Area.T, Area.HC}:
            text += ": status byte and 32 bits"
        elif area is Area.C:
            text += ": status byte and 16 bits"
        yield Assumption("PPI", text, *_AREAS[area])


def _used(jobs: Iterable[PpiJob]) -> list[Area]:
    return sorted({Area(item.item.area) for job in jobs for telegram in job.telegrams for item in telegram.items})


def _station(master: PlannedMaster, station: PlannedStation) -> Iterator[Assumption]:
    name, profile = f"{master.key} {station.key}", station.profile
    source = _MEMORY[profile.key[0]]
    for area in _used(job for job in master.jobs if job.station is station):
        unit = "elements" if area.elements else "bytes"
        text = f"{profile.title} has {profile.sizes[area]} {unit} of {area.name}"
        if area is Area.SYS or area.name in profile.unchecked:
            yield Assumption(name, text, f"from memory, not compared with the {source}", Grade.GENERAL)
        else:
            yield Assumption(name, text, source, Grade.SECOND)


def _module(master: PlannedMaster) -> Iterator[Assumption]:
    if master.module == "cp341":
        for text in (
            "P_SND_RK and P_RCV_RK move 32 bytes in a program cycle, in three calls at least",
            "RESET takes four calls at least and ends with DONE or ERROR",
        ):
            yield Assumption(master.key, text, _CP341, Grade.MANUAL)
        return
    yield Assumption(
        master.key,
        "Port_Config and Receive_Config are needed after power-up; a gap of 35 bit times ends a message",
        f'{_HELP}, "Port_Config", "Receive_Config"',
        Grade.MANUAL,
    )
    yield Assumption(
        master.key,
        "Send_P2P and Receive_P2P need two calls and more for a job",
        f'{_HELP}, "Overview of Freeport communication"; the number is ours',
        Grade.SECOND,
    )


def _times(plan: PpiPlan, master: PlannedMaster) -> Iterator[Assumption]:
    given = plan.spec.ppi[master.key]
    yield Assumption(master.key, f"a cycle of OB1 takes {master.ob1_cycle} ms at most", "the spec", Grade.SPEC)
    line = f"{master.baud} bit/s, 8 data bits, even parity, 1 stop bit"
    yield Assumption(master.key, line, f"the spec; {_LIBNODAVE}", Grade.SECOND)
    for what, time, own in (
        ("E5", master.ack_timeout, given.ack_timeout),
        ("the reply to a poll", master.reply_timeout, given.reply_timeout),
    ):
        source, grade = ("the spec", Grade.SPEC) if own is not None else (_NOBODY, Grade.GENERAL)
        yield Assumption(master.key, f"{what} has been received after {time} ms", source, grade)
