"""Memory of an S7-200 as a file, and back: with station, CPU type and time, piece by piece.

The file is YAML of which a person can read and compare the lines, 32 bytes each. As a file it ends with a hash, so
that a damaged one is not written into a machine.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path
from typing import Annotated

from pydantic import Field, model_validator

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Note, Severity, Span
from plcgen.base.display.cells import clean
from plcgen.base.files.printed import Printed
from plcgen.base.files.text import read_text
from plcgen.base.files.validation import FileShape, Octets, Problems, StrictModel, load_document, problem
from plcgen.ppi.client import Client, CpuInfo
from plcgen.ppi.client.values import Place
from plcgen.ppi.wire.address import PpiAddressError, address_text, parse_item
from plcgen.ppi.wire.areas import Area, TransportSize
from plcgen.ppi.wire.codes import return_code
from plcgen.ppi.wire.model import Item, ItemWrite
from plcgen.report.seal import has_seal, is_result

_PER_LINE = 32
_READ_FRAME, _WRITE_FRAME = 18, 28
"""Bytes of a PDU beside the value of its only item: 12 + 2 + 4, and 10 + 2 + 12 + 4."""

Tell = Callable[[str, int, int], None]
"""What is being done, bytes done, bytes in all."""


@dataclass(frozen=True, slots=True)
class Piece:
    """Consecutive bytes of one area."""

    item: Item
    data: bytes

    @property
    def address(self) -> str:
        """``VB0[10240]``."""
        return address_text(self.item)

    def part(self, start: int, end: int) -> Piece:
        """Some of its bytes."""
        item = Item.memory(Area(self.item.area), self.item.byte + start, end - start)
        return Piece(item, self.data[start:end])


@dataclass(frozen=True, slots=True)
class Backup:
    """What a station held at a time (ISO 8601)."""

    station: int
    cpu: str
    firmware: str
    time: str
    pieces: tuple[Piece, ...]

    def text(self) -> str:
        """The file."""
        head = f"# Memory of an S7-200: plcgen ppi restore, plcgen ppi compare\nstation: {self.station}\n"
        said = {"cpu": self.cpu, "firmware": self.firmware, "time": self.time}
        head += "".join(f"{key}: {json.dumps(text)}\n" for key, text in said.items()) + "memory:\n"
        lines = [head]
        for piece in self.pieces:
            lines.append(f"  - address: {piece.address}\n    hex:\n")
            rows = (piece.data[at : at + _PER_LINE] for at in range(0, len(piece.data), _PER_LINE))
            lines += [f'      - "{row.hex(" ").upper()}"\n' for row in rows]
        return "".join(lines)


@dataclass(frozen=True, slots=True)
class Difference:
    """Consecutive bytes that are not those of the backup."""

    backup: Piece
    now: bytes


class _Memory(StrictModel):
    address: str = Field(description="Bytes of one area, for example VB0[10240].", max_length=40)
    hex: Annotated[tuple[Octets, ...], Field(description="The bytes, in hexadecimal digits.", max_length=100_000)]

    @model_validator(mode="after")
    def _fits(self) -> _Memory:
        problems = Problems()
        with problems.at("address"):
            item = item_of(self.address)
            size = sum(map(len, self.hex))
            if size != item.octets:
                raise problem(f"{self.address} has {item.octets} bytes; the backup holds {size}")
        problems.raise_any()
        return self

    def piece(self) -> Piece:
        """Item and bytes."""
        return Piece(item_of(self.address), b"".join(self.hex))


class _File(StrictModel):
    station: int = Field(ge=0, le=126, description="Station that was read.")
    cpu: Printed = Field(description="CPU type that it reported.")
    firmware: Printed = Field("", description="Its firmware.")
    time: Printed = Field(description="When it was read, ISO 8601.")
    memory: Annotated[tuple[_Memory, ...], Field(description="What it held.", min_length=1, max_length=100)]


def item_of(address: str) -> Item:
    """The bytes that an address of a backup means. Raises PydanticCustomError, as validators do."""
    try:
        item = parse_item(address)
    except PpiAddressError as wrong:
        raise problem(wrong.message, code=wrong.code, help_=wrong.help) from None
    error = _unsuited(item)
    if error:
        raise problem(f"{address}: {error}", help_="for example VB0[10240]")
    return item


def require_bytes(items: Sequence[Item]) -> None:
    """Raise DiagnosticError if something cannot be in a backup."""
    wrong = [f"{address_text(item)}: {why}" for item in items if (why := _unsuited(item))]
    if wrong:
        help_ = "for example VB0[10240]"
        raise DiagnosticError([Diagnostic("PG716", text, Span("<arguments>"), help=help_) for text in wrong])


def _unsuited(item: Item) -> str:
    """Why an item cannot be in a backup, empty if it can."""
    if item.by_element or item.size != TransportSize.BYTE:
        return "a backup holds bytes"
    return "the system area cannot be restored" if item.area == Area.SYS else ""


def load_backup(path: Path) -> Backup:
    """Read a file. Raises DiagnosticError with everything wrong in it."""
    text = read_text(path)
    if has_seal(text.encode()) and not is_result(text.encode()):
        help_ = "take another backup; if you changed it on purpose, remove its last line"
        message = "the backup was changed or damaged since it was written"
        raise DiagnosticError([Diagnostic("PG726", message, Span(str(path)), help=help_)])
    shape = FileShape(_File, "the backup", "a backup is a mapping with station, cpu, time and memory")
    file = load_document(text, str(path), shape).model
    return Backup(file.station, file.cpu, file.firmware, file.time, tuple(each.piece() for each in file.memory))


def read_pieces(client: Client, items: Sequence[Item], tell: Tell) -> tuple[Piece, ...]:
    """Read memory, a telegram at a time. Raises DiagnosticError for the first item that is refused."""
    total, done, found = sum(item.octets for item in items), 0, []
    for item in items:
        data = bytearray()
        for part in _parts(Piece(item, bytes(item.octets)), client.pdu_limit - _READ_FRAME):
            (result,) = client.read_items([part.item])
            if not result.ok:
                raise _refused(client, part, result.code)
            data += result.data
            done += len(result.data)
            tell(part.address, done, total)
        found.append(Piece(item, bytes(data)))
    return tuple(found)


def back_up(client: Client, items: Sequence[Item], time: str, tell: Tell) -> Backup:
    """Read memory and what the station is. Raises DiagnosticError: no answer, or an item refused."""
    cpu = client.info()
    pieces = read_pieces(client, items, tell)
    return Backup(client.exchange.settings.station, clean(cpu.type), cpu.firmware, time, pieces)


def other_cpu(cpu: CpuInfo, backup: Backup, line: str, severity: Severity = Severity.ERROR) -> list[Diagnostic]:
    """What is to be told if a backup is of another CPU type: memory of other sizes and another meaning."""
    if clean(cpu.type) == backup.cpu:
        return []
    message = f"the backup is of a {backup.cpu}, the station is a {cpu.type}"
    return [Diagnostic("PG726", message, Span(line), severity, help="is --station the one you mean?")]


def compare(client: Client, backup: Backup, tell: Tell) -> tuple[Difference, ...]:
    """Read what a backup holds, and return what differs. Raises DiagnosticError as ``read_pieces``."""
    now = read_pieces(client, [piece.item for piece in backup.pieces], tell)
    return tuple(each for old, new in zip(backup.pieces, now, strict=True) for each in _differences(old, new.data))


def _differences(old: Piece, now: bytes) -> Iterator[Difference]:
    for same, run in groupby(range(len(now)), key=lambda at: old.data[at] == now[at]):
        if not same:
            places = list(run)
            start, end = places[0], places[-1] + 1
            yield Difference(old.part(start, end), now[start:end])


def restore(client: Client, backup: Backup, tell: Tell) -> tuple[Difference, ...]:
    """Write a backup, telegram by telegram, then read it back and return what is different nevertheless.

    Raises DiagnosticError: another CPU type, before anything is written; the first refused item or the first telegram
    without an answer, with a note of what is written already.
    """
    line = client.exchange.line.name
    wrong = other_cpu(client.info(), backup, line)
    if wrong:
        raise DiagnosticError(wrong)
    total, done, written = sum(len(piece.data) for piece in backup.pieces), 0, list[Piece]()
    for piece in backup.pieces:
        start = 0
        for part in _parts(piece, client.pdu_limit - _WRITE_FRAME):
            try:
                (result,) = client.write_items([(Place(part.address, part.item), ItemWrite(part.item, part.data))])
                if not result.ok:
                    raise _refused(client, part, result.code)
            except DiagnosticError as problems:
                already = [*written, *([piece.part(0, start)] if start else [])]
                raise DiagnosticError([_with_written(each, part, already) for each in problems.diagnostics]) from None
            start += len(part.data)
            done += len(part.data)
            tell(part.address, done, total)
        written.append(piece)
    return compare(client, backup, tell)


def _parts(piece: Piece, most: int) -> Iterator[Piece]:
    for at in range(0, len(piece.data), most):
        yield piece.part(at, min(at + most, len(piece.data)))


def _refused(client: Client, part: Piece, code: int) -> DiagnosticError:
    meaning = return_code(code)
    message = f"{part.address}: {code:02X}h, {meaning.text}"
    return DiagnosticError([Diagnostic("PG719", message, Span(client.exchange.line.name), help=meaning.help)])


def _with_written(problem_: Diagnostic, part: Piece, written: Sequence[Piece]) -> Diagnostic:
    """The problem, and how far restoring had come."""
    what = ", ".join(piece.address for piece in written) or "nothing"
    note = Note(f"restoring stopped at {part.address}; written already: {what}", problem_.span)
    return replace(problem_, notes=(*problem_.notes, note))
