"""What there is to know of what a cursor is on: a key, a parameter, a drive, a job with its telegrams."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import islice
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import DiagnosticError, Span
from plcgen.base.display.page import Page
from plcgen.ds47.devices import find_device, is_path
from plcgen.workbench.service.results import Hover
from plcgen.workbench.service.specs.drives import (
    KnownDrive,
    drives_at,
    in_full,
    in_short,
    known_drive,
)
from plcgen.workbench.service.specs.jobs import job_offers
from plcgen.workbench.service.specs.names import name_at
from plcgen.workbench.service.specs.offers import names_parameters, parameter_at
from plcgen.workbench.service.specs.others import kind_of
from plcgen.workbench.service.specs.shape import Shape, spec_shape
from plcgen.workbench.service.specs.sketch import Path, Spot
from plcgen.workbench.service.specs.stations import names_items, station_page, symbol_page

if TYPE_CHECKING:
    from plcgen.build.sheet import Message
    from plcgen.ds47.device import Parameter
    from plcgen.workbench.service.documents import Document
    from plcgen.workbench.service.specs.state import Specs, SpecState

_CODE = re.compile(r"\bPG[0-9]{3}\b")
TELEGRAMS = 4
"""Telegrams of a job that are shown byte by byte; the page and ``encode`` show them all."""
_DRIVES = 3


def hover(specs: Specs, document: Document, line: int, column: int) -> Hover | None:
    """What there is to know; None if nothing."""
    state = specs.state(document)
    text = document.lines[line - 1] if line <= len(document.lines) else ""
    for code in _CODE.finditer(text):
        if code.start() <= column - 1 <= code.end() and "#" in text[: code.start()]:
            from plcgen import api

            page = api.explain(code[0])
            place = Span(document.file, line, code.start() + 1, line, code.end() + 1)
            return None if page is None else Hover(place, page)
    spot = state.sketch.at(line, column)
    if spot is None or not spot.word:
        return None
    if state.is_spec:
        found = next((page for page in _pages(state, spot, line, column) if page is not None), None)
    else:
        kind = kind_of(state)
        found = None if kind is None else _meaning(kind.shape, spot)
    return None if found is None else Hover(spot.span, found)


def _pages(state: SpecState, spot: Spot, line: int, column: int) -> Iterator[Page | None]:
    named = name_at(state, line, column)
    if named is not None:
        name, _ = named
        if name.kind.word == "variable":
            yield Page(name.text, "variable", (("Value", state.sketch.value("variables", name.text)),))
        if name.kind.word == "drive":
            yield _drive(state, name.text)
        if name.kind.word == "station":
            yield station_page(state, (*name.bound, "stations", name.text))
        if name.kind.word == "job" and spot.role == "key":
            yield job_page(state, (*spot.path, spot.word))
    place: Path = (*spot.path, spot.word) if spot.role == "key" else spot.path
    if names_items(spot.path, key=spot.role == "key"):
        yield symbol_page(state, spot.path, spot.word)
    words = None if spot.role == "key" else spec_shape().words(place)
    if names_parameters(spot.path, words):
        yield _parameter(spot.word, drives_at(state, spot.path))
    elif spot.role != "key":
        known = parameter_at(state, place)
        if known is not None:
            yield _value(spot.word, *known)
        if place[-1] == "device":
            yield _device(spot.word)
    if spot.role == "key" or not named:
        yield _meaning(spec_shape(), spot)


def _meaning(shape: Shape, spot: Spot) -> Page | None:
    """What the key is for at which, or at whose value, a spot is."""
    place: Path = (*spot.path, spot.word) if spot.role == "key" else spot.path
    meaning = shape.meaning(place)
    key = next((str(step) for step in reversed(place) if isinstance(step, str)), "")
    return Page(key, meaning, (("Values", shape.said(place, listed=not names_parameters(place))),)) if meaning else None


def _parameter(text: str, drives: Sequence[KnownDrive]) -> Page | None:
    """A parameter as the drives in question know it; what several know alike stands once."""
    found: dict[tuple[tuple[str, str], ...], list[str]] = {}
    shown: tuple[Parameter, str] | None = None
    for drive in drives:
        one = drive.find(text)
        if one is not None:
            shown = shown or (one, drive.device.title)
            found.setdefault(tuple(in_full(one)), []).append(drive.key)
    if shown is None:
        return None
    sections: list[tuple[str, str]] = []
    for facts, keys in islice(found.items(), _DRIVES):
        about = "" if len(found) == 1 else f" ({', '.join(keys[:5])}{', ..' if len(keys) > 5 else ''})"
        sections += [(f"{heading}{about}", said) for heading, said in facts if said]
    one, device = shown
    return Page(text, in_short(one) or device, (*sections, ("Device", device)))


def _value(word: str, text: str, known: list[tuple[KnownDrive, Parameter]]) -> Page | None:
    """The value of a parameter."""
    one = known[0][1]
    names = {**one.doubted.get("values", {}), **one.values}
    meant = next((f"{name} = {number}" for name, number in names.items() if word in {name, str(number)}), word)
    return Page(text, in_short(one), (("Value", f"{meant}{f' {one.unit}' if one.unit else ''}"), *in_full(one)))


def _drive(state: SpecState, key: str) -> Page | None:
    known, planned = known_drive(state, key), state.drive(key)
    if known is None:
        return None
    sections = [("Device", f"{known.device.key}: {known.device.title}")]
    if planned is not None and planned.device.key == known.device.key:
        where = planned.id_name or f"{planned.id_value} (16#{planned.id_value:04X})"
        kind = f" ({planned.object_type})" if planned.object_type else ""
        lines = [
            f"ID of WRREC and RDREC: {where}",
            f"data record: {planned.record_index} (16#{planned.record_index:04X})",
            f"drive object: {planned.drive_object}{kind}",
        ]
        sections.append(("Address", "\n".join(lines)))
    plan = state.drive_plan
    jobs = [] if plan is None else [job.path[-1] for job in plan.jobs if job.drive.key == key]
    if jobs:
        sections.append(("Jobs", ", ".join(map(str, dict.fromkeys(jobs)))))
    lacks = [f"{one.kind}: {one.lacks}" for one in job_offers(state, key) if one.lacks]
    if lacks:
        sections.append(("Cannot have", "\n".join(lacks)))
    return Page(key, "drive", tuple(sections))


def _device(name: str) -> Page | None:
    if is_path(name):
        return None
    try:
        device = find_device(name)
    except DiagnosticError:
        return None
    indexes = ", ".join(f"{key} {number} (16#{number:04X})" for key, number in device.record_index.items())
    lines = [
        f"data record: {indexes}; default {device.default_index}",
        f"drive object: {device.drive_object} ({device.drive_object_rule})",
        f"one telegram: {device.record_limit} bytes, {device.max_parameters} parameters",
        f"catalogue: {len(device.parameters)} parameters",
    ]
    return Page(name, device.title, (("Facts", "\n".join(lines)), ("Source", device.source)))


# --- jobs ------------------------------------------------------------------------------------------------------------


def job_page(state: SpecState, path: Path) -> Page | None:
    """A job: who does it, its blocks, every telegram with its bytes and addresses, and what the drive answers."""
    project = state.project
    jobs = [] if project is None else [job for job in project.jobs if job.path == path]
    if not jobs:
        return None
    first = jobs[0]
    partners = ", ".join(dict.fromkeys(job.link.key for job in jobs[:20])) + (", .." if len(jobs) > 20 else "")
    sections = [("With", partners)]
    called = {first.key, str(path[-1]), getattr(first, "shape", ""), f"{path[1]}.{path[-1]}"}
    sheets = [one for one in state.exchanges if one.job in called]
    for one in sheets[:TELEGRAMS]:
        which = f" {one.number} of {one.count}" if one.count > 1 else ""
        sections.append((f"Request{which}", _bytes(one.request)))
        sections += [(f"Answer{which}: {answer.title}", _bytes(answer)) for answer in one.answers[:1]]
        sections += [("Lengths", "\n".join(f"{name}: {said}" for name, said in one.lengths))]
    if len(sheets) > TELEGRAMS:
        sections.append(("More", f"{len(sheets) - TELEGRAMS} telegrams; plcgen encode shows them"))
    answers = list(simulated(state, first))
    if answers:
        sections.append(("The simulated drive answers", "\n".join(answers[:TELEGRAMS])))
    block = sheets[0].block if sheets else first.member
    return Page(str(path[-1]), f"{first.kind} · {block}", tuple(sections))


def _bytes(message: Message) -> str:
    """A telegram where it lies: address, bytes, member, value."""
    home = f'{message.home.kind}{message.home.number} "{message.home.name}", {message.length} bytes'
    rows = []
    for field in message.fields:
        data = " ".join("--" if byte is None else f"{byte:02X}" for byte in field.data[:8])
        more = " .." if len(field.data) > 8 else ""
        said = f"{data}{more:<3}  {field.name}  {field.value} {field.meaning}"
        rows.append(f"{field.address or field.offset:>10}  {said}".rstrip())
    return "\n".join([home, *rows[:60]])


def simulated(state: SpecState, job: object) -> Iterator[str]:
    """What a simulated drive answers to the requests of a job, byte by byte; nothing for other protocols."""
    from plcgen.ds47.plan.nouns import DriveJob
    from plcgen.ds47.recording.exchange import contact_text
    from plcgen.ds47.sim.bench import build_drive
    from plcgen.report.trace.model import Contact

    plan = state.drive_plan
    if plan is None or not isinstance(job, DriveJob):
        return
    drive = build_drive(plan, job.drive)
    for telegram in job.telegrams:
        data = telegram.request.data
        status, answer = drive.write_record(job.drive.record_index, data), b""
        drive.advance(drive.behaviour.processing)
        if not status:
            status, answer = drive.read_record(job.drive.record_index, max(telegram.response.size, 1))
        says = contact_text(Contact("", job.drive.key, "read", job.drive.record_index, status, answer, data))
        yield f"{answer.hex(' ').upper()}  {says}".strip()
