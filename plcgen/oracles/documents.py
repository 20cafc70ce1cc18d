"""What documents say: published telegrams with their meaning, and facts about the shipped devices.

``telegrams.toml``, ``facts.toml``, ``lists.toml`` and ``versions.toml`` are the data; every entry names its manual,
page or list.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

Number = int | float


@dataclass(frozen=True)
class PublishedParameter:
    """One parameter of a published telegram: its address, its type by name, its values."""

    number: int
    subindex: int
    elements: int
    type: str
    values: tuple[Number, ...]


@dataclass(frozen=True)
class PublishedTelegram:
    """A request and its answer as a manual prints them; ``by_size``: answered as byte, word or double word."""

    id: str
    source: str
    request: bytes
    answer: bytes
    by_size: bool
    drive_object: int
    parameters: tuple[PublishedParameter, ...]

    @property
    def writes(self) -> bool:
        """Whether it changes parameters (request ID 02h)."""
        return self.request[1] == 0x02


@dataclass(frozen=True)
class PublishedSource:
    """A signal source as a manual prints it: parameter, bit or index, drive object (None: the one addressed), value."""

    number: int
    index: int
    drive_object: int | None
    value: int
    source: str


@dataclass(frozen=True)
class DocumentedType:
    """Type of a parameter on the wire, and who says so; ``package`` is that of a list of Siemens' help."""

    type: str
    source: str
    package: str = ""

    def another(self, source: str) -> bool:
        """Whether the document is another one than a source."""
        return source != self.source and (not self.package or self.package not in source)


@dataclass(frozen=True)
class DocumentedLimits:
    """Least and greatest value of a parameter in a list of Siemens' help."""

    low: float
    high: float
    source: str
    package: str


@dataclass(frozen=True)
class DocumentedDevice:
    """A device as documents describe it.

    ``drive_object`` is the number that a drive has if nothing else is said, ``drive_objects`` all that the document
    names (empty: a rule). ``by_size`` as in a telegram, None if the document prints no answer. ``records`` are the
    numbers of parameter records that it prints, by the path to the drive. ``elements`` is the most of one
    parameter in a request, ``without_index`` how many are in a request for one without an index, to read and to write,
    ``sources`` how values of sources are made up; 0 and empty: no document says so.
    """

    source: str
    drive_object: int
    drive_objects: tuple[int, ...]
    by_size: bool | None
    records: Mapping[str, int]
    elements: int
    without_index: tuple[int, ...]
    sources: str


@cache
def published_sources() -> tuple[PublishedSource, ...]:
    """Every published source (BICO)."""
    return tuple(
        PublishedSource(row["number"], row["index"], row.get("drive_object"), int(row["value"], 16), row["source"])
        for row in _read("telegrams.toml")["source"]
    )


@cache
def published() -> tuple[PublishedTelegram, ...]:
    """Every published telegram."""
    return tuple(_telegram(row) for row in _read("telegrams.toml")["telegram"])


@cache
def device(key: str) -> DocumentedDevice | None:
    """What documents say about a device; None if nobody looked."""
    row = _read("facts.toml").get(key)
    if row is None:
        return None
    objects = tuple(row["drive_objects"])
    return DocumentedDevice(
        row["source"],
        row["drive_object"],
        objects,
        row.get("by_size"),
        row.get("records", {}),
        row.get("elements", 0),
        tuple(row.get("without_index", ())),
        row.get("sources", ""),
    )


@dataclass(frozen=True)
class DocumentVersions:
    """What documents of a version of the TIA Portal say: the version, and that of each namespace by its beginning."""

    engineering: str
    namespaces: dict[str, str]
    source: str


@dataclass(frozen=True)
class InstructionVersions:
    """Versions of instructions of an S7-1200/1500 by name."""

    versions: Mapping[str, str]
    source: str


@cache
def document_versions(tool: str) -> DocumentVersions | None:
    """What schemas of a tool say; None if there are none."""
    table = _read("versions.toml")["documents"]
    row = table["tools"].get(tool)
    if row is None:
        return None
    base = table["base"]
    names = {f"{base}Interface/": row["interface"], f"{base}NetworkSource/StructuredText/": row["text"]}
    return DocumentVersions(row["engineering"], names, table["source"])


@cache
def instruction_versions() -> InstructionVersions:
    """What exports say about the instructions of drive blocks."""
    row = _read("versions.toml")["instructions"]
    return InstructionVersions(row["versions"], row["source"])


@cache
def s7_types(family: str) -> Mapping[str, str]:
    """S7 type by type of data set 47, for a CPU family; what is missing is bytes."""
    table = _read("values.toml")
    parts = ("classic",) if family in {"s7-300", "s7-400"} else ("new", family)
    return {name: s7 for part in parts for s7, names in table.get(part, {}).items() for name in names}


@cache
def codes_alike() -> tuple[tuple[frozenset[int], str], ...]:
    """Codes of one type, and who says so: which of them a drive answers depends on its firmware."""
    return tuple((frozenset(row["codes"]), row["source"]) for row in _read("telegrams.toml")["alike"])


@cache
def documented_types(key: str) -> Mapping[int, tuple[DocumentedType, ...]]:
    """What documents say of the types of a device's parameters, by number: about the device first, then lists."""
    found: dict[int, list[DocumentedType]] = {}
    for number, said in _read("facts.toml").get(key, {}).get("parameters", {}).items():
        found.setdefault(int(number), []).append(DocumentedType(**said))
    lists = _read("lists.toml")
    for name in lists["devices"].get(key, ()):
        one = lists[name]
        for type_, numbers in one["types"].items():
            for number in numbers:
                found.setdefault(number, []).append(DocumentedType(type_, one["source"], one["package"]))
    return {number: tuple(said) for number, said in found.items()}


@cache
def documented_limits(key: str) -> Mapping[int, tuple[DocumentedLimits, ...]]:
    """Limits that the lists of a device print, by number."""
    found: dict[int, list[DocumentedLimits]] = {}
    lists = _read("lists.toml")
    for one in (lists[name] for name in lists["devices"].get(key, ())):
        for low, high, numbers in one.get("limits", ()):
            for number in numbers:
                found.setdefault(number, []).append(DocumentedLimits(low, high, one["source"], one["package"]))
    return {number: tuple(said) for number, said in found.items()}


def _telegram(row: Mapping[str, Any]) -> PublishedTelegram:
    parameters = tuple(
        PublishedParameter(one["number"], one.get("subindex", 0), one["elements"], one["type"], tuple(one["values"]))
        for one in row["parameters"]
    )
    return PublishedTelegram(
        id=row["id"],
        source=row["source"],
        request=bytes.fromhex(row["request"]),
        answer=bytes.fromhex(row["answer"]),
        by_size=row.get("by_size", False),
        drive_object=row["drive_object"],
        parameters=parameters,
    )


def _read(name: str) -> dict[str, Any]:
    return tomllib.loads((Path(__file__).parent / name).read_text("utf-8"))
