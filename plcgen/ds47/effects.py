"""What a write of a parameter does, by its number, its value and the family of the drive.

``effects.toml`` has the classes of effect and the reasons, ``effects.tsv`` says which number has which, in which
families, and how that is known: a line is ``reason, value, families, grade, source, numbers``, separated by tabs;
numbers are ranges (``840,844-845``). Without a value the line is for every value. Without families it is for numbers
that no list names. docs/devices.md explains how the table is made.
"""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

UNCLASSIFIED = "nobody has classified what a write does"
"""What is said of a number that is in no list."""

TABLE = Path(__file__).with_suffix(".tsv")
_WORDS = Path(__file__).with_suffix(".toml")


@dataclass(frozen=True, slots=True)
class Reason:
    """Why a write asks: ``kind`` is its class of effect, ``why`` the end of "needs a sign-off: ..", empty if it does
    not ask. ``chosen``: whether somebody must choose a value.
    """

    key: str
    kind: str
    asks: bool
    chosen: bool
    why: str


@dataclass(frozen=True, slots=True)
class Family:
    """Drives with one list of parameters: ``called`` are profiles or types of drive objects, ``like`` the families
    whose numbers they share.
    """

    title: str
    called: frozenset[str] = frozenset()
    like: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Effect:
    """What is said of a number: for one ``value`` or all (None), in some ``families``, and how it is known."""

    reason: Reason
    value: int | None
    families: frozenset[str]
    grade: str
    source: str

    def asks(self, values: Collection[object] | None) -> bool:
        """Whether a write of these values needs a sign-off; None are values that nobody knows yet."""
        if not self.reason.asks or self.value is None or values is None:
            return self.reason.asks
        return any(value == self.value or self.value == 1 == _source(value) for value in values)


def _source(value: object) -> int:
    """The number of the parameter that a sink takes its signal from. Recalled: a constant 1 is "parameter 1", that is
    16#0001FC00 in SINAMICS and 16#00010000 in MICROMASTER.
    """
    return value >> 16 if isinstance(value, int) else 0


@lru_cache(maxsize=1)
def _words() -> Mapping[str, Any]:
    return tomllib.loads(_WORDS.read_text("utf-8"))


@lru_cache(maxsize=1)
def reasons() -> Mapping[str, Reason]:
    """Every reason by its key."""
    words = _words()
    classes = {key: (one["asks"], one["asks"] or one.get("chosen", False)) for key, one in words["classes"].items()}
    return {
        key: Reason(key, one["class"], *classes[one["class"]], one.get("why", ""))
        for key, one in words["reasons"].items()
    }


@lru_cache(maxsize=1)
def families() -> Mapping[str, Family]:
    """Every family by its key."""
    return {
        key: Family(one["title"], frozenset(one.get("called", ())), tuple(one.get("like", ())))
        for key, one in _words()["families"].items()
    }


def origins() -> Mapping[str, str]:
    """What the sources of the table are, by their keys."""
    found: Mapping[str, str] = _words()["sources"]
    return found


@lru_cache(maxsize=1)
def _table() -> Mapping[int, list[Effect]]:
    """The effects of every number in the order of the table."""
    found: dict[int, list[Effect]] = {}
    for line in TABLE.read_text("utf-8").splitlines()[3:]:
        reason, value, names, grade, source, numbers = line.split("\t")
        effect = Effect(
            reasons()[reason], int(value) if value else None, frozenset(filter(None, names.split(","))), grade, source
        )
        for text in numbers.split(","):
            first, _, last = text.partition("-")
            for number in range(int(first), int(last or first) + 1):
                found.setdefault(number, []).append(effect)
    return found


def every() -> Iterator[tuple[int, tuple[Effect, ...]]]:
    """All that the table says, by number."""
    return ((number, tuple(found)) for number, found in sorted(_table().items()))


def _family(called: Collection[str]) -> str:
    return next((key for key, one in families().items() if one.called & set(called)), "")


def effects(pnu: int, called: Collection[str]) -> tuple[Effect, ...]:
    """What is said of a number in the family of a drive, else in those that are like it, else in any; only then what
    its neighbours do. ``called`` are its profile, the one that this is like, and the type of the drive object.
    """
    said = _table().get(pnu, ())
    return _near(said, called) or tuple(effect for effect in said if effect.families) or tuple(said)


def _near(said: Iterable[Effect], called: Collection[str]) -> tuple[Effect, ...]:
    """What is said in the family of a drive, else in those that are like it."""
    own = _family(called)
    for keys in ({own}, set(families()[own].like)) if own else ():
        found = tuple(effect for effect in said if effect.families & keys)
        if found:
            return found
    return ()


def harmless(called: Collection[str]) -> set[int]:
    """Numbers of which the family of a drive, or one that is like it, says that no write of any value asks."""
    near = ((pnu, _near(said, called)) for pnu, said in _table().items())
    return {pnu for pnu, found in near if found and not any(one.reason.asks for one in found)}


def left_to_chance(pnu: int, called: Collection[str]) -> str:
    """The class of effect of a number of which somebody must choose the value; empty if there is none."""
    return next((one.reason.kind for one in effects(pnu, called) if one.reason.chosen), "")


def classified(pnu: int) -> bool:
    """Whether anything is said of a number."""
    return pnu in _table()


PROFILE = range(900, 1000)
"""Numbers that the PROFIdrive profile has for itself, the same in drives of every maker."""
UNKNOWN_HERE = "what it does in this drive is not known; in drives of Siemens"


def danger(pnu: int, called: Collection[str], values: Collection[object] | None = None) -> str:
    """Why a write of these values needs a sign-off, with its class of effect; empty if it needs none.

    ``values`` are what is written, None if that is not known before the drive runs.
    """
    asking = [effect for effect in effects(pnu, called) if effect.asks(values)]
    if not asking:
        return ""
    first = asking[0]
    own = _family(called)
    near = {own, *families()[own].like} if own else set()
    names = [one.title for key, one in families().items() if key in first.families and not near & first.families]
    where = f", of {', '.join(names)}" if names else "" if first.families else ", as its neighbours"
    why = first.reason.why
    if not own and pnu not in PROFILE:  # another maker's number may mean anything
        why = f"{UNKNOWN_HERE} it {why.removeprefix('it ')}"
    return f"{why} (effect: {first.reason.kind}{where})"
