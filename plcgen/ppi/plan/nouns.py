"""The frozen plan of PPI masters: stations, jobs, telegrams with their tables, where values lie, how long answers take.

Offsets here come from the telegram (FDL and S7 PDU), never from S7 layout rules: verification compares the two.

Sources: manual "CP 341, Installation and Parameter Assignment", A5E02191071-01, table 6-15 (32 bytes in a program
cycle, at least three calls); TIA Portal information system, "Overview of Freeport communication" (acyclic data
exchange takes several cycles).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Literal

from plcgen.ppi.schema import PpiSection
from plcgen.ppi.wire.model import Item
from plcgen.ppi.wire.profiles import CpuProfile
from plcgen.project.nouns import BlockRef, Buffer, BufferField, Link, Plan, PlannedJob, Telegram
from plcgen.project.spec import SpecPath
from plcgen.s7.types.data_types import DataType, Elementary
from plcgen.s7.types.names import shorten

Kind = Literal["read", "write", "run", "stop", "sync"]
"""``sync`` is a harmless read that tells a station the frame count bit before anything is executed."""

LEAD = 1
"""A table begins with the length of its telegram: with it, every word of a telegram has an even offset."""


@dataclass(frozen=True, slots=True)
class PlannedStation(Link):
    """An S7-200 on the line; ``index`` counts the stations of a master from 1."""

    index: int
    address: int
    profile: CpuProfile


@dataclass(frozen=True, slots=True)
class PpiValue:
    """One address of a job: ``count`` elements of ``element``, ``stride`` bytes apart on the wire, ``skip`` bytes in.

    ``type`` is its type at the block, ``position`` counts inside the job, ``number`` inside the master; ``data`` is the
    constant or start value as wire bytes.
    """

    position: int
    number: int
    label: str
    item: Item
    type: DataType
    element: Elementary
    count: int
    stride: int
    skip: int
    member: str
    data: bytes
    constant: bool
    title: str
    comment: dict[str, str]
    path: SpecPath

    @property
    def bit(self) -> bool:
        """Whether it is a single bit."""
        return self.element.name == "BOOL"

    @property
    def size(self) -> int:
        """Bytes of one element."""
        return 1 if self.bit else self.element.bits // 8


@dataclass(frozen=True, slots=True)
class Placed:
    """A value inside an item of the wire: ``length`` bytes at ``offset`` are bytes ``start`` on of the value.

    ``bit`` is the bit if a byte carries a bit.
    """

    value: PpiValue
    offset: int
    start: int
    length: int
    bit: int | None = None

    @property
    def whole(self) -> bool:
        """Whether this is the complete value."""
        return self.length == self.value.item.octets


@dataclass(frozen=True, slots=True)
class WireItem:
    """One item of a telegram; ``number`` counts the items of a master from 1, ``data`` is what is written."""

    number: int
    item: Item
    values: tuple[Placed, ...]
    data: bytes = b""

    @property
    def single(self) -> PpiValue | None:
        """The value, if the item holds just this one, whole and at its start."""
        only = self.values[0] if len(self.values) == 1 else None
        exact = only is not None and only.bit is None and only.whole and only.value.item.octets == self.item.octets
        return only.value if only is not None and exact and not only.value.skip else None


@dataclass(frozen=True, slots=True)
class PpiField(BufferField):
    """One member of a table or response DB; ``item`` is the item it belongs to, from 1 (0: none)."""

    item: int = 0
    placed: tuple[Placed, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class PpiTelegram(Telegram):
    """One request and its reply. The request's bytes are the whole frame with function code 6Ch and reference 0.

    ``number`` counts the telegrams of a master.
    """

    request: Buffer[PpiField]
    response: Buffer[PpiField] | None
    kind: Kind
    station: PlannedStation
    items: tuple[WireItem, ...]

    @property
    def reordered(self) -> bool:
        """Whether an item carries a value that the spec names in front of all those of the item before it."""
        first = [min(placed.value.position for placed in item.values) for item in self.items if item.values]
        return first != sorted(first)


@dataclass(frozen=True, slots=True, eq=False)
class PpiJob(PlannedJob):
    """One job; ``number`` counts the jobs of a master from 1, times are in ms, ``cycle`` 0 means on demand.

    Names at the block begin with ``stem``, those of flags with ``member``, as in the control DB: all masters share it.
    """

    stem: str
    kind: Kind
    link: PlannedStation
    telegrams: tuple[PpiTelegram, ...]
    number: int
    values: tuple[PpiValue, ...]
    cycle: int
    longest_name: int

    @property
    def station(self) -> PlannedStation:
        """The station that is asked."""
        return self.link

    def pin(self, name: str) -> str:
        """Name of a signal or value at the master's block: ``levels`` and ``busy`` become ``levelsBusy``."""
        return _pin(self.stem, name, self.longest_name)

    @property
    def inputs(self) -> tuple[PpiValue, ...]:
        """The values the caller supplies."""
        return tuple(value for value in self.values if self.kind == "write" and not value.constant)

    @property
    def outputs(self) -> tuple[PpiValue, ...]:
        """The values the block returns."""
        return self.values if self.kind == "read" else ()


@lru_cache(4096)
def _pin(stem: str, name: str, longest: int) -> str:
    """Asked by the proof in every scan."""
    return shorten(f"{stem}{name[:1].upper()}{name[1:]}", longest)


@dataclass(frozen=True, eq=False)
class PlannedMaster:
    """One serial port as PPI master: one function block for all its jobs; times are in ms."""

    key: str
    module: str
    port: int
    own_address: int
    baud: int
    ob1_cycle: int
    ack_timeout: int
    reply_timeout: int
    retry_pause: int
    poll_pause: int
    retries: int
    polls: int
    stations: tuple[PlannedStation, ...]
    jobs: tuple[PpiJob, ...]
    syncs: tuple[PpiTelegram, ...]
    block: BlockRef
    instance: BlockRef
    module_instances: tuple[BlockRef, BlockRef] | None
    buffer: BlockRef | None
    comment: dict[str, str]
    path: SpecPath

    @cached_property
    def telegrams(self) -> tuple[PpiTelegram, ...]:
        """Every telegram of the master by number: those of the jobs, then those that only count frames."""
        return (*(telegram for job in self.jobs for telegram in job.telegrams), *self.syncs)

    @cached_property
    def blocks(self) -> tuple[BlockRef, ...]:
        """Every block of the master, in a stable order."""
        found: list[BlockRef] = []
        for telegram in self.telegrams:
            found += [block for buffer in telegram.buffers for block in (buffer.type, buffer.home)]
        own = (self.block, self.instance, *(self.module_instances or ()), *((self.buffer,) if self.buffer else ()))
        return (*found, *own)


@dataclass(frozen=True, eq=False)
class PpiPlan(Plan):
    """All masters of a spec, the type of their diagnostics and the DB with the commands and results of their jobs."""

    jobs: tuple[PpiJob, ...]
    masters: tuple[PlannedMaster, ...]
    diagnostics_type: BlockRef
    control_db: BlockRef

    @property
    def spec(self) -> PpiSection:
        """The sections of the spec that are planned here."""
        return self.loaded.sections(PpiSection)

    def key(self, master: PlannedMaster, job: PpiJob) -> str:
        """Name of a job in the whole spec; with several masters it begins with the master."""
        return f"{master.key}.{job.key}" if len(self.masters) > 1 else job.key

    def station_key(self, master: PlannedMaster, station: PlannedStation) -> str:
        """Name of a station in the whole spec; with several masters it begins with the master."""
        return f"{master.key}.{station.key}" if len(self.masters) > 1 else station.key


CHARACTER_BITS = 11
GAP_BITS = 35
"""Bit times without a character that end a message: more than the 33 that EN 50170 keeps between two frames."""
PIECE, MORE_CALLS = 32, 2
"""Bytes that P_RCV_RK takes from a CP 341 in a program cycle, and its calls beside those."""
CM_CALLS = 2
"""Calls of Receive_P2P from the one that finds a message to the one with NDR."""
E5 = 1
REPLY_FRAME = 23
"""Bytes of a reply around its data: 7 of the frame, 12 of the header, 2 parameters, FCS and end."""
POLL = 6
SYNC = 33, 28
"""Characters of the read of SMB0 and of its reply."""
START_CALLS, BLOCK_CALLS = 1, 3
"""Calls before the first telegram; of a block that sets or resets a port, and the one behind its end."""
ACK_LEAST, ACK_STATION = 250, 50
REPLY_LEAST, REPLY_STATION = 600, 150
"""What a timeout is at least unless the spec says otherwise, and what it leaves to the station."""


def line_ms(bits: int, baud: int) -> int:
    """Milliseconds of bits on the line, rounded up."""
    return -(-bits * 1000 // baud)


def heard_ms(characters: int, baud: int, ob1: int, *, classic: bool) -> int:
    """Milliseconds from the end of sending until a block has an answer of so many characters that comes at once.

    One cycle more than the calls: behind its end the sending block is called once more.
    """
    calls = MORE_CALLS + -(-characters // PIECE) if classic else CM_CALLS
    return line_ms(characters * CHARACTER_BITS, baud) + line_ms(GAP_BITS, baud) + (calls + 1) * ob1


def lengths(telegram: PpiTelegram) -> tuple[int, int]:
    """Characters of a request and of its reply, if all items are good."""
    return len(telegram.request.data), REPLY_FRAME + (telegram.response.size if telegram.response else 0)


def characters(telegram: PpiTelegram) -> int:
    """Characters of a whole exchange: request, E5, poll, reply."""
    return sum(lengths(telegram)) + E5 + POLL


def job_ms(job: PpiJob, baud: int, ob1: int, *, classic: bool) -> int:
    """Milliseconds that a job takes whose station answers at once, as the first one after power-up.

    A frame is sent in as many calls as it is received in. A CM is configured by two blocks first and reset before each
    telegram, three calls each; what is not a read follows the read of SMB0.
    """
    exchanges = [lengths(telegram) for telegram in job.telegrams] + ([SYNC] if job.kind != "read" else [])
    calls = START_CALLS + (0 if classic else 2 * BLOCK_CALLS)
    frames = 0
    for request, reply in exchanges:
        calls += 1 + (0 if classic else BLOCK_CALLS)
        frames += sum(heard_ms(octets, baud, ob1, classic=classic) for octets in (request, E5, POLL, reply))
        frames -= 2 * line_ms(GAP_BITS, baud)  # nobody waits for one behind what is sent
    return frames + calls * ob1


def longest_reply(jobs: Iterable[PpiJob]) -> int:
    """Characters of the longest reply, 23 if none has data."""
    sizes = (t.response.size for job in jobs for t in job.telegrams if t.response is not None)
    return REPLY_FRAME + max(sizes, default=0)


def chosen(least: int, needed: int, station: int) -> int:
    """A timeout that leaves so much to the station, in tens of milliseconds."""
    return max(least, -(-(needed + station) // 10) * 10)
