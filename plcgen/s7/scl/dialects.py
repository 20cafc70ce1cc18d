"""What the compiler of a dialect refuses although the grammar accepts it: PG803, over tokens and tree."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from itertools import islice

from plcgen.base.diagnostics import Diagnostic, Severity
from plcgen.s7.scl import ast
from plcgen.s7.scl.cursor import MAX_ERRORS
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.instructions import BY_NUMBER, ON_S7_1500, SYSTEM_TYPES
from plcgen.s7.scl.lexer import ADDRESS, KEYWORDS, LOCAL, QUOTED, REAL, TYPED, Tokens
from plcgen.s7.types.blocks import optimized
from plcgen.s7.types.data_types import elementary

Refusal = tuple[int, int, str, str, Severity]
"""Start and end offset, what is refused, how to write it instead, and how bad it is."""

_V5, _T3, _T15 = Dialect.STEP7_V5, Dialect.TIA_300_400, Dialect.TIA_1200_1500
_CLASSIC = frozenset({_V5, _T3})

_WIDE_TYPES = frozenset(
    """LWORD LINT ULINT LREAL LTIME LTOD LTIME_OF_DAY LDT DATE_AND_LTIME DTL SINT USINT UINT UDINT
    WCHAR WSTRING VARIANT HW_IO HW_ANY HW_DEVICE HW_SUBMODULE HW_INTERFACE PORT DB_ANY""".split()
)
"""Types that the S7-300/400 do not have."""
_PEEKS = frozenset({"PEEK", "PEEK_BOOL", "PEEK_BYTE", "PEEK_WORD", "PEEK_DWORD", "POKE", "POKE_BOOL", "POKE_BLK"})
_MEMORY = frozenset(
    area + width
    for area in ("I", "Q", "M", "E", "A", "PI", "PQ", "PE", "PA")
    for width in ("", "X", "B", "W", "D")
    if area + width not in {"PI", "PQ", "PE", "PA"}
)
_INDEXED = frozenset({"DB", "DX", "DW", "DD", "DBX", "DBB", "DBW", "DBD"})
_NUMBERED = re.compile(r"(?:DB|T|C|Z)[0-9]{1,5}")
_JOINED = re.compile(r"(?i:VAR_(?:CONSTANT|STAT(?:IC)?|RETAIN)\b)")
_V5_NAMES = {"OK": ("the OK flag", "use ENO"), "NIL": ("NIL", "write NULL")}
_RESERVED = frozenset("COUNTER TIMER NAME VALUE DATE VERSION AUTHOR FAMILY TITLE NULL EN ENO IN OUT".split())
_LIBRARY = frozenset({"InstructionName", "OriginalPartName"})
_SYSTEM_BLOCK = re.compile(r"SFB[0-9]{1,3}")
_VERSIONS = {"WRREC": "1.1", "RDREC": "1.0"}
"""Library versions in public exports of the TIA Portal V17."""
_SYSTEM_FUNCTION = re.compile(r"SFC[0-9]{1,3}")
_MODERN = frozenset(
    """COUNTOFELEMENTS VARIANTGET VARIANTPUT TYPEOF TYPEOFELEMENTS TYPEOFDB IS_ARRAY MOVE_BLK_VARIANT SERIALIZE
    DESERIALIZE REF LOWER_BOUND UPPER_BOUND GETSYMBOLNAME GETSYMBOLPATH GETINSTANCENAME GETINSTANCEPATH
    GETBLOCKNAME VARIANT_TO_DB_ANY DB_ANY_TO_VARIANT EQ_TYPE NE_TYPE EQ_ELEMTYPE NE_ELEMTYPE""".split()
)
"""Functions over VARIANT, references and symbols."""
_BLOCK_FUNCTIONS = frozenset({"WORD_TO_BLOCK_DB", "BLOCK_DB_TO_WORD"})


def tree(units: Sequence[ast.Unit], tokens: Tokens, dialect: Dialect) -> Iterator[Refusal]:
    """Find constructs that show in the tree only."""
    blocks = frozenset(unit.name.upper() for unit in units)
    for unit in units:
        yield from _header(unit, dialect)
        for section in unit.sections:
            yield from _section(unit, section, tokens, dialect)
        at_refused = _optimized_declarations(unit) if dialect is _T15 else frozenset()
        declared = _declared(unit)
        overlays = _overlays(unit) if dialect is _T15 else {}
        for node in ast.walk(unit):
            if isinstance(node, ast.CallStatement):
                yield from _call_statement(node, tokens, dialect)
            elif isinstance(node, ast.Call | ast.Index) and unit.keyword != "DATA_BLOCK":
                yield from _absolute(node, dialect, declared | blocks)
            elif isinstance(node, ast.Name):
                yield from _name(node, dialect, declared)
            elif isinstance(node, ast.Argument):
                if node.operator == ":=" and isinstance(node.value, ast.Omitted):
                    text = "leave the parameter out or give it a value"
                    yield node.start, node.end, f"{node.name} without a value", text, Severity.WARNING
            elif isinstance(node, ast.ArraySpec):
                yield from _array(node, dialect)
            elif isinstance(node, ast.Slice):
                yield from _slice(node, overlays)
            elif isinstance(node, ast.ReferenceSpec | ast.Dereference):
                if dialect in _CLASSIC:
                    yield node.start, node.end, "references", "pass the variable as an IN_OUT parameter", Severity.ERROR
            elif isinstance(node, ast.Attribute):
                if dialect is _V5 and node.name in _LIBRARY:
                    text = "name the block by its number, such as SFB53"
                    yield node.start, node.end, f"the attribute {node.name}", text, Severity.ERROR
            elif isinstance(node, ast.TypeName | ast.StringSpec):
                yield from _type(node, dialect)
            elif isinstance(node, ast.Declaration):
                if node.at is not None and id(node) in at_refused:
                    text = "add { S7_Optimized_Access := 'FALSE' } to the block"
                    yield node.start, node.end, "AT in a block with optimized access", text, Severity.ERROR
                elif node.at is not None and _bits(node) > overlays.get(node.at.upper(), 1 << 30) > 0:
                    text = "make the variable below at least as wide"
                    yield node.start, node.end, "a view with AT that is wider than its variable", text, Severity.ERROR
            elif isinstance(node, ast.Assign) and node.also and dialect in _CLASSIC:
                yield node.start, node.end, "several targets in one assignment", "write one each", Severity.ERROR


def _header(unit: ast.Unit, dialect: Dialect) -> Iterator[Refusal]:
    for attribute in unit.attributes:
        if dialect is _V5 and attribute.name == "S7_Optimized_Access":
            yield attribute.start, attribute.end, attribute.name, "delete the attribute", Severity.ERROR


def _bits(declaration: ast.Declaration) -> int:
    """Width of an elementary type, 0 for any other."""
    spec = declaration.type
    found = elementary(spec.name) if isinstance(spec, ast.TypeName) and not spec.quoted else None
    return found.bits if found is not None else 0


def _overlays(unit: ast.Unit) -> dict[str, int]:
    """Widths of the variables of a block by upper-case name, -1 for views with AT."""
    return {
        name.name.upper(): -1 if declaration.at is not None else _bits(declaration)
        for section in unit.sections
        for declaration in section.declarations
        for name in declaration.names
    }


def _array(node: ast.ArraySpec, dialect: Dialect) -> Iterator[Refusal]:
    if dialect.is_tia and isinstance(node.element, ast.ArraySpec):
        yield node.start, node.end, "arrays of arrays", "use one array with two dimensions", Severity.ERROR
    if not node.bounds and dialect in _CLASSIC:
        yield node.start, node.end, "ARRAY[*]", "write the bounds", Severity.ERROR


def _slice(node: ast.Slice, overlays: dict[str, int]) -> Iterator[Refusal]:
    base = node.base
    if isinstance(base, ast.Name) and base.scope != QUOTED and overlays.get(base.name.upper()) == -1:
        text = "take the slice of the variable below the view"
        yield node.start, node.end, "a slice of a view with AT", text, Severity.ERROR


def _section(unit: ast.Unit, section: ast.Section, tokens: Tokens, dialect: Dialect) -> Iterator[Refusal]:
    if unit.keyword == "TYPE":
        if dialect is not _T15:
            yield section.start, section.end, "named values of a type", "use constants of the block", Severity.ERROR
        return
    if dialect is _V5 and section.keyword == "VAR" and unit.keyword == "DATA_BLOCK":
        text = "write STRUCT .. END_STRUCT"
        yield section.start, section.start + 3, "VAR in a data block", text, Severity.ERROR
    elif dialect is _V5 and {"RETAIN", "NON_RETAIN"} & set(section.modifiers):
        text = "write VAR without it: all variables of an FB are retentive if the data block is"
        yield section.start, section.start + len(section.keyword), f"VAR {section.modifiers[0]}", text, Severity.ERROR
    joined = _JOINED.match(tokens.source, section.start)
    if joined:
        text = "write VAR" + f" {' '.join(section.modifiers)}".rstrip()
        yield section.start, joined.end(), joined[0], text, Severity.ERROR
    if "CONSTANT" not in section.modifiers:
        return
    if dialect is _V5 and not joined:
        what = "VAR CONSTANT"
        yield section.start, section.start + 3, what, "use CONST .. END_CONST without types", Severity.ERROR
        return
    for declaration in section.declarations:
        value = declaration.initial
        if isinstance(value, ast.Binary):
            text = "write the result"
            yield value.start, value.end, "expressions as the value of a constant", text, Severity.ERROR


def _declared(unit: ast.Unit) -> frozenset[str]:
    """Upper-case names of the parameters and variables of a block."""
    found = (name.name.upper() for s in unit.sections for d in s.declarations for name in d.names)
    return frozenset(found)


def _optimized_declarations(unit: ast.Unit) -> frozenset[int]:
    """Identities of the declarations in optimized memory; DB_SPECIFIC lays them out as in standard blocks."""
    values = [a.value.upper() == "TRUE" for a in unit.attributes if a.name == "S7_Optimized_Access"]
    if not (values[0] if len(values) == 1 else optimized(classic=False)):
        return frozenset()
    return frozenset(id(d) for s in unit.sections if "DB_SPECIFIC" not in s.modifiers for d in s.declarations)


def _name(node: ast.Name, dialect: Dialect, declared: frozenset[str]) -> Iterator[Refusal]:
    """Find names that only STEP 7 V5 knows, unless the block declares them itself."""
    upper = node.name.upper()
    if dialect.is_tia and node.scope == "bare" and upper in _V5_NAMES and upper not in declared:
        what, text = _V5_NAMES[upper]
        yield node.start, node.end, what, text, Severity.ERROR
    if dialect is _V5 and node.scope == "bare" and upper == "NULL" and upper not in declared:
        yield node.start, node.end, "NULL", "write NIL", Severity.ERROR
    if dialect.is_tia and node.scope == "bare" and _NUMBERED.fullmatch(upper) and upper not in declared:
        yield node.start, node.end, f"{node.name} without %", f"write %{node.name}", Severity.WARNING
    if dialect is _T15 and node.scope == "bare" and upper in _BLOCK_FUNCTIONS:
        yield node.start, node.end, node.name, "use PEEK and POKE with dbNumber", Severity.ERROR


def _type(node: ast.TypeName | ast.StringSpec, dialect: Dialect) -> Iterator[Refusal]:
    quoted = isinstance(node, ast.TypeName) and node.quoted
    if not quoted and is_refused(node.name, dialect):
        yield node.start, node.end, f"the type {node.name}", "", Severity.ERROR
    if dialect is _T15 and not quoted and _SYSTEM_BLOCK.fullmatch(node.name.upper()):
        text = _instruction_of(node.name.upper())
        yield node.start, node.end, f"the type {node.name}", text, Severity.ERROR


def is_refused(type_name: str, dialect: Dialect) -> bool:
    """Whether a target does not have a type of the language."""
    return dialect in _CLASSIC and type_name.upper() in _WIDE_TYPES


def _instruction_of(number: str) -> str:
    """How to write a system block by its instruction."""
    name = BY_NUMBER.get(number)
    if name is None:
        return "name the instruction that replaces it"
    if name not in _VERSIONS:
        return f"name the instruction: {name}"
    return f"name the instruction: {{InstructionName := '{name}'; LibVersion := '{_VERSIONS[name]}'}} {name}"


def _call_statement(node: ast.CallStatement, tokens: Tokens, dialect: Dialect) -> Iterator[Refusal]:
    """Find ``"FB"."DB"(..)`` and ``SFB53.DB53(..)`` in the TIA Portal.

    An instance inside a DB is called like that too, but has quotes only where its name needs them.
    """
    target = node.call.target
    if not dialect.is_tia or not isinstance(target, ast.Member) or not isinstance(target.base, ast.Name):
        return
    base = target.base
    numbered = base.scope == "bare" and base.name.upper().startswith(("FB", "SFB")) and base.name[-1].isdigit()
    quoted = tokens.source[target.end - 1] == '"' and not _is_reserved(target.name)
    instance = (quoted and target.name.isidentifier()) or (not quoted and _is_db(target.name))
    if numbered or (base.scope == QUOTED and instance):
        what = "a call with function block and instance DB"
        yield target.start, target.end, what, f'write "{target.name}"(..)', Severity.ERROR


def _is_reserved(name: str) -> bool:
    """Whether the TIA Portal writes quotes around a member because its name is a word of the language."""
    upper = name.upper()
    return upper in KEYWORDS or upper in SYSTEM_TYPES or upper in _RESERVED or elementary(name) is not None


def _absolute(node: ast.Call | ast.Index, dialect: Dialect, declared: frozenset[str]) -> Iterator[Refusal]:
    """PEEK and POKE outside S7-1200/1500, indexed absolute access inside."""
    inner = node.target if isinstance(node, ast.Call) else node.base
    if isinstance(inner, ast.Name):
        if inner.scope == "bare" and inner.name.upper() in _PEEKS and dialect in _CLASSIC:
            text = "use DB100.DW[i]" if dialect is _V5 else "use %DB1.DW(IDX := #i)"
            yield inner.start, inner.end, inner.name, text, Severity.ERROR
        elif inner.scope == "bare" and isinstance(node, ast.Call) and inner.name.upper() not in declared:
            yield from _function(inner, dialect)
        elif dialect is _T15 and isinstance(node, ast.Index) and _is_memory(inner, declared):
            text = "use PEEK and POKE with area 16#81 (inputs), 16#82 (outputs) or 16#83 (memory)"
            yield node.start, node.end, "indexed absolute access", text, Severity.ERROR
    elif dialect is _T15 and (isinstance(inner, ast.Address) or _is_indexed(inner)):
        text = "use PEEK and POKE: area 16#84 for a data block, 16#81 inputs, 16#82 outputs, 16#83 memory"
        yield node.start, node.end, "indexed absolute access", text, Severity.ERROR


def _function(target: ast.Name, dialect: Dialect) -> Iterator[Refusal]:
    """Find functions by number in the TIA Portal, and those that only the S7-1200/1500 have elsewhere."""
    upper = target.name.upper()
    if dialect.is_tia and _SYSTEM_FUNCTION.fullmatch(upper):
        name = BY_NUMBER.get(upper)
        text = f"write {name}(..)" if name else "write the name of the instruction"
        text = ON_S7_1500.get(name or "", text) if dialect is _T15 else text
        yield target.start, target.end, target.name, text, Severity.ERROR
    source, _, result = upper.partition("_TO_")
    modern = upper in _MODERN or (bool(result) and not {source, result}.isdisjoint(_WIDE_TYPES))
    if dialect in _CLASSIC and modern:
        yield target.start, target.end, target.name, "", Severity.ERROR


def _is_memory(inner: ast.Name, declared: frozenset[str]) -> bool:
    upper = inner.name.upper()
    return inner.scope == "bare" and upper in _MEMORY and upper not in declared


def _is_indexed(inner: ast.Expression) -> bool:
    return (
        isinstance(inner, ast.Member)
        and inner.name.upper() in _INDEXED
        and isinstance(inner.base, ast.Name)
        and inner.base.scope == "bare"
        and _is_db(inner.base.name)
    )


def _is_db(name: str) -> bool:
    return name[:2].upper() == "DB" and name[2:].isdigit()


_TIA = frozenset({_T3, _T15})

_WIDE_PREFIXES = frozenset(
    "LT LTIME LTOD LTIME_OF_DAY LDT DTL WSTRING WCHAR LW LWORD LINT ULINT LREAL SINT USINT UINT UDINT".split()
)
_KEYWORDS: dict[str, tuple[frozenset[Dialect], str, str]] = {
    "LABEL": (_TIA, "LABEL sections", "delete the section, a label needs no declaration"),
    "CONST": (_TIA, "CONST sections", "use VAR CONSTANT with a type"),
    "DIV": (_TIA, "the operator DIV", "use /, which divides integers as integers"),
    "REGION": (frozenset({_V5}), "REGION", "use a comment"),
    "=>": (frozenset({_V5}), "=>", "read the output from the instance DB after the call"),
}
_COMBINED = frozenset({"+=", "-=", "*=", "/=", "&=", "**=", "?="})
_NAME_FOLLOWS = frozenset({":", ":=", "=>", ",", ".", "{", "[", ")", ";"})
"""Behind LABEL, CONST, DIV or REGION they show that the word is the name of a member or parameter."""
_PARAMETER_FOLLOWS = frozenset({":=", "=>"})
_SLASH_STAR = re.compile(r"(?<!\()/\*")


def check_dialect(
    units: Sequence[ast.Unit], tokens: Tokens, dialect: Dialect, free_text: Sequence[tuple[int, int]] = ()
) -> list[Diagnostic]:
    """PG803 for every construct that ``dialect`` refuses, up to a bound; ``free_text`` ranges are no code."""
    found = [
        *islice(_tokens(tokens, dialect, sorted(free_text)), MAX_ERRORS),
        *islice(tree(units, tokens, dialect), MAX_ERRORS),
        *islice(_comments(tokens), MAX_ERRORS),
    ]
    return [
        Diagnostic("PG803", f"{dialect.label} does not support {what}", tokens.span(start, end), severity, help=text)
        for start, end, what, text, severity in found
    ]


# --- tokens ----------------------------------------------------------------------------------------------


def _comments(tokens: Tokens) -> Iterator[Refusal]:
    """Find ``/* */`` without parentheses around it, which no Siemens compiler knows."""
    last = -1
    for match in _SLASH_STAR.finditer(tokens.source):
        index = bisect_right(tokens.starts, match.start())
        if index == last or (index and match.start() < tokens.end(index - 1)):
            continue
        last = index
        for comment in tokens.trivia_before(index):
            if comment.text.startswith("/*"):
                yield comment.start, comment.start + 2, "comments in /* */", "write (* *)", Severity.ERROR


def _tokens(tokens: Tokens, dialect: Dialect, free: Sequence[tuple[int, int]]) -> Iterator[Refusal]:
    """Find constructs that one token gives away."""
    suspects = {LOCAL, ADDRESS, TYPED, REAL, *_COMBINED, *_KEYWORDS}
    ranges = iter(free)
    current = next(ranges, None)
    for index, kind in enumerate(tokens.kinds):
        if kind not in suspects:
            continue
        start = tokens.starts[index]
        while current is not None and start >= current[1]:
            current = next(ranges, None)
        if current is not None and current[0] <= start:
            continue
        before = tokens.kinds[index - 1] if index else ""
        if _is_name(kind, before, tokens.kinds[index + 1]):
            continue
        refusal = _token(kind, tokens.texts[index], dialect, after_dot=before == ".")
        if refusal is not None:
            what, text, severity = refusal
            yield start, tokens.end(index), what, text, severity


def _is_name(kind: str, before: str, following: str) -> bool:
    """Whether a keyword or address is a name: of a member, a declaration, or a parameter in a call."""
    if kind == ADDRESS:
        return following in {":", "{"} or (before in {"(", ","} and following in _PARAMETER_FOLLOWS)
    return kind in _KEYWORDS and kind.isalpha() and (before == "." or following in _NAME_FOLLOWS)


def _token(kind: str, text: str, dialect: Dialect, *, after_dot: bool) -> tuple[str, str, Severity] | None:
    """Tell what is refused about one token, how to write it instead, and how bad it is."""
    if kind == LOCAL:
        return ("'#' before a local variable", "leave the # out", Severity.ERROR) if dialect is _V5 else None
    if kind == ADDRESS:
        if after_dot:
            if text[:3].upper() == "%DB":
                return (f"'%' in .{text}", "leave the % out", Severity.ERROR) if dialect is _V5 else None
            slices = text[0] == "%" and dialect in _CLASSIC
            return (f"the slice .{text}", "lay a view over the variable with AT", Severity.ERROR) if slices else None
        if text[0] == "%":
            return (f"'%' in {text}", "leave the % out", Severity.ERROR) if dialect is _V5 else None
        if dialect.is_tia:
            return f"{text} without %", f"write %{text}", Severity.WARNING
        return None
    if kind == TYPED:
        wide = text.partition("#")[0].upper() in _WIDE_PREFIXES
        return (f"the literal {text}", "", Severity.ERROR) if wide and dialect in _CLASSIC else None
    if kind == REAL:
        bare = "." not in text and dialect.is_tia
        return (f"the literal {text}", f"write {_with_point(text)}", Severity.ERROR) if bare else None
    if kind in _COMBINED:
        return (f"'{kind}'", "write target := target ...", Severity.ERROR) if dialect in _CLASSIC else None
    refused, what, help_text = _KEYWORDS[kind]
    return (what, help_text, Severity.ERROR) if dialect in refused else None


def _with_point(text: str) -> str:
    upper = text.upper()
    return text[: upper.index("E")] + ".0" + text[upper.index("E") :]
