"""The one door to a spec: read, validate, plan, apply the rules."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Report, has_errors
from plcgen.project.allowances import Allowance, allowances, settled
from plcgen.project.composing import from_disk
from plcgen.project.includes import Read
from plcgen.project.loading import load_spec, salvage_spec
from plcgen.project.nouns import Project
from plcgen.project.resolve import resolve
from plcgen.project.rules import apply_rules
from plcgen.project.spec import LoadedSpec
from plcgen.project.variables import with_origins


@dataclass(frozen=True, slots=True)
class Opened:
    """A spec as far as it could be planned (None: not at all), and everything found in it."""

    project: Project | None
    diagnostics: tuple[Diagnostic, ...]

    @property
    def usable(self) -> Project | None:
        """The project, if nothing that was found is an error."""
        return None if has_errors(self.diagnostics) else self.project

    def sound(self) -> Project:
        """The project.

        Raises:
            DiagnosticError: with all diagnostics, if one of them is an error.
        """
        Report(list(self.diagnostics)).raise_on_errors()
        if self.project is None:
            raise DiagnosticError(list(self.diagnostics))
        return self.project


def open_spec(path: Path, read: Read = from_disk) -> Opened:
    """Open a spec; whatever is wrong with it is a diagnostic. ``read`` gives the text of it and of what it includes."""
    report = Report()
    project: Project | None = None
    with report.catch():
        loaded = load_spec(path, report, read)
        if loaded is None:
            report.extend(_found_besides(path, read))
        else:
            project = resolve(loaded, report)
            apply_rules(project, report)
    uses = () if project is None else project.loaded.uses
    return Opened(project, tuple(settled(with_origins(report, uses), allowed_in(project))))


def allowed_in(project: Project | None) -> tuple[Allowance, ...]:
    """What comments of the spec and of its included files allow."""
    if project is None:
        return ()
    spec = project.loaded
    return tuple(each for file, text in ((spec.file, spec.text), *spec.included) for each in allowances(text, file))


def _found_besides(path: Path, read: Read) -> Iterator[Diagnostic]:
    """What else is wrong with a spec whose shape is wrong, as far as it can be told."""
    part = salvage_spec(path, read)
    if part is None:
        return
    report = Report()
    with report.catch():
        loaded = LoadedSpec(path.as_posix(), "", part.loaded.model, part.loaded.root, whole=part.whole)
        apply_rules(resolve(loaded, report), report)
    yield from part.told(report)
