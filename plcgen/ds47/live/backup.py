"""All parameters of a drive object that can be read, as a parameter list; and such a list held against a drive.

Which numbers there are, the drive says itself (r980 to r989), or else the lists of its device. How many elements an
array has is not asked for but found out: as many are read as the drive gives, and of those that are counted by data
sets (CDS, DDS) the first one shows how many there are.
"""

from __future__ import annotations

import csv
import io
import struct
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from plcgen.ds47 import guards
from plcgen.ds47.catalogue.lists import ListedParameter
from plcgen.ds47.catalogue.own_list import LISTS
from plcgen.ds47.device import Device, Parameter
from plcgen.ds47.live.channel import GENERIC, PnParameters, read_block
from plcgen.ds47.live.comparison import DEVIATES, EQUAL, UNREAD, LiveRow
from plcgen.ds47.live.parameters import ElementReading
from plcgen.ds47.types import read_type
from plcgen.ds47.wire import formats
from plcgen.ds47.wire.errors import error_text
from plcgen.ds47.wire.model import Block, ErrorBlock, ParameterAddress, ValueBlock

HEADINGS = ("Parameter", "Parameter text", "Online value", "Unit", "Data type")
CHUNK = 48
"""Parameters that are read together, and of which a broken-off backup has all or none."""
_ROUNDED = 1e-6
"""Share of a value that the list of an engineering tool may have rounded away."""
_MOST = 1024
"""Elements that are read of one parameter."""
_FEWER = {0x03, 0x04, 0x15, 0x16}
"""Errors of an index that is not there, of what is no array, of too long an answer, of too many elements."""


@dataclass(slots=True)
class _Gathering:
    """One parameter on its way: what has come, how many elements the next request asks for, 0 when it is over."""

    parameter: Parameter
    next: int
    exact: int | None
    blocks: list[ValueBlock] = field(default_factory=list)
    count: int = 0
    refused: ErrorBlock | None = None

    @property
    def address(self) -> ParameterAddress:
        return ParameterAddress(self.parameter.pnu, self.count, self.next)

    def take(self, block: Block, most: int) -> None:
        """Note an answer, and what to ask for now."""
        if isinstance(block, ValueBlock):
            self.blocks.append(block)
            self.count += self.next
            more = _MOST - self.count if self.exact is None else self.exact - self.count
            self.next = min(max(self.count, 1), more, most)
        elif isinstance(block, ErrorBlock) and block.number in _FEWER:
            there = (block.info or 0) - self.count
            self.next = there if 0 < there < self.next else self.next // 2
            if not self.next and not self.count:
                self.refused = block
        elif isinstance(block, ErrorBlock):
            self.refused = None if self.count else block
            self.next = 0


@dataclass(frozen=True, slots=True)
class SavedParameter:
    """What a drive object has of a parameter: its elements, or why there are none."""

    parameter: Parameter
    elements: Sequence[ElementReading]
    refusal: str = ""
    array: bool = False


def numbers(channel: PnParameters, device: Device, drive_object: int) -> Sequence[int]:
    """The parameters of a drive object: as it says itself, or as the lists of the device say; none if nobody does."""
    found: list[int] = []
    for number in LISTS:
        (own,) = gather(channel, [Parameter(number, "Unsigned16", access="r")], drive_object)
        values = [one.value for one in own.elements if isinstance(one.value, int) and one.value]
        found += [value for value in values if value not in LISTS]
        if not values or values[-1] not in LISTS:
            break
    return sorted(set(found)) or device.listed(device.object_type(drive_object))


def gather(
    channel: PnParameters, parameters: Sequence[Parameter], drive_object: int, sets: dict[str, int] | None = None
) -> Sequence[SavedParameter]:
    """Read parameters whole; ``sets`` are the numbers of data sets that are known, and takes new ones."""
    sets = {} if sets is None else sets
    most = min(channel.elements, (channel.limit - 6) // 4)
    under_way = [_Gathering(one, *_guess(one, sets, most)) for one in parameters]
    while asked := [one for one in under_way if one.next]:
        blocks = channel.ask([one.address for one in asked], [_size(one) for one in asked], drive_object)
        for one, block in zip(asked, blocks, strict=True):
            one.take(block, most)
            if not one.next and one.count and one.parameter.indexes in _SETS and not _is_string(one):
                sets.setdefault(one.parameter.indexes, one.count)
    return [_saved(one) for one in under_way]


_SETS = {"CDS", "DDS", "EDS", "MDS", "PDS"}


def _guess(parameter: Parameter, sets: Mapping[str, int], most: int) -> tuple[int, int | None]:
    """How many elements to ask for first, and how many there are if that is known."""
    octets = read_type(parameter.type)[1] if parameter.type and "[" in parameter.type else 0
    known = octets or parameter.array or sets.get(parameter.indexes)
    if known:
        return min(known, most if not octets else known), known
    if not parameter.indexes and parameter.type and parameter.grades.get("array") == "read":
        return 1, 1
    return 1, None


def _size(one: _Gathering) -> int:
    """Octets of a value: as it has come, or as the catalogue says."""
    if one.blocks:
        fmt = formats.find(one.blocks[0].format)
        return fmt.size if fmt is not None else 4
    return read_type(one.parameter.type)[0].size if one.parameter.type else 4


def _is_string(one: _Gathering) -> bool:
    fmt = formats.find(one.blocks[0].format) if one.blocks else None
    return fmt is not None and fmt.is_string


def _saved(one: _Gathering) -> SavedParameter:
    """The elements out of all answers, with the type that the drive says; the catalogue's if it says a size alone."""
    generic = bool(one.blocks) and one.blocks[0].format in GENERIC
    untyped = replace(one.parameter, type=one.parameter.type if generic else "")
    if one.refused is not None:
        return SavedParameter(untyped, (), f"error {error_text(one.refused.number).explain(one.refused.info)}")
    if not one.blocks:
        return SavedParameter(untyped, (), "no values came")
    first = one.blocks[0]
    data = b"".join(block.data for block in one.blocks)
    whole = ValueBlock(first.format, sum(block.count for block in one.blocks), data)
    string = _is_string(one)
    indexes = range(1 if string else one.count)
    known = not string and (one.parameter.array is not None or bool(one.parameter.indexes))
    return SavedParameter(untyped, list(read_block(untyped, indexes, whole)), array=known or len(indexes) > 1)


def backup(
    channel: PnParameters, device: Device, drive_object: int, wanted: Sequence[int], told: Callable[[int], None]
) -> Iterator[Sequence[SavedParameter]]:
    """Parameters in chunks; ``told`` hears how many are done."""
    object_type = device.object_type(drive_object)
    sets: dict[str, int] = {}
    for at in range(0, len(wanted), CHUNK):
        chunk = wanted[at : at + CHUNK]
        known = [device.find(number, object_type) or Parameter(number, "", access="rw") for number in chunk]
        yield gather(channel, known, drive_object, sets)
        told(at + len(chunk))


def rows(one: SavedParameter) -> Iterator[Sequence[str]]:
    """Lines of the list."""
    letter = "r" if guards.why_read_only("", one.parameter.pnu, catalogued=one.parameter.access) else "p"
    name = f"{letter}{one.parameter.pnu}"
    for element in one.elements:
        shown = f"{name}[{element.index}]" if one.array else name
        yield shown, one.parameter.title, value_text(element), one.parameter.unit, element.parameter.type


def lines(table: Iterable[Sequence[str]]) -> str:
    """Lines of a CSV file."""
    out = io.StringIO()
    csv.writer(out, delimiter=";", lineterminator="\n").writerows(table)
    return out.getvalue()


def value_text(element: ElementReading) -> str:
    """A value for a list: read again, it is the same. Octets, and what is no number, are hexadecimal."""
    value = element.value
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, float):
        return _real(value, read_type(element.parameter.type)[0].size)
    if isinstance(value, int) and element.parameter.bico and value >> 16:
        return element.text
    if isinstance(value, int):
        return str(value)
    return value.rstrip("\0 ") if isinstance(value, str) else f"16#{element.data.hex().upper()}"


def _real(value: float, size: int) -> str:
    """The shortest decimal number that is this REAL; never one whose point may be taken for one of thousands."""
    form: Literal[">f", ">d"] = ">f" if size == 4 else ">d"
    wanted = struct.pack(form, value)
    text = next(one for digits in range(6, 18) if struct.pack(form, float(one := f"{value:.{digits}g}")) == wanted)
    whole, point, part = text.partition(".")
    return f"{text}0" if point and len(part) == 3 and len(whole.lstrip("-")) <= 3 else text


def compare_list(
    channel: PnParameters, listed: Sequence[ListedParameter], place: str, device: Device, drive_object: int
) -> Iterator[LiveRow]:
    """Every adjustable value of a list, against the drive; what a drive sets back by itself says nothing."""
    object_type = device.object_type(drive_object)
    there = [one for one in listed if one.values and one.letter != "r" and one.pnu not in guards.SET_BACK]
    for at in range(0, len(there), CHUNK):
        chunk = there[at : at + CHUNK]
        known = [device.find(one.pnu, object_type) or Parameter(one.pnu, one.type) for one in chunk]
        counted = [replace(one, array=max(wanted.values) + 1 if max(wanted.values) or wanted.indexes else one.array)
                   for one, wanted in zip(known, chunk, strict=True)]  # fmt: skip
        for wanted, found in zip(chunk, gather(channel, counted, drive_object), strict=True):
            yield from _against(wanted, found, place)


def _against(wanted: ListedParameter, found: SavedParameter, place: str) -> Iterator[LiveRow]:
    elements = {one.index: one for one in found.elements}
    title, unit = found.parameter.title or wanted.title, found.parameter.unit or wanted.unit
    for index, value in sorted(wanted.values.items()):
        subject = f"p{wanted.pnu}" + (f"[{index}]" if wanted.indexes else "")
        one = elements.get(index)
        told = str(value) if isinstance(value, str) else f"{value:.9g}"
        if one is None or one.doubt:
            why = found.refusal or (one.doubt if one else f"the drive has no index {index}")
            yield LiveRow(subject, place, told, "", UNREAD, why, title, unit)
            continue
        shown = value_text(one)
        if isinstance(value, str) or not isinstance(one.value, int | float):
            same = shown == str(value).rstrip()
        else:
            same = abs(value - one.value) <= _ROUNDED * max(abs(value), abs(one.value))
        yield LiveRow(subject, place, told, shown, EQUAL if same else DEVIATES, "", title, unit)
