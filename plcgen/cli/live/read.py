"""``plcgen live read``: parameters of a real drive."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from plcgen.cli.arguments import Argument, arguments
from plcgen.cli.live.places import (
    PN,
    drive_option,
    object_number,
    object_options,
    open_drive,
    read_address,
    timeout_option,
)
from plcgen.cli.options import device_option, format_option, verb
from plcgen.cli.ppi.connection import ask

if TYPE_CHECKING:
    from plcgen.base.display.results import Answer
    from plcgen.ds47.device import Device, Parameter
    from plcgen.ds47.live.parameters import ElementReading
    from plcgen.report.registry import OutputFormat

_MOST = 1000
"""Elements that one call reads."""


@verb(
    "read",
    "plcgen live read P1120 r0945[0..3] --drive 192.168.0.5 --device sinamics-g120",
    "plcgen live read r0052:Unsigned16 --drive 192.168.0.5 --do 2",
    "plcgen live read r0052 --port pn://192.168.0.5 --do 2",
)
@click.argument("words", nargs=-1, required=True, metavar="PARAMETER...")
@drive_option()
@device_option("Device profile: types, limits, drive object.")
@object_options
@timeout_option
@format_option("answer")
def command(
    *,
    words: tuple[str, ...],
    host: str,
    device: str | None,
    number: int | None,
    timeout: float,
    format_: OutputFormat,
) -> int:
    """Read parameters of a drive over the S7 protocol, as an HMI does, or with pn:// over PROFINET, where a read is a
    request that is written as a record.

    A type after a colon says how to read the bytes: r0052:Unsigned16. Without one it comes from the catalogue: of
    --device, or of all devices if those that know the number agree. On PROFINET the drive says its type itself.
    """
    where = read_address(host)

    def question() -> Answer:
        from plcgen.ds47.devices import find_device

        known = find_device(device) if device else None
        chosen = [_wanted(word, known, typed=host.startswith(PN)) for word in arguments(words)]
        if sum(len(indexes) for _, indexes in chosen) > _MOST:
            raise click.UsageError(f"these are more than {_MOST} elements: read fewer at once")
        object_ = object_number(number, known)
        with open_drive(where, timeout, known) as reader:
            found = list(reader.read(chosen, object_))
        return _answer(str(where), object_, found)

    return ask(format_, "live read", words, question)


def _wanted(word: Argument, device: Device | None, *, typed: bool) -> tuple[Parameter, Sequence[int]]:
    """Parameter and indexes of a word; ``typed`` if the drive says its type itself.

    Raises DiagnosticError that points at the word.
    """
    from dataclasses import replace

    from plcgen.ds47.device import Parameter
    from plcgen.ds47.live.parameters import OBJECT_STEP
    from plcgen.ds47.references import parse_reference, spelling_hint
    from plcgen.ds47.types import TypeTextError, read_type

    text, _, type_ = word.text.partition(":")
    reference = parse_reference(text)
    if reference is None or (reference.pnu is not None and not 1 <= reference.pnu <= 0xFFFF):
        raise word.problem("PG203", f'"{text}" is not a parameter', spelling_hint(text))
    first, last = reference.first or 0, reference.last or 0
    if last < first or last >= OBJECT_STEP:
        raise word.problem("PG203", f"{text}: indexes go from 0 to {OBJECT_STEP - 1}", "write the lower one first")
    parameter = _known(word, text, reference.name, reference.pnu, device, typed=typed or bool(type_))
    if type_:
        try:
            read_type(type_)
        except TypeTextError as wrong:
            raise word.problem("PG205", str(wrong), wrong.help) from None
        base = parameter or Parameter(reference.pnu or 0, type_, access="r" if text[:1] in "rR" else "rw")
        limits = {} if type_.lower() == base.type.lower() else {"minimum": None, "maximum": None, "bico": False}
        grades = {**base.grades, "type": "read"}
        parameter = replace(base, type=type_, grades=grades, **limits)  # type: ignore[arg-type]
    return parameter or Parameter(reference.pnu or 0, ""), range(first, last + 1)


def _known(
    word: Argument, text: str, name: str, pnu: int | None, device: Device | None, *, typed: bool
) -> Parameter | None:
    """What the catalogue says; None if the word has a type of its own and nothing is known."""
    from plcgen.ds47.devices import device_names, find_device

    if name and device is None:
        raise word.problem("PG703", f'"{text}" is a name, and names belong to a device', "say which one with --device")
    devices_ = [device] if device else [find_device(one) for one in device_names()]
    found = [one.by_name(name) if name else one.find(pnu or 0) for one in devices_]
    known = [one for one in found if one is not None and one.type]
    if device is None and len({one.type for one in known}) == 1:
        return _common(known)
    if device is not None and known:
        return known[0]
    if typed and not name:
        return None
    where = f"of {device.key}" if device else "of any device" if not known else "that all devices agree on"
    raise word.problem("PG703", f"there is no type {where} for {text}", f"write it: {text}:Unsigned16")


def _common(known: Sequence[Parameter]) -> Parameter:
    """What all devices say about a number that they know with one type; limits are those of one family."""
    from dataclasses import replace

    first = known[0]
    return replace(
        first,
        title=first.title if len({one.title for one in known}) == 1 else "",
        unit=first.unit if len({one.unit for one in known}) == 1 else "",
        bico=all(one.bico for one in known),
        minimum=None,
        maximum=None,
    )


def _type(parameter: Parameter) -> str:
    """The type, and how it is known if nobody has read it."""
    grade = parameter.grades.get("type", "read")
    return parameter.type + ("" if grade == "read" else f" ({grade})")


def _answer(where: str, object_: int, found: Sequence[ElementReading]) -> Answer:
    from plcgen.base.diagnostics import Diagnostic, Span
    from plcgen.base.display.data import diagnostics_data
    from plcgen.base.display.results import Answer
    from plcgen.base.display.table import text_table

    rows = [
        (f"{one.parameter.label}[{one.index}]", one.text or "?", one.parameter.unit, one.data.hex(" ").upper(),
         _type(one.parameter), one.parameter.title)
        for one in found
    ]  # fmt: skip
    problems = [
        Diagnostic("PG706", one.doubt, Span(f"{where} {row[0]}"))
        for row, one in zip(rows, found, strict=True)
        if one.doubt
    ]
    header = ("parameter", "value", "unit", "bytes", "type", "title")
    data = [
        {**dict(zip(header, row, strict=True)), "value": one.text if one.value is not None else None}
        for row, one in zip(rows, found, strict=True)
    ]
    shown = {**diagnostics_data("live read", problems), "address": where, "drive_object": object_, "parameters": data}
    text = f"{where}, drive object {object_}\n" + "\n".join(text_table(header, rows, indent=0)) + "\n"
    return Answer(shown, lambda _view: text, problems)
