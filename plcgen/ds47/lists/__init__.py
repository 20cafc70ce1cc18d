"""Whole lists of parameters: what the manufacturer prints of every number of a drive object, as facts.

Each file names its list in the first line and has a line for each parameter, by number; a number can stand several
times, for different drive objects. ``python -m tests.evidence HELP --part parameters --save`` makes them.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

COLUMNS = (
    "number", "letter", "objects", "title", "type", "bico", "array", "unit", "min", "max", "default", "scaling",
    "changeable", "values", "bits", "indexes",
)  # fmt: skip
FOLDER = Path(__file__).parent
ON_WIRE = {948: "TimeDifference", 965: "OctetString[2]"}
"""Types that a drive answers with instead of those that lists print (manuals of S120; the list of TM41 says it too)."""
ALL = "ALL"
"""What stands for every drive object."""


@dataclass(frozen=True, slots=True)
class Listed:
    """A line of a list: texts by their columns, empty where the list says nothing."""

    texts: Mapping[str, str]

    @property
    def objects(self) -> frozenset[str]:
        """Drive objects that have it, as the list calls them; none in a list of a device that has only one."""
        return frozenset(self.texts["objects"].split())

    def names(self, column: str) -> Mapping[int, str]:
        """What numbers stand for: of values, bits (with the meaning of 0 and 1) or indexes."""
        pairs = (one.partition("=") for one in self.texts[column].split("; ") if re.match(r"-?[0-9]+=", one))
        return {int(number): name for number, _, name in pairs}


@lru_cache(maxsize=16)
def _text(name: str) -> str:
    return (FOLDER / f"{name}.tsv").read_text("utf-8")


@lru_cache(maxsize=16)
def _lines(name: str) -> Mapping[int, Sequence[str]]:
    found: dict[int, list[str]] = {}
    for line in filter(None, _text(name).split("\n")[2:]):
        found.setdefault(int(line.partition("\t")[0]), []).append(line)
    return found


def names() -> Sequence[str]:
    """The lists that there are."""
    return sorted(path.stem for path in FOLDER.glob("*.tsv"))


def numbers(name: str) -> Sequence[int]:
    """The parameters that a list has."""
    return sorted(_lines(name))


def source(name: str) -> str:
    """What a list is."""
    return _text(name).partition("\n")[0].removeprefix("# ").removesuffix(", facts only")


_SIGNS = [
    (re.compile(sign), word)
    for sign, word in (
        ("²", "2"), ("³", "3"), ("[µμ]", "u"), ("°", " deg "), ("%", " percent "),
        ("(?<![a-z0-9])-(?=[0-9])", " minus "), ("< ?(?=[0-9])", " below "), ("(?<!-)> ?(?=[0-9])", " above "),
    )
]  # fmt: skip
"""What a name says in words: without it, -300 °C would be 300, m/s² m/s and µm m."""


def value_name(text: str) -> str:
    """The name of a value as a spec writes it; empty if nothing is left."""
    text = text.lower().removesuffix(" - everything enabled")  # nothing is missing: the state itself
    for sign, word in _SIGNS:
        text = sign.sub(word, text)
    words = re.sub("[^a-z0-9]+", "_", text)[:64].strip("_")
    return words if words[:1].isalpha() and not re.fullmatch("[prc][0-9]+", words) else ""


def facts(row: Listed) -> dict[str, Any]:
    """What a line says as facts of a catalogue; nothing where it says nothing. A name that two values have is none."""
    texts = row.texts
    found: dict[str, Any] = {
        key: texts[key] for key in ("title", "type", "unit", "scaling", "changeable") if texts[key]
    }
    found |= {key: _number(texts[key]) for key in ("min", "max", "default") if texts[key]}
    found |= {"bico": True} if texts["bico"] else {}
    found |= {"array": int(texts["array"]) if texts["array"].isdecimal() else texts["array"]} if texts["array"] else {}
    named = [(value_name(text), number) for number, text in row.names("values").items()]
    count = Counter(name for name, _ in named)
    values = {name: number for name, number in named if name and count[name] == 1}
    return found | ({"values": values} if values and texts["type"] != "FloatingPoint" else {})


def _number(text: str) -> float:
    return float(text) if "." in text or "e" in text else int(text)


def search(name: str, words: Sequence[str]) -> list[int]:
    """The numbers of a list whose titles have all of some words, or parts of words, in the order of the list."""
    rows = (line.split("\t", 4) for lines in _lines(name).values() for line in lines)
    return [int(row[0]) for row in rows if all(word.casefold() in row[3].casefold() for word in words)]


def find(name: str, number: int) -> Sequence[Listed]:
    """What a list says of a number; empty if it does not have it."""
    rows = (line.split("\t") for line in _lines(name).get(number, ()))
    padded = (fields + [""] * (len(COLUMNS) - len(fields)) for fields in rows)
    return [Listed(dict(zip(COLUMNS, fields, strict=True))) for fields in padded]
