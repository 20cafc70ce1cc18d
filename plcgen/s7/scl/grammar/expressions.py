"""Expressions by precedence climbing, where NOT binds like a sign as in S7-SCL; initial values of declarations."""

from __future__ import annotations

from dataclasses import dataclass, replace

from plcgen.s7.scl import ast
from plcgen.s7.scl.cursor import MAX_OPERATORS, Cursor, unquote
from plcgen.s7.scl.grammar import mistakes
from plcgen.s7.scl.lexer import ADDRESS, INT, LOCAL, NAME, POINTER, QUOTED, REAL, STRING, TYPED, WORDS

PRECEDENCE = {
    "OR": 1, "XOR": 2, "AND": 3, "&": 3, "=": 4, "<>": 4, "<": 5, "<=": 5, ">": 5, ">=": 5,
    "+": 6, "-": 6, "*": 7, "/": 7, "DIV": 7, "MOD": 7, "**": 9,
}  # fmt: skip
"""Binary operators, the tightest last; all associate to the left. Signs and NOT are 8."""

_POWER = 9
_LITERALS = {
    INT: "int", REAL: "real", STRING: "string", TYPED: "typed", POINTER: "pointer", "TRUE": "bool", "FALSE": "bool",
}  # fmt: skip
"""Kinds of tokens that are literals, and what the tree calls them."""

_POSTFIX = frozenset({".", "[", "(", "^", ":"})
_FREE_LINKS = 8
_SLICE_WIDTHS = "XBWDL"
_NUMBERS = frozenset({INT, REAL})
_WIDTHS = ("", "X", "B", "W", "D")
_SPACED = frozenset(area + width for area in ("I", "Q", "E", "A", "M", "D", "DB") for width in _WIDTHS) | {
    "FB", "SFB", *(area + width for area in ("PI", "PQ", "PE", "PA") for width in "BWD")
}  # fmt: skip
"""Areas that may have a blank before their number, as in statement lists."""


@dataclass(slots=True, eq=False)
class Expressions:
    """Operands, operators and calls; ``sign_first`` says that a sign binds more tightly than ``**``, as in TIA."""

    cursor: Cursor
    sign_first: bool = False
    operators: int = 0
    call_depth: int = 0

    def read(self) -> ast.Expression:
        """One complete expression with its own budget of operators."""
        self.operators = 0
        self.call_depth = 0
        return self.climb(self.operand(), 0)

    def restart(self) -> None:
        """Give what follows a budget of operators of its own."""
        self.operators = 0

    def target(self) -> ast.Expression:
        """What a statement begins with; as a call it has a budget of operators for every argument."""
        self.operators = 0
        self.call_depth = self.cursor.depth + 1
        return self.variable()

    def binary(self, minimum: int) -> ast.Expression:
        """Operators that bind tighter than ``minimum``, from left to right."""
        return self.climb(self.operand(), minimum)

    def climb(self, left: ast.Expression, minimum: int) -> ast.Expression:
        """Go on behind an operand that has been read."""
        cursor = self.cursor
        while (level := PRECEDENCE.get(cursor.kinds[cursor.pos], 0)) > minimum:
            operator = cursor.kinds[cursor.pos]
            cursor.pos += 1
            self.count_operator()
            right = self.binary(level)
            left = ast.Binary(left.start, right.end, operator, left, right)
        return left

    def count_operator(self) -> None:
        """Long chains make deep trees: bounded per expression."""
        self.operators += 1
        if self.operators > MAX_OPERATORS:
            self.cursor.too_deep(f"more than {MAX_OPERATORS} operators in one expression")

    def operand(self) -> ast.Expression:
        """Read a variable, call, literal, sign, NOT or parenthesis."""
        cursor = self.cursor
        pos = cursor.pos
        kind = cursor.kinds[pos]
        text = cursor.texts[pos]
        start = cursor.starts[pos]
        base: ast.Expression
        if kind == LOCAL:
            name = text[1:] if text[1] != '"' else text[2:-1]
            base = ast.Name(start, start + len(text), name, "local")
        elif kind == NAME:
            if cursor.kinds[pos + 1] in _NUMBERS and text.upper() in _SPACED:
                # ``EW 10``, ``M 10.0``, ``DB 10.DW 5``, ``FB 10.DB 20(..)``: the blank means nothing.
                text += cursor.texts[pos + 1]
                cursor.pos += 2
                if text[0] in "DFSdfs":
                    base = ast.Name(start, cursor.last_end, text, "bare")
                else:
                    base = ast.Address(start, cursor.last_end, text)
                return self.postfix(base) if cursor.kinds[cursor.pos] in _POSTFIX else base
            base = ast.Name(start, start + len(text), text, "bare")
        elif kind == QUOTED:
            base = self.quoted_name(text, start)
        elif literal := _LITERALS.get(kind):
            cursor.pos = pos + 1
            return ast.Literal(start, start + len(text), text, literal)
        elif kind == ADDRESS:
            base = ast.Address(start, start + len(text), text)
        else:
            return self.prefixed(kind, start)
        cursor.pos = pos + 1
        return self.postfix(base) if cursor.kinds[pos + 1] in _POSTFIX else base

    @staticmethod
    def quoted_name(text: str, start: int) -> ast.Expression:
        """``"tag"`` or ``"tag":P``."""
        name = ast.Name(start, start + text.rindex('"') + 1, unquote(text), "quoted")
        return name if text[-1] == '"' else ast.Peripheral(start, start + len(text), name)

    def prefixed(self, kind: str, start: int) -> ast.Expression:
        """Read a sign, NOT, or an expression in parentheses."""
        cursor = self.cursor
        if kind in {"-", "+", "NOT"}:
            cursor.enter()
            cursor.pos += 1
            alone = cursor.kinds[cursor.pos] in {"-", "+", "NOT"} or (kind != "NOT" and self.sign_first)
            operand = self.operand() if alone else self.binary(_POWER - 1)
            cursor.depth -= 1
            return ast.Unary(start, operand.end, kind, operand)
        if kind == "(":
            cursor.enter()
            cursor.pos += 1
            inner = self.binary(0)
            cursor.expect(")")
            cursor.depth -= 1
            return replace(inner, start=start, end=cursor.last_end)
        raise mistakes.no_expression(cursor)

    def variable(self) -> ast.Expression:
        """Read an operand that may stand left of ``:=``."""
        cursor = self.cursor
        if cursor.kinds[cursor.pos] not in {LOCAL, NAME, QUOTED, ADDRESS}:
            raise cursor.expected("a variable")
        return self.operand()

    def postfix(self, base: ast.Expression) -> ast.Expression:
        """Members, indices, slices, calls and ``^`` behind a name."""
        cursor = self.cursor
        links = 0
        start = base.start
        while (kind := cursor.kinds[cursor.pos]) in _POSTFIX:
            links += 1
            if links > _FREE_LINKS:
                self.count_operator()
            if kind == ".":
                cursor.pos += 1
                base = self.member(base)
            elif kind == "[":
                cursor.pos += 1
                indices = self.indices()
                base = ast.Index(start, cursor.last_end, base, indices)
            elif kind == "(":
                cursor.pos += 1
                arguments = self.arguments()
                base = ast.Call(start, cursor.last_end, base, arguments)
            elif kind == "^":
                cursor.pos += 1
                base = ast.Dereference(start, cursor.last_end, base)
            elif isinstance(base, ast.Member | ast.Index | ast.Call) and self.at_periphery(cursor.pos):
                cursor.pos += 2
                base = ast.Peripheral(start, cursor.last_end, base)
            else:
                break
        return base

    def at_periphery(self, pos: int) -> bool:
        """Whether the colon at ``pos`` begins ``:P`` without a blank on either side."""
        cursor = self.cursor
        start = cursor.starts[pos]
        return (
            cursor.texts[pos + 1] in {"P", "p"}
            and cursor.tokens.end(pos - 1) == start
            and cursor.starts[pos + 1] == start + 1
        )

    def member(self, base: ast.Expression) -> ast.Expression:
        """Read what follows a dot: a name, a slice, the bit number of ``DBX0.0``."""
        cursor = self.cursor
        pos = cursor.pos
        kind = cursor.kinds[pos]
        text = cursor.texts[pos]
        end = cursor.starts[pos] + len(text)
        if kind in WORDS:
            if cursor.kinds[pos + 1] in _NUMBERS and text.upper() in _SPACED:
                cursor.pos = pos + 2
                return ast.Member(base.start, cursor.last_end, base, text + cursor.texts[pos + 1])
            if text[0] == "%" and text[1:3].upper() == "DB":
                cursor.pos = pos + 1
                return ast.Member(base.start, end, base, text[1:])
            if text[0] == "%":
                width, digits = text[1].upper(), text[2:]
                if width not in _SLICE_WIDTHS or not digits.isdigit():
                    raise cursor.fault(f"'{text}' is not a slice", text="write .%X0, .%B0, .%W0 or .%D0")
                cursor.pos = pos + 1
                return ast.Slice(base.start, end, base, width, int(digits[:6]))
            cursor.pos = pos + 1
            if text[0] == '"':
                if text[-1] != '"':
                    inner = ast.Member(base.start, end - 2, base, unquote(text))
                    return ast.Peripheral(base.start, end, inner)
                text = text[1:-1]
            return ast.Member(base.start, end, base, text)
        if kind == INT and text.isdigit():
            cursor.pos = pos + 1
            return ast.Member(base.start, end, base, text)
        if kind == TYPED:
            cursor.pos = pos + 1
            return ast.Literal(base.start, end, cursor.tokens.source[base.start : end], "typed")
        if kind == LOCAL:  # the TIA Portal takes it, and leaves it in the sources that it writes
            cursor.pos = pos + 1
            return ast.Member(base.start, end, base, text[1:].strip('"'))
        raise cursor.expected("a member name")

    def indices(self) -> tuple[ast.Expression, ...]:
        """Index expressions up to the closing bracket."""
        cursor = self.cursor
        cursor.enter()
        found = [self.binary(0)]
        while cursor.accept(","):
            found.append(self.binary(0))
        cursor.expect("]")
        cursor.depth -= 1
        return tuple(found)

    def arguments(self) -> tuple[ast.Argument, ...]:
        """Arguments up to the closing parenthesis."""
        cursor = self.cursor
        if cursor.accept(")"):
            return ()
        cursor.enter()
        found: list[ast.Argument] = []
        kinds = cursor.kinds
        while True:
            if cursor.depth == self.call_depth:
                self.operators = 0
            pos = cursor.pos
            start = cursor.starts[pos]
            if kinds[pos] in WORDS and kinds[pos + 1] in {":=", "=>"}:
                cursor.pos = pos + 2
                value = (
                    self.binary(0)
                    if kinds[pos + 2] not in {",", ")"}
                    else ast.Omitted(cursor.last_end, cursor.last_end)
                )
                found.append(ast.Argument(start, value.end, unquote(cursor.texts[pos]), kinds[pos + 1], value))
            else:
                value = self.binary(0)
                found.append(ast.Argument(start, value.end, None, "", value))
            if kinds[cursor.pos] == ",":
                cursor.pos += 1
            elif kinds[cursor.pos] == ")":
                cursor.pos += 1
                break
            elif kinds[cursor.pos] == ";" and cursor.kind(1) in WORDS and cursor.kind(2) in {":=", "=>"}:
                cursor.report(cursor.expected("',' or ')'", "arguments are separated by commas"))
                cursor.pos += 1
            else:
                raise cursor.expected("',' or ')'")
        cursor.depth -= 1
        return tuple(found)


_NUMBERED = frozenset({"T", "Z", "C", "DB", "FB", "FC", "SDB"})
"""Timers, counters and blocks as start values; statement lists put a blank before the number."""


@dataclass(slots=True, eq=False)
class InitialValues:
    """Expressions, aggregates, repetitions, and the bare lists of STEP 7 V5."""

    cursor: Cursor
    expressions: Expressions

    def read(self) -> ast.Expression:
        """Read an initial value: an expression, an aggregate, or a bare list of STEP 7 V5."""
        cursor = self.cursor
        start = cursor.start
        first = self.item()
        if cursor.kinds[cursor.pos] != ",":
            return first.value
        items = [first]
        while cursor.accept(","):
            items.append(self.item())
        return ast.Aggregate(start, items[-1].end, "", tuple(items))

    def item(self) -> ast.Argument:
        """One value of a list: plain, named, repeated or an aggregate itself."""
        cursor = self.cursor
        self.expressions.restart()
        pos = cursor.pos
        start = cursor.start
        if cursor.kinds[pos] in WORDS and cursor.kinds[pos + 1] == ":=":
            cursor.pos = pos + 2
            value = self.item().value
            return ast.Argument(start, value.end, unquote(cursor.texts[pos]), ":=", value)
        value = self.operand()
        return ast.Argument(start, value.end, None, "", value)

    def operand(self) -> ast.Expression:
        """Read an aggregate, a repetition, or any expression."""
        cursor = self.cursor
        start = cursor.start
        kind = cursor.kinds[cursor.pos]
        if kind in {"[", "("}:
            cursor.pos += 1
            items = self.items("]" if kind == "[" else ")")
            if kind == "(" and len(items) == 1 and cursor.kinds[cursor.pos] in PRECEDENCE:
                group = replace(items[0].value, start=start, end=cursor.last_end)
                return self.expressions.climb(group, 0)
            return ast.Aggregate(start, cursor.last_end, kind, items)
        if kind == NAME and cursor.kinds[cursor.pos + 1] == INT and cursor.upper() in _NUMBERED:
            cursor.pos += 2
            return ast.Address(start, cursor.last_end, cursor.tokens.source[start : cursor.last_end])
        if kind == INT and cursor.kinds[cursor.pos + 1] == "(":
            count = ast.Literal(start, cursor.tokens.end(cursor.pos), cursor.texts[cursor.pos], "int")
            cursor.pos += 2
            items = self.items(")")
            return ast.Repetition(start, cursor.last_end, count, items)
        return self.expressions.binary(0)

    def items(self, closing: str) -> tuple[ast.Argument, ...]:
        """Items up to the closing bracket."""
        cursor = self.cursor
        if cursor.accept(closing):
            return ()
        cursor.enter()
        items = [self.item()]
        while cursor.accept(","):
            items.append(self.item())
        cursor.expect(closing)
        cursor.depth -= 1
        return tuple(items)
