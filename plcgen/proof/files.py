"""Every file of a delivered folder: complete, unchanged, well encoded, accepted by our front end; what it says."""

from __future__ import annotations

import codecs
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, Severity, Span
from plcgen.project.nouns import Project
from plcgen.proof.checks import Check, Outcome, file_check
from plcgen.proof.folder import Folder
from plcgen.proof.headers import check_headers
from plcgen.proof.inventory import inventory, listed_files, owned_files
from plcgen.proof.making import Pending, attempted, make_checks
from plcgen.proof.tables import check_tables
from plcgen.proof.twins import check_twins
from plcgen.proof.wording import check_wording
from plcgen.s7.read.generated import generated_documents, generated_sources, spec_of
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.xml.reading.invariants import check_invariants

_DIALECTS = {
    Dialect.STEP7_V5: "S7-SCL of STEP 7 V5",
    Dialect.TIA_300_400: "SCL of TIA Portal, S7-300/400",
    Dialect.TIA_1200_1500: "SCL of TIA Portal, S7-1200/1500",
}


def delivered(project: Project, folder: Folder) -> tuple[Check, ...]:
    """Manifest, encodings, syntax, the two spellings of every block, headers, tables, what texts say."""
    place = Span(str(folder.path))
    looks: dict[str, tuple[str, Callable[[Project, Folder], Iterator[Check]]]] = {
        "files.manifest": ("files", _manifest),
        "files.encoding": ("sources", _encodings),
        "files.syntax": ("sources", _syntax),
        "files.simaticml": ("SimaticML", _documents),
        "files.twins": ("text and SimaticML", check_twins),
        "headers": ("headers", check_headers),
        "files.tables": ("tables", check_tables),
        "files.wording": ("wording", check_wording),
    }
    found = (
        Pending(id_, subject, lambda: place, partial(look, project, folder)) for id_, (subject, look) in looks.items()
    )
    return tuple(make_checks(found, "files", place))


def _manifest(project: Project, folder: Folder) -> Iterator[Check]:
    known, problems = listed_files(folder.path)
    problems += inventory(project, folder.path, known)
    if spec_of(folder.path) not in {None, project.loaded.digest}:
        # in front of all that follows from it; it need not make a difference, as with another comment in the spec
        message = "these files were made from another state of the spec"
        place = Span(str(folder.path))
        problems.insert(0, Diagnostic("PG504", message, place, Severity.WARNING, help="run plcgen generate"))
    yield _check(
        "files.manifest",
        "files",
        f"{len(known)} files and manifest.json",
        problems,
        "complete, unchanged, nothing else",
    )
    owned = owned_files(project, folder.path, known)
    if owned:
        yield Check("files.owned", "yours", ", ".join(owned), Outcome.OK, "not as generated: user_owned")


def _encodings(project: Project, folder: Folder) -> Iterator[Check]:
    sources = generated_sources(folder.path)
    wrong = [one for path in sources for one in attempted(partial(_encoding, project, path), Span(str(path)))]
    wanted = "Windows-1252" if project.target.v5 else "UTF-8 with byte order mark"
    yield _check("files.encoding", "sources", f"{len(sources)} files", wrong, wanted)


def _syntax(project: Project, folder: Folder) -> Iterator[Check]:
    dialect = _DIALECTS[project.target.dialect]
    yield _check("files.syntax", "sources", dialect, folder.problems, "parsed without findings")


def _documents(project: Project, folder: Folder) -> Iterator[Check]:
    if not project.target.xml_version:
        return
    documents, classic = generated_documents(folder.path), project.target.classic
    looks = ((path, partial(check_invariants, path, classic=classic)) for path in documents)
    findings = [one for path, look in looks for one in attempted(look, Span(str(path)))]
    text = f"{len(documents)} documents, {project.target.xml_version}"
    yield _check("files.simaticml", "SimaticML", text, findings, "well formed, envelope as in exports")


def _check(id_: str, subject: str, text: str, problems: list[Diagnostic], good: str) -> Check:
    errors = [p for p in problems if p.severity is Severity.ERROR]
    if problems and not errors:
        return Check(id_, subject, text, Outcome.WARNING, problems[0].message, problems[0])
    return file_check(id_, subject, text, errors, good)


def _encoding(project: Project, path: Path) -> list[Diagnostic]:
    data = path.read_bytes()
    bom = data.startswith(codecs.BOM_UTF8)
    if project.target.v5 and bom:
        return [Diagnostic("PG610", "STEP 7 V5 reads ANSI sources; this one has a byte order mark", Span(str(path)))]
    if not project.target.v5 and not bom:
        return [Diagnostic("PG610", "TIA Portal needs UTF-8 with a byte order mark", Span(str(path)))]
    return []
