"""Declaration sections, declarations and types."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Mapping
from dataclasses import dataclass, replace

from plcgen.s7.scl import ast
from plcgen.s7.scl.cursor import Cursor, SyntaxFault, unquote
from plcgen.s7.scl.grammar import documents, mistakes
from plcgen.s7.scl.grammar.expressions import Expressions, InitialValues
from plcgen.s7.scl.grammar.mistakes import FOREIGN_SECTIONS, SECTIONS, UNIT_ENDS, UNITS
from plcgen.s7.scl.lexer import EOF, INT, LOCAL, NAME, QUOTED, WORDS

_SECTION_ENDS = frozenset({"END_VAR", "END_CONST", "END_LABEL", "END_STRUCT", "BEGIN", EOF}) | UNIT_ENDS | (
    UNITS - {"TYPE"}
) | (SECTIONS - {"LABEL"})  # fmt: skip
_MODIFIERS = frozenset({"CONSTANT", "RETAIN", "NON_RETAIN", "DB_SPECIFIC"})
_JOINED = {"VAR_CONSTANT": "CONSTANT", "VAR_STAT": "", "VAR_STATIC": "", "VAR_RETAIN": "RETAIN"}
"""Spellings in one word that other tools write, and the modifier they stand for."""
_NUMBERED = frozenset({"UDT", "FB", "SFB", "FC", "SFC", "DB", "OB"})


@dataclass(slots=True, eq=False)
class Declarations:
    """Everything between the header and BEGIN; ``texts`` are the words of a SIMATIC SD document by key."""

    cursor: Cursor
    expressions: Expressions
    values: InitialValues
    texts: Mapping[str, str] | None = None
    comment: str = ""

    def section(self) -> ast.Section:
        """One section with its END; faults inside cost one declaration each."""
        cursor = self.cursor
        start = cursor.start
        keyword = cursor.kinds[cursor.pos]
        modifiers: list[str] = []
        if keyword == "VAR" and _JOINED.get(cursor.texts[cursor.pos].upper()):
            modifiers.append(_JOINED[cursor.texts[cursor.pos].upper()])
        cursor.pos += 1
        if keyword == "LABEL":
            # ``LABEL a, b; END_LABEL``: the labels become declarations without a type
            found: list[ast.Declaration] = []
            while cursor.kinds[cursor.pos] in {NAME, QUOTED, ",", ";"}:
                if not (cursor.accept(",") or cursor.accept(";")):
                    name = self.declared_name()
                    found.append(ast.Declaration(name.start, name.end, (name,), None, None, None, ""))
            if not cursor.accept("END_LABEL"):
                cursor.report(cursor.expected("END_LABEL"))
            cursor.accept(";")
            return ast.Section(start, cursor.last_end, "LABEL", (), tuple(found))
        mistakes.skip_access(cursor)
        while cursor.upper() in _MODIFIERS and cursor.kind(1) not in {":", ",", "{"}:
            modifiers.append(cursor.upper())
            cursor.pos += 1
        declarations = self.declarations(constants=keyword == "CONST" or "CONSTANT" in modifiers)
        closing = "END_CONST" if keyword == "CONST" else "END_VAR"
        if not cursor.accept(closing):
            cursor.report(cursor.expected(closing))
            if cursor.kinds[cursor.pos] in {"END_VAR", "END_CONST", "END_STRUCT", "END_LABEL"}:
                cursor.pos += 1
        cursor.accept(";")
        return ast.Section(start, cursor.last_end, keyword, tuple(modifiers), declarations)

    def joined_section(self) -> bool:
        """Whether VAR_CONSTANT, VAR_STAT or a section of another dialect begins here: it is read like VAR."""
        cursor = self.cursor
        upper = cursor.upper()
        if upper not in _JOINED and upper not in FOREIGN_SECTIONS:
            return False
        if upper in FOREIGN_SECTIONS:
            mistakes.refuse(cursor, cursor.pos)
        cursor.kinds[cursor.pos] = "VAR"
        return True

    def declarations(self, *, constants: bool = False) -> tuple[ast.Declaration, ...]:
        """Read declarations up to a closing or opening keyword of a section."""
        cursor = self.cursor
        found: list[ast.Declaration] = []
        while cursor.kinds[cursor.pos] not in _SECTION_ENDS or self.at_keyword_as_name():
            depth = cursor.depth
            try:
                found.append(self.constant() if constants else self.declaration())
            except SyntaxFault as fault:
                cursor.depth = depth
                cursor.report(fault)
                self.skip_declaration()
        return tuple(found)

    def at_keyword_as_name(self) -> bool:
        """Whether a keyword that would end the section is declared as a name; BEGIN may have attributes behind.

        In a SIMATIC SD document attributes stand in front: there they are those of what follows.
        """
        cursor = self.cursor
        following = cursor.kind(1)
        if following == "{":
            return self.texts is None and cursor.kinds[cursor.pos] != "BEGIN"
        return following in {":", ","}

    def skip_declaration(self) -> None:
        """Go behind the next semicolon, or to the keyword that ends the section; structures as a whole."""
        cursor = self.cursor
        inside = 0
        while (kind := cursor.kinds[cursor.pos]) not in _SECTION_ENDS or (inside and kind == "END_STRUCT"):
            cursor.pos += 1
            if kind == "STRUCT":
                inside += 1
            elif kind == "END_STRUCT":
                inside -= 1
            elif kind == ";" and not inside:
                break

    def constant(self) -> ast.Declaration:
        """``N := 10;`` of CONST; a type is accepted too."""
        cursor = self.cursor
        if cursor.kind(1) in {":", "{"}:
            return self.declaration()
        start = cursor.start
        name = self.declared_name()
        cursor.expect(":=")
        value = self.expressions.read()
        self.end_of_declaration()
        return ast.Declaration(start, value.end, (name,), None, None, value, cursor.trailing_comment(cursor.pos))

    def declared_name(self) -> ast.DeclaredName:
        """Read a name with its attributes, behind it or in front of it."""
        cursor = self.cursor
        before = cursor.attributes() if cursor.kinds[cursor.pos] == "{" else ()
        if before and self.texts is not None:
            before, self.comment = documents.of_member(before, self.texts)
        pos = cursor.pos
        name = cursor.word("a declaration")
        attributes = before + cursor.attributes() if cursor.kinds[cursor.pos] == "{" else before
        return ast.DeclaredName(
            cursor.starts[pos], cursor.tokens.end(pos), name, cursor.kinds[pos] == QUOTED, attributes
        )

    def declaration(self) -> ast.Declaration:
        """Read ``a, b AT x : type := value; // comment``."""
        cursor = self.cursor
        start = cursor.start
        self.comment = ""
        names = [self.declared_name()]
        comment = self.comment
        while cursor.accept(","):
            names.append(self.declared_name())
        at = None
        if cursor.upper() == "AT":
            cursor.pos += 1
            at = self.overlaid()
            cursor.attributes()
        cursor.expect(":")
        spec = self.type_spec()
        if cursor.kinds[cursor.pos] == "{":
            names[-1] = replace(names[-1], attributes=names[-1].attributes + cursor.attributes())
        initial = self.values.read() if cursor.accept(":=") else None
        end = cursor.last_end
        self.end_of_declaration(optional=initial is None and _ends_structure(spec))
        return ast.Declaration(start, end, tuple(names), at, spec, initial, comment or self.comment_of(spec))

    def overlaid(self) -> str:
        """Read the name behind AT; some write ``#`` in front of it."""
        cursor = self.cursor
        if cursor.kinds[cursor.pos] != LOCAL:
            return cursor.word("the variable that AT overlays")
        cursor.pos += 1
        return cursor.texts[cursor.pos - 1][1:].strip('"')

    def end_of_declaration(self, *, optional: bool = False) -> None:
        """Read the semicolon; a missing one at the end of a line costs only its own message.

        ``optional`` is for END_STRUCT, behind which statement lists may leave it out.
        """
        cursor = self.cursor
        if cursor.accept(";"):
            return
        end = cursor.last_end
        following = cursor.kinds[cursor.pos] in _SECTION_ENDS or "\n" in cursor.tokens.source[end : cursor.start]
        if optional and following:
            return
        if following:
            cursor.report(cursor.diagnostic("expected ';' at the end of the declaration", end, end + 1))
            return
        raise cursor.expected("';'")

    def comment_of(self, spec: ast.TypeSpec) -> str:
        """Behind the semicolon; for a structure behind STRUCT if there is none."""
        cursor = self.cursor
        comment = cursor.trailing_comment(cursor.pos)
        while isinstance(spec, ast.ArraySpec):
            spec = spec.element
        if comment or not isinstance(spec, ast.StructSpec):
            return comment
        return cursor.trailing_comment(bisect_left(cursor.starts, spec.start) + 1)

    def type_spec(self) -> ast.TypeSpec:
        """Read a type with the attributes in front of it."""
        cursor = self.cursor
        start = cursor.start
        attributes = cursor.attributes() if cursor.kinds[cursor.pos] == "{" else ()
        kind = cursor.kinds[cursor.pos]
        if kind == "ARRAY":
            return self.array(start)
        if kind == "STRUCT":
            return self.structure(cursor.start)
        if kind not in WORDS:
            raise cursor.expected("a data type")
        name = cursor.texts[cursor.pos]
        cursor.pos += 1
        if kind == QUOTED or cursor.kinds[cursor.pos] == ".":
            quoted = kind == QUOTED
            name = self.qualified(unquote(name))
            return ast.TypeName(start, cursor.last_end, name, quoted=quoted, attributes=attributes)
        upper = name.upper()
        if upper in {"STRING", "WSTRING"}:
            return self.string(start, name)
        if upper == "REF_TO":
            cursor.enter()
            target = self.type_spec()
            cursor.depth -= 1
            return ast.ReferenceSpec(start, target.end, target)
        if upper in _NUMBERED and cursor.kinds[cursor.pos] == INT:
            name += cursor.texts[cursor.pos]
            cursor.pos += 1
        return ast.TypeName(start, cursor.last_end, name, quoted=False, attributes=attributes)

    def qualified(self, name: str) -> str:
        """Go on behind the first name of a type in a namespace or software unit."""
        while self.cursor.accept("."):
            name += "." + self.cursor.word("a name")
        return name

    def string(self, start: int, name: str) -> ast.StringSpec:
        """Read ``STRING`` with or without a length."""
        cursor = self.cursor
        length = None
        if cursor.accept("["):
            length = self.expressions.read()
            cursor.expect("]")
        return ast.StringSpec(start, cursor.last_end, name, length)

    def array(self, start: int) -> ast.ArraySpec:
        """``ARRAY [low..high, ...] OF type``; ``*`` in place of the bounds."""
        cursor = self.cursor
        cursor.enter()
        cursor.pos += 1
        cursor.expect("[")
        bounds: list[tuple[ast.Expression, ast.Expression]] = []
        stars = 1
        if cursor.accept("*"):
            while cursor.accept(","):
                cursor.expect("*")
                stars += 1
        else:
            bounds.append(self.bound())
            while cursor.accept(","):
                bounds.append(self.bound())
        cursor.expect("]")
        cursor.expect("OF")
        element = self.type_spec()
        cursor.depth -= 1
        return ast.ArraySpec(start, element.end, tuple(bounds), element, stars)

    def named_values(self, base: ast.TypeSpec) -> ast.Section:
        """``(STOP := 0, RUN := 1)`` behind the type that a named value type is made from."""
        cursor = self.cursor
        start = cursor.start
        cursor.expect("(")
        found: list[ast.Declaration] = []
        for item in self.values.items(")"):
            if item.name is None:
                raise cursor.fault("a named value needs a name and a value", text="write NAME := 0")
            name = ast.DeclaredName(item.start, item.start + len(item.name), item.name, quoted=False, attributes=())
            found.append(ast.Declaration(item.start, item.end, (name,), None, base, item.value, ""))
        return ast.Section(start, cursor.last_end, "VAR", ("CONSTANT",), tuple(found))

    def bound(self) -> tuple[ast.Expression, ast.Expression]:
        """``low..high``."""
        low = self.expressions.read()
        self.cursor.expect("..")
        return low, self.expressions.read()

    def structure(self, start: int) -> ast.StructSpec:
        """``STRUCT .. END_STRUCT``."""
        cursor = self.cursor
        cursor.enter()
        cursor.pos += 1
        members = self.declarations()
        if not cursor.accept("END_STRUCT"):
            cursor.report(cursor.expected("END_STRUCT"))
        cursor.depth -= 1
        return ast.StructSpec(start, cursor.last_end, members)


def _ends_structure(spec: ast.TypeSpec) -> bool:
    """Whether the last word of a type is END_STRUCT."""
    while isinstance(spec, ast.ArraySpec):
        spec = spec.element
    return isinstance(spec, ast.StructSpec)
