"""PPI telegram tables: start values decoded with the strict codec."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from functools import partial

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.ppi.plan.nouns import PlannedMaster, PpiPlan, PpiTelegram
from plcgen.ppi.proof.words import LEAD
from plcgen.ppi.wire.errors import PpiError
from plcgen.ppi.wire.fdl import decode_frame
from plcgen.ppi.wire.model import FIRST, Item, ReadRequest, RunRequest, StopRequest, VariableFrame, WriteRequest
from plcgen.ppi.wire.pdu import decode_pdu
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.folder import Folder
from plcgen.proof.making import Pending
from plcgen.s7.layout.image import StartValueError, image, start_place
from plcgen.s7.layout.layout import layout_block


def check_telegrams(plan: PpiPlan, folder: Folder) -> Iterator[Pending]:
    """Checks of the group ``telegrams``: the table's start values are one telegram that says what the spec asks."""
    for master in plan.masters:
        for telegram in master.telegrams:
            job = next((job for job in master.jobs if telegram in job.telegrams), None)
            key = f"first frame to {plan.station_key(master, telegram.station)}"
            if job is not None:
                key = f"{plan.key(master, job)}{_part(job.telegrams, telegram)}"
            name = telegram.request.home.name
            make = partial(_telegram, plan, folder, master, telegram, key)
            yield Pending(f"telegram.{name}", key, partial(folder.place, name), make)


def _part(telegrams: tuple[PpiTelegram, ...], telegram: PpiTelegram) -> str:
    return f" {telegrams.index(telegram) + 1}" if len(telegrams) > 1 else ""


def _telegram(plan: PpiPlan, folder: Folder, master: PlannedMaster, telegram: PpiTelegram, key: str) -> Check:
    name, subject = f"telegram.{telegram.request.home.name}", key
    shown = telegram.request.data.hex(" ").upper()
    text = f"{shown} ({len(telegram.request.data)} bytes)"
    problem = _first_problem(plan, folder, master, telegram)
    if problem is None:
        return Check(name, subject, text, Outcome.OK, "start values form exactly this telegram")
    found = Diagnostic("PG604", problem, _place(folder, telegram), help="run plcgen generate")
    return Check(name, subject, text, Outcome.ERROR, problem, found)


def _place(folder: Folder, telegram: PpiTelegram) -> Span:
    """The line that says the first byte that is another one, or the block."""
    name, wanted = telegram.request.home.name, telegram.request.data
    block = folder.text.get(name.upper())
    with suppress(DiagnosticError, StartValueError):
        data = bytes(image(block, folder.text)) if block is not None else b""
        table = bytes([len(wanted), *wanted])
        at = next((at for at, pair in enumerate(zip(data, table, strict=False)) if pair[0] != pair[1]), None)
        if block is not None and at is not None:
            return start_place(block, folder.text, at) or folder.place(name)
    return folder.place(name)


def _first_problem(plan: PpiPlan, folder: Folder, master: PlannedMaster, telegram: PpiTelegram) -> str | None:
    """What is wrong with the start values in the text source or the SimaticML, or None."""
    for origin, blocks in (("text source", folder.text), ("SimaticML", folder.xml)):
        if origin == "SimaticML" and plan.target.xml_version is None:
            continue
        block = blocks.get(telegram.request.home.name.upper())
        if block is None:
            return f'DB "{telegram.request.home.name}" is missing in the {origin}s'
        try:
            data = bytes(image(block, blocks))
            size = layout_block(block, blocks).size
        except (DiagnosticError, StartValueError) as problem:
            return f"{origin}: {problem}"
        problem_text = _wrong(data[: min(size, len(data))], master, telegram)
        if problem_text is not None:
            return f"{origin}: {problem_text}"
    return None


def _wrong(data: bytes, master: PlannedMaster, telegram: PpiTelegram) -> str | None:
    """Compare the bytes of a table with what the spec asks for, through the strict decoder."""
    length = data[0]
    frame = data[LEAD : LEAD + length]
    try:
        found = decode_frame(frame)
        pdu = decode_pdu(found.pdu) if isinstance(found, VariableFrame) else None
    except PpiError as problem:
        return f"the start values form no telegram: {problem}"
    if not isinstance(found, VariableFrame) or pdu is None:
        return "the start values form no request"
    wanted = (telegram.station.address, master.own_address, FIRST)
    if (found.destination, found.source, found.function) != wanted:
        return f"stations and function code are {found.destination}, {found.source}, {found.function:02X}h"
    if pdu.reference:
        return f"the start value of the reference is {pdu.reference}"
    return _other(pdu, telegram)


def _other(pdu: object, telegram: PpiTelegram) -> str | None:
    kinds = {"run": RunRequest, "stop": StopRequest, "write": WriteRequest}
    if not isinstance(pdu, kinds.get(telegram.kind, ReadRequest)):
        return f"the request is a {type(pdu).__name__}, not what a {telegram.kind} job sends"
    if isinstance(pdu, WriteRequest):
        return _same([(entry.item, entry.data) for entry in pdu.items], [(w.item, w.data) for w in telegram.items])
    if isinstance(pdu, ReadRequest):
        return _same([(item, b"") for item in pdu.items], [(wire.item, b"") for wire in telegram.items])
    return None


def _same(found: list[tuple[Item, bytes]], wanted: list[tuple[Item, bytes]]) -> str | None:
    if len(found) != len(wanted):
        return f"{len(found)} items instead of {len(wanted)}"
    for number, (have, want) in enumerate(zip(found, wanted, strict=True), 1):
        if have != want:
            return f"item {number} is {have[0]} {have[1].hex(' ')}, not {want[0]} {want[1].hex(' ')}"
    return None
