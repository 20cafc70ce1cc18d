"""What a message or a parameter is: in every device that is known, or in one."""

from __future__ import annotations

import re

from plcgen.base.display.page import Page
from plcgen.ds47 import messages
from plcgen.ds47.device import Device, Parameter, limit_text
from plcgen.ds47.devices import device_names, find_device
from plcgen.ds47.messages import FAMILIES, KINDS, Message
from plcgen.ds47.references import parse_reference

_BUFFERS = {
    "F": "in the fault buffer: r945 has the number ({number}), r949 the fault value; a job with faults: reads them",
    "A": "in the alarm buffer: r2122 has the number ({number}), r2124 the alarm value; a job with alarms: reads them",
    "C": "in the buffer of safety messages: r9747 has the number ({number}), r9749 the value",
}
"""Where a message lies, in the lists of VECTOR, G220, S210 and S200; r9747 is in that of VECTOR alone."""


def message_page(text: str, device: str = "") -> Page | None:
    """Explain a message of a drive, ``F30001`` or ``A07012``: of all families, or of one device.

    Raises:
        DiagnosticError: PG201 if there is no such device.
    """
    name = messages.named(text)
    if name is None:
        return None
    kind, number = name
    families = find_device(device).messages if device else tuple(FAMILIES)
    found = messages.find(number, families, kind)
    if not found:
        return None
    titles = dict.fromkeys(one.title for one in found)
    sections = [_message_section(one, alone=len(found) == 1 and bool(device)) for one in found]
    kinds = dict.fromkeys(letter for one in found for letter in (one.kind, *one.also) if kind in {"", letter})
    sections += [("Where it is", _BUFFERS[one].format(number=number)) for one in kinds if one in _BUFFERS]
    sections.append(
        ("Source", f"{messages.source({name for one in found for name in one.families})}; titles in English")
    )
    title = next(iter(titles)) if len(titles) == 1 else f"{len(titles)} titles, by family"
    return Page(f"{kind}{number:05}", title, tuple(sections))


def _message_section(message: Message, *, alone: bool) -> tuple[str, str]:
    where = "Meaning" if alone else "; ".join(text for family, text in FAMILIES.items() if family in message.families)
    return where, "\n".join(message_lines(message))


def message_lines(message: Message) -> list[str]:
    """What is known of a message: kind and title, class, reaction, how it is acknowledged."""
    also = f", can be set to {' or '.join(KINDS[one] for one in message.also)}" if message.also else ""
    lines = [f"{KINDS[message.kind]}{also}: {message.title}", f"class: {message.message_class}"]
    lines += [f"reaction: {message.reaction}"] if message.reaction else []
    return lines + ([f"acknowledge: {message.acknowledge}"] if message.acknowledge else [])


_PARAMETER = re.compile(
    r"([prc][0-9]{1,5}(?:\[[0-9]{1,5}\])?)(?:\.([0-9]{1,2})|={1,2}(-?[0-9]{1,10}))?\Z", re.IGNORECASE
)


def parameter_page(text: str, device: str = "") -> Page | None:
    """Explain a parameter, ``p971``, a bit of it, ``r899.2``, or a value, ``r0002 = 42``: of all devices, or of one.

    Raises:
        DiagnosticError: PG201 if there is no such device.
    """
    match = _PARAMETER.match("".join(text.split()))
    reference = parse_reference(match[1]) if match else None
    if match is None or reference is None or reference.pnu is None:
        return None
    told: dict[tuple[str, str], list[str]] = {}
    for name in (device,) if device else device_names():
        one = find_device(name)
        known = one.find(reference.pnu)
        if known is not None:
            told.setdefault((known.title, _facts(one, known, match[2], match[3])), []).append(name)
    if not told:
        return None
    names = ", ".join
    sections = tuple((names(devices), f"{title}\n{known}") for (title, known), devices in told.items())
    titles = dict.fromkeys(title for title, _ in told)
    title = next(iter(titles)) if len(titles) == 1 else f"{len(titles)} titles, by device"
    more = f".{match[2]}" if match[2] else f" = {match[3]}" if match[3] else ""
    return Page(f"{match[1]}{more}", title, sections)


def _facts(device: Device, known: Parameter, bit: str | None, value: str | None) -> str:
    """What the catalogue of a device says of a parameter, of one of its bits, or of a value."""
    if bit or value:
        column, number = ("bits", int(bit)) if bit else ("values", int(value or ""))
        every = device.names(known.pnu, column)
        if value and not any(number in names for names in every.values()):
            every = {("",): {one: name for name, one in known.values.items()}}
        told: dict[str, list[str]] = {}
        for of, names in every.items():
            if number in names:
                told.setdefault(names[number], []).extend(of)
        sure = known.grades.get("values", "read") if value else "read"
        grades = {one.type or one.name: one.grade for one in device.lists}
        lines = [
            text + _doubt(grades.get(of[0], sure)) + (f" ({', '.join(of)})" if len(told) > 1 else "")
            for text, of in told.items()
        ]
        return f"{'bit ' if bit else ''}{number}: {'; '.join(lines) or 'not stated'}"
    low, high = limit_text(known.minimum), limit_text(known.maximum)
    limits = f"{low} to {high}" if low and high else f"from {low}" if low else f"up to {high}" if high else ""
    access = "read only" if known.access == "r" else "read and write"
    type_ = f"{known.type}{_doubt(known.grades.get('type', 'read'))}" if known.type else "type unknown"
    return ", ".join(filter(None, (type_, known.unit, limits, access)))


def _doubt(grade: str) -> str:
    return "" if grade == "read" else f" ({grade})"
