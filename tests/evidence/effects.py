"""What a write of a parameter does, for every number of a folder of lists: the table that guards writes.

A list is a file ``<name>.tsv`` with a line that names it, a line of headings (letter, number, title, type, objects,
notes among them) and a line for each parameter. ``effects_rules.tsv`` classifies what can be written in it: the first
rule that fits decides, and every number must have one. ``effects_rows.tsv`` adds numbers of families without a list.
What comes out is ``plcgen/ds47/effects.tsv``: facts alone, the same for the same lists and rules.
"""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from plcgen.ds47 import effects

RULES = Path(__file__).with_name("effects_rules.tsv")
ROWS = Path(__file__).with_name("effects_rows.tsv")

FAMILIES = {
    "vector": "s120", "cu": "s120", "a_inf": "infeed", "tb30": "tm", "tm15": "tm", "tm31": "tm", "tm41": "tm",
    "tm120": "tm", "tm150": "tm", "g220": "g220", "g220_clean_power": "g220", "s210_fw5": "s210",
    "s210_fw6": "s210", "s200_pn": "s200", "s200_basic_pn": "s200",
}  # fmt: skip
"""The family that has the parameters of a list."""
_DCM = "DC_CTRL"
"""The drive object of a DCM: rows of the list of VECTOR name it where they hold for it too."""

_HEAD = """\
# What a write of a parameter does: made by python -m tests.evidence LISTS --part effects --save (docs/devices.md).
# value: empty for every value, or the one that matters; families: empty for numbers that no list names.
reason\tvalue\tfamilies\tgrade\tsource\tnumbers
"""


@dataclass(frozen=True, slots=True)
class Row:
    """What is said of a parameter in a list."""

    listed: str
    letter: str
    number: int
    title: str
    type: str
    objects: str
    notes: str

    @property
    def binector(self) -> bool:
        """Whether it takes a signal of one bit."""
        return "/ Binary" in self.type or self.title.startswith("BI:")

    @property
    def connector(self) -> bool:
        """Whether it takes any other signal; firmware 6 marks all that do so by the letter c."""
        return not self.binector and ("/ " in self.type or self.title.startswith("CI:") or self.letter == "c")

    @property
    def sink(self) -> bool:
        """Whether it takes a signal."""
        return self.binector or self.connector


@dataclass(slots=True)
class Rule:
    """A reason with the value that it is for, and the parameters that it applies to."""

    reason: str
    value: str
    ranges: tuple[tuple[int, int], ...]
    when: tuple[str, ...]
    words: re.Pattern[str] | None
    line: int

    def fits(self, row: Row) -> bool:
        """Whether every condition holds."""
        if not any(first <= row.number <= last for first, last in self.ranges):
            return False
        return (self.words is None or bool(self.words.search(row.title))) and all(_holds(one, row) for one in self.when)


def _holds(condition: str, row: Row) -> bool:
    key, _, text = condition.partition(":")
    facts = {
        "bi": row.binector,
        "ci": row.connector,
        "sink": row.sink,
        "no-sink": not row.sink,
        "note": any(letter in row.notes for letter in text),
        "no-note": not any(letter in row.notes for letter in text),
        "list": row.listed in text.split(","),
    }
    return facts[key]


def ranges(text: str) -> tuple[tuple[int, int], ...]:
    """``7,100-102`` as pairs of first and last."""
    return tuple((int(first), int(last or first)) for first, _, last in (one.partition("-") for one in text.split(",")))


def _lines(path: Path) -> Iterator[tuple[int, list[str]]]:
    """The fields of every line behind the headings."""
    lines = [(n, line) for n, line in enumerate(path.read_text("utf-8").splitlines(), 1) if line[:1] not in {"", "#"}]
    width = lines[0][1].count("\t") + 1
    for number, line in lines[1:]:
        fields = line.split("\t")
        yield number, fields + [""] * (width - len(fields))


def rules(path: Path = RULES) -> list[Rule]:
    """The rules in their order."""
    found = []
    for line, (named, numbers, when) in _lines(path):
        words = re.search("/(.*)/", when)
        reason, _, value = named.partition("=")
        conditions = tuple(re.sub("/.*/", "", when).split())
        pattern = re.compile(words[1]) if words else None
        found.append(Rule(reason, value, ranges(numbers), conditions, pattern, line))
    return found


def read_rows(path: Path) -> Iterator[dict[str, str]]:
    """The lines of a list by its headings."""
    with path.open(encoding="utf-8", newline="") as file:
        file.readline()
        yield from csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE, restval="")


def read_list(path: Path) -> list[Row]:
    """What a list says of the parameters that can be written."""
    return [
        Row(path.stem, row["letter"], int(row["number"]), row["title"], row["type"], row["objects"], row["notes"])
        for row in read_rows(path)
        if row["letter"] != "r"
    ]


def classify(row: Row, known: Iterable[Rule]) -> Rule:
    """The rule that decides; an error if none does, or if it calls harmless what cannot be.

    What the manufacturer marks with Danger or Warning asks, and so does a signal sink, unless it only reports
    (signals) or feeds a free block.
    """
    rule = next((one for one in known if one.fits(row)), None)
    if rule is None:
        raise ValueError(f"{row.listed}: no rule for {row.number} {row.title}")
    reason = effects.reasons()[rule.reason]
    silent = not reason.asks and (set(row.notes) & set("DW") or (row.sink and reason.kind not in {"signals", "logic"}))
    if silent:
        raise ValueError(f"{row.listed}: {rule.reason} (line {rule.line}) for {row.number} {row.title}")
    return rule


Entry = tuple[str, str, str, str]
"""Reason, value, grade and source."""


def table(folder: Path) -> str:
    """The text of the table for the lists of a folder."""
    known, entries = rules(), _rows()
    of_lists: dict[tuple[int, str], set[tuple[str, str]]] = {}
    for name, family in FAMILIES.items():
        for row in read_list(folder / f"{name}.tsv"):
            rule = classify(row, known)
            families = (family, "dcm") if _DCM in row.objects else (family,)
            for one in families:
                of_lists.setdefault((row.number, one), set()).add((rule.reason, rule.value))
    for (number, family), said in of_lists.items():
        entries.setdefault((number, family), [(reason, value, "read", "lists") for reason, value in sorted(said)])
    return _HEAD + "".join(_merged(entries))


def _rows() -> dict[tuple[int, str], list[Entry]]:
    """Numbers of families without a list, and those that no list names."""
    entries: dict[tuple[int, str], list[Entry]] = {}
    for line, (families, named, numbers, grade, source) in _lines(ROWS):
        reason, _, value = named.partition("=")
        if reason not in effects.reasons() or source not in effects.origins():
            raise ValueError(f"{ROWS.name} line {line}: unknown reason or source")
        for family in families.split(","):
            for first, last in ranges(numbers):
                for number in range(first, last + 1):
                    entries.setdefault((number, family), []).append((reason, value, grade, source))
    return entries


def _merged(entries: Mapping[tuple[int, str], list[Entry]]) -> Iterator[str]:
    """One line for all numbers of which the same is said in the same families."""
    families: dict[tuple[int, Entry], set[str]] = {}
    for (number, family), said in entries.items():
        for entry in said:
            families.setdefault((number, entry), set()).add(family)
    lines: dict[tuple[Entry, str], list[int]] = {}
    for (number, entry), found in families.items():
        lines.setdefault((entry, ",".join(sorted(found))), []).append(number)
    for (reason, value, grade, source), names in sorted(lines):
        numbers = _spelled(sorted(lines[(reason, value, grade, source), names]))
        yield f"{reason}\t{value}\t{names}\t{grade}\t{source}\t{numbers}\n"


def _spelled(numbers: list[int]) -> str:
    """Ascending numbers as ranges."""
    starts = [numbers[0], *(b for a, b in pairwise(numbers) if b > a + 1)]
    ends = [*(a for a, b in pairwise(numbers) if b > a + 1), numbers[-1]]
    return ",".join(f"{a}" if a == b else f"{a}-{b}" for a, b in zip(starts, ends, strict=True))


def report(folder: Path, *, save: bool) -> Iterator[str]:
    """How many numbers have which class; ``save`` writes the table."""
    missing = [name for name in FAMILIES if not (folder / f"{name}.tsv").is_file()]
    if missing:
        yield f"effects: not here: {', '.join(missing)}"
        return
    text = table(folder)
    if save:
        effects.TABLE.write_text(text, "utf-8")
    found: dict[str, set[int]] = {}
    for line in text.splitlines()[3:]:
        reason, *_, numbers = line.split("\t")
        every = (number for first, last in ranges(numbers) for number in range(first, last + 1))
        found.setdefault(effects.reasons()[reason].kind, set()).update(every)
    counts = Counter({kind: len(numbers) for kind, numbers in found.items()})
    for kind, count in counts.most_common():
        yield f"effects: {count:5} numbers: {kind}"
