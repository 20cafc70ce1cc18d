"""What goes on around the calls of a PPI master, and what must hold behind every one of them and at the end."""

from __future__ import annotations

from dataclasses import replace

from plcgen.ppi.proof.rig import MasterRig, check_job_tables, litter
from plcgen.ppi.proof.scenario import LOST_SCANS, PpiScenario, loose
from plcgen.ppi.proof.words import CLOCK_END, DONE, DRAIN_MS, GAP_BITS, LEAD, LONGEST, STATES_OF, WORDS, State
from plcgen.ppi.sim import FaultKind
from plcgen.ppi.wire.areas import Function
from plcgen.ppi.wire.fdl import examine_frame
from plcgen.ppi.wire.model import FCB, FIRST, FixedFrame, VariableFrame
from plcgen.proof.runner import Run
from plcgen.proof.scenario import ScenarioError

REFERENCE = slice(11, 13)
CODE, CHECK, START = 6, -2, 0x68
WITH_DATA = frozenset({0x08, 0x0A})
"""Function codes of a reply (EN 50170): data, data of high priority."""


class End:
    """The checks of a finished run; ``codes`` are the function codes last sent to each station, kept up to date."""

    def __init__(self, rig: MasterRig, scenario: PpiScenario, codes: dict[int, int]) -> None:
        self.rig, self.scenario, self.codes, self.job = rig, scenario, codes, rig.job

    def check(self, status: int) -> None:
        """Everything, the frames before what is said of the last one."""
        if self.scenario.pace is not None:
            # the silence after a frame is what the constants say, and a few scans; a CP 341 moves 32 bytes in each
            port = self.rig.port
            sent = port.sent
            begins = [*(end - len(data) * port.character for end, data in sent[1:]), port.time]
            scans = 8 + (max(len(data) for _, data in sent) // 32 if self.rig.plan.target.classic else 0)
            slack = scans * self.scenario.scan + 2 * (port.gap + port.character)
            for number, ((end, _), begin) in enumerate(zip(sent, begins, strict=True), 1):
                wanted = self.scenario.pace[2] if number == len(sent) else self.scenario.pace[min(number, 2) - 1]
                if not wanted - 1 <= begin - end <= wanted + slack:
                    raise ScenarioError(f"{begin - end:.0f} ms after frame {number} instead of {wanted}")
        if status == DONE:
            self.check_values()
        self.check_diagnostics(status)
        self.check_frames(status)
        if not self.scenario.restarts and status in {DONE, WORDS["ITEM_ERROR"]}:
            check_job_tables(self.rig, self.job, refused=status != DONE)
        self.check_last(status)
        self.check_heard(status)

    def check_heard(self, status: int) -> None:
        """No job says that nothing came, or only E5, if the block has taken the reply to its last request."""
        if status not in {WORDS["NO_ANSWER"], WORDS["NOT_READY"]}:
            return
        asked = next((data[REFERENCE] for _, data in reversed(self.rig.port.sent) if data[0] == START), None)
        for message in self.rig.port.fetched:
            frame, problems = examine_frame(message)
            if problems or not isinstance(frame, VariableFrame) or not self.scenario.intact:
                continue
            way = frame.source, frame.function in WITH_DATA, message[REFERENCE]
            if way == (self.job.station.address, True, asked):
                raise ScenarioError(f"16#{status:04X}, although the reply came: {message.hex(' ').upper()}")

    def check_last(self, status: int) -> None:
        """What the diagnostics say of the last telegram and its last frame."""
        rig, job = self.rig, self.job
        numbers = [telegram.number for telegram in job.telegrams]
        number, code = rig.db.get("telegram"), self.codes.get(job.station.address, 0)
        if number != numbers[-1] if status == DONE else number not in numbers:
            raise ScenarioError(f"diagnostics.telegram is {number} at the end of telegrams {numbers}")
        if rig.db.get("functionCode") != code and not self.scenario.restarts:
            raise ScenarioError(f"diagnostics.functionCode is {rig.db.get('functionCode'):02X}h instead of {code:02X}h")

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
        errors = scenario.errors if status == WORDS["ITEM_ERROR"] else {}
        out_of_time = status == WORDS["TIMEOUT"]
        for position, word in enumerate(rig.errors(), 1):
            wanted = errors.get(position, 0)
            if word != wanted:
                raise ScenarioError(f"errors[{position}] is 16#{word:04X} instead of 16#{wanted:04X}")
        expected = {
            "failedItem": min(errors, default=0),
            "headerError": scenario.header if status == WORDS["REFUSED"] else 0,
            # a job whose time is over may never have got as far as the failure of its module
            "moduleStatus": rig.db.get("moduleStatus") and scenario.module if out_of_time else scenario.module,
            "job": job.number,
            "state": 0,
        }
        seen = len(job.telegrams) == 1 or status != DONE  # the figures are those of the last telegram
        if scenario.retries is not None and seen:
            expected["retries"] = scenario.retries
        if scenario.polls is not None and seen:
            expected["polls"] = scenario.polls
        for name, value in expected.items():
            if rig.db.get(name) != value and not scenario.restarts:
                raise ScenarioError(f"diagnostics.{name} is {rig.db.get(name)} instead of {value} (16#{status:04X})")

    def check_frames(self, status: int) -> None:
        """Requests are the planned telegrams in turn, FCB alternates, a repetition is the same, nothing runs twice."""
        rig, job = self.rig, self.job
        syncs = [sync.request.data for sync in rig.master.syncs if sync.station is job.station]
        planned = [rig.planned(job, telegram) for telegram in job.telegrams]
        if job.kind != "read" and job.station.address not in self.codes:
            planned = [*syncs, *planned]
        requests: list[bytes] = []
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
                # the function code of a new frame: 6Ch first, then the frame count bit alternates
                before = self.codes.get(frame.destination)
                wanted = FIRST if before is None else 0x5C | (~before & FCB)
                if frame.function != wanted and not self.scenario.restarts:
                    raise ScenarioError(f"function code {frame.function:02X}h follows {before or 0:02X}h")
                self.codes[frame.destination] = frame.function
                repeated = 0
                asked = asked + 1 if isinstance(frame, FixedFrame) else 0
            last = data
            if asked > rig.master.polls:
                raise ScenarioError(f"{asked} polls of one request")
            if isinstance(frame, VariableFrame) and not repeated:
                requests.append(data)
            if repeated and self.scenario.measured:
                raise ScenarioError(f"{data.hex(' ')} was repeated although nothing was lost")
        if self.scenario.restarts:
            _planned(requests, [*syncs, *planned])
        else:
            _in_turn(requests, planned, whole=status == DONE)
        self.check_sync()
        if status not in {DONE, WORDS["ITEM_ERROR"], WORDS["REFUSED"]}:
            self.codes.pop(job.station.address, None)
        self.check_executions(status)

    def check_sync(self) -> None:
        """The table of a harmless read in front of a job is the last one that was sent."""
        for sync in self.rig.master.syncs:
            wanted = sync.request.data
            requests = [data for _, data in self.rig.port.sent if len(data) == len(wanted)]
            sent = [data for data in requests if _neutral(data) == _neutral(wanted)]
            table = bytes(self.rig.cpu.db(sync.request.home.name)[LEAD : LEAD + len(wanted)])
            if sync.station is self.job.station and sent and table != sent[-1]:
                raise ScenarioError(f'"{sync.request.home.name}" holds {table.hex(" ")}, sent was {sent[-1].hex(" ")}')

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


def _in_turn(requests: list[bytes], planned: list[bytes], *, whole: bool) -> None:
    """Every request is the planned telegram whose turn it is; ``whole``: all of them were sent."""
    for sent, wanted in zip(requests, planned, strict=False):
        _planned([sent], [wanted])
    _planned(requests[len(planned) :], [])
    if whole and len(requests) < len(planned):
        raise ScenarioError(f"sent were {len(requests)} requests of {len(planned)}")


def _planned(requests: list[bytes], planned: list[bytes]) -> None:
    known = {_neutral(request) for request in planned}
    for sent in requests:
        if _neutral(sent) not in known:
            raise ScenarioError(f"sent {sent.hex(' ').upper()}, which is not the planned telegram")


def _neutral(frame: bytes) -> bytes:
    """A request without what changes at run time: function code, reference, FCS."""
    image = bytearray(frame)
    image[CODE] = FIRST
    image[REFERENCE] = b"\0\0"
    image[CHECK] = 0
    return bytes(image)


LATE_CALLS, LATE_MS = 15, 100
SILENT_CALLS = 4
"""So many calls behind the last answer: the longest one takes 300 ms to arrive, and one call fetches it."""


class MasterConduct:
    """The jobs of one master, run by run; ``rig.job`` is the one that runs, ``codes`` the last code of each station.

    ``configured`` says that the block need not set the port again, ``longest`` is how many statements it executed in
    one call of a run that is measured.
    """

    def __init__(self, rig: MasterRig) -> None:
        self.rig = rig
        self.codes: dict[int, int] = {}
        self.configured = False
        self.longest = 0
        self.waits = False
        self.counts = (0, 0)
        self.limits = StateLimits(rig)

    def plain(self, name: str) -> PpiScenario:
        """A run of which only the result counts."""
        return loose(name=name)

    def title(self, scenario: PpiScenario) -> str:
        """The job that runs and its scenario."""
        return f"{self.rig.job.key}, {scenario.name}"

    def outputs(self) -> object:
        """All value outputs."""
        return self.rig.outputs()

    def where(self) -> str:
        """The state may be any of many."""
        return "busy"

    def holds(self) -> bool:
        """A job with a cycle goes on."""
        return not self.rig.job.cycle

    def begin(self, run: Run[PpiScenario]) -> int:
        """Set up stations, line, port and clock."""
        rig, scenario, port = self.rig, run.scenario, self.rig.port
        if scenario.fresh:
            rig.cpu.restart("cold")
            self.codes.clear()
            self.configured = False
        rig.new_values(rig.job)
        litter(rig)
        rig.line.faults[:] = [replace(fault) for fault in scenario.faults]
        rig.line.journal.clear()
        rig.executed.clear()
        port.sent.clear()
        port.fetched.clear()
        port.faults, port.hang, port.refusals = dict(scenario.port), scenario.hang, dict(scenario.refusals)
        rig.edited.edit, rig.edited.bend = scenario.edit, scenario.bend
        rig.edited.broken, rig.edited.again, rig.edited.rest = scenario.broken, scenario.again, scenario.rest
        rig.edited.alone(scenario.only, unready=scenario.unready)
        port.echo, port.stuck = scenario.echo, scenario.stuck
        port.transmissions = port.configured = port.conditioned = 0
        if scenario.forgets:
            port.power_up()
        if scenario.gone:
            rig.bus.ports.pop(rig.master.port, None)
        if scenario.clock is not None:
            self.set_clock(scenario.clock)
        self.counts = rig.counts()
        slack = 8 * max(scenario.scan, rig.master.ob1_cycle)
        return rig.job.timeout * (1 + len(scenario.happens)) + DRAIN_MS + slack

    def set_clock(self, clock: int) -> None:
        """Let the clock of the block stand shortly before its end."""
        rig, name = self.rig, self.rig.db.block
        if rig.plan.target.classic:
            rig.cpu.clock = 2**31 - 1 - (CLOCK_END - clock)
        else:
            value = rig.cpu.clock - clock & 0xFFFFFFFF
            rig.cpu[f'"{name}".instClock.START'] = value - (1 << 32) if value >> 31 else value
            rig.cpu[f'"{name}".instClock.ET'] = clock
        rig.cpu.call(name, 0)

    def happen(self, run: Run[PpiScenario], happening: str) -> None:
        """A restart: the frame count begins again. Or a scan that lasts as long as the timeout, or as the
        module is waited for if that is longer.
        """
        if happening == "jump":
            self.rig.cpu.clock += max(self.rig.job.timeout, DRAIN_MS)
            return
        self.codes.clear()
        self.configured = False

    def scan(self, run: Run[PpiScenario]) -> int:
        """Inputs count in the call that starts the job; later they are something else."""
        self.rig.put_inputs(wrong=not run.fresh)
        longest = self.rig.master.ob1_cycle
        if run.scenario.twice or run.scenario.unready:
            known, self.waits = self.waits, self.rig.db.get("state") == State.WAIT
            if self.waits > known or (run.scenario.twice and run.scans % 2 == 0):
                return 0
        return run.random.randint(0, longest) if run.scenario.wild else min(run.scenario.scan, longest)

    def start(self, run: Run[PpiScenario]) -> None:
        """Everything of the job before is gone."""
        if any(self.rig.errors()):
            raise ScenarioError("the errors still show the job before")

    def observe(self, run: Run[PpiScenario]) -> None:
        """No other job moves."""
        if run.scenario.measured:
            self.longest = max(self.longest, self.rig.statements(run.before))
        self.limits.observe(run)
        other = self.rig.moving()
        if other is not None:
            raise ScenarioError(f'job "{other.key}" moves although nobody started it')

    def end(self, run: Run[PpiScenario], status: int) -> None:
        """Values, diagnostics, frames, tables."""
        if (
            not self.rig.plan.target.classic
            and not run.scenario.restarts
            and not run.scenario.gone
            and not run.scenario.refusals
        ):
            done = status == DONE
            # Port_Config and Receive_Config run after power-up and after a failure, once, and not again; ``done``: the
            # module has what they set.
            wanted, port = int(not self.configured), self.rig.port
            if port.configured != wanted or port.conditioned != wanted:
                found = f"Port_Config set the port {port.configured} times, Receive_Config {port.conditioned} times"
                raise ScenarioError(f"{found}, not {wanted}")
            gap, most = port.settings.gap_bits, port.settings.max_length
            if done and not port.settings.any_start:
                raise ScenarioError("a message does not begin with any character")
            if done and (gap, most) != (GAP_BITS, LONGEST):
                raise ScenarioError(f"a message ends after a gap of {gap} bit times or {most} bytes")
        self.configured = status in {DONE, WORDS["ITEM_ERROR"], WORDS["REFUSED"]}
        End(self.rig, run.scenario, self.codes).check(status)
        if run.scenario.clock is not None and not self.rig.plan.target.classic and self.rig.clock() >= CLOCK_END:
            raise ScenarioError(f"the clock of the block runs beyond {CLOCK_END} ms")
        if status != WORDS["TIMEOUT"]:  # what would have been counted later was not there
            self.check_counts(run.scenario)

    def check_counts(self, scenario: PpiScenario) -> None:
        """Frames that were passed over, and damaged ones."""
        names = "ignored", "damaged"
        wanted = scenario.ignored, scenario.damaged
        for name, before, now, more in zip(names, self.counts, self.rig.counts(), wanted, strict=True):
            if more is not None and now - before != more:
                raise ScenarioError(f"diagnostics.{name}Frames counts {now - before} frames instead of {more}")

    def behind(self, run: Run[PpiScenario]) -> None:
        """The line and the module are well again."""
        rig = self.rig
        rig.port.hang, rig.port.faults, rig.port.refusals = False, {}, {}
        rig.edited.edit = rig.edited.bend = None
        rig.edited.broken = rig.edited.again = 0
        rig.edited.alone(0, unready=False)
        rig.port.echo = rig.port.stuck = False
        rig.line.faults.clear()
        rig.bus.ports[rig.master.port] = rig.port

    def rest(self, run: Run[PpiScenario]) -> None:
        """Late answers arrive while nobody waits."""
        silent = 0
        for _ in range(LATE_CALLS):
            silent = silent + 1 if self.rig.quiet() else 0
            self.rig.cpu.call(self.rig.db.block, LATE_MS)
            if silent == SILENT_CALLS:
                break


class StateLimits:
    """Follows ``diagnostics.state`` call by call.

    ``begun`` is when the job started; ``state`` holds since ``since``, all in ms of the CPU's clock.
    """

    def __init__(self, rig: MasterRig) -> None:
        self.rig = rig
        self.known = STATES_OF["CP 341" if rig.plan.target.classic else "CM"]
        master = rig.master
        self.limits = {State.ACK: master.ack_timeout, State.REPLY: master.reply_timeout, State.DRAIN: DRAIN_MS}
        self.state = self.begun = self.since = self.retries = 0

    def observe(self, run: Run[PpiScenario]) -> None:
        """What must hold after a call."""
        state, now, busy = self.rig.db.get("state"), self.rig.cpu.clock, run.seen[0]
        lost = run.scenario.clock is not None and not self.rig.plan.target.classic
        slack = LOST_SCANS * run.scenario.scan if lost else 0
        if run.fresh:
            self.begun = now
        if state not in self.known:
            raise ScenarioError(f"diagnostics.state is {state}, which a master with this module does not have")
        if busy and state == State.IDLE and self.rig.port.sent:
            raise ScenarioError("diagnostics.state is 0 while the job runs")
        if busy and state != State.DRAIN and now - self.begun >= self.rig.job.timeout + slack:
            raise ScenarioError(f"still in state {state} when the job's timeout is over")
        if state != self.state:
            refused = any(each.kind is FaultKind.NACK for each in run.scenario.faults)
            self._change(state, now, exact=run.scenario.pace is not None and not refused)
        elif state in self.limits and now - self.since >= self.limits[State(state)] + slack:
            raise ScenarioError(f"still in state {state} {now - self.since} ms after it began")

    def _change(self, state: int, now: int, *, exact: bool) -> None:
        """Another state: it begins, and the one before has not ended too early.

        ``exact``: nothing but its time ends ACK, REPLY and a pause, or the station is not ready.
        """
        retries, passed = self.rig.db.get("retries"), now - self.since
        if exact and (retries > self.retries or self.state == State.WAIT):
            least = self.limits.get(State(self.state), 0)
            if self.state != State.DRAIN and passed < least:
                raise ScenarioError(f"state {self.state} ends {passed} ms after it began, not {least}")
        if state == State.WAIT:
            master = self.rig.master
            self.limits[State.WAIT] = master.retry_pause if retries > self.retries else master.poll_pause
        self.state, self.since, self.retries = state, now, retries
