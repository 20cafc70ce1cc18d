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


@dataclass(frozen=True, slots=True)
class Buffer:
    """Where messages of a kind lie: the parameters that may have their numbers, and that of their values."""

    kind: str
    name: str
    codes: tuple[int, ...]
    values: int


BUFFERS = (
    Buffer("F", "faults", (FAULTS["code"], 947), FAULTS["value"]),  # MICROMASTER has r947 and no r945
    Buffer("A", "alarms", (ALARMS["code"],), ALARMS["value"]),
)


@dataclass(frozen=True, slots=True)
class Messages:
    """What a drive complains about; elements that could not be read; buffers that the device is not known to have."""

    entries: list[Entry]
    missing: list[ElementReading]
    unknown: list[str]


def read_messages(reader: ParameterReader, device: Device | None, drive_object: int, groups: int) -> Messages:
    """Entries of as many groups of eight; the first are present."""
    found = Messages([], [], [])
    for buffer in BUFFERS:
        number = next((pnu for pnu in buffer.codes if device is None or device.find(pnu) is not None), None)
        if number is None:
            found.unknown.append(buffer.name)
            continue
        columns = [_column(device, number, "Unsigned16"), _column(device, buffer.values, "Integer32")]
        codes, values = (list(reader.read([(one, range(PLACES * groups))], drive_object)) for one in columns)
        doubtful = [next((one for one in column if one.doubt), None) for column in (codes, values)]
        found.missing.extend(one for one in doubtful if one is not None)
        found.entries.extend(_entries(buffer.kind, codes, values, device))
    return found


def _entries(
    kind: str, codes: list[ElementReading], values: list[ElementReading], device: Device | None
) -> Iterator[Entry]:
    for code, value in zip(codes, values, strict=True):
        if isinstance(code.value, int) and code.value:
            yield Entry(kind, code.value, title(kind, code.value, device), value.text, code.index // PLACES)


def _column(device: Device | None, pnu: int, usual: str) -> Parameter:
    """The column as the device has it, or with the type that Siemens' lists give to all families."""
    known = device.find(pnu) if device is not None else None
    return known if known is not None and known.type else Parameter(pnu, usual, access="r")
