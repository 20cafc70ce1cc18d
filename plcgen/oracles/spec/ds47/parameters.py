"""Parameters as a spec writes them, and what spec and device profile say of them (docs/spec.md, docs/devices.md)."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from plcgen.oracles.spec.ds47.listed import StatedLists, alike
from plcgen.oracles.spec.ds47.types import SHORT
from plcgen.oracles.spec.place import NotStatedError, SpecSource

_WRITTEN = re.compile(
    r"(?P<name>[A-Za-z_]\w*)(?:\[\s*(?P<first>\d+)\s*(?:\.\.\s*(?P<last>\d+)\s*)?\])?(?:\.(?P<bit>\d+))?"
)
_NUMBER = re.compile(r"[PpRrCc]0*(\d+)")
NEVER_INHERITED = frozenset({"min", "max", "default", "values", "array"})
"""Facts that count only if somebody read them; from a device that this one is ``like`` they are inferred."""
NUMBER_FACTS = frozenset({"type", "title", "unit", "access", "name", "bico"})
DISPLAYS = frozenset({944, 945, 947, 948, 949, 964, 965, 975})
"""PROFIdrive parameters that no device lets anybody write (OPC 30144, annex B)."""
APART = frozenset({"sinamics-dcm", "sinamics-dcp"})
"""Devices of a family that have nothing in common with its other ones: converters for direct current."""
Facts = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class WrittenParameter:
    """``P2155[1..2]``, ``r722.3``, ``ramp_up_time``: number and indexes; ``facts`` is what is known."""

    text: str
    number: int
    first: int
    count: int
    indexed: bool
    bit: int | None
    facts: Facts = field(hash=False)

    @property
    def name(self) -> str:
        """In snake_case, for members and inputs."""
        return str(self.facts.get("name") or f"{'r' if self.facts.get('letter') == 'r' else 'p'}{self.number}")

    @property
    def type(self) -> str:
        """Type on the wire."""
        found = str(self.facts.get("type", "unknown"))
        if found == "unknown":
            raise NotStatedError(f"nobody says which type {self.text} has")
        return SHORT.get(found, found)

    @property
    def bico(self) -> bool:
        """Whether its value is a source."""
        return bool(self.facts.get("bico"))


class StatedCatalogue:
    """What is known of the parameters of one drive: its profile, those it is ``like``, and the spec."""

    def __init__(self, device: str, source: SpecSource, own: Mapping[str, Any], object_type: str) -> None:
        profiles = source.profiles
        self.numbers: dict[int, dict[str, Any]] = {}
        having = next((name for name, one in _chain(device, profiles) if one.get("lists")), device)
        asked = profiles[having].get("lists") or []
        self._lists = StatedLists(asked, source.lists, object_type, lent=having != device)
        stated = (one["main_values"] for _, one in _chain(device, profiles) if one.get("main_values"))
        self.main_values: Mapping[str, str] = next(stated, {})
        self.called = [device]
        for step, (name, profile) in reversed(list(enumerate(_chain(device, profiles)))):
            self.called += [name] if step else []
            for key, facts in (profile.get("parameters") or {}).items():
                known = self.numbers.setdefault(_number(str(key)), {})
                known.update(_believed(facts or {}, inherited=step > 0), letter=_letter(str(key), facts or {}, known))
        usual: Mapping[str, Any] = next(
            (one["object_types"] for _, one in _chain(device, profiles) if one.get("object_types")), {}
        )
        self._unusual = bool(usual and object_type) and not alike(object_type, str(usual.get("others", "")))
        self.asking = {number: str(facts.get("dangerous") or "") for number, facts in self.numbers.items()}
        self.harmless = {number for number, facts in self.numbers.items() if facts.get("harmless")}
        self._defined = {_number(str(key)) for key in own}
        for key, facts in own.items():
            number = _number(str(key))
            known = self.numbers[number] = self._of_object(number) or self._lists.facts(number, defined=True)
            letter = _letter(str(key), facts or {}, known)
            known.update({name: value for name, value in (facts or {}).items() if value is not None}, letter=letter)
        self._device, self._source = str(profiles[device].get("like") or device), source
        self._own_key = device
        self.names = {facts["name"]: number for number, facts in self.numbers.items() if facts.get("name")}

    def _of_object(self, number: int) -> dict[str, Any]:
        """A row of the profiles; it gives way to the list of a type of drive object that is not the usual one."""
        row = self.numbers.get(number, {})
        said = self._lists.read(number) if row and self._unusual else {}
        return {**said, **{key: row[key] for key in ("name", "dangerous", "harmless") if row.get(key)}} if said else row

    def has(self, number: int) -> bool:
        """Whether somebody knows that the drive has it: the spec, the profile but from memory, or a list of its own."""
        facts = self.numbers.get(number)
        if facts is None or number in self._defined:
            return facts is not None or self._lists.name_it(number)
        grade = (facts.get("facts") or {}).get("type", facts.get("grade", "read"))
        return bool(facts.get("type", "unknown") != "unknown" and grade != "recalled")

    def bit_name(self, number: int, bit: int) -> str:
        """What the lists call a bit, in snake_case; empty if they do not."""
        return self._lists.bit_name(number, bit)

    def lent(self, number: int) -> Facts:
        """What other devices of the family say of a number of which this one's catalogue has no type, if all that do
        give one type; nothing from memory counts.
        """
        if self._source.family is None or APART & {self._device, self._own_key}:
            return {}
        family = self._source.family(self._device)
        start = f"{self._device.partition('-')[0]}-"
        named = (name for name in sorted(family.profiles) if name.startswith(start))
        others = (name for name in named if name not in {self._own_key, *APART})
        found = [one for name in others if (one := _of_device(name, family, number))]
        if len({one["type"] for one in found}) != 1:
            return {}
        letter = "r" if any(one.get("letter") == "r" for one in found) else "P"
        bico = all(one.get("bico") for one in found)
        return {**{key: found[0].get(key) for key in ("type", "title", "unit")}, "letter": letter, "bico": bico}

    def read(self, text: str) -> WrittenParameter:
        """A parameter as it is written in a spec."""
        match = _WRITTEN.fullmatch(text.strip())
        if match is None:
            raise NotStatedError(f"{text!r} is no parameter")
        plain = _NUMBER.fullmatch(match["name"])
        number = int(plain[1]) if plain else self.names.get(match["name"])
        if number is None:
            raise NotStatedError(f"{match['name']} is the name of no parameter")
        indexed = match["first"] is not None
        first = int(match["first"] or 0)
        count = int(match["last"] or first) - first + 1
        bit = int(match["bit"]) if match["bit"] else None
        known = self.numbers.get(number) if number in self._defined else self._of_object(number)
        known = known or self._lists.facts(number) or {"letter": "r" if number in DISPLAYS else "P"}
        return WrittenParameter(text, number, first, count, indexed, bit, known)


def _of_device(name: str, family: SpecSource, number: int) -> Facts:
    """What a device says of a number, of its usual drive object or any; nothing without a type that was looked up."""
    profile = family.profiles[name]
    others = str((profile.get("object_types") or {}).get("others", ""))
    if number in map(_number, map(str, profile.get("absent") or ())):
        return {}
    for object_type in dict.fromkeys((others, "")):
        facts = StatedCatalogue(name, family, {}, object_type).read(f"P{number}").facts
        grade = (facts.get("facts") or {}).get("type", facts.get("grade", "read"))
        if facts.get("type", "unknown") != "unknown" and grade != "recalled":
            return facts
    return {}


def _number(key: str) -> int:
    match = _NUMBER.match(key)
    if match is None:
        raise NotStatedError(f"{key!r} is no number of a parameter")
    return int(match[1])


def _letter(key: str, facts: Facts, known: Facts) -> str:
    """``r`` of a parameter that can only be read: by its key, by what is said of its access, or in every device."""
    free = "c" if key[:1] in "cC" or known.get("letter") == "c" else "P"
    if facts.get("access"):
        return "r" if facts["access"] == "r" else free
    read_only = key[:1] in "rR" or _number(key) in DISPLAYS or known.get("letter") == "r"
    return "r" if read_only else free


def _chain(device: str, profiles: Mapping[str, Mapping[str, Any]]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """The profile with its name, then what it is like."""
    seen: set[str] = set()
    name: str | None = device
    while name is not None and name not in seen:
        seen.add(name)
        if name not in profiles:
            raise NotStatedError(f"there is no profile {name}")
        yield name, profiles[name]
        name = profiles[name].get("like")


def _believed(facts: Mapping[str, Any], *, inherited: bool) -> Iterator[tuple[str, Any]]:
    """Limits, start values, indexes and names of values only where somebody read them for this very device."""
    grade, grades = str(facts.get("grade", "read")), facts.get("facts") or {}
    for name, value in facts.items():
        if name in NEVER_INHERITED and (inherited or grades.get(name, grade) != "read"):
            continue
        yield name, value
