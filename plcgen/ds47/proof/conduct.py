"""What goes on around the calls of a job block, and what must hold behind every one of them."""

from __future__ import annotations

from dataclasses import replace

from plcgen.ds47.proof.asked import Asked
from plcgen.ds47.proof.clock_input import Times
from plcgen.ds47.proof.contents import held, written
from plcgen.ds47.proof.cycles import SLOW, Repeats, slow_scan
from plcgen.ds47.proof.end import check_end, check_errors, check_refused
from plcgen.ds47.proof.forms import Came, check_formats, check_forms
from plcgen.ds47.proof.message_lists import Messages, fill
from plcgen.ds47.proof.pace import Pace
from plcgen.ds47.proof.poll_results import AnotherSave, check_saved
from plcgen.ds47.proof.poll_times import PollTimes
from plcgen.ds47.proof.records import Record
from plcgen.ds47.proof.repetition import Repetition
from plcgen.ds47.proof.restoration import BACK, CAUSE, OLD, Restoration, Restores
from plcgen.ds47.proof.rig import SLOT, WAIT_LIMIT_MS, JobRig
from plcgen.ds47.proof.scenario import DriveScenario
from plcgen.ds47.proof.step_facts import Steps, longest_waits, route
from plcgen.ds47.proof.step_run import StepRun
from plcgen.ds47.proof.untouched import Untouched
from plcgen.ds47.proof.wait_times import WaitTimes
from plcgen.ds47.proof.words import DONE, DRAIN_MS, HOLD, NO_ANSWER, state_name
from plcgen.proof.runner import Run
from plcgen.proof.scenario import OtherTelegramError, ScenarioError

MANY_MS = 10_000_000
"""Longer than any run."""
STILL_MS = 1000
"""Of the time between two calls so much counts at most."""
LONG_MS = 2000
"""What takes longer waits for a time, and may be looked at less often."""
COARSE_SCANS = 10_000
"""Behind so many scans the rest of a run whose time is not measured has about as many more, however long it is."""
WAITING_MS = 50
"""Length of a scan in ms while a job waits for a drive that has forgotten its telegram: some seconds."""
EARLIER = 0x7777
"""What the diagnosis of an earlier run might have."""


class JobConduct:
    """One job, run by run. ``before`` are its outputs in front of the run, ``requests`` what it must send."""

    def __init__(self, rig: JobRig) -> None:
        self.rig = rig
        self.before: list[list[bytes]] = []
        self.wanted: list[list[bytes]] = []
        self.requests: list[bytes] = []
        self.steps = StepRun(rig, (), exact=False)
        self.untouched = Untouched(rig)
        self.times: PollTimes | WaitTimes | None = None
        self.polled = 0
        """How often this run has repeated the last telegram."""
        self.saves = 0
        """Saves that the job has counted in front of this run."""
        self.saved_at = 0
        """When the last save was handed over."""
        self.taken = 0
        """Until when another job has the unit."""
        self.begun = 0
        """When the job started."""
        self.length = 0
        """Length of a scan in ms at least."""
        self.latest = 0
        """After how many ms at the latest the job must have ended."""
        self.pace = Pace(rig.cpu, [rig.drive])

    def plain(self, name: str) -> DriveScenario:
        """A run without any fault."""
        return DriveScenario(name=name, again=None)

    def title(self, scenario: DriveScenario) -> str:
        """There is one job in the block."""
        return scenario.name

    def outputs(self) -> object:
        """Outputs are looked at telegram by telegram in ``observe``, all of them at the end."""

    def where(self) -> str:
        """State of the channel."""
        return state_name(self.rig.unit.get("state"))

    def holds(self) -> bool:
        """The result stays as long as execute does, but for a job with a cycle, which goes on."""
        return not self.rig.job.cycle

    def begin(self, run: Run[DriveScenario]) -> int:
        """Set up drive, bus and inputs."""
        rig, scenario = self.rig, run.scenario
        rig.address(other_bit=scenario.output)
        rig.next_values(scenario.values)
        rig.report(scenario.of(Restores).state)
        rig.asked = scenario.of(Asked)
        rig.put_inputs(scenario.slot)
        record, save, steps = scenario.of(Record), scenario.of(AnotherSave), scenario.of(Steps)
        rig.damage(record.record, record.damaged)
        rig.called_alone = False
        self.polled, self.saves = 0, rig.saves
        if save.since is None:
            rig.forget(save.left)
        else:
            rig.wait(self.saved_at + save.since - rig.cpu.clock - scenario.scan)
        rig.drive.begin(scenario)
        rig.bus.write_busy, rig.bus.read_busy = scenario.busy
        repeats = scenario.of(Repeats)
        if scenario.occupied:
            rig.occupy()
            if repeats.slow:
                rig.channel.set("waitLimit", WAIT_LIMIT_MS)  # its scans are longer than the short limit
        happens = set(scenario.happens.values())
        others = scenario.occupied or steps.taken or repeats.taken or repeats.given_up
        self.untouched.begin(alone=not others and not {"cold", "warm"} & happens)
        messages = scenario.of(Messages).messages
        if messages is not None:
            fill(rig.job, rig.drive, rig.drive_object, messages)
        if scenario.matches:
            rig.match(scenario.keeps)
        rig.tell(scenario.of(Times).moment)
        rig.diagnosis.set("recordStatus", EARLIER)
        rig.diagnosis.set("retries", EARLIER)
        self.before, self.wanted = rig.delivered(), self.due(scenario)
        rig.takes_over()  # what the channel took in the runs before is none of this one's
        self.set_off(scenario)
        self.taken = 0
        for (telegram, place), data in scenario.delivers.items():
            self.wanted[telegram - 1][place - 1] = data
        self.length, self.pace = scenario.scan, Pace(rig.cpu, [rig.drive])
        calls = 12 * max(scenario.scan, WAITING_MS if "off" in happens else 0)
        calls += len(SLOW) * rig.job.cycle if repeats.slow else 0
        self.latest = rig.job.timeout + DRAIN_MS + longest_waits(rig.job) + calls
        return self.latest

    def set_off(self, scenario: DriveScenario) -> None:
        """What must be handed over in this run."""
        telegrams, requests = route(self.rig.job, scenario), self.rig.requests()
        self.requests = [requests[one.number - 1] for one in telegrams]
        self.restoration = Restoration(
            self.rig.job, self.rig.drive, self.rig.drive_object, requests, self.rig.values.given
        )
        restarts = {what for at, what in scenario.happens.items() if at > 1} & {"cold", "warm"}
        self.steps = StepRun(self.rig, telegrams, exact=scenario.again is not None and not restarts)
        self.times = None
        if self.rig.job.poll is not None and not restarts:
            self.times = PollTimes(self.rig, self.rig.job.poll)
        elif self.rig.job.waits and not restarts:
            self.times = WaitTimes(self.rig)

    def due(self, scenario: DriveScenario) -> list[list[bytes]]:
        """What the outputs must be: what the drive makes of it; a service that writes shows nothing."""
        if self.rig.asked.writes is not None:
            return self.rig.delivered()
        return self.rig.wanted(scenario.keeps, scenario.meanwhile)

    def happen(self, run: Run[DriveScenario], happening: str) -> None:
        """A restart, or what only a drive's job knows."""
        if happening in {"cold", "warm"}:
            self.rig.put_inputs(run.scenario.slot)
            self.before = self.rig.delivered()
        elif happening == "rise":
            run.execute = True
        elif happening == "lost":
            self.rig.unit.set("turn.grant", 0)
        elif happening == "off":
            self.rig.drive.switch_off()
            self.length = WAITING_MS

    def scan(self, run: Run[DriveScenario]) -> int:
        """Inputs change behind the first call; the job of another slot leaves; the channel is not called."""
        steps, later = run.scenario.of(Steps), run.scenario.of(Times).later
        if run.scenario.twice:
            self.rig.called_alone = run.scans % 2 == 0
        if run.scenario.occupied:
            self.rig.alive()
            if run.scans == run.scenario.occupied // run.scenario.scan:
                self.rig.leave()
        if steps.taken and self.steps.free:
            if not self.taken:
                self.taken = run.passed + steps.taken
                self.rig.take()
            self.rig.alive()
            if self.taken and run.passed >= self.taken:
                self.rig.leave()
                self.taken = steps.taken + MANY_MS
        if steps.still and steps.still == self.steps.handed and self.rig.unit.get("state") == HOLD:
            return min(STILL_MS, self.rig.job.timeout // 2)
        if run.scenario.of(Repeats).slow and run.scans in SLOW:
            return slow_scan(self.rig.job, waits=run.scenario.occupied > 0)
        if run.scenario.meddle and run.scans > 1:
            self.rig.meddle()
        if steps.robbed and steps.robbed == self.steps.handed and self.rig.answered:
            self.rig.alive(SLOT)
        if later is not None and run.scans == 2:
            self.rig.tell(later)
            self.set_off(run.scenario)
        counted = run.scenario.happens or run.scenario.occupied  # something happens in a certain scan
        exact = counted or run.passed < LONG_MS
        length = self.length if exact else max(self.length, self.pace.length())
        if run.scans > COARSE_SCANS and run.scenario.took is None:
            length = max(length, min(STILL_MS, self.latest // COARSE_SCANS))
        if run.scenario.sharp is not None and self.times is not None:
            return self.times.length(length, run.scenario.sharp)
        return length

    def start(self, run: Run[DriveScenario]) -> None:
        """No parameter has an answer yet, whatever was there before; values stay until there are new ones."""
        self.begun = self.rig.cpu.clock
        check_errors(self.rig, [(NO_ANSWER, 0)] * len(self.rig.job.uses))
        if any(self.rig.record):
            raise ScenarioError("recordStatus or retries are those of an earlier run")

    def observe(self, run: Run[DriveScenario]) -> None:
        """What is handed over to the channel; no output changes before its telegram is answered."""
        rig, telegram = self.rig, self.rig.telegram
        if run.scenario.guarded:
            self.untouched.check()
        for word, bit in rig.job.shown:  # an output is 0 before the first answer, and so are its bits
            if bit.bit is not None and rig.db.flag(bit.member) != bool(rig.db.get(word.member) >> bit.bit & 1):
                raise ScenarioError(f"{bit.member} is not bit {bit.bit} of {word.member}")
        check_forms(rig)
        if self.times is not None:
            self.times.observe(telegram, busy=run.seen[0])
        if rig.takes_over():
            self.handed_over(telegram)
        if rig.job.in_steps:
            self.steps.observe(busy=run.seen[0])
            telegram = self.steps.unanswered()
        if run.seen[0]:
            if rig.job.messages is not None and telegram:
                telegram = (telegram - 1) % len(rig.job.telegrams) + 1
            for number, (found, before) in enumerate(zip(rig.delivered(), self.before, strict=True), 1):
                if number >= telegram and found != before:
                    raise ScenarioError(f"an output of telegram {number} changed although it is not answered")

    def handed_over(self, telegram: int) -> None:
        """Bytes of the request, what goes with it, what is expected."""
        rig, job = self.rig, self.rig.job
        if job.in_steps:
            longest = max(len(request) for request in self.requests)
            telegram = self.steps.number(rig.unit.bytes("telegram", longest), self.requests)
        if job.restores:
            if telegram == OLD:
                self._merge()
            request = self.restoration.hand_over(telegram)
            if not self.restoration.saves or telegram <= len(job.telegrams):
                self.requests[max(telegram - 1, BACK) :] = [request] if telegram > BACK else []
        number = min(telegram, len(self.requests))
        if telegram > number and job.poll is None:
            raise ScenarioError(f"a telegram {telegram} is handed over, the job has {number}")
        self.polled = max(self.polled, telegram - number)
        request = self.requests[number - 1]
        found = rig.handed_over(len(request))
        if found[1:] != request[1:]:  # any reference will do
            raise OtherTelegramError(f"telegram {telegram} is", found, found[:1] + request[1:])
        asked = self.restoration.shape(telegram) if job.restores else self.steps.telegrams[number - 1]
        if asked.writes and asked.parts[0].use in job.saving:
            self.saved_at = rig.cpu.clock
        order, wanted = rig.order(), rig.wanted_order(asked, len(request))
        wrong = [
            f"{name} is {order[name]} instead of {value}" for name, value in wanted.items() if order[name] != value
        ]
        if wrong:
            raise ScenarioError(f"in the order of telegram {telegram} {', '.join(wrong)}")
        if asked.writes or rig.asked.writes is not None:
            return
        at = rig.unit.spots["expected"].byte
        for position, part in enumerate(asked.parts):
            word = bytes(rig.unit.memory[at + 4 * position : at + 4 * position + 4])
            right = bytes((0 if part.use.untyped else part.use.format.code, part.count, 0, part.size))
            right = rig.asked.expected if job.serves else right
            if word != right:
                shown = f"16#{word.hex().upper()}, not 16#{right.hex().upper()}"
                raise ScenarioError(f"what is expected of {part.use.label} in telegram {telegram} is {shown}")

    def _merge(self) -> None:
        """Words of which bits are written are made of those that the drive has now, whatever an earlier start wrote."""
        rig = self.rig
        words = [use for use in rig.job.uses if use.bits]
        if words:
            given = rig.values.given
            merged = {use.position: written(use, held(rig.drive, rig.drive_object, use), given) for use in words}
            rig.values = replace(rig.values, given={**given, **merged})
            self.requests = rig.requests()
            self.restoration.requests = tuple(self.requests)
            self.restoration.given = rig.values.given

    def end(self, run: Run[DriveScenario], status: int) -> None:
        """Values, errors, wire."""
        self.rig.called_alone = False
        wanted = self.wanted
        if self.rig.job.whole:  # the buffer may have changed; what is not whole is not delivered
            wanted = self.due(run.scenario) if status == DONE else self.before
        before = self.before
        if self.rig.job.in_steps:
            before = wanted = self.steps.came(self.requests, self.before)
            self.steps.check(run.scenario, status)
        restoration = self.restoration if self.rig.job.restores else None
        if restoration is not None:
            restoration.check(run.scenario, status, self.rig.db.get(CAUSE))
        check_end(self.rig, run.scenario, self.requests, before, wanted, status, self.polled, restoration)
        if status == DONE and run.scenario.checked and self.rig.asked.writes is None:
            check_formats(self.rig, run.scenario.of(Came))
        if self.rig.job.recipe is not None and self.rig.job.writes and run.scenario.checked:
            check_refused(self.rig, run.scenario, status)
        if self.rig.job.poll is not None:
            check_saved(self.rig, status, self.saves if run.scenario.checked else None)
        if self.times is not None:
            self.times.end(status)
        self.before = self.rig.delivered()
        if self.rig.records is not None and not run.scenario.at_once:  # it counts in the start only
            self.rig.damage(0, {})

    def behind(self, run: Run[DriveScenario]) -> None:
        """Execute comes again in the call after the end, or the cycle goes on: the job is done once more."""
        if run.scenario.of(Repeats) != Repeats() and run.seen[1]:
            Repetition(self.rig, run, self.begun).go()
            self.rig.takes_over()  # those of the runs that have gone on
        if not run.scenario.at_once:
            return
        self.rig.forget()
        self.set_off(self.plain("once more"))
        run.execute = run.fresh = True
        limit = run.passed + self.rig.job.timeout + DRAIN_MS + longest_waits(self.rig.job)
        while run.fresh or run.seen[0]:
            run.step()
            if run.passed > limit:
                raise ScenarioError(f"still {self.where()} when it is done once more")
        if run.seen != (False, True, False, DONE):
            raise ScenarioError(f"done once more, it ends with 16#{run.seen[-1]:04X}")
        if self.rig.job.in_steps or any(use.precedes for use in self.rig.job.uses):
            self.before = self.rig.delivered()  # what a step waits for may have come differently; old values are others

    def rest(self, run: Run[DriveScenario]) -> None:
        """An idle job does nothing: values stay behind the end."""
        if run.scenario.occupied or run.scenario.of(Steps).taken:
            self.rig.leave()
        run.fall()
        if self.rig.delivered() != self.before:
            raise ScenarioError("a value output changed after the end of the job")
        self.untouched.check()
