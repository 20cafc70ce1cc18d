"""Faults that a simulated drive shows on demand: scriptable, counted, gone after so many uses."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from plcgen.ds47.wire.model import ErrorBlock
from plcgen.ds47.wire.status import status_of

if TYPE_CHECKING:
    from plcgen.ds47.wire.status import Direction


class FaultKind(enum.Enum):
    """What goes wrong; see ``KINDS``."""

    STATUS = "status"
    BUSY = "busy"
    LATE = "late"
    STALE = "stale"
    REFERENCE = "reference"
    RESPONSE_ID = "response_id"
    DRIVE_OBJECT = "drive_object"
    COUNT = "count"
    FORMAT = "format"
    CUT = "cut"
    JUNK = "junk"
    ERROR = "error"
    SILENCE = "silence"


KINDS: Mapping[FaultKind, tuple[str, tuple[str, ...]]] = {
    FaultKind.STATUS: ("WRREC or RDREC ends with this STATUS", ("call", "status")),
    FaultKind.BUSY: ("WRREC or RDREC ends with this error code, a temporary one by default", ("call", "code")),
    FaultKind.LATE: ("the response takes that much longer", ("milliseconds",)),
    FaultKind.STALE: ("the response before is delivered again", ()),
    FaultKind.REFERENCE: ("the response mirrors another request reference", ("value",)),
    FaultKind.RESPONSE_ID: ("the response has another response ID", ("value",)),
    FaultKind.DRIVE_OBJECT: ("the response is of another drive object", ("value",)),
    FaultKind.COUNT: ("the response has another number of parameters", ("value",)),
    FaultKind.FORMAT: ("the first value has another format", ("value",)),
    FaultKind.CUT: ("the response ends after that many bytes", ("value",)),
    FaultKind.JUNK: ("other bytes come instead of the response", ("data",)),
    FaultKind.ERROR: ("the drive refuses a parameter", ("number", "position", "words", "info")),
    FaultKind.SILENCE: ("the request is swallowed: no response, nothing is written", ()),
}
"""What happens, and the keys that count for it beside ``times`` and ``after``."""


_MIRROR_OFFSETS = {
    FaultKind.REFERENCE: 0,
    FaultKind.RESPONSE_ID: 1,
    FaultKind.DRIVE_OBJECT: 2,
    FaultKind.COUNT: 3,
    FaultKind.FORMAT: 4,
}

_JUNK = bytes.fromhex("DEADBEEF00FF55AA")


@dataclass(slots=True)
class Fault:
    """One fault: it lets ``after`` occasions pass, strikes ``times`` occasions (None: all), then is gone.

    An occasion is a WRREC or RDREC call for ``status`` and ``busy``, an accepted request for ``late``,
    ``error`` and ``silence``, a finished response for the others. ``value`` None puts some wrong value.
    """

    kind: FaultKind
    times: int | None = 1
    after: int = 0
    call: Direction = "read"
    status: int = 0
    code: int = 0xB5
    milliseconds: int = 0
    value: int | None = None
    data: bytes = _JUNK
    number: int = 0
    position: int = 1
    words: Literal[1, 2] = 2
    info: int = 0

    @property
    def spent(self) -> bool:
        """Whether the fault has struck as often as it should."""
        return self.times is not None and self.times <= 0

    def use(self) -> bool:
        """Count one occasion; True if the fault strikes on it."""
        if self.spent:
            return False
        if self.after > 0:
            self.after -= 1
            return False
        if self.times is not None:
            self.times -= 1
        return True

    def call_status(self) -> int:
        """STATUS of a struck WRREC or RDREC call."""
        return self.status if self.kind is FaultKind.STATUS else status_of(self.call, self.code)

    def error_block(self) -> ErrorBlock:
        """Error block of a struck parameter."""
        return ErrorBlock(self.number, self.info if self.words == 2 else None)


def damage(fault: Fault, response: bytes, previous: bytes | None) -> bytes:
    """Return the response as the struck drive delivers it."""
    if fault.kind is FaultKind.STALE:
        older = bytes((response[0] - 1 or 255, *response[1:]))
        return older if previous is None else previous
    if fault.kind is FaultKind.CUT:
        return response[: len(response) - 1 if fault.value is None else fault.value]
    if fault.kind is FaultKind.JUNK:
        return fault.data
    at = _MIRROR_OFFSETS[fault.kind]
    if at >= len(response):
        return response
    wrong = _wrong(fault.kind, response[at]) if fault.value is None else fault.value
    return response[:at] + bytes((wrong,)) + response[at + 1 :]


def _wrong(kind: FaultKind, right: int) -> int:
    """Return a value that is wrong for sure: the other service, an unknown format, the next number."""
    if kind is FaultKind.RESPONSE_ID:
        return right ^ 0x03
    if kind is FaultKind.FORMAT:
        return 0x0E
    if kind is FaultKind.REFERENCE:
        return right % 255 + 1
    return (right + 1) % 256


CALL_FAULTS = frozenset({FaultKind.STATUS, FaultKind.BUSY})
RESPONSE_FAULTS = frozenset({*_MIRROR_OFFSETS, FaultKind.STALE, FaultKind.CUT, FaultKind.JUNK})
