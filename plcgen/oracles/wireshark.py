"""What Wireshark's dissector makes of parameter telegrams: frames as on a PROFINET wire, read by ``tshark``.

A request lies in an IODWrite request, an answer in an IODRead response, connectionless DCE/RPC over UDP port 34964
(IEC 61158-6-10). Only what lies inside the record is of interest; the rest is filled in as a controller would.
The dissector is ``packet-dcerpc-pn-io.c`` and ``packet-pn.c`` of the Wireshark project; versions differ in the formats
that they know.
"""

from __future__ import annotations

import json
import struct
import subprocess
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

PROFIDRIVE = "pn_io.profidrive.parameter."
UNKNOWN = "format.invalid"
"""Name of the field that the dissector shows for a format that it does not know."""
TIME = 300.0
"""Seconds that ``tshark`` may take."""

_PORT = 34964
_INTERFACE = bytes.fromhex("01 00 A0 DE 97 6C D1 11 82 71 00 A0 24 42 DF 7D")
_OBJECT = bytes.fromhex("00 00 A0 DE 97 6C D1 11 82 71 00 01 01 01 00 2A")
_READ, _WRITE = 2, 3
_ACTIVITY = bytes(15) + b"\1"
_AR = bytes(15) + b"\1"
"""Application relation: one without a number is something else, where the record does not follow the header."""
_LITTLE_ENDIAN = bytes((0x10, 0, 0))


@dataclass(frozen=True)
class WireRecord:
    """One record on the wire: what was written to it, and what was read from it."""

    index: int
    request: bytes
    answer: bytes


@dataclass(frozen=True)
class Dissected:
    """Fields of one telegram in their order: name without prefix, value as the dissector shows it."""

    fields: tuple[tuple[str, str], ...]

    @property
    def unknown(self) -> bool:
        """Whether a format was met that the dissector does not know."""
        return any(name == UNKNOWN for name, _ in self.fields)


class WiresharkError(RuntimeError):
    """``tshark`` did not do its work."""


def version(program: str) -> str | None:
    """First line of ``tshark --version``; None if the program at this path cannot say it."""
    try:
        done = subprocess.run([program, "--version"], capture_output=True, timeout=TIME, check=True)  # noqa: S603 - tshark itself
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.decode("utf-8", "replace").split("\n", 1)[0].strip().rstrip(".")


def run_tshark(program: str, records: Sequence[WireRecord]) -> list[tuple[Dissected, Dissected]]:
    """Request and answer of every record as the dissector reads them; ``program`` is the path of ``tshark``.

    Raises:
        WiresharkError: if ``tshark`` cannot be run.
    """
    shown = dissect(program, capture(records))
    found = [
        Dissected(tuple((name.removeprefix(PROFIDRIVE), text) for name, text in frame if name.startswith(PROFIDRIVE)))
        for frame in shown
    ]
    if len(found) != 4 * len(records):
        raise WiresharkError(f"tshark shows {len(found)} frames of {4 * len(records)}")
    return [(found[at], found[at + 3]) for at in range(0, len(found), 4)]


def dissect(program: str, data: bytes) -> list[list[tuple[str, str]]]:
    """Every field of every frame of a capture, name and value in order. Raises WiresharkError."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "records.pcap"
        path.write_bytes(data)
        command = [program, "-n", "-r", str(path), "-T", "json"]
        try:
            done = subprocess.run(command, capture_output=True, timeout=TIME, check=True)  # noqa: S603 - tshark, too
            packets = json.loads(done.stdout, object_pairs_hook=list)
        except (OSError, subprocess.SubprocessError, ValueError) as problem:
            raise WiresharkError(f"tshark failed: {problem}") from problem
    return [list(_fields(packet)) for packet in packets]


def capture(records: Iterable[WireRecord]) -> bytes:
    """A capture file: four frames a record, request and response of a write and of a read."""
    return datagrams(_calls(records))


def datagrams(sent: Iterable[tuple[bool, bytes]]) -> bytes:
    """A capture file of UDP datagrams on the port of PROFINET, each with whether it is an answer."""
    out = [struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 0xFFFF, 1)]
    for at, (response, data) in enumerate(sent):
        frame = _frame(data, response=response)
        out.append(struct.pack("<IIII", at // 1000, at % 1000, len(frame), len(frame)) + frame)
    return b"".join(out)


def _calls(records: Iterable[WireRecord]) -> Iterator[tuple[bool, bytes]]:
    for number, record in enumerate(records):
        done = _header(0x8009, record.index, len(record.answer)) + record.answer
        yield _call(number * 2, _WRITE, _header(0x0008, record.index, len(record.request)) + record.request)
        yield _call(number * 2, _WRITE, _header(0x8008, record.index, 0), response=True)
        yield _call(number * 2 + 1, _READ, _header(0x0009, record.index, 240))
        yield _call(number * 2 + 1, _READ, done, response=True)


def _header(block: int, index: int, length: int) -> bytes:
    """IODWriteReqHeader and its kin, 64 bytes: slot 1, subslot 1."""
    start = struct.pack(">HHBBH16sIHHHHI", block, 60, 1, 0, 0, _AR, 0, 1, 1, 0, index, length)
    return start + bytes(64 - len(start))


def _call(call: int, operation: int, blocks: bytes, *, response: bool = False) -> tuple[bool, bytes]:
    """DCE/RPC, and the array of bytes that all PROFINET operations have."""
    status_or_maximum = 0 if response else len(blocks)
    body = struct.pack("<IIIII", status_or_maximum, len(blocks), len(blocks), 0, len(blocks)) + blocks
    rpc = struct.pack("<BBBB", 4, 2 if response else 0, 0x20, 0) + _LITTLE_ENDIAN + b"\0"
    rpc += _OBJECT + _INTERFACE + _ACTIVITY
    return response, rpc + struct.pack("<IIIHHHHHBB", 0, 1, call, operation, 0xFFFF, 0xFFFF, len(body), 0, 0, 0) + body


def _frame(data: bytes, *, response: bool) -> bytes:
    """Ethernet, IP and UDP around a datagram."""
    here, there = (b"\x0a\0\0\1", b"\x0a\0\0\2") if not response else (b"\x0a\0\0\2", b"\x0a\0\0\1")
    udp = struct.pack(">HHHH", _PORT, _PORT, 8 + len(data), 0) + data
    ip = struct.pack(">BBHHHBBH4s4s", 0x45, 0, 20 + len(udp), 0, 0, 64, 17, 0, here, there) + udp
    return bytes(6) + b"\2\0\0\0\0\1" + b"\x08\0" + ip


def _fields(node: Any) -> Iterator[tuple[str, str]]:
    """Every field below a node of the JSON, in order; objects are lists of pairs."""
    if not isinstance(node, list):
        return
    for item in node:
        if isinstance(item, tuple) and isinstance(item[1], str):
            yield item
        else:
            yield from _fields(item[1] if isinstance(item, tuple) else item)
