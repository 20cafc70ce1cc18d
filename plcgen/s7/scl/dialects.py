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
from plcgen.s7.scl.dialects_tree import Refusal, tree
from plcgen.s7.scl.lexer import ADDRESS, LOCAL, REAL, TYPED, Tokens

_V5, _T3, _T15 = Dialect.STEP7_V5, Dialect.TIA_300_400, Dialect.TIA_1200_1500
_CLASSIC = frozenset({_V5, _T3})
_TIA = frozenset({_T3, _T15})

_WIDE_PREFIXES = frozenset(
    "LT LTIME LTOD LTIME_OF_DAY LDT DTL WSTRING WCHAR LW LWORD LINT ULINT LREAL SINT USINT UINT UDINT".split()  # noqa: SIM905
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
        return _address(text, dialect, after_dot=after_dot)
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


def _address(text: str, dialect: Dialect, *, after_dot: bool) -> tuple[str, str, Severity] | None:
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


def _with_point(text: str) -> str:
    upper = text.upper()
    return text[: upper.index("E")] + ".0" + text[upper.index("E") :]
