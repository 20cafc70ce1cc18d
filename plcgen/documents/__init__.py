"""From the project to documents: one module per kind of file. Views only; the templates write the text."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from plcgen.documents.document import Document
from plcgen.project.nouns import Project
from plcgen.protocols.ds47.plan.nouns import DrivePlan
from plcgen.protocols.ppi.plan.nouns import PpiPlan


def emit(project: Project) -> Iterator[Document]:
    """Every document of a project, one job after the other; the files know their import order, not this one."""
    from plcgen.documents.code import job_twins, main_twin
    from plcgen.documents.openness import openness_documents
    from plcgen.documents.simaticml import closing_xml, job_xml, shared_xml
    from plcgen.protocols.ds47.views.blocks import control_document, job_documents, main_document, shared_documents
    from plcgen.protocols.ds47.views.jobs import job_document
    from plcgen.protocols.ds47.views.tables import sheet, table_documents, watch_document, watch_rows

    xml = project.target.xml_version is not None
    drives, ppi = project.plan(DrivePlan), project.plan(PpiPlan)
    sheets = []
    if drives is not None and drives.jobs:
        yield from shared_documents(drives)
        if xml:
            yield from shared_xml(drives)
        for job in drives.jobs:
            yield from job_documents(drives, job)
            yield replace(job_document(drives, job), twins=job_twins(drives, job))
            watch = watch_rows(drives, job)
            yield watch_document(job, watch)
            if xml:
                yield from job_xml(drives, job, watch)
            sheets.append(sheet(drives, job))
        yield control_document(drives)
    if ppi is not None:
        from plcgen.protocols.ppi.views.blocks import ppi_documents
        from plcgen.protocols.ppi.views.tables import ppi_xml

        yield from ppi_documents(ppi)
        if xml:
            yield from ppi_xml(ppi)
    yield replace(main_document(project), twins=main_twin(project))
    if xml:
        if drives is not None and drives.jobs:
            yield from closing_xml(drives)
        yield from openness_documents(project)
    yield from table_documents(project, sheets)
