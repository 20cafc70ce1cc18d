"""Addresses on the command line, the limit of time, and the answer of the verbs that compare."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from plcgen.base.diagnostics import Diagnostic
    from plcgen.base.display.results import Answer
    from plcgen.ds47.device import Device
    from plcgen.ds47.live.channel import PnParameters
    from plcgen.ds47.live.comparison import LiveRow
    from plcgen.ds47.live.connection import S7Partner
    from plcgen.ds47.live.parameters import ParameterReader
    from plcgen.ds47.live.profinet import PnPartner

Callback = TypeVar("Callback", bound=Callable[..., Any])

PN = "pn://"
APIS = {"3A00": 0x3A00, "0": 0}
RECORDS = {"47": 47, "B02E": 0xB02E, "B02F": 0xB02F}


def timeout_option(verb: Callback) -> Callback:
    """Add ``--timeout``."""
    return click.option(
        "--timeout",
        type=click.FloatRange(0.1, 60),
        default=5.0,
        show_default=True,
        metavar="SECONDS",
        help="Longest wait for one answer; connecting over S7 takes 5 s at most.",
    )(verb)


def drive_option(*, several: bool = False) -> Callable[[Callback], Callback]:
    """Add ``--drive``, which may be called ``--port`` and is ``host`` (``given`` if there may be several)."""
    named = "[DRIVE=]" * several
    metavar, help_ = (
        f"{named}ADDRESS",
        "Address of a drive: 192.168.0.5 (S7), pn://192.168.0.5[/SLOT.SUBSLOT] (PROFINET).",
    )
    return click.option(
        "--drive",
        "--port",
        "given" if several else "host",
        multiple=several,
        required=True,
        metavar=metavar,
        help=help_,
    )


def object_options(verb: Callback) -> Callback:
    """Add ``--do``, and ``--record`` and ``--api``, which addresses on PROFINET take."""
    object_ = click.option(
        "--do", "number", type=click.IntRange(0, 255), metavar="N", help="Drive object.  [default: by device, 1]"
    )
    record = _kept("--record", RECORDS, "Record of the parameter channel on PROFINET.  [default: by device, B02F]")
    api = _kept("--api", APIS, "Profile that the slot belongs to: PROFIdrive (3A00), or none (0).  [default: 3A00]")
    return object_(record(api(verb)))


def _kept(name: str, numbers: dict[str, int], help_: str) -> Callable[[Callback], Callback]:
    """An option whose number the call remembers for the addresses."""

    def keep(ctx: click.Context, _param: click.Parameter, value: str | None) -> None:
        if value is not None:
            ctx.meta[name] = numbers[value]

    choice = click.Choice(list(numbers), case_sensitive=False)
    return click.option(name, type=choice, is_eager=True, expose_value=False, callback=keep, help=help_)


def read_partner(text: str, option: str, rack: int = 0, slot: int = 0) -> S7Partner:
    """``HOST`` or ``HOST:PORT``."""
    from plcgen.ds47.live.connection import PORT, S7Partner

    host, colon, port = text.strip().rpartition(":")
    if not colon:
        host, port = port, str(PORT)
    if not host or not host.isascii() or not host.isprintable() or " " in host or not _is_port(port):
        raise click.BadParameter(f'"{text}": write an IPv4 address, 192.168.0.5 or 192.168.0.5:102', param_hint=option)
    return S7Partner(host, int(port), rack, slot)


def read_station(text: str, option: str = "--port") -> PnPartner:
    """``pn://IP[:PORT][/SLOT.SUBSLOT]``, an address of one device."""
    from plcgen.ds47.live.profinet import PnPartner, unicast
    from plcgen.ds47.wire.pnio import PROFIDRIVE
    from plcgen.ds47.wire.rpc import PORT

    address, _, place = text.strip().removeprefix(PN).partition("/")
    host, _, port = address.partition(":")
    slot, _, subslot = place.partition(".")
    wrong = unicast(host) if text.strip().startswith(PN) else "it is no PROFINET address"
    if wrong or not _is_port(port or str(PORT)) or (place and not (_is_number(slot) and _is_number(subslot))):
        why = wrong or "port, slot and subslot are numbers up to 65535"
        raise click.BadParameter(f'"{text}": {why}; write pn://192.168.0.5 or pn://192.168.0.5/2.1', param_hint=option)
    meta = click.get_current_context().meta
    api, record = meta.get("--api", PROFIDRIVE), meta.get("--record")
    return PnPartner(host, int(slot or 1), int(subslot or 1), int(port or PORT), api, record)


def _is_number(text: str) -> bool:
    return text.isascii() and text.isdigit() and len(text) <= 5 and int(text) <= 0xFFFF


def _is_port(text: str) -> bool:
    return _is_number(text) and int(text) >= 1


@contextlib.contextmanager
def open_channel(where: PnPartner, timeout: float, device: Device | None) -> Iterator[PnParameters]:
    """The parameter channel of a drive on PROFINET."""
    from plcgen.ds47.live.channel import PnParameters, record_index
    from plcgen.ds47.live.profinet import PnConnection

    with PnConnection(where, where.record or record_index(device), timeout) as connection:
        yield PnParameters(connection, device)


@contextlib.contextmanager
def open_drive(where: S7Partner | PnPartner, timeout: float, device: Device | None) -> Iterator[ParameterReader]:
    """Parameters of a drive, whichever way its address names."""
    from plcgen.ds47.live.connection import S7Connection, S7Partner
    from plcgen.ds47.live.parameters import S7Parameters

    if isinstance(where, S7Partner):
        with S7Connection(where, timeout) as reader:
            yield S7Parameters(reader)
    else:
        with open_channel(where, timeout, device) as channel:
            yield channel


def read_address(text: str, option: str = "--drive") -> S7Partner | PnPartner:
    """An address for either way."""
    if text.strip().startswith(PN):
        return read_station(text, option)
    if {"--record", "--api"} & set(click.get_current_context().meta):
        raise click.BadParameter(f'"{text}": --record and --api are for addresses with {PN}', param_hint=option)
    return read_partner(text, option)


def object_number(number: int | None, device: Device | None) -> int:
    """The drive object that is meant."""
    return number if number is not None else device.drive_object if device else 1


def comparison(kind: str, rows: Sequence[LiveRow], place_title: str, skipped: Sequence[str]) -> Answer:
    """Rows as a table and as data; what deviates or was not read is a diagnostic."""
    from plcgen.base.diagnostics import Diagnostic, Span
    from plcgen.base.display.data import diagnostics_data
    from plcgen.base.display.results import Answer
    from plcgen.base.display.table import text_table
    from plcgen.ds47.live.comparison import DEVIATES, UNREAD

    problems: list[Diagnostic] = []
    for row in rows:
        if row.verdict == DEVIATES:
            problems.append(Diagnostic("PG707", row.sentence, Span(row.subject)))
        elif row.verdict == UNREAD:
            problems.append(Diagnostic("PG706", row.why, Span(row.subject)))
    header = ("subject", place_title, "wanted", "found", "unit", "verdict")
    cells = [(row.subject, row.place, row.wanted, row.found, row.unit, row.verdict) for row in rows]
    text = "\n".join(text_table(header, cells, indent=0)) + "\n" if cells else ""
    text += "".join(f"not asked: {one}\n" for one in skipped)
    keys = ("subject", "place", "wanted", "found", "verdict", "why", "title", "unit")
    data = [{key: getattr(row, key) for key in keys} for row in rows]
    shown = {**diagnostics_data(kind, problems), "rows": data, "skipped": list(skipped)}
    return Answer(shown, lambda _view: text, problems)
