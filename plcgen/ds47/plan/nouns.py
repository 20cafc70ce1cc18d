"""The nouns of drive jobs: drives, uses of parameters, telegrams of data set 47, function blocks.

Offsets here come from the telegram (DS47), never from S7 layout rules: verification compares the two.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from plcgen.ds47 import guards
from plcgen.ds47.device import Device
from plcgen.ds47.kind import Messages, Poll, Wait
from plcgen.ds47.plan.access import Compare, Mask, Part, Recount, Remember, Use, Verify
from plcgen.ds47.references import number_of
from plcgen.ds47.registry import kind_called, kinds
from plcgen.ds47.schema import DriveSections, DriveSettings, JobEntry
from plcgen.ds47.words import VARIANTS, Variant
from plcgen.project.nouns import BlockRef, Buffer, BufferField, Link, Plan, PlannedJob, Telegram
from plcgen.project.spec import SpecPath
from plcgen.s7.types.data_types import Elementary


@dataclass(frozen=True, slots=True)
class PlannedUnit:
    """A device with one parameter server: one request at a time, whatever drive object it is for.

    ``db`` holds what its channel and jobs share; ``member`` names the channel in the caller; ``wait`` in ms.
    """

    key: str
    member: str
    db: BlockRef
    device: Device
    record_index: int
    wait: int
    path: SpecPath


@dataclass(frozen=True, slots=True)
class PlannedDrive(Link):
    """A drive as the blocks address it.

    ``id_value`` is the ID of WRREC/RDREC, bit 15 included; where the spec names a system constant, ``id_name`` is its
    name and ``id_value`` a number that stands for it here. ``object_type`` is that of its drive object, empty for a
    device that has one type only.
    """

    unit: PlannedUnit
    id_value: int
    id_name: str
    drive_object: int
    object_type: str

    @property
    def device(self) -> Device:
        """Profile of the unit."""
        return self.unit.device

    @property
    def record_index(self) -> int:
        """Data record of the unit's parameter channel."""
        return self.unit.record_index


@dataclass(frozen=True, slots=True)
class DriveField(BufferField):
    """A member of a request or response; ``part`` is the access to which it belongs, if it belongs to one."""

    part: Part | None = None


@dataclass(frozen=True, slots=True, eq=False)
class DriveTelegram(Telegram):
    """One request/response pair of data set 47, with the lengths in bytes of both kinds of answer.

    ``pinned`` is the length of the response buffer if the spec fixes it.
    """

    request: Buffer[DriveField]
    response: Buffer[DriveField]
    parts: tuple[Part, ...]
    positive_length: int
    negative_length: int
    pinned: int | None

    @property
    def writes(self) -> bool:
        """Whether it is a change; all of its parameters are written then, else all are read."""
        return self.parts[0].use.writes

    @property
    def once(self) -> bool:
        """Whether it starts something, so that it is not sent again without knowing what became of it."""
        return any(part.use.writes and part.use.parameter.pnu in guards.TRIGGERS for part in self.parts)

    @property
    def step(self) -> int:
        """The step of a sequence to which it belongs, from 1; 0 in other jobs."""
        return self.parts[0].use.step

    @property
    def awaited(self) -> Wait | None:
        """What it waits for: that of its first value, with the times of all of them; None if it does not wait."""
        return self.parts[0].use.as_(Wait)


@dataclass(frozen=True, slots=True)
class MessageList:
    """The buffer of messages that a job delivers: an array ``member`` of ``type``, and how many are present.

    ``settings`` is what the kind says of the buffer.
    """

    member: str
    count: str
    type: BlockRef
    settings: Messages

    @property
    def places(self) -> int:
        """Elements of the array."""
        return self.settings.places


@dataclass(frozen=True, slots=True)
class DeviationList:
    """What a job that compares delivers: the deviations, how many there are, and whether there is none.

    ``places`` of ``type`` are the elements of the array.
    """

    type: BlockRef
    places: int
    member: str = "deviations"
    count: str = "deviationCount"
    equal: str = "equal"


@dataclass(frozen=True, slots=True)
class PlannedRecipe:
    """A parameter set: a type with a member for each of ``uses``, a data block with an array of it.

    ``names`` are those of the records, empty if they have none, ``values`` their start values by member. Which values
    are allowed, the parameters of ``uses`` say.
    """

    key: str
    type: BlockRef
    db: BlockRef
    uses: tuple[Use, ...]
    names: tuple[str, ...]
    values: tuple[Mapping[str, bytes], ...]
    comment: dict[str, str]

    @property
    def count(self) -> int:
        """How many records there are."""
        return len(self.names)


@dataclass(frozen=True, slots=True)
class Permitted:
    """Numbers that a service may write, as ascending ranges in a data block; ``named``: those that the spec names."""

    db: BlockRef
    ranges: tuple[tuple[int, int], ...]
    named: frozenset[int]


@dataclass(frozen=True, slots=True)
class DriveCaller:
    """A function block that calls a part of the jobs, its instance DB, and the DB with their commands and results.

    ``number`` counts from 1; the first one calls the gate, too.
    """

    number: int
    block: BlockRef
    instance: BlockRef
    control: BlockRef

    def blocks(self) -> tuple[BlockRef, ...]:
        """All of them."""
        return self.block, self.instance, self.control


@dataclass(frozen=True, slots=True, eq=False)
class DriveJob(PlannedJob):
    """A parameter job on one drive: an instance of a function block that it shares with the same job on other drives.

    ``shape`` is the job's key in the spec, ``slot`` its place in the unit, from 1; ``caller`` calls it; ``once`` says
    that a change is never sent again without knowing what became of it. ``uses`` are those of the block, as its first
    drive knows the parameters, ``own`` the same accesses as this drive knows them: what it says of access, danger and
    grades. Instances whose drives know them alike have the same ``own``.
    ``diagnosis`` is the type of what is told of a failure. ``then`` is the kind of what it does behind its own, if any.
    ``clock`` is the type of the time at its input, if it sets a clock. ``cycle`` is the time in ms from one start to
    the next, 0 if only an edge starts it. ``permitted``: what a service that writes may write.
    """

    link: PlannedDrive
    caller: DriveCaller
    telegrams: tuple[DriveTelegram, ...]
    once: bool
    shape: str
    slot: int
    uses: tuple[Use, ...]
    own: tuple[Use, ...]
    block: BlockRef
    diagnosis: BlockRef
    reference: int
    retry_pause: int
    retries: int
    faq_names: bool
    listed: MessageList | DeviationList | None = None
    clock: Elementary | None = None
    recipe: PlannedRecipe | None = None
    then: str = ""
    cycle: int = 0
    permitted: Permitted | None = None

    @property
    def drive(self) -> PlannedDrive:
        """The drive that is asked."""
        return self.link

    @property
    def pinned(self) -> bool:
        """Whether its telegrams lie in data blocks of their own."""
        return self.telegrams[0].request.db is not None

    @property
    def supplied(self) -> tuple[Use, ...]:
        """The values that are inputs or taken from a record: no constants, nothing that the block makes of a time."""
        if self.clock is not None:
            return ()
        uses = (one for use in self.uses for one in (use.bits or (use,)))
        return tuple(use for use in uses if use.supplied and not use.constant)

    @property
    def inputs(self) -> tuple[Use, ...]:
        """The values the caller supplies."""
        return tuple(use for use in self.supplied if not use.recorded)

    @property
    def timed(self) -> tuple[Use, ...]:
        """Days since 1970-01-01 and milliseconds of the day, which the block makes of the time at its input."""
        return self.uses[-2:] if self.clock is not None else ()

    @property
    def outputs(self) -> tuple[Use, ...]:
        """The values the block returns one by one: all that it reads, unless it makes a list or a record of them."""
        return () if self.whole else tuple(use for use in self.uses if not use.writes)

    @property
    def shown(self) -> tuple[tuple[Use, Use], ...]:
        """What it reads with what of it is an output of its own: bits of words, forms of values without a type."""
        return tuple((use, one) for use in self.uses for one in use.shown)

    @property
    def untyped(self) -> bool:
        """Whether the type of a value comes from the answer."""
        return any(use.untyped for use in self.uses)

    @property
    def stores(self) -> bool:
        """Whether a record gets what it reads."""
        return self.recipe is not None and not self.supplied

    @property
    def whole(self) -> bool:
        """Whether what it reads is delivered at once, when all of it has come."""
        return self.listed is not None or self.stores

    @property
    def messages(self) -> MessageList | None:
        """The list that it delivers, if it reads a buffer of messages."""
        return self.listed if isinstance(self.listed, MessageList) else None

    @property
    def deviations(self) -> DeviationList | None:
        """The list that it delivers, if it compares."""
        return self.listed if isinstance(self.listed, DeviationList) else None

    @property
    def writes(self) -> bool:
        """Whether it changes parameters."""
        return any(use.writes for use in self.uses)

    @property
    def compares(self) -> bool:
        """Whether it holds what it reads against what the drive should have."""
        return any(use.as_(Compare) for use in self.uses)

    @property
    def rounds(self) -> bool:
        """Whether all its telegrams are sent again and again."""
        return any(use.as_(Recount) for use in self.uses)

    @property
    def in_steps(self) -> bool:
        """Whether it is a sequence."""
        return self.uses[0].step > 0

    @property
    def waits(self) -> bool:
        """Whether a step of it waits for a value."""
        return any(use.as_(Wait) for use in self.uses)

    @property
    def verified(self) -> bool:
        """Whether it reads back what it has written."""
        return any(use.as_(Verify) for use in self.uses)

    def suffix(self, telegram: DriveTelegram) -> str:
        """What follows the names of a telegram's members in the block: its number, if there are several."""
        return str(telegram.number) if len(self.telegrams) > 1 else ""

    def old(self, word: Use) -> Use:
        """What reads the word of which a use writes bits."""
        return next(use for use in self.uses if isinstance(use.role, Mask | Remember) and use.role.of is word)

    @property
    def serves(self) -> bool:
        """Whether its inputs say at run time which parameter is read."""
        return kind_called(self.kind).serves

    @property
    def restores(self) -> bool:
        """Whether it writes the old values back if it fails."""
        return self.uses[0].as_(Remember) is not None

    @property
    def saving(self) -> tuple[Use, ...]:
        """The one that starts something in the drive, and the one that asks whether that has ended."""
        asks = next((number for number, use in enumerate(self.uses) if use.as_(Poll)), 0)
        return self.uses[asks - 1 : asks + 1] if asks else ()

    @property
    def guarded(self) -> bool:
        """Whether it refuses to start again too soon, because it saves."""
        return self.poll is not None and self.poll.saves

    @property
    def poll(self) -> Poll | None:
        """How its last telegram is repeated, if it is."""
        return next((poll for use in self.uses if (poll := use.as_(Poll))), None)


@dataclass(frozen=True, slots=True)
class Engine:
    """The blocks that are the same in every project of a target."""

    order: BlockRef
    turn: BlockRef
    ask: BlockRef
    unit: BlockRef
    place: BlockRef
    gate_type: BlockRef
    channel: BlockRef
    ticket: BlockRef
    gate: BlockRef
    gate_db: BlockRef

    def blocks(self) -> tuple[BlockRef, ...]:
        """All of them."""
        return tuple(getattr(self, name) for name in self.__slots__)


@dataclass(frozen=True, eq=False)
class DrivePlan(Plan):
    """All units and drives of a spec and their jobs, the engine that they share, the blocks that call them."""

    jobs: tuple[DriveJob, ...]
    drives: tuple[PlannedDrive, ...]
    units: tuple[PlannedUnit, ...]
    engine: Engine
    callers: tuple[DriveCaller, ...]

    @cached_property
    def shapes(self) -> tuple[DriveJob, ...]:
        """One job for each function block: the first of those that share it."""
        return tuple(jobs[0] for jobs in self._instances.values())

    def instances(self, shape: DriveJob) -> tuple[DriveJob, ...]:
        """The jobs that share a function block, one for each drive."""
        return self._instances[shape.shape]

    @cached_property
    def _instances(self) -> dict[str, tuple[DriveJob, ...]]:
        found: dict[str, list[DriveJob]] = {}
        for job in self.jobs:
            found.setdefault(job.shape, []).append(job)
        return {shape: tuple(jobs) for shape, jobs in found.items()}

    def drive_kinds(self, shape: DriveJob) -> tuple[DriveJob, ...]:
        """One of the instances for each kind of drive: the first of those whose drives know the parameters alike."""
        first: dict[tuple[str, str, int], DriveJob] = {}
        for job in self.instances(shape):
            first.setdefault((job.drive.device.key, job.drive.object_type, id(job.own)), job)
        return tuple(first.values())

    @cached_property
    def variant(self) -> Variant:
        """The smallest engine that has room for every telegram and unit; the largest if none has."""
        telegrams = [telegram for job in self.shapes for telegram in job.telegrams]
        needed = (
            max((max(len(one.request.data), one.response.size) for one in telegrams), default=0),
            max((len(one.parts) for one in telegrams), default=0),
            max((self.slots(unit) for unit in self.units), default=0),
            len(self.units),
        )
        fitting = (one for one in VARIANTS if all(need <= room for need, room in zip(needed, one[1:], strict=True)))
        return next(fitting, VARIANTS[-1])

    def channels(self, caller: DriveCaller) -> tuple[PlannedUnit, ...]:
        """The units whose channels a caller calls: those of which it calls the first job."""
        return tuple(unit for unit in self.units if self._first_callers.get(unit.key) is caller)

    @cached_property
    def _first_callers(self) -> dict[str, DriveCaller]:
        found: dict[str, DriveCaller] = {}
        for job in self.jobs:
            found.setdefault(job.drive.unit.key, job.caller)
        return found

    def slots(self, unit: PlannedUnit) -> int:
        """Places of a unit that are in use."""
        return self._slots[unit.key]

    @cached_property
    def _slots(self) -> Counter[str]:
        return Counter(job.drive.unit.key for job in self.jobs)

    def entry(self, job: DriveJob) -> JobEntry:
        """What the spec says about a job."""
        return self.spec.jobs[job.shape]

    def settings(self, drive: PlannedDrive) -> DriveSettings:
        """What the spec says about a drive."""
        return self._placed[drive.path]

    def own_numbers(self, drive: PlannedDrive) -> set[int | None]:
        """Numbers of the parameters that the spec defines for a drive."""
        return set(map(number_of, self.settings(drive).parameters))

    @cached_property
    def _placed(self) -> dict[SpecPath, DriveSettings]:
        return {placed.path: placed.drive for placed in self.spec.placed()}

    def danger(self, job: DriveJob, use: Use) -> str:
        """Why what is written needs a sign-off: the one question that every kind of job answers to.

        A job that restores old values may write any.
        """
        if not use.writes:
            return ""
        values = use.numbers if self.entry(job).on_error is None else None
        return job.drive.device.danger(use.parameter.pnu, values, job.drive.object_type)

    def unclassified(self, job: DriveJob, use: Use) -> bool:
        """Whether nobody has said what it does, or that it needs no sign-off."""
        return use.writes and not job.drive.device.classified(use.parameter.pnu)

    def sign_off(self, job: DriveJob, pnu: int) -> str | None:
        """The reason that a job gives for writing a dangerous parameter; None if it gives none.

        It is one that there is such a job at all, if that is what its kind is for; never for Safety Integrated.
        """
        spec = self.entry(job)
        if pnu in guards.SAFETY:
            return next((why for text, why in spec.allow_safety.items() if number_of(text) == pnu), None)
        said = ((kind.permits, getattr(spec, kind.key)) for kind in kinds())
        permits = (permits(value) for permits, value in said if permits is not None and value is not None)
        permitted = next((found[pnu] for found in permits if pnu in found), None)
        return next((why for text, why in spec.allow.items() if number_of(text) == pnu), permitted)

    @property
    def recipes(self) -> tuple[PlannedRecipe, ...]:
        """Those that jobs use."""
        return tuple({job.recipe.key: job.recipe for job in self.jobs if job.recipe is not None}.values())

    @property
    def spec(self) -> DriveSections:
        """The sections of the spec that are planned here."""
        return self.loaded.sections(DriveSections)
