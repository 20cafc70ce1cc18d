"""One access of a job to a parameter, and what it is there for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias, TypeVar

from plcgen.ds47.device import Parameter
from plcgen.ds47.kind import Poll, ReadItem, Wait, WriteItem
from plcgen.ds47.wire.formats import FROM_ANSWER, Format, FormatKind, unpack_values
from plcgen.project.spec import SpecPath

_NUMBERS = frozenset({FormatKind.BOOLEAN, FormatKind.SIGNED, FormatKind.UNSIGNED, FormatKind.FLOAT})


@dataclass(frozen=True, slots=True)
class Read:
    """The value is an output, or a member of the record if it is ``recorded``.

    ``shown`` are outputs of their own: bits of a word, or what a value is whose type comes from the answer.
    """

    recorded: bool = False
    shown: tuple[Use, ...] = ()


@dataclass(frozen=True, slots=True)
class Write:
    """The value is written: a constant, an input, a member of the record, or ``bits`` of the word that is there."""

    constant: bool = False
    recorded: bool = False
    bits: tuple[Use, ...] = ()


@dataclass(frozen=True, slots=True)
class Bit:
    """One of the bits of a word that is written; it is in no telegram of its own."""

    number: int
    constant: bool


@dataclass(frozen=True, slots=True)
class Form:
    """What a value is whose type comes from the answer: its ``format``, or the value as ``dint`` or ``real``."""

    name: str


@dataclass(frozen=True, slots=True)
class Compare:
    """The value is what the drive should have: a constant, an input, or a member of the record."""

    constant: bool = False
    recorded: bool = False


@dataclass(frozen=True, slots=True)
class Verify:
    """What was written is read back."""

    of: Use


@dataclass(frozen=True, slots=True)
class Remember:
    """The old value of what is written is read first, to be written back if the job fails."""

    of: Use


@dataclass(frozen=True, slots=True)
class Mask:
    """The word of which bits are written is read first: all other bits stay as they are."""

    of: Use


@dataclass(frozen=True, slots=True)
class Running:
    """The word in which the drive says whether it runs is read: old values are not written back while it does."""


@dataclass(frozen=True, slots=True)
class Column:
    """Eight messages of a buffer are read, one column of them; ``group`` counts from 0."""

    name: str
    group: int


@dataclass(frozen=True, slots=True)
class Recount:
    """The counter of a buffer of messages, or the codes of a group, are read once more, to see whether they changed."""


Role: TypeAlias = (
    Read | Write | Bit | Form | Compare | Verify | Remember | Mask | Running | Column | Recount | Poll | Wait
)
_Role = TypeVar("_Role", bound=Role)


@dataclass(frozen=True, slots=True)
class Use:
    """One parameter of a job, before packing: where it is, and in ``role`` what it is there for.

    ``count`` values of ``format`` (for string formats: octets), ``elements`` the byte in the address of an unsplit
    access, ``data`` the constant, start value or wanted value as wire bytes, ``sources`` whether values are BICO values
    with a drive object. ``path`` is the place in the spec and ``item`` what stands there; ``position`` is that in
    ``errors``, from 1, ``step`` the step of a sequence, 0 in other jobs. ``served``: inputs name the parameter.
    """

    position: int
    parameter: Parameter
    format: Format
    first: int | None
    elements: int
    count: int
    data: bytes
    sources: bool
    member: str
    comment: dict[str, str]
    path: SpecPath
    item: ReadItem | WriteItem
    role: Role = Read()
    step: int = 0
    served: bool = False

    def as_(self, role: type[_Role]) -> _Role | None:
        """Its role, if it is of this type."""
        return self.role if isinstance(self.role, role) else None

    @property
    def writes(self) -> bool:
        """Whether it changes a parameter."""
        return isinstance(self.role, Write)

    @property
    def type_text(self) -> str:
        """Its type, for messages, with what is to be added if nobody has read it."""
        return f"{self.format.name}{self.parameter.doubt('type')}"

    @property
    def supplied(self) -> bool:
        """Whether it has a value of this side: a constant, an input or a member of a record."""
        return isinstance(self.role, Write | Compare | Bit)

    @property
    def constant(self) -> bool:
        """Whether that value is a constant."""
        return isinstance(self.role, Write | Compare | Bit) and self.role.constant

    @property
    def recorded(self) -> bool:
        """Whether its value is a member of a record."""
        return isinstance(self.role, Read | Write | Compare) and self.role.recorded

    @property
    def bits(self) -> tuple[Use, ...]:
        """The bits that are written, of a word that is not written as a whole."""
        return self.role.bits if isinstance(self.role, Write) else ()

    @property
    def shown(self) -> tuple[Use, ...]:
        """Of what is read: bits of the word, or the forms of a value without a type, each an output of its own."""
        return self.role.shown if isinstance(self.role, Read) else ()

    @property
    def untyped(self) -> bool:
        """Whether its type comes from the answer."""
        return self.format is FROM_ANSWER

    @property
    def bit(self) -> int | None:
        """The number of a bit of a word; None of any other access."""
        return self.role.number if isinstance(self.role, Bit) else None

    @property
    def precedes(self) -> bool:
        """Whether it reads the old value of what is written."""
        return isinstance(self.role, Remember | Mask)

    @property
    def subindex(self) -> int:
        """First subindex; 0 without an index."""
        return self.first or 0

    @property
    def numbers(self) -> frozenset[object] | None:
        """What it writes, if those are numbers that the spec gives."""
        plain = self.constant and not self.bits and self.format.kind in _NUMBERS
        return frozenset(unpack_values(self.format, self.count, self.data)) if plain else None

    @property
    def mask(self) -> bytes:
        """The bits of its values that are written: all of them, or those of a word that are named."""
        size = self.count * self.format.size
        return sum(1 << (one.bit or 0) for one in self.bits).to_bytes(size) if self.bits else b"\xff" * size

    @property
    def divisible(self) -> bool:
        """Whether the access may be spread over several telegrams."""
        return self.count > 1 and not self.format.is_string and not isinstance(self.role, Column | Recount)

    @property
    def label(self) -> str:
        """``P50303``, ``r945[0]``, ``P2155[1..2]`` or ``P1200.3``, as messages and comments write it."""
        numbers = (str(one.bit) for one in (self.bits or (self,)) if one.bit is not None)
        return ".".join((self.place, ", .".join(numbers))).removesuffix(".")

    @property
    def place(self) -> str:
        """The same without bits."""
        if self.served:
            return "number[index]"
        base = self.parameter.label
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
