"""What PPI masters contribute to verification, and what a green one rests on."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from plcgen.base.diagnostics import Span
from plcgen.base.diagnostics.counting import quantity, shortlist
from plcgen.ppi.plan.nouns import PlannedMaster, PlannedStation, PpiJob, PpiPlan
from plcgen.ppi.proof.conduct import MasterConduct
from plcgen.ppi.proof.rig import MasterRig, check_telegrams
from plcgen.ppi.proof.scenario import (
    CHARACTER_BITS,
    FRAME_CALLS,
    POLL_MS,
    SHORT_REPLY,
    PpiScenario,
    fault,
    in_time,
    loose,
    lost_once,
    reply_length,
)
from plcgen.ppi.proof.scenarios import (
    cpu_scenarios,
    hangs,
    in_the_pause,
    line_scenarios,
    module_scenarios,
    pace_scenarios,
    ready,
    refusals,
    wrong_replies,
)
from plcgen.ppi.proof.stated.times import stated_checks
from plcgen.ppi.proof.together import ROW, procedures
from plcgen.ppi.proof.wording import PpiWording
from plcgen.ppi.proof.words import CLOCK_END, WORDS, State
from plcgen.ppi.wire.areas import Area, Function
from plcgen.project.nouns import BufferField
from plcgen.proof.checks import Check, CheckGroup, Outcome
from plcgen.proof.conditions import STATE, Premise
from plcgen.proof.coverage import NO_OTHER
from plcgen.proof.effort import Faults
from plcgen.proof.folder import Folder
from plcgen.proof.ledger import Assumption, Grade
from plcgen.proof.making import make_checks
from plcgen.proof.rig import shown_value
from plcgen.proof.runner import Runner
from plcgen.proof.scenario import Failure, Statistics
from plcgen.proof.suite import CodeBlock, LaidOut, Procedure, Progress, Reads
from plcgen.s7.cpu.program import Program

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
    # codes of the areas, and the layout of a value where it is not just bytes
    for area in _used(jobs):
        text = f"area {area:02X}h, {area.title}"
        if area in {Area.T, Area.HC}:
            text += ": status byte and 32 bits"
        elif area is Area.C:
            text += ": status byte and 16 bits"
        yield Assumption("PPI", text, *_AREAS[area])
    for master in plan.masters:
        for station in master.stations:
            yield from _station(master, station)
        yield from _module(master)
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


SHOWN = 3
SHOWN_ROLES = frozenset({"function_code", "reference", "return_code", "value", "fcs"})
"""Members that the report names: what changes at run time. All of them are compared."""
OPENED = ("MAX_RETRIES", "MAX_POLLS", "tempLastItem", "tempFailed")
"""Names of the block whose values are an excuse only where the plan says so."""
NO_REPLY = (0, 1, 3, 4)
"""Events of a message but for EVENT_REPLY: none, E5, refused, busy."""
SHAPES = {"read": "read", "write": "write", "run": "service", "stop": "service"}
"""Kinds of jobs whose replies are walked alike: one of each runs through the whole matrix."""


class PpiProof:
    """The proof of a plan of PPI masters."""

    def __init__(self, plan: PpiPlan) -> None:
        self.plan = plan

    def constants(self) -> dict[str, int]:
        """None."""
        return {}

    def stimulus(self) -> tuple[tuple[str, str], ...]:
        """None: the block is called as it lies in the folder."""
        return ()

    def layouts(self) -> Iterator[LaidOut]:
        """Table and response DB of every telegram."""
        for master in self.plan.masters:
            for telegram in master.telegrams:
                yield LaidOut(telegram.request, _shown, prefix="telegram.")
                if telegram.response is not None:
                    yield LaidOut(telegram.response, _shown)

    def telegrams(self, folder: Folder) -> Iterator[Check]:
        """Start values of the tables."""
        return make_checks(check_telegrams(self.plan, folder), "telegrams", Span(str(folder.path)))

    def foundation(self, folder: Path) -> Iterator[Check]:
        """Nothing: a block is made for its master."""
        return iter(())

    def exchanges(self, folder: Folder, partner: Path | None, progress: Progress | None) -> CheckGroup | None:
        """Stations are only met by the block as a whole."""

    def stated(self, program: Program) -> Iterator[Check]:
        """Every master."""
        return stated_checks(self.plan, program)

    def oracles(self, folder: Folder, *, dissector: bool) -> Iterator[Check]:
        """Nobody else is asked."""
        return iter(())

    def wording(self) -> PpiWording:
        """What the documents say."""
        return PpiWording(self.plan)

    def ledger(self) -> Iterator[Assumption]:
        """What documents and recordings say about line, stations and modules."""
        return ledger(self.plan)

    def suites(self) -> list[PpiSuite]:
        """A suite for every master."""
        return [PpiSuite(self.plan, master) for master in self.plan.masters]


def _shown(field: BufferField) -> bool:
    return field.role in SHOWN_ROLES


class PpiSuite:
    """The jobs of one master, all in one block."""

    page = "docs/ppi-master.md"

    def __init__(self, plan: PpiPlan, master: PlannedMaster) -> None:
        self.plan, self.master, self.jobs = plan, master, master.jobs
        self.prefix = f"{master.key}."

    def pins(self, job: PpiJob) -> dict[str, str]:
        """Inputs and outputs of the master's instance."""
        names = ("execute", "busy", "done", "error", "status")
        return {name: f'"{self.master.instance.name}".{job.pin(name)}' for name in names}

    def shown_name(self, job: PpiJob) -> str:
        """Its key, with several masters that of the master in front."""
        return self.plan.key(self.master, job)

    def blocks(self) -> list[CodeBlock]:
        """The block of the master."""
        name, span = self.master.block.name, self.plan.loaded.key_span(self.master.path)
        return [CodeBlock(self.master.key, name, name, self.jobs, lambda: span, self.premises(), OPENED)]

    def premises(self) -> tuple[Premise, ...]:
        """What cannot happen in this project.

        A job is active only while the state is not IDLE. A telegram is walked item by item only if its reply has items,
        those of a read and those of a write in their own way. A single job never waits for a CP 341. With one poll per
        telegram a poll has 5Ch and a request 7Ch. What is not repeated waits for a reply between two polls only.
        """

        def known(why: str, variable: str, values: Iterable[int], among: Iterable[int], given: str = STATE) -> Premise:
            return Premise(why, "", variable, frozenset(values), given, frozenset(among))

        master, waiting = self.master, (State.ACK, State.REPLY, State.WAIT)
        kinds = {t.number: t.kind for t in master.telegrams if t.response is not None}
        found = [
            Premise(NO_OTHER, never="STATUS_TIMEOUT", among=frozenset({State.IDLE})),
            *([known(NO_OTHER, "statTelegram", kinds, waiting)] if kinds else []),
        ]
        found.append(known(NO_OTHER, "statCurrent", {t.number for t in master.telegrams}, (State.BUILD,)))
        for function, kind in ((Function.READ, "read"), (Function.WRITE, "write")):
            numbers = [number for number, asked in kinds.items() if asked == kind]
            found.append(known(NO_OTHER, "statService", (function,), numbers, "statTelegram"))
        longest, soon = max(job.timeout for job in master.jobs), "every job ends by its timeout before that"
        for word, times, pause in (
            ("STATUS_NOT_READY", master.polls, master.poll_pause),
            ("STATUS_NO_ANSWER", master.retries, master.retry_pause),
        ):
            if times * (pause + POLL_MS) >= longest:
                found.append(Premise(soon, never=word))
        if len(master.jobs) == 1 and self.plan.target.classic:
            found.append(Premise("a single job never waits for the port", never="STATUS_PORT_OCCUPIED"))
        if not master.retries:
            found.append(Premise("no retries", follow=("MAX_RETRIES",)))
        if all(len(telegram.items) < 2 for telegram in master.telegrams):
            found.append(Premise("every telegram has one item", follow=("tempLastItem", "tempFailed")))
        if master.polls == 1 and not master.retries:
            found.append(known("a message takes two calls, and E5 was the last one", "tempNew", (0,), (State.POLL,)))
        shortest = min(map(reply_length, master.telegrams), default=SHORT_REPLY) * CHARACTER_BITS * 1000 // master.baud
        if not master.retries and shortest > master.poll_pause + FRAME_CALLS * master.ob1_cycle:
            why = "no reply is as short as a pause"
            found.append(known(why, "tempNew", (0,), (State.POLL,)))
            found.append(known(why, "tempEvent", NO_REPLY, (State.WAIT,)))
        if master.polls == 1:
            found.append(Premise("one poll only", follow=("MAX_POLLS",)))
            found.append(Premise("one poll only", never="POLL_PAUSE"))
            found.append(known("one poll only", "statFunctionCode", (0, 0x5C), (State.BUILD,)))
            found.append(known("one poll only", "statFunctionCode", (0x6C, 0x7C), (State.SEND, State.POLL)))
        return tuple(found)

    def runner(self, program: Program, job: PpiJob, statistics: Statistics | None = None) -> Runner[PpiScenario]:
        """The master against its stations."""
        rig = MasterRig(self.plan, program, self.master)
        rig.job = job
        return Runner(MasterConduct(rig), statistics)

    def reads(self, job: PpiJob) -> Reads | None:
        """All jobs of a master are one block."""

    def first(self) -> PpiScenario:
        """Behind power-up a telegram more may be needed."""
        return loose(name="first run", follow=False)

    def nominal(self, runner: Runner[PpiScenario]) -> PpiScenario:
        """A run without any fault."""
        return PpiScenario(name="nominal run", follow=False, measured=True, ignored=0, damaged=0)

    def shown(self, runner: Runner[PpiScenario], scans: int) -> tuple[str, str]:
        """Scans and frames; the values read."""
        rig = rig_of(runner)
        sent, job = rig.port.sent, rig.job
        polls = sum(len(data) == 6 for _, data in sent)
        requests = len(sent) - polls
        frames = f"{quantity(requests, 'request')}, {quantity(polls, 'poll')}"
        if isinstance(runner.conduct, MasterConduct):
            frames += f", longest scan {runner.conduct.longest:,} statements"
        if job.kind in {"run", "stop"}:
            return f"{scans} scans, {frames}", f"{job.station.key} in {job.kind.upper()}"
        name = self.master.instance.name
        texts = [f"{value.label} = {shown_value(rig.cpu[f'{name}.{job.pin(value.member)}'])}" for value in job.outputs]
        texts = texts or [f"{value.label} written" for value in job.values]
        return f"{scans} scans, {frames}", shortlist(texts, SHOWN, f", .. ({len(texts)})")

    def matrix(self, runner: Runner[PpiScenario], scans: int, level: Faults) -> Iterator[PpiScenario]:
        """All of it, or what depends on the job itself and one of each kind of the rest."""
        job = rig_of(runner).job
        for scenario in self.everything(job, scans, level):
            yield in_time(self.master, job, scenario)

    def everything(self, job: PpiJob, scans: int, level: Faults) -> Iterator[PpiScenario]:
        """All scenarios of a job, as if it had all the time in the world."""
        master, target, every = self.master, self.plan.target, level == "full"
        if not every and job is not next(j for j in self.jobs if SHAPES[j.kind] == SHAPES[job.kind]):
            # what depends on the job itself, and one fault of each kind of the rest
            yield loose(name="first job after power-up", fresh=True)
            for at, kind in (("request", "silence"), ("poll", "fcs"), ("poll", "silence")):
                once = fault(kind, "request" if at == "request" else "poll")
                yield PpiScenario(name=f"{kind} at the {at}", faults=(once,), **lost_once(master, polls=at == "poll"))
            dead = (fault("deaf", times=None),)
            yield PpiScenario(
                name="silence forever", faults=dead, status=(WORDS["NO_ANSWER"],), retries=master.retries, polls=0
            )
            yield from ready(master.polls)
            yield from refusals(job, every=False)
            yield from wrong_replies(job)
            yield from hangs(master, job, classic=target.classic)
            yield PpiScenario(name="execute dropped", happens={scans // 2: "drop"})
            yield loose(name="cold restart", happens={scans // 2: "cold"})
            yield loose(name="scans of random length", wild=True)
            if job is min(self.jobs, key=lambda each: reply_length(each.telegrams[0])):
                yield from in_the_pause(master, job)  # that of a longer reply may be too short for it
            return
        yield from line_scenarios(master, job, every=every)
        yield from pace_scenarios(master, job)
        yield from module_scenarios(master, job, classic=target.classic)
        yield from cpu_scenarios(scans, CLOCK_END, master.ob1_cycle, retentive=target.v5, every=every)

    def behind(
        self, program: Program, runner: Runner[PpiScenario]
    ) -> Iterator[tuple[Failure | None, Runner[PpiScenario]]]:
        """Nothing: many jobs in a row are a matter of all jobs."""
        yield from ()

    def faults(self, job: PpiJob, level: Faults, kinds: int) -> str:
        """How many."""
        return f"{kinds} faults of line, module and CPU"

    def procedures(self, program: Program) -> Iterator[Procedure]:
        """All jobs at once, behind each other, many in a row, a buffer with a wrong number."""
        return procedures(self.plan, program, self.master)

    def together(self, procedures: int) -> Check:
        """All jobs on all stations."""
        stations = quantity(len(self.master.stations), "station")
        text = f"{quantity(len(self.jobs), 'job')} on {stations} through OB1, {ROW} jobs in a row"
        name, subject = f"together.{self.master.key}", f"jobs of {self.master.key}"
        return Check(name, subject, text, Outcome.OK, "round robin, one frame at a time, every job gets its turn")

    def left_out(self) -> Iterator[Check]:
        """Nothing."""
        return iter(())

    def own(self, program: Program, partner: Path) -> Iterator[Check]:
        """There are no files of stations here."""
        yield from ()


def rig_of(runner: Runner[PpiScenario]) -> MasterRig:
    """The rig of a master."""
    rig = runner.conduct.rig
    if not isinstance(rig, MasterRig):
        raise TypeError("not a PPI master")
    return rig
