"""From the project to documents: one module per kind of file. Views only; the templates write the text."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.emit.document import Document
from plcgen.plan.model import Project


def emit(project: Project) -> Iterator[Document]:
    """Every document of a project, in import order: types, data blocks, function blocks, instances, OB, tables."""
    from plcgen.emit.blocks import control_document, job_documents, main_document, shared_documents
    from plcgen.emit.jobs import job_document
    from plcgen.emit.simaticml import simaticml_documents
    from plcgen.emit.tables import table_documents

    yield from shared_documents(project)
    for job in project.jobs:
        yield from job_documents(project, job)
        yield job_document(project, job)
    yield control_document(project)
    yield main_document(project)
    yield from simaticml_documents(project)
    yield from table_documents(project)
