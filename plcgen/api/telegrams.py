"""What is done with single telegrams and codes: encode, decode, explain."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Sequence

    from plcgen.display.page import Page
    from plcgen.protocols.decoded import DecodedTelegram
    from plcgen.protocols.ds47.wire.model import ParameterAddress, ValueBlock
    from plcgen.protocols.ds47.wire.status import Status


def encode_read(addresses: Sequence[ParameterAddress], *, drive_object: int = 1, reference: int = 1) -> bytes:
    """Return a read request. Raises TelegramError if a field does not fit or the record is too long."""
    from plcgen.protocols.ds47.wire.codec import encode_request
    from plcgen.protocols.ds47.wire.model import read_request

    return encode_request(read_request(reference, drive_object, addresses))


def encode_write(
    changes: Sequence[tuple[ParameterAddress, ValueBlock]], *, drive_object: int = 1, reference: int = 1
) -> bytes:
    """Return a change request. Raises TelegramError if a field does not fit or the record is too long."""
    from plcgen.protocols.ds47.wire.codec import encode_request
    from plcgen.protocols.ds47.wire.model import change_request

    return encode_request(change_request(reference, drive_object, changes))


def decode(
    data: bytes, *, kind: Literal["request", "response"] | None = None, request: bytes | None = None
) -> DecodedTelegram:
    """Take a telegram apart, as far as it goes; ``request`` gives a response its context."""
    from plcgen.protocols.ds47.texts import dissect

    return dissect(data, kind, request)


def decode_status(value: int) -> Status:
    """Explain a STATUS double word of WRREC or RDREC."""
    from plcgen.protocols.ds47.wire.status import explain

    return explain(value)


def explain(key: str) -> Page | None:
    """Explain a diagnostic code, DS47 error number, status word or STATUS; None if it is none of these."""
    from plcgen.api.explanation import explain_page

    return explain_page(key)
