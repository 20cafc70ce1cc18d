"""What the jobs of a PPI master do to each other, many jobs in a row, and a buffer with a wrong number."""

from __future__ import annotations

import itertools
from collections.abc import Callable

from plcgen.cpu.program import Program
from plcgen.protocols.ds47.proof.rig import ScenarioError
from plcgen.protocols.ds47.proof.runner import Failure
from plcgen.protocols.ppi.plan.nouns import PlannedMaster, PpiJob, PpiPlan
from plcgen.protocols.ppi.proof.rig import MasterRig
from plcgen.protocols.ppi.proof.runner import MasterRunner
from plcgen.protocols.ppi.proof.scenario import DONE, WORDS, PpiScenario
from plcgen.protocols.ppi.wire.fdl import examine_frame
from plcgen.protocols.ppi.wire.model import VariableFrame

ROW = 600
ROUNDS = 4
UNUSED_NUMBER = 59_998
Result = tuple[Failure | None, list[int]]


def _guarded(rig: MasterRig, name: str, run: Callable[[], None]) -> Result:
    """Run something; what it finds is a failure at the last misuse or nowhere."""
    try:
        run()
    except ScenarioError as problem:
        return _failure(rig, name, str(problem)), list(rig.cpu.coverage)
    except Exception as problem:  # noqa: BLE001 - changed sources may make the simulated CPU itself fail
        message = f"the simulated CPU stopped: {type(problem).__name__} {problem}"
        return _failure(rig, name, message), list(rig.cpu.coverage)
    return None, list(rig.cpu.coverage)


def _failure(rig: MasterRig, name: str, message: str) -> Failure:
    misuses = rig.cpu.misuses
    if misuses:
        return Failure(name, rig.cpu.scans, str(misuses[0]), misuses[0].file, misuses[0].line)
    return Failure(name, rig.cpu.scans, message, rig.file, 1)


# --- all jobs at once, through OB1 ----------------------------------------------------------------------------


def together(plan: PpiPlan, program: Program, master: PlannedMaster) -> Result:
    """All jobs started at once through OB1, round after round; then a port that hangs."""
    rig = MasterRig(plan, program, master)

    def run() -> None:
        for number in range(ROUNDS):
            _round(rig, plan, number)
        if len(master.jobs) > 1 or not plan.target.classic:
            _occupied(rig, plan)

    return _guarded(rig, "all jobs at once", run)


def _control(plan: PpiPlan, job: PpiJob, signal: str) -> str:
    """Path of a signal as the caller supplies it: a member of the control DB, or a flag."""
    from plcgen.protocols.ppi.views.documents import operand

    return operand(plan, job, signal)


def _round(rig: MasterRig, plan: PpiPlan, number: int) -> None:
    """Every job once: all end well, in turn, with values that travelled through OB1."""
    jobs, cpu = rig.master.jobs, rig.cpu
    for job in jobs:
        rig.new_values(job)
        for value in job.inputs:
            cpu[_control(plan, job, value.member)] = cpu[f'"{rig.master.instance.name}".{job.pin(value.member)}']
        cpu[_control(plan, job, "execute")] = True
    rig.port.sent.clear()
    ended: dict[str, int] = {}
    longest = sum(job.timeout for job in jobs)
    for scan in range(longest // 10 + 100):
        cpu.scan(10)
        if cpu.misuses:
            raise ScenarioError("misuse")
        for job in jobs:
            if cpu[_control(plan, job, "error")]:
                status = cpu[_control(plan, job, "status")]
                raise ScenarioError(f"round {number}: {job.key} ends with 16#{status:04X}")
            if cpu[_control(plan, job, "done")] and job.key not in ended:
                ended[job.key] = scan
                _compare(rig, plan, job)
                cpu[_control(plan, job, "execute")] = False
        if len(ended) == len(jobs):
            break
    else:
        waiting = [job.key for job in jobs if job.key not in ended]
        raise ScenarioError(f"round {number}: {', '.join(waiting)} never ended")
    cpu.scan(10, 3)
    for job in jobs:
        if cpu[_control(plan, job, "status")] != WORDS["IDLE"]:
            raise ScenarioError(f"round {number}: {job.key} is not idle after execute has fallen")


def _compare(rig: MasterRig, plan: PpiPlan, job: PpiJob) -> None:
    """The control DB shows what the block shows."""
    name = rig.master.instance.name
    for value in job.outputs:
        if rig.shown(job, value) != rig.expected(job, value):
            raise ScenarioError(f"{value.member} of {job.key} is not what the station has")
        if rig.cpu[_control(plan, job, value.member)] != rig.cpu[f'"{name}".{job.pin(value.member)}']:
            raise ScenarioError(f"{value.member} of {job.key} does not reach the control DB")


def _occupied(rig: MasterRig, plan: PpiPlan) -> None:
    """A job that waits for the port for its whole timeout says so; afterwards everything works."""
    jobs, cpu = rig.master.jobs, rig.cpu
    rig.port.hang = True
    words: list[object] = []
    for _ in range(2):  # on an S7-1200/1500 even a single job waits the second time: the module is still sending
        for job in jobs:
            cpu[_control(plan, job, "execute")] = True
        slowest = max(job.timeout for job in jobs)
        for _ in range(slowest // 50 + 200):
            cpu.scan(50)
        words += [cpu[_control(plan, job, "status")] for job in jobs]
        for job in jobs:
            cpu[_control(plan, job, "execute")] = False
        cpu.scan(50, 2)
    allowed = {WORDS[name] for name in ("TIMEOUT", "DRAIN_TIMEOUT", "PORT_OCCUPIED", "RUNNING", "STARTED")}
    if not allowed.issuperset(words) or WORDS["PORT_OCCUPIED"] not in words:
        raise ScenarioError(f"a port that hangs gives {', '.join(f'16#{word:04X}' for word in words)}")
    rig.port.hang = False
    for _ in range(2000):
        cpu.scan(10)
        if all(cpu[_control(plan, job, "status")] == WORDS["IDLE"] for job in jobs):
            break
    _round(rig, plan, ROUNDS)


def behind(plan: PpiPlan, program: Program, master: PlannedMaster) -> Result:
    """Every job behind the last one of the master, and behind one of another station, after power-up."""
    rig = MasterRig(plan, program, master)
    runner = MasterRunner(rig)

    def run() -> None:
        for job in master.jobs:
            strange = [other for other in master.jobs if other.station is not job.station]
            for before in dict.fromkeys((master.jobs[-1], *strange[-1:])):
                name = f"{job.key} behind {before.key}"
                for one, fresh in ((before, True), (job, False)):
                    runner.run(one, PpiScenario(name=name, fresh=fresh, retries=None, polls=None))

    return _guarded(rig, "jobs behind each other", run)


# --- many in a row --------------------------------------------------------------------------------------------


def row(plan: PpiPlan, program: Program, master: PlannedMaster) -> Result:
    """600 jobs in a row: references never repeat and never are 0, frame count bits alternate throughout."""
    rig = MasterRig(plan, program, master)
    runner = MasterRunner(rig)

    def run() -> None:
        job = master.jobs[0]
        name = rig.master.instance.name
        references: list[int] = []
        spot = rig.spots["pduReference"]
        for number in range(ROW):
            runner.name, runner.scan = f"job {number + 1} in a row", number
            if number == ROW // 2:
                rig.cpu[f'"{name}".statReference'] = 32_766  # the reference starts again
            rig.port.sent.clear()
            _once(rig, job, number)
            for _, data in rig.port.sent:
                frame, _problems = examine_frame(data)
                if isinstance(frame, VariableFrame):
                    references.append(int.from_bytes(frame.pdu[4:6]))
        zero = 0 in references
        twice = any(a == b for a, b in itertools.pairwise(references))
        if zero or twice or len(references) < ROW or max(references) != 32_767:
            raise ScenarioError("PDU references repeat or are 0")
        if rig.get("pduReference") != references[-1] or not spot.size:
            raise ScenarioError("diagnostics.pduReference is not that of the last request")

    return _guarded(rig, f"{ROW} jobs in a row", run)


def _once(rig: MasterRig, job: PpiJob, number: int) -> None:
    name = rig.master.instance.name
    rig.set_flag(job, "execute", value=True)
    for _ in range(job.timeout // 20):
        rig.cpu.call(name, 20)
        if not rig.flag(job, "busy"):
            break
    if rig.status(job) != DONE or rig.get("retries"):
        raise ScenarioError(f"job {number + 1} in a row ends with 16#{rig.status(job):04X}")
    rig.set_flag(job, "execute", value=False)
    rig.cpu.call(name, 20)


# --- a wrong number -------------------------------------------------------------------------------------------


def wrong_number(plan: PpiPlan, program: Program, master: PlannedMaster) -> Result:
    """The buffer DB has another number than the block expects: nothing is sent. S7-300 only."""
    if master.buffer is None:
        raise ValueError("this master has no buffer")
    entry = program.link.find(master.buffer.name)
    other = program.link.find(plan.control_db.name)
    if entry is None or other is None:
        return None, [0] * len(program.probes)
    before = entry.number, other.number
    entry.number, other.number = UNUSED_NUMBER, before[0]
    try:
        rig = MasterRig(plan, program, master)

        def run() -> None:
            job = master.jobs[0]
            rig.set_flag(job, "execute", value=True)
            for _ in range(20):
                rig.cpu.call(rig.master.instance.name, 10)
                if not rig.flag(job, "busy"):
                    break
            if rig.status(job) != WORDS["WRONG_DB"] or rig.port.sent:
                raise ScenarioError(f"the wrong number gives 16#{rig.status(job):04X}, not 16#8204")

        return _guarded(rig, "buffer DB with a wrong number", run)
    finally:
        entry.number, other.number = before
