"""Versions in documents and sources, against a table that shares nothing with the one they were made from."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.base.files.files import read_bounded
from plcgen.oracles.documents import document_versions, instruction_versions
from plcgen.project.nouns import Project
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.folder import Folder
from plcgen.s7.read.generated import generated_documents, generated_sources

MAX_FILE = 64 * 1024 * 1024
_ENGINEERING = re.compile(rb'<Engineering version="([^"]*)"')
_NAMESPACE = re.compile(rb'xmlns="([^"]*/(?:Interface|StructuredText)/)([^"/]*)"')
_LIBRARY = re.compile(rb"InstructionName := '(\w+)'; LibVersion := '([^']*)'")


@dataclass(frozen=True, slots=True)
class _Stated:
    """Something with a version in a file, and the version that documents print."""

    what: str
    version: str
    documented: str
    file: Path


def check_versions(project: Project, folder: Folder) -> Iterator[Check]:
    """Namespaces of every document by the schemas of its tool, and instructions of every source by exports."""
    documents = document_versions(project.target.toolchain)
    if documents is not None:
        stated = [
            one
            for path in generated_documents(folder.path)
            for one in _in_document(path, documents.engineering, documents.namespaces)
        ]
        yield _compared("versions.documents", "versions of documents", stated, documents.source)
    known = instruction_versions()
    own = project.loaded.spec.plc.instructions.model_dump(exclude_none=True)
    if project.target.t15:
        stated = [
            _Stated(name, version, known.versions[name], path)
            for path in generated_sources(folder.path)
            for name, version in _pairs(_LIBRARY, path)
            if name in known.versions and name not in own
        ]
        if stated:
            yield _compared("versions.instructions", "versions of instructions", stated, known.source)


def _in_document(path: Path, engineering: str, namespaces: dict[str, str]) -> Iterator[_Stated]:
    for found in _ENGINEERING.findall(read_bounded(path, MAX_FILE)):
        yield _Stated("Engineering", found.decode(), engineering, path)
    for base, version in _pairs(_NAMESPACE, path):
        yield _Stated(base, version, namespaces.get(base, "no namespace of that name"), path)


def _pairs(pattern: re.Pattern[bytes], path: Path) -> Iterator[tuple[str, str]]:
    for name, version in pattern.findall(read_bounded(path, MAX_FILE)):
        yield name.decode(), version.decode()


def _compared(id_: str, subject: str, stated: list[_Stated], source: str) -> Check:
    wrong = next((one for one in stated if one.version != one.documented), None)
    if wrong is None:
        return Check(id_, subject, source, Outcome.OK, f"{len(stated)} as documented")
    message = f"{wrong.what} is {wrong.version} in {wrong.file.name}, {wrong.documented} in: {source}"
    return Check(id_, subject, "", Outcome.ERROR, message, Diagnostic("PG640", message, Span(str(wrong.file))))
