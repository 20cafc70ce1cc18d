"""Files on which programs are run and verified, and what verification found, for the page."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal, NamedTuple

from plcgen.api import default_folder
from plcgen.base.display.view import PLAIN
from plcgen.build.writing import write_folder
from plcgen.project.composing import from_disk
from plcgen.project.opening import open_spec
from plcgen.proof import Asked, verify
from plcgen.proof.checks import Outcome
from plcgen.proof.data import verification_data
from plcgen.proof.effort import Faults
from plcgen.proof.replay import replay
from plcgen.report.registry import shipped_format
from plcgen.report.review.collect import collect
from plcgen.report.review.model import ReviewRequest
from plcgen.workbench.serve.becomes import Made
from plcgen.workbench.serve.working import Progress

_WITHOUT_WIRESHARK = (
    re.compile(r"only with --oracle tshark"), "Wireshark decodes telegrams from the command line only",
)  # fmt: skip
_ON_THE_PAGE = (
    (re.compile(r"generate again with --force"), "overwrite it with Write files"),
    (re.compile(r"run plcgen generate( once more| first)?"), "write the files: button Write files"),
    _WITHOUT_WIRESHARK,
    (re.compile(r", choose another --out, or overwrite with --force|, or choose another --out"), ""),
    (re.compile(r"plcgen catalogue show WORD --device \S+ searches"), "the form beside the text searches"),
    (re.compile("`plcgen layout`"), "**Panel**"),
    (re.compile(r"compare this place with docs/\S+\.md(; )?|docs/\S+\.md says .*"), ""),
)
"""Commands and options of the command line, and what does the same here."""
Origin = Literal["made", "disk"]


def folder_of(spec: Path, origin: Origin, made: Callable[[], Made], bench: Path) -> Path:
    """The folder on disk, or one on the bench with the files as they are made now. Raises DiagnosticError."""
    if origin == "disk":
        return default_folder(spec)
    target = bench / default_folder(spec).name
    write_folder(made().files.values(), target, force=True)
    return target


class Typed(NamedTuple):
    """A spec as the editor has it, saved or not; what it includes is read from disk."""

    path: Path
    text: str

    def read(self, path: Path, file: str) -> str:
        """Text of a file of the spec. Raises DiagnosticError."""
        return self.text if path == self.path else from_disk(path, file)


def on_the_page(text: str) -> str:
    """A remedy with the buttons of the page in place of commands."""
    for command, button in _ON_THE_PAGE:
        text = command.sub(button, text)
    return text


def verified(spec: Typed, folder: Path, faults: Faults, progress: Progress) -> dict[str, Any]:
    """Verify, and name the scenarios of each check that failed."""
    found = verify(Asked(spec.path, folder, faults=faults, read=spec.read), progress)
    data = verification_data(found)
    data["stale"] = any(one.code == "PG504" for one in found.problems)
    data["diagnostics"] = [{**one, "help": on_the_page(one["help"])} for one in data["diagnostics"]]
    for group, shown in zip(found.groups, data["groups"], strict=True):
        for check, row in zip(group.checks, shown["checks"], strict=True):
            row["verdict"] = on_the_page(row["verdict"])
            if row["diagnostic"]:
                row["diagnostic"] = {**row["diagnostic"], "help": on_the_page(row["diagnostic"]["help"])}
            row["failed"] = [trial.scenario for trial in check.trials if not trial.ok]
            row["runs"] = check.outcome is Outcome.ERROR and check.id.partition(".")[0] in {"run", "faults", "together"}
            row["tried"] = len(check.trials)
    return data


def replayed(spec: Typed, folder: Path, check: str, scenario: str) -> dict[str, Any] | None:
    """The scans of a scenario that failed."""
    found = replay(open_spec(spec.path, spec.read).sound(), folder, check, scenario)
    if found is None:
        return None
    failure = found.failure
    return {
        "scenario": found.scenario,
        "failure": None
        if failure is None
        else {"text": failure.message, "scan": failure.scan, "file": Path(failure.file).name, "line": failure.line},
        "telegrams": [one.hex(" ").upper() for one in found.telegrams],
        "scans": found.scans,
        "jobs": {
            key: [[scan, *now[:-1], f"{now.status:04X}"] for scan, now in signals.items()]
            for key, signals in found.jobs.items()
        },
        "exchanges": [
            {"scan": one.scan, "direction": one.direction, "hex": one.data.hex(" ").upper()} for one in found.exchanges
        ],
    }


def reviewed(spec: Typed, folder: Path, base: str, progress: Progress) -> dict[str, Any]:
    """The page of a review. Raises DiagnosticError if there is nothing to compare with under that name."""
    request = ReviewRequest(spec.path, folder, base, read=spec.read, home=default_folder(spec.path))
    found = collect(request, progress)
    page = shipped_format("html").render("review", found, PLAIN)
    for private in (folder.parent, spec.path.parent):  # the page is handed on
        page = page.replace(f"{private.as_posix()}/", "")
    field = "Vergleichen mit" if found.language == "de" else "Compare with"
    page = page.replace("<code>--against</code>", f"<b>{field}</b>").replace("--against ", "")
    page = _WITHOUT_WIRESHARK[0].sub(_WITHOUT_WIRESHARK[1], page)
    return {"page": page, "ok": found.ok, "name": f"{spec.path.stem}_review.html"}
