"""A recorded run as text: one row per job and scan in which something changed, telegrams and values below it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from plcgen.base.diagnostics.counting import quantity
from plcgen.base.display.cells import clean, cut, pad, wrap
from plcgen.base.display.cells import width as columns
from plcgen.base.display.excerpts import diagnostics_text
from plcgen.base.display.view import PLAIN, View
from plcgen.report.trace.spelling import value_text

if TYPE_CHECKING:
    from plcgen.report.trace.model import BlockCall, Contact, JobResult, Signal, Step, Trace, Value

_RIGHT = frozenset({0, 1})
_GAP = 2
_INDENT = 6
_BYTES = 32


@dataclass(slots=True)
class _Row:
    """Cells of one row; ``style`` paints the last one; ``details`` stand below."""

    cells: tuple[str, ...]
    style: str = ""
    details: list[tuple[str, str, str]] = field(default_factory=list)


def trace_text(trace: Trace, view: View) -> str:
    """The whole report: what ran, the scans, misuse and problems, how every job ended, the summary."""
    if not trace.scans:
        return diagnostics_text(trace.diagnostics, view)
    head = ", ".join(clean(text) for text in (trace.project, trace.target) if text)
    what = f'OB "{clean(trace.main)}" every {trace.scan_time} ms'
    out = [f"{head}: {clean(trace.folder)}", what, "", *_scans(trace, view), ""]
    if trace.diagnostics:
        out.append(diagnostics_text(trace.diagnostics, view))
    for job in trace.jobs:
        out += [*_job(job, trace.words[0], view), ""]
    return "\n".join([*out, run_summary(trace, view)]) + "\n"


def run_summary(trace: Trace, view: View = PLAIN) -> str:
    """``2 jobs: 1 done, 1 error; 35 scans, 350 ms``."""
    parts = []
    for ending, style in (("done", "ok"), ("error", "error"), ("running", "warning"), ("not started", "warning")):
        count = sum(job.ending == ending for job in trace.jobs)
        if count:
            parts.append(view.paint(f"{count} {ending}", style))
    jobs = f"{quantity(len(trace.jobs), 'job')}: {', '.join(parts)}" if parts else "no job"
    why = {"stop": ", then the CPU went to STOP", "scans": ", then the run was ended"}.get(trace.ended, "")
    return f"{jobs}; {quantity(trace.scans, 'scan')}, {trace.time} ms{why}"


class _Table:
    """Rows of a trace; what a row says is the state after its scan."""

    def __init__(self, trace: Trace) -> None:
        self.trace = trace
        self.position = {signal.id: n for n, signal in enumerate(trace.signals)}
        self.partners = {job.key: job.partner for job in trace.jobs}
        self.owners = [
            (n, signal.names) for n, signal in enumerate(trace.signals) if signal.name == "owner" and 0 in signal.names
        ]
        self.told: set[str] = set()
        self.telegrams = self._telegrams()
        self.order = {signal.group: n for n, signal in reversed(list(enumerate(trace.signals)))}

    def _telegrams(self) -> dict[str, int]:
        """Highest telegram number of every job."""
        jobs = {self.position.get(f"{key}.telegram", -1): key for key in self.partners}
        found: dict[str, int] = {}
        for step in self.trace.steps:
            for n, value in step.changes:
                if n in jobs and isinstance(value, int):
                    found[jobs[n]] = max(value, found.get(jobs[n], 0))
        return found

    def rows(self) -> Iterator[_Row]:
        """All rows in order."""
        for step, values in self.trace.values():
            first = True
            for group in self._groups(step):
                yield self._row(step, values, group, first=first)
                first = False

    def _groups(self, step: Step) -> list[str]:
        """Jobs and instances that have something to tell about a step, in the order of the signals."""
        found: dict[str, None] = {}
        for n, value in step.changes:
            signal = self.trace.signals[n]
            if signal.group in self.partners or signal.listed or "." in signal.name:
                found[signal.group] = None
            found |= dict.fromkeys(_name(names, value) for at, names in self.owners if at == n)
        found |= dict.fromkeys(contact.group for contact in step.contacts)
        found.pop("", None)
        return sorted(found, key=lambda group: self.order.get(group, len(self.order)))

    def _row(self, step: Step, values: list[Value], group: str, *, first: bool) -> _Row:
        calls = [call for call in step.calls if call.group == group and not call.idle]
        status, style = self._status(values, group)
        owned = any(_name(names, values[at]) == group for at, names in self.owners)
        cells = (
            str(step.scan) if first else "",
            str(step.time) if first else "",
            clean(group),
            self._state(values, group),
            ", ".join(map(call_text, calls)),
            self.partners.get(group, "") if owned else "",
            status,
        )
        return _Row(cells, style, [*self._contacts(step, group), *self._values(step, group)])

    def _get(self, values: list[Value], group: str, name: str) -> Value | None:
        at = self.position.get(f"{group}.{name}")
        return None if at is None else values[at]

    def _state(self, values: list[Value], group: str) -> str:
        at = self.position.get(f"{group}.state")
        if at is None:
            return ""
        number = values[at]
        text = self.trace.signals[at].names.get(number, str(number)) if isinstance(number, int) else ""
        telegram, retries = self._get(values, group, "telegram"), self._get(values, group, "retries")
        if self.telegrams.get(group, 0) > 1 and text not in {"IDLE", "WAITING"}:
            text += f" {telegram}/{self.telegrams[group]}"
        return f"{text} retry {retries}" if text.startswith("PAUSE") else text

    def _status(self, values: list[Value], group: str) -> tuple[str, str]:
        status = self._get(values, group, "status")
        if not isinstance(status, int):
            return "", ""
        flags = [name for name in ("busy", "done", "error") if self._get(values, group, name)]
        style = {"done": "ok", "error": "error"}.get(flags[-1] if flags else "", "")
        return f"{' '.join(flags) or 'idle'} {status:04X}", style

    def _contacts(self, step: Step, group: str) -> Iterator[tuple[str, str, str]]:
        for contact in step.contacts:
            if contact.group != group:
                continue
            text = contact.text
            if not contact.status:
                yield _telegram(contact), text, "dim"
            elif text not in self.told:
                self.told.add(text)
                yield text, "", "error"

    def _values(self, step: Step, group: str) -> Iterator[tuple[str, str, str]]:
        for n, value in step.changes:
            signal = self.trace.signals[n]
            if signal.group == group and signal.listed:
                yield f"{signal.name} = {signal_text(signal, value)}", "", ""


def _name(names: Mapping[int, str], value: Value) -> str:
    """What a number means; empty if it means nothing."""
    return names.get(value, "") if isinstance(value, int) else ""


def signal_text(signal: Signal, value: Value) -> str:
    """Value of a signal with its unit; words are hexadecimal."""
    text = value_text(value, bits=signal.bits if signal.kind == "word" else 0)
    return f"{text} {signal.unit}" if signal.unit else text


def call_text(call: BlockCall) -> str:
    """``WRREC REQ BUSY 7001``, ``RDREC VALID 10 B``, ``RDREC ERROR DE80B500``."""
    if call.error:
        return f"{call.block} {'REQ ' if call.request else ''}ERROR {call.status:0{call.shape.bits // 4}X}"
    if call.finished:
        return f"{call.block} {call.shape.success}{f' {call.length} B' if call.shape.answers else ''}"
    busy = " BUSY" if call.busy else ""
    running = call.status >> 8 & 0xFFFF if call.shape.bits == 32 else call.status
    return f"{call.block}{' REQ' if call.request else ''}{busy}{f' {running:04X}' if running else ''}"


def _telegram(contact: Contact) -> str:
    """Direction, partner and bytes; the rest of a long telegram says nothing to people."""
    more = f" .. {len(contact.data)} bytes" if len(contact.data) > _BYTES else ""
    arrow = "->" if contact.direction == "write" else "<-"
    return f"{arrow} {contact.partner or 'partner'}: {contact.data[:_BYTES].hex(' ').upper()}{more}"


def _scans(trace: Trace, view: View) -> list[str]:
    """Header and rows, as wide as their contents; what does not fit is left out from the least needed on."""
    call, partner = trace.words
    names = ("scan", "ms", "job", "state", call, partner, "job status")
    rows = list(_Table(trace).rows())
    shown = [n for n in range(len(names)) if n < 2 or any(row.cells[n] for row in rows)]
    widths = [max([columns(names[n]), *(columns(row.cells[n]) for row in rows)]) for n in range(len(names))]
    for spare in (5, 2):
        if _total(widths, shown) <= view.columns or spare not in shown:
            continue
        if spare == 5 or len(trace.jobs) <= 1:
            shown.remove(spare)
        else:
            widths[spare] = max(8, widths[spare] - (_total(widths, shown) - view.columns))
    header = _line(names, shown, widths, "", PLAIN)
    out = [view.paint(header, "dim")]
    for row in rows:
        if not any(row.cells[3:]):
            out += _plain(row, widths, view.columns)
            continue
        out.append(_line(row.cells, shown, widths, row.style, view))
        for first, text, style in row.details:
            out += _detail(first, text, style, view)
    return out


def _plain(row: _Row, widths: Sequence[int], width: int) -> list[str]:
    """Rows of members that belong to no job: one line each."""
    out = []
    cells = row.cells[:2]
    for first, text, _ in row.details:
        head = _line((*cells, ""), range(2), widths, "", PLAIN)
        margin = widths[0] + widths[1] + 2 * _GAP
        lines = wrap(" ".join(filter(None, (clean(first), clean(text)))), width - margin)
        out += [f"{pad(head if not n else '', margin)}{line}" for n, line in enumerate(lines)]
        cells = ("", "")
    return out


def _total(widths: Sequence[int], shown: Sequence[int]) -> int:
    return sum(widths[n] for n in shown) + _GAP * (len(shown) - 1)


def _line(cells: Sequence[str], shown: Sequence[int], widths: Sequence[int], style: str, view: View) -> str:
    parts = []
    for n in shown:
        text = cut(cells[n], widths[n])
        filled = " " * (widths[n] - columns(text)) + text if n in _RIGHT else pad(text, widths[n])
        parts.append(view.paint(filled, style if n == shown[-1] else ""))
    return (" " * _GAP).join(parts).rstrip()


def _detail(first: str, text: str, style: str, view: View) -> list[str]:
    """Bytes and their meaning side by side if they fit, else below each other."""
    room = view.columns - _INDENT
    if text and columns(first) + 3 + columns(text) <= room:
        return [f"{' ' * _INDENT}{clean(first)}   {view.paint(clean(text), style)}"]
    arrow = 3 if first[:2] in {"->", "<-"} else 0
    out = [" " * (_INDENT + arrow * bool(n)) + line for n, line in enumerate(wrap(clean(first), room - arrow))]
    if not text:
        return [view.paint(line, style) for line in out]
    more = wrap(clean(text), room - arrow)
    return [*out, *(" " * (_INDENT + arrow) + view.paint(line, style) for line in more)]


def _job(job: JobResult, call: str, view: View) -> list[str]:
    """How a job ended, and its values."""
    style = {"done": "ok", "error": "error"}.get(job.ending, "warning")
    retries = quantity(job.retries, "retry", "retries") if job.retries else "no retry"
    figures = f"{quantity(job.scan, 'scan')}, {job.time} ms, {quantity(job.telegrams, 'telegram')}, {retries}"
    status = f"{job.ending} {job.status:04X} {job.text}" if job.ending in {"done", "error"} else job.ending
    out = [f"{view.paint(clean(job.key), 'bold')}: {view.paint(status, style)}"]
    if job.ending == "not started":
        return out
    out.append(f"  {figures}")
    if job.ending == "error" and job.record_text:
        text = f"last {call} {job.record_status:08X}: {job.record_text}"
        out += [f"  {line}" for line in wrap(text, view.columns - 2)]
    label = max((columns(value.label) for value in job.values), default=0)
    member = max((columns(value.member) for value in job.values), default=0)
    for value in job.values:
        head = f"  {pad(value.label, label)}  {pad(value.member, member)} "
        if value.error is not None:
            text, style = f"error {value.problem}", "error"
        elif value.value is not None:
            text, style = f"= {value_text(value.value)}{f' {value.unit}' if value.unit else ''}", ""
            text += f": {value.meaning}" if value.meaning else ""
        else:
            continue
        first, *more = wrap(clean(text), max(view.columns - columns(head), _INDENT * 4))
        out.append(head + view.paint(first, style))
        out += [" " * columns(head) + view.paint(line, style) for line in more]
    return out
