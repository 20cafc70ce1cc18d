"""Violations of the protocol: what is wrong, at which byte, and who would mind."""

from __future__ import annotations

import enum
from collections.abc import Iterable
from dataclasses import dataclass

from plcgen.base.diagnostics import PlcgenError


class Kind(enum.StrEnum):
    """What a violation is about: stable names for tests and tools."""

    START = "start"
    SHORT = "short"
    TRAILING = "trailing"
    LENGTH = "length"
    REPEATED_LENGTH = "repeated length"
    REPEATED_START = "repeated start"
    CHECKSUM = "checksum"
    END = "end"
    STATION = "station"
    FUNCTION_CODE = "function code"
    FRAME_COUNT = "frame count"
    ACKNOWLEDGEMENT = "acknowledgement"
    PROTOCOL = "protocol"
    ROSCTR = "rosctr"
    RESERVED = "reserved"
    PARAMETER_LENGTH = "parameter length"
    DATA_LENGTH = "data length"
    ITEM_COUNT = "item count"
    ITEM_HEADER = "item header"
    TRANSPORT_SIZE = "transport size"
    COUNT = "count"
    DATA_BLOCK = "data block"
    AREA = "area"
    ADDRESS = "address"
    SIZE_CODE = "size code"
    VALUE_LENGTH = "value length"
    VALUE = "value"
    PAD = "pad"
    RETURN_CODE = "return code"
    SERVICE = "service"
    LIMIT = "limit"
    MISMATCH = "mismatch"


TOLERABLE = frozenset({Kind.ACKNOWLEDGEMENT, Kind.PAD, Kind.FRAME_COUNT})
"""What real lines produce: accepted by ``ppi decode --tolerant``, and by the client."""


@dataclass(frozen=True, slots=True)
class Violation:
    """One thing that is wrong: kind, byte offset in what was decoded, and a sentence."""

    kind: Kind
    offset: int
    message: str


class PpiError(PlcgenError, ValueError):
    """Bytes that are no valid telegram, or values that make none: every violation, in order of the offsets."""

    def __init__(self, violations: Iterable[Violation]) -> None:
        self.violations: tuple[Violation, ...] = tuple(sorted(violations, key=lambda v: v.offset))
        super().__init__("; ".join(f"byte {v.offset}: {v.message}" for v in self.violations))

    @classmethod
    def of(cls, kind: Kind, message: str, offset: int = 0) -> PpiError:
        """Build the error of a single violation."""
        return cls([Violation(kind, offset, message)])

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """Kinds of the violations, in their order."""
        return tuple(violation.kind for violation in self.violations)
