"""What a protocol contributes to a recorded run: partners on the bus, jobs to watch, and what went over the wire."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol, TypeAlias

from plcgen.report.trace.model import CallShape, Contact, JobValue, Signal
from plcgen.report.trace.recorder import Derived, RecordingCpu, Watched
from plcgen.s7.cpu.system.port import Periphery

Observed: TypeAlias = tuple[Signal, Watched | Derived]


@dataclass(frozen=True, slots=True)
class PartnerOptions:
    """What the partners are told, as it was typed: ``faults``, a file of faults, files ``[PARTNER=]FILE``."""

    faults: Sequence[str] = ()
    fault_file: Path | None = None
    files: Sequence[str] = ()


@dataclass(frozen=True, slots=True)
class JobEnd:
    """What a job has at its end beside its status: STATUS of the system block, its meaning if bad, and the values."""

    record_status: int
    record_text: str
    values: tuple[JobValue, ...]


@dataclass(frozen=True, slots=True)
class JobFacts:
    """One job: ``timeout`` in ms, ``execute`` what starts it, ``pins`` the paths of busy, done, error and status.

    ``texts`` say what the status words mean.
    """

    key: str
    partner: str
    timeout: int
    execute: str
    pins: Mapping[str, str]
    texts: Mapping[int, str]


@dataclass(frozen=True, slots=True)
class JobInput:
    """A value that the caller gives to a job: ``path`` on the CPU, what it is, and what the catalogue says of it.

    ``low`` and ``high`` are limits in ``unit``, None where nobody knows one; ``names`` are values with a name.
    """

    path: str
    title: str = ""
    unit: str = ""
    low: float | None = None
    high: float | None = None
    names: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class FaultKind:
    """What can go wrong: the word for it, what then happens, and the keys that count for it."""

    kind: str
    text: str
    keys: tuple[FaultKey, ...]


@dataclass(frozen=True, slots=True)
class FaultKey:
    """A key of a fault: ``choices`` are all values that it can have, ``known`` those that have a meaning, each with it.

    ``default`` is what counts without it, "" if it must be given or some wrong value is taken.
    """

    key: str
    text: str
    default: str = ""
    choices: tuple[str, ...] = ()
    known: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class PartnerValue:
    """A value of a partner as it is now: ``name`` as :meth:`Recording.put` takes it."""

    name: str
    title: str
    unit: str
    value: str


class PendingFault(Protocol):
    """A fault that waits for its occasions: ``times`` are left, None for all; with 0 it is spent."""

    times: int | None

    @property
    def spent(self) -> bool:
        """Whether it has struck as often as it should."""


class RecordedJob(Protocol):
    """A job on a CPU."""

    @property
    def facts(self) -> JobFacts:
        """What does not change."""

    def inputs(self) -> Iterator[JobInput]:
        """The values that it takes from its caller."""

    def signals(self) -> Iterator[Observed]:
        """What is recorded of it: ``execute``, ``state``, ``busy``, ``done``, ``error``, ``status`` and more.

        ``telegram`` counts its telegrams from 1, ``retries`` what was repeated.
        """

    def after(self) -> bool:
        """Look at the job behind a scan; whether it began a retry."""

    def sends(self, contact: Contact) -> bool:
        """Whether a contact counts as a telegram of the job."""

    def end(self, *, finished: bool) -> JobEnd:
        """What it has to show now."""


class Recorded(Protocol):
    """The plan of a protocol on a CPU."""

    def job(self, key: str) -> RecordedJob:
        """One job. Raises KeyError for a block or member that is not in the files."""

    def signals(self) -> Iterator[Observed]:
        """What is recorded of what the jobs share; a signal ``owner`` names the job that has it."""

    def job_of(self, instance: str) -> str | None:
        """For which job an instance of a system block works; None if it is none of the protocol's."""

    def take(self) -> tuple[Contact, ...]:
        """What went over the wire since the last time."""


class Recording(Protocol):
    """What can be recorded of a plan."""

    @property
    def jobs(self) -> Sequence[str]:
        """Keys of the jobs."""

    @property
    def partners(self) -> Sequence[str]:
        """Names for which files may be given."""

    @property
    def faults(self) -> Sequence[str]:
        """Kinds of faults."""

    @property
    def kinds(self) -> Sequence[FaultKind]:
        """The same with their keys."""

    @property
    def fault(self) -> str:
        """A fault that shows something."""

    @property
    def drain(self) -> int:
        """How many ms a job may last beyond its timeout."""

    @property
    def constants(self) -> Mapping[str, int]:
        """System constants by name."""

    @property
    def controls(self) -> Sequence[str]:
        """The DBs with the commands."""

    @property
    def words(self) -> tuple[str, str]:
        """What calls and partners are called."""

    @property
    def calls(self) -> Sequence[CallShape]:
        """The system blocks that every job calls."""

    def connect(self, bus: Periphery, options: PartnerOptions) -> None:
        """Put the partners on the bus. Raises DiagnosticError with every mistake of the options."""

    def attach(self, cpu: RecordingCpu) -> Recorded:
        """Watch a CPU that has started."""

    def contents(self) -> Iterator[PartnerValue]:
        """What the jobs read and write on the partners."""

    def put(self, text: str) -> bool:
        """Change a partner by hand, ``NAME=VALUE``; False if it has nothing of that name. Raises DiagnosticError."""

    def strike(self, fault: str) -> Sequence[PendingFault]:
        """One more fault from now on, of one or more partners. Raises DiagnosticError."""
