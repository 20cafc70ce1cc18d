"""What guards a spec and what a panel takes of it: the layout lock beside it, text lists."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from plcgen.base.diagnostics import DiagnosticError
from plcgen.build.text_lists import WRITERS
from plcgen.ds47.hmi.lists import LANGUAGES, text_lists
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.wire.errors import Table
from plcgen.report.diff.lock import DEFAULT
from plcgen.report.diff.lockfile import read_lock, reduced
from plcgen.report.diff.planned import spec_snapshot
from plcgen.report.diff.run import compare_snapshots
from plcgen.report.review.page import comparison_view
from plcgen.s7.compare.policy import load_policy
from plcgen.workbench.serve.becomes import FIRST_TIME, Made
from plcgen.workbench.serve.proving import Typed
from plcgen.workbench.serve.room import Room, wrong
from plcgen.workbench.serve.spec import problem_data


def lock_of(spec: Path) -> Path:
    """The layout lock of a spec: that of its folder, unless that is of something else; then one of its own."""
    shared = spec.parent / DEFAULT
    if shared.is_file():
        try:
            named = read_lock(shared).sources
        except DiagnosticError:
            return shared  # what is wrong with it is said when it is compared
        if list(named) != [spec.name]:
            return spec.with_name(f"{spec.stem}.lock.json")
    return shared


def compared(typed: Typed, room: Room) -> dict[str, Any]:
    """The lock against what the text makes now; without a lock, that there is none."""
    path = lock_of(typed.path)
    name = room.shown(path.as_posix())
    if not path.is_file():
        return {"lock": name, "there": False, "changes": None, "problems": []}
    try:
        state = reduced(spec_snapshot(typed.path, typed.read))
        found = compare_snapshots(read_lock(path).snapshot, state, load_policy(()))
    except DiagnosticError as problem:
        problems = [problem_data(one, room.shown) for one in problem.diagnostics]
        return {"lock": name, "there": True, "changes": None, "problems": problems}
    return {
        "lock": name,
        "there": True,
        "changes": comparison_view("", found, planned=True),
        "problems": [problem_data(one, room.shown) for one in found.diagnostics],
    }


def text_archive(made: Made, languages: Sequence[str], formats: Iterable[str]) -> bytes:
    """Text lists of status words, errors and messages of the drives of a spec. Raises DiagnosticError."""
    plan = made.project.plan(DrivePlan)
    if plan is None:
        raise wrong(made.project.name, "text lists are of drive jobs: the spec has none")
    unknown = next((tag for tag in languages if tag[:2].lower() not in LANGUAGES), None)
    if unknown is not None or not languages:
        raise wrong(made.project.name, f'there are no texts in "{unknown or ""}"', "en-US, de-DE, zh-CN or the like")
    devices = [unit.device for unit in plan.units]
    families = tuple(dict.fromkeys(family for device in devices for family in device.messages))
    table: Table = "profidrive" if any(device.error_table == "profidrive" for device in devices) else "sinamics"
    lists = text_lists(languages, table, families)
    version = made.project.target.xml_version or "V19"
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for format_ in dict.fromkeys(formats):
            for file in WRITERS[format_](lists, languages, version):
                archive.writestr(zipfile.ZipInfo(file.path, FIRST_TIME), file.data, zipfile.ZIP_DEFLATED)
    return target.getvalue()
