"""A spec as one tree: its file, the files that it includes, and values in the place of variables."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Report, Span
from plcgen.base.files.text import read_text
from plcgen.base.files.yaml import YamlNode, parse_yaml
from plcgen.project.includes import Read, gather
from plcgen.project.variables import VariableUse, substitute, with_origins

HELP = "start from an example: plcgen new"


@dataclass(frozen=True, slots=True)
class Composed:
    """The tree, texts of the included files by name, and where variables were used."""

    root: YamlNode
    included: tuple[tuple[str, str], ...]
    uses: tuple[VariableUse, ...]

    def told(self, found: Iterable[Diagnostic]) -> Iterable[Diagnostic]:
        """Diagnostics with the origin of the values that are meant."""
        return with_origins(found, self.uses)


def from_disk(path: Path, file: str) -> str:
    """Text of a file of a spec."""
    return read_text(path, file)


def compose(text: str, file: str, report: Report, read: Read = from_disk) -> Composed | None:
    """Read a spec as one tree; problems go to ``report``; None if a file of it cannot be used at all."""
    root = parse_yaml(text, file, report)
    if root is None:
        if not report.has_errors:
            report.add(Diagnostic("PG101", "the file is empty", Span(file, 1, 1, 1, 1), help=HELP))
        return None
    try:
        gathered = gather(root, file, report, read)
    except DiagnosticError:  # it is in the report
        return None
    uses = substitute(gathered.root, report) if gathered.root.kind == "map" else ()
    if not gathered.complete or any(found.code == "PG109" for found in report):
        return None
    return Composed(gathered.root, tuple(gathered.texts.items()), uses)


def included_files(text: str, path: Path) -> tuple[Path, ...]:
    """The files that a spec includes, those of included files too, as far as they can be read."""
    report = Report()
    root = parse_yaml(text, path.as_posix(), report)
    try:
        return () if root is None else tuple(map(Path, gather(root, path.as_posix(), report, from_disk).texts))
    except DiagnosticError:
        return ()
