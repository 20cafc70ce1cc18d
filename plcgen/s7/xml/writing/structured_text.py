"""SCL code to the elements of StructuredText, straight from the token stream; nothing of the text is lost.

A statement needs no tree: keywords and operators are Tokens, blanks and comments stand between them, and only
operands and calls have structure. ``UId`` is a slot until the network is complete.
"""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import replace
from typing import TYPE_CHECKING

from plcgen.s7.scl.cursor import unquote
from plcgen.s7.scl.lexer import (
    ADDRESS,
    INT,
    KEYWORDS,
    LOCAL,
    NAME,
    POINTER,
    QUOTED,
    REAL,
    STRING,
    TYPED,
    WORDS,
    Tokens,
    tokenize,
)
from plcgen.s7.types.blocks import Block, SectionKind
from plcgen.s7.types.data_types import elementary
from plcgen.s7.types.names import is_identifier
from plcgen.s7.xml.spelling import address, attribute, content, datatype
from plcgen.s7.xml.writing.documents import Setting, document
from plcgen.s7.xml.writing.elements import (
    HAS_HASH,
    HAS_QUOTES,
    SLOT,
    UID,
    BlockScope,
    constant,
    is_system,
    named_constant,
    simple_symbol,
    token,
    trivia,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from plcgen.s7.xml.writing.documents import Setting

FIRST_UID = 21
"""UIds of a network begin here in every genuine export."""

_CONSTANTS = {
    INT: "LiteralConstant", REAL: "LiteralConstant", STRING: "LiteralConstant", "TRUE": "LiteralConstant",
    "FALSE": "LiteralConstant", TYPED: "TypedConstant", POINTER: "LiteralConstant",
}  # fmt: skip
_PATH = frozenset({".", "[", "(", "^", ":"})
_OPERAND_ENDS = frozenset(
    {INT, REAL, STRING, TYPED, POINTER, ADDRESS, LOCAL, NAME, QUOTED, "TRUE", "FALSE", ")", "]", "^"}
)
_MEMBER_INSTRUCTIONS = frozenset({"TP", "TON", "TOF", "TONR", "CTU", "CTD", "CTUD"})
"""Instructions that are called as a member of their timer or counter: ``#t.TON(..)``."""

_TYPED = {
    **dict.fromkeys(("SCALE_X", "NORM_X", "TRUNC", "ROUND", "CEIL", "FLOOR"), "dest_type"),
    **dict.fromkeys(("SHL", "SHR", "ROL", "ROR", "SWAP", "LIMIT"), "value_type"),
}
"""Instructions that have the one type that they are used with behind their name (``SHL_WORD``): what that type is."""

_DECLARING = frozenset({"VAR", "TYPE", "ARRAY", "STRUCT"})
"""Keywords of declarations only: exports have VAR, Type and Array as names of members without quotes."""

_ASSIGNS = frozenset({":=", "=>"})
_NO_TITLE = frozenset({".", "[", "(", ":", ";", ",", ")", ":=", "+=", "-=", "*=", "/=", "&=", "**=", "?="})


def elements(
    tokens: Tokens,
    begin: int,
    stop: int,
    scope: BlockScope,
    setting: Setting,
    unknown: dict[str, tuple[int, int]] | None = None,
) -> str:
    """Elements for the source between two offsets, with ``SLOT`` for every UId.

    ``unknown`` gets what cannot be written for sure, with the offsets of the name where that is first: what is called
    and of which the scope does not know what it is (the call is that of an FC then), and types as operands of TypeOf.
    """
    writer = _Writer(tokens, begin, stop, scope, setting)
    text = writer.write(stop)
    if unknown is not None:
        unknown.update(writer.unknown)
    return text


def numbered(elements: str) -> str:
    """Put ascending UIds from 21 into the slots of a network."""
    pieces = elements.split(SLOT)
    parts = [""] * (2 * len(pieces) - 1)
    parts[::2] = pieces
    parts[1::2] = map(str, range(FIRST_UID, FIRST_UID + len(pieces) - 1))
    return "".join(parts)


class _Writer:
    """A position in the token list; every method writes what begins there and goes behind it."""

    def __init__(self, tokens: Tokens, begin: int, stop: int, scope: BlockScope, setting: Setting) -> None:
        self.source = tokens.source
        self.kinds = tokens.kinds
        self.texts = tokens.texts
        self.starts = tokens.starts
        self.pos = bisect_left(tokens.starts, begin)
        self.last = bisect_left(tokens.starts, stop, self.pos)
        self.scope = scope
        self.culture = setting.cultures[0]
        self.marks_quotes = setting.version.marks_quotes
        self.end = begin
        """Offset up to which the source is written."""
        self.out: list[str] = []
        self.unknown: dict[str, tuple[int, int]] = {}
        self.called = begin
        jumps = (n + 1 for n, kind in enumerate(self.kinds) if kind == "GOTO")
        self.labels = frozenset(self.texts[n].upper() for n in jumps)

    def write(self, stop: int) -> str:
        """Everything up to an offset."""
        while self.pos < self.last:
            self.gap()
            self.item()
        if self.end < stop:
            self.out.append(trivia(self.source[self.end : stop], self.culture))
        return "".join(self.out)

    def gap(self) -> None:
        """Write the trivia before the current token."""
        start = self.starts[self.pos]
        if self.end < start:
            self.out.append(trivia(self.source[self.end : start], self.culture))
            self.end = start

    def step(self, count: int = 1) -> None:
        """Go behind tokens that are written."""
        self.pos += count
        self.end = self.starts[self.pos - 1] + len(self.texts[self.pos - 1])

    def token(self) -> None:
        """Write the current token as a Token; the TIA Portal writes keywords in upper case."""
        kind = self.kinds[self.pos]
        self.out.append(token(kind if kind in KEYWORDS else self.texts[self.pos]))
        self.step()

    def item(self) -> None:
        """Write one operand, call or other token."""
        kind = self.kinds[self.pos]
        if kind == LOCAL:
            text = self.texts[self.pos]
            quoted = text[1] == '"'
            self.operand("Local", text[2:-1] if quoted else text[1:], quoted=quoted)
        elif kind == QUOTED:
            name = unquote(self.texts[self.pos])
            self.type_as_value(name, quoted=True)
            self.operand("Global", name, quoted=self.marks_quotes)
        elif scope := _CONSTANTS.get(kind):
            self.out.append(constant(scope, self.texts[self.pos]))
            self.step()
        elif kind == NAME:
            self.name()
        elif kind == ADDRESS:
            self.absolute()
        elif kind == "-" and self.is_sign():
            self.out.append(constant("LiteralConstant", "-" + self.texts[self.pos + 1]))
            self.step(2)
        elif kind == "REGION" and self.kinds[self.pos + 1] not in _NO_TITLE:
            self.token()
            self.title(self.source.find("\n", self.end))
        elif kind == "END_REGION":
            self.token()
            # write the title behind END_REGION; a comment or code there is none
            line_end = self.source.find("\n", self.end)
            stop = line_end if line_end >= 0 else len(self.source)
            line = self.source[self.end : stop].partition("//")[0]
            code = self.pos < self.last and self.kinds[self.pos] in KEYWORDS
            if (
                self.pos < self.last
                and self.starts[self.pos] < stop
                and not code
                and not (";" in line and line.strip(" \t\r;"))
            ):
                self.title(self.end + len(line))
        else:
            self.token()

    def is_sign(self) -> bool:
        """Whether the minus belongs to the number right behind it: then both are one literal."""
        pos = self.pos
        return (
            self.kinds[pos + 1] in {INT, REAL}
            and self.starts[pos + 1] == self.starts[pos] + 1
            and (pos == 0 or self.kinds[pos - 1] not in _OPERAND_ENDS)
        )

    # --- regions ----------------------------------------------------------------------------------------

    def title(self, line_end: int) -> None:
        """Write the title of a REGION: free text up to the end of the line, with the blanks there."""
        stop = line_end if line_end >= 0 else len(self.source)
        line = self.source[self.end : stop].rstrip("\r")
        text = line.lstrip()
        if not text:
            return
        lead = len(line) - len(line.lstrip())
        if lead:
            self.out.append(trivia(line[:lead], self.culture))
        self.out.append(f"<Text {UID}>{content(text)}</Text>")
        self.end += lead + len(text)
        while self.pos < self.last and self.starts[self.pos] < stop:
            self.pos += 1

    # --- operands ---------------------------------------------------------------------------------------

    def name(self) -> None:
        """Write a name without # and quotes: a function, a label, ENO, or a variable."""
        pos = self.pos
        text = self.texts[pos]
        upper = text.upper()
        following = self.kinds[pos + 1]
        if upper in self.labels and (following == ":" or (pos and self.kinds[pos - 1] == "GOTO")):
            self.out.append(f'<Access Scope="Label" {UID}><Label Name="{attribute(text)}" {UID} /></Access>')
            self.step()
        elif self.scope.is_local(text):
            self.operand("Local", text, quoted=False)
        elif following == "(":
            self.step()
            self.call(_instruction(text), "</Instruction>")
        elif upper == "ENO":
            variable = f'<PredefinedVariable Name="ENO" {UID} />'
            self.out.append(f'<Access Scope="PredefinedVariable" {UID}>{variable}</Access>')
            self.step()
        elif upper == "NULL":
            self.out.append(constant("LiteralConstant", text))
            self.step()
        else:
            self.type_as_value(text, quoted=False)
            self.operand("Global", text, quoted=False)

    def type_as_value(self, name: str, *, quoted: bool) -> None:
        """Note the name of a type where a value stands, as behind TypeOf(..): it is no tag."""
        pos = self.pos
        if self.kinds[pos + 1] not in {".", "(", "["} and self.scope.is_type(name, quoted=quoted):
            end = self.starts[pos] + len(self.texts[pos])
            self.unknown.setdefault(f"compares with the type {name}", (self.starts[pos], end))

    def absolute(self) -> None:
        """Write an absolute operand; what is none, such as an indexed one, stays a Token."""
        found = address(self.texts[self.pos])
        if found is None:
            self.token()
            return
        block = "" if found.block is None else f' BlockNumber="{found.block}"'
        place = f'Area="{found.area}" Type="{found.type}"{block} BitOffset="{found.bits}"'
        self.out.append(f'<Access Scope="Address" {UID}><Address {place} {UID} /></Access>')
        self.step()

    def operand(self, where: str, name: str, *, quoted: bool) -> None:
        """Write a variable or constant with members, indices and slices, or the call of an instance."""
        text = self.texts[self.pos]
        following = self.kinds[self.pos + 1]
        constants = self.scope.constants if where == "Local" else self.scope.global_constants
        quoted = quoted and is_plain(name)
        if name.upper() in constants:
            self.out.append(named_constant(f"{where}Constant", name, quoted=quoted and where == "Local"))
            self.step()
            return
        peripheral = text.endswith('":P')
        if following not in _PATH and not peripheral:
            self.out.append(simple_symbol(f"{where}Variable", name, quoted=quoted))
            self.step()
            return
        self.called = self.starts[self.pos]
        outer, self.out = self.out, []
        names, dot = self.path(name, quoted=quoted, peripheral=peripheral)
        pieces, self.out = self.out, outer
        called = self.pos < self.last and self.kinds[self.pos] == "("
        if called and self.is_instruction(where, names):
            self.variable(where, "".join(pieces[:dot]))
            self.out += pieces[dot:-1]
            self.call(f'<Instruction Name="{names[-1]}" {UID}>', "</Instruction>")
        elif called:
            self.instance(where, names, "".join(pieces))
        else:
            self.variable(where, "".join(pieces))

    def variable(self, where: str, symbol: str) -> None:
        """Write a variable of these components."""
        self.out.append(f'<Access Scope="{where}Variable" {UID}><Symbol {UID}>{symbol}</Symbol></Access>')

    def path(self, name: str, *, quoted: bool, peripheral: bool = False) -> tuple[tuple[str, ...], int]:
        """Write the components of a symbol; return their names and where the last dot begins in what is written."""
        names, dot = [name], 0
        self.component(name, quoted=quoted, peripheral=peripheral)
        while self.pos < self.last:
            kind = self.kinds[self.pos]
            if kind == "^":
                self.gap()
                self.token()
            elif kind == ".":
                dot = len(self.out)
                self.gap()
                self.token()
                if self.pos >= self.last:
                    break
                self.gap()
                names.append(self.member())
            else:
                break
        return tuple(names), dot

    def member(self) -> str:
        """Write what stands behind a dot and return its name."""
        kind, text = self.kinds[self.pos], self.texts[self.pos]
        marks = HAS_HASH if kind == LOCAL else ""
        if marks or (kind == INT and text.isdigit()) or (kind in WORDS and text[0] != "%"):
            name = unquote(text.removeprefix("#"))
            quoted = '"' in text and is_plain(name)
            self.component(name, quoted=quoted, peripheral=text.endswith('":P'), marks=marks)
            return name
        self.token()
        return ""

    def component(self, name: str, *, quoted: bool, peripheral: bool, marks: str = "") -> None:
        """Write one component with its indices."""
        self.step()
        indexed = self.pos < self.last and self.kinds[self.pos] == "["
        modifier = ' SimpleAccessModifier="Periphery"' if peripheral or self.is_peripheral() else ""
        head = f'<Component Name="{attribute(name)}"{modifier} {UID}'
        flag = marks + (HAS_QUOTES if quoted else "")
        if not indexed and not flag:
            self.out.append(f"{head} />")
        else:
            self.out.append(f"{head}>{flag}")
            while self.pos < self.last and self.kinds[self.pos] == "[":
                self.gap()
                self.token()
                self.until("]")
                if self.pos < self.last:
                    self.gap()
                    self.token()
            self.out.append("</Component>")
        if self.is_peripheral():
            self.step(2)

    def is_peripheral(self) -> bool:
        """Whether ``:P`` stands right behind the last token."""
        pos = self.pos
        return (
            pos + 1 < self.last
            and self.kinds[pos] == ":"
            and self.texts[pos + 1] in {"P", "p"}
            and self.starts[pos] == self.end
            and self.starts[pos + 1] == self.end + 1
        )

    def until(self, *closing: str) -> None:
        """Write operands and operators up to a closing token, without the trivia before it."""
        depth = 0
        while self.pos < self.last:
            kind = self.kinds[self.pos]
            if not depth and kind in closing:
                return
            depth += (kind == "(") - (kind == ")")
            self.gap()
            self.item()

    # --- calls ------------------------------------------------------------------------------------------

    def is_instruction(self, where: str, names: tuple[str, ...]) -> bool:
        """Whether an instruction is called as a member of its timer or counter, and no instance of that name."""
        called = names[-1].upper() in _MEMBER_INSTRUCTIONS and self.kinds[self.pos - 1] == NAME
        return called and len(names) > 1 and (where == "Global" or self.scope.block_of(names) is None)

    def instance(self, where: str, names: tuple[str, ...], symbol: str) -> None:
        """Write the call of an instance or of a function with quotes; its operand is ``symbol``."""
        if where == "Local":
            made = self.scope.block_of(names)
        elif len(names) == 1 and "<Token" not in symbol:
            made = self.global_block(names[0])
        else:
            made = self.scope.global_block_of(names)
        if made is None:
            self.is_unknown("#" + ".".join(names) if where == "Local" else f'"{names[0]}".{".".join(names[1:])}')
        if made is not None and made[1]:
            self.variable(where, symbol)
            self.call(f"<Instruction {UID}>", "</Instruction>")
        elif made is not None and made[0] == "":
            component = f'<Component Name="{attribute(names[0])}" {UID} />'
            instance = f'<Instance Scope="GlobalVariable" {UID}>{component}</Instance>'
            self.call(f'<CallInfo BlockType="FC" {UID}>{instance}', "</CallInfo>")
        else:
            name = f' Name="{attribute(made[0])}"' if made is not None else ""
            self.call(
                f'<CallInfo{name} BlockType="FB" {UID}><Instance Scope="{where}Variable" {UID}>{symbol}</Instance>',
                "</CallInfo>",
            )

    def global_block(self, name: str) -> tuple[str, bool]:
        """Block behind a quoted name that is called, and whether it is a system block; an FC has no name."""
        made = self.scope.instances.get(name.upper())
        if made is not None:
            return made, is_system(made)
        if name.upper() not in self.scope.functions:
            self.is_unknown(f'"{name}"')
        return "", False

    def is_unknown(self, name: str) -> None:
        """Keep where something is called first of which nobody knows what it is; its name ends before the bracket."""
        last = self.pos - 1
        what = f"calls {name}: whether that is an FC or an instance is not known"
        self.unknown.setdefault(what, (self.called, self.starts[last] + len(self.texts[last])))

    def call(self, head: str, tail: str) -> None:
        """Write the arguments of a call between ``head`` and ``tail``."""
        self.out.append(f'<Access Scope="Call" {UID}>{head}')
        self.gap()
        self.token()
        while self.pos < self.last and self.kinds[self.pos] != ")":
            self.gap()
            if self.kinds[self.pos] == ",":
                self.token()
            else:
                self.argument()
        if self.pos < self.last:
            self.gap()
            self.token()
        self.out.append(f"{tail}</Access>")

    def argument(self) -> None:
        """Write ``name := value``, ``name => value`` or a value alone."""
        pos = self.pos
        if self.kinds[pos] in WORDS and self.kinds[pos + 1] in _ASSIGNS:
            name = unquote(self.texts[pos])
            quoted = HAS_QUOTES if self.kinds[pos] == QUOTED and is_plain(name) else ""
            self.out.append(f'<Parameter Name="{attribute(name)}" {UID}>{quoted}')
            self.step()
            self.until(",", ")")
            self.out.append("</Parameter>")
        else:
            self.out.append(f"<NamelessParameter {UID}>")
            self.until(",", ")")
            self.out.append("</NamelessParameter>")


def _instruction(name: str) -> str:
    """The begin of the call of a function; a type behind its name is a value of its template."""
    base, _, spelling = name.rpartition("_")
    type_ = elementary(spelling)
    kind = _TYPED.get(base.upper())
    if kind is None or type_ is None:
        return f'<Instruction Name="{attribute(name)}" {UID}>'
    value = f'<TemplateValue Name="{kind}" Type="Type" {UID}>{datatype(type_)}</TemplateValue>'
    return f'<Instruction Name="{attribute(base)}" {UID}>{value}'


def is_plain(name: str) -> bool:
    """Whether a name needs no quotes behind # or a dot."""
    return is_identifier(name) is not None and (name.upper() not in KEYWORDS or name.upper() in _DECLARING)


def code_document(block: Block, setting: Setting, known: Sequence[Block] = ()) -> str:
    """Document of an FB, FC or OB; ``known`` are the blocks it may call."""
    text = block.code or ""
    code = elements(tokenize(text, "generated"), 0, len(text), BlockScope.of(block, known), setting)
    return document(block, setting, numbered(code))[0]


def instance_document(instance: Block, of: Block, setting: Setting) -> str:
    """Document of an instance DB with the interface of its function block."""
    inside = {SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.IN_OUT, SectionKind.STATIC}
    return document(replace(instance, sections=tuple(s for s in of.sections if s.kind in inside)), setting)[0]
