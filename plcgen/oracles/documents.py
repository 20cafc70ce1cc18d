"""What documents say: published telegrams with their meaning, and facts about the shipped devices.

``telegrams.toml`` and ``facts.toml`` are the data; every entry names its manual, page or entry.
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
class DocumentedType:
    """Type of a parameter on the wire, and who says so."""

    type: str
    source: str


@dataclass(frozen=True)
class DocumentedDevice:
    """A device as documents describe it.

    ``drive_object`` is the number that a drive has if nothing else is said, ``drive_objects`` all that the document
    names (empty: a rule). ``by_size`` as in a telegram, None if the document prints no answer. ``records`` are the
    numbers of parameter records that it prints, by the path to the drive.
    """

    source: str
    drive_object: int
    drive_objects: tuple[int, ...]
    by_size: bool | None
    records: Mapping[str, int]
    parameters: Mapping[int, DocumentedType]


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
    types = {int(number): DocumentedType(**said) for number, said in row["parameters"].items()}
    objects = tuple(row["drive_objects"])
    return DocumentedDevice(
        row["source"], row["drive_object"], objects, row.get("by_size"), row.get("records", {}), types
    )


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
