"""Access through the number of a data block: ``db.DW[i]``, ``#db.%DBW0``, ``WORD_TO_BLOCK_DB(w).DB(i)``."""

from __future__ import annotations

import re
from dataclasses import dataclass

from plcgen.s7.cpu.compiler.context import Context
from plcgen.s7.cpu.compiler.conversions import integer_code
from plcgen.s7.cpu.compiler.expressions import Expressions
from plcgen.s7.cpu.compiler.scope import scalar_name
from plcgen.s7.cpu.compiler.values import UNKNOWN, MemoryPlace
from plcgen.s7.cpu.type_rules import BITS, INT_CONST, INTEGERS, NUMBERED
from plcgen.s7.layout.shapes import bare_shape
from plcgen.s7.scl import ast

WIDTHS = {"X": "BOOL", "B": "BYTE", "W": "WORD", "D": "DWORD"}
_OPENED = re.compile(r"(?:DB|D)([XBWD])([0-9]{1,5})?(?:\.([0-7]))?", re.IGNORECASE)
_LAST = 65535


@dataclass(slots=True, eq=False)
class OpenedBlocks:
    """Absolute access to a data block whose number is known when the code runs.

    Sources: S7-SCL V5.3 manual, "Indexed access to data blocks"; help of the TIA Portal, "Indirect addressing of data
    blocks" (S7-300/400).
    """

    context: Context
    expressions: Expressions

    def is_number(self, node: ast.Expression) -> bool:
        """Whether an expression is the number of a data block: a parameter or variable, or WORD_TO_BLOCK_DB."""
        if isinstance(node, ast.Call):
            target = node.target
            return isinstance(target, ast.Name) and target.name.upper() == "WORD_TO_BLOCK_DB"
        if not isinstance(node, ast.Name) or node.scope == "quoted":
            return False
        symbol = self.context.scope.symbols.get(node.name.upper())
        return symbol is not None and symbol.place is not None and scalar_name(symbol.place.shape) in NUMBERED

    def place(self, node: ast.Expression) -> MemoryPlace | None:
        """Place of such an access; None if the expression is none."""
        target: ast.Expression = node
        indices: tuple[ast.Expression, ...] = ()
        bit = ""
        if isinstance(node, ast.Index):
            target, indices = node.base, node.indices
        elif isinstance(node, ast.Call):
            target, indices = node.target, tuple(argument.value for argument in node.arguments)
        elif isinstance(node, ast.Member) and isinstance(node.base, ast.Member) and node.name.isdecimal():
            target, bit = node.base, f".{node.name}"
        if not isinstance(target, ast.Member) or not self.is_number(target.base):
            return None
        match = _OPENED.fullmatch(target.name + bit)
        if match is None or (match[2] is None) != bool(indices):
            return None
        return self.at(target.base, match, indices)

    def at(self, base: ast.Expression, match: re.Match[str], indices: tuple[ast.Expression, ...]) -> MemoryPlace:
        """Place in the block that ``base`` numbers, at fixed or computed addresses."""
        shape = bare_shape(WIDTHS[match[1].upper()])
        memory = f"opened({self.expressions.value(base).wrapped})"
        if match[2] is not None:
            return MemoryPlace(shape, memory, int(match[2]) * 8 + int(match[3] or 0))
        codes = [self.address(index) for index in indices]
        if match[1] not in "Xx":
            return MemoryPlace(shape, memory, 0, f"ck({codes[0]},{_LAST})")
        bit = codes[1] if len(codes) > 1 else "0"
        return MemoryPlace(shape, memory, 0, dynbit=f"ck({codes[0]},{_LAST})*8+ck({bit},7)")

    def address(self, node: ast.Expression) -> str:
        """Code of a computed address."""
        value = self.expressions.value(node)
        if value.type not in INTEGERS and value.type not in {INT_CONST, UNKNOWN, *BITS}:
            self.context.error("PG821", "an address index is an integer", node)
        return integer_code(value)
