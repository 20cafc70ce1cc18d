"""SIMATIC SD (``.s7dcl``): blocks as SCL has them, with other words around them.

Attributes stand in front of what they describe, code stands in networks with a language each, texts are named by keys
whose words are in another file, and ``_.`` in front of a name says that it is one of the same software unit. All of it
becomes the tree that SCL has, so that nothing else has to know where a block comes from.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from plcgen.s7.scl import ast
from plcgen.s7.scl.cursor import Cursor
from plcgen.s7.scl.grammar.mistakes import UNIT_ENDS, UNITS
from plcgen.s7.scl.grammar.statements import Statements
from plcgen.s7.scl.lexer import EOF, NAME, QUOTED, Tokens, tokenize

SUFFIX = ".s7dcl"
IEC_CHECK = "IsIECCheckEnabled"
"""The name that SimaticML has for it: whether a block is compiled with IEC check."""
NUMBER = "S7_BlockNumber"
SAFETY = "S7_Safety"
TEXT = "S7_MLC"
"""Attribute with the key of a comment."""
SCL = "SCL"

_HEADER = {"S7_Optimized": "S7_Optimized_Access", "S7_IECCheck": IEC_CHECK}
_PROPERTIES = {"S7_Version": "VERSION", "S7_Author": "AUTHOR", "S7_Family": "FAMILY", "S7_Name": "NAME"}
_TITLE, _COMMENT, _RETAIN = "S7_BlockTitle", "S7_BlockComment", "S7_StandardRetain"
_OF_THE_EDITOR = frozenset({"S7_PreferredLanguage", "S7_EditorMode"})
_NO_WRITING = {"S7_ACCESS": ("READONLY", "ExternalWritable"), "S7_VISIBILITY": ("HIDDEN", "ExternalVisible")}
"""Attributes of members, what their value begins with, and what is then false; read off their words."""
_NO_KEYWORD = frozenset({":=", ":", ".", "(", "[", ";", ",", "=>"})


def is_document(file: str) -> bool:
    """Whether the name of a file says that it is a SIMATIC SD document."""
    return file.lower().endswith(SUFFIX)


def document_tokens(text: str, file: str) -> Tokens:
    """Tokens with NETWORK and END_NETWORK as keywords, and names of the same unit in quotes; every place stays."""
    tokens = tokenize(text, file)
    kinds, texts = tokens.kinds, tokens.texts
    own = [
        at
        for at in range(len(kinds) - 2)
        if texts[at] == "_" and kinds[at + 1] == "." and kinds[at + 2] in {NAME, QUOTED} and not _behind_dot(kinds, at)
    ]
    if own:
        tokens = tokenize(_in_quotes(tokens, own), file)
        kinds, texts = tokens.kinds, tokens.texts
    for at, kind in enumerate(kinds):
        if kind == NAME and texts[at].upper() in {"NETWORK", "END_NETWORK"}:
            following = kinds[at + 1]
            if following not in _NO_KEYWORD and not _behind_dot(kinds, at):
                kinds[at] = texts[at].upper()
    return tokens


def _behind_dot(kinds: list[str], at: int) -> bool:
    return at > 0 and kinds[at - 1] == "."


def _in_quotes(tokens: Tokens, own: Iterable[int]) -> str:
    """The text with ``"name"`` for ``_.name`` and for ``_."name"``: as many characters, the rest blanks."""
    pieces: list[str] = []
    done = 0
    for at in own:
        begin, end = tokens.starts[at], tokens.end(at + 2)
        name = tokens.texts[at + 2]
        shown = name if tokens.kinds[at + 2] == QUOTED else f'"{name}"'
        pieces += [tokens.source[done:begin], shown.rjust(end - begin)]
        done = end
    return "".join([*pieces, tokens.source[done:]])


@dataclass(frozen=True, slots=True)
class Header:
    """What the attributes in front of a block say, in the words of SCL."""

    attributes: tuple[ast.Attribute, ...] = ()
    properties: tuple[tuple[str, str], ...] = ()
    flags: tuple[str, ...] = ()
    comment: str = ""

    @classmethod
    def of(cls, keyword: str, given: Iterable[ast.Attribute], texts: Mapping[str, str]) -> Header:
        """``texts`` are the words by key. A data block keeps its values only if it says so."""
        kept: list[ast.Attribute] = []
        properties: list[tuple[str, str]] = []
        comment, retain = "", False
        for one in given:
            if one.name in _PROPERTIES:
                properties.append((_PROPERTIES[one.name], one.value))
            elif one.name == _TITLE:
                properties.append(("TITLE", texts.get(one.value, "")))
            elif one.name in {_COMMENT, TEXT}:
                comment = texts.get(one.value, "")
            elif one.name == _RETAIN:
                retain = one.value.upper() == "TRUE"
            elif one.name not in _OF_THE_EDITOR:
                kept.append(ast.Attribute(one.start, one.end, _HEADER.get(one.name, one.name), one.value))
        flags = ("NON_RETAIN",) if keyword == "DATA_BLOCK" and not retain else ()
        return cls(tuple(kept), tuple(properties), flags, comment)


def of_member(given: Iterable[ast.Attribute], texts: Mapping[str, str]) -> tuple[tuple[ast.Attribute, ...], str]:
    """The attributes of a member in the words of SCL, and its comment."""
    kept: list[ast.Attribute] = []
    comment = ""
    for one in given:
        value, name = _NO_WRITING.get(one.name.upper(), ("", ""))
        if one.name == TEXT:
            comment = texts.get(one.value, "")
        elif value and one.value.upper().startswith(value):
            kept.append(ast.Attribute(one.start, one.end, name, "False"))
        else:
            kept.append(one)
    return tuple(kept), comment


@dataclass(slots=True, eq=False)
class Networks:
    """The networks of a block: SCL is read, what is drawn is kept as text to compare."""

    cursor: Cursor
    statements: Statements

    def read(self) -> tuple[ast.Network, ...]:
        """All networks up to the end of the block."""
        cursor = self.cursor
        found: list[ast.Network] = []
        while True:
            start = cursor.start
            attributes = cursor.attributes()
            if not cursor.accept("NETWORK"):
                if not attributes:
                    return tuple(found)
                cursor.report(cursor.expected("NETWORK"))
            found.append(self.network(start, attributes))

    def network(self, start: int, attributes: tuple[ast.Attribute, ...]) -> ast.Network:
        """One network behind its first word."""
        cursor = self.cursor
        said = next((one.value for one in attributes if one.name == "S7_Language"), "")
        language = said or ("LAD" if cursor.upper() == "RUNG" else SCL)
        begin, drawn = cursor.last_end, False
        body: ast.Body = ()
        if language.upper() == SCL:
            body = self.scl()
        else:
            drawn = self.rungs()
        inside = begin, cursor.start
        if not cursor.accept("END_NETWORK"):
            cursor.report(cursor.expected("END_NETWORK"))
        return ast.Network(start, cursor.last_end, language, attributes, body, drawn, inside)

    def scl(self) -> ast.Body:
        """Statements up to the end of the network; a stray END costs one message."""
        cursor = self.cursor
        found: list[ast.Statement] = []
        while True:
            found.extend(self.statements.body())
            kind = cursor.kinds[cursor.pos]
            if kind in _NETWORK_ENDS:
                return tuple(found)
            cursor.report(cursor.fault(f"{kind} without its beginning"))
            cursor.pos += 1
            cursor.accept(";")

    def rungs(self) -> bool:
        """Step over what is drawn; whether there is more than an empty rung. RUNG and brackets must be closed."""
        cursor = self.cursor
        begin, rung, drawn = cursor.start, -1, False
        brackets: list[int] = []
        while (kind := cursor.kinds[cursor.pos]) not in _NETWORK_ENDS:
            word = cursor.upper()
            if word == "RUNG":
                if rung >= 0:
                    self.unclosed(rung, "RUNG without END_RUNG")
                rung = cursor.pos
            elif word == "END_RUNG":
                if rung < 0:
                    self.unclosed(cursor.pos, "END_RUNG without RUNG")
                if brackets:
                    self.unclosed(brackets[0], "the bracket is not closed")
                    brackets.clear()
                rung = -1
            elif kind in {"(", "[", "{"}:
                brackets.append(cursor.pos)
            elif kind in {")", "]", "}"}:
                if not brackets:
                    self.unclosed(cursor.pos, "the bracket was not opened")
                else:
                    brackets.pop()
            drawn = drawn or not (word in {"RUNG", "END_RUNG"} or cursor.texts[cursor.pos].startswith("wire#"))
            cursor.pos += 1
        if rung >= 0:
            self.unclosed(rung, "RUNG without END_RUNG")
        cursor.free_text.append((begin, cursor.start))
        return drawn

    def unclosed(self, at: int, message: str) -> None:
        """PG801 at a token."""
        cursor = self.cursor
        cursor.report(cursor.diagnostic(message, cursor.starts[at], cursor.tokens.end(at)))


_NETWORK_ENDS = UNIT_ENDS | UNITS | {"NETWORK", "END_NETWORK", EOF}
