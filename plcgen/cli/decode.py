"""``plcgen decode``: telegrams and STATUS values, byte by byte."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import click

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.base.telegrams.hexbytes import HexError, HexText, hex_problem, parse_hex, strip_comment
from plcgen.cli.arguments import ARGUMENTS
from plcgen.cli.hexbytes import STDIN, read_stdin
from plcgen.cli.options import console, format_option, verb
from plcgen.cli.output import PROBLEMS

if TYPE_CHECKING:
    from plcgen.base.telegrams.decoded import DecodedTelegram
    from plcgen.report.registry import OutputFormat

REQUEST = "<request>"
_SPELLINGS = "write bytes as 03 01, 0301, 16#03, 0x03, 03h or W#16#0101, one telegram per line"


@verb(
    "decode",
    "plcgen decode 03 01 02 01 10 01 C4 7F 00 00",
    'plcgen decode 0301020108014120 0000 --request "0301020110 01C47F0000"',
    "plcgen encode job.yaml | plcgen decode",
    "plcgen decode --status DF80B500",
)
@click.argument("hex_", nargs=-1, metavar="[HEX...]")
@click.option(
    "--as",
    "kind",
    type=click.Choice(["request", "response"]),
    help="Treat it as this kind instead of deciding by its bytes.",
)
@click.option("--request", metavar="HEX", help="Request that the response answers, for names and checks.")
@click.option("--status", is_flag=True, help="HEX is a STATUS double word of WRREC or RDREC.")
@format_option("answer")
def command(
    *,
    hex_: tuple[str, ...],
    kind: Literal["request", "response"] | None,
    request: str | None,
    status: bool,
    format_: OutputFormat,
) -> int:
    """Explain telegrams of data set 47 byte by byte, from arguments or from stdin.

    All arguments together are one telegram; on stdin every line is one. Requests and responses are told
    apart by their bytes. Exit code 1 if a telegram is malformed.
    """
    from plcgen.ds47.texts import telegrams_answer

    out = console()
    if status:
        return _status(hex_, format_)
    known = {ARGUMENTS: " ".join(hex_), REQUEST: request or ""}
    found: list[Diagnostic] = []
    context = _read(known[REQUEST], REQUEST, 1, found) if request is not None else None
    if hex_:
        lines, name = [known[ARGUMENTS]], ARGUMENTS
    else:
        text = read_stdin("").decode("utf-8-sig", "replace").replace("\r\n", "\n").replace("\r", "\n")
        known[STDIN], lines, name = text, text.split("\n"), STDIN
    telegrams: list[DecodedTelegram] = []
    for number, line in enumerate(lines, 1):
        body = strip_comment(line)
        if not body.strip():
            continue
        parsed = _read(body, name, number, found)
        if parsed is not None:
            telegrams.append(_decode(parsed, name, number, kind, context, found))
    if not telegrams and not found:
        found.append(Diagnostic("PG701", "there are no bytes to decode", Span(name), help=_SPELLINGS))
    return out.answer(format_, telegrams_answer(telegrams, found), known=known)


def _read(text: str, name: str, line: int, found: list[Diagnostic]) -> HexText | None:
    try:
        return parse_hex(text)
    except HexError as problem:
        found.append(hex_problem(problem, name, line, _SPELLINGS))
        return None


def _decode(
    parsed: HexText,
    name: str,
    line: int,
    kind: Literal["request", "response"] | None,
    context: HexText | None,
    found: list[Diagnostic],
) -> DecodedTelegram:
    from plcgen import api

    telegram = api.decode(parsed.data, kind=kind, request=context.data if context else None)
    for offset, message in telegram.problems:
        column, length = parsed.place(offset)
        span = Span(name, line, column + 1, line, column + 1 + length)
        found.append(Diagnostic("PG702", f"byte {offset}: {message}", span))
    return telegram


def _status(hex_: tuple[str, ...], format_: OutputFormat) -> int:
    from plcgen import api
    from plcgen.ds47.texts import status_answer

    out = console()
    text = " ".join(hex_)
    if not text:
        raise click.UsageError("--status needs a value, for example DF80B500")
    found: list[Diagnostic] = []
    parsed = _read(text, ARGUMENTS, 1, found)
    if parsed is not None and len(parsed.data) != 4:
        span = Span(ARGUMENTS, 1, 1, 1, len(text) + 1)
        message = f"a STATUS has 4 bytes, not {len(parsed.data)}"
        found.append(Diagnostic("PG701", message, span, help="for example DF80B500 or DW#16#DF80B500"))
    if found or parsed is None:
        out.complain(found, {ARGUMENTS: text})
        return PROBLEMS
    return out.answer(format_, status_answer(api.decode_status(int.from_bytes(parsed.data))))
