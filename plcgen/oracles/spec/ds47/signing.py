"""What a write may do to a plant, and who has signed for it (docs/devices.md "Dangerous parameters", docs/spec.md).

The table of effects is handed in as the plain contents of its two files; nothing of what reads it elsewhere is used.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from plcgen.oracles.spec.ds47.drives import KnownDrive
from plcgen.oracles.spec.ds47.kinds import save
from plcgen.oracles.spec.ds47.kinds.activate import COMMAND
from plcgen.oracles.spec.ds47.statement import Number, StatedAccess

UNKNOWN = "nobody has classified what a write does"
SAFETY = frozenset({3117, *range(9300, 9400), *range(9500, 10_300), 60_022})
"""Safety Integrated (lists of parameters in the TIA Portal information system)."""


@dataclass(frozen=True, slots=True)
class Row:
    """One line of the table: why a number asks, for one value or all, in which families of drives."""

    reason: str
    value: str
    families: frozenset[str]


class Effects:
    """The table: ``words`` has classes, reasons and families; a line has reason, value, families, .., numbers."""

    def __init__(self, words: Mapping[str, Any], lines: Sequence[str]) -> None:
        self.words = words
        self.rows: dict[int, list[Row]] = {}
        for line in lines:
            if line.startswith(("#", "reason\t")) or not line:
                continue
            reason, value, families, _, _, numbers = line.split("\t")
            row = Row(reason, value, frozenset(families.split(",")) - {""})
            for number in _numbers(numbers):
                self.rows.setdefault(number, []).append(row)

    def danger(self, drive: KnownDrive, number: int, values: Collection[Number] | None) -> str:
        """Why a write asks for a sign-off; empty if it does not. ``values`` None: nobody knows them yet."""
        if own := drive.catalogue.asking.get(number, ""):
            return own
        family = self.family(drive)
        near = [{family}, set(self.words["families"][family].get("like", ()))] if family else []
        rows = [row for row in self.rows.get(number, ()) if row.families]
        own_rows = [[row for row in rows if row.families & keys] for keys in near]
        for row in next(filter(None, own_rows), rows) or self.rows.get(number, []):
            reason = self.words["reasons"][row.reason]
            class_ = reason["class"]
            met = not row.value or values is None or int(row.value) in values
            if met and self.words["classes"][class_]["asks"]:
                why = reason["why"]
                if not family and number not in range(900, 1000):
                    why = f"what it does in this drive is not known; in drives of Siemens it {why.removeprefix('it ')}"
                return f"{why} (effect: {class_}{self._where(row, set().union(*near))})"
        return "" if number in self.rows or number in drive.catalogue.harmless else UNKNOWN

    def harmless(self, drive: KnownDrive) -> frozenset[int]:
        """Numbers of which a write of any value never asks, by what the family of the drive says of them, or else
        those that are like it; by what the profile says.
        """
        family = self.family(drive)
        like = set(self.words["families"][family].get("like", ())) if family else set()
        found = set(drive.catalogue.harmless)
        for number, rows in self.rows.items():
            own = [row for row in rows if family in row.families] or [row for row in rows if row.families & like]
            classes = {self.words["reasons"][row.reason]["class"] for row in own}
            if classes and not any(self.words["classes"][one]["asks"] for one in classes):
                found.add(number)
        return frozenset(number for number in found if not drive.catalogue.asking.get(number))

    def family(self, drive: KnownDrive) -> str:
        """The first family that has the type of the drive object, the device, or one that it is like."""
        called = {drive.object_type, *drive.catalogue.called}
        return next((key for key, one in self.words["families"].items() if called & set(one.get("called", ()))), "")

    def _where(self, row: Row, near: set[str]) -> str:
        if not row.families:
            return ", as its neighbours"
        if near & row.families:
            return ""
        return ", of " + ", ".join(one["title"] for key, one in self.words["families"].items() if key in row.families)


def _numbers(text: str) -> Iterator[int]:
    """``840,844-845``."""
    for part in text.split(","):
        first, _, last = part.partition("-")
        yield from range(int(first), int(last or first) + 1)


def sign_off(job: Mapping[str, Any], drive: KnownDrive, number: int) -> str:
    """The reason that a job gives for a write; a job that is there to do it needs no other; empty without one."""
    key = "allow_safety" if number in SAFETY else "allow"
    for text, reason in (job.get(key) or {}).items():
        if drive.catalogue.read(str(text)).number == number:
            return str(reason)
    saved, activated = job.get("save"), job.get("activate")
    if saved is not None and save.saves(saved) and number == _number(save.command(saved)):
        return f"the job says save, once in {_spelled(save.distance_ms(saved))} at most"
    if activated is not None and number == _number(COMMAND):
        state = activated["state"] if isinstance(activated, Mapping) else activated
        return f"the job says activate: {str(state).lower()}"
    return ""


def values_written(access: StatedAccess, *, restores: bool) -> frozenset[Number] | None:
    """Numbers that a write is known to write; a job that restores old values may write any."""
    plain = [one for one in access.values if isinstance(one, int | float)]
    known = not restores and not access.bits and not access.bico and len(plain) == len(access.values)
    return frozenset(plain) if known else None


def _number(text: str) -> int:
    return int(text[1:])


def _spelled(time: int) -> str:
    """``600 s``; in milliseconds what is no whole second."""
    return f"{time} ms" if time % 1000 else f"{time // 1000} s"
