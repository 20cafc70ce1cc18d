"""What engineers mistype: misspelt keywords, operators of other languages, headers of statements that fail."""

from __future__ import annotations

from difflib import get_close_matches

from plcgen.scl import ast
from plcgen.scl.cursor import Fault
from plcgen.scl.lexer import EOF, INT, NAME, QUOTED, WORDS
from plcgen.scl.parser_labels import LabelParser

_STATEMENTS = """IF ELSIF ELSE END_IF CASE END_CASE FOR END_FOR WHILE END_WHILE REPEAT UNTIL END_REPEAT EXIT CONTINUE
    RETURN GOTO REGION END_REGION END_FUNCTION_BLOCK END_FUNCTION END_ORGANIZATION_BLOCK END_DATA_BLOCK
    END_TYPE""".split()  # noqa: SIM905
_UNITS = "FUNCTION_BLOCK FUNCTION ORGANIZATION_BLOCK DATA_BLOCK TYPE".split()  # noqa: SIM905
_SECTIONS = "VAR VAR_INPUT VAR_OUTPUT VAR_IN_OUT VAR_TEMP CONST END_VAR END_CONST BEGIN".split()  # noqa: SIM905
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
    (":", "="): "write ':=' without a blank", ("+", "+"): "write x := x + 1", ("-", "-"): "write x := x - 1",
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


class RecoveryParser(LabelParser):
    """Goes on as if the right word stood there."""

    def rename(self, index: int, keyword: str) -> None:
        """Report a misspelt keyword and take it for the right one."""
        fault = self.fault(f"{self.texts[index]} is no keyword", index=index, text=f"write {keyword}")
        self.kinds[index] = keyword
        self.report(fault.diagnostic)

    def misspelt_statement(self, began: int) -> bool:
        """Whether the statement that failed began with a misspelt keyword; it is read again then."""
        if self.kinds[began] != NAME:
            return False
        upper = self.texts[began].upper()
        following = self.kinds[began + 1]
        if upper == "END" and f"END_{following}" in _STATEMENTS:
            fault = self.fault(f"END {following} is written in one word", index=began, text=f"write END_{following}")
            self.kinds[began + 1] = f"END_{following}"
            self.pos = began + 1
            self.report(fault.diagnostic)
            return True
        keyword = _meant(upper, _STATEMENTS)
        if not keyword:
            return False
        self.pos = began
        self.rename(began, keyword)
        return True

    def misspelt_section(self) -> bool:
        """Whether a section begins here whose keyword is misspelt."""
        if self.kind(1) not in {NAME, QUOTED}:
            return False
        keyword = _meant(self.upper(), _SECTIONS)
        if keyword:
            self.rename(self.pos, keyword)
        return bool(keyword)

    def misspelt_unit(self) -> bool:
        """Whether a block begins here whose keyword is misspelt."""
        if self.kinds[self.pos] != NAME or self.kind(1) not in {NAME, QUOTED}:
            return False
        keyword = _meant(self.upper(), _UNITS)
        if keyword:
            self.rename(self.pos, keyword)
        return bool(keyword)

    def braces(self, keyword: str, closer: str) -> bool:
        """Whether a ``{`` stands where statements begin; the matching ``}`` is taken for the END then."""
        if self.kinds[self.pos] != "{" or (self.kind(1) in WORDS and self.kind(2) in {":=", "="} and keyword == "ELSE"):
            return False
        fault = self.fault("SCL has no braces around statements", text=f"write {keyword} .. {closer}")
        index, depth = self.pos, 0
        while self.kinds[index] not in _BLOCK_ENDS:
            depth += (self.kinds[index] == "{") - (self.kinds[index] == "}")
            if not depth:
                self.kinds[index] = ";" if self.kinds[index + 1] in {"ELSE", "ELSIF"} else closer
                break
            index += 1
        self.pos += 1
        self.report(fault.diagnostic)
        return True

    def wrong_assignment(self) -> Fault:
        """Return the fault about what follows the target of an assignment."""
        kinds = self.kinds[self.pos], self.kind(1)
        text = _ASSIGNMENTS.get(kinds, "")
        if kinds[0] == "=" and not text:
            return self.fault("'=' compares, it does not assign", text="write ':='")
        return self.expected("':=' or '('", text)

    def no_expression(self) -> Fault:
        """Return the fault about a token that begins no expression."""
        before = self.kinds[self.pos - 1] if self.pos else ""
        return self.expected("an expression", _OPERATORS.get((before, self.kinds[self.pos]), ""))

    def no_end(self) -> Fault:
        """Return the fault about a token in place of a semicolon."""
        kind = self.kinds[self.pos]
        text = ""
        if kind in {")", "]"}:
            text = f"there is one '{kind}' more than opened"
        elif kind == "," and self.kinds[self.pos - 1] == INT and self.kind(1) == INT:
            text = f"write {self.texts[self.pos - 1]}.{self.texts[self.pos + 1]} with a point"
        return self.expected("';'", text)

    def condition(self, closing: str, stops: frozenset[str]) -> ast.Expression:
        """Read the condition in front of THEN, DO or OF; a fault in it costs the condition only."""
        start, depth = self.start, self.depth
        try:
            return self.expression()
        except Fault as fault:
            if type(fault) is not Fault:
                raise
            self.skip_header(fault, closing, stops, depth)
            return ast.Literal(start, self.start, "TRUE", "bool")

    def skip_header(self, fault: Fault, closing: str, stops: frozenset[str], depth: int) -> None:
        """Go to THEN, DO or OF of the statement whose header failed; without one the statement fails."""
        index = self.pos
        while (kind := self.kinds[index]) not in stops and kind not in {closing, ";", EOF}:
            index += 1
        if kind != closing:
            raise fault
        self.depth = depth
        self.pos = index
        self.report(fault.diagnostic)
