"""What a job block runs on: the files on disk in a soft CPU, a scripted drive, places in memory."""

from __future__ import annotations

from collections.abc import Mapping

from plcgen.ds47.plan.access import Part, Running, Verify
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan, DriveTelegram
from plcgen.ds47.proof import asked, clock_input, message_lists
from plcgen.ds47.proof.contents import ValueSet, held, kept, piece, value_set
from plcgen.ds47.proof.cycles import SINCE, cycle_signals
from plcgen.ds47.proof.partner import ScriptedDrive
from plcgen.ds47.proof.records import NUMBER, Records, recipe_signals
from plcgen.ds47.proof.restoration import CAUSE
from plcgen.ds47.proof.scenario import Contents
from plcgen.ds47.proof.step_facts import FAILED, triggers
from plcgen.ds47.proof.stimulus import SLOTS, UNITS, shape_fb
from plcgen.ds47.proof.words import COUNTERS, HOLD, STEP_MS
from plcgen.ds47.sim.awaited import let_come
from plcgen.ds47.sim.bench import build_unit
from plcgen.ds47.sim.parameters import Keeps
from plcgen.ds47.wire.formats import unpack_values
from plcgen.proof.rig import Members, Source
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.system.port import Periphery

SIGNALS = ("execute", "busy", "done", "error", "status", "driveObject", "slot")
DIAGNOSIS = ("recordStatus", "retries", "errors", "errorInfos")
ORDER = ("length", "retries", "timeout", "pause", "once", "pinned", "requestDb", "responseDb", "responseSize")
CLOCK, REST = "statNow", "statRest"
"""Clock of a job in its last call; ms until it may save again."""
GUARD = ("saves", REST)
"""Of a job that saves: how often it did, and how long it refuses to do it again."""
LITTER = b"\x5a"
"""Bytes of a telegram that is another job's."""
VALUE_SETS = 3
OUTPUT = 0x8000
"""Bit 15 of the address of an output."""
OUTPUT_BIT = 0x8000
"""Bit 15 of an address, that of outputs on S7-300/400; a number like any other in a hardware identifier."""
SLOT, OTHER = 1, 2
"""Slots of the job in the proof's unit, and of one that has the unit in between."""
WAIT_MS, WAIT_LIMIT_MS = 500, 60_000
"""How long a job waits for its unit: where another job has it, and usually."""


CHANNEL = ("channel0.waitLimit", "channel0.recordIndex", "channel0.statReference", "jobsOnly")


def record_index(plan: DrivePlan, job: DriveJob) -> int:
    """The record of a job as the channel's input has it: an INT on S7-300/400."""
    index = job.drive.record_index
    return index - 0x10000 if index > 0x7FFF and plan.target.classic else index


class JobRig:
    """One job of a program, called by the proof's own caller. ``number`` is that of its block in the plan, from 1."""

    def __init__(self, plan: DrivePlan, program: Program, job: DriveJob, number: int, cpu: Cpu | None = None) -> None:
        self.plan, self.program, self.job = plan, program, job
        self.drive_object = job.drive.drive_object
        self.drive = ScriptedDrive(build_unit(job.drive.device, {self.drive_object: job.uses}))
        self.cpu = Cpu(program) if cpu is None else cpu
        self.bus: Periphery = self.cpu.bus
        self.bus.drives.clear()
        self.address(other_bit=False)
        self.cpu.restart("cold")
        self.cpu.misuses.clear()
        self.cpu.forget_coverage()
        self.id_name = "hardwareId" if plan.target.t15 else "driveAddress"
        self.channel = Members(self.cpu, program, f"{shape_fb(number)}_DB", CHANNEL, "channel0.")
        values = [*clock_input.inputs(job), *(use.member for use in job.outputs)]
        paths = [f"job.{name}" for name in (*SIGNALS, self.id_name, *values, *message_lists.paths(job))]
        paths += [f"job.{name}" for name in GUARD] if job.guarded else []
        paths += [f"job.{CLOCK}"] if job.poll is not None or job.waits else []
        paths += [f"job.{name}" for name in FAILED] if job.in_steps else []
        paths += ["job.statStep"] if job.waits else []
        paths += [f"job.{CAUSE}"] if job.restores else []
        paths += [f"job.{name}" for name in recipe_signals(job)]
        paths += [f"job.{name}" for name in (*cycle_signals(job), *([SINCE] if job.cycle else []))]
        paths += [f"job.{one.member}" for _, one in job.shown]
        paths += [f"job.{name}" for name in asked.names(job)]
        self.db = Members(self.cpu, program, f"{shape_fb(number)}_DB", paths, "job.")
        paths = [f"jobDiagnosis.{name}" for name in DIAGNOSIS]
        self.diagnosis = Members(self.cpu, program, self.db.block, paths, "jobDiagnosis.")
        self.asked = asked.Asked()
        self.records = Records(job, self.db, "jobRecords", 1) if job.recipe is not None else None
        self.drive.asked = self.let_come if job.waits else None
        self.unit = self.unit_of(UNITS[0])
        self.source = Source(program, job.block)
        self.set_number = self._reference = 0
        self.values = self.value_set("factory")

    def unit_of(self, name: str) -> Members:
        """What job and channel share."""
        self.order_id = "order.hardwareId" if self.plan.target.t15 else "order.address"
        names = [
            "state",
            "retries",
            "telegram",
            "expected",
            "turn.grant",
            "turn.served",
            "order",
            self.order_id,
            *(f"order.{name}" for name in ORDER),
        ]
        names += [f"asks[{slot}].telegram" for slot in range(1, SLOTS + 1)]
        names += [f"asks[{slot}].{name}" for slot in (SLOT, OTHER) for name in ("want", "mark")]
        names += [f"ended[{OTHER}]"]
        return Members(self.cpu, self.program, name, [f"unit.{name}" for name in names], "unit.")

    def let_come(self) -> None:
        """The drive is asked: what the job waits for is there."""
        let_come(self.drive.objects[self.drive_object], self.job, self.db.get("statStep"))

    @property
    def saves(self) -> int:
        """Saves that the job has counted."""
        return self.db.get("saves") if self.job.guarded else 0

    def forget(self, left: int = 0) -> None:
        """The last save is long ago; or so many ms are left until the next may start."""
        if self.job.guarded:
            self.db.set(REST, left)

    def wait(self, milliseconds: int) -> None:
        """Time passes while the job is called and has nothing to do."""
        self.db.set("execute", 0)
        while milliseconds > 0:
            self.cpu.call(self.db.block, min(milliseconds, STEP_MS))
            milliseconds -= STEP_MS

    @staticmethod
    def pin(name: str) -> str:
        """There is one job in the block."""
        return name

    # --- values ---------------------------------------------------------------------------------------

    def value_set(self, kind: Contents) -> ValueSet:
        """Values of a kind."""
        return value_set(
            self.job, self.drive, self.drive_object, kind, f"{self.job.shape} {self.set_number}", self.set_number
        )

    def next_values(self, kind: Contents) -> None:
        """Give drive and inputs values."""
        self.set_number = (self.set_number + 1) % VALUE_SETS
        if self.records is not None:
            self.records.number = self.records.number % self.records.count + 1
        self.values = self.value_set(kind)
        self.values.put(self.drive, self.drive_object)
        self.put_inputs()

    def tell(self, moment: clock_input.Moment | bytes | None) -> None:
        """The time at the input of a job that sets a clock; of bytes that are no time nothing is expected."""
        if isinstance(moment, bytes):
            self.db.put(clock_input.TIME, moment)
        elif moment is not None:
            self.values = self.values.at(self.job, moment)
            self.put_inputs()

    def match(self, keeps: Mapping[int, Keeps]) -> None:
        """The drive has what the job wants, but for what it makes of some parameters."""
        for use in self.job.uses:
            values = unpack_values(use.format, use.count, kept(use, self.values.given[use.position], (keeps,)))
            there = self.drive.objects[self.drive_object].parameters[use.parameter.pnu].values
            there[use.subindex : use.subindex + use.count] = values

    def report(self, state: int) -> None:
        """The drive reports whether it runs."""
        for use in self.job.uses:
            if use.as_(Running):
                self.drive.objects[self.drive_object].parameters[use.parameter.pnu].values[0] = state

    def address(self, *, other_bit: bool) -> None:
        """Put the drive at its address, or at the one that differs from it in bit 15."""
        self.id_value = self.job.drive.id_value ^ (OUTPUT_BIT if other_bit else 0)
        self.bus.attach(self.id_value, self.drive)

    def put_inputs(self, slot: int | None = None) -> None:
        """Supply the inputs."""
        self.channel.set("recordIndex", record_index(self.plan, self.job))
        self.db.set("slot", SLOT if slot is None else slot)
        self.db.set("driveObject", self.drive_object)
        self.db.set(self.id_name, self.id_value)
        for member, data in self.values.inputs(self.job):
            self.db.put(member, data)
        for name, number in self.asked.inputs().items() if self.job.serves else ():
            self.db.set(name, number)
        for name, data in self.asked.more().items() if self.job.permitted is not None else ():
            self.db.put(name, data)
        if self.records is not None:
            self.db.set(NUMBER, self.records.number)
            self.records.put(self.values.given)

    def meddle(self) -> None:
        """Change all inputs but the slot; of the channel the record, which it takes over with the telegram."""
        self.channel.set("recordIndex", record_index(self.plan, self.job) ^ (self.unit.get("state") > HOLD))
        self.db.set("driveObject", self.drive_object ^ 0xFF)
        self.db.set(self.id_name, self.id_value ^ 0xFF)
        for member, data in self.values.inputs(self.job):
            self.db.put(member, bytes(byte ^ 0xFF for byte in data))
        for name, number in self.asked.inputs().items() if self.job.serves else ():
            self.db.set(name, number ^ 2)
        for name, data in self.asked.more().items() if self.job.permitted is not None else ():
            self.db.put(name, bytes(byte ^ 1 for byte in data))
        if self.records is not None:
            self.db.set(NUMBER, self.records.number % self.records.count + 1)
            if not self.job.stores:
                self.records.change(self.values.given)

    def damage(self, number: int | None, values: Mapping[tuple[int, int], bytes]) -> None:
        """Another number, or values of the record that are not allowed, by position of the use and place there."""
        if number is not None:
            self.db.set(NUMBER, number)
        if self.records is not None and values:
            given = dict(self.values.given)
            for (position, at), data in values.items():
                start = at * len(data)
                given[position] = given[position][:start] + data + given[position][start + len(data) :]
            self.records.put(given)

    def requests(self) -> list[bytes]:
        """The telegrams this run must send, reference 0."""
        found = self.values.requests(self.job, self.drive_object)
        return [self.asked.request(one) for one in found] if self.job.serves else found

    def wanted(self, *keeps: Mapping[int, Keeps]) -> list[list[bytes]]:
        """Wire bytes that the parts of each telegram must deliver; ``keeps``: what the drive makes of written ones."""
        if self.records is not None and self.job.stores:
            there = {use.position: held(self.drive, self.drive_object, use) for use in self.job.uses}
            return self._listed(self.records.wanted(there))
        if self.job.listed is not None:
            return self._listed(message_lists.wanted(self.job, self.drive, self.drive_object, self.values.given))
        known = {use.position: held(self.drive, self.drive_object, use) for use in self.job.outputs}
        for use in self.job.outputs:
            if back := use.as_(Verify):
                known[use.position] = kept(use, self.values.given[back.of.position], keeps)
        return [[piece(part, known[part.use.position]) for part in t.parts if not t.writes] for t in self.job.telegrams]

    def delivered(self) -> list[list[bytes]]:
        """Wire bytes of the outputs, by telegrams and parts; a change has none."""
        if self.records is not None and self.job.stores:
            return self._listed(self.records.shown())
        if self.job.listed is not None:
            return self._listed(message_lists.shown_list(self.job, self.db))
        return [[self.output(part) for part in t.parts if not t.writes] for t in self.job.telegrams]

    def _listed(self, content: bytes) -> list[list[bytes]]:
        """A list is delivered as a whole, with the last parameter."""
        last = self.job.telegrams[-1].parts[-1]
        return [[content if part is last else b"" for part in t.parts] for t in self.job.telegrams]

    def output(self, part: Part) -> bytes:
        """Wire bytes of a part of an output."""
        use = part.use
        return piece(part, self.db.bytes(use.member, use.count * use.format.size))

    @property
    def record(self) -> tuple[int, int]:
        """STATUS of the last record job and retries, as the diagnosis has them."""
        return self.diagnosis.get("recordStatus"), self.diagnosis.get("retries")

    def words(self, name: str) -> list[int]:
        """Array of words of the diagnosis, for every use of the job."""
        return self.diagnosis.words(name, len(self.job.uses))

    @property
    def longest(self) -> int:
        """Bytes of the longest record that the engine takes."""
        return self.unit.spots["telegram"].size

    @property
    def telegram(self) -> int:
        """The telegram that the job has handed over last; 0 without one."""
        slot = self.db.get("slot")
        return self.unit.get(f"asks[{slot}].telegram") if 0 < slot <= SLOTS else 0

    @property
    def answered(self) -> bool:
        """Whether the telegram that was handed over last has its result, which the job has not been called with."""
        return self.unit.get("state") == HOLD and self.unit.get("turn.served") == self.telegram > 0

    # --- another job ------------------------------------------------------------------------------

    def occupy(self) -> None:
        """The job of another slot gets the unit, and others wait for ``WAIT_MS`` at most."""
        self.take()
        self.cpu.call(self.db.block, 10)

    def take(self) -> None:
        """The job of another slot asks for the unit, which is free; others wait for ``WAIT_MS`` at most."""
        self.channel.set("waitLimit", WAIT_MS)
        self.unit.set(f"asks[{OTHER}].want", -self.unit.get(f"asks[{OTHER}].want", signed=True) % COUNTERS + 1)

    def give_up(self) -> None:
        """The job of another slot has asked, was refused, and is not called any more."""
        self.unit.set(f"asks[{OTHER}].want", COUNTERS)
        self.unit.set(f"ended[{OTHER}]", COUNTERS)

    def alive(self, slot: int = OTHER) -> None:
        """The other job gives a sign of life; in the job's own slot it should not be."""
        name = f"asks[{slot}].mark"
        self.unit.set(name, self.unit.get(name) % COUNTERS + 1)

    def leave(self) -> None:
        """The other job gives the unit back, with a telegram of its own in it."""
        for name in ("telegram", "expected", "order"):
            self.unit.put(name, LITTER * self.unit.spots[name].size)
        self.unit.set(f"asks[{OTHER}].want", -abs(self.unit.get(f"asks[{OTHER}].want", signed=True)))
        self.channel.set("waitLimit", WAIT_LIMIT_MS)
        self.cpu.call(self.db.block, 10)

    # --- what the job hands over ----------------------------------------------------------------------

    @property
    def called_alone(self) -> bool:
        """Whether gate and channel are not called: the job lies in a faster OB."""
        return self.channel.flag("jobsOnly")

    @called_alone.setter
    def called_alone(self, alone: bool) -> None:
        self.channel.set("jobsOnly", alone)

    def takes_over(self) -> bool:
        """Whether the channel has taken a telegram over since this was asked last: each has another reference."""
        before, self._reference = self._reference, self.channel.get("statReference")
        return self._reference not in {before, 0}

    def order(self) -> dict[str, int]:
        """What goes with the request."""
        found = {name: int.from_bytes(self.unit.bytes(f"order.{name}")) for name in ORDER}
        return found | {"id": self.unit.get(self.order_id)}

    def wanted_order(self, sent: DriveTelegram, length: int) -> dict[str, int]:
        """What the spec wants to go with the request of a telegram, which has so many bytes."""
        job = self.job
        once = job.once and sent.writes and (not job.verified or sent.parts[0].use in job.saving)
        once = any(triggers(part.use) for part in sent.parts) if job.in_steps else once
        found = {"length": length, "retries": job.retries, "timeout": job.timeout}
        found |= {"pause": job.retry_pause, "once": int(once), "pinned": int(job.pinned), "id": self.id_value}
        found |= {"requestDb": 0, "responseDb": 0, "responseSize": 0}
        own = job.telegrams[0]
        if own.request.db is not None and own.response.db is not None:
            found["requestDb"] = self.cpu.db(own.request.db.name).number
            found["responseDb"] = self.cpu.db(own.response.db.name).number
            found["responseSize"] = own.response.size
        return found

    def handed_over(self, length: int) -> bytes:
        """The request that the channel is going to send."""
        own = self.job.telegrams[0].request.db
        return self.unit.bytes("telegram", length) if own is None else bytes(self.cpu.db(own.name)[:length])
