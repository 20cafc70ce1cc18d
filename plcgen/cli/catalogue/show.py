"""``plcgen catalogue show``: what is known about parameters, how it is known, and from where."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from plcgen.base.diagnostics.counting import quantity
from plcgen.cli.arguments import ARGUMENTS
from plcgen.cli.options import console, device_option, format_option, verb

if TYPE_CHECKING:
    from plcgen.base.diagnostics import Diagnostic
    from plcgen.base.display.results import Answer
    from plcgen.base.display.view import View
    from plcgen.ds47.device import Device, Parameter
    from plcgen.report.registry import OutputFormat


@verb(
    "show",
    "plcgen catalogue show P1120 --device sinamics-g120",
    "plcgen catalogue show ramp_up_time r945 --device sinamics-s120",
    'plcgen catalogue show "motor temperature" --device sinamics-s120',
    "plcgen catalogue show --device sinamics-s120 --draw 10 --seed 1",
)
@click.argument("parameters", nargs=-1, metavar="[PARAMETER...]")
@device_option(required=True)
@click.option(
    "--draw", type=click.IntRange(1, 1000), metavar="N", help="Draw N parameters for a spot check, without their facts."
)
@click.option("--seed", type=int, default=0, help="Seed of the draw.  [default: 0]")
@format_option("answer")
def command(*, parameters: tuple[str, ...], device: str, draw: int | None, seed: int, format_: OutputFormat) -> int:
    """Show what the catalogue knows about the parameters of a device.

    All of the profile, those given by number or name, or a list of those that have a text in their titles.
    """
    if draw is not None and parameters:
        raise click.UsageError("--draw chooses the parameters: do not name any")
    from plcgen.ds47.catalogue import pages
    from plcgen.ds47.devices import find_device

    found = find_device(device)
    if draw is not None:
        return console().answer(format_, _drawn(pages.draw(found, draw, seed)))
    if not parameters:
        return console().answer(format_, _list(found, [found.parameters[pnu] for pnu in sorted(found.parameters)]))
    chosen, missing, searched = _find(found, parameters)
    known = {ARGUMENTS: " ".join(parameters)}
    answer = _list(found, chosen, missing) if searched else _details(found, chosen, missing)
    return console().answer(format_, answer, known=known)


def _find(device: Device, words: tuple[str, ...]) -> tuple[list[Parameter], tuple[Diagnostic, ...], bool]:
    """Parameters by number, name, or a text in their titles, and whether there was such a text.

    A number that is not there is not guessed at.
    """
    from plcgen.base.diagnostics.suggest import did_you_mean
    from plcgen.cli.arguments import arguments
    from plcgen.ds47.references import parse_reference, split_bit

    chosen: dict[int, Parameter] = {}
    missing: list[Diagnostic] = []
    searched = False
    names = [one.name for one in device.parameters.values() if one.name]
    for word in arguments(words):
        split = split_bit(word.text)  # the page of a word says what its bits mean
        reference = parse_reference(split[0] if split is not None else word.text)
        number = reference.pnu if reference is not None else None
        one = device.by_name(word.text) if number is None else device.find(number)
        found = [one] if one is not None else device.search(word.text) if number is None else []
        searched = searched or (one is None and bool(found))
        chosen |= {each.pnu: each for each in found}
        if not found:
            hint = "" if number is not None else did_you_mean(word.text, names)
            help_ = hint or f"plcgen catalogue show --device {device.key}"
            what = "is not" if number is not None else "is neither a name nor in a title"
            message = f'"{word.text}" {what} in the catalogue of {device.key}'
            missing += word.problem("PG703", message, help_).diagnostics
    return list(chosen.values()), tuple(missing), searched


def _details(device: Device, found: Sequence[Parameter], missing: tuple[Diagnostic, ...]) -> Answer:
    from plcgen.base.display.data import diagnostics_data
    from plcgen.base.display.page import page_text
    from plcgen.base.display.results import Answer
    from plcgen.ds47.catalogue import pages

    rows = [pages.data(device, one) for one in found]

    def text(view: View) -> str:
        return "\n".join(page_text(pages.parameter_page(device, one), view) for one in found)

    return Answer({**diagnostics_data("catalogue", missing), "parameters": rows}, text, missing)


def _drawn(found: Sequence[Parameter]) -> Answer:
    """Numbers and titles alone: who looks them up in a manual has not seen what the catalogue says."""
    from plcgen.base.display.data import head
    from plcgen.base.display.results import Answer
    from plcgen.base.display.table import text_table

    rows = [(one.label, one.title) for one in found]
    text = "\n".join(text_table(("parameter", "title"), rows, indent=0)) + "\n"
    listed = [{"parameter": name, "title": title} for name, title in rows]
    shown = {**head("catalogue draw", ok=True), "parameters": listed}
    return Answer(shown, lambda _view: text)


def _list(device: Device, found: Sequence[Parameter], missing: tuple[Diagnostic, ...] = ()) -> Answer:
    from plcgen.base.display.data import diagnostics_data
    from plcgen.base.display.results import Answer
    from plcgen.base.display.table import text_table
    from plcgen.ds47.catalogue import pages

    header = ("parameter", "type", "type is", "unit", "name", "title")
    rows = [(p.label, p.type or "unknown", p.grades.get("type", "unknown"), p.unit, p.name, p.title) for p in found]
    count = pages.counts(found)
    told = ", ".join(f"{count[grade]} {grade}" for grade in pages.GRADES)
    text = "\n".join(text_table(header, rows, indent=0)) + f"\n\n{quantity(len(found), 'parameter')}; facts: {told}\n"
    shown = {
        **diagnostics_data("catalogue", missing),
        "facts": {grade: count[grade] for grade in pages.GRADES},
        "parameters": [pages.data(device, one) for one in found],
    }
    return Answer(shown, lambda _view: text, missing)
