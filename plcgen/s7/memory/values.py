"""What it takes to load a value and to call a block: operands, constants, operators, conversions, parameters."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from plcgen.s7.memory import costs
from plcgen.s7.memory.names import BlockNames, CodeOperand, OperandArea
from plcgen.s7.scl import ast
from plcgen.s7.types.blocks import Block, BlockKind, SectionKind
from plcgen.s7.types.data_types import DataType, StringType

_WORD_PARAMETER = 16
_BY_ANY = frozenset({"SFC14", "SFC15", "SFC20", "SFC21", "BLKMOV", "FILL", "DPRD_DAT", "DPWR_DAT", "UBLKMOV", "SFC81"})
"""Functions whose parameters are of type ANY; of other functions the interface says so."""


@dataclass(frozen=True, slots=True)
class CallCost:
    """Calls of one block; ``load`` gives the bytes of a value (for a width), ``access`` those of a place."""

    names: BlockNames
    load: Callable[..., int]
    access: Callable[[CodeOperand], int]

    def function(self, node: ast.Call) -> tuple[int, int]:
        """Bytes of a call of an FC or SFC without taking its result, and the bits of that result."""
        name = _name(node.target)
        block = self.names.find(name) if name else None
        size = costs.CALL + costs.POINTER + (costs.SAVE_REGISTERS if self.names.has_instance else 0)
        for argument in node.arguments:
            if isinstance(argument.value, ast.Omitted):
                continue
            declared = _parameter_of(block, argument.name)[1]
            size += costs.POINTER + self._argument(argument.value, declared, by_any=name in _BY_ANY)
        returned = block.section(SectionKind.RETURN) if block is not None else ()
        width = self.names.width(returned[0].type) if returned else _WORD_PARAMETER
        return size, 32 if width is None or name == "SFC64" else width

    def _argument(self, node: ast.Expression, declared: DataType | None, *, by_any: bool) -> int:
        """Bytes that make an argument of a function ready: its address is handed over."""
        if isinstance(node, ast.Literal) and node.kind == "pointer":
            return costs.ANY
        place = self.names.place(node)
        if (
            place is not None
            and not place.indices
            and place.area is OperandArea.TEMP
            and (self.names.is_elementary(place.type) or self.names.name(place.type) == "ANY")
        ):
            return 0
        if by_any or self.names.name(declared) == "ANY":
            return costs.ANY
        if place is not None and not self.names.is_elementary(place.type):
            return costs.STRUCTURE
        return self.load(node, self.names.width(declared)) + costs.ACCESS

    def block(self, node: ast.Call) -> int | None:
        """Bytes of a call of an FB by its instance; None if what is called is no FB."""
        found = self._instance(node.target)
        if found is None:
            return None
        block, own = found
        size = costs.MULTI_INSTANCE_CALL if own else costs.INSTANCE_CALL
        for argument in node.arguments:
            if not isinstance(argument.value, ast.Omitted):
                size += self._parameter(argument, block, own=own)
        return size

    def _instance(self, target: ast.Expression) -> tuple[Block | None, bool] | None:
        """The FB behind an instance and whether it lies in the caller's own data; None if it is no instance."""
        if isinstance(target, ast.Member):
            base = _name(target.base)
            block = self.names.find(base, quoted=True) if base else None
            if block is not None and block.kind is BlockKind.FB and self._of_block(target.base):
                return block, False
        place = self.names.place(target)
        if place is None or place.area in {OperandArea.FAR, OperandArea.NEAR}:
            return None
        type_ = place.type
        name = getattr(type_, "name", "")
        block = self.names.blocks.get(name.upper()) if place.area is OperandArea.DB else None
        if block is not None and block.instance_of:
            return self.names.find(block.instance_of, quoted=True), False
        block = self.names.find(name, quoted=True) if name else None
        if place.area is OperandArea.DB or (block is not None and block.kind is BlockKind.FB):
            return block, place.area is not OperandArea.DB
        return None

    def _of_block(self, node: ast.Expression) -> bool:
        """Whether a name stands for a block, not for a variable."""
        return isinstance(node, ast.Name) and (node.scope == "quoted" or node.name.upper() not in self.names.variables)

    def _parameter(self, argument: ast.Argument, block: Block | None, *, own: bool) -> int:
        kind, declared = _parameter_of(block, argument.name)
        place = self.names.place(argument.value)
        if argument.operator == "=>":
            return costs.ACCESS + (self.access(place) if place is not None else costs.ACCESS)
        if self.names.name(declared) == "ANY" or getattr(declared, "name", "").upper() == "VARIANT":
            return costs.ANY
        structured = not self.names.is_elementary(declared)
        if kind is SectionKind.IN_OUT:
            return costs.STRUCTURE if structured else self.load(argument.value) + costs.IN_OUT
        if structured:
            return costs.STRUCTURE if isinstance(declared, StringType) else costs.COPY
        foreign = not own and place is not None and place.area is OperandArea.STATIC
        size = self.load(argument.value, self.names.width(declared)) + costs.ACCESS
        return size + (costs.FROM_OTHER_INSTANCE if foreign else 0)


def _name(node: ast.Expression) -> str:
    return node.name.upper() if isinstance(node, ast.Name) else ""


def _parameter_of(block: Block | None, name: str | None) -> tuple[SectionKind | None, DataType | None]:
    if block is None or name is None:
        return None, None
    wanted = name.upper()
    for section in block.sections:
        for member in section.members:
            if member.name.upper() == wanted:
                return section.kind, member.type
    return None, None


COMPARISONS = frozenset({"=", "<>", "<", ">", "<=", ">="})
_LOGIC = frozenset({"AND", "&", "OR", "XOR"})
_BIT, _BYTE, _WORD, _DOUBLE = 1, 8, 16, 32
_WIDTHS = {
    "BOOL": _BIT, "BYTE": _BYTE, "CHAR": _BYTE, "SINT": _BYTE, "USINT": _BYTE, "WORD": _WORD, "INT": _WORD,
    "UINT": _WORD, "DATE": _WORD, "S5TIME": _WORD, "BLOCK_DB": _WORD, "DWORD": _DOUBLE, "DINT": _DOUBLE,
    "UDINT": _DOUBLE, "REAL": _DOUBLE, "TIME": _DOUBLE, "TOD": _DOUBLE,
}  # fmt: skip
_CONVERSION = re.compile(rf"({'|'.join(_WIDTHS)})_TO_({'|'.join(_WIDTHS)})\Z")
_ONE_INSTRUCTION = frozenset(
    {
        "ABS",
        "SQR",
        "SQRT",
        "EXP",
        "LN",
        "SIN",
        "COS",
        "TAN",
        "ASIN",
        "ACOS",
        "ATAN",
        "TRUNC",
        "ROUND",
        "INT_TO_BCD",
        "BCD_TO_INT",
        "DINT_TO_BCD",
        "BCD_TO_DINT",
    }
)
_SHIFTS = frozenset({"SHL", "SHR", "ROL", "ROR"})
_CHOICES = frozenset({"MIN", "MAX", "LIMIT", "SEL", "MUX"})
_INTEGERS = frozenset({"INT", "DINT", "UINT", "UDINT", "SINT", "USINT"})
_TYPED = {
    "B": _BYTE, "BYTE": _BYTE, "C": _BYTE, "CHAR": _BYTE, "SINT": _BYTE, "USINT": _BYTE, "W": _WORD, "WORD": _WORD,
    "INT": _WORD, "UINT": _WORD, "S5T": _WORD, "S5TIME": _WORD, "D": _WORD, "DATE": _WORD, "BOOL": _BIT,
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class LoadedValue:
    """A value on its way into the accumulator: bytes of code, width in bits, name of its type if it is known.

    ``plain`` is a single load; ``bit`` a BOOL that is still a variable, ``literal`` a number without a type of its own.
    """

    size: int
    width: int
    type: str = ""
    plain: bool = False
    bit: bool = False
    literal: bool = False


class ValueSize:
    """Code for the values of one block; ``opened`` is the data block that the statement has opened."""

    def __init__(self, names: BlockNames) -> None:
        self.names = names
        self.opened = ""

    # --- operands --------------------------------------------------------------------------------------------

    def access(self, place: CodeOperand) -> int:
        """Bytes to load or store an elementary operand, its data block and its indices included."""
        size = costs.NEAR if place.area is OperandArea.NEAR else costs.ACCESS
        if place.area is OperandArea.POINTED:
            size = costs.POINTED_IN_FB if self.names.has_instance else costs.POINTED_IN_FC
        elif place.area is OperandArea.DB and place.db != self.opened:
            self.opened = place.db
            near = place.number is not None and place.number < costs.NEAR_DB
            size += costs.OPEN_NEAR if near else costs.OPEN
        return size + self._indexing(place)

    def _indexing(self, place: CodeOperand) -> int:
        if not place.indices:
            return 0
        size = costs.TO_REGISTER
        size += costs.IN_INSTANCE if place.area is OperandArea.STATIC else 0
        size += costs.OFFSET if place.offset else 0
        for number, (index, low) in enumerate(zip(place.indices, place.lows, strict=True)):
            value = self.load(index)
            size += value.size + costs.SCALE
            size += costs.WIDEN_INDEX if value.width == _WORD else 0
            size += costs.LOW_BOUND if low else 0
            size += costs.NEXT_INDEX if number else 0
        return size

    def by_number(self, node: ast.Index) -> LoadedValue | None:
        """``db.DW[i]``: an operand of a data block whose number is a value; None if it is something else."""
        if not isinstance(node.base, ast.Member) or node.base.name.upper() not in _NUMBERED_WIDTHS:
            return None
        base = node.base.base
        place = self.names.place(base)
        known = place is not None and place.area in {OperandArea.TEMP, OperandArea.STATIC, OperandArea.PARAMETER}
        if not (isinstance(base, ast.Call) or (known and place is not None and self.names.is_elementary(place.type))):
            return None
        size = self.load(base).size + sum(self.load(index).size for index in node.indices) + costs.BY_DB_NUMBER
        return LoadedValue(size, _NUMBERED_WIDTHS[node.base.name.upper()])

    # --- values ----------------------------------------------------------------------------------------------

    def load(self, node: ast.Expression) -> LoadedValue:
        """Code that brings a value into the accumulator, a BOOL into the result of logic operation."""
        constant = self.names.constant(node)
        if constant is not None:
            return self._constant(constant)
        if isinstance(node, ast.Binary):
            chain = [node]
            while isinstance(chain[-1].left, ast.Binary):
                chain.append(chain[-1].left)
            value = self.load(chain[-1].left)
            for joined in reversed(chain):  # a long sum is as deep as it is long
                value = self._joined(joined, value)
            return value
        if isinstance(node, ast.Unary):
            value = self.load(node.operand)
            if node.operator == "+":
                return value
            first = costs.FIRST_BIT if value.bit else 0
            return LoadedValue(value.size + first + costs.OPERATION, value.width, value.type)
        if isinstance(node, ast.Call):
            return self._call(node)
        if isinstance(node, ast.Index) and (found := self.by_number(node)) is not None:
            return found
        place = self.names.place(node)
        if place is None:
            return LoadedValue(costs.ACCESS, _WORD, plain=True)
        width = self.names.width(place.type)
        plain = not place.indices and place.area is not OperandArea.POINTED
        return LoadedValue(
            self.access(place),
            _DOUBLE if width is None else width,
            self.names.name(place.type),
            plain,
            bit=width == _BIT,
        )

    def condition(self, node: ast.Expression) -> int:
        """Bytes of a BOOL that is asked for: a variable needs the chain of bits to begin anew."""
        value = self.load(node)
        return value.size + (costs.FIRST_BIT if value.bit else 0)

    def _constant(self, node: ast.Expression) -> LoadedValue:
        while not isinstance(node, ast.Literal):
            following = node.operand if isinstance(node, ast.Unary) else self.names.constant(node)
            if following is None or following is node:
                return LoadedValue(costs.CONSTANTS[_WORD], _WORD, plain=True, literal=True)
            node = following
        width, literal = literal_width(node)
        return LoadedValue(
            costs.CONSTANTS[width], width, plain=True, literal=literal, type="REAL" if node.kind == "real" else ""
        )

    def _joined(self, node: ast.Binary, left: LoadedValue) -> LoadedValue:
        right = self.load(node.right)
        if node.operator in _LOGIC and left.width == _BIT:
            size = left.size + (costs.FIRST_BIT if left.bit else 0) + right.size
            if node.operator in {"AND", "&"} and self._negated_bit(node.right):
                size -= costs.FIRST_BIT + costs.OPERATION  # AN: the negation is part of the instruction
            elif not (right.bit and node.operator in {"AND", "&"}):
                size += costs.TERM
            return LoadedValue(size, _BIT, "BOOL")
        if left.literal != right.literal:
            left, right = _fitted(left, right.width), _fitted(right, left.width)
        size = left.size + right.size + costs.OPERATION + _mixed(left, right)
        if not right.plain:
            size += costs.SWAP if left.plain else costs.SPILL
        if node.operator in COMPARISONS:
            return LoadedValue(size, _BIT, "BOOL")
        wider = max(left, right, key=lambda value: (value.type == "REAL", value.width))
        return LoadedValue(size, wider.width, wider.type)

    def _negated_bit(self, node: ast.Expression) -> bool:
        """Whether a term is NOT before a plain variable."""
        operand = self.names.place(node.operand) if isinstance(node, ast.Unary) and node.operator == "NOT" else None
        return operand is not None and self.names.width(operand.type) == _BIT

    # --- functions -------------------------------------------------------------------------------------------

    def _call(self, node: ast.Call) -> LoadedValue:
        name = node.target.name.upper() if isinstance(node.target, ast.Name) else ""
        arguments = [argument.value for argument in node.arguments]
        if arguments and (conversion := _CONVERSION.match(name)):
            return self._converted(arguments[0], conversion[1], conversion[2])
        if arguments and name in _ONE_INSTRUCTION:
            value = self.load(arguments[0])
            return LoadedValue(
                value.size + costs.OPERATION, value.width, "DINT" if name in {"TRUNC", "ROUND"} else value.type
            )
        if len(arguments) > 1 and name in _SHIFTS:
            value, count = self.load(arguments[0]), self.load(arguments[1])
            moving = self.names.constant(arguments[1]) is None
            size = count.size + costs.SHIFT_BY_VARIABLE if moving else costs.OPERATION
            return LoadedValue(value.size + size, value.width, value.type)
        if len(arguments) > 1 and name in _CHOICES:
            values = [self.load(argument) for argument in arguments]
            return LoadedValue(sum(value.size for value in values) + costs.CHOICE * (len(values) - 1), values[-1].width)
        size, width = CallCost(self.names, self.load_size, self.access).function(node)
        return LoadedValue(size + costs.ACCESS, width)

    def load_size(self, node: ast.Expression, width: int | None = None) -> int:
        """Bytes to load a value; ``width`` is what a constant is loaded for."""
        value = self.load(node)
        if width is not None:
            value = _fitted(value, width)
        return value.size + (costs.FIRST_BIT if value.bit else 0)

    def _converted(self, node: ast.Expression, source: str, target: str) -> LoadedValue:
        value = self.load(node)
        old, new = _WIDTHS[source], _WIDTHS[target]
        return LoadedValue(
            value.size + _conversion(source, target, old, new) + (costs.FIRST_BIT if value.bit else 0), new, target
        )


_NUMBERED_WIDTHS = {"DX": _BIT, "DB": _BYTE, "DW": _WORD, "DD": _DOUBLE}


def literal_width(node: ast.Literal) -> tuple[int, bool]:
    """Bits of a literal, and whether they depend on what it is used with."""
    if node.kind == "bool":
        return _BIT, False
    if node.kind == "real":
        return _DOUBLE, False
    if node.kind == "int":
        return _WORD, True
    if node.kind == "typed":
        return _TYPED.get(node.text.split("#")[0].upper(), _DOUBLE), False
    return (_BYTE, False) if node.kind == "string" and len(node.text) == 3 else (_DOUBLE, False)


def _fitted(value: LoadedValue, width: int) -> LoadedValue:
    """A constant in the width of the other operand."""
    if not value.literal or width not in costs.CONSTANTS or width <= value.width:
        return value
    return LoadedValue(costs.CONSTANTS[width], width, value.type, plain=True)


def _mixed(left: LoadedValue, right: LoadedValue) -> int:
    """Converting the narrower operand of two types."""
    one, other = sorted((left, right), key=lambda value: (value.type == "REAL", value.width))
    if other.type == "REAL" and one.type in _INTEGERS:
        return costs.TO_REAL if one.width == _WORD else costs.OPERATION
    return costs.OPERATION if (one.width, other.width) == (_WORD, _DOUBLE) else 0


def _conversion(source: str, target: str, old: int, new: int) -> int:
    if _BIT in {old, new}:
        return 0 if old == new else costs.BIT_CONVERSION
    if target == "REAL":
        return {_WORD: costs.TO_REAL, _BYTE: costs.TO_REAL}.get(old, costs.OPERATION if source in _INTEGERS else 0)
    if source == "REAL":
        return costs.OPERATION if target in _INTEGERS else 0
    if (source, target) == ("INT", "DINT"):
        return costs.OPERATION
    if old == new:
        return 0
    return costs.NARROW_DOUBLE if (old, new) == (_DOUBLE, _WORD) else costs.NARROW
