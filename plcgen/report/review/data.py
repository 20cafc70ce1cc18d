"""A review as plain data."""

from __future__ import annotations

from typing import Any

from plcgen.base.display.data import head
from plcgen.build.sheet import ExchangeSheet, Message, ReviewSheet
from plcgen.proof.data import verification_data
from plcgen.report.review.model import Review
from plcgen.report.trace.data import trace_data
from plcgen.s7.compare.text import comparison_data


def review_data(review: Review) -> dict[str, Any]:
    """Everything of the page but its pictures; the parts have the shapes of the verbs that they come from."""
    return {
        **head("review", ok=review.ok),
        "spec": review.spec,
        "folder": review.folder,
        "project": review.project,
        "target": review.target,
        "spec_sha256": review.spec_hash,
        "included": list(review.included),
        "files_sha256": review.files_hash,
        "files": [
            {"path": f.path, "sha256": f.sha256, "bytes": f.bytes, "experimental": f.experimental} for f in review.files
        ],
        "missing": list(review.missing),
        "base": review.base,
        "changes": [{"title": title, **comparison_data(found, "never")} for title, found in review.changes],
        "lock": comparison_data(review.lock, "any") if review.lock is not None else None,
        **sheet_data(review.sheet),
        "layouts": [
            {
                "before": pair.before.title if pair.before is not None else None,
                "after": pair.after.title if pair.after is not None else None,
                "changed": pair.changed,
            }
            for pair in review.layouts
        ],
        "runs": [{"job": run.job, "fault": run.fault, "trace": trace_data(run.trace)} for run in review.runs],
        "verification": verification_data(review.verification),
    }  # fmt: skip


def sheet_data(sheet: ReviewSheet) -> dict[str, Any]:
    """What is written, to whom, and every telegram byte by byte."""
    return {
        "writes": [
            {
                "job": w.job, "block": w.block, "partners": list(w.partners), "parameter": w.parameter, "text": w.text,
                "value": w.value, "input": w.input, "limits": w.limits, "unit": w.unit, "trigger": w.trigger,
                "memory": w.memory, "danger": w.danger, "signed": w.signed, "safety": w.safety,
                "doubts": list(w.doubts),
            }
            for w in sheet.writes
        ],
        "instances": [
            {"job": i.job, "key": i.key, "partner": i.partner, "address": i.address, "trigger": i.trigger}
            for i in sheet.instances
        ],
        "telegrams": [_exchange(exchange) for exchange in sheet.exchanges],
    }  # fmt: skip


def _exchange(exchange: ExchangeSheet) -> dict[str, Any]:
    return {
        "job": exchange.job,
        "block": exchange.block,
        "number": exchange.number,
        "request": _message(exchange.request),
        "answers": [_message(message) for message in exchange.answers],
        "lengths": dict(exchange.lengths),
    }


def _message(message: Message) -> dict[str, Any]:
    """Bytes as numbers; null where the partner decides."""
    return {
        "title": message.title,
        "block": message.home.name,
        "size": message.size,
        "fields": [
            {
                "offset": field.offset, "bytes": list(field.data), "name": field.name, "role": field.role.value,
                "address": field.address, "value": field.value, "meaning": field.meaning,
            }
            for field in message.fields
        ],
    }  # fmt: skip
