"""The blocks that are the same in every project of a target: channel, ticket and gate with their types."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from plcgen.build.members import plain
from plcgen.build.nouns import FunctionBlock, MemberRow, TypeBlock
from plcgen.build.simaticml import RECORD_NOTE
from plcgen.build.spelling import type_words
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.words import CHANNEL_STATES, CHANNEL_WORDS, DRAIN_MS, LEASE_MS, TICKET_WORDS
from plcgen.project.nouns import BlockRef

Row = tuple[str, str, str] | tuple[str, str, str, str]
"""Name, type, text and start value of a member; a type in quotes is a user type, ``n..m of`` an array."""

_TURN: list[Row] = [
    ("slotCount", "INT", "places of the unit; 0: the channel was never called"),
    ("beat", "INT", "counts in every call of the channel"),
    ("grant", "DINT", "who holds the unit: 100000 x slot + number under which it asked"),
    ("served", "INT", "telegram of that job that has ended"),
    ("status", "WORD", "its result"),
]
_ASK: list[Row] = [
    ("telegram", "INT", "telegram that is handed over"),
    ("mark", "INT", "counts in every call of the job while it is busy"),
    ("want", "INT", "number under which the job asks; not positive: it does not"),
]
_PLACE: list[Row] = [
    ("ask", "INT", "number under which the channel asks; 0: it does not"),
    ("beat", "INT", "counts in every call of the channel"),
    ("grant", "INT", "number that has a place; written by the gate"),
]


def types(plan: DrivePlan) -> list[TypeBlock]:
    """What the engine's blocks share, in the order in which a compiler wants it."""
    engine = plan.engine
    gate: list[Row] = [
        ("channels", f'1..{plan.variant.channels} of "{engine.place.name}"', "written by the channel of that number")
    ]
    return [
        TypeBlock(engine.order, _members(plan, _order(t15=plan.target.t15)), starts=True),
        TypeBlock(engine.turn, _members(plan, _TURN)),
        TypeBlock(engine.ask, _members(plan, _ASK)),
        TypeBlock(engine.unit, _members(plan, _unit(plan))),
        TypeBlock(engine.place, _members(plan, _PLACE)),
        TypeBlock(engine.gate_type, _members(plan, gate)),
    ]


def _order(*, t15: bool) -> list[Row]:
    number = "DB_ANY" if t15 else "INT"
    return [
        ("hardwareId", "HW_IO", "hardware identifier of the drive") if t15 else ("address", "DWORD", "ID of the drive"),
        ("length", "INT", "bytes of the request"),
        ("retries", "INT", "how often a telegram is tried again", "40"),
        ("timeout", "DINT", "ms, the whole job, all retries included", "L#10000"),
        ("pause", "DINT", "ms, pause before a retry or the next poll", "L#200"),
        ("once", "BOOL", "a lost request is not sent again: it starts something"),
        ("pinned", "BOOL", "the telegrams lie in data blocks of their own"),
        ("requestDb", number, "data block of the request"),
        ("responseDb", number, "data block of the response"),
        ("responseSize", "INT", "bytes of that one"),
    ]


def _unit(plan: DrivePlan) -> list[Row]:
    """The mailbox of a device: telegram and results, what the channel says, what its jobs say."""
    engine, size = plan.engine, plan.variant
    last, blocks = size.bytes - 1, size.parameters
    return [
        (
            "telegram",
            f"0..{last} of BYTE",
            "request; then the answer, every value where it lies if all are as expected",
        ),
        *([] if plan.target.t15 else [("record", f"0..{last} of BYTE", "what the drive answered")]),
        ("errors", f"1..{blocks} of WORD", "per parameter of the telegram, as at the job"),
        ("infos", f"1..{blocks} of WORD", "per parameter of the telegram, as at the job"),
        (
            "expected",
            f"1..{blocks} of DWORD",
            "per parameter that is read: 16#ttnn00bb = type (00 = any), number of values, bytes",
        ),
        ("order", f'"{engine.order.name}"', "what goes with the request"),
        ("turn", f'"{engine.turn.name}"', "what the channel says to all jobs"),
        ("recordStatus", "DWORD", "STATUS of the last WRREC or RDREC that ended"),
        ("failed", "INT", "first parameter of the telegram that failed, 0 = none"),
        ("state", "INT", "state of the channel, see its STATE constants"),
        ("retries", "INT", "retries of this telegram"),
        ("asks", f'1..{size.slots} of "{engine.ask.name}"', "written by the job that has the slot"),
        ("ended", f"1..{size.slots} of INT", "number that the channel serves no more"),
    ]


def _members(plan: DrivePlan, rows: Sequence[Row]) -> list[MemberRow]:
    words = type_words(tia=not plan.target.v5)
    found = []
    for name, type_, text, *start in rows:
        bounds, of, element = type_.rpartition(" of ")
        shown = words.get(element, element)
        if of:
            shown = f"ARRAY[{bounds}] OF {shown}" if plan.target.v5 else f"Array[{bounds}] of {shown}"
        found.append(plain(plan, name, shown, text, *start))
    return found


def engine_names(plan: DrivePlan) -> dict[str, str]:
    """Names of the engine's blocks for the templates."""
    engine = plan.engine
    return {
        "channel": engine.channel.name,
        "ticket": engine.ticket.name,
        "gate": engine.gate.name,
        "gate_data": engine.gate_type.name,
        "place": engine.place.name,
        "unit": engine.unit.name,
        "order": engine.order.name,
        "turn": engine.turn.name,
        "ask": engine.ask.name,
    }


def programs(plan: DrivePlan) -> list[FunctionBlock]:
    """Ticket, gate and channel."""
    view = {
        "names": engine_names(plan),
        "v5": plan.target.v5,
        "slots": plan.variant.slots,
        "last": plan.variant.bytes - 1,
        "blocks": plan.variant.parameters,
        "gate_channels": plan.variant.channels,
        "drain_ms": DRAIN_MS,
        "lease_ms": LEASE_MS,
        "record_address": f"DW#16#{0x84000000 + 8 * plan.variant.bytes:08X}",
        "versions": versions(plan),
        "states": CHANNEL_STATES,
        "statuses": _words(CHANNEL_WORDS, wrong_db=not plan.target.t15),
        "job_statuses": _words(TICKET_WORDS, wrong_db=True),
    }
    engine = plan.engine
    return [
        _block(engine.ticket, "How a job asks for its unit and waits for its turn", "ds47/engine/ticket.scl.j2", view),
        _block(engine.gate, "Places for record jobs of this CPU", "ds47/engine/gate.scl.j2", view),
        _block(engine.channel, "Parameter channel of one drive unit", "ds47/engine/channel.scl.j2", view),
    ]


def _words(words: Sequence[tuple[str, int, str]], *, wrong_db: bool) -> list[tuple[str, str, str]]:
    return [(name, f"W#16#{v:04X}", text) for name, v, text in words if wrong_db or name != "STATUS_WRONG_DB"]


def _block(block: BlockRef, title: str, template: str, view: dict[str, Any]) -> FunctionBlock:
    return FunctionBlock(block, None, title, template, view, RECORD_NOTE, (), (), ())


def versions(plan: DrivePlan) -> dict[str, str]:
    """Versions of the instructions that the blocks use."""
    default = {"WRREC": "1.1" if plan.target.t15 else "1.0", "RDREC": "1.0", "TON_TIME": "1.0"}
    return default | plan.loaded.spec.plc.instructions.model_dump(exclude_none=True)
