"""What the tab of the spec asks: problems, completion, hover, form; plain data, places as editors count them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict
from typing import Any

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.ds47.registry import kinds as known_kinds
from plcgen.workbench.serve.proving import on_the_page
from plcgen.workbench.serve.room import Room
from plcgen.workbench.service.documents import Document as Opened
from plcgen.workbench.service.positions import from_units, to_units
from plcgen.workbench.service.results import Edit, Finding
from plcgen.workbench.service.specs.drives import drives_at, known_drive
from plcgen.workbench.service.specs.jobs import job_offers
from plcgen.workbench.service.specs.search import search as searched
from plcgen.workbench.service.specs.state import SpecState


def problem_data(diagnostic: Diagnostic, rename: Callable[[str], str] = str) -> dict[str, Any]:
    """A diagnostic without a place in an editor."""
    return {
        "code": diagnostic.code,
        "severity": diagnostic.severity.label,
        "message": diagnostic.message,
        "help": on_the_page(diagnostic.help),
        "file": "" if diagnostic.span.file.startswith("--") else rename(diagnostic.span.file),  # an option: no file
        "line": diagnostic.span.line,
        "column": diagnostic.span.column,
    }


def place(lines: Sequence[str], span: Span) -> list[int]:
    """Line and character of both ends, from 0, in UTF-16 units."""
    first = to_units(lines, span.line, span.column)
    last = to_units(lines, span.end_line or span.line, span.end_column or span.column + 1)
    return [*first, *last]


def findings(room: Room, document: Opened, found: Iterable[Finding]) -> list[dict[str, Any]]:
    """Problems with their places in the text, those of other files at its beginning."""
    return [
        {
            **problem_data(one.diagnostic, room.shown),
            "here": one.diagnostic.span.file == document.file,
            "place": place(
                document.lines, one.diagnostic.span if one.diagnostic.span.file == document.file else Span("")
            ),
            "reason": one.reason,
            "remedy": on_the_page(one.remedy),
            "fixes": [{"title": fix.title, "edits": edits(document, fix.edits)} for fix in one.fixes],
        }
        for one in sorted(found, key=lambda one: (-one.diagnostic.severity, one.diagnostic.sort_key))
    ]


def edits(document: Opened, found: Iterable[Edit]) -> list[dict[str, Any]]:
    """Edits of this text; a fix that would need another file is none here."""
    return [
        {"place": place(document.lines, edit.span), "text": edit.text}
        for edit in found
        if edit.span.file == document.file
    ]


def caret(document: Opened, line: int, character: int) -> tuple[int, int]:
    """A place of an editor as line and column."""
    return from_units(document.lines, line, character)


def outline(state: SpecState) -> dict[str, Any]:
    """What the form shows: drives and jobs as the text has them, and whether jobs can be added here."""
    drives = []
    for path, key in (*state.names("drives"), *state.names("units", "*", "drives")):
        known = known_drive(state, key)
        drives.append(
            {
                "key": key,
                "device": known.device.key if known else "",
                "title": known.device.title if known else "",
                **_entry(state, path),
            }
        )
    jobs = [{"key": key, "drives": _of(state, path), **_entry(state, path)} for path, key in state.names("jobs")]
    stations = [
        {"key": key, "line": str(path[1]), **_entry(state, path)} for path, key in state.names("ppi", "*", "stations")
    ]
    jobs += [{"key": key, "drives": [], **_entry(state, path)} for path, key in state.names("ppi", "*", "jobs")]
    project = state.project
    return {
        "drives": drives,
        "jobs": jobs,
        "stations": stations,
        "lines": [key for _, key in state.names("ppi")],
        "recipes": [key for _, key in state.names("recipes")],
        "next_address": _next_address(state),
        "family": project.target.family if project is not None else "",
    }


def _next_address(state: SpecState) -> str:
    """One more than the greatest address of a drive, as a proposal; empty if no drive has one as a number."""
    places = (
        one for one in state.sketch.entries if "drives" in one.path and one.path[-1] in {"hardware_id", "address"}
    )
    numbers = [int(one.value) for one in places if one.value.isdecimal() and len(one.value) <= _DIGITS]
    return str(max(numbers) + 1) if numbers else ""


def _entry(state: SpecState, path: Sequence[str | int]) -> dict[str, Any]:
    """The keys to an entry, where its key stands (None in another file); what a job does, with what, how often.

    ``repeats`` is whether it may have a cycle.
    """
    found = state.sketch.get(*path)
    parameters = [
        {"label": _label(state, one.path), "path": list(one.path)}
        for one in state.sketch.entries
        if len(one.path) == len(path) + 2 and one.path[:-2] == tuple(path) and one.path[-2] in _HOLD
    ]
    does = [str(one.path[-1]) for one in state.sketch.below(tuple(path)) if one.path[-1] in _KINDS]
    return {
        "path": list(path),
        "place": None if found is None else place(state.document.lines, found.key)[:2],
        "parameters": parameters,
        "does": does,
        "cycle": state.sketch.value(*path, "cycle"),
        "repeats": path[0] == "ppi" or all(_KINDS[key].repeatable for key in does),
    }


_KINDS = {one.key: one for one in known_kinds()}
_DIGITS = 5
_HOLD = ("read", "write", "compare")


def _label(state: SpecState, path: Sequence[str | int]) -> str:
    """A parameter as the text names it: by its key, as an item, or in an item with more keys."""
    last = path[-1]
    if isinstance(last, str):
        return last
    return state.sketch.value(*path) or state.sketch.value(*path, "parameter") or str(last + 1)


def _of(state: SpecState, path: Sequence[str | int]) -> list[str]:
    return [one.key for one in drives_at(state, tuple(path))]


def search(state: SpecState, job: str, words: str) -> dict[str, Any]:
    """Parameters and messages of the drives of a job or recipe (``jobs/ramps``), or of all drives without one."""
    place = job.split("/") if "/" in job or not job else ["jobs", job]
    return asdict(searched(state, [part for part in place if part], words))


def kinds(state: SpecState, partner: str) -> list[dict[str, Any]]:
    """The kinds of jobs of a drive, or of a station as ``line/station``, with the reason of those that it lacks."""
    return [asdict(one) for one in job_offers(state, partner)]
