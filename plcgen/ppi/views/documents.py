"""What PPI masters contribute to the documents: diagnostics, function blocks, parts of the import guide."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

from plcgen.build.members import fixed
from plcgen.build.nouns import Contribution, GuidePart, TypeBlock
from plcgen.build.spelling import literal
from plcgen.ppi.plan.nouns import PlannedMaster, PpiPlan, PpiValue
from plcgen.ppi.plan.times import GAP_BITS, line_ms
from plcgen.ppi.views.program import MAX_MESSAGE, MODULES, program
from plcgen.ppi.words import DIAGNOSTICS
from plcgen.s7.types.data_types import Elementary

_SYMBOLS = (("P_RCV_RK", "FB 7", "FB 7", "CP 341: receive"), ("P_SND_RK", "FB 8", "FB 8", "CP 341: send"))


def contribution(plan: PpiPlan) -> Contribution:
    """Everything of a plan."""
    return Contribution(
        family="PPI",
        jobs="jobs",
        types=(TypeBlock(plan.diagnostics_type, fixed(plan, DIAGNOSTICS)),),
        data=(),
        programs=(program(plan, master) for master in plan.masters),
        controls={plan.control_db: "Commands and results of all PPI jobs"},
        tag_table=f"{plan.prefix}PpiJobTags",
        guide=partial(_guide, plan),
        manifest=partial(_manifest, plan),
        symbols=_SYMBOLS,
    )


def _guide(plan: PpiPlan) -> tuple[list[GuidePart], list[GuidePart]]:
    speeds = sorted({master.baud for master in plan.masters})
    view = {
        "controls": [plan.control_db.name],
        "masters": [
            {"block": master.block.name, "module": MODULES[master.module], "baud": master.baud, "port": master.port}
            for master in plan.masters
        ],
        "speed": f"{speeds[0]} bit/s" if len(speeds) == 1 else "the speed of its master above",
        "gap_ms": max(4, line_ms(GAP_BITS, speeds[0])),
        "gap_bits": GAP_BITS,
        "most": MAX_MESSAGE,
        "writes": [row for master in plan.masters for row in _writes(plan, master)],
        "numbered": [master.buffer for master in plan.masters if master.buffer is not None],
    }
    return [("ppi/import.md.j2", view)], []


def _writes(plan: PpiPlan, master: PlannedMaster) -> Iterator[dict[str, str]]:
    for job in master.jobs:
        row = {"job": f"{master.block.name}, job {job.key}", "station": f"{job.station.key} ({job.station.address})"}
        if job.kind in {"run", "stop"}:
            yield {**row, "label": "CPU", "value": job.kind.upper()}
        for value in job.values if job.kind == "write" else ():
            yield {**row, "label": value.label, "value": written_value(plan, value)}


def written_value(plan: PpiPlan, value: PpiValue) -> str:
    """What a job writes: its constant, or that an input of the block says it."""
    if value.constant and isinstance(value.element, Elementary):
        text = literal(value.element, value.data[: value.size], v5=plan.target.v5)
        return f"{value.count} times {text}" if value.count > 1 else text
    return "block input"


def _manifest(plan: PpiPlan) -> dict[str, Any]:
    masters = [
        {
            "master": master.key,
            "block": master.block.name,
            "telegrams": [
                {
                    "request": telegram.request.data.hex(" ").upper(),
                    "request_db": f"DB{telegram.request.home.number}",
                    **({"response_db": f"DB{telegram.response.home.number}"} if telegram.response else {}),
                }
                for telegram in master.telegrams
            ],
        }
        for master in plan.masters
    ]
    return {"ppi": masters}
