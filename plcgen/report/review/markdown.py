"""A review as Markdown for a pull request: bounded, the important first; what does not fit is named."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from plcgen.base.display.cells import clean
from plcgen.base.display.markdown import code_span, escape
from plcgen.base.display.table import markdown_table
from plcgen.report.review.grid import matrix
from plcgen.report.review.model import Review
from plcgen.report.review.page import compared, lock_reason, no_writes, outcomes, verdict, write_rows
from plcgen.report.review.timeline import time_line
from plcgen.s7.compare.model import Comparison
from plcgen.s7.tables.tables import BlockTable

LIMIT = 60_000
"""Bytes of the whole text: a comment of GitHub holds 65,536 characters."""

_MARK = {"breaking": ":red_circle:", "compatible": ":yellow_circle:", "documentation": ":white_circle:"}
_CELL = 400
_TAIL = 400
"""Bytes kept for the sentence about what was left out."""


@dataclass(frozen=True, slots=True)
class _Part:
    """A part of the text; ``fixed`` lines begin it (the head of a table), of the others as many as fit."""

    title: str
    fixed: Sequence[str]
    lines: Sequence[str]
    folded: bool = False


def review_markdown(review: Review) -> str:
    """The whole text, at most ``LIMIT`` bytes in UTF-8."""
    out: list[str] = []
    left = LIMIT - _TAIL
    omitted: list[str] = []
    for part in _parts(review):
        if not part.lines and not part.fixed:
            continue
        opening = [f"<details><summary>{part.title}</summary>", ""] if part.folded else [f"### {part.title}", ""]
        closing = ["", "</details>", ""] if part.folded else [""]
        left -= _size([*opening, *part.fixed, *closing])
        if left < 0:
            omitted.append(part.title)
            left += _size([*opening, *part.fixed, *closing])
            continue
        kept = []
        for line in part.lines:
            if _size([line]) > left:
                break
            left -= _size([line])
            kept.append(line)
        if len(kept) < len(part.lines):
            omitted.append(f"{part.title} ({len(part.lines) - len(kept)} of {len(part.lines)} lines)")
        out += [*opening, *part.fixed, *kept, *closing]
    if omitted:
        text = f"Left out for its length: {'; '.join(omitted)}. The page made by `plcgen review` has everything."
        out.append(text.encode()[: _TAIL - 1].decode("utf-8", "ignore"))
    return "\n".join(out).rstrip("\n") + "\n"


def _size(lines: Sequence[str]) -> int:
    return sum(len(line.encode()) + 1 for line in lines)


def _parts(review: Review) -> Iterator[_Part]:
    """Every part, the important first."""
    yield _head(review)
    for title, found in review.changes:
        yield _changes(f"Changes: {title}", found, planned=review.planned)
    yield _Part("What is wrong or worth a look", (), [_problem(review, n) for n in range(len(review.problems))])
    if review.lock is not None:
        yield _changes("The layout lock against the sources", review.lock, planned=review.planned)
    yield _writes(review)
    missing = [f"- {escape(check.subject)}: {escape(check.verdict)}" for check in review.not_run]
    yield _Part("Not run, not there", (), [*missing, *(f"- {escape(text)}" for text in review.missing)])
    rests = [(a.subject, a.text, a.grade.value, a.source) for a in review.assumptions]
    table = markdown_table(("about", "what is assumed", "how it is known", "source"), rests)
    yield _Part(f"Rests on {len(rests)} assumptions", table[:2], table[2:], folded=True)
    yield _matrix(review)
    yield _Part("Telegrams", *_telegrams(review), folded=True)
    for pair in review.layouts:
        if pair.before is not None and (pair.changed or pair.after is None):
            yield _layout(pair.before, "before")
            if pair.after is not None:
                yield _layout(pair.after, "after")
    yield _Part("Runs", (), list(_runs(review)), folded=True)
    for pair in review.layouts:
        if pair.after is not None and not pair.changed:
            yield _layout(pair.after, "")
    yield _Part(f"{len(review.sheet.instances)} instances", *_instances(review), folded=True)
    files = markdown_table(("file", "bytes", "SHA-256"), [(f.path, str(f.bytes), f.sha256) for f in review.files])
    yield _Part(f"{len(review.files)} files", files[:2], files[2:], folded=True)


def _head(review: Review) -> _Part:
    mark = ":white_check_mark:" if review.ok else ":x:"
    counts = ", ".join(f"{count} {outcome}" for outcome, count in outcomes(review))
    base = f", compared with {code_span(review.base)}" if review.base else ""
    lines = [
        f"{mark} **{verdict(review)}**: {counts or 'no checks'}{base}",
        "",
        f"- {escape(review.target or 'unknown target')}",
        f"- spec {code_span(review.spec)}{_included(review)}, SHA-256 `{review.spec_hash or 'unknown'}`",
        f"- {len(review.files)} files in {code_span(review.folder)}, over the list `{review.files_hash or 'unknown'}`",
    ]
    if reason := lock_reason(review):
        lines.insert(1, f"\n- {escape(reason)}")
    return _Part(f"Review of {escape(review.project or review.spec)}", lines, ())


def _problem(review: Review, number: int) -> str:
    problem = review.problems[number]
    place = f" ({code_span(str(problem.span))})" if problem.span.file else ""
    return f"- **{problem.severity.label} {problem.code}** {escape(problem.message)}{place}"


def _changes(title: str, found: Comparison, *, planned: bool) -> _Part:
    counts = compared(found, planned=planned)
    rows = [
        (f"{_MARK[c.level.value]} {c.level.value}", subject, c.text[:_CELL], c.kind)
        for subject, changes in found.folded()
        for c in changes
    ]
    table = markdown_table(("class", "where", "what", "id"), rows) if rows else []
    labels = f"{code_span(found.old)} to {code_span(found.new)}: {counts}"
    told = [f"- {_MARK[one.level.value]} **{escape(one.who)}**: {escape(one.text)}" for one in found.sentences]
    return _Part(
        escape(title), [labels, *(["", *told] if told else []), *(["", *table[:2]] if table else [])], table[2:]
    )


def _writes(review: Review) -> _Part:
    rows = []
    for row in write_rows(review):
        partners = row["partners"]
        on = ", ".join(partners) if len(partners) <= 3 else f"{len(partners)}: {partners[0]} .. {partners[-1]}"
        danger = f"; DANGER: {row['danger']}; signed off: {row['signed'] or 'no'}" if row["danger"] else ""
        limits = f"{row['limits']} {row['unit']}".strip()
        doubts = "".join(f"; {doubt}" for doubt in row["doubts"])
        what = f"{row['parameter']} {row['text']}{danger}{doubts}"
        rows.append((row["job"], on, what, row["value"], limits, row["trigger"], row["memory"]))
    header = ("job", "on", "parameter", "value", "limits, unit", "who triggers", "ends up in")
    table = markdown_table(header, rows) if rows else []
    return _Part("Write list", table[:2] or [no_writes(review)], table[2:])


def _instances(review: Review) -> tuple[list[str], list[str]]:
    rows = [(i.job, i.partner, i.address, i.trigger) for i in review.sheet.instances]
    table = markdown_table(("job", "partner", "addressed as", "who triggers"), rows)
    return table[:2], table[2:]


def _matrix(review: Review) -> _Part:
    grid = matrix(review.verification)
    rows = [
        (job, *(f"{cell[0]}: {cell[1]}"[:_CELL] if cell is not None else "-" for cell in cells))
        for job, cells in grid.rows
    ]
    table = markdown_table(("job", *grid.columns), rows) if rows else []
    return _Part("Fault matrix", table[:2], table[2:])


def _telegrams(review: Review) -> tuple[list[str], list[str]]:
    rows = []
    for one in review.sheet.exchanges:
        for message in (one.request, *one.answers):
            text = " ".join("??" if byte is None else f"{byte:02X}" for f in message.fields for byte in f.data)
            which = f"{one.job} {one.number}/{one.count}" if one.count > 1 else one.job
            rows.append((which, message.title, message.home.name, text, f"{message.length} of {message.size}"))
    table = markdown_table(("job", "what", "in", "bytes (?? the partner decides)", "length"), rows)
    return (table[:2], table[2:]) if rows else ([], [])


def _layout(table: BlockTable, which: str) -> _Part:
    rows = [(r.offset, r.address, "  " * r.depth + r.name, r.type, r.size, r.start, r.comment) for r in table.rows]
    lines = markdown_table(("offset", "address", "name", "type", "size", "start value", "meaning"), rows)
    title = f"{escape(table.title)}, {escape(table.summary)}{f' ({which})' if which else ''}"
    return _Part(title, lines[:2], lines[2:], folded=True)


def _runs(review: Review) -> Iterator[str]:
    for run in review.runs:
        for job in run.trace.jobs:
            line = time_line(run.trace, job)
            fault = f" with the fault {code_span(run.fault)}" if run.fault else ""
            yield f"- {code_span(clean(job.key))}{fault}: {escape(line.summary)}"


def _included(review: Review) -> str:
    return f" with {', '.join(map(code_span, review.included))}" if review.included else ""
