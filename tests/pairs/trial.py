"""What becomes of a spec: refused with codes, or everything that can be done with it is done."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal

import pytest
import yaml

from plcgen import api
from plcgen.base.diagnostics import Diagnostic, Severity
from tests.xsd_support import PROJECT, VERSIONS, validate_islands

FILES = Path(__file__).with_name("files")
"""What specs name: profiles of devices, a symbol table."""
Effort = Literal["none", "quick"]


class WrongError(Exception):
    """Something that is not as it should be."""


def tried(spec: dict[str, Any], folder: Path, effort: Effort = "none") -> frozenset[str]:
    """Codes with which a spec is refused, none if all of it works. Raises WrongError."""
    shutil.copytree(FILES, folder, dirs_exist_ok=True)
    path = folder / "spec.yaml"
    path.write_text(yaml.safe_dump(spec, sort_keys=False, allow_unicode=True), "utf-8")
    checked = api.check(path)
    refused = [one for one in checked.diagnostics if one.severity is Severity.ERROR]
    if any(not one.span.line for one in refused):
        raise WrongError(f"no place: {_errors(refused)}")
    if refused:
        return frozenset(one.code for one in refused)
    out = folder / "spec_generated"
    shutil.rmtree(out, ignore_errors=True)  # another spec's files in it are nobody's that are asked about here
    if not (made := api.generate(path, out, force=True)).ok:
        raise WrongError(f"generate: {_errors(made.diagnostics)}")
    for owned in spec["plc"].get("user_owned", ()):
        file = next(out.rglob(f"{owned}.scl"), out / owned)
        if file.exists() or file.suffix:  # one source for all blocks has no file of the block
            file.write_bytes((file.read_bytes() if file.exists() else b"") + b"// mine\r\n")
    again = api.generate(path, out, check_only=True)
    if not again.ok or again.diff:
        raise WrongError(f"generate --check: {again.diff[:300]} {_errors(again.diagnostics)}")
    found = api.verify(path, out, faults=effort)
    if not found.ok:
        raise WrongError(f"verify: {_errors(found.problems)}")
    lock = folder / "plcgen.lock.json"
    locked = api.lock(path, out=lock, force=True)
    for what, compared in (("diff with itself", api.diff(out, out)), ("lock --check", api.check_lock(path, lock=lock))):
        if compared.changes or _errors((*compared.diagnostics, *locked.diagnostics)):
            raise WrongError(f"{what}: {compared.changes[:2]} {_errors(compared.diagnostics)}")
    if schemas := _schemas():
        for document in sorted(out.glob("xml/*.xml")) if checked.project is not None else ():
            version = checked.project.target.xml_version
            with suppress(pytest.skip.Exception):  # there is no schema of this version
                if version in VERSIONS and (messages := validate_islands(document, version)):
                    raise WrongError(f"{document.name} against {schemas}: {messages[:2]}")
    return frozenset()


def _errors(diagnostics: Iterable[Diagnostic]) -> list[str]:
    return [f"{one.code} {one.message}" for one in diagnostics if one.severity is Severity.ERROR]


def _schemas() -> Path | None:
    folder = Path(os.environ.get("PLCGEN_SIMATICML_XSD") or PROJECT.parent / "shared" / "xsd")
    return folder if folder.is_dir() else None
