"""``plcgen live write``: change parameters of a drive."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import click

from plcgen.cli.arguments import ARGUMENTS, Argument, arguments
from plcgen.cli.live.places import object_number, object_options, open_channel, read_station, timeout_option
from plcgen.cli.options import console, device_option, format_option, verb
from plcgen.cli.ppi.connection import ask

if TYPE_CHECKING:
    from plcgen.base.diagnostics import Diagnostic
    from plcgen.base.display.results import Answer
    from plcgen.ds47.device import Device, Parameter
    from plcgen.ds47.live.channel import PnParameters
    from plcgen.ds47.live.parameters import ElementReading
    from plcgen.ds47.wire.model import Block, ParameterAddress, ValueBlock
    from plcgen.report.registry import OutputFormat

_RAM = "nothing was saved: after power off the drive has its old values\n"
Change = tuple["Parameter", "ParameterAddress", "ValueBlock"]


@verb(
    "write",
    "plcgen live write P1120=5.0 --port pn://192.168.0.5 --device sinamics-g120 --yes-write",
    "plcgen live write P971=1 --allow 'P971=keep the ramps' --port pn://192.168.0.5 --device sinamics-s120 --yes-write",
)
@click.argument("words", nargs=-1, required=True, metavar="PARAMETER=VALUE[:TYPE]...")
@click.option("--port", "host", required=True, metavar="pn://IP", help="The drive: pn://IP[:PORT][/SLOT.SUBSLOT].")
@device_option("Device profile: types, drive object, what is dangerous.", required=True)
@object_options
@click.option("--yes-write", is_flag=True, help="Write the values; without this option they are only shown.")
@click.option("--allow", multiple=True, metavar="P=WHY", help="Write this dangerous parameter, and why.")
@click.option("--allow-safety", multiple=True, metavar="P=WHY", help="The same for Safety Integrated.")
@timeout_option
@format_option("answer")
def command(
    *, words: tuple[str, ...], host: str, device: str, number: int | None, format_: OutputFormat, **more: Any
) -> int:
    """Write parameters of a drive over PROFINET, all in one request; only with --yes-write, since a machine may move.

    Dangerous parameters need an --allow each, as in a spec. The values of before are shown, and read again afterwards.
    Nothing is saved: after power off the drive has its old values, unless you write p0971 or p0977, too.
    Exit code 1 if a value was refused or is another one afterwards, 2 without --yes-write.
    """
    where = read_station(host)

    def question() -> Answer:
        from plcgen.ds47.devices import find_device

        known = find_device(device)
        object_ = object_number(number, known)
        changes = _changes(arguments(words), known, object_, more["allow"], more["allow_safety"])
        if not more["yes_write"]:
            console().say(
                "\n".join(f"{_called(one, address)} = {_shown(one, block)}" for one, address, block in changes)
            )
            raise click.UsageError("nothing was written: writing needs --yes-write")
        with open_channel(where, more["timeout"], known) as channel:
            before = _read(channel, changes, object_)
            answers = channel.change([(address, block) for _, address, block in changes], object_)
            now = _read(channel, changes, object_)
        return _answer(f"{where} drive object {object_}", (str(where), object_), changes, (before, answers, now))

    return ask(format_, "live write", words, question)


def _changes(
    words: Sequence[Argument], device: Device, object_: int, allow: Sequence[str], safety: Sequence[str]
) -> Sequence[Change]:
    """What is to be written, if all of it may be; of what nobody has classified it warns.

    Raises DiagnosticError: PG207, PG219.
    """
    from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Severity
    from plcgen.cli.adhoc import change
    from plcgen.ds47 import guards
    from plcgen.ds47.device import Parameter

    found: list[Change] = []
    problems: list[Diagnostic] = []
    doubts: list[Diagnostic] = []
    signed = {False: _signed(allow, "--allow"), True: _signed(safety, "--allow-safety")}
    object_type = device.object_type(object_)
    for word in words:
        address, block = change(word, device)
        known = device.find(address.pnu, object_type) or Parameter(address.pnu, "")
        why = guards.why_read_only(word.text, address.pnu, catalogued=known.access)
        if why:
            problems += word.problem("PG207", f"{_called(known, address)} cannot be written: {why}").diagnostics
        danger = device.danger(address.pnu, block.values(), object_type)
        is_safety = address.pnu in guards.SAFETY
        if danger and address.pnu not in signed[is_safety]:
            option = "--allow-safety" if is_safety else "--allow"
            help_ = f'if this is intended, add {option} "P{address.pnu}=why"'
            message = f"writing {_called(known, address)} needs a sign-off: {danger}"
            problems += word.problem("PG219", message, help_).diagnostics
        elif not device.classified(address.pnu) and address.pnu not in signed[is_safety]:
            message = f"nobody has classified what writing {_called(known, address)} does"
            help_ = f'look it up in the list manual; --allow "P{address.pnu}=why" says that you have'
            doubts.append(Diagnostic("PG261", message, word.span, Severity.WARNING, help=help_))
        found.append((known, address, block))
    console().complain(doubts, {ARGUMENTS: " ".join(word.text for word in words)})
    written = {address.pnu for _, address, _ in found}
    strange = sorted({*signed[False], *signed[True]} - written)
    if strange:
        raise click.UsageError(f"P{strange[0]} is allowed, but not written")
    if problems:
        raise DiagnosticError(problems)
    return found


def _signed(given: Sequence[str], option: str) -> Mapping[int, str]:
    """Numbers and reasons. Raises BadParameter."""
    from plcgen.ds47.references import number_of

    found = {}
    for text in given:
        name, _, why = text.partition("=")
        pnu = number_of(name)
        if pnu is None or not why.strip():
            raise click.BadParameter(f'"{text}": write a parameter and why it may be written, P971=keep the ramps',
                                     param_hint=option)  # fmt: skip
        found[pnu] = why.strip()
    return found


def _read(channel: PnParameters, changes: Sequence[Change], object_: int) -> Sequence[Sequence[ElementReading]]:
    """The elements of every change, as the drive has them."""
    from dataclasses import replace

    found = []
    for one, address, block in changes:
        string = "[" in one.type or one.type.startswith(("VisibleString", "OctetString"))
        wanted = replace(one, type=f"{one.type.partition('[')[0]}[{block.count}]" if string else "")
        indexes = [address.subindex] if string else range(address.subindex, address.subindex + block.count)
        found.append(list(channel.read([(wanted, indexes)], object_)))
    return found


def _called(one: Parameter, address: ParameterAddress) -> str:

    return f"{one.label}[{address.subindex}]" + (f" ({one.title})" if one.title else "")


def _shown(one: Parameter, block: ValueBlock) -> str:
    """Values that are to be written, as they would be read."""
    from dataclasses import replace

    from plcgen.ds47.live.channel import read_block

    untyped = replace(one, type="")
    return ", ".join(each.text for each in read_block(untyped, range(block.count), block)) + f" {one.unit}".rstrip()


def _answer(
    place: str,
    where: tuple[str, int],
    changes: Sequence[Change],
    came: tuple[Sequence[Sequence[ElementReading]], Sequence[Block], Sequence[Sequence[ElementReading]]],
) -> Answer:
    from plcgen.base.diagnostics import Diagnostic, Span
    from plcgen.base.display.data import diagnostics_data
    from plcgen.base.display.results import Answer
    from plcgen.base.display.table import text_table
    from plcgen.ds47 import guards
    from plcgen.ds47.kinds.save import SAVES
    from plcgen.ds47.live.channel import read_block
    from plcgen.ds47.wire.errors import error_text
    from plcgen.ds47.wire.model import ErrorBlock

    before, answers, now = came
    rows, problems = [], []
    for at, (one, address, block) in enumerate(changes):
        answer = answers[at if len(answers) == len(changes) else 0] if answers else None
        wanted = list(read_block(now[at][0].parameter, [each.index for each in now[at]], block))
        span = Span(f"{place} {_called(one, address)}")
        if isinstance(answer, ErrorBlock):
            message = f"the drive refused the value: error {error_text(answer.number).explain(answer.info)}"
            problems.append(Diagnostic("PG709", message, span))
        for old, want, new in zip(before[at], wanted, now[at], strict=True):
            rows.append((f"{_called(one, address).partition('[')[0]}[{old.index}]", one.title, one.unit,
                         old.text or "?", want.text or block.data.hex(" ").upper(), new.text or "?"))  # fmt: skip
            quiet = isinstance(answer, ErrorBlock) or one.pnu in guards.SET_BACK
            if not quiet and (new.doubt or new.data != want.data):
                message = f"{new.text or new.doubt} was read afterwards, {want.text} was written"
                problems.append(Diagnostic("PG709", message, span))
    saves = any(one.pnu in SAVES.values() for one, _, _ in changes)
    header = ("parameter", "title", "unit", "before", "wanted", "now")
    text = "\n".join(text_table(header, rows, indent=0)) + "\n" + _RAM * (not saves)
    data = [dict(zip(header, row, strict=True)) for row in rows]
    shown = {
        **diagnostics_data("live write", problems),
        "address": where[0],
        "drive_object": where[1],
        "parameters": data,
    }
    return Answer(shown, lambda _view: text, problems)
