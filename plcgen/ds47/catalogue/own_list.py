"""The list of parameters that a drive keeps of itself, read by a job and taken out of the CPU, or by ``live read``.

PROFIdrive parameters 980 to 989 are arrays of parameter numbers. Siemens' PROFIdrive example (AC4, function
``uPdrv_RfPnu00980``, after profile V4.2 table 144) gives them in the order of their numbers, leaves 980 to 989 out, and
fills up with zeros. By general knowledge a SINAMICS whose list is longer has the number of the next one in the last
element.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from plcgen.base.files.workbook import Row
from plcgen.ds47.catalogue.lists import ListedParameter, wrong
from plcgen.ds47.device import Device, Parameter

LISTS = range(980, 990)
_HEADINGS = 50
"""Rows at the top among which the headings are looked for."""
_NAMES = ("name", "parameter", "symbol")
_VALUES = (
    "monitor value", "beobachtungswert", "status value", "statuswert", "snapshot", "momentaufnahme",
    "actual value", "aktualwert", "value", "wert",
)  # fmt: skip
"""Columns of watch tables, data blocks (TIA Portal, STEP 7) and ``live read``; the first one with a value counts."""
_ELEMENT = re.compile(r'(?:.*[."])?[PpRr]0*(98[0-9])\[([0-9]{1,5})\]"?\Z')
_OTHER = re.compile(r"[PpRr](?!0*98[0-9]\b)[0-9]{1,5}(?:\[[0-9]{1,5}\])?\Z")
_NUMBER = re.compile(r"(?:[WwUuIiNnTt]{1,4}#)?(?:16#([0-9A-Fa-f]{1,8})|([0-9]{1,10}))\Z")


@dataclass(frozen=True, slots=True)
class OwnList:
    """Numbers that a drive has, each with its line of the file.

    ``continues`` is the list in which it goes on and which is not in the file; ``ended`` says whether its end is there.
    """

    lines: Mapping[int, int]
    continues: int | None
    ended: bool

    def parameters(self) -> Sequence[ListedParameter]:
        """The same as a parameter list, which says of each that it exists."""
        return [ListedParameter(pnu, "p", line=line) for pnu, line in sorted(self.lines.items())]


@dataclass(frozen=True, slots=True)
class Inventory:
    """What a drive has and what the catalogue knows of it: both, the drive alone, the catalogue alone."""

    both: Sequence[Parameter]
    drive: Sequence[int]
    catalogue: Sequence[Parameter]


@dataclass(frozen=True, slots=True)
class _Element:
    line: int
    value: int


def read_own_list(sheets: Sequence[Sequence[Row]], path: Path) -> OwnList | None:
    """Find the list in the rows of a file; None if the file is of another kind. Raises DiagnosticError, PG704."""
    cells = [[(line, _split(row)) for line, row in rows] for rows in sheets]
    arrays = next(filter(None, (_named(rows, path) for rows in cells)), {})
    if not arrays and len(cells) == 1:
        arrays = _plain(cells[0], path)
    return _joined(arrays, path) if arrays else None


def compare_own_list(device: Device, own: OwnList) -> Inventory:
    """Hold a list against the catalogue of a device."""
    known = [device.parameters[pnu] for pnu in sorted(device.parameters) if pnu not in LISTS]
    return Inventory(
        both=[one for one in known if one.pnu in own.lines],
        drive=sorted(own.lines.keys() - device.parameters.keys()),
        catalogue=[one for one in known if one.pnu not in own.lines],
    )


def _split(cells: Sequence[str]) -> list[str]:
    """The cells of a row; where there is no separator, words are cells."""
    return [cell.strip() for cell in cells] if len(cells) > 1 else " ".join(cells).split()


def _named(rows: Sequence[tuple[int, list[str]]], path: Path) -> dict[int, list[_Element]]:
    """Arrays by number, out of a table whose rows are named ``p980[12]``; none if there are other parameters, too."""
    columns = next(filter(None, (_columns(cells) for _, cells in rows[:_HEADINGS])), [])
    found: dict[int, dict[int, _Element]] = {}
    for line, cells in rows if columns else ():
        name, *values = (cells[at] if at < len(cells) else "" for at in columns)
        match = _ELEMENT.match(name)
        if match:
            element = _Element(line, _number(next(filter(None, values), ""), line, f"r{match[1]}[{match[2]}]", path))
            found.setdefault(int(match[1]), {})[int(match[2])] = element
        elif _OTHER.match(name):
            return {}
    for number, elements in found.items():
        gap = next((index for index in range(len(elements)) if index not in elements), None)
        if gap is not None:
            line = min(one.line for index, one in elements.items() if index > gap)
            raise wrong(path, f"r{number}[{gap}] is missing before this line", "copy the whole array", line)
    return {number: [elements[index] for index in sorted(elements)] for number, elements in found.items()}


def _columns(cells: Sequence[str]) -> Sequence[int]:
    """Where names and values are, if these are the headings."""
    words = [" ".join(cell.casefold().split()) for cell in cells]
    name = next((words.index(word) for word in _NAMES if word in words), None)
    values = [words.index(word) for word in _VALUES if word in words]
    return [] if name is None or not values else [name, *values]


def _plain(rows: Sequence[tuple[int, list[str]]], path: Path) -> dict[int, list[_Element]]:
    """Numbers alone, as one array; none if the file begins with something else."""
    each = [(line, cell) for line, cells in rows for cell in cells if cell]
    if not each or not _NUMBER.match(each[0][1]):
        return {}
    return {LISTS[0]: [_Element(line, _number(cell, line, "this", path)) for line, cell in each]}


def _number(text: str, line: int, what: str, path: Path) -> int:
    match = _NUMBER.match(text)
    number = -1 if match is None else int(match[1], 16) if match[1] else int(match[2])
    if not 0 <= number <= 0xFFFF:
        told = f'{what} is "{text[:20]}"' if text else f"{what} has no value"
        raise wrong(path, f"{told}: a parameter number is 0 to 65535", "show the values as decimal numbers", line)
    return number


def _joined(arrays: Mapping[int, Sequence[_Element]], path: Path) -> OwnList:
    """All numbers of the arrays, up to the zeros of each; a number of a list leads to the next one."""
    if LISTS[0] not in arrays:
        raise wrong(path, f"r{LISTS[0]} is missing: the list begins there", "copy that array, too")
    lines: dict[int, int] = {}
    led: set[int] = set()
    ended = False
    for number in sorted(arrays):
        values = list(_up_to_zeros(arrays[number], path))
        ended = len(values) < len(arrays[number])
        lines |= {one.value: one.line for one in values if one.value not in LISTS}
        last = values[-1].value if values else 0
        led |= {last} if last in LISTS else set()
    if not lines:
        raise wrong(path, "there is no number in the list", "start the job, and copy the values when it is done")
    missing = min(led - arrays.keys(), default=None)
    return OwnList(lines, missing, ended and missing is None)


def _up_to_zeros(elements: Sequence[_Element], path: Path) -> Iterator[_Element]:
    zero = False
    for one in elements:
        if zero and one.value:
            message = f"{one.value} comes after the 0 that ends such a list"
            raise wrong(path, message, "give the values in the order of their indexes", one.line)
        zero = zero or not one.value
        if not zero:
            yield one
