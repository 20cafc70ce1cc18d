"""``plcgen encode``: request telegrams as hex."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.base.diagnostics import Diagnostic, DiagnosticError
from plcgen.cli.options import console, device_option, format_option, verb
from plcgen.cli.output import SENDS_NOTHING, Console

if TYPE_CHECKING:
    from plcgen.base.display.results import Answer
    from plcgen.report.registry import OutputFormat


@verb(
    "encode",
    "plcgen encode job.yaml",
    "plcgen encode job.yaml read_ramp_up",
    'plcgen encode read P50303 "P2155[1..2]" --do 2 --ref 3',
    "plcgen encode write P50304=100.0:FloatingPoint --do 2",
    "plcgen encode write ramp_down_time_1=100.0 --device sinamics-dcm",
)
@click.argument("words", nargs=-1, required=True, metavar="SPEC [JOB] | read P... | write P=VALUE:TYPE...")
@click.option("--do", "drive_object", type=click.IntRange(0, 255), help="Drive object.  [default: the device's, or 1]")
@click.option("--ref", "reference", type=click.IntRange(1, 255), default=1, help="Request reference.  [default: 1]")
@device_option("Device profile: names, data types, drive object.")
@format_option("answer")
def command(
    *, words: tuple[str, ...], drive_object: int | None, reference: int, device: str | None, format_: OutputFormat
) -> int:
    """Print request telegrams as hex, one per line: for a spec's jobs, or for parameters given here.

    Types are those of data set 47 (FloatingPoint, Unsigned16, ...); with --device the catalogue knows them.
    For a file that is called read or write, give ./read or ./write.
    """
    out = console()
    verb, rest = words[0], words[1:]
    if verb in {"read", "write"}:
        if not rest:
            raise click.UsageError(f"{verb} needs a parameter, for example P50303")
        return _adhoc(out, verb, rest, (drive_object, reference, device), format_)
    if len(words) > 2:
        raise click.UsageError("give one spec and at most one job")
    if drive_object is not None or device is not None:
        raise click.UsageError("--do and --device are for read and write; a spec has its own")
    return _spec(out, Path(verb), rest[0] if rest else None, format_)


def _spec(out: Console, spec: Path, job: str | None, format_: OutputFormat) -> int:
    from plcgen import api

    result = api.encode(spec, job)
    rows = [(t.job, t.index, t.block, t.data) for t in result.telegrams]
    texts = [data.hex(" ").upper() for *_, data in rows]
    width = max((len(text) for text in texts if len(text) <= 60), default=0)
    lines = [
        f"{text:<{width}}  // {job}{f' telegram {index}' if index > 1 else ''}, {block}, {len(data)} bytes\n"
        for text, (job, index, block, data) in zip(texts, rows, strict=True)
    ]
    return out.answer(format_, _answer(rows, "".join(lines), result.diagnostics))


def _adhoc(
    out: Console, verb: str, words: tuple[str, ...], how: tuple[int | None, int, str | None], format_: OutputFormat
) -> int:
    from plcgen.base.diagnostics import Span
    from plcgen.cli.arguments import ARGUMENTS
    from plcgen.ds47.wire.codec import TelegramError

    try:
        data = _telegram(verb, words, *how)
        found = _answer([(verb, 1, "", data)], data.hex(" ").upper() + "\n", ())
    except DiagnosticError as problem:
        found = _answer([], "", problem.diagnostics)
    except TelegramError as problem:
        found = _answer([], "", [Diagnostic("PG703", item.message, Span(ARGUMENTS)) for item in problem.problems])
    if verb == "write" and not found.diagnostics:
        out.say(SENDS_NOTHING)
    return out.answer(format_, found, known={ARGUMENTS: " ".join(words)})


def _telegram(verb: str, words: tuple[str, ...], drive_object: int | None, reference: int, key: str | None) -> bytes:
    from plcgen import api
    from plcgen.cli import adhoc
    from plcgen.cli.arguments import arguments

    device = adhoc.device_named(key)
    target = drive_object if drive_object is not None else device.drive_object if device else 1
    if verb == "read":
        addresses = [adhoc.parameter_address(argument, argument.text, device) for argument in arguments(words)]
        return api.encode_read(addresses, drive_object=target, reference=reference)
    changes = [adhoc.change(argument, device) for argument in arguments(words)]
    return api.encode_write(changes, drive_object=target, reference=reference)


def _answer(rows: Sequence[tuple[str, int, str, bytes]], text: str, found: Sequence[Diagnostic]) -> Answer:
    """Telegrams as (job, number, block, bytes)."""
    from plcgen.base.display.data import diagnostics_data
    from plcgen.base.display.results import Answer

    telegrams = [
        {"job": job, "telegram": index, "block": block, "length": len(data), "hex": data.hex().upper()}
        for job, index, block, data in rows
    ]
    return Answer({**diagnostics_data("requests", found), "telegrams": telegrams}, lambda _view: text, found)
