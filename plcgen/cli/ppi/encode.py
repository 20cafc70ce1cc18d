"""``plcgen ppi encode``: request telegrams as hex."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import click

from plcgen.base.diagnostics import Diagnostic, DiagnosticError
from plcgen.cli.arguments import ARGUMENTS
from plcgen.cli.options import console, format_option, verb
from plcgen.cli.output import SENDS_NOTHING
from plcgen.cli.ppi.places import cpu_option, symbols_option

if TYPE_CHECKING:
    from plcgen.ppi.symbols import SymbolTable
    from plcgen.ppi.wire.model import Request
    from plcgen.ppi.wire.profiles import CpuProfile
    from plcgen.report.registry import OutputFormat

_BARE = ("run", "stop", "setup", "poll")
_HARMLESS = frozenset({"read", "setup", "poll"})
_WITH_ITEMS = ("read", "write", "force", "unforce")


@dataclass(frozen=True, slots=True)
class _How:
    """Everything besides the items."""

    station: int
    source: int
    function: int
    reference: int
    pack: bool


@verb(
    "encode",
    "plcgen ppi encode read VB100 M0.0 --station 2",
    "plcgen ppi encode write VW100=1234 VD200:REAL=1.5",
    "plcgen ppi encode read VB0[500] --pack",
    "plcgen ppi encode poll --fcb 0",
    "plcgen ppi encode run --ref 7 | plcgen ppi decode",
)
@click.argument("words", nargs=-1, required=True, metavar="read A... | write A=VALUE... | run | stop | setup | poll")
@click.option("--station", type=click.IntRange(0, 126), default=2, help="Station of the PLC (DA).  [default: 2]")
@click.option("--source", type=click.IntRange(0, 126), default=0, help="Our own station (SA).  [default: 0]")
@click.option("--ref", "reference", type=click.IntRange(0, 65535), default=0, help="PDU reference.  [default: 0]")
@click.option("--first", is_flag=True, help="First request of a sequence: 6C (the default; poll: 5C).")
@click.option("--fcb", type=click.IntRange(0, 1), help="Frame count bit of a later request: 0 is 5C, 1 is 7C.")
@click.option("--pack", is_flag=True, help="Use as many telegrams as needed, and read neighbours together.")
@cpu_option
@symbols_option
@format_option("answer")
def command(
    *,
    words: tuple[str, ...],
    station: int,
    source: int,
    reference: int,
    first: bool,
    fcb: int | None,
    pack: bool,
    cpu: str | None,
    symbols: str | None,
    format_: OutputFormat,
) -> int:
    """Print PPI request telegrams as hex, one per line.

    Addresses: VB100, VW100, VD100, V100.3, M0.0, SMB34, AIW0, T32, C5, HC0, VB100[20]; a type after a colon:
    VD100:REAL, VW100:INT, VB0[21]:STRING. German mnemonics (EB0, A0.0, Z5) work as well.
    """
    from plcgen.base.display.data import diagnostics_data
    from plcgen.base.display.results import Answer
    from plcgen.cli.ppi.places import find_profile, find_symbols, telegram_problems
    from plcgen.ppi.wire.errors import PpiError

    verb, rest = words[0].lower(), words[1:]
    _require_usage(verb, rest, first=first, fcb=fcb, stations=(station, source))
    how = _How(station, source, _function(verb, first=first, fcb=fcb), reference, pack)
    found: tuple[Diagnostic, ...] = ()
    telegrams: list[bytes] = []
    try:
        telegrams = _encode(verb, rest, how, find_profile(cpu), find_symbols(symbols))
    except DiagnosticError as problem:
        found = problem.diagnostics
    except PpiError as problem:
        found = telegram_problems(problem)
    text = "".join(data.hex(" ").upper() + "\n" for data in telegrams)
    rows = [
        {"request": verb, "telegram": number, "length": len(data), "hex": data.hex().upper()}
        for number, data in enumerate(telegrams, 1)
    ]
    answer = Answer({**diagnostics_data("ppi requests", found), "telegrams": rows}, lambda _view: text, found)
    out = console()
    if telegrams and verb not in _HARMLESS:
        out.say(SENDS_NOTHING)
    return out.answer(format_, answer, known={ARGUMENTS: " ".join(rest)})


def _require_usage(verb: str, rest: Sequence[str], *, first: bool, fcb: int | None, stations: tuple[int, int]) -> None:
    from plcgen.base.diagnostics.suggest import did_you_mean

    if verb not in (*_BARE, *_WITH_ITEMS):
        known = (*_WITH_ITEMS, *_BARE)
        raise click.UsageError(f'there is no telegram "{verb}"; {did_you_mean(verb, known) or ", ".join(known)}')
    if verb in _BARE and rest:
        raise click.UsageError(f"{verb} takes no addresses")
    if verb in _WITH_ITEMS and not rest:
        example = "VW100=1234" if verb in {"write", "force"} else "VB100"
        raise click.UsageError(f"{verb} needs an address, for example {example}")
    if first and fcb is not None:
        raise click.UsageError("--first and --fcb cannot be used together")
    if stations[0] == stations[1]:
        raise click.UsageError(f"--station and --source are both {stations[0]}")


def _function(verb: str, *, first: bool, fcb: int | None) -> int:
    if fcb is not None:
        return 0x7C if fcb else 0x5C
    return 0x5C if verb == "poll" and not first else 0x6C


def _encode(
    verb: str, rest: Sequence[str], how: _How, cpu: CpuProfile | None, symbols: SymbolTable | None
) -> list[bytes]:
    from plcgen.ppi.wire.telegram import encode_poll, encode_request

    stations = {"destination": how.station, "source": how.source}
    if verb == "poll":
        return [encode_poll(**stations, function=how.function)]
    encoded: list[bytes] = []
    function = how.function
    for request in _requests(verb, rest, how, cpu, symbols):
        encoded.append(encode_request(request, **stations, function=function))
        function = 0x5C if function == 0x5C else 0x7C  # the poll in between toggles the bit once more
    return encoded


def _requests(
    verb: str, rest: Sequence[str], how: _How, cpu: CpuProfile | None, symbols: SymbolTable | None
) -> Sequence[Request]:
    from plcgen.cli.ppi.places import read_assignments, read_places
    from plcgen.ppi.wire import model
    from plcgen.ppi.wire.areas import READ_LIMIT, WRITE_LIMIT
    from plcgen.ppi.wire.pack import pack_read, pack_write

    reference = how.reference
    bare: dict[str, Request] = {
        "run": model.RunRequest(reference),
        "stop": model.StopRequest(reference),
        "setup": model.SetupRequest(reference),
    }
    if verb in bare:
        return [bare[verb]]
    if verb in {"read", "unforce"}:
        items = [place.item for place in read_places(rest, symbols, cpu, None if how.pack else READ_LIMIT)]
        if verb == "unforce":
            return [model.ForceRequest(reference, item, None) for item in items]
        return pack_read(items).requests(reference) if how.pack else [model.ReadRequest(reference, tuple(items))]
    entries = [entry for _, entry in read_assignments(rest, symbols, cpu, None if how.pack else WRITE_LIMIT)]
    if verb == "force":
        return [model.ForceRequest(reference, entry.item, entry.data) for entry in entries]
    return (
        pack_write(entries).requests(reference) if how.pack else [model.WriteRequest.padded(reference, tuple(entries))]
    )
