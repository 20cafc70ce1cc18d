"""The review page as the template shows it: plain dictionaries and lists; the template escapes every text."""

from __future__ import annotations

import hashlib
import tomllib
from base64 import b64encode
from collections.abc import Callable, Iterator, Sequence
from functools import cache, partial
from typing import Any

from plcgen.base.diagnostics import Diagnostic
from plcgen.base.display.cells import clean
from plcgen.base.resources import templates_dir
from plcgen.build.phrases import LANGUAGES
from plcgen.build.sheet import ExchangeSheet, Message, MessageField, Role, WriteEntry
from plcgen.proof.checks import Outcome
from plcgen.report.review.grid import matrix, scenario_grids
from plcgen.report.review.model import LayoutPair, RecordedRun, Review
from plcgen.report.review.timeline import time_line
from plcgen.s7.compare.model import Change, Comparison
from plcgen.s7.tables.pictures import views

_SUBJECTS = 3
"""So many blocks that differ from the lock are named in the verdict."""
MAX_EXCHANGES = 60
"""Telegrams that are drawn byte by byte; ``layout`` has them all."""
MAX_LAYOUTS = 120
MAX_CHANGES = 1000
MAX_DETAILS = 60
MAX_FILES = 5000
CHUNK = 32
"""Rows of a picture that are shown at once."""
PARTS = (
    ("verdict", "Verdict"), ("changes", "What changed"), ("writes", "Write list"), ("telegrams", "Telegrams"),
    ("layouts", "Layouts"), ("runs", "Runs"), ("matrix", "Fault matrix"), ("signoff", "Sign-off"),
)  # fmt: skip
ROLES = tuple((role.value, text) for role, text in zip(
    Role,
    ("header", "address of a parameter", "format and number", "value", "error", "pad or reserve"),
    strict=True,
))  # fmt: skip


def page_view(review: Review, script: str) -> dict[str, Any]:
    """Everything that the template needs; ``script`` is the text of its only script, permitted by its hash."""
    say = partial(said_in, review.language)
    return {
        **script_view(script),
        "_": say,
        "language": review.language if review.language in LANGUAGES else "en",
        "shown_verdict": shown_verdict(review, say),
        "parts": [PARTS[1], PARTS[0], *PARTS[2:]] if review.changes else PARTS,
        "roles": ROLES,
        "review": review,
        "verdict": verdict(review),
        "outcomes": outcomes(review),
        "problems": [_problem(problem) for problem in review.problems],
        "files": [(clean(f.path), f.bytes, f.sha256, clean(f.experimental)) for f in review.files[:MAX_FILES]],
        "more_files": max(0, len(review.files) - MAX_FILES),
        "changes": [comparison_view(title, found, planned=review.planned) for title, found in review.changes],
        "lock": comparison_view("the layout lock against the sources", review.lock, planned=review.planned)
        if review.lock is not None
        else None,
        "writes": list(write_rows(review)),
        "no_writes": no_writes(review),
        "lock_reason": clean(lock_reason(review)),
        "instances": [tuple(map(clean, (i.job, i.partner, i.address, i.trigger))) for i in review.sheet.instances],
        "exchanges": [_exchange(review, n, one) for n, one in enumerate(review.sheet.exchanges[:MAX_EXCHANGES], 1)],
        "more_exchanges": max(0, len(review.sheet.exchanges) - MAX_EXCHANGES),
        "layouts": list(_layouts(review.layouts[:MAX_LAYOUTS])),
        "more_layouts": max(0, len(review.layouts) - MAX_LAYOUTS),
        "runs": [_run(n, run) for n, run in enumerate(review.runs, 1)],
        "matrix": matrix(review.verification),
        "scenarios": list(scenario_grids(review.verification)),
    }


def script_view(script: str) -> dict[str, str]:
    """A script, and the hash by which the policy of its page permits it and no other."""
    digest = b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return {"script": script, "script_hash": f"sha256-{digest}"}


def verdict(review: Review) -> str:
    """The verdict in a few words; what was not run is part of it."""
    if not review.ok:
        return "not in order"
    left = len(review.not_run)
    return f"in order as far as it was run, {left} not run" if left else "in order"


def shown_verdict(review: Review, say: Callable[[str], str]) -> str:
    """The verdict in a language, with the names of what was not run."""
    apart = f"; {say('made from the spec now: the folder on disk was not looked at')}" if review.made_now else ""
    if not review.ok or not review.not_run:
        return f"{say(verdict(review))}{apart}"
    left = [clean(check.subject) for check in review.not_run]
    names = f"{', '.join(left[:_SUBJECTS])}{', ..' if left[_SUBJECTS:] else ''}"
    return f"{say('in order as far as it was run')}, {len(left)} {say('not run')}: {names}{apart}"


def said_in(language: str, label: str) -> str:
    """A label of the page in a language; what the table has not stays as it is."""
    return dict(zip(LANGUAGES, _labels().get(label, ()), strict=False)).get(language, label)


@cache
def _labels() -> dict[str, list[str]]:
    return tomllib.loads((templates_dir() / "html" / "review.toml").read_text("utf-8"))


def no_writes(review: Review) -> str:
    """What an empty write list says: nothing is known of a spec that cannot be planned."""
    if review.planned:
        return "These blocks write nothing to a partner."
    return "Not known: the spec has errors."


def compared(found: Comparison, *, planned: bool = True) -> str:
    """How many changes of which class; that there are none is known only if both sides, and the spec, can be read."""
    if not planned:
        return found.counts or "not known: the spec has errors"
    return found.counts or ("no differences" if found.readable else "not known: there are errors")


def lock_reason(review: Review) -> str:
    """Why a lock makes the verdict what it is, and where it differs; empty if it does not."""
    if review.lock is None or not review.lock.changes:
        return ""
    subjects = list(dict.fromkeys(change.subject for change in review.lock.changes))
    more = f" and {len(subjects) - _SUBJECTS} more" if len(subjects) > _SUBJECTS else ""
    where = f"{', '.join(subjects[:_SUBJECTS])}{more}"
    old = review.lock.old
    return f"the lock {old} differs from the sources ({review.lock.counts}): {where}; if meant, plcgen lock"


def outcomes(review: Review) -> list[tuple[str, int]]:
    """How many checks had which outcome, those that did not occur left out."""
    return [(outcome.value, count) for outcome in Outcome if (count := review.count(outcome))]


def _problem(problem: Diagnostic) -> dict[str, str]:
    place = str(problem.span) if problem.span.file else ""
    return {
        "code": problem.code, "level": problem.severity.label, "text": clean(problem.message),
        "place": clean(place), "help": clean(problem.help),
    }  # fmt: skip


def comparison_view(title: str, found: Comparison, *, planned: bool) -> dict[str, Any]:
    """A comparison as rows, the worst of each subject first."""
    rows = [_change(subject, change) for subject, changes in found.folded() for change in changes]
    return {
        "title": title,
        "old": clean(found.old),
        "new": clean(found.new),
        "counts": compared(found, planned=planned),
        "readable": found.readable,
        "problems": [_problem(problem) for problem in found.diagnostics],
        "sentences": [(one.level.value, clean(one.who), clean(one.text)) for one in found.sentences],
        "inside": clean(", ".join(sorted(found.inside))),
        "rows": rows[:MAX_CHANGES],
        "more": max(0, len(rows) - MAX_CHANGES),
    }


def _change(subject: str, change: Change) -> dict[str, Any]:
    return {
        "level": change.level.value, "subject": clean(subject), "text": clean(change.text), "id": change.kind,
        "details": [clean(detail) for detail in change.details[:MAX_DETAILS]],
        "more": max(0, len(change.details) - MAX_DETAILS),
    }  # fmt: skip


def write_rows(review: Review) -> Iterator[dict[str, Any]]:
    """The write list, dangerous ones first in their job's order."""
    for entry in review.sheet.writes:
        yield {
            "job": clean(entry.job), "block": clean(entry.block), "partners": [clean(p) for p in entry.partners],
            "parameter": clean(entry.parameter), "text": clean(entry.text), "value": _written(entry),
            "limits": clean(entry.limits), "unit": clean(entry.unit), "trigger": clean(entry.trigger),
            "memory": clean(entry.memory), "danger": clean(entry.danger), "signed": clean(entry.signed),
            "safety": entry.safety, "doubts": [clean(doubt) for doubt in entry.doubts],
        }  # fmt: skip


def _written(entry: WriteEntry) -> str:
    """The value as a reader needs it: a constant, or an input and what it holds while nothing is connected."""
    text = clean(entry.value)
    if not entry.input:
        return text
    return "input of the block" if text == "block input" else f"input; {text} if nothing is connected"


# --- telegrams ---------------------------------------------------------------------------------------------


def _exchange(review: Review, number: int, exchange: ExchangeSheet) -> dict[str, Any]:
    key = f"t{number}"
    messages = [(f"{key}q", exchange.request), *((f"{key}a{n}", m) for n, m in enumerate(exchange.answers, 1))]
    which = f", telegram {exchange.number} of {exchange.count}" if exchange.count > 1 else ""
    lines = _excerpts(review, key, [message for _, message in messages])
    linked = {(line["home"], line["member"]): line["anchor"] for group in lines for line in group["lines"]}
    return {
        "id": key,
        "title": clean(f"{exchange.job}{which}"),
        "block": clean(exchange.block),
        "partners": [clean(i.partner) for i in review.sheet.instances if i.job == exchange.job],
        "lengths": exchange.lengths,
        "messages": [_message(anchor, message, linked) for anchor, message in messages],
        "sources": lines,
    }


def _excerpts(review: Review, key: str, messages: Sequence[Message]) -> list[dict[str, Any]]:
    homes = {message.home.name for message in messages}
    found = []
    for number, excerpt in enumerate((e for e in review.excerpts if e.block in homes), 1):
        lines = [
            {
                "number": line.number,
                "text": clean(line.text),
                "member": line.member,
                "home": excerpt.block,
                "anchor": f"{key}s{number}-{line.number}",
            }
            for line in excerpt.lines
        ]
        found.append({"file": clean(excerpt.file), "lines": lines})
    return found


def _message(anchor: str, message: Message, linked: dict[tuple[str, int], str]) -> dict[str, Any]:
    fields = [_field(anchor, message, field, linked) for field in message.fields]
    number = f"{message.home.kind}{message.home.number}" if message.home.kind == "DB" else message.home.kind
    return {
        "title": message.title,
        "home": clean(f'{number} "{message.home.name}"'),
        "length": message.length,
        "size": message.size,
        "fields": fields,
        "addressed": any(field["address"] for field in fields),
    }


def _field(anchor: str, message: Message, field: MessageField, linked: dict[tuple[str, int], str]) -> dict[str, Any]:
    return {
        "id": f"{anchor}-{field.offset}",
        "offset": field.offset,
        "role": field.role.value,
        "bytes": ["\N{MIDDLE DOT}\N{MIDDLE DOT}" if byte is None else f"{byte:02X}" for byte in field.data],
        "name": clean(field.name),
        "address": clean(field.address),
        "value": clean(field.value),
        "meaning": clean(field.meaning),
        "source": linked.get((message.home.name, field.offset), ""),
    }


# --- layouts, runs -----------------------------------------------------------------------------------------


def _layouts(pairs: Sequence[LayoutPair]) -> Iterator[dict[str, Any]]:
    for number, pair in enumerate(pairs, 1):
        tables = [table for table in (pair.before if pair.changed or pair.after is None else None, pair.after) if table]
        shown = views(tables, CHUNK, f"d{number}-")
        if pair.after is None:
            state = "removed"
        elif pair.before is None:
            state = ""
        else:
            state = "changed" if pair.changed else "as before"
        titles = ("before", "after") if len(shown) > 1 else ("",)
        yield {"state": state, "blocks": list(zip(titles, shown, strict=True))}


def _run(number: int, run: RecordedRun) -> dict[str, Any]:
    lines = [(clean(job.key), time_line(run.trace, job)) for job in run.trace.jobs]
    problems = [_problem(problem) for problem in run.trace.diagnostics]
    return {"id": f"r{number}", "job": clean(run.job), "fault": clean(run.fault), "lines": lines, "problems": problems}
