"""Blocks before and after compilation, and what one may refer to: other blocks, tags, numbers, counters of coverage."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import CodeType

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.s7.cpu.kinds import Kind, kind_of
from plcgen.s7.cpu.type_rules import IecCheck, TypeRules
from plcgen.s7.layout.shapes import Shape
from plcgen.s7.scl import ast
from plcgen.s7.scl.constants import integer
from plcgen.s7.scl.declarations import UnknownNames
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.logic import Logic, deciding, outcome
from plcgen.s7.scl.parser import ParseResult, parse
from plcgen.s7.types.address import Address, AddressError, parse_address
from plcgen.s7.types.blocks import OF_BLOCKS, Block, BlockKind, is_optimized
from plcgen.s7.types.data_types import NamedType


@dataclass(frozen=True, slots=True)
class Decision:
    """A condition: how its operands are joined, and the counters of each for deciding with TRUE and with FALSE."""

    logic: Logic
    counters: tuple[tuple[int, int], ...]


class Table(dict[tuple[bool | None, ...], bool]):
    """Outcomes of a condition by the values that its operands had, negated; None was not looked at.

    The generated code looks the outcome up. What is not there yet is worked out, and counted for those that decide.
    """

    def __init__(self, decision: Decision, counts: list[int]) -> None:
        super().__init__()
        self.decision, self.counts = decision, counts

    def __missing__(self, negated: tuple[bool | None, ...]) -> bool:
        values = [None if value is None else not value for value in negated]
        for number in deciding(self.decision.logic, values):
            true, false = self.decision.counters[number]
            self.counts[true if values[number] else false] += 1
        found = bool(outcome(self.decision.logic, values))
        self[negated] = found
        return found


_NUMBERED = re.compile(r"(?:DB|FB|FC|OB|SFB|SFC|UDT)[0-9]{1,5}", re.ASCII)
_CELL = re.compile(r"[TCZ][0-9]{1,5}", re.ASCII)
ENO = re.compile(r"\b(?:ENO|OK)\b", re.IGNORECASE)
"""A word for the enable output of a block."""


@dataclass(slots=True)
class ProgramBlock:
    """A block of the program: the tree, the declarations, where it lies in the generated code.

    ``unit`` has the places of the block in its text, and its tree until that is released.
    """

    index: int
    unit: ast.Unit
    block: Block
    result: ParseResult
    shape: Shape | None = None
    number: int | None = None
    released: bool = False

    @property
    def name(self) -> str:
        """Name as declared."""
        return self.block.name

    @property
    def words(self) -> list[str]:
        """Its text without blanks and line ends."""
        return self.result.tokens.source[self.unit.start : self.unit.end].split()

    @property
    def skipped(self) -> bool:
        """Whether it has code that was not read, as that of a statement list."""
        return self.unit.code[0] < 0 and self.block.kind in {BlockKind.FB, BlockKind.FC, BlockKind.OB}

    @property
    def tree(self) -> ast.Unit:
        """The whole tree; one that was released is made again."""
        if not self.released:
            return self.unit
        text, unit = self.result.tokens.source, self.unit
        return parse(" " * unit.start + text[unit.start : unit.end], self.result.tokens.file).units[0]

    def release(self) -> None:
        """Keep the text alone, a tenth of the memory."""
        self.unit = replace(self.unit, sections=(), body_type=None, statements=())
        self.released = True


@dataclass(frozen=True, slots=True)
class Probe:
    """One thing coverage counts in a block: a statement, the outcome of a branch, or an operand that decides."""

    file: str
    line: int
    column: int
    kind: str
    block: str

    @property
    def source(self) -> str:
        """Its block and the file of it: a file may have several."""
        return f"{self.file} {self.block}"


@dataclass(slots=True)
class Compiled:
    """A block as Python code; ``lines`` maps a line of ``source`` to the line of the SCL file.

    ``counters`` are those of its coverage.

    ``calls`` are the blocks it calls, ``moving`` those of them that are multi-instances, by upper-case name.
    """

    name: str
    function: str
    source: str
    lines: list[int]
    file: str
    code: CodeType | None = None
    diagnostics: list[Diagnostic] = field(default_factory=list)
    calls: dict[str, Span] = field(default_factory=dict)
    moving: frozenset[str] = frozenset()
    counters: range = range(0)


@dataclass(slots=True)
class Linkage:
    """Names of a program; keys are upper case.

    ``constants`` are system constants of the project, hardware identifiers by name; ``literals`` has those and the
    ``user_constants`` as they are written, ``numbers`` the whole numbers among them.
    ``mixed``: blocks with standard and with optimised access meet. ``eno``: some block speaks of ENO or OK. ``litter``:
    local data holds garbage at the start of a call, of two kinds in turn. ``probes`` and ``decisions`` grow while
    blocks are compiled for coverage; ``counted_by`` has for each probe the number of the one that counts for it, the
    first of those that run equally often unless a fault ends the scan. ``points`` grow while blocks are compiled for
    preemption.

    ``stated`` says of single blocks whether their IEC check is on, ``iec_check`` of all others; ``foreign`` are those
    that plcgen did not generate.
    ``opaque`` are the types that nobody declares: they are reported once, and nothing is said about what they hold.
    ``unknown`` are the names that were reported as unknown; ``guessed_bounds`` says that an array has a
    bound whose value stands elsewhere: then one of a single element may have more.
    """

    dialect: Dialect
    blocks: dict[str, ProgramBlock] = field(default_factory=dict)
    types: dict[str, Block] = field(default_factory=dict)
    tags: dict[str, tuple[Address, str]] = field(default_factory=dict)
    constants: dict[str, int] = field(default_factory=dict)
    aliases: dict[str, str] = field(default_factory=dict)
    addresses: dict[str, str] = field(default_factory=dict)
    instance_regions: set[str] = field(default_factory=set)
    mixed: bool = False
    eno: bool = False
    coverage: bool = False
    litter: bool = False
    probes: list[Probe] = field(default_factory=list)
    counted_by: list[int] = field(default_factory=list)
    decisions: list[Decision] = field(default_factory=list)
    points: list[Probe] = field(default_factory=list)
    iec_check: IecCheck = IecCheck.AS_STATED
    foreign: set[str] = field(default_factory=set)
    stated: dict[str, bool] = field(default_factory=dict)
    user_constants: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    literals: dict[str, str] = field(default_factory=dict)
    numbers: dict[str, int] = field(default_factory=dict)
    opaque: set[str] = field(default_factory=set)
    unknown: UnknownNames = field(default_factory=UnknownNames)
    guessed_bounds: bool = False
    cells: dict[str, int] = field(default_factory=dict)
    """Tags of S5 timers and counters, and their numbers."""
    kinds: dict[Kind, int] = field(default_factory=dict)
    """Kinds of variables that are handed over as VARIANT or ``ARRAY[*]``, with their numbers in generated code."""

    shown: dict[int, tuple[Shape, int]] = field(default_factory=dict)
    """Shapes whose kind has a number already, by their identity: a large one may be handed over a thousand times."""

    def kind(self, shape: Shape) -> int:
        """Number of the kind of a variable."""
        known = self.shown.get(id(shape))
        if known is None:
            known = self.shown[id(shape)] = shape, self.number(kind_of(shape))
        return known[1]

    def number(self, kind: Kind) -> int:
        """Number of a kind in generated code."""
        return self.kinds.setdefault(kind, len(self.kinds))

    def add_constants(self, constants: Mapping[str, int], user_constants: Mapping[str, tuple[str, str]]) -> None:
        """Take over the constants of the project."""
        self.constants = {name.upper(): number for name, number in constants.items()}
        self.user_constants = user_constants
        self.literals = {name: literal for name, (_, literal) in user_constants.items()}
        self.literals |= {name: str(number) for name, number in self.constants.items()}
        found = {name: integer(literal) for name, literal in self.literals.items()}
        self.numbers = {name: number for name, number in found.items() if number is not None}

    @property
    def classic(self) -> bool:
        """Whether the target is an S7-300/400."""
        return self.dialect.classic

    def rules(self, block: str) -> TypeRules:
        """What a block may mix."""
        stated = self.stated.get(block.upper())
        if stated is None and self.iec_check is IecCheck.AS_STATED and block.upper() in self.foreign:
            stated = OF_BLOCKS["ISIECCHECKENABLED"] == "TRUE"
        return TypeRules.of(self.dialect, self.iec_check, stated=stated)

    def unstated(self) -> list[ProgramBlock]:
        """Blocks with code that others wrote and of whose IEC check nothing is said, where there is one."""
        if self.iec_check is not IecCheck.AS_STATED or self.dialect is not Dialect.TIA_1200_1500:
            return []
        code = (BlockKind.FB, BlockKind.FC, BlockKind.OB)
        blocks = (self.blocks[name] for name in self.blocks if name in self.foreign and name not in self.stated)
        return [entry for entry in blocks if entry.block.kind in code]

    def is_opaque(self, shape: Shape) -> bool:
        """Whether nobody knows what a variable of this shape holds."""
        return isinstance(shape.type, NamedType) and shape.type.name.upper() in self.opaque

    def find(self, name: str) -> ProgramBlock | None:
        """Return a block by its name or by its number, such as DB3."""
        upper = name.upper().lstrip("%")
        known = self.blocks
        return known.get(upper) or known.get(self.aliases.get(upper, "")) or known.get(self.addresses.get(upper, ""))

    def ob_number(self, block: ProgramBlock) -> int:
        """Number of an organization block, from its name, its symbol, or what Main and Startup are; else 0."""
        name = block.name.upper()
        known = [alias for alias, found in self.aliases.items() if found == name and alias.startswith("OB")]
        text = next(iter(known), {"MAIN": "OB1", "STARTUP": "OB100"}.get(name, name))
        return block.number or (int(text[2:]) if text.startswith("OB") and text[2:].isdecimal() else 0)

    def data_block(self, number: int) -> ProgramBlock | None:
        """Return the data block with a number."""
        return self.find(f"DB{number}")

    def instance_type(self, block: ProgramBlock) -> str:
        """Name of the FB or system block that a data block is an instance of; empty for a global one."""
        name = block.block.instance_of or ""
        found = self.find(name)
        if found is not None:
            return found.name.upper() if found.block.kind is BlockKind.FB else ""
        declared = self.types.get(name.upper())
        return "" if declared is not None and declared.kind is BlockKind.UDT else name.upper()

    def optimized(self, block: ProgramBlock) -> bool:
        """Whether a block has optimised access; an instance data block has that of its FB."""
        of = self.blocks.get(self.instance_type(block)) if block.block.kind is BlockKind.DB else None
        return is_optimized((of or block).block, {}, classic=self.classic)

    def add_tags(self, tags: Mapping[str, str | tuple[str, str]]) -> list[str]:
        """Take tags over; return the names whose address makes no sense."""
        wrong: list[str] = []
        for name, target in tags.items():
            text, type_ = (target, "") if isinstance(target, str) else target
            upper = text.strip().lstrip("%").replace(" ", "").upper()
            if _CELL.fullmatch(upper):
                self.cells[name.upper()] = int(upper[1:])
                continue
            if _NUMBERED.fullmatch(upper):
                self.aliases[upper] = name.upper()
                self.addresses[name.upper()] = upper
                continue
            try:
                address = parse_address(upper)
            except AddressError:
                wrong.append(name)
                continue
            self.tags[name.upper()] = (address, type_.upper() or address.type_name or "BYTE")
        return wrong
