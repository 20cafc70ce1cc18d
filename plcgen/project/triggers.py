"""The absolute flags of a job, from the spec."""

from __future__ import annotations

from plcgen.diagnostics import Diagnostic, Report
from plcgen.project.nouns import PlannedTrigger
from plcgen.project.schema import Trigger
from plcgen.project.spec import LoadedSpec, SpecPath
from plcgen.s7.address import Address, AddressError, parse_address


def plan_trigger(trigger: Trigger | None, path: SpecPath, loaded: LoadedSpec, report: Report) -> PlannedTrigger:
    """Flags of a job whose place in the spec is ``path``; a flag that cannot be used is a diagnostic."""
    if trigger is None:
        return PlannedTrigger()
    found: dict[str, Address] = {}
    for signal in ("execute", "busy", "done", "error", "status"):
        text = getattr(trigger, signal)
        if text is None:
            continue
        place = loaded.span((*path, "trigger", signal))
        width = 16 if signal == "status" else 1
        wanted = "a word such as MW52" if width > 1 else "a bit such as M50.0"
        try:
            address = parse_address(text)
        except AddressError as problem:
            report.add(Diagnostic("PG404", f'"{text}": {problem.reason}', place, help=f"{signal} is {wanted}"))
            continue
        if address.area != "M" or address.width_bits != width:
            report.add(
                Diagnostic("PG404", f'"{text}" cannot be the {signal} flag', place, help=f"{signal} is {wanted}")
            )
            continue
        found[signal] = address
    return PlannedTrigger(**found)
