"""A toy protocol of another distribution: lamps that are switched by a frame of two bytes, mark BEh and lamp number.

It shows the least that a protocol has to bring: sections of the spec, a plan, rules, documents, proof.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

from pydantic import Field as Key

from plcgen.base.diagnostics import Diagnostic
from plcgen.base.files.validation import StrictModel
from plcgen.base.telegrams.dissection import ByteField, Walker
from plcgen.build.control import signals
from plcgen.build.members import assignments, buffer_member
from plcgen.build.nouns import Command, Contribution, DataBlock, FunctionBlock, TypeBlock
from plcgen.build.sheet import ReviewSheet
from plcgen.project.nouns import BlockRef, Buffer, BufferField, Link, Plan, PlannedJob, PlannedTrigger, Telegram
from plcgen.project.part import Named, Rules
from plcgen.proof.audited import Audited
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.suite import LaidOut
from plcgen.s7.compare.model import DriveState, JobState, TelegramState
from plcgen.s7.layout.image import image
from plcgen.s7.types.data_types import ELEMENTARY

MARK = 0xBE
LAST_LAMP = 9


class Lamp(StrictModel):
    """A lamp of the spec."""

    number: int = Key(ge=0, le=255, description="number of the lamp")


class Lamps(StrictModel):
    """The section of the spec."""

    beacons: dict[str, Lamp] = Key(min_length=1, description="lamps by name")


@dataclass(frozen=True, eq=False)
class BeaconPlan(Plan):
    """Lamps, each with a block of its own."""

    blocks_of: dict[str, tuple[BlockRef, BlockRef]]
    control: BlockRef


def _names(plan: BeaconPlan) -> Iterator[Named]:
    for key in plan.loaded.sections(Lamps).beacons:
        yield Named("lamp", key, "key", partial(plan.loaded.key_span, ("beacons", key)))


def _unknown_lamps(plan: BeaconPlan) -> Iterator[Diagnostic]:
    for key, lamp in plan.loaded.sections(Lamps).beacons.items():
        if lamp.number > LAST_LAMP:
            place = plan.loaded.span(("beacons", key, "number"))
            yield Diagnostic("PG107", f"there is no lamp {lamp.number}", place, help=f"lamps are 0 to {LAST_LAMP}")


RULES = Rules(
    checks=(_unknown_lamps,),
    names=_names,
    texts=lambda plan: (((*job.path, "comment"), job.comment) for job in plan.jobs),
    untranslated=lambda _plan: iter(()),
    taken=lambda _plan: iter([("BeaconTags", "the tag table of the lamps", None)]),
    partners=lambda _plan: iter(()),
)


class BeaconProof:
    """The frame that the start values form is the one that switches the lamp of the spec."""

    def __init__(self, plan: BeaconPlan) -> None:
        self.plan = plan

    def constants(self) -> dict[str, int]:
        """None."""
        return {}

    def stimulus(self) -> tuple[tuple[str, str], ...]:
        """None."""
        return ()

    def foundation(self, folder) -> Iterator[Check]:  # the face
        """Nothing that other projects have too."""
        yield from ()

    def layouts(self) -> Iterator[LaidOut]:
        """One buffer a lamp."""
        for job in self.plan.jobs:
            yield LaidOut(job.telegrams[0].request, lambda _field: True)

    def telegrams(self, folder) -> Iterator[Check]:
        """BEh and the number of the spec, as they lie in the source on disk."""
        for job in self.plan.jobs:
            ref = job.telegrams[0].request.db
            data = bytes(image(folder.text[ref.name.upper()], folder.text))
            wanted = bytes((MARK, self.plan.loaded.sections(Lamps).beacons[job.key].number))
            outcome = Outcome.OK if data == wanted else Outcome.ERROR
            yield Check(f"telegram.{ref.name}", job.key, data.hex(" ").upper(), outcome, "as the spec says")

    def exchanges(self, folder, partner, progress):
        """No lamp is simulated."""

    def stated(self, program):  # the face
        """Nobody says what a lamp must do."""
        return ()

    def oracles(self, folder, *, dissector):  # the face
        """Nobody else is asked."""
        return iter(())

    def ledger(self):
        """Nothing is assumed."""
        return iter(())

    def suites(self):
        """Nothing is executed."""
        return ()


class Beacon:
    """The face of the protocol."""

    key = "beacon"
    sections = ("beacons",)
    entries = ("beacons",)
    details = ()
    length_note = ""

    def section(self, *, alone):  # the same in every company
        """Lamps."""
        return Lamps

    def complete(self, schema, profiles) -> None:
        """There are no short forms."""

    def pinned(self, loaded):  # no key fixes one
        """No number is fixed."""
        return ()

    def plan(self, loaded, numbering, report) -> BeaconPlan:  # nothing can go wrong
        """A block, an instance and a frame for each lamp."""
        jobs, blocks, own = [], [], {}
        for key, lamp in loaded.sections(Lamps).beacons.items():
            path, name = ("beacons", key), key.capitalize()
            frame = bytes((MARK, lamp.number))
            db, type_ = numbering.block("DB", f"{name}_Request", path), numbering.block("UDT", f"type{name}", path)
            byte = ELEMENTARY["BYTE"]
            fields = [
                BufferField("mark", "mark", byte, 0, 1, frame[:1]),
                BufferField("lamp", "lamp", byte, 1, 1, frame[1:]),
            ]
            telegram = Telegram(1, MARK, MARK, Buffer(db, type_, fields, 2, frame), None)
            trigger = PlannedTrigger()
            jobs.append(PlannedJob(key, key, "switch", Link(key, {}, path), (telegram,), trigger, 1000, {}, path))
            own[key] = numbering.block("FB", name, path), numbering.block("DB", f"{name}_DB", path)
            blocks += [type_, db, *own[key]]
        control = numbering.block("DB", "Beacons", ("plc",), given=True)
        plc = loaded.spec.plc
        frame_of_plan = (loaded, plc.name, numbering.where, plc.languages)
        return BeaconPlan(*frame_of_plan, self, tuple(jobs), (*blocks, control), own, control)

    def rules(self) -> Rules:
        """Numbers of lamps."""
        return RULES

    def documents(self, plan: BeaconPlan) -> Contribution:
        """A program a lamp."""
        programs = (self._program(plan, job) for job in plan.jobs)
        return Contribution(
            "BEACON", "lamps", (), (), programs, {plan.control: "All lamps"}, "BeaconTags", lambda: ([], []), dict
        )

    def _program(self, plan: BeaconPlan, job: PlannedJob) -> FunctionBlock:
        block, instance = plan.blocks_of[job.key]
        buffer = job.telegrams[0].request
        members = [buffer_member(plan, buffer.db, field, {}, field.name, starts=True) for field in buffer.fields]
        frame = TypeBlock(buffer.type, members), DataBlock(buffer.db, "Frame", members, assignments(members))
        command = Command(plan.control, job.member, f"Switch {job.key}", {}, signals(plan), [], [])
        title, template = f"Switch {job.key}", "beacon:templates/lamp.scl.j2"
        view = {"name": block.name}
        return FunctionBlock(
            block, instance, title, template, view, "a toy", [frame], [command], [buffer.data.hex(" ")]
        )

    def buffers(self, plan: BeaconPlan):
        """The frames."""
        return ((job.telegrams[0].request, f"frame of {job.key}") for job in plan.jobs)

    def link_states(self, plan: BeaconPlan) -> Iterator[DriveState]:
        """The lamps."""
        lamps = plan.loaded.sections(Lamps).beacons
        return (DriveState(key, "lamp", lamp.number, ()) for key, lamp in lamps.items())

    def job_states(self, plan: BeaconPlan) -> Iterator[JobState]:
        """What is sent to them."""
        for job in plan.jobs:
            yield JobState(job.key, job.key, (TelegramState(job.telegrams[0].request.data, 0, 0, 0, self.key),))

    def review_sheet(self, plan: BeaconPlan) -> ReviewSheet:  # a toy
        """Nothing that has to be signed."""
        return ReviewSheet()

    def request_fields(self, data: bytes) -> list[ByteField]:
        """Mark and lamp."""
        walker = Walker(data)
        walker.hexadecimal(1, "mark")
        walker.decimal(1, "lamp")
        return walker.fields

    def explain(self, digits: str) -> None:
        """No number means anything."""

    def recording(self, plan: BeaconPlan) -> None:
        """Nobody watches it run."""

    def proof(self, plan: BeaconPlan) -> BeaconProof:
        """The frames."""
        return BeaconProof(plan)

    def audit(self, plan: BeaconPlan, sources) -> Audited:  # a toy
        """Nothing is found."""
        return Audited()


PROTOCOL = Beacon()
