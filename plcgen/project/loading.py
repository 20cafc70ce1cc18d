"""From a spec file to a validated spec, with every problem of the file as a diagnostic at its place."""

from __future__ import annotations

import copyreg
from pathlib import Path
from typing import Any

from plcgen.base.diagnostics import Report
from plcgen.base.files.validation import FileShape, keys_at, validate
from plcgen.base.files.yaml import YamlNode
from plcgen.project.composing import HELP, compose, from_disk
from plcgen.project.includes import Read
from plcgen.project.part import SpecPart
from plcgen.project.registry import protocols
from plcgen.project.salvage import Parts, Salvaged, salvage
from plcgen.project.schema import Spec
from plcgen.project.shape import spec_model
from plcgen.project.spec import LoadedSpec, SpecPath


def load_spec(path: Path, report: Report, read: Read = from_disk) -> LoadedSpec | None:
    """Read and validate a spec file, with the files that it includes.

    Raises:
        DiagnosticError: if the file cannot be read as text at all.
    """
    return parse_spec(read(path, path.as_posix()), path.as_posix(), report, read)


def parse_spec(text: str, file: str, report: Report, read: Read = from_disk) -> LoadedSpec | None:
    """Validate spec text; problems go to ``report``; None if it cannot be used."""
    own = Report()
    composed = compose(text, file, own, read)
    if composed is None:
        report.extend(own)
        return None
    valid = validate(composed.root, _SPEC, own)
    report.extend(composed.told(own))
    if valid is None or own.has_errors:
        return None
    return LoadedSpec(file, text, valid, composed.root, composed.included, composed.uses)


def salvage_spec(path: Path, read: Read = from_disk) -> Salvaged[Spec] | None:
    """What can be planned of a spec whose shape is wrong; None if that would be nothing."""
    found = Report()
    composed = compose(read(path, path.as_posix()), path.as_posix(), found, read)
    if composed is None:
        return None
    known = protocols()
    entries = frozenset(key for protocol in known for key in protocol.entries)
    details = frozenset(key for protocol in known for key in protocol.details)
    return salvage(composed.root, found, _SPEC, Parts(("plc",), entries, details))


def _parsed(text: str, file: str, included: dict[str, str]) -> LoadedSpec:
    loaded = parse_spec(text, file, Report(), lambda _, name: included[name])
    if loaded is None:
        raise ValueError(f"{file} was valid before")
    return loaded


def _as_text(spec: LoadedSpec) -> tuple[Any, ...]:
    return _parsed, (spec.text, spec.file, dict(spec.included))


copyreg.pickle(LoadedSpec, _as_text)  # its model is made anew: a class that was made for some protocols has no name


def used_protocols(root: YamlNode) -> tuple[SpecPart, ...]:
    """The protocols whose sections stand in a spec; without any, the first one, whose keys are missing then."""
    used = tuple(protocol for protocol in protocols() if any(key in root.pairs for key in protocol.sections))
    return used or protocols()[:1]


def spec_keys(path: SpecPath) -> list[str]:
    """Keys that a spec may have at a path, whatever protocols it uses."""
    return keys_at(spec_model(protocols()), path)


_SPEC: FileShape[Spec] = FileShape(
    model=lambda root: spec_model(used_protocols(root)),
    what="the spec",
    shape="a spec is a mapping with plc, drives and jobs",
    help=HELP,
    keys=spec_keys,
)
