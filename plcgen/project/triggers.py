"""Where the signals of a job lie besides DriveJobs: absolute flags, or tags and data blocks of the user's program."""

from __future__ import annotations

import re

from plcgen.base.diagnostics import Diagnostic, Report
from plcgen.project.nouns import Flag, OwnSymbol, PlannedTrigger
from plcgen.project.schema import Trigger
from plcgen.project.spec import LoadedSpec, SpecPath
from plcgen.project.target import target
from plcgen.s7.types.address import Address, AddressError, parse_address
from plcgen.s7.types.names import TIA_LIMIT, V5_LIMIT, check_name

_SYMBOL = re.compile(r'(?:"([^"]+)"|([^\W\d]\w*))((?:\.[^\W\d]\w*(?:\[[0-9]{1,5}\])?)*)')
_LIKE_AN_ADDRESS = re.compile(r"%|(?i:P?[IQEAM][BWDX]?|DB|[TCZ])[0-9]")


def plan_trigger(trigger: Trigger | None, path: SpecPath, loaded: LoadedSpec, report: Report) -> PlannedTrigger:
    """Flags of a job whose place in the spec is ``path``; a flag that cannot be used is a diagnostic."""
    if trigger is None:
        return PlannedTrigger()
    plc = loaded.spec.plc
    where = target(plc.family, plc.toolchain)
    found: dict[str, Flag] = {}
    for signal in ("execute", "busy", "done", "error", "status"):
        text = getattr(trigger, signal)
        if text is None:
            continue
        wanted = "a word such as MW52" if signal == "status" else "a bit such as M50.0"
        flag = _flag(text, signal) if _LIKE_AN_ADDRESS.match(text) else _symbol(text, where.encoding, v5=where.v5)
        if isinstance(flag, str):
            help_ = f'{signal} is {wanted}, or a tag or member of your program such as "Plant".start'
            place = loaded.span((*path, "trigger", signal))
            report.add(Diagnostic("PG404", f'"{text}"{flag}', place, help=help_))
        else:
            found[signal] = flag
    return PlannedTrigger(**found)


def _flag(text: str, signal: str) -> Address | str:
    """An absolute flag, or why it is none."""
    try:
        address = parse_address(text)
    except AddressError as problem:
        return f": {problem.reason}"
    if address.area != "M" or address.width_bits != (16 if signal == "status" else 1):
        return f" cannot be the {signal} flag"
    return address


def _symbol(text: str, encoding: str, *, v5: bool) -> OwnSymbol | str:
    """A tag or member, or why it is none."""
    match = _SYMBOL.fullmatch(text)
    if match is None:
        return " is neither an address nor a symbol"
    name = match[1] or match[2]
    members = tuple(match[3].split(".")[1:])
    limit = V5_LIMIT if v5 else TIA_LIMIT
    if len(name) > limit or not name.isprintable():
        return f": a name has at most {limit} printable characters"
    reasons = (check_name(member.partition("[")[0], v5, "identifier") for member in members)
    reason = next(filter(None, reasons), None)
    if reason is not None:
        return f": {reason}"
    if text.encode(encoding, "replace").decode(encoding) != text:
        return f": the sources are {encoding}, which has not all of its characters"
    return OwnSymbol(name, members)
