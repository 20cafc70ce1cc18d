"""Faults that a simulated PPI bus shows on demand: scriptable, counted, gone after so many uses; their text form."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationInfo, field_validator

from plcgen.base.files.options import read_fault
from plcgen.base.files.validation import FileShape, Octets, StrictModel, counting, problem, validate_option
from plcgen.base.files.yaml import resolve_plain
from plcgen.ppi.wire.areas import Area, SizeCode
from plcgen.ppi.wire.fdl import SD1, checksum, encode_frame, examine_frame
from plcgen.ppi.wire.model import (
    ACKNOWLEDGE,
    Acknowledgement,
    Frame,
    Item,
    ItemResult,
    ReadReply,
    ReadRequest,
    TokenFrame,
    VariableFrame,
)
from plcgen.ppi.wire.telegram import encode_poll, encode_reply, encode_request

At = Literal["any", "request", "poll"]


class FaultKind(enum.Enum):
    """What goes wrong; see ``KINDS``."""

    DEAF = "deaf"
    SILENCE = "silence"
    NOT_READY = "not_ready"
    FCS = "fcs"
    LATE = "late"
    CUT = "cut"
    GARBAGE = "garbage"
    NOISE = "noise"
    CLIPPED = "clipped"
    ECHO = "echo"
    FOREIGN = "foreign"
    TOKEN = "token"  # noqa: S105 - of a token ring
    STALE = "stale"
    REFERENCE = "reference"
    ADDRESS = "address"
    FUNCTION = "function"
    NACK = "nack"
    COUNT = "count"
    LENGTH = "length"
    ITEM = "item"
    HEADER = "header"


KINDS: Mapping[FaultKind, tuple[str, tuple[str, ...]]] = {
    FaultKind.DEAF: ("the station does not hear the frame: no answer, nothing is executed", ()),
    FaultKind.SILENCE: ("the station hears and executes, but its answer is lost", ()),
    FaultKind.NOT_READY: ("E5 to a poll although the answer is there", ()),
    FaultKind.FCS: ("checksum of the answer, one too high by default", ("value",)),
    FaultKind.LATE: ("the answer comes that much later", ("milliseconds",)),
    FaultKind.CUT: ("so many bytes of the answer arrive, by default all but the last two", ("value",)),
    FaultKind.GARBAGE: ("other bytes come instead of the answer", ("data",)),
    FaultKind.NOISE: ("other bytes come before the answer", ("data",)),
    FaultKind.CLIPPED: ("the acknowledgement E5 with its first bits lost, F9h by default", ("value",)),
    FaultKind.ECHO: ("the frame comes back before its answer, as from an RS-485 adapter that hears itself", ()),
    FaultKind.FOREIGN: ("an exchange of another master with another station before the answer", ("data",)),
    FaultKind.TOKEN: ("token frames of other masters before the answer", ("data",)),
    FaultKind.STALE: ("the answer before comes again, else this one with the reference before", ("value",)),
    FaultKind.REFERENCE: ("PDU reference of the answer, one too high by default", ("value",)),
    FaultKind.ADDRESS: ("source of the answer, the next station by default", ("value",)),
    FaultKind.FUNCTION: ("function code of the answer, 02h by default", ("value",)),
    FaultKind.NACK: ("a short refusal (01h, 02h, 03h) instead of the answer, nothing is executed", ("value",)),
    FaultKind.COUNT: ("item count of the answer, one too high by default", ("value",)),
    FaultKind.LENGTH: ("length of the first value of the answer, one byte more by default", ("value",)),
    FaultKind.ITEM: ("that item is refused with this return code", ("item", "code")),
    FaultKind.HEADER: ("the job is refused with this error, 8404h (busy) by default", ("code",)),
}
"""What happens, and the keys that count for it beside ``times``, ``after``, ``at`` and ``station``."""


@dataclass(slots=True)
class Fault:
    """One fault: it lets ``after`` occasions pass, strikes ``times`` occasions (None: all), then is gone.

    An occasion is a frame to a station (``at``: a request, a poll, or both) whose answer the fault can damage.
    ``station`` None means every station. ``value`` None puts some wrong value.
    """

    kind: FaultKind
    times: int | None = 1
    after: int = 0
    at: At = "any"
    station: int | None = None
    value: int | None = None
    milliseconds: int = 500
    data: bytes = b""
    item: int = 1
    code: int | None = None

    @property
    def spent(self) -> bool:
        """Whether the fault has struck as often as it should."""
        return self.times is not None and self.times <= 0

    def meets(self, station: int, frame: Frame) -> bool:
        """Whether a frame to a station is an occasion."""
        if self.station is not None and self.station != station:
            return False
        return self.at == "any" or (self.at == "request") == isinstance(frame, VariableFrame)

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


BEFORE = frozenset({FaultKind.ECHO, FaultKind.FOREIGN, FaultKind.TOKEN, FaultKind.NOISE})
"""Faults that put something in front of the answer."""

DAMAGING = frozenset({
    FaultKind.FCS, FaultKind.CUT, FaultKind.GARBAGE, FaultKind.CLIPPED, FaultKind.STALE, FaultKind.REFERENCE,
    FaultKind.ADDRESS, FaultKind.FUNCTION, FaultKind.COUNT, FaultKind.LENGTH,
})  # fmt: skip
"""Faults that change the answer itself."""

_WITH_CHECKSUM = frozenset({FaultKind.FCS, FaultKind.CUT, FaultKind.ADDRESS, FaultKind.FUNCTION})
_LEAST_PDU = {FaultKind.COUNT: 14, FaultKind.LENGTH: 18}
"""A read answer has a count behind 12 + 1 bytes, the length of its first value behind 12 + 2 + 2."""

_GARBAGE = bytes.fromhex("00FF6816681055AA")
_PDU = 7


def can_damage(fault: Fault, answer: Frame) -> bool:
    """Whether this answer has what the fault damages: a checksum, a reference, a length."""
    if fault.kind is FaultKind.CLIPPED:
        return isinstance(answer, Acknowledgement)
    if fault.kind is FaultKind.GARBAGE:
        return True
    if fault.kind in _WITH_CHECKSUM:
        return not isinstance(answer, Acknowledgement)
    return isinstance(answer, VariableFrame) and len(answer.pdu) >= _LEAST_PDU.get(fault.kind, 6)


def damage(fault: Fault, raw: bytes, previous: bytes | None) -> bytes:
    """Return the bytes of an answer as they arrive at the master.

    ``raw`` are the bytes that ``can_damage`` found fit, ``previous`` is the data answer before it.
    """
    kind, value = fault.kind, fault.value
    if kind is FaultKind.GARBAGE:
        return fault.data or _GARBAGE
    frame = examine_frame(raw)[0]
    if frame is None or not can_damage(fault, frame):
        return raw  # another fault has left nothing to damage
    if kind is FaultKind.CLIPPED:
        return _byte(0xF9 if value is None else value)
    if kind is FaultKind.CUT:
        return raw[:-2] if value is None else raw[:value]
    if kind is FaultKind.STALE and previous is not None:
        return previous
    if kind is FaultKind.FCS:
        return raw[:-2] + _byte(raw[-2] + 1 if value is None else value) + raw[-1:]
    changed = bytearray(raw)
    source = 2 if changed[0] == SD1 else 5
    if kind is FaultKind.ADDRESS:
        changed[source] = (changed[source] + 1) % 127 if value is None else value & 0xFF
    elif kind is FaultKind.FUNCTION:
        changed[source + 1] = 0x02 if value is None else value & 0xFF
    elif kind is FaultKind.COUNT:
        at = _PDU + 13
        changed[at] = (changed[at] + 1 if value is None else value) & 0xFF
    elif kind is FaultKind.LENGTH:
        bits = changed[_PDU + 15] in {SizeCode.BIT, SizeCode.WORDS}
        _add(changed, _PDU + 16, 8 if bits else 1, value)
    else:
        _add(changed, _PDU + 4, -1 if kind is FaultKind.STALE else 1, value)
    first = 1 if raw[0] == SD1 else 4
    changed[-2] = checksum(bytes(changed[first:-2]))
    return bytes(changed)


def _add(raw: bytearray, at: int, step: int, value: int | None) -> None:
    wrong = int.from_bytes(raw[at : at + 2]) + step if value is None else value
    raw[at : at + 2] = (wrong & 0xFFFF).to_bytes(2)


def _byte(value: int) -> bytes:
    return bytes((value & 0xFF,))


def before(fault: Fault, frame: bytes) -> bytes:
    """Return what a fault puts in front of the answer to ``frame``."""
    if fault.kind is FaultKind.ECHO:
        return frame
    if fault.data:
        return fault.data
    if fault.kind is FaultKind.TOKEN:
        return encode_frame(TokenFrame(3, 1)) + encode_frame(TokenFrame(1, 3))
    if fault.kind is FaultKind.NOISE:
        return b"\x00\xff"
    item = Item.memory(Area.V, 0)
    return (
        encode_request(ReadRequest(0x4711, (item,)), destination=6, source=1)
        + bytes((ACKNOWLEDGE,))
        + encode_poll(destination=6, source=1, function=0x5C)
        + encode_reply(ReadReply(0x4711, (ItemResult.of(item, b"\x99"),)), destination=1, source=6)
    )


MOST = 1_000_000
_FAULT = Fault(FaultKind.SILENCE)
_FOR_EVER = ("always", "forever")


class FaultKeys(StrictModel):
    """One fault: see ``Fault``."""

    kind: Annotated[FaultKind, Field(strict=False)] = Field(description="what goes wrong")
    times: Annotated[int, Field(ge=1, le=MOST)] | Literal["once", "always", "forever"] = Field(
        1, description="how often it strikes"
    )
    after: int = Field(_FAULT.after, ge=0, le=MOST, description="how many occasions pass first")
    at: At = Field(_FAULT.at, description="the frame whose answer is damaged")
    station: int | None = Field(None, ge=0, le=126, description="this address only")
    value: int | None = Field(None, ge=0, le=0xFFFF, description="the wrong value; see the kind")
    milliseconds: int = Field(_FAULT.milliseconds, ge=0, le=MOST, description="how much later the answer comes")
    data: Octets = Field(_FAULT.data, description="other bytes, hexadecimal")
    item: int = Field(_FAULT.item, ge=1, le=19, description="which item is refused")
    code: int | None = Field(None, ge=1, le=0xFFFF, description="return code of the item, or error of the header")

    @field_validator("*")
    @classmethod
    def _counts(cls, value: Any, info: ValidationInfo) -> Any:
        """Refuse a key that does nothing for the kind."""
        return counting(value, info, KINDS)

    @field_validator("code")
    @classmethod
    def _is_an_error(cls, code: int | None, info: ValidationInfo) -> int | None:
        """Return code of an item (not FFh, success) or error of a header (not 0)."""
        if code is not None and code > 0xFE and info.data.get("kind") is FaultKind.ITEM:
            raise problem(f"the return code of an item is 1 to 254, not {code}")
        return code

    def fault(self) -> Fault:
        """Build the fault."""
        times = None if self.times in _FOR_EVER else 1 if self.times == "once" else self.times
        return Fault(**{**dict(self), "times": times})


_OPTION = FileShape(FaultKeys, "the fault", "a fault is a mapping")


def parse_fault(text: str) -> Fault:
    """Read ``KIND[:KEY=VALUE,...]`` as the command line takes it. Raises DiagnosticError.

    ``times`` is ``once``, a number or ``always``.
    """
    option = f"--fault {text}"
    entry = read_fault(text, option, [item.value for item in FaultKind], _plain)
    return validate_option(entry, option, _OPTION).fault()


def _plain(key: str, text: str) -> Any:
    return text if key == "data" else _hexadecimal(text) if key == "code" else resolve_plain(text)


def _hexadecimal(text: str) -> Any:
    """Codes are hexadecimal, as manuals print them: 05, 8404, 8404h."""
    try:
        return int(text.removesuffix("h").removeprefix("16#"), 16)
    except ValueError:
        return text
