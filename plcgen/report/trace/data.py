"""A recorded run as plain data: every signal, every change, every telegram field by field."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from plcgen.base.display.data import diagnostic_data, head
from plcgen.base.telegrams.decoded import telegram_data

if TYPE_CHECKING:
    from plcgen.report.trace.model import BlockCall, Contact, JobResult, Signal, Step, Trace, Value


def trace_data(trace: Trace) -> dict[str, Any]:
    """The whole run; values that JSON lacks (infinite, not a number) are texts."""
    endings = [job.ending.replace(" ", "_") for job in trace.jobs]
    return {
        **head("trace", ok=trace.ok),
        "spec": trace.spec,
        "folder": trace.folder,
        "project": trace.project,
        "target": trace.target,
        "main": trace.main,
        "scan_time": trace.scan_time,
        "scans": trace.scans,
        "time": trace.time,
        "ended": trace.ended,
        "summary": {ending: endings.count(ending) for ending in sorted(set(endings))},
        "signals": [_signal(n, trace) for n in range(len(trace.signals))],
        "steps": [_step(step, trace) for step in trace.steps],
        "jobs": [_job(job) for job in trace.jobs],
        "diagnostics": [diagnostic_data(d) for d in trace.diagnostics],
    }


def _plain(value: Value) -> Any:
    """A value that JSON can hold."""
    if isinstance(value, list):
        return [_plain(item) for item in value]
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items()}
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value


def _signal(position: int, trace: Trace) -> dict[str, Any]:
    found: Signal = trace.signals[position]
    return {
        "id": found.id,
        "group": found.group,
        "name": found.name,
        "kind": found.kind,
        "bits": found.bits,
        "unit": found.unit,
        "path": found.path,
        "names": {str(number): name for number, name in found.names.items()},
        "start": _plain(trace.start[position]),
    }


def _step(step: Step, trace: Trace) -> dict[str, Any]:
    return {
        "scan": step.scan,
        "time": step.time,
        "changes": {trace.signals[n].id: _plain(value) for n, value in step.changes},
        "calls": [_call(call) for call in step.calls],
        "exchanges": [_contact(contact) for contact in step.contacts],
    }


def _call(call: BlockCall) -> dict[str, Any]:
    return {
        "group": call.group,
        "block": call.block,
        "instance": call.instance,
        "req": call.request,
        "busy": call.busy,
        call.shape.success.lower(): call.finished,
        "error": call.error,
        "status": f"{call.status:0{call.shape.bits // 4}X}",
    }


def _contact(contact: Contact) -> dict[str, Any]:
    return {
        "group": contact.group,
        "drive": contact.partner,
        "direction": contact.direction,
        "index": contact.index,
        "status": f"{contact.status:08X}",
        "text": contact.text,
        "telegram": telegram_data(contact.telegram) if contact.telegram is not None else None,
    }


def _job(job: JobResult) -> dict[str, Any]:
    return {
        "job": job.key,
        "drive": job.partner,
        "ending": job.ending.replace(" ", "_"),
        "status": f"{job.status:04X}",
        "text": job.text,
        "scan": job.scan,
        "time": job.time,
        "telegrams": job.telegrams,
        "retries": job.retries,
        "record_status": f"{job.record_status:08X}",
        "record_text": job.record_text,
        "values": [
            {
                "parameter": value.label,
                "member": value.member,
                "title": value.title,
                "unit": value.unit,
                "value": None if value.value is None else _plain(value.value),
                "meaning": value.meaning,
                "error": None if value.error is None else f"{value.error:02X}",
                "info": value.info,
            }
            for value in job.values
        ],
    }
