"""The statement about a job: which drive, which accesses in which order, what is waited for, times, failures.

``text()`` of a job is the sentence by which an engineer can check the proof.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from plcgen.oracles.spec.place import SpecPlace

Number = int | float
SHOWN = 2


@dataclass(frozen=True, slots=True)
class StatedDrive:
    """A drive and how it is reached.

    ``identifier`` is the hardware identifier, the name of its system constant, or the logical address; ``output``
    says that the address is one of outputs only: bit 15. ``unit`` is the device whose parameter server it shares.
    """

    key: str
    place: SpecPlace
    identifier: int | str
    output: bool
    drive_object: int
    record: int
    unit: str
    wait_ms: int
    by_size: bool = False
    local: bool = False
    """Whether the identifier alone selects the drive object: record B02Eh."""
    longest: int = 240
    most_parameters: int = 39
    most_elements: int = 234
    """Of a telegram: bytes each way, parameters, elements of a parameter."""
    comments: frozenset[str] = frozenset()

    def __str__(self) -> str:
        where = f"{self.identifier}{' (outputs)' if self.output else ''}"
        return f"{self.key}: identifier {where}, drive object {self.drive_object}, record {self.record:04X}h"


@dataclass(frozen=True, slots=True)
class FromInput:
    """A value that an input of the block supplies: element ``index`` of an array, None if it is none.

    ``start`` is what is written if nothing is connected.
    """

    name: str
    index: int | None
    start: Number | str

    def __str__(self) -> str:
        return f"input {self.name}{'' if self.index is None else f'[{self.index}]'}"


@dataclass(frozen=True, slots=True)
class FromRecord:
    """A value of the record of a recipe that the job selects; ``values`` are those of every record as delivered."""

    recipe: str
    member: str
    index: int | None
    values: tuple[Number | str, ...]
    minimum: Number | None = None
    maximum: Number | None = None

    def __str__(self) -> str:
        return f"record of {self.recipe}, {self.member}{'' if self.index is None else f'[{self.index}]'}"


@dataclass(frozen=True, slots=True)
class FromClock:
    """A value made of the time at the input ``utc``: days since 1970-01-01, or milliseconds of the day."""

    part: str

    def __str__(self) -> str:
        return f"{self.part} of input utc"


Source = Number | str | FromInput | FromRecord | FromClock
"""A constant (text and octets as text), or what supplies the value."""


@dataclass(frozen=True, slots=True)
class StatedAccess:
    """One parameter that is read or written: ``count`` values from ``index`` on.

    ``indexed`` is whether the spec names an index; without one a request carries as many ``elements`` as the device
    expects. ``type`` is the type on the wire, of ``size`` bytes; the octets of a string are its elements. ``values``
    are as many as ``count``; of a word of which only bits are written, ``bits`` has them and ``values`` is empty.
    ``output`` is what shows the value. ``letter``, ``title`` and ``unit`` are what documents call the parameter,
    ``comments`` what the spec says of it in its languages; None if the kind of job names the parameter.
    """

    place: SpecPlace
    written: str
    write: bool
    number: int
    index: int
    indexed: bool
    count: int
    elements: int
    type: str
    size: int
    values: tuple[Source, ...] = ()
    bits: tuple[tuple[int, Source], ...] = ()
    output: str = ""
    shown: tuple[tuple[int, str], ...] = ()
    """Of a word that is read: bits that are outputs of their own, with their names."""
    bico: bool = False
    letter: str = "P"
    title: str = ""
    unit: str = ""
    comments: frozenset[str] | None = None

    @property
    def string(self) -> bool:
        """Whether the values are octets of one text."""
        return self.type.startswith(("VisibleString", "OctetString"))

    def __str__(self) -> str:
        what = f"{self.written} ({self.type}{f', {self.count} values' if self.count > 1 else ''})"
        if self.bits:
            return f"{what}: " + ", ".join(f"bit {bit} = {source}" for bit, source in self.bits)
        if self.values:
            shown = list(dict.fromkeys(map(str, self.values)))
            return f"{what} = {', '.join(shown if len(shown) <= SHOWN else (shown[0], '..', shown[-1]))}"
        return f"{what} -> {self.output}" if self.output else what


@dataclass(frozen=True, slots=True)
class StatedCondition:
    """What must be true of the value (of its ``bit``) that access number ``access`` of a step brings.

    An input stands for 1 if it is 1, and for 0 otherwise.
    """

    access: int
    relation: str
    value: Number | FromInput
    bit: int | None = None
    element: int = 0
    late: int = 0
    """How the job ends if nothing but this is wrong at the limit; 0: like the step."""

    def __str__(self) -> str:
        return f"{'value' if self.bit is None else f'bit {self.bit}'} {self.relation} {self.value}"


@dataclass(frozen=True, slots=True)
class StatedStep:
    """Accesses of one kind, in their order; ``ordered`` False: in any.

    With ``until`` it is asked again, ``interval_ms`` from one question to the next, until all of it is true in one
    answer; a question at ``limit_ms`` or later is the last one, and if its answer says no the job ends with ``late``.
    The first one comes at once, or with ``pause_first`` an interval behind the answer to the step before; the limit
    counts from there. ``once``: the request starts something, so a lost one is not sent again.
    """

    title: str
    accesses: tuple[StatedAccess, ...]
    until: tuple[StatedCondition, ...] = ()
    limit_ms: int = 0
    interval_ms: int = 0
    pause_first: bool = False
    late: int = 0
    once: bool = False
    ordered: bool = True
    together: bool = False
    """Whether all of it goes in one telegram."""
    number: int = 0
    """Of a sequence: counted from 1."""

    def __str__(self) -> str:
        text = f"{self.title}: {'; '.join(map(str, self.accesses))}"
        if self.until:
            wanted = " and ".join(f"{self.accesses[c.access].written} {c}" for c in self.until)
            text += f", every {self.interval_ms} ms until {wanted}, at most {self.limit_ms} ms"
        return text + (", never sent twice" if self.once else "")


@dataclass(frozen=True, slots=True)
class StatedList:
    """A list of messages: its name and that of their number, its columns, groups of 8, what it is turned round in.

    Of faults every group is turned round, of alarms the first one.
    """

    name: str
    count: str
    columns: tuple[str, ...]
    groups: int
    every_group: bool


@dataclass(frozen=True, slots=True)
class StatedJob:
    """Everything that a job of the spec demands, on one of its drives.

    ``member`` is its structure in DB DriveJobs. ``signals`` are triggers that lie elsewhere. ``tries`` is how often
    the steps of a buffer are read that changes meanwhile, ``wear_ms`` the shortest time between two of its saves.
    ``restore``: what to do with the old values if it fails: empty, ``stopped`` or ``running``. ``cycle_ms``: it runs by
    itself, so long from one start to the next; 0: only an edge starts it.
    """

    key: str
    kind: str
    place: SpecPlace
    drive: StatedDrive
    member: str
    steps: tuple[StatedStep, ...]
    timeout_ms: int
    pause_ms: int
    retries: int
    signals: tuple[tuple[str, str], ...] = ()
    tries: int = 0
    wear_ms: int = 0
    cycle_ms: int = 0
    restore: str = ""
    recipe: str = ""
    records: int = 0
    verify: bool = False
    """Whether the job has a list of drives."""
    listing: StatedList | None = None
    comments: frozenset[str] = frozenset()

    def text(self) -> str:
        """The sentence for a reader."""
        lines = [f"{self.key} ({self.kind}) on {self.drive}"]
        lines += [f"  {number} {step}" for number, step in enumerate(self.steps, 1)]
        lines.append(f"  timeout {self.timeout_ms} ms, {self.retries} retries, a pause of {self.pause_ms} ms")
        lines += [f"  at least {self.wear_ms} ms from one save to the next"] if self.wear_ms else []
        lines += [f"  again every {self.cycle_ms} ms while execute is TRUE"] if self.cycle_ms else []
        lines += [f"  old values are restored while it is {self.restore}"] if self.restore == "stopped" else []
        lines += ["  old values are restored whether it runs or not"] if self.restore == "running" else []
        lines += [f"  read again if the buffer has changed, {self.tries} times in all"] if self.tries else []
        return "\n".join(lines)


@dataclass(frozen=True, slots=True)
class Unstated:
    """A job about which nobody says anything: ``reason`` is shown."""

    key: str
    kind: str
    place: SpecPlace
    reason: str


@dataclass(frozen=True, slots=True)
class Statement:
    """All jobs of a spec, one for each drive of a job, in the order of the spec; ``unstated`` have none.

    ``prefix`` stands in front of the names of blocks.
    """

    jobs: tuple[StatedJob, ...]
    unstated: tuple[Unstated, ...] = ()
    drives: tuple[StatedDrive, ...] = field(default=())
    prefix: str = ""
