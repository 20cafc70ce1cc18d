"""Files: complete, unchanged since generation, in the encoding the tool wants, accepted by our own front end."""

from __future__ import annotations

import codecs
from collections.abc import Iterator
from pathlib import Path

from plcgen.diagnostics import Diagnostic, Severity, Span
from plcgen.input.files import read_bounded
from plcgen.input.hashes import has_digest
from plcgen.project.nouns import Project
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.folder import Folder
from plcgen.scl.dialect import Dialect
from plcgen.simaticml.reading.invariants import check_invariants
from plcgen.sources.generated import (
    JOURNAL,
    MANIFEST,
    MAX_MANIFEST,
    generated_documents,
    generated_sources,
    known_files,
)

_DIALECTS = {
    Dialect.STEP7_V5: "S7-SCL of STEP 7 V5",
    Dialect.TIA_300_400: "SCL of TIA Portal, S7-300/400",
    Dialect.TIA_1200_1500: "SCL of TIA Portal, S7-1200/1500",
}


def check_files(project: Project, folder: Folder) -> Iterator[Check]:
    """Checks of the group ``files``."""
    known, problems = _manifest(folder.path)
    problems += _changed(folder.path, known)
    yield _check("files.manifest", "files", f"{len(known)} files", problems, "complete, hashes match the manifest")
    sources = generated_sources(folder.path)
    wrong = [problem for path in sources for problem in _encoding(project, path)]
    wanted = "Windows-1252" if project.target.v5 else "UTF-8 with byte order mark"
    yield _check("files.encoding", "sources", f"{len(sources)} files", wrong, wanted)
    yield _check(
        "files.syntax", "sources", _DIALECTS[project.target.dialect], folder.problems, "parsed without findings"
    )
    documents = generated_documents(folder.path)
    if project.target.xml_version:
        findings = [d for path in documents for d in check_invariants(path, classic=project.target.classic)]
        text = f"{len(documents)} documents, {project.target.xml_version}"
        yield _check("files.simaticml", "SimaticML", text, findings, "well formed, envelope as in exports")


def _check(id_: str, subject: str, text: str, problems: list[Diagnostic], good: str) -> Check:
    errors = [p for p in problems if p.severity is Severity.ERROR]
    if errors:
        more = f" (+{len(errors) - 1} more)" if len(errors) > 1 else ""
        return Check(id_, subject, text, Outcome.ERROR, f"{errors[0].message}{more}", errors[0])
    if problems:
        return Check(id_, subject, text, Outcome.WARNING, problems[0].message, problems[0])
    return Check(id_, subject, text, Outcome.OK, good)


def _manifest(folder: Path) -> tuple[dict[str, str], list[Diagnostic]]:
    path = folder / MANIFEST
    try:
        return known_files(read_bounded(path, MAX_MANIFEST)), []
    except OSError as problem:
        why = problem.strerror or str(problem)
        return {}, [Diagnostic("PG507", f"no manifest: {why}", Span(str(path)), help="run plcgen generate")]
    except ValueError as problem:
        return {}, [Diagnostic("PG611", str(problem), Span(str(path)), help="run plcgen generate")]


def _changed(folder: Path, known: dict[str, str]) -> list[Diagnostic]:
    found = []
    if (folder / JOURNAL).exists():
        message = "a generation was interrupted here: some files are old, some are new"
        found.append(Diagnostic("PG602", message, Span(str(folder)), help="run plcgen generate once more"))
    root = folder.resolve()
    for name, expected in known.items():
        path = folder / name
        if not path.resolve().is_relative_to(root):
            found.append(
                Diagnostic("PG611", f'the manifest names "{name}" outside the folder', Span(str(folder / MANIFEST)))
            )
        elif not path.is_file():
            found.append(Diagnostic("PG601", "generated file is missing", Span(str(path)), help="run plcgen generate"))
        elif not has_digest(path.read_bytes(), expected):
            found.append(
                Diagnostic(
                    "PG602",
                    "file was changed after it was generated",
                    Span(str(path)),
                    Severity.WARNING,
                    help="the other checks below look at the changed file",
                )
            )
    return found


def _encoding(project: Project, path: Path) -> list[Diagnostic]:
    data = path.read_bytes()
    bom = data.startswith(codecs.BOM_UTF8)
    if project.target.v5 and bom:
        return [Diagnostic("PG610", "STEP 7 V5 reads ANSI sources; this one has a byte order mark", Span(str(path)))]
    if not project.target.v5 and not bom:
        return [Diagnostic("PG610", "TIA Portal needs UTF-8 with a byte order mark", Span(str(path)))]
    return []
