"""``plcgen encode``: request telegrams as hex."""

from __future__ import annotations

from pathlib import Path

import click

from plcgen.cli.options import CONTEXT, Verb, common_options, console, json_option
from plcgen.cli.output import OK, PROBLEMS, Console
from plcgen.diagnostics import Diagnostic, DiagnosticError


@click.command(
    "encode",
    cls=Verb,
    context_settings=CONTEXT,
    examples=(
        "plcgen encode job.yaml",
        "plcgen encode job.yaml read_ramp_up",
        'plcgen encode read P50303 "P2155[1..2]" --do 2 --ref 3',
        "plcgen encode write P50304=100.0:FloatingPoint --do 2",
        "plcgen encode write ramp_down_time_1=100.0 --device sinamics-dcm",
    ),
)
@click.argument("words", nargs=-1, required=True, metavar="SPEC [JOB] | read P... | write P=VALUE:TYPE...")
@click.option("--do", "drive_object", type=click.IntRange(0, 255), help="Drive object.  [default: the device's, or 1]")
@click.option("--ref", "reference", type=click.IntRange(1, 255), default=1, help="Request reference.  [default: 1]")
@click.option("--device", metavar="DEVICE", help="Device profile: names, data types, drive object.")
@json_option
@common_options
@click.pass_context
def command(
    ctx: click.Context,
    words: tuple[str, ...],
    drive_object: int | None,
    reference: int,
    device: str | None,
    as_json: bool,  # noqa: FBT001 - click's signature
) -> int:
    """Print request telegrams as hex, one a line: of a spec's jobs, or of parameters given here.

    Types are those of data set 47 (FloatingPoint, Unsigned16, ...); with --device the catalogue knows them.
    A file that is called read or write is ./read or ./write.
    """
    out = console(ctx)
    verb, rest = words[0], words[1:]
    if verb in {"read", "write"}:
        if not rest:
            raise click.UsageError(f"{verb} needs a parameter, for example P50303", ctx)
        return _adhoc(out, verb, rest, (drive_object, reference, device), as_json=as_json)
    if len(words) > 2:
        raise click.UsageError("one spec and at most one job", ctx)
    if drive_object is not None or device is not None:
        raise click.UsageError("--do and --device go with read and write; a spec has its own", ctx)
    return _spec(out, Path(verb), rest[0] if rest else None, as_json=as_json)


def _spec(out: Console, spec: Path, job: str | None, *, as_json: bool) -> int:
    from plcgen import api

    result = api.encode(spec, job)
    rows = [
        {"job": t.job, "telegram": t.index, "block": t.block, "length": len(t.data), "hex": t.data.hex().upper()}
        for t in result.telegrams
    ]
    if as_json:
        _json(out, rows, result.diagnostics)
        return OK if result.ok else PROBLEMS
    out.complain(result.diagnostics)
    texts = [t.data.hex(" ").upper() for t in result.telegrams]
    width = max((len(text) for text in texts if len(text) <= 60), default=0)
    lines = [
        f"{text:<{width}}  // {t.job}{f' telegram {t.index}' if t.index > 1 else ''}, {t.block}, {len(t.data)} bytes\n"
        for text, t in zip(texts, result.telegrams, strict=True)
    ]
    if lines:
        out.result("".join(lines))
    return OK if result.ok else PROBLEMS


def _adhoc(
    out: Console, verb: str, words: tuple[str, ...], how: tuple[int | None, int, str | None], *, as_json: bool
) -> int:
    from plcgen import api
    from plcgen.cli import adhoc
    from plcgen.cli.arguments import ARGUMENTS, arguments
    from plcgen.diagnostics import Span
    from plcgen.protocols.ds47.wire.codec import TelegramError

    drive_object, reference, key = how
    try:
        device = adhoc.find_device(key)
        target = drive_object if drive_object is not None else device.drive_object if device else 1
        placed = arguments(words)
        if verb == "read":
            addresses = [adhoc.address(argument, argument.text, device) for argument in placed]
            data = api.encode_read(addresses, drive_object=target, reference=reference)
        else:
            changes = [adhoc.change(argument, device) for argument in placed]
            data = api.encode_write(changes, drive_object=target, reference=reference)
    except DiagnosticError as problem:
        found: tuple[Diagnostic, ...] = problem.diagnostics
    except TelegramError as problem:
        found = tuple(Diagnostic("PG703", item.message, Span(ARGUMENTS)) for item in problem.problems)
    else:
        row = {"job": verb, "telegram": 1, "block": "", "length": len(data), "hex": data.hex().upper()}
        if as_json:
            _json(out, [row], ())
        else:
            out.result(data.hex(" ").upper() + "\n")
        return OK
    if as_json:
        _json(out, [], found)
    else:
        out.complain(found, {ARGUMENTS: " ".join(words)})
    return PROBLEMS


def _json(out: Console, rows: list[dict[str, object]], found: tuple[Diagnostic, ...]) -> None:
    from plcgen.output.json import diagnostics_data, dump

    data = diagnostics_data("requests", found)
    out.result(dump({**data, "telegrams": rows}))
