"""Messages of drives: faults, alarms and safety messages with title, class, reaction and acknowledgement.

Facts of the lists of messages of the TIA Portal information system (help of V19, English), joined into one table: the
same number can mean something else in another family. ``python -m tests.evidence HELP --part lists --save`` makes it.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Literal

COLUMNS = ("number", "kind", "also", "title", "class", "reaction", "acknowledge", "families")
TABLE = Path(__file__).with_name("messages.tsv")
KINDS = {"F": "fault", "A": "alarm", "N": "no message", "C": "safety message"}
Family = Literal[
    "a_inf", "cu230p", "cu240", "cu250s", "dc_ctrl", "g110m", "g115d", "g120c", "g120x", "g220", "g220_clean_power",
    "s200_basic_pn", "s200_pn", "s210_fw5",
    "s210_fw6", "servo", "vector",
]  # fmt: skip
FAMILIES: Mapping[Family, str] = {
    "a_inf": "infeeds of S120, S150, G130, G150",
    "cu230p": "G120 with CU230P-2",
    "cu240": "G120 with CU240x-2",
    "cu250s": "G120 with CU250S-2",
    "dc_ctrl": "DCM",
    "g110m": "G110M",
    "g115d": "G115D",
    "g120c": "G120C",
    "g120x": "G120X",
    "g220": "G220",
    "g220_clean_power": "G220 Clean Power",
    "s200_basic_pn": "S200 Basic PN",
    "s200_pn": "S200 PN",
    "s210_fw5": "S210, firmware 5",
    "s210_fw6": "S210, firmware 6",
    "servo": "SERVO of S120",
    "vector": "VECTOR of S120, S150, G130, G150",
}
"""Families that the table tells apart. Of DC_CTRL it has what the list of VECTOR says of it, which is not all."""
_NAME = re.compile(r"(?:([FANC])0*([1-9][0-9]{3,4})(?:\([FANC,]*\))?|([0-9]{5}))\Z", re.IGNORECASE)


CODES = {945: "F", 947: "F", 2131: "F", 2122: "A", 2132: "A"}
"""Parameters whose values are numbers of messages, faults or alarms."""


@dataclass(frozen=True, slots=True)
class Message:
    """What a number means in some families. ``also``: kinds that it can be set to; empty texts are not stated."""

    number: int
    kind: str
    also: tuple[str, ...]
    title: str
    message_class: str
    reaction: str
    acknowledge: str
    families: frozenset[str]

    @property
    def name(self) -> str:
        """``F07011 (N, A)``, as the lists print it."""
        return f"{self.kind}{self.number:05}" + (f" ({', '.join(self.also)})" if self.also else "")


@cache
def _lines() -> list[str]:
    return TABLE.read_text("utf-8").splitlines()


def source(families: Collection[str]) -> str:
    """The lists that speak of families."""
    pairs = dict(one.split("=") for one in _lines()[0].removeprefix("# ").split(", "))
    names = sorted({pairs[one] for one in families})
    return f"TIA Portal information system (help of V19), messages: {', '.join(names)}"


def all_messages(families: Collection[str]) -> Iterator[Message]:
    """Messages that some of the families have, by number."""
    for line in _lines()[2:]:
        number, kind, also, title, class_, reaction, acknowledge, where = line.split("\t")
        found = frozenset(where.split()) & frozenset(families)
        if found:
            yield Message(int(number), kind, tuple(also.split()), title, class_, reaction, acknowledge, found)


def named(text: str) -> tuple[str, int] | None:
    """The letter, or an empty text, and the number of ``F30001``, ``f7011`` or ``A07012 (F)``; None for others."""
    match = _NAME.match("".join(text.split()))
    return ((match[1] or "").upper(), int(match[2] or match[3])) if match else None


def find(number: int, families: Collection[str] = tuple(FAMILIES), kind: str = "") -> list[Message]:
    """What a number means, a message for each meaning; with ``kind`` those that are, or can be set to, this one."""
    start = f"{number}\t"
    if not any(line.startswith(start) for line in _lines()):
        return []
    known = (one for one in all_messages(families) if one.number == number)
    return [one for one in known if not kind or kind in {one.kind, *one.also}]
