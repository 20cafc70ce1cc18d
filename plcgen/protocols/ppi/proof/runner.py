"""Run one scenario of a PPI job scan by scan and hold the master to what it must do in every scan and at the end."""

from __future__ import annotations

import random
from dataclasses import replace

from plcgen.protocols.ds47.proof.rig import ScenarioError
from plcgen.protocols.ds47.proof.runner import Failure, Statistics
from plcgen.protocols.ppi.plan.nouns import PpiJob
from plcgen.protocols.ppi.proof.rig import MasterRig
from plcgen.protocols.ppi.proof.scenario import DONE, WORDS, PpiScenario
from plcgen.protocols.ppi.proof.tables import check_tables, litter
from plcgen.protocols.ppi.wire.areas import Function
from plcgen.protocols.ppi.wire.fdl import examine_frame
from plcgen.protocols.ppi.wire.model import FCB, FIRST, FixedFrame, VariableFrame
from plcgen.protocols.ppi.words import CLOCK_END, DRAIN_MS

MAX_SCANS = 40_000
REFERENCE = slice(11, 13)
CODE, CHECK = 6, -2


class MasterRunner:
    """Runs scenarios of the jobs of one master one after the other on one CPU."""

    def __init__(self, rig: MasterRig) -> None:
        self.rig = rig
        self.statistics = Statistics()
        self.scan = 0
        self.name = ""
        self.before: list[int] = []
        self.codes: dict[int, int] = {}

    # --- entry ----------------------------------------------------------------------------------------

    def try_run(self, job: PpiJob, scenario: PpiScenario, *, follow: bool = True) -> Failure | None:
        """Run a scenario and a job after it; None if everything was right."""
        try:
            self.run(job, scenario)
            if follow:
                after = PpiScenario(name=f"the job after: {scenario.name}", retries=None, polls=None)
                self.run(job, after)
        except ScenarioError as problem:
            return self.failure(job, str(problem))
        except Exception as problem:  # noqa: BLE001 - changed sources may make the simulated CPU itself fail
            return self.failure(job, f"the simulated CPU stopped: {type(problem).__name__} {problem}")
        return None

    def failure(self, job: PpiJob, message: str) -> Failure:
        """Where the block was: the misuse, or the last statement that not every call executes."""
        name = f"{job.key}, {self.name}"
        misuses = self.rig.cpu.misuses
        if misuses:
            return Failure(name, self.scan, str(misuses[0]), misuses[0].file, misuses[0].line)
        probes, counters = self.rig.program.probes, self.rig.cpu.coverage
        found = [
            probes[i]
            for i, old in zip(self.rig.probes, self.before, strict=False)
            if counters[i] > old and probes[i].kind == "statement"
        ]
        margin = min((probe.column for probe in found), default=0)
        inner = [probe for probe in found if probe.column > margin] or found
        return Failure(name, self.scan, message, self.rig.file, max((probe.line for probe in inner), default=1))

    # --- one run --------------------------------------------------------------------------------------

    def run(self, job: PpiJob, scenario: PpiScenario) -> None:
        """Run a job from the rising edge of execute to its end. Raises ScenarioError."""
        rig = self.rig
        self.name, self.scenario, self.job, self.scan = scenario.name, scenario, job, 0
        self.prepare()
        self.random = random.Random(scenario.name)  # noqa: S311 - scan lengths
        self.execute, self.started_new = True, True
        self.outputs = rig.outputs()
        slack = 8 * (50 if scenario.jitter else scenario.scan)
        latest = job.timeout * (1 + len(scenario.happens)) + DRAIN_MS + slack
        begin = rig.cpu.clock
        while True:
            self.step()
            if rig.flag(job, "done") or rig.flag(job, "error"):
                break
            if rig.cpu.clock - begin > latest or self.scan > MAX_SCANS:
                self.statistics.hangs += 1
                raise ScenarioError(f"still busy after {latest} ms")
        self.took = rig.cpu.clock - begin
        self.statistics.runs += 1
        self.statistics.scans += self.scan
        self.statistics.longest = max(self.statistics.longest, self.scan)
        self.check_end()
        self.hold()

    def prepare(self) -> None:
        """Set up stations, line, port and clock."""
        rig, scenario, job = self.rig, self.scenario, self.job
        port = rig.port
        if scenario.fresh:
            rig.cpu.restart("cold")
            self.codes.clear()
        rig.new_values(job)
        litter(rig)
        rig.line.faults[:] = [replace(fault) for fault in scenario.faults]
        rig.line.journal.clear()
        rig.executed.clear()
        port.sent.clear()
        port.faults, port.hang, port.reset_fault = dict(scenario.port), scenario.hang, scenario.reset
        rig.edited.edit = scenario.edit
        port.transmissions = 0
        if scenario.gone:
            rig.bus.ports.pop(rig.master.port, None)
        if scenario.clock is not None:
            self.set_clock(scenario.clock)

    def set_clock(self, clock: int) -> None:
        """Let the clock of the block stand shortly before its end."""
        rig = self.rig
        if rig.plan.target.classic:
            rig.cpu.clock = 2**31 - 1 - (CLOCK_END - clock)
        else:
            spot = rig.cpu.program.link.find(rig.master.instance.name)
            path = f'"{spot.name}".instClock.START' if spot is not None else ""
            rig.cpu[path] = _signed(rig.cpu.clock - clock)
            rig.cpu[path.replace("START", "ET")] = clock
        rig.cpu.call(rig.master.instance.name, 0)

    def step(self) -> None:
        """One scan: what happens around the block, its call, and what must hold after every call."""
        rig, job = self.rig, self.job
        self.scan += 1
        happening = self.scenario.happens.get(self.scan)
        if happening == "drop":
            self.execute = False
        elif happening is not None:
            rig.cpu.restart("cold" if happening == "cold" else "warm")
            self.started_new = not rig.flag(job, "busy")
            self.outputs = rig.outputs()
            self.codes.clear()
        rig.put_inputs(job)
        rig.set_flag(job, "execute", value=self.execute)
        coverage = rig.cpu.coverage
        self.before = [coverage[i] for i in rig.probes]
        length = self.random.randint(1, 50) if self.scenario.jitter else self.scenario.scan
        rig.cpu.call(rig.master.instance.name, length)
        self.observe()

    def observe(self) -> None:
        """What must hold after every call."""
        rig, job = self.rig, self.job
        if rig.cpu.misuses or rig.cpu.faulted:
            raise ScenarioError("misuse")
        busy, done, error = (rig.flag(job, name) for name in ("busy", "done", "error"))
        status = rig.status(job)
        if busy + done + error != 1:
            raise ScenarioError(f"busy {busy}, done {done}, error {error} at the same time")
        wanted = WORDS["STARTED" if self.started_new else "RUNNING"]
        if busy and status != wanted:
            raise ScenarioError(f"status is 16#{status:04X} while the job runs, not 16#{wanted:04X}")
        if busy and self.started_new and any(rig.errors(job)):
            raise ScenarioError("the errors still show the job before")
        if not done and rig.outputs() != self.outputs:
            raise ScenarioError("a value output changed although the job is not done")
        for other in rig.master.jobs:
            if other is not job and (rig.flag(other, "busy") or rig.status(other) != WORDS["IDLE"]):
                raise ScenarioError(f'job "{other.key}" moves although nobody started it')
        self.started_new = False

    # --- the end --------------------------------------------------------------------------------------

    def check_end(self) -> None:
        """Result, values, errors, diagnostics, frames."""
        rig, scenario, job = self.rig, self.scenario, self.job
        status = rig.status(job)
        if status not in scenario.status:
            wanted = " or ".join(f"16#{word:04X}" for word in scenario.status)
            raise ScenarioError(f"status is 16#{status:04X} instead of {wanted}")
        if rig.flag(job, "done") != (status == DONE):
            raise ScenarioError(f"done is {rig.flag(job, 'done')} with status 16#{status:04X}")
        if scenario.took is not None and not scenario.took[0] <= self.took <= scenario.took[1]:
            raise ScenarioError(f"took {self.took} ms instead of {scenario.took[0]} to {scenario.took[1]}")
        if scenario.pace is not None:
            self.check_pace(scenario.pace)
        if status == DONE:
            self.check_values()
        self.check_diagnostics(status)
        self.check_frames(status)
        if not scenario.happens and status in {DONE, WORDS["ITEM_ERROR"]}:
            check_tables(rig, job, refused=status != DONE)
        self.check_last(status)

    def check_pace(self, pace: tuple[int, int, int]) -> None:
        """The silence behind every frame is what the constants say, and a few scans."""
        port = self.rig.port
        sent = port.sent
        begins = [*(end - len(data) * port.character for end, data in sent[1:]), port.time]
        slack = 8 * self.scenario.scan + 2 * (port.gap + port.character)
        for number, ((end, _), begin) in enumerate(zip(sent, begins, strict=True), 1):
            wanted = pace[2] if number == len(sent) else pace[min(number, 2) - 1]
            if not wanted - 1 <= begin - end <= wanted + slack:
                raise ScenarioError(f"{begin - end:.0f} ms behind frame {number} instead of {wanted}")

    def check_last(self, status: int) -> None:
        """What the diagnostics say of the last telegram and its last frame."""
        rig, job = self.rig, self.job
        numbers = [telegram.number for telegram in job.telegrams]
        number, code = rig.get("telegram"), self.codes.get(job.station.address, 0)
        if number != numbers[-1] if status == DONE else number not in numbers:
            raise ScenarioError(f"diagnostics.telegram is {number} at the end of telegrams {numbers}")
        if rig.get("functionCode") != code and not self.scenario.happens:
            raise ScenarioError(f"diagnostics.functionCode is {rig.get('functionCode'):02X}h instead of {code:02X}h")

    def check_values(self) -> None:
        """Outputs hold what the station has; the station holds what was written, and its mode is the one wanted."""
        rig, job = self.rig, self.job
        for value in job.outputs:
            found, expected = rig.shown(job, value), rig.expected(job, value)
            if found != expected:
                raise ScenarioError(f"{value.member} is {found.hex(' ')}, the station has {expected.hex(' ')}")
        for value in job.values if job.kind == "write" else ():
            data = rig.inputs.get(job.pin(value.member), value.data) if not value.constant else value.data
            if rig.memory(job, value.item) != data:
                raise ScenarioError(f"{value.label} was not written")
        mode = rig.station(job).mode.value
        if job.kind in {"run", "stop"} and mode != job.kind:
            raise ScenarioError(f"the CPU is in {mode}, not in {job.kind}")

    def check_diagnostics(self, status: int) -> None:
        """Errors per address and the details for the maintenance engineer."""
        rig, scenario, job = self.rig, self.scenario, self.job
        for position, word in enumerate(rig.errors(job), 1):
            wanted = scenario.errors.get(position, 0)
            if word != wanted:
                raise ScenarioError(f"errors[{position}] is 16#{word:04X} instead of 16#{wanted:04X}")
        expected = {
            "failedItem": min(scenario.errors, default=0),
            "headerError": scenario.header,
            "moduleStatus": scenario.module,
            "job": job.number,
            "state": 0,
        }
        seen = len(job.telegrams) == 1 or status != DONE  # the figures are those of the last telegram
        if scenario.retries is not None and seen:
            expected["retries"] = scenario.retries
        if scenario.polls is not None and seen:
            expected["polls"] = scenario.polls
        for name, value in expected.items():
            if rig.get(name) != value and not scenario.happens:
                raise ScenarioError(f"diagnostics.{name} is {rig.get(name)} instead of {value} (16#{status:04X})")

    def check_frames(self, status: int) -> None:
        """Every request is a planned telegram, FCB alternates, a repetition is the same, nothing runs twice."""
        rig, job = self.rig, self.job
        planned = [rig.planned(job, telegram) for telegram in job.telegrams]
        planned += [sync.request.data for sync in rig.master.syncs if sync.station is job.station]
        last: bytes | None = None
        repeated = asked = 0
        for data in (data for _, data in rig.port.sent):
            frame, problems = examine_frame(data)
            if problems or not isinstance(frame, FixedFrame | VariableFrame):
                raise ScenarioError(f"sent {data.hex(' ')}: {problems[0].message if problems else 'no frame'}")
            if data == last:
                repeated += 1
                if repeated > rig.master.retries:
                    raise ScenarioError(f"{data.hex(' ')} was repeated {repeated} times")
            else:
                self.check_code(frame)
                repeated = 0
                asked = asked + 1 if isinstance(frame, FixedFrame) else 0
            last = data
            if asked > rig.master.polls:
                raise ScenarioError(f"{asked} polls of one request")
            if isinstance(frame, VariableFrame) and _neutral(data) not in {_neutral(request) for request in planned}:
                raise ScenarioError(f"sent {data.hex(' ').upper()}, which is none of the planned telegrams")
        if status not in {DONE, WORDS["ITEM_ERROR"], WORDS["REFUSED"]}:
            self.codes.pop(job.station.address, None)
        self.check_executions(status)

    def check_code(self, frame: FixedFrame | VariableFrame) -> None:
        """The function code of a new frame: 6Ch first, then the frame count bit alternates."""
        before = self.codes.get(frame.destination)
        wanted = FIRST if before is None else 0x5C | (~before & FCB)
        if frame.function != wanted and not self.scenario.happens:
            raise ScenarioError(f"function code {frame.function:02X}h follows {before or 0:02X}h")
        self.codes[frame.destination] = frame.function

    def check_executions(self, status: int) -> None:
        """Nothing but a read is executed twice; a job that is done was executed."""
        job = self.job
        seen: set[bytes] = set()
        for pdu in self.rig.executed:
            if pdu in seen and pdu[10] != Function.READ:
                raise ScenarioError(f"{pdu.hex(' ')} was executed twice")
            seen.add(pdu)
        own = [pdu for pdu in seen if job.kind == "read" or pdu[10] != Function.READ]
        runs = sum(happening != "drop" for happening in self.scenario.happens.values()) + 1
        if status == DONE and not len(job.telegrams) <= len(own) <= runs * (len(job.telegrams) + 1):
            raise ScenarioError(f"{len(own)} requests were executed for {len(job.telegrams)} telegrams")

    def hold(self) -> None:
        """The result stays until execute falls, for one call at least, then the job is idle and the line is quiet."""
        rig, job, scenario = self.rig, self.job, self.scenario
        status, values = rig.status(job), rig.outputs()
        if self.execute and not job.cycle:
            for _ in range(2):
                rig.cpu.call(rig.master.instance.name, scenario.scan)
                shown = rig.flag(job, "busy"), rig.flag(job, "done"), rig.flag(job, "error"), rig.status(job)
                if shown != (False, status == DONE, status != DONE, status):
                    raise ScenarioError("the result does not stay while execute is TRUE")
        rig.port.hang = False
        rig.port.faults, rig.port.reset_fault = {}, 0
        rig.edited.edit = None
        rig.line.faults.clear()
        rig.bus.ports[rig.master.port] = rig.port
        rig.set_flag(job, "execute", value=False)
        rig.cpu.call(rig.master.instance.name, scenario.scan)
        if rig.flag(job, "busy") or rig.flag(job, "done") or rig.flag(job, "error") or rig.status(job) != WORDS["IDLE"]:
            raise ScenarioError(f"not idle after execute has fallen: 16#{rig.status(job):04X}")
        if rig.outputs() != values:
            raise ScenarioError("a value output changed after the end of the job")
        for _ in range(15):  # late answers arrive while nobody waits
            rig.cpu.call(rig.master.instance.name, 100)
        if rig.cpu.misuses:
            raise ScenarioError("misuse")


def _neutral(frame: bytes) -> bytes:
    """A request without what changes at run time: function code, reference, FCS."""
    image = bytearray(frame)
    image[CODE] = FIRST
    image[REFERENCE] = b"\0\0"
    image[CHECK] = 0
    return bytes(image)


def _signed(value: int) -> int:
    value &= 0xFFFFFFFF
    return value - (1 << 32) if value >> 31 else value
