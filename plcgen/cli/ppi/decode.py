"""``plcgen ppi decode``: telegrams and whole captures, byte by byte."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.base.diagnostics import Diagnostic, Severity, Span
from plcgen.cli.arguments import ARGUMENTS
from plcgen.cli.hexbytes import MAX_INPUT, STDIN, read_stdin, require_size
from plcgen.cli.options import PATH, console, format_option, verb

if TYPE_CHECKING:
    from plcgen.cli.ppi.capture import Capture
    from plcgen.ppi.texts import DecodedFrame
    from plcgen.report.registry import OutputFormat


@verb(
    "decode",
    "plcgen ppi decode 68 16 16 68 00 02 08 32 03 00 00 00 00 00 02 00 05 00 00 04 01 FF 04 00 08 22 78 16",
    "plcgen ppi decode F9 --tolerant",
    "plcgen ppi decode --file capture.txt --short",
    "plcgen ppi encode read VB100 | plcgen ppi decode --json",
)
@click.argument("hex_", nargs=-1, metavar="[HEX...]")
@click.option("--file", "file", type=PATH, metavar="FILE", help="Read a capture: hexadecimal lines, or raw bytes.")
@click.option(
    "--tolerant",
    is_flag=True,
    help="Accept and report what real lines produce (F9 instead of E5, padding, constant FC).",
)
@click.option("-s", "--short", is_flag=True, help="One line per telegram.")
@format_option("answer")
def command(*, hex_: tuple[str, ...], file: Path | None, tolerant: bool, short: bool, format_: OutputFormat) -> int:
    """Explain PPI telegrams byte by byte: from arguments, a file or stdin.

    All bytes form one stream, in which the frames are found; bytes that belong to no frame are reported. An answer is
    shown with the addresses of the request before it. Exit code 1 if anything is malformed.
    """
    from plcgen.cli.ppi.capture import SPELLINGS
    from plcgen.ppi.texts import decode_pieces, telegrams_answer

    if hex_ and file is not None:
        raise click.UsageError("give the bytes as arguments or with --file, not both")
    capture, known = _capture(hex_, file)
    found = list(capture.problems)
    telegrams = decode_pieces(capture.pieces(tolerant=tolerant), tolerant=tolerant)
    for telegram in telegrams:
        found += _diagnostics(telegram, capture)
    if not telegrams and not found:
        found.append(Diagnostic("PG701", "there are no bytes to decode", Span(capture.name), help=SPELLINGS))
    return console().answer(format_, telegrams_answer(telegrams, found, short=short), known=known)


def _capture(hex_: Sequence[str], file: Path | None) -> tuple[Capture, dict[str, str]]:
    from plcgen.cli.ppi.capture import Capture, capture_of

    if hex_:
        text = " ".join(hex_)
        capture = Capture(ARGUMENTS)
        capture.add_line(text, 1)
        return capture, {ARGUMENTS: text}
    if file is None:
        data = read_stdin(", as --file")
        return capture_of(STDIN, data), {STDIN: data.decode("utf-8", "replace")}
    from plcgen.base.files.files import read_bounded

    data = read_bounded(file, MAX_INPUT)
    require_size(data, str(file))
    return capture_of(str(file), data), {}


def _diagnostics(telegram: DecodedFrame, capture: Capture) -> list[Diagnostic]:
    return [
        Diagnostic(
            "PG710",
            f"{mark}{_place(telegram, p.offset)}: {p.message}",
            capture.span(telegram.offset + p.offset),
            severity,
        )
        for mark, severity, problems in (
            ("", Severity.ERROR, telegram.problems),
            ("tolerated: ", Severity.WARNING, telegram.tolerated),
        )
        for p in problems
    ]


def _place(telegram: DecodedFrame, offset: int) -> str:
    """Where a byte is: in the capture, and in its frame if that begins later."""
    if telegram.offset and telegram.framed:
        return f"byte {offset} of the frame at byte {telegram.offset}"
    return f"byte {telegram.offset + offset}"
