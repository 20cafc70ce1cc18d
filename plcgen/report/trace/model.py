"""What a recorded run consists of: signals, the steps in which something changed, and how every job ended."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from plcgen.base.diagnostics import Diagnostic, has_errors
from plcgen.base.telegrams.decoded import DecodedTelegram

Scalar: TypeAlias = bool | int | float | str
Value: TypeAlias = "Scalar | list[Value] | dict[str, Value]"
Kind: TypeAlias = Literal["bool", "integer", "word", "real", "text"]


@dataclass(frozen=True, slots=True)
class Signal:
    """One recorded quantity.

    ``group`` is the job, unit, master or instance it belongs to; ``bits`` the width of a word or integer; ``names``
    says what its numbers mean; ``path`` is how the CPU addresses it, empty for the signals of a call.
    ``listed`` says that the text report names the signal when it changes. An array is one signal.
    """

    group: str
    name: str
    kind: Kind
    bits: int = 0
    unit: str = ""
    path: str = ""
    names: Mapping[int, str] = field(default_factory=dict)
    listed: bool = False

    @property
    def id(self) -> str:
        """``group.name``: unique in a trace."""
        return f"{self.group}.{self.name}"


@dataclass(frozen=True, slots=True)
class CallShape:
    """A block of the system whose calls are recorded: its name, what its flag of success is called, bits of STATUS.

    ``answers`` if it hands bytes over, whose number is then recorded, too.
    """

    block: str
    success: str
    bits: int
    answers: bool = False


@dataclass(frozen=True, slots=True)
class BlockCall:
    """One call of such a block as it left the block; ``finished`` is its flag of success."""

    group: str
    shape: CallShape
    instance: str
    request: bool
    busy: bool
    finished: bool
    error: bool
    status: int
    length: int

    @property
    def block(self) -> str:
        """Name of the block."""
        return self.shape.block

    @property
    def idle(self) -> bool:
        """Whether the call did nothing."""
        return not (self.request or self.busy or self.finished or self.error)


Direction: TypeAlias = Literal["write", "read"]


@dataclass(frozen=True, slots=True)
class Contact:
    """What one partner got (``write``) or gave (``read``), and what it says.

    ``index`` is the number of a data record, ``status`` with what it was refused, both 0 on a serial line; ``request``
    is the telegram that a read answers.
    """

    group: str
    partner: str
    direction: Direction
    index: int
    status: int
    data: bytes
    request: bytes
    text: str = ""
    telegram: DecodedTelegram | None = None


@dataclass(frozen=True, slots=True)
class Step:
    """A scan in which something changed: new values by position in ``Trace.signals``, calls and contacts."""

    scan: int
    time: int
    changes: tuple[tuple[int, Value], ...]
    calls: tuple[BlockCall, ...]
    contacts: tuple[Contact, ...]


@dataclass(frozen=True, slots=True)
class JobValue:
    """One value of a job at its end; ``error`` is the number of the partner's error or None, ``info`` its second word,
    ``problem`` what they mean; ``meaning`` is what the value means, where a list says so.
    """

    label: str
    member: str
    title: str
    unit: str
    value: Value | None
    error: int | None
    info: int
    problem: str = ""
    meaning: str = ""


Ending: TypeAlias = Literal["done", "error", "running", "not started"]


@dataclass(frozen=True, slots=True)
class JobResult:
    """How a job ended; ``status`` is its status word, ``record_status`` STATUS of its last call of a system block,
    with its meaning if that is an error.
    """

    key: str
    partner: str
    ending: Ending
    status: int
    text: str
    scan: int
    time: int
    telegrams: int
    retries: int
    record_status: int
    record_text: str
    values: tuple[JobValue, ...]


@dataclass(frozen=True, slots=True)
class Trace:
    """A recorded run.

    ``start`` holds the values before the first scan, in the order of ``signals``. ``ended`` says why the run ended:
    every job did, the number of scans was reached, or a fault stopped the CPU. ``main`` is the cyclic OB that ran.
    ``words`` are what this kind of call and of partner is called.
    """

    spec: str
    folder: str
    project: str = ""
    target: str = ""
    main: str = ""
    words: tuple[str, str] = ("call", "partner")
    scan_time: int = 10
    scans: int = 0
    time: int = 0
    ended: Literal["jobs", "scans", "stop", ""] = ""
    limited: bool = False
    signals: tuple[Signal, ...] = ()
    start: tuple[Value, ...] = ()
    steps: tuple[Step, ...] = ()
    jobs: tuple[JobResult, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()

    @property
    def ok(self) -> bool:
        """No error among the diagnostics, no job ended in error; none still runs unless scans were limited."""
        if has_errors(self.diagnostics):
            return False
        good = {"done", "running", "not started"} if self.limited else {"done"}
        return all(job.ending in good for job in self.jobs)

    def values(self) -> Iterator[tuple[Step, list[Value]]]:
        """Every step with the values of all signals after it."""
        now = list(self.start)
        for step in self.steps:
            for position, value in step.changes:
                now[position] = value
            yield step, list(now)
