"""Expressions by precedence climbing; the table is the one of S7-SCL, where NOT binds like a sign."""

from __future__ import annotations

from dataclasses import replace

from plcgen.scl import ast
from plcgen.scl.cursor import MAX_OPERATORS, Fault, unquote
from plcgen.scl.lexer import ADDRESS, INT, LOCAL, NAME, POINTER, QUOTED, REAL, STRING, TYPED, WORDS
from plcgen.scl.parser_foreign import ForeignSyntax

PRECEDENCE = {
    "OR": 1, "XOR": 2, "AND": 3, "&": 3, "=": 4, "<>": 4, "<": 5, "<=": 5, ">": 5, ">=": 5,
    "+": 6, "-": 6, "*": 7, "/": 7, "DIV": 7, "MOD": 7, "**": 9,
}  # fmt: skip
"""Binary operators, the tightest last; all associate to the left. Signs and NOT are 8."""

_POWER = 9
LITERALS = {
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
_NUMBERED = frozenset({"T", "Z", "C", "DB", "FB", "FC", "SDB"})
"""Timers, counters and blocks as start values; statement lists put a blank before the number."""


class ExpressionParser(ForeignSyntax):
    """Operands, operators, calls and initial values."""

    def expression(self) -> ast.Expression:
        """One complete expression with its own budget of operators."""
        self.operators = 0
        self.call_depth = 0
        return self.binary(0)

    def binary(self, minimum: int) -> ast.Expression:
        """Operators that bind tighter than ``minimum``, from left to right."""
        return self.climb(self.operand(), minimum)

    def climb(self, left: ast.Expression, minimum: int) -> ast.Expression:
        """Go on behind an operand that has been read."""
        while (level := PRECEDENCE.get(self.kinds[self.pos], 0)) > minimum:
            operator = self.kinds[self.pos]
            self.pos += 1
            self.count_operator()
            right = self.binary(level)
            left = ast.Binary(left.start, right.end, operator, left, right)
        return left

    def count_operator(self) -> None:
        """Long chains make deep trees: bounded per expression."""
        self.operators += 1
        if self.operators > MAX_OPERATORS:
            self.too_deep(f"more than {MAX_OPERATORS} operators in one expression")

    def operand(self) -> ast.Expression:
        """Read a variable, call, literal, sign, NOT or parenthesis."""
        pos = self.pos
        kind = self.kinds[pos]
        text = self.texts[pos]
        start = self.starts[pos]
        base: ast.Expression
        if kind == LOCAL:
            name = text[1:] if text[1] != '"' else text[2:-1]
            base = ast.Name(start, start + len(text), name, "local")
        elif kind == NAME:
            if self.kinds[pos + 1] in _NUMBERS and text.upper() in _SPACED:
                return self.spaced_address(start)
            base = ast.Name(start, start + len(text), text, "bare")
        elif kind == QUOTED:
            base = self.quoted_name(text, start)
        elif literal := LITERALS.get(kind):
            self.pos = pos + 1
            return ast.Literal(start, start + len(text), text, literal)
        elif kind == ADDRESS:
            base = ast.Address(start, start + len(text), text)
        else:
            return self.prefixed(kind, start)
        self.pos = pos + 1
        return self.postfix(base) if self.kinds[pos + 1] in _POSTFIX else base

    def spaced_address(self, start: int) -> ast.Expression:
        """``EW 10``, ``M 10.0``, ``DB 10.DW 5``, ``FB 10.DB 20(..)``: the blank means nothing."""
        text = self.texts[self.pos] + self.texts[self.pos + 1]
        self.pos += 2
        block = text[0] in "DFSdfs"
        base: ast.Expression
        base = ast.Name(start, self.last_end, text, "bare") if block else ast.Address(start, self.last_end, text)
        return self.postfix(base) if self.kinds[self.pos] in _POSTFIX else base

    @staticmethod
    def quoted_name(text: str, start: int) -> ast.Expression:
        """``"tag"`` or ``"tag":P``."""
        name = ast.Name(start, start + text.rindex('"') + 1, unquote(text), "quoted")
        return name if text[-1] == '"' else ast.Peripheral(start, start + len(text), name)

    def prefixed(self, kind: str, start: int) -> ast.Expression:
        """Read a sign, NOT, or an expression in parentheses."""
        if kind in {"-", "+", "NOT"}:
            self.enter()
            self.pos += 1
            operand = self.operand() if self.kinds[self.pos] in {"-", "+", "NOT"} else self.binary(_POWER - 1)
            self.depth -= 1
            return ast.Unary(start, operand.end, kind, operand)
        if kind == "(":
            self.enter()
            self.pos += 1
            inner = self.binary(0)
            self.expect(")")
            self.depth -= 1
            return replace(inner, start=start, end=self.last_end)
        raise self.no_expression()

    def no_expression(self) -> Fault:
        """Return the fault about a token that begins no expression."""
        return self.expected("an expression")

    def variable(self) -> ast.Expression:
        """Read an operand that may stand left of ``:=``."""
        if self.kinds[self.pos] not in {LOCAL, NAME, QUOTED, ADDRESS}:
            raise self.expected("a variable")
        return self.operand()

    def postfix(self, base: ast.Expression) -> ast.Expression:
        """Members, indices, slices, calls and ``^`` behind a name."""
        links = 0
        start = base.start
        while (kind := self.kinds[self.pos]) in _POSTFIX:
            links += 1
            if links > _FREE_LINKS:
                self.count_operator()
            if kind == ".":
                self.pos += 1
                base = self.member(base)
            elif kind == "[":
                self.pos += 1
                indices = self.indices()
                base = ast.Index(start, self.last_end, base, indices)
            elif kind == "(":
                self.pos += 1
                arguments = self.arguments()
                base = ast.Call(start, self.last_end, base, arguments)
            elif kind == "^":
                self.pos += 1
                base = ast.Dereference(start, self.last_end, base)
            elif isinstance(base, ast.Member | ast.Index | ast.Call) and self.at_periphery(self.pos):
                self.pos += 2
                base = ast.Peripheral(start, self.last_end, base)
            else:
                break
        return base

    def at_periphery(self, pos: int) -> bool:
        """Whether the colon at ``pos`` begins ``:P`` without a blank on either side."""
        start = self.starts[pos]
        return (
            self.texts[pos + 1] in {"P", "p"}
            and self.tokens.end(pos - 1) == start
            and self.starts[pos + 1] == start + 1
        )

    def member(self, base: ast.Expression) -> ast.Expression:
        """Read what follows a dot: a name, a slice, the bit number of ``DBX0.0``."""
        pos = self.pos
        kind = self.kinds[pos]
        text = self.texts[pos]
        end = self.starts[pos] + len(text)
        if kind in WORDS:
            if self.kinds[pos + 1] in _NUMBERS and text.upper() in _SPACED:
                self.pos = pos + 2
                return ast.Member(base.start, self.last_end, base, text + self.texts[pos + 1])
            if text[0] == "%" and text[1:3].upper() == "DB":
                self.pos = pos + 1
                return ast.Member(base.start, end, base, text[1:])
            if text[0] == "%":
                width, digits = text[1].upper(), text[2:]
                if width not in _SLICE_WIDTHS or not digits.isdigit():
                    raise self.fault(f"'{text}' is no slice", text="write .%X0, .%B0, .%W0 or .%D0")
                self.pos = pos + 1
                return ast.Slice(base.start, end, base, width, int(digits[:6]))
            self.pos = pos + 1
            if text[0] == '"':
                if text[-1] != '"':
                    inner = ast.Member(base.start, end - 2, base, unquote(text))
                    return ast.Peripheral(base.start, end, inner)
                text = text[1:-1]
            return ast.Member(base.start, end, base, text)
        if kind == INT and text.isdigit():
            self.pos = pos + 1
            return ast.Member(base.start, end, base, text)
        if kind == TYPED:
            self.pos = pos + 1
            return ast.Literal(base.start, end, self.tokens.source[base.start : end], "typed")
        if kind == LOCAL:
            raise self.fault("'#' behind a dot", text="only the first name of a path has a '#'")
        raise self.expected("a member name")

    def indices(self) -> tuple[ast.Expression, ...]:
        """Index expressions up to the closing bracket."""
        self.enter()
        found = [self.binary(0)]
        while self.accept(","):
            found.append(self.binary(0))
        self.expect("]")
        self.depth -= 1
        return tuple(found)

    def arguments(self) -> tuple[ast.Argument, ...]:
        """Arguments up to the closing parenthesis."""
        if self.accept(")"):
            return ()
        self.enter()
        found: list[ast.Argument] = []
        kinds = self.kinds
        while True:
            if self.depth == self.call_depth:
                self.operators = 0
            pos = self.pos
            start = self.starts[pos]
            if kinds[pos] in WORDS and kinds[pos + 1] in {":=", "=>"}:
                self.pos = pos + 2
                value = self.omitted() if kinds[pos + 2] in {",", ")"} else self.binary(0)
                found.append(ast.Argument(start, value.end, unquote(self.texts[pos]), kinds[pos + 1], value))
            else:
                value = self.binary(0)
                found.append(ast.Argument(start, value.end, None, "", value))
            if kinds[self.pos] == ",":
                self.pos += 1
            elif kinds[self.pos] == ")":
                self.pos += 1
                break
            elif kinds[self.pos] == ";" and self.kind(1) in WORDS and self.kind(2) in {":=", "=>"}:
                self.report(self.expected("',' or ')'", "a comma stands between two arguments").diagnostic)
                self.pos += 1
            else:
                raise self.expected("',' or ')'")
        self.depth -= 1
        return tuple(found)

    def omitted(self) -> ast.Expression:
        """Return the missing value of ``Q => ,``."""
        return ast.Omitted(self.last_end, self.last_end)

    # --- initial values -------------------------------------------------------------------------------

    def initial_value(self) -> ast.Expression:
        """Read an initial value: an expression, an aggregate, or a bare list of STEP 7 V5."""
        start = self.start
        first = self.initial_item()
        if self.kinds[self.pos] != ",":
            return first.value
        items = [first]
        while self.accept(","):
            items.append(self.initial_item())
        return ast.Aggregate(start, items[-1].end, "", tuple(items))

    def initial_item(self) -> ast.Argument:
        """One value of a list: plain, named, repeated or an aggregate itself."""
        self.operators = 0
        pos = self.pos
        start = self.start
        if self.kinds[pos] in WORDS and self.kinds[pos + 1] == ":=":
            self.pos = pos + 2
            value = self.initial_item().value
            return ast.Argument(start, value.end, unquote(self.texts[pos]), ":=", value)
        value = self.initial_operand()
        return ast.Argument(start, value.end, None, "", value)

    def initial_operand(self) -> ast.Expression:
        """Read an aggregate, a repetition, or any expression."""
        start = self.start
        kind = self.kinds[self.pos]
        if kind in {"[", "("}:
            self.pos += 1
            items = self.initial_items("]" if kind == "[" else ")")
            if kind == "(" and len(items) == 1 and self.kinds[self.pos] in PRECEDENCE:
                group = replace(items[0].value, start=start, end=self.last_end)
                return self.climb(group, 0)
            return ast.Aggregate(start, self.last_end, kind, items)
        if kind == NAME and self.kinds[self.pos + 1] == INT and self.upper() in _NUMBERED:
            self.pos += 2
            return ast.Address(start, self.last_end, self.tokens.source[start : self.last_end])
        if kind == INT and self.kinds[self.pos + 1] == "(":
            count = ast.Literal(start, self.tokens.end(self.pos), self.texts[self.pos], "int")
            self.pos += 2
            items = self.initial_items(")")
            return ast.Repetition(start, self.last_end, count, items)
        return self.binary(0)

    def initial_items(self, closing: str) -> tuple[ast.Argument, ...]:
        """Items up to the closing bracket."""
        if self.accept(closing):
            return ()
        self.enter()
        items = [self.initial_item()]
        while self.accept(","):
            items.append(self.initial_item())
        self.expect(closing)
        self.depth -= 1
        return tuple(items)
