"""What the jobs of a PPI master do to each other, many jobs in a row, and a buffer with a wrong number."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

from plcgen.cpu.program import Program
from plcgen.proof.runner import Run
from plcgen.proof.scenario import ScenarioError, Statistics
from plcgen.proof.suite import Procedure
from plcgen.protocols.ppi.plan.nouns import PlannedMaster, PpiJob, PpiPlan
from plcgen.protocols.ppi.proof.conduct import MasterConduct
from plcgen.protocols.ppi.proof.rig import MasterRig
from plcgen.protocols.ppi.proof.scenario import PpiScenario
from plcgen.protocols.ppi.proof.words import DONE, WORDS
from plcgen.protocols.ppi.wire.fdl import examine_frame
from plcgen.protocols.ppi.wire.model import VariableFrame

ROW = 600
ROUNDS = 4
UNUSED_NUMBER = 59_998


def procedures(plan: PpiPlan, program: Program, master: PlannedMaster) -> Iterator[Procedure]:
    """What the jobs of a master do to each other."""

    def bed() -> MasterRig:
        return MasterRig(plan, program, master)

    yield Procedure("all jobs at once", bed, together)
    yield Procedure("jobs behind each other", bed, behind)
    yield Procedure(f"{ROW} jobs in a row", bed, row)
    if plan.target.classic:
        yield Procedure("buffer DB with a wrong number", lambda: misnumbered(plan, program, master), wrong_number)


# --- all jobs at once, through OB1 ----------------------------------------------------------------------------


def together(rig: MasterRig) -> None:
    """All jobs started at once through OB1, round after round; then a port that hangs."""
    for number in range(ROUNDS):
        _round(rig, number)
    if len(rig.master.jobs) > 1 or not rig.plan.target.classic:
        _occupied(rig)


def _control(rig: MasterRig, job: PpiJob, signal: str) -> str:
    """Path of a signal as the caller supplies it: a flag, or a member of the control DB.

    With several masters the member begins with the name of the master.
    """
    address = getattr(job.trigger, signal, None)
    if address is not None:
        return str(address)
    member = job.member
    if len(rig.plan.masters) > 1:
        member = f"{rig.master.member}{member[:1].upper()}{member[1:]}"
    return f'"{rig.plan.control_db.name}".{member}.{signal}'


def _round(rig: MasterRig, number: int) -> None:
    """Every job once: all end well, in turn, with values that travelled through OB1."""
    jobs, cpu = rig.master.jobs, rig.cpu
    for job in jobs:
        rig.new_values(job)
        for value in job.inputs:
            cpu[_control(rig, job, value.member)] = cpu[f'"{rig.master.instance.name}".{job.pin(value.member)}']
        cpu[_control(rig, job, "execute")] = True
    rig.port.sent.clear()
    ended: dict[str, int] = {}
    longest = sum(job.timeout for job in jobs)
    for scan in range(longest // 10 + 100):
        cpu.scan(10)
        if cpu.misuses:
            raise ScenarioError("misuse")
        for job in jobs:
            if cpu[_control(rig, job, "error")]:
                status = cpu[_control(rig, job, "status")]
                raise ScenarioError(f"round {number}: {job.key} ends with 16#{status:04X}")
            if cpu[_control(rig, job, "done")] and job.key not in ended:
                ended[job.key] = scan
                _compare(rig, job)
                cpu[_control(rig, job, "execute")] = False
        if len(ended) == len(jobs):
            break
    else:
        waiting = [job.key for job in jobs if job.key not in ended]
        raise ScenarioError(f"round {number}: {', '.join(waiting)} never ended")
    cpu.scan(10, 3)
    for job in jobs:
        if cpu[_control(rig, job, "status")] != WORDS["IDLE"]:
            raise ScenarioError(f"round {number}: {job.key} is not idle after execute has fallen")


def _compare(rig: MasterRig, job: PpiJob) -> None:
    """The control DB shows what the block shows."""
    name = rig.master.instance.name
    for value in job.outputs:
        if rig.shown(job, value) != rig.expected(job, value):
            raise ScenarioError(f"{value.member} of {job.key} is not what the station has")
        if rig.cpu[_control(rig, job, value.member)] != rig.cpu[f'"{name}".{job.pin(value.member)}']:
            raise ScenarioError(f"{value.member} of {job.key} does not reach the control DB")


def _occupied(rig: MasterRig) -> None:
    """A job that waits for the port for its whole timeout says so; afterwards everything works."""
    jobs, cpu = rig.master.jobs, rig.cpu
    rig.port.hang = True
    words: list[object] = []
    for _ in range(2):  # on an S7-1200/1500 even a single job waits the second time: the module is still sending
        for job in jobs:
            cpu[_control(rig, job, "execute")] = True
        slowest = max(job.timeout for job in jobs)
        for _ in range(slowest // 50 + 200):
            cpu.scan(50)
        words += [cpu[_control(rig, job, "status")] for job in jobs]
        for job in jobs:
            cpu[_control(rig, job, "execute")] = False
        cpu.scan(50, 2)
    allowed = {WORDS[name] for name in ("TIMEOUT", "DRAIN_TIMEOUT", "PORT_OCCUPIED", "RUNNING", "STARTED")}
    if not allowed.issuperset(words) or WORDS["PORT_OCCUPIED"] not in words:
        raise ScenarioError(f"a port that hangs gives {', '.join(f'16#{word:04X}' for word in words)}")
    rig.port.hang = False
    for _ in range(2000):
        cpu.scan(10)
        if all(cpu[_control(rig, job, "status")] == WORDS["IDLE"] for job in jobs):
            break
    _round(rig, ROUNDS)


def behind(rig: MasterRig) -> None:
    """Every job behind the last one of the master, and behind one of another station, after power-up."""
    conduct, jobs = MasterConduct(rig), rig.master.jobs
    for job in jobs:
        strange = [other for other in jobs if other.station is not job.station]
        for before in dict.fromkeys((jobs[-1], *strange[-1:])):
            name = f"{job.key} behind {before.key}"
            for rig.job, fresh in ((before, True), (job, False)):
                Run(PpiScenario(name=name, fresh=fresh, retries=None, polls=None), conduct, Statistics()).go()


# --- many in a row --------------------------------------------------------------------------------------------


def row(rig: MasterRig) -> None:
    """600 jobs in a row: references never repeat and never are 0, frame count bits alternate throughout."""
    references: list[int] = []
    for number in range(ROW):
        if number == ROW // 2:
            rig.cpu[f'"{rig.db.block}".statReference'] = 32_766  # the reference starts again
        rig.port.sent.clear()
        ended = _once(rig, rig.job.timeout // 20, 20)
        if ended != DONE or rig.db.get("retries"):
            raise ScenarioError(f"job {number + 1} in a row ends with 16#{ended:04X}")
        rig.db.set(rig.pin("execute"), 0)
        rig.cpu.call(rig.db.block, 20)
        frames = (examine_frame(data)[0] for _, data in rig.port.sent)
        references += [int.from_bytes(frame.pdu[4:6]) for frame in frames if isinstance(frame, VariableFrame)]
    twice = any(a == b for a, b in itertools.pairwise(references))
    if 0 in references or twice or len(references) < ROW or max(references) != 32_767:
        raise ScenarioError("PDU references repeat or are 0")
    if rig.db.get("pduReference") != references[-1]:
        raise ScenarioError("diagnostics.pduReference is not that of the last request")


def _once(rig: MasterRig, scans: int, length: int) -> int:
    """Start the job and call the block until it ends; its status."""
    rig.db.set(rig.pin("execute"), 1)
    for _ in range(scans):
        rig.cpu.call(rig.db.block, length)
        if not rig.db.flag(rig.pin("busy")):
            break
    return rig.db.get(rig.pin("status"))


# --- a wrong number -------------------------------------------------------------------------------------------


def misnumbered(plan: PpiPlan, program: Program, master: PlannedMaster) -> MasterRig:
    """A CPU in which another DB has the number of the buffer. S7-300 only."""
    entry = program.link.find(master.buffer.name) if master.buffer is not None else None
    other = program.link.find(plan.control_db.name)
    if entry is None or other is None:
        raise ScenarioError("there is no buffer DB or no control DB")
    before = entry.number, other.number
    entry.number, other.number = UNUSED_NUMBER, before[0]
    try:
        return MasterRig(plan, program, master)
    finally:
        entry.number, other.number = before


def wrong_number(rig: MasterRig) -> None:
    """The buffer DB has another number than the block expects: nothing is sent."""
    status = _once(rig, 20, 10)
    if status != WORDS["WRONG_DB"] or rig.port.sent:
        raise ScenarioError(f"the wrong number gives 16#{status:04X}, not 16#8204")
