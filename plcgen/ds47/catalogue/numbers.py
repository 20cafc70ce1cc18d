"""Numbers as lists have them: decimal point or comma, thousands grouped or not, the number of an enumeration.

``12,500`` alone may be twelve and a half or twelve thousand five hundred: the other numbers of the list decide, and if
none of them shows which sign is the decimal one, it is no number.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from plcgen.base.files.workbook import Numeral

_PLAIN = re.compile(r"[+-]?([0-9]{1,15})(?:([.,])([0-9]{1,15}))?([eE][+-]?[0-9]{1,2})?\Z")
_GROUPED = re.compile(r"[+-]?[1-9][0-9]{0,2}([.,' ])[0-9]{3}((?:\1[0-9]{3}){0,4})(?:(?!\1)([.,])[0-9]{1,15})?\Z")
_CHOICE = re.compile(r"\[([+-]?[0-9]{1,9})\](?: .*)?\Z")
"""``[31] Ready for switching on``: the windows of the programs show the number of an enumeration before its text."""
_DIGITS = re.compile(r"[+-]?[0-9][0-9.,' ]*\Z")
_OTHER = {".": ",", ",": "."}


def decimal_sign(cells: Iterable[str]) -> str:
    """The decimal sign that the numbers of a list show; empty if they show none, or both."""
    shown = {_shown(_spelled(cell)) for cell in cells if not isinstance(cell, Numeral)} - {""}
    return shown.pop() if len(shown) == 1 else ""


def number(text: str, decimal: str) -> float | None:
    """The number that a cell has; None if it is none, or if ``decimal`` is needed and empty."""
    text = _spelled(text)
    choice = _CHOICE.match(text)
    if choice:
        return float(choice[1])
    plain, grouped = _PLAIN.match(text), _GROUPED.match(text)
    if plain and not plain[2]:
        return float(text)
    sign = "." if isinstance(text, Numeral) else _shown(text) or decimal
    if not sign and grouped and grouped[1] in "' ":
        sign = "."
    if not sign or not (grouped or (plain and plain[2] == sign)):
        return None
    for separator in (_OTHER[sign], "'", " "):
        text = text.replace(separator, "")
    return float(text.replace(sign, "."))


def looks_like_number(text: str) -> bool:
    """Whether a cell has digits and separators alone, so that it was meant as a number."""
    return bool(_DIGITS.match(_spelled(text)))


def _spelled(text: str) -> str:
    """With one spelling of blanks and apostrophes."""
    return text if isinstance(text, Numeral) else re.sub(r"\s", " ", text.strip()).replace("\u2019", "'")


def _shown(text: str) -> str:
    """The decimal sign that a number shows by itself: ``1.500,00`` a comma, ``1.500`` none."""
    plain, grouped = _PLAIN.match(text), _GROUPED.match(text)
    if plain and plain[2] and not (grouped and not plain[4]):
        return plain[2]
    if grouped:
        separator, more, sign = grouped.groups()
        return sign or (_OTHER[separator] if more and separator in _OTHER else "")
    return ""
