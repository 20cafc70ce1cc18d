"""Jobs and drives of two specs: what is sent to whom, byte by byte with the name of every field."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from plcgen.base.diagnostics import Span
from plcgen.base.telegrams.dissection import ByteField
from plcgen.project.registry import protocol
from plcgen.s7.compare.model import Change, DriveState, JobState, Snapshot, TelegramState
from plcgen.s7.compare.policy import Level


def compare_jobs(old: Snapshot, new: Snapshot, policy: Mapping[str, Level]) -> list[Change]:
    """Changes of drives, then of jobs, in the order of the new spec; removed ones last."""
    if old.jobs is None or new.jobs is None:
        return []
    found = _Found(policy)
    for key in [*new.drives, *(key for key in old.drives if key not in new.drives)]:
        found.drive(key, old.drives.get(key), new.drives.get(key))
    for key in [*new.jobs, *(key for key in old.jobs if key not in new.jobs)]:
        found.job(key, old.jobs.get(key), new.jobs.get(key))
    return found.changes


class _Found:
    """Collects changes."""

    def __init__(self, policy: Mapping[str, Level]) -> None:
        self.policy = policy
        self.changes: list[Change] = []

    def add(
        self, kind: str, subject: str, message: str, old: str, new: str, before: Span | None, after: Span | None
    ) -> None:
        """Keep one change."""
        self.changes.append(Change(kind, self.policy[kind], subject, "", message, old, new, before, after))

    def drive(self, key: str, old: DriveState | None, new: DriveState | None) -> None:
        """One drive."""
        state = new or old
        if state is None:
            return
        subject = f"{state.what} {key}"
        if old is None or new is None:
            kind, word = ("drive-added", "added") if old is None else ("drive-removed", "removed")
            settings = ", ".join(f"{name} {value}" for name, value in state.settings)
            spans = (None, state.span) if old is None else (state.span, None)
            self.add(kind, subject, f"{word}: address {_number(state.address)}, {settings}", "", "", *spans)
            return
        if old.address != new.address:
            what = "hardware identifier or address" if new.what == "drive" else "address"
            message = f"{what} {_number(old.address)} -> {_number(new.address)}"
            self.add("drive-address", subject, message, str(old.address), str(new.address), old.span, new.span)
        before, after = dict(old.settings), dict(new.settings)
        for what in dict.fromkeys((*after, *before)):
            was, now = before.get(what, "(none)"), after.get(what, "(none)")
            if was != now:
                self.add("drive-device", subject, f"{what} {was} -> {now}", was, now, old.span, new.span)

    def job(self, key: str, old: JobState | None, new: JobState | None) -> None:
        """One job."""
        subject = f"job {key}"
        if old is None or new is None:
            state = new or old
            if state is not None:
                kind, word = ("job-added", "added") if old is None else ("job-removed", "removed")
                requests = "; ".join(_hex(telegram.request) for telegram in state.telegrams)
                spans = (None, state.span) if old is None else (state.span, None)
                self.add(kind, subject, f"{word}: {requests}", "", "", *spans)
            return
        if old.drive != new.drive:
            message = f"drive {old.drive} -> {new.drive}"
            self.add("job-drive", subject, message, old.drive, new.drive, old.span, new.span)
        self.telegrams(subject, old, new)
        for kind, before, after in (
            ("job-timing", dict(old.timing), dict(new.timing)),
            ("job-trigger", dict(old.trigger), dict(new.trigger)),
        ):
            for name in sorted(before.keys() | after.keys()):
                was, now = before.get(name, ""), after.get(name, "")
                if was != now:
                    message = f"{name} {was or '(symbolic)'} -> {now or '(symbolic)'}"
                    self.add(kind, subject, message, was, now, old.span, new.span)

    def telegrams(self, subject: str, old: JobState, new: JobState) -> None:
        """Requests and the lengths of their answers."""
        if len(old.telegrams) != len(new.telegrams):
            was, now = str(len(old.telegrams)), str(len(new.telegrams))
            self.add("telegram-count", subject, f"{was} -> {now} telegrams", was, now, old.span, new.span)
            return
        several = len(new.telegrams) > 1
        for number, (before, after) in enumerate(zip(old.telegrams, new.telegrams, strict=True), 1):
            which = f"telegram {number}: " if several else ""
            for kind, message, was, now in _telegram(before, after):
                self.add(kind, subject, f"{which}{message}", was, now, old.span, new.span)


def _telegram(old: TelegramState, new: TelegramState) -> Iterator[tuple[str, str, str, str]]:
    if len(old.request) != len(new.request):
        was, now = len(old.request), len(new.request)
        yield (
            "request-length",
            f"request {was} -> {now} bytes{protocol(new.protocol).length_note}",
            str(was),
            str(now),
        )
    before, after = _fields(old), _fields(new)
    for name, field in after.items():
        earlier = before.get(name)
        if earlier is None:
            yield "telegram-field", f"byte {field.offset}: {name} {_value(field)} is new", "", _value(field)
        elif (earlier.value, earlier.note) != (field.value, field.note):
            message = f"byte {field.offset}: {name} {_value(earlier)} -> {_value(field)}"
            yield _kind(name), message, earlier.value, field.value
    for name, earlier in before.items():
        if name not in after:
            yield "telegram-field", f"byte {earlier.offset}: {name} {_value(earlier)} is gone", _value(earlier), ""
    for what, was, now in (
        ("positive answer", old.positive, new.positive),
        ("negative answer", old.negative, new.negative),
        ("response buffer", old.buffer, new.buffer),
    ):
        if was != now:
            yield "response-length", f"{what} {was} -> {now} bytes", str(was), str(now)


def _fields(telegram: TelegramState) -> dict[str, ByteField]:
    """Fields of a request by name, without those that follow from the others."""
    return {field.name: field for field in protocol(telegram.protocol).request_fields(telegram.request)}


def _kind(name: str) -> str:
    if name == "request reference":
        return "telegram-reference"
    words = name.split()
    is_value = "value" in words and "values" not in words and words[-1] not in {"code", "length", "reserved"}
    return "telegram-value" if is_value else "telegram-field"


def _value(field: ByteField) -> str:
    return f"{field.value} ({field.note})" if field.note and field.note != field.value else field.value


def _hex(data: bytes) -> str:
    text = data.hex(" ").upper()
    return text if len(text) <= 48 else f"{text[:44]} .."


def _number(value: int) -> str:
    return f"{value} (16#{value:04X})"
