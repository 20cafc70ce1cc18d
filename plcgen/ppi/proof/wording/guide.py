"""The part of IMPORT.md about PPI masters, line by line, and what the manifest says of them, stated a second time."""

from __future__ import annotations

import re
import struct
import tomllib
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from plcgen.ppi.plan.nouns import PlannedMaster, PpiPlan, PpiValue
from plcgen.ppi.proof.words import GAP_BITS, LONGEST
from plcgen.proof.folder import plain
from plcgen.proof.wording.model import GuideLine


@cache
def sentences() -> Mapping[str, Any]:
    """Texts by what a block is and the name of a member, and the lines of the guide."""
    return tomllib.loads((Path(__file__).parent / "sentences.toml").read_text("utf-8"))


SIGNED = frozenset({"INT", "DINT", "SINT"})
MODULES = {"cm1241": "CM 1241", "cb1241": "CB 1241", "cm-ptp": "CM PtP", "cp341": "CP 341"}
LEAST_GAP_MS = 4
"""Character delay time of a CP 341: at least so many milliseconds (manual of the CP 341)."""


def guide_before(plan: PpiPlan) -> list[GuideLine]:
    """Modules with their settings, numbers of data blocks, what is written."""
    where = "hardware identifier" if plan.target.t15 else "address"
    found = [
        "## PPI masters",
        *(
            f"- `{one.block.name}`: {MODULES[one.module]} at {where} {one.port}, {one.baud} bit/s"
            for one in plan.masters
        ),
        *_module(plan),
        *_said("jobs", controls=f"`{plan.control_db.name}`"),
        *([] if plan.target.v5 else _said("by_name")),
    ]
    writes = [line for master in plan.masters for line in _writes(master)]
    head = [GuideLine("## What these masters write"), GuideLine("| job | station | address | value |")]
    return [*map(GuideLine, found), *(head if writes else []), *writes]


def _module(plan: PpiPlan) -> Iterator[str]:
    """How the modules are set, and where their blocks come from; what differs is said of each master."""
    slowest, fastest = min(one.baud for one in plan.masters), max(one.baud for one in plan.masters)
    speed = f"{slowest} bit/s" if slowest == fastest else "the speed of its master above"
    if plan.target.t15:
        yield from _said("cm", speed=speed, gap=GAP_BITS, longest=LONGEST)
        return
    gap = max(LEAST_GAP_MS, -(-GAP_BITS * 1000 // slowest))
    yield from _said("cp", speed=speed, gap=gap, longest=LONGEST)
    yield from _said("v5" if plan.target.v5 else "tia")
    yield " ".join([*_said("buffers"), *([] if plan.target.v5 else _said("number"))])
    yield from _said("numbers")
    yield from (f"| {one.buffer.name} | DB{one.buffer.number} |" for one in plan.masters if one.buffer is not None)


def _said(part: str, **words: object) -> list[str]:
    return [line.format(**words) for line in sentences()["guide"][part]]


def _writes(master: PlannedMaster) -> Iterator[GuideLine]:
    for job in master.jobs:
        front = f"| {master.block.name}, job {job.key} | {job.station.key} ({job.telegrams[0].request.data[4]}) |"
        if job.kind in {"run", "stop"}:
            yield GuideLine(f"{front} CPU | {job.kind.upper()} |")
        for value in job.values if job.kind == "write" else ():
            yield _written(plain(f"{front} {value.label} |"), value)


def _written(front: str, value: PpiValue) -> GuideLine:
    def accepts(text: str) -> bool:
        said = text.removeprefix(front).removesuffix("|").strip()
        return text.startswith(front) and says_value(value, said)

    return GuideLine(f"{front} {_shown(value) if value.constant else 'block input'} |", accepts)


def _shown(value: PpiValue) -> str:
    """A constant as a person reads it."""
    data, name = value.data[: value.size], value.element.name
    if name == "REAL":
        text = f"{struct.unpack('>f', data)[0]:.7g}"
    elif name in SIGNED:
        text = str(int.from_bytes(data, signed=True))
    else:
        text = f"16#{data.hex().upper()}"
    return f"{value.count} times {text}" if value.count > 1 else text


def says_value(value: PpiValue, text: str) -> bool:
    """Whether a cell names what is written: a constant, or that an input says it."""
    if not value.constant:
        return text == "block input"
    data = value.data[: value.size]
    if value.count > 1:
        times, _, text = text.partition(" times ")
        if times != str(value.count) or value.data != data * value.count:
            return False
    if text in {"TRUE", "FALSE"}:
        return (text == "TRUE") == any(data)
    if (found := re.fullmatch(r"(?:[A-Z]+#)?16#([0-9A-F]+)", text)) is not None:
        return int(found[1], 16) == int.from_bytes(data)
    if text.startswith("'"):
        return text[1:-1].encode("latin-1", "replace").endswith(data)
    try:
        number = float(text.rpartition("#")[2])
    except ValueError:
        return False
    if value.element.name == "REAL":
        return struct.pack(">f", number) == data
    return int(number) == int.from_bytes(data, signed=value.element.name in SIGNED)


def listed_master(master: PlannedMaster) -> dict[str, object]:
    """A master in the manifest: its telegrams as they lie on disk."""
    telegrams = []
    for one in master.telegrams:
        found: dict[str, object] = {
            "request": one.request.data.hex(" ").upper(),
            "request_db": f"DB{one.request.home.number}",
        }
        if one.response is not None:
            found["response_db"] = f"DB{one.response.home.number}"
        telegrams.append(found)
    return {"master": master.key, "block": master.block.name, "telegrams": telegrams}
