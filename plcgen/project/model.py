"""The frozen project: what is sent, what is stored where, and which name and number everything has.

Offsets here come from the telegram (DS47), never from S7 layout rules: verification compares the two.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from plcgen.project.loading import LoadedSpec, SpecPath
from plcgen.project.target import Target
from plcgen.protocols.ds47.devices import Device, Parameter
from plcgen.protocols.ds47.wire.formats import Format
from plcgen.s7.address import Address
from plcgen.s7.types import DataType

if TYPE_CHECKING:
    from plcgen.protocols.ppi.plan.model import PpiPlan


@dataclass(frozen=True, slots=True)
class BlockRef:
    """A block's identity. ``pinned`` says that the spec gave the number; ``path`` where it did."""

    kind: str
    name: str
    number: int
    pinned: bool
    path: SpecPath


@dataclass(frozen=True, slots=True)
class PlannedDrive:
    """A drive as the blocks address it.

    ``id_value`` is the ID of WRREC/RDREC, bit 15 included; ``token`` is shared by all drives at one address.
    """

    key: str
    device: Device
    id_value: int
    drive_object: int
    record_index: int
    token: BlockRef
    comment: dict[str, str]
    path: SpecPath


@dataclass(frozen=True, slots=True)
class Use:
    """One parameter of a job, before packing.

    ``count`` values of ``format`` (for string formats: octets), ``elements`` the byte in the address of an
    unsplit access, ``data`` the constant or start value as wire bytes, ``constant`` whether it is a constant.
    """

    position: int
    parameter: Parameter
    format: Format
    first: int | None
    elements: int
    count: int
    data: bytes
    constant: bool
    member: str
    comment: dict[str, str]
    path: SpecPath

    @property
    def subindex(self) -> int:
        """First subindex; 0 without an index."""
        return self.first or 0

    @property
    def divisible(self) -> bool:
        """Whether the access may be spread over several telegrams."""
        return self.count > 1 and not self.format.is_string

    @property
    def label(self) -> str:
        """``P50303``, ``r945[0]`` or ``P2155[1..2]``, as messages and comments write it."""
        base = f"{'r' if self.parameter.access == 'r' else 'P'}{self.parameter.pnu}"
        if self.first is None:
            return base
        last = self.first + (1 if self.format.is_string else self.count) - 1
        return f"{base}[{self.first}]" if last == self.first else f"{base}[{self.first}..{last}]"


@dataclass(frozen=True, slots=True)
class Part:
    """A use, or a slice of an array use, inside one telegram: values ``start`` .. ``start + count - 1``."""

    use: Use
    start: int
    count: int

    @property
    def subindex(self) -> int:
        """Subindex of the first value of this part."""
        return self.use.subindex + self.start

    @property
    def elements(self) -> int:
        """The elements byte of the address."""
        return self.use.elements if self.whole else self.count

    @property
    def whole(self) -> bool:
        """Whether this is the complete use."""
        return self.count == self.use.count

    @property
    def size(self) -> int:
        """Bytes of the values, without the pad."""
        return self.count * self.use.format.size

    @property
    def data(self) -> bytes:
        """Wire bytes of this part's constant or start values."""
        step = self.use.format.size
        return self.use.data[self.start * step : (self.start + self.count) * step]


@dataclass(frozen=True, slots=True)
class Field:
    """One member of a buffer DB: where it lies in the telegram and what it holds at start.

    ``data`` is the start value as wire bytes; zeros for what the drive fills in.
    """

    name: str
    role: str
    type: DataType
    offset: int
    size: int
    data: bytes
    part: Part | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Telegram:
    """One request/response pair: bytes, buffers and what every byte is called."""

    index: int
    parts: tuple[Part, ...]
    request: bytes
    request_db: BlockRef
    request_type: BlockRef
    request_fields: tuple[Field, ...]
    positive_length: int
    negative_length: int
    response_size: int
    response_db: BlockRef
    response_type: BlockRef
    response_fields: tuple[Field, ...]
    pinned_response: int | None


@dataclass(frozen=True, slots=True)
class PlannedTrigger:
    """Absolute flags of a call; None where the control DB's member is used."""

    execute: Address | None = None
    busy: Address | None = None
    done: Address | None = None
    error: Address | None = None
    status: Address | None = None

    def items(self) -> list[tuple[str, Address]]:
        """The flags that are absolute, by signal name."""
        pairs = [(name, getattr(self, name)) for name in ("execute", "busy", "done", "error", "status")]
        return [(name, address) for name, address in pairs if address is not None]


@dataclass(frozen=True, slots=True, eq=False)
class PlannedJob:
    """A parameter job: one function block, one or more telegrams, all on one drive."""

    key: str
    member: str
    write: bool
    drive: PlannedDrive
    owner: int
    uses: tuple[Use, ...]
    telegrams: tuple[Telegram, ...]
    block: BlockRef
    instance: BlockRef
    record_instances: tuple[BlockRef, BlockRef] | None
    trigger: PlannedTrigger
    reference: int
    timeout: int
    retry_pause: int
    retries: int
    faq_names: bool
    comment: dict[str, str]
    path: SpecPath

    @property
    def inputs(self) -> tuple[Use, ...]:
        """The values the caller supplies."""
        return tuple(use for use in self.uses if self.write and not use.constant)

    @property
    def outputs(self) -> tuple[Use, ...]:
        """The values the block returns."""
        return () if self.write else self.uses


@dataclass(frozen=True, eq=False)
class Project:
    """Everything the emitters, rules and verification need; positions are looked up in ``loaded`` on demand."""

    loaded: LoadedSpec
    name: str
    target: Target
    languages: tuple[str, ...]
    drives: tuple[PlannedDrive, ...]
    jobs: tuple[PlannedJob, ...]
    diagnostics_type: BlockRef
    token_type: BlockRef
    control_db: BlockRef
    ppi: PpiPlan | None = None

    @cached_property
    def tokens(self) -> tuple[tuple[BlockRef, tuple[PlannedDrive, ...]], ...]:
        """Each token DB with the drives that share it: all drive objects at one address."""
        shared: dict[str, list[PlannedDrive]] = {}
        for drive in self.drives:
            shared.setdefault(drive.token.name, []).append(drive)
        return tuple((drives[0].token, tuple(drives)) for drives in shared.values())

    @cached_property
    def blocks(self) -> tuple[BlockRef, ...]:
        """Every block of the project, in a stable order: types, drives' tokens, jobs, control DB, PPI masters."""
        masters = self.ppi.blocks if self.ppi is not None else ()
        if not self.jobs and masters:
            return masters
        found = [self.diagnostics_type, self.token_type, *(token for token, _ in self.tokens)]
        for job in self.jobs:
            for telegram in job.telegrams:
                found += [
                    telegram.request_type,
                    telegram.response_type,
                    telegram.request_db,
                    telegram.response_db,
                ]
            found += [job.block, job.instance, *(job.record_instances or ())]
        return (*found, self.control_db, *masters)
