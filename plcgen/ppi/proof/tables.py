"""Telegram tables and response DBs of a PPI master after a job: what was sent, and what the line brought.

Both are littered before the job, so a copy that is missing shows.
"""

from __future__ import annotations

from plcgen.ppi.plan.nouns import PpiJob, PpiTelegram
from plcgen.ppi.proof.rig import MasterRig
from plcgen.ppi.proof.words import LEAD
from plcgen.ppi.wire.fdl import examine_frame
from plcgen.ppi.wire.model import ReadReply, VariableFrame, WriteReply
from plcgen.ppi.wire.pdu import examine_pdu
from plcgen.proof.scenario import ScenarioError

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
