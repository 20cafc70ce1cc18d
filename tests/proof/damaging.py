"""Damage to delivered files: put into a copy of an example, its manifest made anew; what is found without running."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from plcgen.project.opening import open_spec
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.delivery import delivered
from plcgen.proof.folder import read_folder
from plcgen.proof.layouts import check_layout
from tests.projects import ROOT

Edit = tuple[str, str, str]
"""File, what stands there, what stands there instead."""


def signed(folder: Path, files: Sequence[str]) -> None:
    """The manifest with hashes and lengths of files as they are now."""
    manifest = json.loads((folder / "manifest.json").read_text("utf-8"))
    for entry in manifest["files"]:
        if entry["path"] in files:
            data = (folder / entry["path"]).read_bytes()
            entry |= {"sha256": hashlib.sha256(data).hexdigest(), "bytes": len(data)}
    (folder / "manifest.json").write_text(json.dumps(manifest), "utf-8")


@contextmanager
def damaged(folder: Path, edits: Sequence[Edit], encoding: str) -> Iterator[None]:
    """The folder with the first occurrence of each text changed, and hashes that hide it; afterwards as it was."""
    before = {name: (folder / name).read_bytes() for name in {"manifest.json", *(name for name, _, _ in edits)}}
    try:
        for name, old, new in edits:
            own = encoding if name.endswith((".scl", ".sdf", ".inp")) else "utf-8"
            text = (folder / name).read_bytes().decode(own)
            crlf = "\r\n" in text
            text = text.replace("\r\n", "\n")
            assert old in text, f"{name}: {old}"
            text = text.replace(old, new, 1)
            (folder / name).write_bytes((text.replace("\n", "\r\n") if crlf else text).encode(own))
        signed(folder, [name for name, _, _ in edits if name != "manifest.json"])
        yield
    finally:
        for name, data in before.items():
            (folder / name).write_bytes(data)


def findings(example: str, folder: Path) -> list[Check]:
    """Errors of everything that reads the files without running them."""
    project = open_spec(ROOT / "specs" / f"{example}.yaml").sound()
    files = read_folder(folder, project.target)
    proofs = [plan.protocol.proof(plan) for plan in project.plans]
    checks = [*delivered(project, files)]
    checks += [check_layout(project, files, laid) for proof in proofs for laid in proof.layouts()]
    checks += [check for proof in proofs for check in proof.telegrams(files)]
    return [check for check in checks if check.outcome is Outcome.ERROR]
