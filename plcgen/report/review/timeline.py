"""A recorded run of one job as a time line: lanes of signals over scans, in pixels; idle stretches are shortened."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from plcgen.base.diagnostics.counting import quantity
from plcgen.base.display.cells import clean
from plcgen.report.trace.model import JobResult, Signal, Trace, Value
from plcgen.report.trace.spelling import value_text

_GUTTER, _LANE, _HEAD = 74, 22, 20
_WIDE, _BROAD, _LEAST = 1040, 40, 9
_MARGIN = 12
_GAP = 6
"""So many scans in which nothing happens are drawn as they are; longer stretches as this many, with a mark."""
MAX_STEPS = 300
_CHARACTER = 6.7
_MAX_SENT = 40
_LANES = ("execute", "busy", "done", "error")
_SUCCESS = ("DONE", "VALID", "NDR")


@dataclass(frozen=True, slots=True)
class Bar:
    """A stretch of a lane; the text stands in it, upwards if it is ``turned``."""

    x: float
    y: int
    width: float
    height: int
    style: str
    text: str = ""
    turned: bool = False
    title: str = ""


@dataclass(frozen=True, slots=True)
class TimeLine:
    """The picture of one run: names of lanes end at ``edge``; bars, ticks (x, text), marks of shortened stretches."""

    width: int
    height: int
    edge: int
    lanes: tuple[tuple[int, str], ...]
    bars: tuple[Bar, ...]
    ticks: tuple[tuple[float, str], ...]
    breaks: tuple[float, ...]
    summary: str
    partner: str
    events: tuple[tuple[int, int, str, str], ...]
    values: tuple[str, ...]
    ok: bool
    cut: bool


class _Axis:
    """Scans to pixels; a scan is the room to the right of its own number."""

    def __init__(self, scans: list[int], last: int, gutter: int) -> None:
        self._gutter = gutter
        self._places: dict[int, int] = {}
        self.breaks: list[int] = []
        place, before = 0, 0
        for scan in [*scans, last + 1]:
            distance = scan - before
            if distance > _GAP + 2:
                self.breaks.append(place + _GAP // 2)
                distance = _GAP
            place += distance
            self._places[scan] = place
            before = scan
        self.unit = min(_BROAD, max(_LEAST, (_WIDE - gutter) / max(place, 1)))
        self.units = place

    def x(self, scan: int) -> float:
        """Left edge of a scan at which something changes; of any other, of the gutter."""
        return self.at(self._places.get(scan, 1))

    def at(self, place: float) -> float:
        """Pixel of a place on the axis."""
        return self._gutter + (place - 1) * self.unit

    @property
    def ticks(self) -> Iterator[tuple[float, str]]:
        """Numbers of scans that have room."""
        edge = -1.0
        for scan, place in self._places.items():
            x = self.at(place)
            if x >= edge:
                yield x, str(scan)
                edge = x + _CHARACTER * len(str(scan)) + 8


def time_line(trace: Trace, job: JobResult) -> TimeLine:
    """Draw what one job of a run did."""
    steps = trace.steps[:MAX_STEPS]
    cut = len(trace.steps) > MAX_STEPS
    last = steps[-1].scan if cut and steps else trace.scans
    story = _Story(trace, job.key, len(steps), last)
    gutter = max([_GUTTER, *(int(_CHARACTER * len(block)) + _MARGIN for block in story.blocks())])
    axis = _Axis([step.scan for step in steps], last, gutter)
    bars: list[Bar] = []
    lanes: list[tuple[int, str]] = []
    y = _HEAD
    for name in _LANES:
        bars += _bools(axis, story.lane(name), y, name)
        lanes.append((y + 15, name))
        y += _LANE
    signal = story.signal("state")
    high = int(_CHARACTER * max([4, *(len(name) for name in signal.names.values())] if signal else [4])) + _MARGIN
    bars += _states(axis, story, y, high)
    lanes.append((y + high // 2 + 4, "state"))
    y += high + 4
    for block in story.blocks():
        bars += _bools(axis, story.lane(f"{block}.BUSY"), y, "call", "BUSY")
        for finished in _SUCCESS:
            bars += _bools(axis, story.lane(f"{block}.{finished}"), y, "good", finished)
        bars += _bools(axis, story.lane(f"{block}.ERROR"), y, "bad", "ERROR")
        lanes.append((y + 15, block))
        y += _LANE
    return TimeLine(
        width=int(gutter + axis.units * axis.unit + 4),
        height=y + 4,
        edge=gutter - 8,
        lanes=tuple(lanes),
        bars=tuple(bars),
        ticks=tuple(axis.ticks),
        breaks=tuple(axis.at(place) for place in axis.breaks),
        summary=_summary(trace, job),
        partner=trace.words[1],
        events=tuple(_events(trace, job)),
        values=tuple(_values(job)),
        ok=job.ending == "done",
        cut=cut,
    )


class _Story:
    """Values of a job's signals over the scans that are drawn."""

    def __init__(self, trace: Trace, job: str, steps: int, last: int) -> None:
        self.last = last
        self._places: Mapping[str, int] = {s.id: n for n, s in enumerate(trace.signals) if s.group == job}
        self._trace, self._job, self._steps = trace, job, steps

    def signal(self, name: str) -> Signal | None:
        """The signal of that name."""
        place = self._places.get(f"{self._job}.{name}")
        return None if place is None else self._trace.signals[place]

    def blocks(self) -> Iterator[str]:
        """The system blocks that the job calls, in the order in which they came up."""
        names = (name.removeprefix(f"{self._job}.") for name in self._places)
        yield from (name.removesuffix(".BUSY") for name in names if name.endswith(".BUSY"))

    def lane(self, name: str) -> list[tuple[int, int, Value]]:
        """Stretches as (first scan, first scan behind it, value), in order."""
        place = self._places.get(f"{self._job}.{name}")
        if place is None:
            return []
        found: list[tuple[int, int, Value]] = []
        begin, now = 1, self._trace.start[place]
        for step in self._trace.steps[: self._steps]:
            for changed, value in step.changes:
                if changed == place and value != now:
                    if step.scan > begin:
                        found.append((begin, step.scan, now))
                    begin, now = step.scan, value
        return [*found, (begin, self.last + 1, now)]


def _bools(axis: _Axis, lane: list[tuple[int, int, Value]], y: int, style: str, text: str = "") -> Iterator[Bar]:
    for begin, end, value in lane:
        if value is True:
            x = axis.x(begin)
            wide = axis.x(end) - x
            shown = text if _CHARACTER * len(text) + 4 <= wide else ""
            title = f"{text or style} from scan {begin} to {end - 1}"
            yield Bar(x, y + 3, wide, _LANE - 6, f"l-{style}", shown, title=title)


def _states(axis: _Axis, story: _Story, y: int, high: int) -> Iterator[Bar]:
    signal = story.signal("state")
    names: Mapping[int, str] = signal.names if signal is not None else {}
    for begin, end, value in story.lane("state"):
        name = names.get(value, str(value)) if isinstance(value, int) else str(value)
        x = axis.x(begin)
        wide = axis.x(end) - x
        if wide <= 0:
            continue
        turned = _CHARACTER * len(name) + 4 > wide
        style = "l-idle" if value == 0 else "l-state"
        yield Bar(x, y + 2, wide, high - 4, style, name, turned, f"{name} from scan {begin} to {end - 1}")


def _summary(trace: Trace, job: JobResult) -> str:
    parts = [f"{job.ending} 16#{job.status:04X}: {job.text}", f"{quantity(job.scan, 'scan')}, {job.time} ms"]
    parts.append(quantity(job.telegrams, "telegram"))
    if job.retries:
        parts.append(quantity(job.retries, "retry", "retries"))
    if trace.ended == "stop":
        parts.append("then the CPU went to STOP")
    return clean("; ".join(parts))


def _events(trace: Trace, job: JobResult) -> Iterator[tuple[int, int, str, str]]:
    """Scan, ms, bytes and meaning of what went over the wire."""
    shown = 0
    for step in trace.steps:
        for contact in step.contacts:
            if contact.group == job.key and shown < _MAX_SENT:
                shown += 1
                arrow = "\N{RIGHTWARDS ARROW}" if contact.direction == "write" else "\N{LEFTWARDS ARROW}"
                data = f"STATUS {contact.status:08X}" if contact.status else contact.data.hex(" ").upper()
                yield step.scan, step.time, f"{arrow} {data}", clean(contact.text)


def _values(job: JobResult) -> Iterator[str]:
    for value in job.values:
        if value.error is not None:
            yield clean(f"{value.label}: error {value.error:02X}h")
        elif value.value is not None:
            name = f"{value.label} {value.title}".rstrip()
            meaning = f" ({value.meaning})" if value.meaning else ""
            yield clean(f"{name}: {value_text(value.value)} {value.unit}".rstrip() + meaning)
