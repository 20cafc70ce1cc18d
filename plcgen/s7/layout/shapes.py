"""How one type lies in standard-access memory: size, alignment, fields; the rules behind ``layout``.

A rule is *compiled* when STEP 7 V5 compiled blocks that need it, *literature* otherwise. A literature rule
only makes an offset doubtful where it changes the outcome.
"""

from __future__ import annotations

import itertools
import math
import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, NamedTuple

from plcgen.base.diagnostics import Diagnostic, Note, Span
from plcgen.base.diagnostics.suggest import Vocabulary, did_you_mean
from plcgen.s7.layout.evidence import ARRAY_END, BIT_ROWS, COMPOSITE_START, NO_DOUBTS, SIZES, STRING_STRIDE
from plcgen.s7.types.blocks import Block, BlockKind, SectionKind
from plcgen.s7.types.data_types import (
    ELEMENTARY,
    ArrayType,
    DataType,
    Elementary,
    Member,
    NamedType,
    StringType,
    StructType,
    elementary,
)
from plcgen.s7.types.system import is_literature, system_block

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

MAX_BYTES = 16 * 1024 * 1024
MAX_ENTRIES = 1_000_000
MAX_DEPTH = 64
MAX_STRING = {"STRING": 254, "WSTRING": 16382}

INSTANCE_SECTIONS = (SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.IN_OUT, SectionKind.STATIC)
BY_POINTER = frozenset({"DATE_AND_TIME", "DTL"})
NO_MEMORY = frozenset({"VARIANT", "VOID"})


class Field(NamedTuple):
    """A member inside its parent: ``offset`` in bits from the parent's start, ``doubts`` the rules it rests on."""

    member: Member
    offset: int
    shape: Shape
    doubts: frozenset[str]


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """One type in memory; every measure in bits.

    ``bits`` is the room taken including padding, ``used`` without padding that only literature asks for;
    ``align`` and ``first_align`` are the alignment with and without literature rules; ``has_struct`` says that it
    is a structure or has one inside; ``count`` is how many entries a member of this type adds to a layout.
    ``doubts`` are the literature rules (``evidence``) that the size rests on, ``stride_doubts`` those of the places
    of an array's elements but the first. ``spare`` are the bits that an ARRAY OF BOOL leaves free in its last byte.
    """

    type: DataType
    bits: int
    align: int
    used: int
    first_align: int
    has_struct: bool = False
    doubts: frozenset[str] = NO_DOUBTS
    count: int = 1
    depth: int = 0
    fields: tuple[Field, ...] = ()
    index: Mapping[str, Field] = field(default_factory=dict)
    element: Shape | None = None
    strides: tuple[int, ...] = ()
    stride_doubts: frozenset[str] = NO_DOUBTS
    spare: int = 0
    looked_up: dict[str, Any] = field(default_factory=dict, repr=False)
    """What ``layout.locate`` has found in this shape, by path: scenarios ask for the same members again and again."""

    def places(self) -> Iterator[tuple[str, int]]:
        """Index and offset in bits of every element of an array, the last index counting fastest; else nothing."""
        if not isinstance(self.type, ArrayType):
            return
        bounds = self.type.bounds
        for indices in itertools.product(*(range(low, high + 1) for low, high in bounds)):
            steps = zip(indices, bounds, self.strides, strict=True)
            yield ",".join(map(str, indices)), sum((i - low) * stride for i, (low, _), stride in steps)


@dataclass(slots=True)
class _Cursor:
    """The next free bit: ``bits`` by all rules, ``low`` without those that only literature asks for.

    While the two differ, ``causes`` are the rules behind it; ``doubts`` are those of sizes, which never go away.
    """

    bits: int = 0
    low: int = 0
    doubts: frozenset[str] = NO_DOUBTS
    causes: frozenset[str] = NO_DOUBTS

    def place(self, shape: Shape) -> tuple[int, frozenset[str]]:
        align = shape.align
        offset = -(-self.bits // align) * align
        if shape.first_align == align and self.low == self.bits:
            self.bits = self.low = offset + shape.bits
            doubts = self.doubts
        else:
            doubts = self._compare(shape, offset)
        if shape.used != shape.bits:
            self.low -= shape.bits - shape.used
            self.causes |= {ARRAY_END}
        if shape.doubts:
            self.doubts = union(self.doubts, shape.doubts)
        return offset, doubts

    def _compare(self, shape: Shape, offset: int) -> frozenset[str]:
        """Place a member in both ways; equal places need no literature rule."""
        first = shape.first_align
        low = _up(self.low, first)
        if low == offset:
            self.causes, doubts = NO_DOUBTS, self.doubts
        else:
            if low != _up(self.low, shape.align) or _up(self.bits, first) != offset:
                self.causes |= {COMPOSITE_START}
            doubts = union(self.doubts, self.causes) if self.doubts else self.causes
            if shape.has_struct and first != shape.align:
                self.doubts = doubts  # its own padding is then unknown: the two ways do not surely meet again
        self.bits, self.low = offset + shape.bits, low + shape.bits
        if low % 8 and shape.element is not None and shape.element.bits == 1:  # it ends elsewhere than from a byte on
            self.low += _up(low + shape.used - shape.spare, 8) - low - shape.used
        return doubts

    def even(self) -> None:
        self.bits, self.low = _up(self.bits, 16), _up(self.low, 16)
        if self.bits == self.low:
            self.causes = NO_DOUBTS


_NUMBERED = re.compile(r"(?:UDT|S?FB)[0-9]+", re.IGNORECASE)
_SYSTEM = re.compile(
    r"SF[BC][0-9]{1,3}|IEC_\w+|CT(?:U|D|UD)_\w+|T(?:CON|SEND|RCV|DISCON|USEND|URCV)(?:_\w+)?|T(?:ON|OF|P|ONR)_\w+"
    r"|(?:PID|MC|TO|MB|G7)_\w+|TMAIL_C|RALRM|GET|PUT|[BU]SEND|[BU]RCV|CONT_[CS]|PULSEGEN|CTRL_\w+|PROGRAM_ALARM"
    r"|REMOTE|T_(?:DIAG|RESET)|TDIAG_STATUS"
    r"|(?:SEND|RECEIVE)_(?:P2P|RESET|CONFIG)|PORT_CONFIG|P_(?:SND|RCV)_RK|SEND_PTP|RCV_PTP", re.IGNORECASE
)  # fmt: skip
"""Names of the system libraries, beyond those whose members ``system`` has."""
OPEN_ARRAY = "ARRAY[*] has no length where it is memory of its own"
"""What is said of an array without bounds that is no parameter."""


class TypeTable(dict[str, "Block"]):
    """Types by upper-case name without quotes: made once, looked up by every layout without another copy.

    An export without its types asks for hundreds of names, and for each of them many times: what is near is kept as
    long as no type comes in.
    """

    _near: tuple[int, Vocabulary, dict[str, str]] = (-1, Vocabulary(()), {})

    def near(self, name: str) -> str:
        """``did you mean "x"?`` for a name that is no type, or an empty string."""
        if self._near[0] != len(self):
            known = (other for other, block in self.items() if block.kind in (BlockKind.UDT, BlockKind.FB))
            self._near = (len(self), Vocabulary([*known, *ELEMENTARY]), {})
        _, words, told = self._near
        if name not in told:
            told[name] = near_type(name, words)
        return told[name]

    @classmethod
    def of(cls, types: Mapping[str, Block]) -> TypeTable:
        """The table of a mapping with names in any spelling; a table is returned as it is."""
        if isinstance(types, cls):
            return types
        return cls((name.upper().strip('"'), block) for name, block in types.items())


class ShapeBuilder:
    """Turns declared types into shapes; collects every problem instead of stopping at the first."""

    def __init__(self, types: Mapping[str, Block], owner: Span) -> None:
        self._types = TypeTable.of(types)
        self._owner = owner
        self._named: dict[str, Shape] = {}
        self._open: list[str] = []
        self._depth = 0
        self.diagnostics: list[Diagnostic] = []

    def report(self, code: str, message: str, span: Span | None, help_text: str = "") -> None:
        """Add one problem; without a span it is put at the block."""
        self.diagnostics.append(Diagnostic(code, message, span or self._owner, help=help_text))

    def find(self, name: str, *, quoted: bool = False) -> Block | None:
        """Find the block or type called ``name`` in any letter case; user blocks go before system types.

        In quotes a system type is a symbol of STEP 7 V5, which only the S7-300/400 have.
        """
        return self._types.get(name.upper()) or system_block(name, classic=quoted)

    def block(self, block: Block) -> Shape:
        """Shape of a block's memory: an FB's instance data, a DB, a UDT; FC and OB take none."""
        self.check_names(block.members)
        if block.kind in (BlockKind.FC, BlockKind.OB):
            return self.struct(StructType(()), ())
        self._open.append(block.name.upper())
        source = self._source(block)
        groups = [(kind, source.section(kind)) for kind in INSTANCE_SECTIONS]
        shape = self.struct(StructType(()), groups, doubts=_doubts(source))
        self._open.pop()
        return shape

    def _source(self, block: Block) -> Block:
        """Choose the declaration that counts: an instance DB without members has those of its type."""
        if block.instance_of is None or block.members:
            return block
        source = self.find(block.instance_of)
        if source is not None and source.instance_of is None and source.kind in (BlockKind.FB, BlockKind.UDT):
            if source.name.upper() not in self._open:
                self.check_names(source.members)
                self._open[-1] = source.name.upper()
            return source
        self.unknown(block.instance_of, block.span, source)
        return block

    def struct(
        self,
        type_: DataType,
        groups: Iterable[tuple[SectionKind, Sequence[Member]]],
        *,
        doubts: frozenset[str] = NO_DOUBTS,
    ) -> Shape:
        """Lay members out in section order; every section starts and the whole ends at an even byte."""
        cursor = _Cursor(doubts=doubts)
        fields: list[Field] = []
        index: dict[str, Field] = {}
        for kind, members in groups:
            cursor.even()
            for member in members:
                placed = self._field(member, kind, cursor, index)
                fields.append(placed)
                index.setdefault(member.name.upper(), placed)
        cursor.even()
        shapes = [f.shape for f in fields]
        return Shape(
            type_,
            cursor.bits,
            16,
            cursor.bits,
            shapes[0].first_align if shapes else 1,
            has_struct=True,
            doubts=cursor.doubts | cursor.causes,
            count=1 + sum(s.count for s in shapes),
            depth=1 + max((s.depth for s in shapes), default=0),
            fields=tuple(fields),
            index=index,
        )

    def _field(self, member: Member, kind: SectionKind, cursor: _Cursor, index: Mapping[str, Field]) -> Field:
        known = _ELEMENTARY.get(member.type.name) if isinstance(member.type, Elementary) else None
        if known is not None and member.at is None and kind is not SectionKind.IN_OUT:
            offset, doubts = cursor.place(known)
            return Field(member, offset, known, doubts)
        if kind is SectionKind.IN_OUT and self._by_pointer(member.type):
            if not isinstance(member.type, ArrayType) or member.type.bounds:  # ARRAY[*] takes what it is given
                self.shape(member.type, member)
            shape = Shape(ELEMENTARY["POINTER"], 48, 16, 48, 16)
        else:
            shape = self.shape(member.type, member)
        if member.at is None:
            offset, doubts = cursor.place(shape)
            return Field(member, offset, shape, doubts)
        target = index.get(member.at.strip('"#').upper())
        if target is None:
            help_text = did_you_mean(member.at, (f.member.name for f in index.values()))
            message = f"{member.name} AT {member.at}: no such variable is declared above"
            self.report("PG806", message, member.span, help_text)
            return Field(member, cursor.bits, shape, NO_DOUBTS)
        return Field(member, target.offset, shape, target.doubts)

    def _by_pointer(self, type_: DataType) -> bool:
        """Whether an IN_OUT of this type is kept as a 6-byte pointer to the caller's data."""
        plain = elementary(type_.name) if isinstance(type_, NamedType) and not type_.quoted else type_
        if isinstance(plain, Elementary):
            return plain.name in BY_POINTER
        return not (isinstance(type_, NamedType) and type_.name.upper() in NO_MEMORY)

    def shape(self, type_: DataType, member: Member) -> Shape:
        """Shape of any type; ``member`` is where it is declared, for messages."""
        if isinstance(type_, Elementary):
            return _ELEMENTARY[type_.name]
        if isinstance(type_, StringType):
            limit = MAX_STRING.get(type_.name.upper(), 0)
            if not 0 <= type_.length <= limit:
                message = f"{type_.name}[{type_.length}]: the length must be 0 to {limit}"
                self.report("PG806", message, member.span)
                return _NOTHING
            wide = type_.name.upper() == "WSTRING"
            bits = 8 * (2 * type_.length + 4 if wide else type_.length + 2)
            return Shape(type_, bits, 16, bits, 16, doubts=_WIDE if wide else NO_DOUBTS)
        if self._depth >= MAX_DEPTH:
            self.report("PG808", f"{member.name}: nested more than {MAX_DEPTH} levels deep", member.span)
            return _NOTHING
        self._depth += 1
        try:
            if isinstance(type_, ArrayType):
                return self._array(type_, member)
            if isinstance(type_, StructType):
                self.check_names(type_.members)
                return self.struct(type_, ((SectionKind.STATIC, type_.members),))
            return self._name(type_, member)
        finally:
            self._depth -= 1

    def _array(self, type_: ArrayType, member: Member) -> Shape:
        if not type_.bounds:
            message = f"{member.name}: {OPEN_ARRAY}"
            help_text = "write the bounds; parameters of a function and in-outs of a function block may leave them open"
            self.report("PG806", message, member.span, help_text)
            return _NOTHING
        lengths = [high - low + 1 for low, high in type_.bounds]
        if min(lengths) < 1:
            shown = ", ".join(f"{low}..{high}" for low, high in type_.bounds)
            self.report("PG806", f"{member.name}: ARRAY[{shown}] has no element", member.span)
            return _NOTHING
        element = self.shape(type_.element, member)
        if element.bits == 1:
            stride, inner = 1, lengths[-1] if len(lengths) == 1 else _up(lengths[-1], 8)
        else:
            stride = _up(element.bits, 8 if element.bits == 8 else 16)
            inner = stride * lengths[-1]
        strides = [stride]
        row = inner
        for length in reversed(lengths[:-1]):
            strides.insert(0, row)
            row *= length
        doubts = element.doubts
        if stride != element.bits and math.prod(lengths) > 1:
            doubts |= {STRING_STRIDE}
        if element.used != element.bits and math.prod(lengths) > 1:
            doubts |= {ARRAY_END}
        if math.prod(lengths[:-1]) > 1 and inner != stride * lengths[-1]:
            doubts |= {BIT_ROWS}
        return Shape(
            type_,
            _up(row, 16),
            16,
            _up(row, 8),
            element.first_align,
            has_struct=element.has_struct,
            doubts=doubts,
            depth=element.depth + 1,
            element=element,
            strides=tuple(strides),
            stride_doubts=doubts,
            spare=_up(row, 8) - row if element.bits == 1 else 0,
        )

    def _name(self, type_: NamedType, member: Member) -> Shape:
        key = type_.name.upper()
        if key in self._named:
            return self._named[key]
        if key in self._open:
            chain = " > ".join([*self._open[self._open.index(key) :], key])
            self.report("PG807", f"{type_.name} contains itself: {chain}", member.span)
            return _NOTHING
        if not type_.quoted and key not in self._types:
            plain = elementary(type_.name)
            if plain is not None:
                return _ELEMENTARY[plain.name]
            if key in NO_MEMORY:
                return Shape(type_, 0, 1, 0, 1, doubts=frozenset({key}))
        block = self.find(type_.name, quoted=type_.quoted)
        if block is None or block.kind not in (BlockKind.UDT, BlockKind.FB):
            self.unknown(type_.name, member.span, block)
            return _NOTHING
        self._open.append(key)
        self.check_names(block.members)
        groups = [(kind, block.section(kind)) for kind in INSTANCE_SECTIONS]
        shape = self.struct(type_, groups, doubts=_doubts(block))
        self._open.pop()
        self._named[key] = shape
        return shape

    def unknown(self, name: str, span: Span | None, block: Block | None = None) -> None:
        """Report a name that is no type; the same words for every use, so that uses can be put together."""
        if block is not None:
            self.report("PG806", f"{name} is {block.kind.value}, not a data type", span)
        elif _SYSTEM.fullmatch(name):
            help_text = "declare a UDT of this name with the same members, for example from its instance DB"
            self.report("PG806", f"the members of {name} are not known to plcgen", span, help_text)
        elif name.startswith("REF_TO "):
            self.report("PG806", f"{name}: references exist in blocks with optimized access only", span)
        else:
            help_text = (
                self._types.near(name) or "also name the file that declares it; several files and folders can be given"
            )
            self.report("PG806", f"unknown data type {name}", span, help_text)

    def check_names(self, members: Sequence[Member]) -> None:
        """Report members that share a name in one scope; letter case does not tell names apart."""
        if len({member.name.upper() for member in members}) == len(members):
            return
        seen: dict[str, Member] = {}
        for member in members:
            first = seen.setdefault(member.name.upper(), member)
            if first is not member:
                self.diagnostics.append(declared_twice(member, first, self._owner))


def declared_twice(member: Member, first: Member, owner: Span) -> Diagnostic:
    """PG805 for two members with one name, with both places."""
    notes = (Note("first declared here", first.span),) if first.span else ()
    text = "S7 names do not tell upper case from lower case: give one of them another name"
    return Diagnostic("PG805", f'"{member.name}" is declared twice', member.span or owner, help=text, notes=notes)


def near_type(name: str, known: Iterable[str]) -> str:
    """``did you mean "x"?`` for a name that is no type, or an empty string: one number says nothing about another."""
    return "" if _NUMBERED.fullmatch(name) else did_you_mean(name, known)


def union(one: frozenset[str], other: frozenset[str]) -> frozenset[str]:
    """Union of both; thousands of members share the set that holds the other one already."""
    return one if other <= one else other if one <= other else one | other


def _up(value: int, step: int) -> int:
    return -(-value // step) * step


def _elementary_shape(type_: Elementary) -> Shape:
    align = 1 if type_.bits == 1 else 8 if type_.bits == 8 else 16
    doubts = frozenset({type_.name}) if type_.name in SIZES else NO_DOUBTS
    return Shape(type_, type_.bits, align, type_.bits, align, doubts=doubts)


def _with_parts(name: str, parts: Mapping[str, str]) -> Shape:
    """Shape of an elementary type whose parts have names: they are no fields, a layout shows it as one value."""
    shape, index, offset = _elementary_shape(ELEMENTARY[name]), {}, 0
    for part, type_ in parts.items():
        index[part] = Field(Member(part, ELEMENTARY[type_]), offset, _ELEMENTARY[type_], shape.doubts)
        offset += ELEMENTARY[type_].bits
    return replace(shape, index=index)


def bare_shape(name: str) -> Shape:
    """Shape of an elementary type that lies nowhere yet."""
    return _ELEMENTARY[name]


def _doubts(block: Block) -> frozenset[str]:
    return frozenset({block.name.upper()}) if is_literature(block) else NO_DOUBTS


_WIDE = frozenset({"WSTRING"})
_ELEMENTARY = {name: _elementary_shape(type_) for name, type_ in ELEMENTARY.items()}
_ELEMENTARY["DTL"] = _with_parts("DTL", {
    "YEAR": "UINT", "MONTH": "USINT", "DAY": "USINT", "WEEKDAY": "USINT", "HOUR": "USINT", "MINUTE": "USINT",
    "SECOND": "USINT", "NANOSECOND": "UDINT",
})  # fmt: skip
_NOTHING = Shape(StructType(()), 0, 1, 0, 1)
