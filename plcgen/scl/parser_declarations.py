"""Declaration sections, declarations and types."""

from __future__ import annotations

from dataclasses import replace

from plcgen.scl import ast
from plcgen.scl.cursor import Fault, unquote
from plcgen.scl.lexer import EOF, INT, LOCAL, NAME, QUOTED, WORDS
from plcgen.scl.parser_expressions import LITERALS, ExpressionParser
from plcgen.scl.parser_foreign import FOREIGN_SECTIONS

SECTIONS = frozenset({"VAR", "VAR_INPUT", "VAR_OUTPUT", "VAR_IN_OUT", "VAR_TEMP", "CONST", "LABEL"})
UNIT_KEYWORDS = frozenset({"FUNCTION_BLOCK", "FUNCTION", "ORGANIZATION_BLOCK", "DATA_BLOCK", "TYPE"})
UNIT_ENDS = frozenset("END_" + keyword for keyword in UNIT_KEYWORDS)
_SECTION_ENDS = frozenset({"END_VAR", "END_CONST", "END_LABEL", "END_STRUCT", "BEGIN", EOF}) | UNIT_ENDS | (
    UNIT_KEYWORDS - {"TYPE"}
) | (SECTIONS - {"LABEL"})  # fmt: skip
_MODIFIERS = frozenset({"CONSTANT", "RETAIN", "NON_RETAIN", "DB_SPECIFIC"})
_JOINED = {"VAR_CONSTANT": "CONSTANT", "VAR_STAT": "", "VAR_STATIC": "", "VAR_RETAIN": "RETAIN"}
"""Spellings in one word that other tools write, and the modifier they stand for."""
_NUMBERED = frozenset({"UDT", "FB", "SFB", "FC", "SFC", "DB", "OB"})
_NOT_PLAIN = frozenset({"STRING", "WSTRING", "REF_TO"})


class DeclarationParser(ExpressionParser):
    """Everything between the header and BEGIN."""

    def section(self) -> ast.Section:
        """One section with its END; faults inside cost one declaration each."""
        start = self.start
        keyword = self.kinds[self.pos]
        modifiers: list[str] = []
        if keyword == "VAR" and _JOINED.get(self.texts[self.pos].upper()):
            modifiers.append(_JOINED[self.texts[self.pos].upper()])
        self.pos += 1
        if keyword == "LABEL":
            return self.label_section(start)
        self.skip_access()
        while self.upper() in _MODIFIERS and self.kind(1) not in {":", ",", "{"}:
            modifiers.append(self.upper())
            self.pos += 1
        declarations = self.declarations(constants=keyword == "CONST" or "CONSTANT" in modifiers)
        closing = "END_CONST" if keyword == "CONST" else "END_VAR"
        if not self.accept(closing):
            self.report(self.expected(closing).diagnostic)
            if self.kinds[self.pos] in {"END_VAR", "END_CONST", "END_STRUCT", "END_LABEL"}:
                self.pos += 1
        self.accept(";")
        return ast.Section(start, self.last_end, keyword, tuple(modifiers), declarations)

    def joined_section(self) -> bool:
        """Whether VAR_CONSTANT, VAR_STAT or a section of another dialect begins here: it is read like VAR."""
        upper = self.upper()
        if upper not in _JOINED and upper not in FOREIGN_SECTIONS:
            return False
        if upper in FOREIGN_SECTIONS:
            self.refuse(self.pos)
        self.kinds[self.pos] = "VAR"
        return True

    def label_section(self, start: int) -> ast.Section:
        """``LABEL a, b; END_LABEL``: the labels become declarations without a type."""
        found: list[ast.Declaration] = []
        while self.kinds[self.pos] in {NAME, QUOTED, ",", ";"}:
            if not (self.accept(",") or self.accept(";")):
                name = self.declared_name()
                found.append(ast.Declaration(name.start, name.end, (name,), None, None, None, ""))
        if not self.accept("END_LABEL"):
            self.report(self.expected("END_LABEL").diagnostic)
        self.accept(";")
        return ast.Section(start, self.last_end, "LABEL", (), tuple(found))

    def declarations(self, *, constants: bool = False) -> tuple[ast.Declaration, ...]:
        """Read declarations up to a closing or opening keyword of a section."""
        found: list[ast.Declaration] = []
        while self.kinds[self.pos] not in _SECTION_ENDS or self.at_keyword_as_name():
            depth = self.depth
            try:
                found.append(self.constant() if constants else self.declaration())
            except Fault as fault:
                if type(fault) is not Fault:
                    raise
                self.depth = depth
                self.report(fault.diagnostic)
                self.skip_declaration()
        return tuple(found)

    def at_keyword_as_name(self) -> bool:
        """Whether a keyword that would end the section is declared as a name; BEGIN may have attributes behind."""
        following = self.kind(1)
        return following in {":", ","} or (following == "{" and self.kinds[self.pos] != "BEGIN")

    def skip_declaration(self) -> None:
        """Go behind the next semicolon, or to the keyword that ends the section; structures as a whole."""
        inside = 0
        while (kind := self.kinds[self.pos]) not in _SECTION_ENDS or (inside and kind == "END_STRUCT"):
            self.pos += 1
            if kind == "STRUCT":
                inside += 1
            elif kind == "END_STRUCT":
                inside -= 1
            elif kind == ";" and not inside:
                break

    def constant(self) -> ast.Declaration:
        """``N := 10;`` of CONST; a type is accepted too."""
        if self.kind(1) in {":", "{"}:
            return self.declaration()
        start = self.start
        name = self.declared_name()
        self.expect(":=")
        value = self.expression()
        self.end_of_declaration()
        return ast.Declaration(start, value.end, (name,), None, None, value, self.trailing_comment())

    def declared_name(self) -> ast.DeclaredName:
        """Read a name with its attributes, behind it or in front of it."""
        before = self.attributes() if self.kinds[self.pos] == "{" else ()
        pos = self.pos
        name = self.word("a declaration")
        attributes = before + self.attributes() if self.kinds[self.pos] == "{" else before
        return ast.DeclaredName(self.starts[pos], self.tokens.end(pos), name, self.kinds[pos] == QUOTED, attributes)

    def plain_declaration(self) -> ast.Declaration | None:
        """Read ``name : type;`` or ``name : type := literal;`` in one step, as most are; None for all others."""
        pos, kinds, texts, starts = self.pos, self.kinds, self.texts, self.starts
        if (
            kinds[pos] != NAME
            or kinds[pos + 1] != ":"
            or kinds[pos + 2] != NAME
            or texts[pos + 2].upper() in _NOT_PLAIN
        ):
            return None
        initial = None
        if kinds[pos + 3] == ";":
            end, self.pos = starts[pos + 2] + len(texts[pos + 2]), pos + 4
        elif kinds[pos + 3] == ":=" and kinds[pos + 4] in LITERALS and kinds[pos + 5] == ";":
            text, begin = texts[pos + 4], starts[pos + 4]
            initial = ast.Literal(begin, begin + len(text), text, LITERALS[kinds[pos + 4]])
            end, self.pos = begin + len(text), pos + 6
        else:
            return None
        start, name, type_name, type_start = starts[pos], texts[pos], texts[pos + 2], starts[pos + 2]
        names = (ast.DeclaredName(start, start + len(name), name, False, ()),)  # noqa: FBT003 - as in the class
        spec = ast.TypeName(type_start, type_start + len(type_name), type_name, quoted=False, attributes=())
        return ast.Declaration(start, end, names, None, spec, initial, self.trailing_comment())

    def declaration(self) -> ast.Declaration:
        """Read ``a, b AT x : type := value; // comment``."""
        if plain := self.plain_declaration():
            return plain
        start = self.start
        names = [self.declared_name()]
        while self.accept(","):
            names.append(self.declared_name())
        at = None
        if self.upper() == "AT":
            self.pos += 1
            at = self.overlaid()
            self.attributes()
        self.expect(":")
        spec = self.type_spec()
        if self.kinds[self.pos] == "{":
            names[-1] = replace(names[-1], attributes=names[-1].attributes + self.attributes())
        initial = self.initial_value() if self.accept(":=") else None
        end = self.last_end
        self.end_of_declaration(optional=initial is None and _ends_structure(spec))
        return ast.Declaration(start, end, tuple(names), at, spec, initial, self.comment_of(spec))

    def overlaid(self) -> str:
        """Read the name behind AT; some write ``#`` in front of it."""
        if self.kinds[self.pos] != LOCAL:
            return self.word("the variable that AT overlays")
        self.pos += 1
        return self.texts[self.pos - 1][1:].strip('"')

    def end_of_declaration(self, *, optional: bool = False) -> None:
        """Read the semicolon; a missing one at the end of a line costs only its own message.

        ``optional`` is for END_STRUCT, behind which statement lists may leave it out.
        """
        if self.accept(";"):
            return
        end = self.last_end
        following = self.kinds[self.pos] in _SECTION_ENDS or "\n" in self.tokens.source[end : self.start]
        if optional and following:
            return
        if following:
            self.report(self.diagnostic("expected ';' at the end of the declaration", end, end + 1))
            return
        raise self.expected("';'")

    def comment_of(self, spec: ast.TypeSpec) -> str:
        """Behind the semicolon; for a structure behind STRUCT if there is none."""
        comment = self.trailing_comment()
        while isinstance(spec, ast.ArraySpec):
            spec = spec.element
        if comment or not isinstance(spec, ast.StructSpec):
            return comment
        saved, self.pos = self.pos, self.index_at(spec.start) + 1
        comment = self.trailing_comment()
        self.pos = saved
        return comment

    def index_at(self, offset: int) -> int:
        """Index of the token that starts at ``offset``."""
        from bisect import bisect_left

        return bisect_left(self.starts, offset)

    # --- types ----------------------------------------------------------------------------------------

    def type_spec(self) -> ast.TypeSpec:
        """Read a type with the attributes in front of it."""
        start = self.start
        attributes = self.attributes() if self.kinds[self.pos] == "{" else ()
        kind = self.kinds[self.pos]
        if kind == "ARRAY":
            return self.array(start)
        if kind == "STRUCT":
            return self.structure(self.start)
        if kind not in WORDS:
            raise self.expected("a data type")
        name = self.texts[self.pos]
        self.pos += 1
        if kind == QUOTED or self.kinds[self.pos] == ".":
            quoted = kind == QUOTED
            name = self.qualified(unquote(name))
            return ast.TypeName(start, self.last_end, name, quoted=quoted, attributes=attributes)
        upper = name.upper()
        if upper in {"STRING", "WSTRING"}:
            return self.string(start, name)
        if upper == "REF_TO":
            self.enter()
            target = self.type_spec()
            self.depth -= 1
            return ast.ReferenceSpec(start, target.end, target)
        if upper in _NUMBERED and self.kinds[self.pos] == INT:
            name += self.texts[self.pos]
            self.pos += 1
        return ast.TypeName(start, self.last_end, name, quoted=False, attributes=attributes)

    def qualified(self, name: str) -> str:
        """Go on behind the first name of a type in a namespace or software unit."""
        while self.accept("."):
            name += "." + self.word("a name")
        return name

    def string(self, start: int, name: str) -> ast.StringSpec:
        """Read ``STRING`` with or without a length."""
        length = None
        if self.accept("["):
            length = self.expression()
            self.expect("]")
        return ast.StringSpec(start, self.last_end, name, length)

    def array(self, start: int) -> ast.ArraySpec:
        """``ARRAY [low..high, ...] OF type``; ``*`` in place of the bounds."""
        self.enter()
        self.pos += 1
        self.expect("[")
        bounds: list[tuple[ast.Expression, ast.Expression]] = []
        if self.accept("*"):
            while self.accept(","):
                self.expect("*")
        else:
            bounds.append(self.bound())
            while self.accept(","):
                bounds.append(self.bound())
        self.expect("]")
        self.expect("OF")
        element = self.type_spec()
        self.depth -= 1
        return ast.ArraySpec(start, element.end, tuple(bounds), element)

    def named_values(self, base: ast.TypeSpec) -> ast.Section:
        """``(STOP := 0, RUN := 1)`` behind the type that a named value type is made from."""
        start = self.start
        self.expect("(")
        found: list[ast.Declaration] = []
        for item in self.initial_items(")"):
            if item.name is None:
                raise self.fault("a named value needs a name and a value", text="write NAME := 0")
            name = ast.DeclaredName(item.start, item.start + len(item.name), item.name, quoted=False, attributes=())
            found.append(ast.Declaration(item.start, item.end, (name,), None, base, item.value, ""))
        return ast.Section(start, self.last_end, "VAR", ("CONSTANT",), tuple(found))

    def bound(self) -> tuple[ast.Expression, ast.Expression]:
        """``low..high``."""
        low = self.expression()
        self.expect("..")
        return low, self.expression()

    def structure(self, start: int) -> ast.StructSpec:
        """``STRUCT .. END_STRUCT``."""
        self.enter()
        self.pos += 1
        members = self.declarations()
        if not self.accept("END_STRUCT"):
            self.report(self.expected("END_STRUCT").diagnostic)
        self.depth -= 1
        return ast.StructSpec(start, self.last_end, members)


def _ends_structure(spec: ast.TypeSpec) -> bool:
    """Whether the last word of a type is END_STRUCT."""
    while isinstance(spec, ast.ArraySpec):
        spec = spec.element
    return isinstance(spec, ast.StructSpec)
