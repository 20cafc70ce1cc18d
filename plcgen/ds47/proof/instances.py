"""More instances of a job block, made by hand: on the same unit for another drive object, and on another unit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

from plcgen.ds47.plan.access import Verify
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.ds47.proof import clock_input, message_lists
from plcgen.ds47.proof.contents import ValueSet, alike, held, masked, piece, taken_values, value_set, values_of
from plcgen.ds47.proof.cycles import SINCE
from plcgen.ds47.proof.pace import Pace
from plcgen.ds47.proof.partner import ScriptedDrive
from plcgen.ds47.proof.poll_results import saving_scans
from plcgen.ds47.proof.records import NUMBER, Records, recipe_signals
from plcgen.ds47.proof.rig import record_index
from plcgen.ds47.proof.step_facts import overwritten
from plcgen.ds47.proof.stimulus import UNITS, own_dbs, pair_fb
from plcgen.ds47.proof.words import DONE, GATE, GRANT, READ
from plcgen.ds47.sim.awaited import let_come
from plcgen.ds47.sim.behaviour import LOCAL_INDEX
from plcgen.ds47.sim.bench import build_unit
from plcgen.proof.rig import Members
from plcgen.proof.scenario import ScenarioError
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program

SIGNALS = ("execute", "busy", "done", "error", "status", "driveObject", "slot")
FIRST_ID = 0x3F00
"""Hardware identifiers or addresses of the drives; each instance has its own."""


@dataclass(slots=True)
class Instance:
    """One of the instances; ``begins`` is the scan in which it is started."""

    key: str
    slot: int
    id_value: int
    drive: ScriptedDrive
    drive_object: int
    db: Members
    values: ValueSet
    begins: int = 0


class ThreeInstances:
    """Three instances of one block: two for two drive objects of one unit, the third for another unit."""

    def __init__(self, plan: DrivePlan, program: Program, cpu: Cpu, job: DriveJob, number: int) -> None:
        self.plan, self.program, self.cpu, self.job, self.number = plan, program, cpu, job, number
        self.block = f"{pair_fb(number)}_DB"
        self.records: dict[str, Records] = {}
        device, first = job.drive.device, job.drive.drive_object
        one_object = job.drive.record_index & 0xFFFF == LOCAL_INDEX
        second = first if one_object else first + 1 if first < 0xFF else first - 1
        near = ScriptedDrive(build_unit(device, dict.fromkeys((first, second), job.uses)))
        far = ScriptedDrive(build_unit(device, {first: job.uses}))
        self.all = [
            self._instance("job", 1, FIRST_ID, near, first),
            self._instance("near", 2, FIRST_ID + 1, near, second),
        ]
        for channel in (0, 1):
            path = f"channel{channel}.recordIndex"
            Members(cpu, program, self.block, [path]).set(path, record_index(plan, job))
        if not job.pinned:  # each one would need data blocks of its own
            self.all.append(self._instance("far", 1, FIRST_ID + 2, far, first))
        paths = ("unit.state", "unit.telegram", "unit.turn.grant")
        own = self.all[:2], self.all[2:]
        self.units = [(Members(cpu, program, name, paths, "unit."), its) for name, its in zip(UNITS, own, strict=True)]
        for place, drive in enumerate((near, far) if job.waits else ()):
            drive.asked = partial(self.let_come, place)

    def let_come(self, number: int) -> None:
        """A unit is asked: what the instance waits for that holds it is there."""
        unit, instances = self.units[number]
        slot = unit.get("turn.grant") // GRANT
        for one in instances:
            if one.slot == slot:
                let_come(one.drive.objects[one.drive_object], self.job, one.db.get("statStep"))

    def _instance(self, key: str, slot: int, id_value: int, drive: ScriptedDrive, drive_object: int) -> Instance:
        self.cpu.bus.attach(id_value, drive)
        id_name = "hardwareId" if self.plan.target.t15 else "driveAddress"
        members = [
            *clock_input.inputs(self.job),
            *(use.member for use in self.job.outputs),
            *message_lists.paths(self.job),
        ]
        members += ["statStep"] if self.job.waits else []
        members += [SINCE] if self.job.cycle else []
        paths = [f"{key}.{name}" for name in (*SIGNALS, id_name, *members, *recipe_signals(self.job))]
        db = Members(self.cpu, self.program, self.block, paths, f"{key}.")
        values = value_set(self.job, drive, drive_object, "next", f"{self.job.shape} {key}")
        if key != "near" or self.job.drive.record_index & 0xFFFF != LOCAL_INDEX:
            values.put(drive, drive_object)
        db.set("slot", slot)
        db.set("driveObject", drive_object)
        db.set(id_name, id_value)
        for member, data in values.inputs(self.job):
            db.put(member, data)
        if self.job.recipe is not None:
            records = self.records[key] = Records(self.job, db, f"{key}Records", self.job.recipe.count)
            db.set(NUMBER, records.number)
            records.put(values.given)
        if key == "near" and self.job.pinned:
            data = self.job.telegrams[0].request.data
            self.cpu.db(own_dbs(self.number)[0])[: len(data)] = data
        return Instance(key, slot, id_value, drive, drive_object, db, values)

    @property
    def patience(self) -> int:
        """Scans in which all have ended."""
        return 100 + 60 * len(self.job.telegrams) + len(self.all) * saving_scans(self.job)

    def begin(self, scan: int) -> None:
        """Start what begins in this scan; no cycle is over in it."""
        for instance in self.all:
            if self.job.cycle:
                instance.db.set(SINCE, 0)
            if instance.begins == scan:
                instance.db.set("execute", 1)

    @property
    def over(self) -> bool:
        """Whether all have ended."""
        return all(one.db.flag("done") or one.db.flag("error") for one in self.all)

    def run(self, near: int, far: int) -> Iterator[int]:
        """Start the second and third so many scans behind the first, until all have ended; yields in every scan."""
        for instance, begins in zip(self.all, (0, near, far), strict=False):
            instance.begins = begins
        pace = Pace(self.cpu, [one.drive for one in self.all])
        for scan in range(self.patience + near + far):
            self.begin(scan)
            self.cpu.call(self.block, pace.length())
            yield scan
            if self.cpu.misuses or self.cpu.faulted:
                raise ScenarioError("misuse")
            if not self.job.pinned:
                self.addressed()
            if self.over and scan >= max(near, far):
                break
        self.check()

    def addressed(self) -> None:
        """A telegram is handed over for the drive object of the instance that has the unit. Raises ScenarioError."""
        for unit, instances in self.units:
            if not GATE <= unit.get("state") <= READ:
                continue
            slot, addressed = unit.get("turn.grant") // GRANT, unit.bytes("telegram", 3)[2]
            for one in instances:
                if one.slot == slot and one.drive_object != addressed:
                    shown = f"{addressed} instead of {one.drive_object}"
                    raise ScenarioError(f"instance {one.key} addresses drive object {shown}")

    def check(self) -> None:
        """Each has the values of its own drive object, each drive object those of its own instance."""
        for one in self.all:
            status = one.db.get("status")
            if not one.db.flag("done") or status != DONE:
                raise ScenarioError(f"instance {one.key} ends with 16#{status:04X}")
            if message_lists.shown_list(self.job, one.db) != message_lists.wanted(
                self.job, one.drive, one.drive_object, one.values.given
            ):
                raise ScenarioError(f"the list of instance {one.key} is not that of its drive")
            if self.job.stores:
                given = {use.position: held(one.drive, one.drive_object, use) for use in self.job.uses}
                if self.records[one.key].shown() != self.records[one.key].wanted(given):
                    raise ScenarioError(f"the records of instance {one.key} are not those of its drive")
            self._read(one)
            outputs = () if self.job.in_steps else self.job.outputs
            for use in (*outputs, *(use for use in self.job.uses if use.writes)):
                if use.writes and (use in self.job.saving or overwritten(self.job, use)):
                    continue  # it has returned to 0, or has another value in a later step
                there = held(one.drive, one.drive_object, use)
                if use.precedes:
                    if self._shared(one):
                        continue  # which of them was first is not known
                    there = taken_values(use, one.values.held[use.parameter.pnu])
                back = use.as_(Verify)
                if back is not None:
                    there = one.values.given[back.of.position]
                here = one.values.given[use.position] if use.writes else one.db.bytes(use.member, len(there))
                if back is not None and back.of.bits and self._shared(one):
                    here, there = (masked(data, back.of.mask) for data in (here, there))
                if here != there and not (use.writes and self._shared(one)):
                    raise ScenarioError(
                        f"{use.label} is {here.hex(' ')} at instance {one.key}, {there.hex(' ')} in its drive"
                    )
            requests = {exchange.data for exchange in one.drive.journal if exchange.direction == "write"}
            wanted = one.values.requests(self.job, one.drive_object)
            for telegram, request in zip(self.job.telegrams, wanted, strict=True):
                if not any(alike(telegram, sent, request) for sent in requests):
                    raise ScenarioError(
                        f"instance {one.key} does not send {request.hex(' ').upper()} (reference aside)"
                    )
            order = [exchange.direction for exchange in one.drive.journal if not exchange.status]
            if any(before == after for before, after in pairwise(order)):
                raise ScenarioError("two requests at once on one unit")

    def _read(self, one: Instance) -> None:
        """What a sequence has read is what its drive has answered, which may be another value now."""
        if not self.job.in_steps:
            return
        exchanges = [exchange for exchange in one.drive.journal if not exchange.status]
        for telegram, request in zip(self.job.telegrams, one.values.requests(self.job, one.drive_object), strict=True):
            if telegram.writes:
                continue
            came = [b.data for a, b in pairwise(exchanges) if a.direction == "write" and a.data[1:] == request[1:]]
            shown = [piece(part, one.db.bytes(part.use.member)) for part in telegram.parts]
            if shown not in [values_of(telegram, answer) for answer in came]:
                raise ScenarioError(f"what instance {one.key} has read in step {telegram.step} did not come")

    def _shared(self, one: Instance) -> bool:
        """Whether another instance writes into the same drive object."""
        return sum(x.drive is one.drive and x.drive_object == one.drive_object for x in self.all) > 1
