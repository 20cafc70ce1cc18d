"""Telegram tables and response DBs of a PPI master: start values, what was sent, and what the line brought.

Tables and DBs are littered before the job, so a copy that is missing shows.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from functools import partial

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.ppi.plan.nouns import PlannedMaster, PpiJob, PpiPlan, PpiTelegram
from plcgen.ppi.proof.rig import MasterRig
from plcgen.ppi.proof.words import LEAD
from plcgen.ppi.wire.errors import PpiError
from plcgen.ppi.wire.fdl import decode_frame, examine_frame
from plcgen.ppi.wire.model import (
    FIRST,
    Item,
    ReadReply,
    ReadRequest,
    RunRequest,
    StopRequest,
    VariableFrame,
    WriteReply,
    WriteRequest,
)
from plcgen.ppi.wire.pdu import decode_pdu, examine_pdu
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.folder import Folder
from plcgen.proof.making import Pending
from plcgen.proof.scenario import ScenarioError
from plcgen.s7.layout.image import StartValueError, image, start_place
from plcgen.s7.layout.layout import layout_block

LITTER = 0xA5
DATA = 14
"""Where the data of a reply with items begins: header 12, function, number of items."""
RUN_TIME = frozenset({"function_code", "reference", "fcs"})
"""Members of a table that the block fills whatever they were."""


def litter(rig: MasterRig) -> None:
    """Fill every response DB and what the block fills in every table with a pattern."""
    for telegram in rig.master.telegrams:
        table = rig.cpu.db(telegram.request.home.name)
        for field in telegram.request.fields:
            if field.role in RUN_TIME:
                table[field.offset : field.offset + field.size] = bytes((LITTER,)) * field.size
        if telegram.response is not None:
            response = rig.cpu.db(telegram.response.home.name)
            response[:] = bytes((LITTER,)) * len(response)


def check_job_tables(rig: MasterRig, job: PpiJob, *, refused: bool) -> None:
    """Tables and response DBs after a job that is done, or whose last telegram has refused items."""
    last = rig.db.get("telegram")
    for telegram in rig.master.telegrams:
        mine = telegram in job.telegrams and telegram.number <= last
        if mine:
            reply = _exchange(rig, telegram)
            _compare(rig, telegram, reply, refused=refused and telegram.number == last)
        elif telegram.response is not None and set(rig.cpu.db(telegram.response.home.name)) - {LITTER}:
            raise ScenarioError(f'"{telegram.response.home.name}" changed although its telegram was not sent')


def _exchange(rig: MasterRig, telegram: PpiTelegram) -> bytes:
    """The table is the request that was sent; PDU of the reply to it."""
    table = bytes(rig.cpu.db(telegram.request.home.name)[LEAD : LEAD + len(telegram.request.data)])
    if table not in {data for _, data in rig.port.sent}:
        raise ScenarioError(f'"{telegram.request.home.name}" holds {table.hex(" ").upper()}, which was not sent')
    frame = examine_frame(table)[0]
    reference = frame.pdu[4:6] if isinstance(frame, VariableFrame) else b""
    for entry in reversed(rig.line.journal):
        answer = entry.frame
        known = isinstance(answer, VariableFrame) and answer.source == telegram.station.address
        if entry.direction == "<" and known and isinstance(answer, VariableFrame) and answer.pdu[4:6] == reference:
            return answer.pdu
    raise ScenarioError(f'nothing answered "{telegram.request.home.name}", but the job says so')


def _compare(rig: MasterRig, telegram: PpiTelegram, pdu: bytes, *, refused: bool) -> None:
    """Every member of the response DB is what the reply says; without values if an item was refused."""
    if telegram.response is None:
        return
    found = rig.cpu.db(telegram.response.home.name)
    reply = examine_pdu(pdu)[0]  # a return code that nobody knows is one, too
    if isinstance(reply, ReadReply):
        codes = [result.code for result in reply.results]
    elif isinstance(reply, WriteReply):
        codes = list(reply.codes)
    else:
        raise ScenarioError(f'"{telegram.response.home.name}": the reply has no items')
    for field in telegram.response.fields:
        kept = telegram.items[field.item - 1].item.octets if field.role == "value" else field.size  # without pad
        if field.role == "return_code":
            wanted = bytes((codes[field.item - 1],))
        elif field.role == "pad" or refused:
            wanted = b""
        else:
            wanted = pdu[DATA + field.offset : DATA + field.offset + kept]
        wanted += bytes((LITTER,)) * (field.size - len(wanted))
        octets = bytes(found[field.offset : field.offset + field.size])
        if octets != wanted:
            shown = f"{octets.hex(' ').upper()} instead of {wanted.hex(' ').upper()}"
            raise ScenarioError(f'"{telegram.response.home.name}".{field.name} is {shown}')


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
