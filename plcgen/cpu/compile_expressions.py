"""Expressions: operators, conversions and constants, each with its S7 type."""

from __future__ import annotations

from plcgen.cpu.compile_model import UNKNOWN, Val
from plcgen.cpu.compile_places import PlaceCompiler
from plcgen.cpu.literals import as_real, classify, source_of
from plcgen.cpu.semantics_types import (
    BITS,
    DURATIONS,
    INT_CONST,
    INTEGERS,
    NUMERIC,
    POINTERS,
    REAL_CONST,
    REALS,
    SIGNED_WIDTHS,
    TEXT_CONST,
    TEXTS,
    WIDTHS,
    common_type,
    limits,
    remedy,
    widens,
)
from plcgen.s7.types import HARDWARE
from plcgen.scl import ast

_COMPARE = {"=": "==", "<>": "!=", "<": "<", "<=": "<=", ">": ">", ">=": ">="}
_RING = frozenset({"+", "-", "*"})
_LOGIC = {"AND": ("and", "&"), "&": ("and", "&"), "OR": ("or", "|"), "XOR": ("", "^")}
_ORDERED = frozenset({"TIME", "LTIME", "DATE", "TIME_OF_DAY", "LTIME_OF_DAY", "LDT", "CHAR", "WCHAR", "S5TIME"})


def wrapped(code: str, type_: str) -> str:
    """Return code that brings an integer into the range of its type."""
    bits = WIDTHS.get(type_, 16)
    mask = (1 << bits) - 1
    if type_ in SIGNED_WIDTHS:
        half = 1 << bits - 1
        return f"(({code}+{half}&{mask})-{half})"
    return f"(({code})&{mask})"


class ExpressionCompiler(PlaceCompiler):
    """Values and their types; a problem is reported once and gives the type UNKNOWN."""

    uses_eno = False

    def call_value(self, node: ast.Call) -> Val:
        """Compile a call that has a value; the next class knows how."""
        raise NotImplementedError

    def expression(self, node: ast.Expression) -> Val:
        """Compile an expression."""
        if isinstance(node, ast.Name):
            return self.name_value(node)
        if isinstance(node, ast.Literal):
            return self.literal(node)
        if isinstance(node, ast.Binary):
            return self.binary(node)
        if isinstance(node, ast.Unary):
            return self.unary(node)
        if isinstance(node, ast.Call):
            return self.call_value(node)
        if isinstance(node, ast.Slice):
            return self.slice_value(node)
        if isinstance(node, ast.Aggregate | ast.Repetition):
            self.error("PG827", "a list of values stands in declarations only", node)
            return self.unknown()
        if isinstance(node, ast.Omitted):
            self.error("PG822", "the parameter has no value", node)
            return self.unknown()
        place = self.place(node)
        return self.load(place) if place is not None else self.unknown()

    @staticmethod
    def unknown() -> Val:
        """Value of something that has been reported."""
        return Val("0", UNKNOWN)

    def name_value(self, node: ast.Name) -> Val:
        """Value of a variable or constant."""
        symbol = self.symbol(node)
        if symbol is not None and symbol.constant is not None:
            return symbol.constant
        if node.scope == "bare" and symbol is None and node.name.upper() in {"ENO", "OK", "EN", "NULL", "NIL"}:
            if node.name.upper() in {"NULL", "NIL"}:
                return Val("(None,0,0)", "ANY")
            self.uses_eno = True
            return Val("E[0]", "BOOL")
        place = self.named(node)
        return self.load(place) if place is not None else self.unknown()

    def literal(self, node: ast.Literal) -> Val:
        """Compile a constant."""
        if node.kind == "pointer":
            return self.pointer(node)
        found = classify(node.text, node.kind)
        if found is None:
            self.error("PG824", f"{node.text} is no constant", node)
            return self.unknown()
        type_, value = found
        return Val(source_of(value), type_, value)

    def pointer(self, node: ast.Literal) -> Val:
        """Compile ``P#DB3.DBX0.0 BYTE 10``."""
        raise NotImplementedError

    # --- conversions ----------------------------------------------------------------------------------

    def integer_code(self, value: Val) -> str:
        """Code of a value that is wrapped to its type."""
        if isinstance(value.const, int) and not isinstance(value.const, bool):
            return source_of(value.const)
        return wrapped(value.code, value.type) if value.raw else value.code

    def coerce(self, value: Val, target: str, node: ast.Expression) -> str:
        """Code of a value as ``target``; PG821 if there is no implicit conversion, PG824 out of range."""
        source = value.type
        if UNKNOWN in {source, target}:
            return value.code or "0"
        if source == target:
            return wrapped(value.code, source) if value.raw else value.code
        if source in {INT_CONST, REAL_CONST, TEXT_CONST}:
            return self.constant_as(value, target, node)
        if not widens(source, target, classic=self.classic) and not (target in TEXTS and source in TEXTS):
            shown = source or "a structure"
            text = f"write {source}_TO_{target}(..)" if source in WIDTHS and target in WIDTHS else ""
            text = remedy(source, target, text, self.link.dialect)
            self.error("PG821", f"{shown} is not converted to {target} implicitly", node, text)
            return "0"
        if value.const is not None:
            return self.constant_as(value, target, node)
        code = wrapped(value.code, source) if value.raw else value.code
        if target in REALS and source in INTEGERS:
            return f"float({code})"
        if target == "LTIME" and source == "TIME":
            return f"({code}*1000000)"
        if target == "LTIME_OF_DAY" and source == "TIME_OF_DAY":
            return f"({code}*1000000)"
        return f"chr({code})" if target in TEXTS and source in {"CHAR", "WCHAR"} else code

    def constant_as(self, value: Val, target: str, node: ast.Expression) -> str:
        """Code of a constant as a type."""
        const = value.const
        if isinstance(const, str):
            if target in TEXTS:
                return repr(const)
            if target in {"CHAR", "WCHAR"} and len(const) == 1:
                return str(ord(const))
            if target in {"CHAR", "WCHAR"} and not const and not self.classic:
                self.error("PG827", f"the soft CPU does not know the code of an empty {target}", node)
                return "0"
        elif isinstance(const, float):
            if target in REALS:
                return source_of(as_real(const, target))
        elif isinstance(const, int):
            number = self.integer_constant(const, target, node)
            if number is not None:
                return number
        self.error("PG821", f"{self.text(node)} is no {target} constant", node)
        return "0"

    def integer_constant(self, const: int, target: str, node: ast.Expression) -> str | None:
        """Code of an integer constant as a type, None if the type takes none."""
        if target in REALS:
            return source_of(as_real(float(const), target))
        if target == "BOOL" and const in {0, 1}:
            return "True" if const else "False"
        if target not in INTEGERS and target not in BITS and target not in HARDWARE and target != "TIME":
            return None
        low, high = limits(target) or (0, 0)
        if target in BITS:
            low = -(1 << BITS[target] - 1)
        if not low <= const <= high:
            self.error("PG824", f"{self.text(node)} is outside {target} ({low}..{high})", node)
            return "0"
        return source_of(const & (1 << BITS[target]) - 1 if target in BITS else const)

    def truth(self, value: Val, node: ast.Expression) -> str:
        """Code of a condition."""
        if value.type not in {"BOOL", UNKNOWN}:
            self.error("PG821", f"a condition is BOOL, not {value.type or 'a structure'}", node)
            return "0"
        return value.code

    # --- operators ------------------------------------------------------------------------------------

    def unary(self, node: ast.Unary) -> Val:
        """Signs and NOT."""
        value = self.expression(node.operand)
        if value.type == UNKNOWN:
            return value
        if node.operator == "NOT":
            if value.type == "BOOL":
                return Val(f"(not {value.code})", "BOOL", pure=value.pure)
            if value.type in BITS:
                return Val(f"({value.code}^{(1 << BITS[value.type]) - 1})", value.type, pure=value.pure)
            self.error("PG821", f"NOT needs BOOL or a bit string, not {value.type or 'a structure'}", node)
            return self.unknown()
        if value.type not in NUMERIC and value.type not in DURATIONS:
            self.error("PG821", f"a sign needs a number, not {value.type or 'a structure'}", node)
            return self.unknown()
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
        value = self.expression(left)
        for link in reversed(chain):
            conditional = value.type == "BOOL" and link.operator in {"AND", "&", "OR"}
            self.conditional += conditional
            right = self.expression(link.right)
            self.conditional -= conditional
            value = self.operate(link, value, right)
        return value

    def operate(self, node: ast.Binary, left: Val, right: Val) -> Val:
        """Apply one operator."""
        if UNKNOWN in {left.type, right.type}:
            return Val("0", "BOOL" if node.operator in _COMPARE else UNKNOWN)
        if node.operator in _COMPARE:
            return self.compare(node, left, right)
        if node.operator in _LOGIC:
            return self.logic(node, left, right)
        return self.arithmetic(node, left, right)

    def mismatch(self, node: ast.Binary, left: Val, right: Val) -> Val:
        """PG821 about two operands."""
        kinds = f"{left.type or 'a structure'} and {right.type or 'a structure'}"
        text = remedy(left.type, right.type, "convert one of them explicitly", self.link.dialect)
        text = text if ";" in text else remedy(right.type, left.type, text, self.link.dialect)
        self.error("PG821", f"{node.operator} does not take {kinds}", node, text)
        return Val("0", "BOOL" if node.operator in _COMPARE else UNKNOWN)

    def logic(self, node: ast.Binary, left: Val, right: Val) -> Val:
        """AND, OR, XOR."""
        common = common_type(left.type, right.type, classic=self.classic)
        word, symbol = _LOGIC[node.operator]
        pure = left.pure and right.pure
        if common == "BOOL" and not {left.const, right.const} <= {None, 0, 1}:
            return self.mismatch(node, left, right)
        if common == "BOOL":
            if word and right.pure:
                before = left.parts[1] if left.parts and left.parts[0] == word else [left.code]
                parts = [*before, right.code]
                return Val(f"({f' {word} '.join(parts)})", "BOOL", pure=pure, parts=(word, parts))
            return Val(f"((not not {left.code}){symbol}(not not {right.code}))", "BOOL", pure=pure)
        if common not in BITS:
            return self.mismatch(node, left, right)
        codes = self.coerce(left, common, node.left), self.coerce(right, common, node.right)
        return Val(f"({codes[0]}{symbol}{codes[1]})", common, pure=pure)

    def compare(self, node: ast.Binary, left: Val, right: Val) -> Val:
        """Six comparisons; NaN and bit strings as the target has them."""
        pure = left.pure and right.pure
        symbol = _COMPARE[node.operator]
        equality = node.operator in {"=", "<>"}
        if left.const is not None and right.const is not None and {left.type, right.type} <= NUMERIC:
            return Val(f"({left.code}{symbol}{right.code})", "BOOL")
        common = common_type(left.type, right.type, classic=self.classic)
        if common == "BOOL" and not {left.const, right.const} <= {None, 0, 1}:
            return self.mismatch(node, left, right)
        if common == "BOOL" and equality:
            return Val(f"((not {left.code}){symbol}(not {right.code}))", "BOOL", pure=pure)
        if not common or common in POINTERS or common == "BOOL":
            return self.mismatch(node, left, right)
        ordered = common in NUMERIC or common in _ORDERED or common in TEXTS or (common in BITS and not self.classic)
        if not equality and not ordered:
            return self.mismatch(node, left, right)
        codes = self.coerce(left, common, node.left), self.coerce(right, common, node.right)
        if common in REALS and node.operator == "<>" and self.classic:
            return Val(f"real_ne({codes[0]},{codes[1]})", "BOOL", pure=pure)
        return Val(f"({codes[0]}{symbol}{codes[1]})", "BOOL", pure=pure)

    def arithmetic(self, node: ast.Binary, left: Val, right: Val) -> Val:
        """Compile + - * / MOD ** of numbers and times."""
        operator = node.operator
        if left.type in _ORDERED or right.type in _ORDERED:
            return self.time_arithmetic(node, left, right)
        common = common_type(left.type, right.type, classic=self.classic)
        if common not in NUMERIC:
            return self.mismatch(node, left, right)
        pure = left.pure and right.pure
        if operator == "**":
            return self.power(left, right)
        if common in {INT_CONST, REAL_CONST}:
            return self.folded(node, left, right, common)
        if common in REALS:
            return self.real_arithmetic(node, left, right, common)
        if operator in _RING:
            codes = self.ring(left, common, node.left), self.ring(right, common, node.right)
            if operator != "+":
                codes = codes[0], f"({codes[1]})" if right.raw else codes[1]
            if operator == "*" and left.raw:
                codes = f"({codes[0]})", codes[1]
            return Val(f"{codes[0]}{operator}{codes[1]}", common, raw=True, pure=pure)
        codes = self.coerce(left, common, node.left), self.coerce(right, common, node.right)
        name = "mod" if operator == "MOD" else "div"
        if right.const == 0:
            self.error("PG824", "division by the constant 0", node)
        return Val(f"{name}({codes[0]},{codes[1]})", common, raw=name == "div", pure=pure)

    def ring(self, value: Val, common: str, node: ast.Expression) -> str:
        """Operand of + - *: a pending wrap of the same type may wait."""
        return value.code if value.raw and value.type == common else self.coerce(value, common, node)

    def real_arithmetic(self, node: ast.Binary, left: Val, right: Val, common: str) -> Val:
        """REAL rounds after every operation."""
        codes = self.coerce(left, common, node.left), self.coerce(right, common, node.right)
        pure = left.pure and right.pure
        if node.operator in {"MOD", "DIV"}:
            self.error("PG821", f"{node.operator} does not take {common}", node)
            return self.unknown()
        code = f"fdiv({codes[0]},{codes[1]})" if node.operator == "/" else f"{codes[0]}{node.operator}{codes[1]}"
        return Val(f"f32({code})" if common == "REAL" else f"({code})", common, pure=pure)

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
            self.error("PG824", "division by the constant 0", node)
            return self.unknown()
        elif common == REAL_CONST:
            result = a / b
        else:
            quotient = abs(int(a)) // abs(int(b)) * (1 if (a < 0) == (b < 0) else -1)
            result = int(a) - quotient * int(b) if node.operator == "MOD" else quotient
        return Val(source_of(result), common, result)

    def power(self, left: Val, right: Val) -> Val:
        """``**`` gives REAL on S7-300/400, the type of the base elsewhere if it is one."""
        type_ = "LREAL" if "LREAL" in {left.type, right.type} else "REAL"
        code = f"power({left.code if left.const is not None else self.integer_code(left)},"
        code += f"{right.code if right.const is not None else self.integer_code(right)})"
        return Val(f"f32({code})" if type_ == "REAL" else code, type_, pure=left.pure and right.pure)

    def time_arithmetic(self, node: ast.Binary, left: Val, right: Val) -> Val:
        """TIME + TIME, TIME * number, TOD + TIME, TOD - TOD; the bytes are integers of one unit."""
        operator, pure = node.operator, left.pure and right.pure
        codes = self.integer_code(left), self.integer_code(right)
        kinds = left.type, right.type
        number = right.type in INTEGERS or right.type == INT_CONST
        if operator in {"+", "-"}:
            if kinds[0] in DURATIONS and (kinds[0] == kinds[1] or (number and not self.classic)):
                return Val(f"{codes[0]}{operator}({codes[1]})", kinds[0], raw=True, pure=pure)
            if kinds[0] == "TIME_OF_DAY" and kinds[1] == "TIME":
                return Val(f"(({codes[0]}{operator}{codes[1]})%86400000)", "TIME_OF_DAY", pure=pure)
            if kinds == ("TIME_OF_DAY", "TIME_OF_DAY") and operator == "-":
                return Val(f"({codes[0]}-{codes[1]})", "TIME", pure=pure)
            if kinds in {("LDT", "LTIME"), ("LTIME_OF_DAY", "LTIME")}:
                return Val(f"({codes[0]}{operator}{codes[1]})", kinds[0], raw=True, pure=pure)
        elif operator in {"*", "/", "DIV"} and kinds[0] in DURATIONS and number:
            if operator == "*":
                return Val(f"({codes[0]})*({codes[1]})", kinds[0], raw=True, pure=pure)
            return Val(f"div({codes[0]},{codes[1]})", kinds[0], raw=True, pure=pure)
        return self.mismatch(node, left, right)

    # --- slices ---------------------------------------------------------------------------------------

    def slice_value(self, node: ast.Slice) -> Val:
        """``x.%X3``: part of a bit string or integer."""
        value = self.expression(node.base)
        part = self.slice_type(node, value)
        if part is None:
            return self.unknown()
        bits, type_ = part
        code = wrapped(value.code, value.type) if value.raw else value.code
        return Val(f"({code}>>{node.index * bits}&{(1 << bits) - 1})", type_, pure=value.pure)

    def slice_type(self, node: ast.Slice, value: Val) -> tuple[int, str] | None:
        """Width and type of a slice; PG824 if it lies outside."""
        if value.type == UNKNOWN:
            return None
        bits, type_ = {"X": (1, "BOOL"), "B": (8, "BYTE"), "W": (16, "WORD"), "D": (32, "DWORD")}[node.width]
        whole = WIDTHS.get(value.type, 0)
        if (node.index + 1) * bits > whole or value.type in REALS:
            self.error("PG824", f".%{node.width}{node.index} lies outside {value.type or 'a structure'}", node)
            return None
        return bits, type_
