"""Files on which programs are run and verified, and what verification found, for the page."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

from plcgen import api
from plcgen.api import default_folder
from plcgen.base.display.view import PLAIN
from plcgen.build.writing import write_folder
from plcgen.project.opening import open_spec
from plcgen.proof.checks import Outcome, Verification
from plcgen.proof.data import verification_data
from plcgen.proof.effort import Faults
from plcgen.proof.replay import replay
from plcgen.report.registry import output_format
from plcgen.workbench.serve.becomes import Made
from plcgen.workbench.serve.working import Progress

Origin = Literal["made", "disk"]


def folder_of(spec: Path, origin: Origin, made: Callable[[], Made], bench: Path) -> Path:
    """The folder on disk, or one on the bench with the files as they are made now. Raises DiagnosticError."""
    if origin == "disk":
        return default_folder(spec)
    target = bench / default_folder(spec).name
    write_folder(made().files.values(), target, force=True)
    return target


def verified(spec: Path, folder: Path, faults: Faults, progress: Progress) -> dict[str, Any]:
    """Verify, and name the scenarios of each check that failed."""
    found: Verification = api.verify(spec, folder, faults=faults, progress=progress)
    data = verification_data(found)
    for group, shown in zip(found.groups, data["groups"], strict=True):
        for check, row in zip(group.checks, shown["checks"], strict=True):
            row["failed"] = [trial.scenario for trial in check.trials if not trial.ok]
            row["runs"] = check.outcome is Outcome.ERROR and check.id.partition(".")[0] in {"run", "faults"}
            row["tried"] = len(check.trials)
    return data


def replayed(spec: Path, folder: Path, check: str, scenario: str) -> dict[str, Any] | None:
    """The calls of a scenario that failed."""
    found = replay(open_spec(spec).sound(), folder, check, scenario)
    if found is None:
        return None
    failure = found.failure
    return {
        "scenario": found.scenario,
        "failure": None
        if failure is None
        else {"text": failure.message, "scan": failure.scan, "file": Path(failure.file).name, "line": failure.line},
        "calls": [
            [one.scan, one.time, one.execute, one.busy, one.done, one.error, f"{one.status:04X}"] for one in found.calls
        ],
        "exchanges": [
            {"scan": one.scan, "direction": direction, "hex": data.hex(" ").upper()}
            for one in found.calls
            for direction, data in one.exchanged
        ],
    }


def reviewed(spec: Path, folder: Path, base: str, progress: Progress) -> dict[str, Any]:
    """The page of a review. Raises DiagnosticError if there is nothing to compare with under that name."""
    found = api.review(spec, folder, against=base, progress=progress)
    format_ = output_format("html")
    assert format_ is not None  # noqa: S101 - it is shipped
    page = format_.render("review", found, PLAIN)
    for private in (folder.parent, spec.parent):  # the page is handed on
        page = page.replace(f"{private.as_posix()}/", "")
    return {"page": page, "ok": found.ok, "name": f"{spec.stem}_review.html"}
