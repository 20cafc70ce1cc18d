"""What is done with single telegrams and codes: encode, decode, explain."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from plcgen.api.arguments import expect
from plcgen.base.diagnostics import ArgumentError, Diagnostic, has_errors

if TYPE_CHECKING:
    from collections.abc import Sequence

    from plcgen.base.display.page import Page
    from plcgen.base.telegrams.decoded import DecodedTelegram
    from plcgen.ds47.wire.model import ParameterAddress, ValueBlock
    from plcgen.ds47.wire.status import Status
    from plcgen.project.nouns import BlockRef


@dataclass(frozen=True, slots=True)
class EncodedTelegram:
    """A request as bytes: which job, which of its telegrams (from 1), the data block it lies in."""

    job: str
    index: int
    block: str
    data: bytes


@dataclass(frozen=True, slots=True)
class EncodeResult:
    """Requests as bytes, in the order in which they are sent."""

    telegrams: tuple[EncodedTelegram, ...]
    diagnostics: tuple[Diagnostic, ...]

    @property
    def ok(self) -> bool:
        """Whether no diagnostic is an error."""
        return not has_errors(self.diagnostics)


def encode_read(addresses: Sequence[ParameterAddress], *, drive_object: int = 1, reference: int = 1) -> bytes:
    """Return a read request. Raises TelegramError if a field does not fit or the record is too long."""
    from plcgen.ds47.wire.codec import encode_request
    from plcgen.ds47.wire.model import read_request

    return encode_request(read_request(reference, drive_object, addresses))


def encode_write(
    changes: Sequence[tuple[ParameterAddress, ValueBlock]], *, drive_object: int = 1, reference: int = 1
) -> bytes:
    """Return a change request. Raises TelegramError if a field does not fit or the record is too long."""
    from plcgen.ds47.wire.codec import encode_request
    from plcgen.ds47.wire.model import change_request

    return encode_request(change_request(reference, drive_object, changes))


def decode(
    data: bytes, *, kind: Literal["request", "response"] | None = None, request: bytes | None = None
) -> DecodedTelegram:
    """Take a telegram apart, as far as it goes; ``request`` gives a response its context.

    Raises:
        ArgumentError: if ``kind`` is another word.
    """
    from plcgen.ds47.texts import dissect_telegram

    expect("kind", kind, ("request", "response"))
    return dissect_telegram(data, kind, request)


def decode_status(value: int) -> Status:
    """Explain a STATUS double word of WRREC or RDREC. Raises ArgumentError if the value has more than 32 bits."""
    if not 0 <= value <= 0xFFFFFFFF:
        raise ArgumentError(f"{value} is not a STATUS double word, which has 32 bits")
    from plcgen.ds47.wire.status import explain_status

    return explain_status(value)


def explain(key: str, device: str = "") -> Page | None:
    """Explain a diagnostic code, DS47 error number, status word, STATUS, message or parameter; None if it is none.

    Messages and parameters are those of a device, or of all. Raises DiagnosticError, PG201, if there is no such device.
    """
    from plcgen.api.explanation import explain_page

    return explain_page(key, device)


def encode(spec: Path | str, job: str | None = None) -> EncodeResult:
    """Return the requests of all jobs of a spec, or of one job, with their start values."""
    from plcgen.base.diagnostics.suggest import job_hint
    from plcgen.project.opening import open_spec

    opened = open_spec(Path(spec))
    project = opened.usable
    if project is None:
        return EncodeResult((), opened.diagnostics)
    jobs = [planned for planned in project.jobs if job in {None, planned.key}]
    if not jobs:
        names = [planned.key for planned in project.jobs]
        hint = job_hint(job or "", names)
        span = project.loaded.key_span(("jobs",))
        unknown = Diagnostic("PG703", f'the spec has no job "{job}"', span, help=hint)
        return EncodeResult((), (*opened.diagnostics, unknown))
    telegrams = [
        EncodedTelegram(planned.key, number, _block_text(telegram.request.home), telegram.request.data)
        for planned in jobs
        for number, telegram in enumerate(planned.telegrams, 1)
    ]
    return EncodeResult(tuple(telegrams), opened.diagnostics)


def _block_text(ref: BlockRef) -> str:
    return f'{ref.kind}{ref.number} "{ref.name}"'
