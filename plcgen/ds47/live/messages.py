"""The fault buffer and the alarms of a drive object, with the titles that Siemens' lists print."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from plcgen.ds47 import messages
from plcgen.ds47.device import Device, Parameter
from plcgen.ds47.kinds.messages import ALARMS, FAULTS, PLACES
from plcgen.ds47.live.parameters import ElementReading, ParameterReader


@dataclass(frozen=True, slots=True)
class Entry:
    """One entry: whether it is a fault, its number, title and value, and which fault case or group it belongs to."""

    kind: str
    number: int
    title: str
    value: str
    case: int

    @property
    def code(self) -> str:
        """``F07901``."""
        return f"{self.kind}{self.number:05}"


def title(kind: str, number: int, device: Device | None) -> str:
    """What the lists of a device call it, or those of all families without one; several titles if they differ."""
    found = messages.find(number, device.messages if device is not None else tuple(messages.FAMILIES), kind)
    return " / ".join(dict.fromkeys(one.title for one in found))


def read_messages(
    reader: ParameterReader, device: Device | None, drive_object: int, groups: int
) -> tuple[list[Entry], list[ElementReading]]:
    """Entries of as many groups of eight (the first are present), and what could not be read."""
    found: list[Entry] = []
    missing: list[ElementReading] = []
    for kind, columns in (("F", FAULTS), ("A", ALARMS)):
        codes, values = (
            list(reader.read([(_column(device, columns[name]), range(PLACES * groups))], drive_object))
            for name in ("code", "value")
        )
        missing += [
            next(one for one in column if one.doubt) for column in (codes, values) if any(one.doubt for one in column)
        ]
        found += _entries(kind, codes, values, device)
    return found, missing


def _entries(
    kind: str, codes: list[ElementReading], values: list[ElementReading], device: Device | None
) -> Iterator[Entry]:
    for code, value in zip(codes, values, strict=True):
        if isinstance(code.value, int) and code.value:
            yield Entry(kind, code.value, title(kind, code.value, device), value.text, code.index // PLACES)


def _column(device: Device | None, pnu: int) -> Parameter:
    """The column as the device has it; Siemens' lists give these types to all families."""
    known = device.find(pnu) if device is not None else None
    types = {FAULTS["code"]: "Unsigned16", ALARMS["code"]: "Unsigned16"}
    return known if known is not None and known.type else Parameter(pnu, types.get(pnu, "Integer32"), access="r")
