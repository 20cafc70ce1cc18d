"""Functions of the language: mathematics, shifts, conversions, selection, texts."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.s7.cpu.compiler.context import Context
from plcgen.s7.cpu.compiler.conversions import coerce, convert_code, truth
from plcgen.s7.cpu.compiler.scope import UNKNOWN, Expressions, Val, unknown
from plcgen.s7.cpu.type_rules import (
    BITS,
    CLOCKS,
    DURATIONS,
    INT_CONST,
    INTEGERS,
    NUMERIC,
    REAL_CONST,
    REALS,
    SIGNED,
    STAMPS,
    TEXT_CONST,
    TEXTS,
    WIDTHS,
    bit_string,
    canonical,
    common_type,
    conversions,
    integer_of,
)
from plcgen.s7.scl import ast
from plcgen.s7.scl.instructions import INSTRUCTIONS, is_type_name, parameters

_MAX_TEXTS = 32
"""So many texts CONCAT of an S7-1200/1500 joins."""
_CONVERSION = re.compile(r"([A-Z][A-Z0-9_]*?)_TO_([A-Z][A-Z0-9_]*)")
_MATH = frozenset("SQR SQRT EXP EXPD LN LOG SIN COS TAN ASIN ACOS ATAN FRAC".split())
_ROUNDING = frozenset({"ROUND", "TRUNC", "FLOOR", "CEIL"})
_SHIFTS = frozenset({"SHL", "SHR", "ROL", "ROR"})
_ORDERED = frozenset({*INTEGERS, *REALS, *DURATIONS, *CLOCKS, *STAMPS})
_SELECTED = _ORDERED | {*BITS, *TEXTS, "BOOL", "CHAR", "WCHAR"}
_TYPES = {
    **dict.fromkeys(_MATH, frozenset(REALS)),
    **dict.fromkeys(_ROUNDING, frozenset({*INTEGERS, *REALS})),
    **dict.fromkeys(_SHIFTS, frozenset({*BITS, *INTEGERS})),
    "ABS": frozenset({*SIGNED, *REALS}), "SWAP": frozenset({"WORD", "DWORD", "LWORD"}),
    **dict.fromkeys(("MIN", "MAX", "LIMIT"), _ORDERED), **dict.fromkeys(("SEL", "MUX"), _SELECTED),
}  # fmt: skip
"""Functions whose type may stand behind their name, ``SHL_WORD``, and the types of each.

What they take is converted to that type before; the type of a rounding is that of its result (help of the TIA Portal,
"Parameters" of each of them, and "Shift left" of GRAPH).
"""
_INPUT = re.compile("IN[0-9]+|EN|ENO")
_NAME = re.compile(r"([A-Z]+)_([A-Z_]+)")
_TEXT_FUNCTIONS = frozenset({"LEN", "CONCAT", "LEFT", "RIGHT", "MID", "FIND", "DELETE", "INSERT", "REPLACE"})
_DELAYS = {"DIS_AIRT": "dis_airt", "SFC41": "dis_airt", "EN_AIRT": "en_airt", "SFC42": "en_airt"}


def bit_type(constant: object) -> str:
    """Type in which a constant without one is shifted: a word, or as wide as it needs."""
    bits = constant.bit_length() if isinstance(constant, int) else 0
    return next((name for name in ("WORD", "DWORD") if bits <= WIDTHS[name]), "LWORD")


class Reported(Exception):  # noqa: N818 - control flow inside the compiler, never seen outside
    """A call cannot be compiled, and a diagnostic says why: its value is UNKNOWN."""


@dataclass(slots=True, eq=False)
class Functions:
    """Functions that only compute."""

    context: Context
    expressions: Expressions

    def compile(self, node: ast.Call, name: str) -> Val | None:
        """Compile a function of the language, None if there is none of that name."""
        named = _NAME.fullmatch(name)
        if named is not None and canonical(named[2]) in _TYPES.get(named[1], ()):
            return self.typed(node, named[1], canonical(named[2]))
        if named is not None and named[1] in _TYPES and is_type_name(named[2]):
            self.context.error("PG821", f"there is no {named[1]} of {named[2]}", node)
            return unknown()
        if name in _TYPES:
            return self.typed(node, name)
        if name in {"TIME_TCK", "SFC64"}:
            self.bind(node, ())
            return Val("(T[0]-T[1]&2147483647)", "TIME")
        if name in _DELAYS:
            self.bind(node, (), ("RET_VAL",))
            return Val(f"{_DELAYS[name]}()", "INT", pure=False)
        base, _, kind = name.partition("_")
        if base in _TEXT_FUNCTIONS and (not kind or (kind in TEXTS and not self.context.classic)):
            wide = kind == "WSTRING"
            # LEN, CONCAT, LEFT, RIGHT, MID, FIND, DELETE, INSERT, REPLACE; of WSTRING if ``wide`` or one is given
            more = (
                tuple(f"IN{n}" for n in range(3, _MAX_TEXTS + 1))
                if base == "CONCAT" and not self.context.classic
                else ()
            )
            names = parameters()[base]
            given = [(argument.name or "").upper() for argument in node.arguments]
            if base == "LEN" and given == ["S"] and not self.context.rules.dialect.is_tia:
                names = ("S",)  # as sources of STEP 7 V5 call FC21; no manual was found for it
            bound = self.bind(node, names, more)
            codes, pure = [], True
            for parameter, expression in bound.items():
                value = self.expressions.value(expression)
                pure = pure and value.pure
                if parameter.startswith(("IN", "S")):
                    wide = wide or value.type == "WSTRING"
                    if value.type not in TEXTS and value.type not in {TEXT_CONST, "CHAR", "WCHAR", UNKNOWN}:
                        return self.refuse(node, base, value)
                    codes.append(coerce(self.context, value, "WSTRING" if wide else "STRING", expression))
                else:
                    codes.append(value.wrapped)
            type_ = "INT" if base in {"LEN", "FIND"} else "WSTRING" if wide else "STRING"
            form = "_v5" if self.context.classic and base in {"DELETE", "REPLACE"} else ""
            return Val(f"t_{base.lower()}{form}({','.join(codes)})", type_, pure=pure)
        match = _CONVERSION.fullmatch(name)
        if match is not None:
            return self.conversion(node, name, match[1], match[2])
        return None

    def typed(self, node: ast.Call, name: str, type_: str = "") -> Val:
        """``TRUNC_DINT``, ``SHL_WORD``: a function with its type, or of the type of what it is given."""
        if name in _ROUNDING:
            return self.rounding(node, name, type_ or "DINT")
        if name in _SHIFTS:
            return self.shift(node, name, type_)
        if name in {"MIN", "MAX"}:
            return self.extreme(node, name, type_)
        if name in {"SEL", "MUX"}:
            return self.select(node, name, type_)
        if name == "LIMIT":
            return self.limit(node, type_)
        if name == "SWAP":
            return self.swap(node, type_)
        return self.absolute_value(node, type_) if name == "ABS" else self.mathematics(node, name, type_)

    def operand(self, node: ast.Expression, type_: str) -> Val:
        """Value of an operand, as the type of the instruction if its name says one."""
        value = self.expressions.value(node)
        if not type_ or value.type in {UNKNOWN, type_}:
            return value
        return Val(coerce(self.context, value, type_, node), type_, pure=value.pure)

    def bind(
        self,
        node: ast.Call,
        names: tuple[str, ...],
        optional: tuple[str, ...] = (),
        needed: Sequence[str] | None = None,
    ) -> dict[str, ast.Expression]:
        """Arguments by name, given with names or in order; PG822 about the rest, Reported if one is missing.

        Those that may be missing are ``optional``, or all but the ``needed``.
        """
        found: dict[str, ast.Expression] = {}
        allowed = (*names, *optional)
        for position, argument in enumerate(node.arguments):
            name = (argument.name or (allowed[position] if position < len(allowed) else "")).upper()
            if name in {"EN", "ENO"}:
                continue
            if name not in allowed or name in found:
                shown = argument.name or self.context.text(argument)
                self.context.error("PG822", f"there is no parameter {shown}", argument, did_you_mean(shown, allowed))
                continue
            if argument.operator != "=>" or not isinstance(argument.value, ast.Omitted):
                found[name] = argument.value
        missing = [name for name in (names if needed is None else needed) if name not in found]
        if missing:
            self.context.error("PG822", f"{missing[0]} is missing", node)
            raise Reported
        return found

    def several(self, node: ast.Call) -> list[tuple[str, ast.Expression]]:
        """Arguments of a function with any number of inputs."""
        return [
            ((a.name or "").upper(), a.value) for a in node.arguments if (a.name or "").upper() not in {"EN", "ENO"}
        ]

    def mathematics(self, node: ast.Call, name: str, type_: str) -> Val:
        """Functions of REAL and LREAL."""
        bound = self.bind(node, ("IN",))
        value = self.operand(bound["IN"], type_)
        type_ = "LREAL" if value.type == "LREAL" else "REAL"
        if value.type in INTEGERS and name == "SQR":
            code = value.wrapped
            return Val(f"sqr({code})", value.type, raw=True, pure=value.pure)
        code = f"m_{name.lower()}({coerce(self.context, value, type_, bound['IN'])})"
        return Val(f"f32({code})" if type_ == "REAL" else code, type_, pure=value.pure)

    def absolute_value(self, node: ast.Call, type_: str) -> Val:
        """ABS keeps the type."""
        bound = self.bind(node, ("IN",))
        value = self.operand(bound["IN"], type_)
        if value.type in BITS and not self.context.rules.checked and not self.context.classic:
            type_ = integer_of(value.type, classic=False)
            return Val(coerce(self.context, value, type_, bound["IN"]), type_, pure=value.pure)
        if value.type not in NUMERIC:
            return self.refuse(node, "ABS", value)
        type_ = {INT_CONST: "INT", REAL_CONST: "REAL"}.get(value.type, value.type)
        code = coerce(self.context, value, type_, bound["IN"])
        return Val(f"abs({code})", type_, raw=type_ in INTEGERS, pure=value.pure)

    def refuse(self, node: ast.Expression, name: str, value: Val) -> Val:
        """PG821 about the operand of a function."""
        if value.type != UNKNOWN:
            self.context.error("PG821", f"{name} does not take {value.type or 'a structure'}", node)
        return unknown()

    def rounding(self, node: ast.Call, name: str, result: str) -> Val:
        """REAL to DINT, or to another type that the name of the function says."""
        bound = self.bind(node, ("IN",))
        value = self.expressions.value(bound["IN"])
        type_ = "LREAL" if value.type == "LREAL" else "REAL"
        code = coerce(self.context, value, type_, bound["IN"])
        if result in REALS:
            whole = f"whole({code},{name.lower()!r})"
            return Val(f"f32({whole})" if (type_, result) == ("LREAL", "REAL") else whole, result, pure=value.pure)
        signed = result in SIGNED
        return Val(f"to_int({code},{WIDTHS[result]},{signed},{name.lower()!r})", result, pure=value.pure)

    def shift(self, node: ast.Call, name: str, type_: str) -> Val:
        """SHL, SHR, ROL, ROR of bit strings, and of integers on S7-1200/1500."""
        bound = self.bind(node, ("IN", "N"))
        value, count = self.operand(bound["IN"], type_), self.expressions.value(bound["N"])
        type_ = bit_type(value.const) if value.type == INT_CONST else value.type
        free = not self.context.rules.checked
        if type_ in INTEGERS and self.context.classic and free:
            type_ = bit_string(type_)
        if type_ not in BITS and (type_ not in INTEGERS or self.context.classic):
            return self.refuse(node, name, value)
        if count.type not in INTEGERS and count.type not in {INT_CONST, UNKNOWN} and not (free and count.type in BITS):
            self.context.error("PG821", f"N counts bits, it cannot be a {count.type or 'structure'}", bound["N"])
        bits = WIDTHS[type_]
        code, steps = coerce(self.context, value, type_, bound["IN"]), count.wrapped
        pure = value.pure and count.pure
        if type_ in BITS and isinstance(count.const, int) and 0 <= count.const < bits and name in {"SHL", "SHR"}:
            shifted = f"({code}>>{steps})" if name == "SHR" else f"({code}<<{steps}&{(1 << bits) - 1})"
            return Val(shifted, type_, pure=pure)
        return Val(f"{name.lower()}({code},{steps},{bits})", type_, raw=type_ in INTEGERS, pure=pure)

    def values(self, expressions: list[ast.Expression]) -> list[tuple[Val, ast.Expression]]:
        """Values in the order in which they are evaluated, also where a later one is a call."""
        pending, before = self.context.pending, len(self.context.pending)
        found: list[tuple[Val, ast.Expression]] = []
        for expression in expressions:
            found.append((self.expressions.value(expression), expression))
            pending.append(found[-1][0])
        del pending[before:]
        return found

    def extreme(self, node: ast.Call, name: str, type_: str) -> Val:
        """MIN and MAX of two and more."""
        for argument in node.arguments:
            if argument.name and not _INPUT.fullmatch(argument.name.upper()):
                self.context.error("PG822", f"there is no parameter {argument.name}", argument, "they are IN1, IN2, ..")
        values = self.values([expression for _, expression in self.several(node)])
        return self.common_call(node, name.lower(), values, type_)

    def limit(self, node: ast.Call, type_: str) -> Val:
        """LIMIT(MN, IN, MX)."""
        bound = self.bind(node, ("MN", "IN", "MX"))
        values = self.values([bound[name] for name in ("MN", "IN", "MX")])
        result = self.common_call(node, "limit", values, type_)
        if result.type != UNKNOWN:
            asked = any((argument.name or "").upper() == "ENO" for argument in node.arguments)
            self.context.uses_eno = self.context.uses_eno or not asked
            result.code = result.code.replace("limit(", f"limit({'E' if asked else 'eno'},", 1)
        return result

    def common_call(self, node: ast.Call, function: str, values: list[tuple[Val, ast.Expression]], type_: str) -> Val:
        """Call with all operands in the type of the instruction, or in their common one."""
        common: str | None = type_ or (values[0][0].type if values else None)
        for value, _ in () if type_ else values[1:]:
            common = common_type(common or UNKNOWN, value.type, self.context.rules)
        if any(value.type == UNKNOWN for value, _ in values):
            return unknown()
        if not common or len(values) < 2:
            self.context.error("PG821", f"the operands of {function.upper()} have no common type", node)
            return unknown()
        if common in STAMPS - {"LDT"} and function in {"min", "max", "limit"}:  # bytes do not compare as dates do
            codes = [
                f"ns({coerce(self.context, value, common, expression)},{common!r})" for value, expression in values
            ]
            code = f"moment({function}({','.join(codes)}),'LDT',{common!r})"
            return Val(code, common, pure=all(value.pure for value, _ in values))
        common = {INT_CONST: "INT", REAL_CONST: "REAL", TEXT_CONST: "STRING"}.get(common, common)
        codes = [coerce(self.context, value, common, expression) for value, expression in values]
        return Val(f"{function}({','.join(codes)})", common, pure=all(value.pure for value, _ in values))

    def select(self, node: ast.Call, name: str, type_: str) -> Val:
        """SEL(G, IN0, IN1), MUX(K, IN0, IN1, ...)."""
        arguments = self.several(node)
        if len(arguments) < 3 or (name == "SEL" and len(arguments) > 3):
            self.context.error("PG822", f"{name} needs a selector and at least two inputs", node)
            return unknown()
        if all(label for label, _ in arguments):
            first = parameters()[name][0]
            if first not in {label for label, _ in arguments}:
                self.context.error("PG822", f"{first} is missing", node)
                return unknown()
            arguments.sort(key=lambda item: (item[0] != first, len(item[0]), item[0]))
        (selector, _), *values = self.values([expression for _, expression in arguments])
        code = f"int(not not {truth(self.context, selector, node)})" if name == "SEL" else selector.wrapped
        result = self.common_call(node, name.lower(), values, type_)
        if result.type == UNKNOWN:
            return result
        return Val(f"mux({code},{result.code.partition('(')[2]}", result.type, pure=result.pure and selector.pure)

    def swap(self, node: ast.Call, type_: str) -> Val:
        """Change the order of bytes."""
        bound = self.bind(node, ("IN",))
        value = self.operand(bound["IN"], type_)
        if value.type not in BITS:
            return self.refuse(node, "SWAP", value)
        size = BITS[value.type] // 8
        return Val(f"int.from_bytes(({value.code}).to_bytes({size}),'little')", value.type, pure=value.pure)

    def conversion(self, node: ast.Call, name: str, source: str, target: str) -> Val | None:
        """``A_TO_B`` with one argument."""
        if name in {"BCD_TO_INT", "WORD_BCD_TO_INT", "INT_TO_BCD_WORD", "INT_TO_BCD"} or "BCD" in name:
            return self.bcd(node, name)
        if name in INSTRUCTIONS and "BLOCK_DB" not in name:
            return None
        source, target = canonical(source), canonical(target)
        if (source, target) not in conversions(classic=self.context.classic):
            self.context.unknown("PG820", f"{self.context.link.dialect.label} has no function {name}", (name,), node)
            for _, expression in self.several(node):
                self.expressions.value(expression)
            return unknown()
        bound = self.bind(node, ("IN",))
        value = self.expressions.value(bound["IN"])
        code = coerce(self.context, value, source, bound["IN"])
        return Val(convert_code(code, source, target, classic=self.context.classic), target, pure=value.pure)

    def bcd(self, node: ast.Call, name: str) -> Val:
        """BCD words and integers."""
        bound = self.bind(node, ("IN",))
        double = "DINT" in name or "DWORD" in name
        value = self.expressions.value(bound["IN"])
        if name.endswith(("_TO_INT", "_TO_DINT")):
            code = coerce(self.context, value, "DWORD" if double else "WORD", bound["IN"])
            name = "bcd" if self.context.classic else "bcd_to_int"
            return Val(f"{name}({code},{7 if double else 3})", "DINT" if double else "INT", pure=value.pure)
        code = coerce(self.context, value, "DINT" if double else "INT", bound["IN"])
        return Val(f"int_to_bcd({code},{7 if double else 3})", "DWORD" if double else "WORD", pure=value.pure)
