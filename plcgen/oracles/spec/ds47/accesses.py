"""From what stands under ``read``, ``write`` or ``compare`` to accesses of a drive."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from plcgen.oracles.spec.ds47.drives import KnownDrive
from plcgen.oracles.spec.ds47.parameters import WrittenParameter
from plcgen.oracles.spec.ds47.statement import Source, StatedAccess
from plcgen.oracles.spec.ds47.types import ANY, size_of, string_octets
from plcgen.oracles.spec.ds47.values import sources_of
from plcgen.oracles.spec.place import Keys, NotStatedError, SpecPlace, SpecSource, texts


@dataclass(frozen=True, slots=True)
class SpecItem:
    """One entry of a list of parameters: what is written there, and the keys of its long form."""

    text: str
    settings: Mapping[str, Any]
    value: Any
    place: SpecPlace
    fixed: bool = False
    """Whether the kind of job names it."""

    @property
    def comments(self) -> frozenset[str] | None:
        """What the spec says of it, in every language."""
        return None if self.fixed else texts(self.settings.get("comment"))


@dataclass(frozen=True, slots=True)
class JobReader:
    """A job of the spec on one of its drives; ``way`` leads to the job."""

    source: SpecSource
    job: Mapping[str, Any]
    way: Keys
    drive: KnownDrive

    def items(self, *below: str | int) -> list[SpecItem]:
        """What stands under a key of the job: a parameter, a list of them, or values by parameter."""
        node: Any = self.job
        for step in below:
            node = node[step]
        return list(items(node, self.source, (*self.way, *below)))

    def parameter(self, item: SpecItem, *, free: bool = False) -> WrittenParameter:
        """The parameter of an item, with the type that the item gives it, or other devices of the family.

        ``free``: a single value that is read needs none, the answer tells it.
        """
        found = self.drive.catalogue.read(item.text)
        type_ = item.settings.get("type")
        if not type_ and found.facts.get("type", "unknown") == "unknown":
            if free and found.count == 1:
                letter = "r" if item.text.strip()[:1] in "rR" else found.facts.get("letter", "P")
                return replace(found, facts={**found.facts, "type": ANY, "letter": letter})
            known = {name: value for name, value in found.facts.items() if value and name not in {"type", "letter"}}
            lent = self.drive.catalogue.lent(found.number)
            letters = {"r" if item.text.strip()[:1] in "rR" else "P", found.facts.get("letter"), lent.get("letter")}
            return replace(found, facts={**lent, **known, "letter": "r" if "r" in letters else "P"})
        return replace(found, facts={**found.facts, "type": type_}) if type_ else found

    def name(self, item: SpecItem, parameter: WrittenParameter) -> str:
        """Name of an input or output, with the index if it is a single one."""
        if item.settings.get("as"):
            return str(item.settings["as"])
        single = parameter.indexed and parameter.count == 1
        return camel(parameter.name) + (f"Index{parameter.first}" if single else "")

    def reads(self, item: SpecItem, output: str | None = None, *, free: bool = False) -> StatedAccess:
        """The item is read; ``free``: it may have no type."""
        parameter = self.parameter(item, free=free)
        name = self.name(item, parameter) if output is None else output
        return self.access(item, parameter, write=False, output=name)

    def writes(self, item: SpecItem) -> StatedAccess:
        """The item is written: constants, or an input."""
        parameter = self.parameter(item)
        values = self.wanted(item, parameter)
        return replace(self.access(item, parameter, write=True, output=""), values=values)

    def wanted(self, item: SpecItem, parameter: WrittenParameter, name: str = "") -> tuple[Source, ...]:
        """The values of an item: constants, or those of an input."""
        input_ = name or self.name(item, parameter)
        return sources_of(parameter, item.value, self.drive.profile, input_, item.settings.get("start"))

    def access(self, item: SpecItem, parameter: WrittenParameter, *, write: bool, output: str) -> StatedAccess:
        """What goes over the wire, without values."""
        octets = string_octets(parameter.type)
        if octets and parameter.count > 1:
            raise NotStatedError(f"{item.text}: an array of texts")
        scalar = not parameter.indexed and not octets
        return StatedAccess(
            place=item.place,
            written=item.text,
            write=write,
            number=parameter.number,
            index=parameter.first,
            indexed=parameter.indexed,
            count=octets or parameter.count,
            elements=self.drive.elements(write=write) if scalar else octets or parameter.count,
            type=parameter.type,
            size=size_of(parameter.type),
            output=output,
            bico=parameter.bico,
            letter=str(parameter.facts.get("letter", "P")),
            title=str(parameter.facts.get("title") or ""),
            unit=unit_of(parameter.facts),
            comments=item.comments,
        )

    def fixed(self, text: str, type_: str = "") -> SpecItem:
        """A parameter that the kind of job names, not the spec; ``type_`` if the catalogue has none."""
        return SpecItem(text, {"type": type_} if type_ else {}, None, self.source.place(self.way), fixed=True)


def unit_of(facts: Mapping[str, Any]) -> str:
    """What a value is counted in: ``s``, or ``0.01 s`` of a fixed point value."""
    unit, scale = str(facts.get("unit") or ""), facts.get("scale")
    return f"{scale:g} {unit}".strip() if scale else unit


def items(node: Any, source: SpecSource, way: Keys) -> Iterator[SpecItem]:
    """Short and long forms alike."""
    if isinstance(node, Mapping) and "parameter" in node:
        yield _item(node, source.place(way))
    elif isinstance(node, Mapping):
        for position, (text, value) in enumerate(node.items()):
            place = source.place((*way, position, "parameter"))
            settings = value if isinstance(value, Mapping) else {"value": value}
            yield SpecItem(str(text), settings, settings.get("value"), place)
    elif isinstance(node, Sequence) and not isinstance(node, str):
        for position, one in enumerate(node):
            yield from items(one, source, (*way, position))
    else:
        yield SpecItem(str(node), {}, None, source.place(way))


def _item(node: Mapping[str, Any], place: SpecPlace) -> SpecItem:
    return SpecItem(str(node["parameter"]), node, node.get("value"), place)


def camel(name: str) -> str:
    """``ramp_up_time`` -> ``rampUpTime``."""
    parts = [part for part in re.split(r"[_\W]+", name) if part]
    return "".join([parts[0][:1].lower() + parts[0][1:], *(part[:1].upper() + part[1:] for part in parts[1:])])
