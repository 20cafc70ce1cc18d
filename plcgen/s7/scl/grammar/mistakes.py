"""What is no SCL but is written: misspelt keywords, operators and constructs of other languages, headers that fail."""

from __future__ import annotations

from difflib import get_close_matches

from plcgen.s7.scl.cursor import Cursor, SyntaxFault
from plcgen.s7.scl.lexer import EOF, INT, NAME, QUOTED, WORDS

SECTIONS = frozenset({"VAR", "VAR_INPUT", "VAR_OUTPUT", "VAR_IN_OUT", "VAR_TEMP", "CONST", "LABEL"})
UNITS = frozenset({"FUNCTION_BLOCK", "FUNCTION", "ORGANIZATION_BLOCK", "DATA_BLOCK", "TYPE"})
UNIT_ENDS = frozenset("END_" + keyword for keyword in UNITS)

CLOSERS = frozenset({"END_IF", "END_CASE", "END_FOR", "END_WHILE", "END_REPEAT", "END_REGION", "UNTIL"})
STOPS = CLOSERS | {"ELSIF", "ELSE", "NETWORK", "END_NETWORK", EOF} | UNIT_ENDS | UNITS
"""Where a list of statements ends; only a SIMATIC SD document has tokens of the kinds NETWORK and END_NETWORK."""
STARTS = frozenset({"IF", "CASE", "FOR", "WHILE", "REPEAT", "EXIT", "CONTINUE", "RETURN", "GOTO", "REGION"})
CODE = STOPS | STARTS
"""Keywords that belong to statements, so that nothing else reaches across them."""


_STATEMENTS = """IF ELSIF ELSE END_IF CASE END_CASE FOR END_FOR WHILE END_WHILE REPEAT UNTIL END_REPEAT EXIT CONTINUE
    RETURN GOTO REGION END_REGION END_FUNCTION_BLOCK END_FUNCTION END_ORGANIZATION_BLOCK END_DATA_BLOCK
    END_TYPE""".split()
_UNITS = "FUNCTION_BLOCK FUNCTION ORGANIZATION_BLOCK DATA_BLOCK TYPE".split()
_SECTIONS = "VAR VAR_INPUT VAR_OUTPUT VAR_IN_OUT VAR_TEMP CONST END_VAR END_CONST BEGIN".split()
_OTHER_LANGUAGES = {"BREAK": "EXIT", "ELIF": "ELSIF", "SWITCH": "CASE", "NEXT": "CONTINUE", "JMP": "GOTO"}
_BLOCK_ENDS = frozenset({EOF, *(f"END_{unit}" for unit in _UNITS)})
_LONG = 5
_SIMILAR = 0.8
_OPERATORS = {
    ("=", "="): "write '=' once", ("=", "<"): "write '<='", ("=", ">"): "write '>='", ("&", "&"): "write AND",
    ("<", "="): "write '<='", (">", "="): "write '>='", (">", "<"): "write '<>'", ("*", "/"): "a comment ends here",
    (":=", "="): "write ':=' once",
}  # fmt: skip
"""Two operators in a row that other languages have, or that were turned around."""
_ASSIGNMENTS = {
    (":", "="): "write ':=' without a space", ("+", "+"): "write x := x + 1", ("-", "-"): "write x := x - 1",
    ("=", ":"): "write ':='",
}  # fmt: skip


def _letters(word: str) -> list[str]:
    return sorted(word.replace("_", ""))


def _meant(word: str, keywords: list[str]) -> str:
    """Return the keyword a misspelt word stands for, else an empty string."""
    if word in _OTHER_LANGUAGES and _OTHER_LANGUAGES[word] in keywords:
        return _OTHER_LANGUAGES[word]
    for keyword in keywords:
        if _letters(word) == _letters(keyword):
            return keyword
    near = (
        get_close_matches(word, keywords, n=1, cutoff=_SIMILAR) if _LONG <= len(word) <= max(map(len, keywords)) else []
    )
    return near[0] if near else ""


def rename(cursor: Cursor, index: int, keyword: str) -> None:
    """Report a misspelt keyword and take it for the right one."""
    fault = cursor.fault(f"{cursor.texts[index]} is not a keyword", index=index, text=f"write {keyword}")
    cursor.kinds[index] = keyword
    cursor.report(fault)


def misspelt_statement(cursor: Cursor, began: int) -> bool:
    """Whether the statement that failed began with a misspelt keyword; it is read again then."""
    if cursor.kinds[began] != NAME:
        return False
    upper = cursor.texts[began].upper()
    following = cursor.kinds[began + 1]
    if upper == "END" and f"END_{following}" in _STATEMENTS:
        fault = cursor.fault(f"END {following} is written in one word", index=began, text=f"write END_{following}")
        cursor.kinds[began + 1] = f"END_{following}"
        cursor.pos = began + 1
        cursor.report(fault)
        return True
    keyword = _meant(upper, _STATEMENTS)
    if not keyword:
        return False
    cursor.pos = began
    rename(cursor, began, keyword)
    return True


def misspelt_section(cursor: Cursor) -> bool:
    """Whether a section begins here whose keyword is misspelt."""
    if cursor.kind(1) not in {NAME, QUOTED}:
        return False
    keyword = _meant(cursor.upper(), _SECTIONS)
    if keyword:
        rename(cursor, cursor.pos, keyword)
    return bool(keyword)


def misspelt_unit(cursor: Cursor) -> bool:
    """Whether a block begins here whose keyword is misspelt."""
    if cursor.kinds[cursor.pos] != NAME or cursor.kind(1) not in {NAME, QUOTED}:
        return False
    keyword = _meant(cursor.upper(), _UNITS)
    if keyword:
        rename(cursor, cursor.pos, keyword)
    return bool(keyword)


def braces(cursor: Cursor, keyword: str, closer: str) -> bool:
    """Whether a ``{`` stands where statements begin; the matching ``}`` is taken for the END then."""
    if cursor.kinds[cursor.pos] != "{" or (
        cursor.kind(1) in WORDS and cursor.kind(2) in {":=", "="} and keyword == "ELSE"
    ):
        return False
    fault = cursor.fault("SCL has no braces around statements", text=f"write {keyword} .. {closer}")
    index, depth = cursor.pos, 0
    while cursor.kinds[index] not in _BLOCK_ENDS:
        depth += (cursor.kinds[index] == "{") - (cursor.kinds[index] == "}")
        if not depth:
            cursor.kinds[index] = ";" if cursor.kinds[index + 1] in {"ELSE", "ELSIF"} else closer
            break
        index += 1
    cursor.pos += 1
    cursor.report(fault)
    return True


def wrong_assignment(cursor: Cursor) -> SyntaxFault:
    """Return the fault about what follows the target of an assignment."""
    kinds = cursor.kinds[cursor.pos], cursor.kind(1)
    text = _ASSIGNMENTS.get(kinds, "")
    if kinds[0] == "=" and not text:
        return cursor.fault("'=' compares, it does not assign", text="write ':='")
    return cursor.expected("':=' or '('", text)


def no_expression(cursor: Cursor) -> SyntaxFault:
    """Return the fault about a token that begins no expression."""
    before = cursor.kinds[cursor.pos - 1] if cursor.pos else ""
    return cursor.expected("an expression", _OPERATORS.get((before, cursor.kinds[cursor.pos]), ""))


def no_end(cursor: Cursor) -> SyntaxFault:
    """Return the fault about a token in place of a semicolon."""
    kind = cursor.kinds[cursor.pos]
    text = ""
    if kind in {")", "]"}:
        text = f"there is one '{kind}' more than opened"
    elif kind == "," and cursor.kinds[cursor.pos - 1] == INT and cursor.kind(1) == INT:
        text = f"write {cursor.texts[cursor.pos - 1]}.{cursor.texts[cursor.pos + 1]} with a point"
    return cursor.expected("';'", text)


_FOREIGN_UNITS = frozenset(
    {"CLASS", "INTERFACE", "METHOD", "PROPERTY", "ACTION", "PROGRAM", "CONFIGURATION", "RESOURCE"}
)
_INSIDE = frozenset({"METHOD", "PROPERTY", "ACTION"})
_ACCESS = frozenset({"PUBLIC", "PRIVATE", "PROTECTED", "INTERNAL", "ABSTRACT", "FINAL", "OVERRIDE"})
_INHERITANCE = frozenset({"EXTENDS", "IMPLEMENTS"})
FOREIGN_SECTIONS = frozenset({"VAR_EXTERNAL", "VAR_GLOBAL", "VAR_CONFIG", "VAR_ACCESS", "VAR_INST"})
_BLOCKS = frozenset({"END_FUNCTION_BLOCK", "END_FUNCTION", "END_DATA_BLOCK", "END_ORGANIZATION_BLOCK"})
_HELP = "that is the language of SIMATIC AX or CODESYS; plcgen reads the SCL of STEP 7 V5 and the TIA Portal"


def refuse(cursor: Cursor, index: int) -> None:
    """PG801 at a word of another dialect."""
    cursor.report(cursor.fault(f"SCL has no {cursor.texts[index].upper()}", index=index, text=_HELP))


def unit(cursor: Cursor) -> bool:
    """Step over ``CLASS .. END_CLASS`` and the like between blocks."""
    if cursor.upper() not in _FOREIGN_UNITS or cursor.kind(1) not in WORDS:
        return False
    skip(cursor)
    return True


def member(cursor: Cursor, began: int) -> bool:
    """Step over ``METHOD .. END_METHOD`` where a statement was read from token ``began`` on."""
    if cursor.kinds[began] != NAME or cursor.texts[began].upper() not in _INSIDE or cursor.kind(0) not in WORDS:
        return False
    cursor.pos = began
    skip(cursor)
    return True


def skip(cursor: Cursor) -> None:
    """Report the word at the position and go behind its END, or to the END of the block around it."""
    refuse(cursor, cursor.pos)
    closing = "END_" + cursor.upper()
    while cursor.kinds[cursor.pos] not in _BLOCKS and cursor.kinds[cursor.pos] != EOF:
        cursor.pos += 1
        if cursor.texts[cursor.pos - 1].upper() == closing:
            return


def skip_access(cursor: Cursor) -> None:
    """Step over PUBLIC, ABSTRACT and others in front of a name; the first one is reported."""
    first = True
    while cursor.upper() in _ACCESS and cursor.kind(1) in {NAME, QUOTED}:
        if first:
            refuse(cursor, cursor.pos)
        first = False
        cursor.pos += 1


def skip_inheritance(cursor: Cursor) -> None:
    """Step over ``EXTENDS a IMPLEMENTS b, c``."""
    while cursor.upper() in _INHERITANCE:
        refuse(cursor, cursor.pos)
        cursor.rest_of_line()
