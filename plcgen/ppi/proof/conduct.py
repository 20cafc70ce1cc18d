"""What goes on around the calls of a PPI master, and what must hold behind every one of them and at the end."""

from __future__ import annotations

from dataclasses import replace

from plcgen.ppi.proof.end import End
from plcgen.ppi.proof.rig import MasterRig
from plcgen.ppi.proof.scenario import LOST_SCANS, PpiScenario, loose
from plcgen.ppi.proof.tables import litter
from plcgen.ppi.proof.words import CLOCK_END, DONE, DRAIN_MS, GAP_BITS, LONGEST, STATES_OF, WORDS, State
from plcgen.ppi.sim import FaultKind
from plcgen.proof.runner import Run
from plcgen.proof.scenario import ScenarioError

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
            rig.cpu[f'"{name}".instClock.START'] = _signed(rig.cpu.clock - clock)
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
            self.check_settings(done=status == DONE)
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

    def check_settings(self, *, done: bool) -> None:
        """Port_Config and Receive_Config run after power-up and after a failure, once, and not again; ``done``: the
        module has what they set.
        """
        wanted, port = int(not self.configured), self.rig.port
        if port.configured != wanted or port.conditioned != wanted:
            found = f"Port_Config set the port {port.configured} times, Receive_Config {port.conditioned} times"
            raise ScenarioError(f"{found}, not {wanted}")
        gap, most = port.settings.gap_bits, port.settings.max_length
        if done and not port.settings.any_start:
            raise ScenarioError("a message does not begin with any character")
        if done and (gap, most) != (GAP_BITS, LONGEST):
            raise ScenarioError(f"a message ends after a gap of {gap} bit times or {most} bytes")

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


def _signed(value: int) -> int:
    value &= 0xFFFFFFFF
    return value - (1 << 32) if value >> 31 else value


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
