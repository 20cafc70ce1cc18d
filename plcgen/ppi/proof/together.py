"""What the jobs of a PPI master do to each other, many jobs in a row, and a buffer with a wrong number."""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Iterator

from plcgen.ppi.plan.nouns import PlannedMaster, PpiJob, PpiPlan
from plcgen.ppi.proof.conduct import MasterConduct
from plcgen.ppi.proof.rig import MasterRig
from plcgen.ppi.proof.scenario import FRAME_CALLS, FRAME_MS, loose, others
from plcgen.ppi.proof.words import DONE, DRAIN_MS, LONGEST, WORDS, State
from plcgen.ppi.sim import Fault, FaultKind
from plcgen.ppi.wire.fdl import examine_frame
from plcgen.ppi.wire.model import VariableFrame
from plcgen.proof.runner import Run
from plcgen.proof.scenario import ScenarioError, Statistics
from plcgen.proof.suite import Procedure
from plcgen.s7.cpu.program import Program

ROW = 600
ROUNDS = 4
FULL = 32_767
"""Highest value of an INT."""
UNUSED_NUMBER = 59_998
NOISE = (LONGEST // 4, LONGEST // 2, LONGEST)
START = 0x68
MOMENTS = range(10)
"""Calls of a job before a restart: none, the first one, in which a block of the module begins, while it works."""
SLACK = 1.2
"""Statements of a call that does not search besides."""


def procedures(plan: PpiPlan, program: Program, master: PlannedMaster) -> Iterator[Procedure]:
    """What the jobs of a master do to each other."""

    def bed() -> MasterRig:
        return MasterRig(plan, program, master)

    yield Procedure("every job with the values as delivered", bed, as_delivered)
    yield Procedure("all jobs at once", bed, together)
    yield Procedure("jobs one after the other", bed, behind)
    if not plan.target.classic:
        yield Procedure("a restart with a retentive instance", bed, kept)
    if any(job.cycle for job in master.jobs):
        yield Procedure("jobs with a cycle", bed, cycles)
    yield Procedure("longest scan", bed, longest_scan)
    yield Procedure(f"{ROW} jobs in a row", bed, row)
    yield Procedure("counters at their end", bed, full_counters)
    if plan.target.classic:
        yield Procedure("buffer DB with a wrong number", lambda: misnumbered(plan, program, master), wrong_number)


def step(rig: MasterRig) -> int:
    """Milliseconds of a scan."""
    return min(10, rig.master.ob1_cycle)


# --- as delivered ---------------------------------------------------------------------------------------------


def as_delivered(rig: MasterRig) -> None:
    """Data blocks as after a download: jobs with a cycle start on their own, no other; each ends well as it is.

    One with a flag of its own waits for it.
    """
    jobs, cpu = rig.master.jobs, rig.cpu
    own = [job for job in jobs if job.cycle and job.trigger.execute is None]
    for job in jobs:
        if rig.db.get(job.pin("status")) != WORDS["IDLE"]:
            raise ScenarioError(f"the status of {job.key} is not 16#7000 before the first call")
    cpu.scan(step(rig), ROUNDS)
    for job in jobs:
        if (cpu[_control(rig, job, "status")] != WORDS["IDLE"]) != (job in own):
            raise ScenarioError(f"{job.key} {'does not start' if job in own else 'starts'} on its own")
    if rig.port.sent and not own:
        raise ScenarioError("something is sent although no job was started")
    for job in jobs:
        cpu[_control(rig, job, "execute")] = True
    waiting, crowd = list(jobs), Crowd(rig)
    for _ in range(crowd.longest // step(rig) + 100):
        cpu.scan(step(rig))
        failed = next((job for job in waiting if cpu[_control(rig, job, "error")] and not crowd.again(job)), None)
        if cpu.misuses or failed is not None:
            raise ScenarioError("misuse" if failed is None else f"{failed.key} ends with an error")
        waiting = [job for job in waiting if not cpu[_control(rig, job, "done")]]
        if not waiting:
            return
    raise ScenarioError(f"{waiting[0].key} never ended")


class Crowd:
    """Jobs that want the port at the same time, and which of them have less time than all of them take together.

    Such a job may end because others have the port; it is started again, and gets its turn within ``longest`` ms.
    """

    def __init__(self, rig: MasterRig) -> None:
        self.rig, jobs = rig, rig.master.jobs
        frame = FRAME_MS * 9600 // rig.master.baud + FRAME_CALLS * step(rig)
        needed = sum(2 * frame * (len(job.telegrams) + (job.kind != "read")) for job in jobs)
        self.pressed = [job for job in jobs if job.timeout <= needed and len(jobs) > 1]
        self.longest = sum(job.timeout for job in jobs) + (len(jobs) * needed if self.pressed else 0)

    def again(self, job: PpiJob) -> bool:
        """Start a job once more whose time is over; False if it had time enough or another reason to fail."""
        cpu = self.rig.cpu
        status = cpu[_control(self.rig, job, "status")]
        if job not in self.pressed or status not in {WORDS["TIMEOUT"], WORDS["PORT_OCCUPIED"]}:
            return False
        cpu[_control(self.rig, job, "execute")] = False
        cpu.scan(step(self.rig))
        cpu[_control(self.rig, job, "execute")] = True
        return True


# --- all jobs at once, through OB1 ----------------------------------------------------------------------------


def together(rig: MasterRig) -> None:
    """All jobs started at once through OB1, round after round; then a port that hangs."""
    for number in range(ROUNDS):
        _round(rig, number)
    if len(rig.master.jobs) > 1 or not rig.plan.target.classic:
        _occupied(rig)


def _control(rig: MasterRig, job: PpiJob, signal: str) -> str:
    """Path of a signal as the caller supplies it: a flag, or a member of the control DB."""
    address = getattr(job.trigger, signal, None)
    if address is not None:
        return str(address)
    return f'"{rig.plan.control_db.name}".{job.member}.{signal}'


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
    crowd = Crowd(rig)
    for scan in range(crowd.longest // step(rig) + 100):
        cpu.scan(step(rig))
        if cpu.misuses:
            raise ScenarioError("misuse")
        for job in jobs:
            for signal in ("busy", "done", "error", "status"):
                if cpu[_control(rig, job, signal)] != cpu[f'"{rig.master.instance.name}".{job.pin(signal)}']:
                    raise ScenarioError(f"{signal} of {job.key} does not arrive where the caller looks for it")
            if cpu[_control(rig, job, "error")] and not crowd.again(job):
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
    cpu.scan(step(rig), 3)
    for job in jobs:
        if cpu[_control(rig, job, "status")] != WORDS["IDLE"]:
            raise ScenarioError(f"round {number}: {job.key} is not idle after execute has fallen")


def _compare(rig: MasterRig, job: PpiJob) -> None:
    name = rig.master.instance.name
    for value in job.outputs:
        if rig.shown(job, value) != rig.expected(job, value):
            raise ScenarioError(f"{value.member} of {job.key} is not what the station has")
        if rig.cpu[_control(rig, job, value.member)] != rig.cpu[f'"{name}".{job.pin(value.member)}']:
            raise ScenarioError(f"{value.member} of {job.key} does not reach the control DB")


def _occupied(rig: MasterRig) -> None:
    """A job that waits for the port for its whole timeout says so; afterwards everything works."""
    jobs, cpu = sorted(rig.master.jobs, key=lambda job: -job.timeout), rig.cpu
    rig.port.hang = True
    words: set[int] = set()
    for _ in range(2):  # on an S7-1200/1500 even a single job waits the second time: the module is still sending
        for job in jobs:  # the first one has the port, and no other waits as long
            cpu[_control(rig, job, "execute")] = True
            cpu.scan(50)
        slowest = max(job.timeout for job in jobs)
        for _ in range(slowest // 50 + 200):
            cpu.scan(50)
            words |= {int(str(cpu[_control(rig, job, "status")])) for job in jobs}  # a job with a cycle soon runs again
        passed = [job for job in jobs if cpu[_control(rig, job, "status")] == WORDS["PORT_OCCUPIED"]]
        for job in jobs:
            cpu[_control(rig, job, "execute")] = False
        cpu.scan(50, 2)
        late = [job.key for job in passed if cpu[_control(rig, job, "status")] != WORDS["IDLE"]]
        if late:
            raise ScenarioError(f"{', '.join(late)} did not get the port, and waits for it all the same")
    allowed = {WORDS[name] for name in ("TIMEOUT", "DRAIN_TIMEOUT", "PORT_OCCUPIED", "RUNNING", "STARTED")}
    if not words <= allowed or WORDS["PORT_OCCUPIED"] not in words:
        raise ScenarioError(f"a port that hangs gives {', '.join(f'16#{word:04X}' for word in sorted(words))}")
    rig.port.hang = False
    for _ in range(2000):
        cpu.scan(step(rig))
        if all(cpu[_control(rig, job, "status")] == WORDS["IDLE"] for job in jobs):
            break
    _round(rig, ROUNDS)


def behind(rig: MasterRig) -> None:
    """Every job behind the last one of the master, and behind one of another station, after power-up."""
    conduct, jobs = MasterConduct(rig), rig.master.jobs
    for job in jobs:
        strange = [other for other in jobs if other.station is not job.station]
        for before in dict.fromkeys((jobs[-1], *strange[-1:])):
            name = f"{job.key} after {before.key}"
            for rig.job, fresh in ((before, True), (job, False)):
                Run(loose(name=name, fresh=fresh), conduct, Statistics()).go()


def kept(rig: MasterRig) -> None:
    """The CPU stops and runs again between two jobs, or within one, and the instance keeps its values: the module has
    its own settings again, so the block sets the port, once, and the job, which begins anew, ends well.
    """
    name, port = rig.master.instance.name, rig.port
    for job in rig.master.jobs:
        rig.job = job
        for calls in (None, *MOMENTS):
            if calls is None:
                _first_telegram(rig)
            else:
                _once(rig, calls, step(rig))
            before = bytes(rig.cpu.db(name))
            rig.cpu.restart("warm")
            rig.cpu.db(name)[:] = before
            port.configured = port.conditioned = 0
            rig.new_values(job)
            _once(rig, 1, step(rig))
            if port.transmitting:
                raise ScenarioError(
                    f"{job.key} after a restart that kept the instance: it sends before it sets the port"
                )
            status = _end(rig)
            if status != DONE or (port.configured, port.conditioned) != (1, 1):
                found = f"16#{status:04X}, Port_Config set the port {port.configured} times"
                raise ScenarioError(f"{job.key} after a restart that kept the instance: {found}")


def _first_telegram(rig: MasterRig) -> None:
    """Up to the call after power-up that builds a telegram: the first one of a station may be none of the job's."""
    rig.cpu.restart("cold")
    tables = {telegram.request.home.name for telegram in (*rig.master.syncs, *rig.job.telegrams)}
    delivered = {table: bytes(rig.cpu.db(table)) for table in tables}
    for _ in range(ROW):
        _once(rig, 1, step(rig))
        if any(bytes(rig.cpu.db(table)) != data for table, data in delivered.items()):
            return
    raise ScenarioError(f"{rig.job.key} builds no telegram after power-up")


def _whole(rig: MasterRig) -> int:
    rig.new_values(rig.job)
    return _end(rig)


def _end(rig: MasterRig) -> int:
    status = _once(rig, (rig.job.timeout + DRAIN_MS) // step(rig) + 1, step(rig))
    rig.db.set(rig.pin("execute"), 0)
    rig.cpu.call(rig.db.block, step(rig))
    return status


# --- again and again ------------------------------------------------------------------------------------------


def cycles(rig: MasterRig) -> None:
    """While execute is TRUE a job with a cycle starts again when it is over; its result stays until then."""
    for job in (job for job in rig.master.jobs if job.cycle):
        rig.job = job
        rig.cpu.restart("cold")
        rig.new_values(rig.job)
        _repeat(rig)
        rig.cpu.restart("cold")
        module = rig.bus.ports.pop(rig.master.port)
        # A job that fails early, as its module is missing, keeps its error until the cycle is over
        begin = rig.cpu.clock
        status = _once(rig, rig.job.timeout // step(rig), step(rig))
        while rig.cpu.clock + step(rig) < begin + rig.job.cycle:
            rig.cpu.call(rig.db.block, step(rig))
            if rig.db.get(rig.pin("status")) != status or not rig.db.flag(rig.pin("error")):
                raise ScenarioError(f"{rig.job.key}: the error 16#{status:04X} does not stay until the next cycle")
        rig.bus.ports[rig.master.port] = module
    for job in (job for job in rig.master.jobs if not job.cycle):
        rig.job = job
        _rest(rig, max(job.cycle for job in rig.master.jobs))


def _repeat(rig: MasterRig) -> None:
    """The job starts ``ROUNDS`` times, each a cycle after the start before or as soon as that has ended."""
    job, cpu = rig.job, rig.cpu
    rig.db.set(rig.pin("execute"), 1)
    starts: list[int] = []
    ends: list[int] = []
    for _ in range((job.cycle + job.timeout) * ROUNDS // step(rig)):
        before = rig.db.get(rig.pin("status"))
        cpu.call(rig.db.block, step(rig))
        status = rig.db.get(rig.pin("status"))
        if status == WORDS["STARTED"]:
            starts.append(cpu.clock)
        elif not rig.db.flag(rig.pin("busy")):
            if status != DONE:
                raise ScenarioError(f"{job.key}: 16#{status:04X} instead of 16#0000 between two cycles")
            if before != DONE:
                ends.append(cpu.clock)
        if len(starts) == ROUNDS:
            break
    for start, end, again in zip(starts, ends, starts[1:], strict=False):
        wanted = max(start + job.cycle, end + step(rig))
        if not wanted <= again < wanted + step(rig):
            raise ScenarioError(f"{job.key} starts again after {again - start} ms, not {wanted - start}")
    if len(starts) < ROUNDS:
        raise ScenarioError(f"{job.key} starts {len(starts)} times, not {ROUNDS}")


def _rest(rig: MasterRig, longest: int) -> None:
    """A job without a cycle runs once, however long execute is TRUE and whatever starts again beside it."""
    rig.cpu.restart("cold")
    rig.new_values(rig.job)
    status = _once(rig, rig.job.timeout // step(rig), step(rig))
    beside = [job.pin("execute") for job in rig.master.jobs if job.cycle]
    for pin in beside:
        rig.db.set(pin, 1)
    for _ in range(2 * longest // step(rig)):
        rig.cpu.call(rig.db.block, step(rig))
        if rig.db.flag(rig.pin("busy")) or rig.db.get(rig.pin("status")) != status:
            raise ScenarioError(f"{rig.job.key} starts again although it has no cycle")
    for pin in beside:
        rig.db.set(pin, 0)


# --- the longest scan -----------------------------------------------------------------------------------------


def longest_scan(rig: MasterRig) -> None:
    """A message twice as long takes twice as many statements, even if a frame may begin at each of its bytes."""
    costs = [_noise(rig, octets) for octets in NOISE]
    for (short, less), (long, more) in itertools.pairwise(zip(NOISE, costs, strict=True)):
        if more * short > less * long * SLACK:
            raise ScenarioError(f"{short} bytes of noise take {less} statements, {long} bytes {more}")


def _noise(rig: MasterRig, octets: int) -> int:
    """Most statements of one call while so many start bytes come instead of a reply; the job works nevertheless."""
    rig.cpu.restart("cold")
    rig.port.sent.clear()
    most = max(_hearing(rig, bytes((START,)) * octets))
    status = rig.db.get(rig.pin("status"))
    if rig.cpu.misuses:
        raise ScenarioError("misuse")
    if status not in {DONE, WORDS["NO_ANSWER"], WORDS["TIMEOUT"]}:
        raise ScenarioError(f"{octets} bytes of noise end the job with 16#{status:04X}")
    return most


def _hearing(rig: MasterRig, message: bytes) -> Iterator[int]:
    """Run the job; a message comes instead of its first reply. Statements of each call."""
    rig.line.faults[:] = [Fault(FaultKind.SILENCE, times=1, at="poll")]
    rig.db.set(rig.pin("execute"), 1)
    for _ in range((rig.job.timeout + DRAIN_MS) // step(rig)):
        if message and rig.db.get("state") == State.REPLY:
            rig.port.deliver(message)
            message = b""
        before = rig.cpu.counters[rig.source.probes]
        rig.cpu.call(rig.db.block, step(rig))
        yield rig.statements(before)
        if not rig.db.flag(rig.pin("busy")):
            break
    rig.db.set(rig.pin("execute"), 0)


# --- many in a row --------------------------------------------------------------------------------------------


def row(rig: MasterRig) -> None:
    """600 jobs in a row: references never repeat and never are 0, frame count bits alternate throughout."""
    references: list[int] = []
    for number in range(ROW):
        if number == ROW // 2:
            rig.cpu[f'"{rig.db.block}".statReference'] = 32_766  # the reference starts again
        rig.port.sent.clear()
        ended = _once(rig, rig.job.timeout // step(rig), step(rig))
        if ended != DONE or rig.db.get("retries"):
            raise ScenarioError(f"job {number + 1} in a row ends with 16#{ended:04X}")
        rig.db.set(rig.pin("execute"), 0)
        rig.cpu.call(rig.db.block, step(rig))
        frames = (examine_frame(data)[0] for _, data in rig.port.sent)
        references += [int.from_bytes(frame.pdu[4:6]) for frame in frames if isinstance(frame, VariableFrame)]
    twice = any(a == b for a, b in itertools.pairwise(references))
    if 0 in references or twice or len(references) < ROW or max(references) != 32_767:
        raise ScenarioError("PDU references repeat or are 0")
    if rig.db.get("pduReference") != references[-1]:
        raise ScenarioError("diagnostics.pduReference is not that of the last request")


def full_counters(rig: MasterRig) -> None:
    """The counts of frames passed over and damaged stay at their highest value."""
    for message, name in ((others(rig.master), "ignored"), (b"\xff", "damaged")):
        rig.cpu[f'"{rig.db.block}".stat{name.capitalize()}'] = FULL - 1
        for _ in range(2):
            deque(_hearing(rig, message), maxlen=0)
            rig.cpu.call(rig.db.block, step(rig))
            if rig.db.get(f"{name}Frames") != FULL:
                raise ScenarioError(f"diagnostics.{name}Frames goes from {FULL - 1} to {rig.db.get(f'{name}Frames')}")


def _once(rig: MasterRig, scans: int, length: int) -> int:
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
    """The buffer DB has another number than the block expects: nothing is sent, whatever lies in the wrong one."""
    rig.job = next((job for job in rig.master.jobs if job.cycle), rig.job)
    wrong = rig.cpu.db(rig.plan.control_db.name)
    for byte in range(0x100):
        wrong[0] = byte
        status = _once(rig, 20, step(rig))
        rig.cpu.call(rig.db.block, 1)
        rig.db.set(rig.pin("execute"), 0)
        rig.cpu.call(rig.db.block, step(rig))
        if status != WORDS["WRONG_DB"] or rig.port.sent:
            raise ScenarioError(f"the wrong number gives 16#{status:04X}, not 16#8204")
