"""Operands - names, constants, slices, paths - and operators, each with its S7 type."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from plcgen.base.diagnostics import Severity
from plcgen.s7.cpu.arithmetic import mod, quotient
from plcgen.s7.cpu.compiler.access import Access
from plcgen.s7.cpu.compiler.arguments import References
from plcgen.s7.cpu.compiler.context import Context
from plcgen.s7.cpu.compiler.conversions import coerce, integer_code
from plcgen.s7.cpu.compiler.literals import classify, source_of
from plcgen.s7.cpu.compiler.places import Places
from plcgen.s7.cpu.compiler.scope import UNKNOWN, Expressions, Val, same_type, unknown
from plcgen.s7.cpu.type_rules import (
    BITS,
    DURATIONS,
    INT_CONST,
    INTEGERS,
    NUMERIC,
    POINTERS,
    REAL_CONST,
    REALS,
    SIGNED,
    STAMPS,
    TEXTS,
    TYPE_NAME,
    UNSIGNED,
    WIDTHS,
    bit_string,
    common_bits,
    common_type,
    integer_of,
    remedy,
)
from plcgen.s7.scl import ast
from plcgen.s7.scl.dialects import is_refused
from plcgen.s7.types.data_types import HARDWARE
from plcgen.s7.types.values import RANGES


@dataclass(slots=True, eq=False)
class Operands:
    """What an expression begins with."""

    context: Context
    access: Access
    expressions: Expressions
    places: Places
    references: References

    def name(self, node: ast.Name) -> Val:
        """Value of a variable or constant."""
        symbol = self.places.symbol(node)
        if symbol is not None and symbol.place is not None:
            return self.access.load(symbol.place)
        if symbol is not None and symbol.constant is not None:
            return symbol.constant
        if node.name.upper() in {"ENO", "OK", "EN", "NULL", "NIL"} and self.places.undeclared(node):
            if node.name.upper() in {"NULL", "NIL"}:
                return Val("(None,0,0)", "ANY")
            self.context.uses_eno = True
            return Val(self.context.enable(node.name), "BOOL")
        named = self.places.type_named(node)
        if named:
            return Val(repr(named), TYPE_NAME)
        place = self.places.named(node)
        return self.access.load(place) if place is not None else unknown()

    def literal(self, node: ast.Literal) -> Val:
        """Compile a constant."""
        if node.kind == "pointer":
            return self.references.pointer(node)
        found = classify(node.text, node.kind)
        if found is None:
            self.context.error("PG824", f"{node.text} is not a constant", node)
            return unknown()
        type_, value = found
        if is_refused(type_, self.context.link.dialect):
            return unknown()  # PG803 has told of it
        return Val(source_of(value), type_, value)

    def slice(self, node: ast.Slice) -> Val:
        """``x.%X3``: part of a bit string or integer."""
        value = self.expressions.value(node.base)
        part = self.places.slice_type(node, value)
        if part is None:
            return unknown()
        bits, type_ = part
        return Val(f"({value.wrapped}>>{node.index * bits}&{(1 << bits) - 1})", type_, pure=value.pure)

    def variable(self, node: ast.Expression) -> Val:
        """Value of a path or an address."""
        place = self.places.place(node)
        return self.access.load(place) if place is not None else unknown()

    def omitted(self, node: ast.Omitted) -> Val:
        """PG822 about ``Q => ,`` where a value is needed."""
        self.context.error("PG822", "the parameter has no value", node)
        return unknown()

    def listed(self, node: ast.Aggregate | ast.Repetition) -> Val:
        """PG827 about ``[1, 2]`` and ``3(0)``."""
        self.context.error("PG827", "a list of values is allowed in declarations only", node)
        return unknown()


_COMPARE = {"=": "==", "<>": "!=", "<": "<", "<=": "<=", ">": ">", ">=": ">="}
_RING = frozenset({"+", "-", "*"})
FAULT = re.compile(r"\b(?:ck|opened|deref|peek|peek_bit)\(")
"""Code that may be a fault, besides that with an index or a divisor."""
_LOGIC = {"AND": ("and", "&"), "&": ("and", "&"), "OR": ("or", "|"), "XOR": ("", "^")}
_TIMED = frozenset({"DATE_AND_TIME", "DTL"})
_DATES = STAMPS | {"DATE", "TIME_OF_DAY", "LTIME_OF_DAY"}
_STAMPED = {
    ("+", "DATE", "TIME_OF_DAY"): "DTL", ("+", "DATE", "LTIME_OF_DAY"): "DTL", ("-", "DATE", "DATE"): "LTIME",
    ("-", "DATE_AND_TIME", "DATE_AND_TIME"): "TIME", ("-", "DTL", "DTL"): "LTIME", ("-", "LDT", "LDT"): "LTIME",
    ("-", "LTIME_OF_DAY", "LTIME_OF_DAY"): "LTIME",
    **{(sign, stamp, span): stamp for sign in "+-" for stamp in STAMPS for span in ("TIME", "LTIME")},
}  # fmt: skip
"""Results of date arithmetic of the S7-1500 (help of the TIA Portal, "Arithmetic expressions")."""
_STORED = {"TIME": "DINT", "LTIME": "LINT", "CHAR": "INT", "WCHAR": "INT", "DATE": "INT", "TIME_OF_DAY": "DINT"}
_SAME_WIDTH = "convert one of them; without IEC check the TIA Portal converts on its own (--iec-check off)"
_ORDERED = frozenset({"TIME", "LTIME", "DATE", "TIME_OF_DAY", "LTIME_OF_DAY", "LDT", "CHAR", "WCHAR"})


def wide_enough(value: Val, other: str) -> Val:
    """A constant above the range of the integer beside it as one of a wider type: both meet there.

    Seen in sources that the TIA Portal exported from a running plant: ``#sint <> 255``.
    """
    if value.type != INT_CONST or other not in INTEGERS or not isinstance(value.const, int):
        return value
    low, high = RANGES[other]
    if value.const <= high and (value.const >= low or low == 0):
        return value
    room = (name for name in SIGNED if RANGES[name][0] <= value.const <= RANGES[name][1])
    return replace(value, type=next(room, INT_CONST))


def signs_differ(left: Val, right: Val) -> bool:
    """Whether an integer with a sign meets one without; constants take the type of the other.

    Arithmetic with them needs the IEC check off (help of the TIA Portal, "Arithmetic expressions").
    """
    kinds = {value.type for value in (left, right) if value.const is None}
    return len(kinds & SIGNED.keys()) == 1 and len(kinds & UNSIGNED.keys()) == 1


@dataclass(slots=True, eq=False)
class Operators:
    """Signs, NOT and everything between two operands."""

    context: Context
    access: Access
    expressions: Expressions
    places: Places

    def unary(self, node: ast.Unary) -> Val:
        """Signs and NOT."""
        value = self.expressions.value(node.operand)
        if value.type == UNKNOWN:
            return value
        if node.operator == "NOT":
            if value.type == "BOOL":
                return Val(f"(not {value.code})", "BOOL", pure=value.pure)
            if value.type in INTEGERS and not self.context.rules.checked:
                type_ = bit_string(value.type)
                value = Val(coerce(self.context, value, type_, node.operand), type_, pure=value.pure)
            if value.type == INT_CONST and isinstance(value.const, int):
                return Val(source_of(~value.const), INT_CONST, ~value.const)
            if value.type in BITS:
                return Val(f"({value.code}^{(1 << BITS[value.type]) - 1})", value.type, pure=value.pure)
            self.context.error("PG821", f"NOT needs BOOL or a bit string, not {value.type or 'a structure'}", node)
            return unknown()
        if value.type not in NUMERIC and value.type not in DURATIONS:
            self.context.error("PG821", f"a sign needs a number, not {value.type or 'a structure'}", node)
            return unknown()
        if node.operator == "+":
            return value
        if isinstance(value.const, int | float) and value.type in {INT_CONST, REAL_CONST}:
            return Val(source_of(-value.const), value.type, -value.const)
        if value.type in REALS:
            return Val(f"(-{value.code})", value.type, pure=value.pure)
        return Val(f"(-{value.code})", value.type, raw=True, pure=value.pure)

    def binary(self, node: ast.Binary) -> Val:
        """Left-associative chains, in a loop: they may be long."""
        chain: list[ast.Binary] = []
        left: ast.Expression = node
        while isinstance(left, ast.Binary):
            chain.append(left)
            left = left.left
        value = self.expressions.value(left)
        for link in reversed(chain):
            conditional = value.type == "BOOL" and link.operator in {"AND", "&", "OR"}
            self.access.conditional += conditional
            checks = self.context.out.checks
            pending, own = self.context.pending, len(self.context.pending)
            pending.append(value)
            right = self.expressions.value(link.right)
            del pending[own]  # behind it may be operands that are kept for coverage
            self.access.conditional -= conditional
            may_fail = self.context.out.checks > checks or FAULT.search(right.code) is not None
            value = self.expressions.shown(link, self.operate(link, value, right, may_fail=may_fail))
        return value

    def operate(self, node: ast.Binary, left: Val, right: Val, *, may_fail: bool) -> Val:
        """Apply one operator."""
        if UNKNOWN in {left.type, right.type}:
            return Val("0", "BOOL" if node.operator in _COMPARE else UNKNOWN)
        for value, other, operand in ((left, right, node.left), (right, left, node.right)):
            if node.operator in _COMPARE and wide_enough(value, other.type) is not value:
                low, high = RANGES[other.type]
                shown = f"{self.context.text(operand)} is outside {other.type} ({low}..{high})"
                self.context.error("PG824", f"{shown}: the result is always the same", operand, "", Severity.WARNING)
        left, right = wide_enough(left, right.type), wide_enough(right, left.type)
        if node.operator in _COMPARE:
            return self.compare(node, left, right)
        if node.operator in _LOGIC:
            return self.logic(node, left, right, may_fail=may_fail)
        return self.arithmetic(node, left, right)

    def mismatch(self, node: ast.Binary, left: Val, right: Val) -> Val:
        """PG821 about two operands."""
        kinds = f"{left.type or 'a structure'} and {right.type or 'a structure'}"
        text = remedy(left.type, right.type, "convert one of them explicitly", self.context.rules)
        text = text if ";" in text else remedy(right.type, left.type, text, self.context.rules)
        self.context.error("PG821", f"{node.operator} does not take {kinds}", node, text)
        return Val("0", "BOOL" if node.operator in _COMPARE else UNKNOWN)

    def logic(self, node: ast.Binary, left: Val, right: Val, *, may_fail: bool) -> Val:
        """AND, OR, XOR.

        A CPU evaluates both operands, also where the first one decides: what fails in the second one fails. The short
        circuit of Python is for those where nobody notices.
        """
        if left.type == right.type == INT_CONST and isinstance(left.const, int) and isinstance(right.const, int):
            joined = {"&": left.const & right.const, "|": left.const | right.const, "^": left.const ^ right.const}
            number = joined[_LOGIC[node.operator][1]]
            return Val(source_of(number), INT_CONST, number)
        common = common_bits(left.type, right.type, self.context.rules)
        word, symbol = _LOGIC[node.operator]
        pure = left.pure and right.pure
        if common == "BOOL" and not {left.const, right.const} <= {None, 0, 1}:
            return self.mismatch(node, left, right)
        if common == "BOOL":
            if word and right.pure and not may_fail:
                before = left.parts[1] if left.parts and left.parts[0] == word else [left.code]
                parts = [*before, right.code]
                return Val(f"({f' {word} '.join(parts)})", "BOOL", pure=pure, parts=(word, parts))
            return Val(f"((not not {left.code}){symbol}(not not {right.code}))", "BOOL", pure=pure)
        if common not in BITS:
            return self.mismatch(node, left, right)
        codes = coerce(self.context, left, common, node.left), coerce(self.context, right, common, node.right)
        return Val(f"({codes[0]}{symbol}{codes[1]})", common, pure=pure)

    def compare(self, node: ast.Binary, left: Val, right: Val) -> Val:
        """Six comparisons; NaN and bit strings as the target has them."""
        pure = left.pure and right.pure
        symbol = _COMPARE[node.operator]
        equality = node.operator in {"=", "<>"}
        if left.const is not None and right.const is not None and {left.type, right.type} <= NUMERIC:
            return Val(f"({left.code}{symbol}{right.code})", "BOOL")
        if left.type == right.type == TYPE_NAME and equality:
            return Val(f"({left.code}{symbol}{right.code})", "BOOL", pure=pure)
        if {left.type, right.type} <= _DATES and {left.type, right.type} & STAMPS:
            dates = (f"ns({value.wrapped},{value.type!r})" for value in (left, right))
            return Val(f"({symbol.join(dates)})", "BOOL", pure=pure)
        if self.is_not_executed(left, right, equality=equality):
            message = "the soft CPU does not compare structures, arrays, pointers and S5TIME"
            self.context.error("PG827", message, node)
            return Val("False", "BOOL")
        if {left.type, right.type} == {"REAL", "LREAL"} and self.context.rules.checked:
            self.context.error("PG821", f"{node.operator} does not take REAL and LREAL", node, _SAME_WIDTH)
            return Val("False", "BOOL")
        common = common_type(left.type, right.type, self.context.rules)
        if common == "BOOL" and not {left.const, right.const} <= {None, 0, 1}:
            return self.mismatch(node, left, right)
        if common == "BOOL" and equality:
            return Val(f"((not {left.code}){symbol}(not {right.code}))", "BOOL", pure=pure)
        if not common or common in POINTERS or common == "BOOL":
            return self.mismatch(node, left, right)
        ordered = common in NUMERIC or common in _ORDERED or common in TEXTS
        ordered = ordered or (common in BITS and not self.context.classic)
        if not equality and not ordered:
            return self.mismatch(node, left, right)
        codes = coerce(self.context, left, common, node.left), coerce(self.context, right, common, node.right)
        if common in REALS and node.operator == "<>" and self.context.classic:
            return Val(f"real_ne({codes[0]},{codes[1]})", "BOOL", pure=pure)
        return Val(f"({codes[0]}{symbol}{codes[1]})", "BOOL", pure=pure)

    def is_not_executed(self, left: Val, right: Val, *, equality: bool) -> bool:
        """Whether a comparison is one of the S7-1200/1500 that the soft CPU does not have.

        Dates compare with dates, structures and arrays with their like, a VARIANT or ANY with everything (help of the
        TIA Portal, "Relational expressions"). Of S5TIME it says that it does not compare, and that it becomes TIME.
        """
        if "S5TIME" in {left.type, right.type}:
            return True
        if not equality or not self.context.link.dialect.is_tia:
            return False
        kinds = [self.places.pointer_type(value) for value in (left, right)]
        if any(kinds):
            return True
        pair = left.place, right.place
        if self.context.classic or left.type or right.type or pair[0] is None or pair[1] is None:
            return False
        return same_type(pair[0].shape, pair[1].shape)

    def arithmetic(self, node: ast.Binary, left: Val, right: Val) -> Val:
        """Compile + - * / MOD ** of numbers and times."""
        operator = node.operator
        stamped = _STAMPED.get((operator, left.type, right.type))
        if stamped is not None:
            if self.context.classic:
                stamped = {"DTL": "DATE_AND_TIME", "LTIME": "TIME"}.get(stamped, stamped)
            function = "add_ns" if operator == "+" else "sub_ns"
            types = left.type, right.type, stamped
            code = f"{function}({types!r},{left.wrapped},{right.wrapped})[1]"
            return Val(code, stamped, pure=left.pure and right.pure)
        timed = {left.type, right.type} & _TIMED
        if timed or left.type in _ORDERED or right.type in _ORDERED:
            return self.time_arithmetic(node, left, right)
        if self.context.rules.checked and signs_differ(left, right):
            return self.mismatch(node, left, right)
        left, right = self.counted(left, right.type, node.left), self.counted(right, left.type, node.right)
        common = common_type(left.type, right.type, self.context.rules)
        if common in BITS and self.context.rules.dialect.is_tia and not self.context.rules.checked:
            if common == "BYTE" and self.context.classic:  # it counts as USINT, says the help, a type they do not have
                self.context.error("PG827", "the soft CPU does not compute with BYTE as S7-300/400 do", node)
                return unknown()
            common = integer_of(common, classic=self.context.classic)
        if common in HARDWARE and WIDTHS[common] == WIDTHS["UINT"] and not self.context.rules.checked:
            common = "UINT"  # the number of a connection that a library counts up
        if common not in NUMERIC:
            return self.mismatch(node, left, right)
        pure = left.pure and right.pure
        if operator == "**":
            return self.power(left, right)
        if common in {INT_CONST, REAL_CONST}:
            return self.folded(node, left, right, common)
        if common in REALS:
            # REAL rounds after every operation
            codes = coerce(self.context, left, common, node.left), coerce(self.context, right, common, node.right)
            pure = left.pure and right.pure
            if node.operator in {"MOD", "DIV"}:
                self.context.error("PG821", f"{node.operator} does not take {common}", node)
                return unknown()
            self.context.out.checks += node.operator == "/" and right.const is None
            code = f"fdiv({codes[0]},{codes[1]})" if node.operator == "/" else f"{codes[0]}{node.operator}{codes[1]}"
            return Val(f"f32({code})" if common == "REAL" else f"({code})", common, pure=pure)
        if operator in _RING:
            codes = self.ring(left, common, node.left), self.ring(right, common, node.right)
            if operator != "+":
                codes = codes[0], f"({codes[1]})" if right.raw else codes[1]
            if operator == "*" and left.raw:
                codes = f"({codes[0]})", codes[1]
            return Val(f"{codes[0]}{operator}{codes[1]}", common, raw=True, pure=pure)
        codes = coerce(self.context, left, common, node.left), coerce(self.context, right, common, node.right)
        name = "mod" if operator == "MOD" else "div"
        if right.const == 0:
            self.context.error("PG824", "division by the constant 0", node)
        self.context.out.checks += right.const is None
        return Val(f"{name}({codes[0]},{codes[1]})", common, raw=name == "div", pure=pure)

    def counted(self, value: Val, other: str, node: ast.Expression) -> Val:
        """A bit string beside a floating-point number as the integer that it counts as without IEC check.

        Seen in documents of blocks that the TIA Portal V18 compiled: ``#word * 0.1``.
        """
        mixed = value.type in BITS and other in {*REALS, REAL_CONST}
        if not mixed or self.context.rules.checked or self.context.classic:
            return value
        type_ = integer_of(value.type, classic=False)
        return Val(coerce(self.context, value, type_, node), type_, pure=value.pure)

    def ring(self, value: Val, common: str, node: ast.Expression) -> str:
        """Operand of + - *: a pending wrap of the same type may wait."""
        return value.code if value.raw and value.type == common else coerce(self.context, value, common, node)

    def folded(self, node: ast.Binary, left: Val, right: Val, common: str) -> Val:
        """Two constants make a constant."""
        a, b = left.const, right.const
        if not isinstance(a, int | float) or not isinstance(b, int | float):
            return self.mismatch(node, left, right)
        result: int | float
        if node.operator == "+":
            result = a + b
        elif node.operator == "-":
            result = a - b
        elif node.operator == "*":
            result = a * b
        elif not b:
            self.context.error("PG824", "division by the constant 0", node)
            return unknown()
        elif common == REAL_CONST:
            result = a / b
        else:
            result = (mod if node.operator == "MOD" else quotient)(int(a), int(b))
        return Val(source_of(result), common, result)

    def power(self, left: Val, right: Val) -> Val:
        """``**`` gives REAL on S7-300/400, the type of the base elsewhere if it is one."""
        type_ = "LREAL" if "LREAL" in {left.type, right.type} else "REAL"
        code = f"power({left.code if left.const is not None else integer_code(left)},"
        code += f"{right.code if right.const is not None else integer_code(right)})"
        return Val(f"f32({code})" if type_ == "REAL" else code, type_, pure=left.pure and right.pure)

    def time_arithmetic(self, node: ast.Binary, left: Val, right: Val) -> Val:
        """TIME + TIME, TIME * number, TOD + TIME, TOD - TOD; the bytes are integers of one unit."""
        operator, pure = node.operator, left.pure and right.pure
        if operator == "*" and right.type in DURATIONS and not self.context.classic:
            left, right = (right, left) if left.type not in DURATIONS else (left, right)  # 1000 * LTIME: library LGF
        codes = integer_code(left), integer_code(right)
        kinds = left.type, right.type
        number = right.type in INTEGERS or right.type == INT_CONST
        if operator in {"+", "-"}:
            if kinds[0] in DURATIONS and (kinds[0] == kinds[1] or (number and not self.context.classic)):
                return Val(f"{codes[0]}{operator}({codes[1]})", kinds[0], raw=True, pure=pure)
            if kinds in {("LTIME", "TIME"), ("LTIME_OF_DAY", "TIME")}:
                return Val(f"{codes[0]}{operator}({codes[1]})*1000000", kinds[0], raw=True, pure=pure)
            if kinds[0] == "LTIME_OF_DAY" and number and not self.context.rules.checked:
                return Val(f"{codes[0]}{operator}({codes[1]})", kinds[0], raw=True, pure=pure)
            if kinds[0] == "TIME_OF_DAY" and (kinds[1] == "TIME" or (number and not self.context.rules.checked)):
                return Val(f"(({codes[0]}{operator}{codes[1]})%86400000)", "TIME_OF_DAY", pure=pure)
            if kinds == ("TIME_OF_DAY", "TIME_OF_DAY") and operator == "-":
                return Val(f"({codes[0]}-{codes[1]})", "TIME", pure=pure)
            if kinds in {("LDT", "LTIME"), ("LTIME_OF_DAY", "LTIME")}:
                return Val(f"({codes[0]}{operator}{codes[1]})", kinds[0], raw=True, pure=pure)
        elif operator in {"*", "/", "DIV"} and kinds[0] in DURATIONS and number:
            if operator == "*":
                return Val(f"({codes[0]})*({codes[1]})", kinds[0], raw=True, pure=pure)
            self.context.out.checks += right.const is None
            return Val(f"div({codes[0]},{codes[1]})", kinds[0], raw=True, pure=pure)
        return self.as_numbers(node, left, right) or self.mismatch(node, left, right)

    def as_numbers(self, node: ast.Binary, left: Val, right: Val) -> Val | None:
        """Without IEC check times, dates and characters count as the integers that they are stored as."""
        if self.context.rules.checked or not self.context.rules.dialect.is_tia:
            return None
        both = [replace(value, type=_STORED.get(value.type, value.type)) for value in (left, right)]
        plain = {value.type for value in both} <= {*NUMERIC, *BITS}
        return self.arithmetic(node, *both) if plain else None
