"""SimaticML of code blocks: made from the rendered SCL text, so text and document can never differ."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

from plcgen.documents.document import RAW, Document
from plcgen.documents.spelling import culture
from plcgen.project.nouns import BlockRef, Frame, Project
from plcgen.protocols.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.protocols.ppi.plan.nouns import PpiPlan
from plcgen.s7.blocks import Block, BlockKind
from plcgen.simaticml.versions import VERSIONS
from plcgen.simaticml.writing.documents import Setting
from plcgen.simaticml.writing.twin import code_document, instance_document, read_block

RECORD_NOTE = "the call form of WRREC and RDREC is inferred; no genuine export was at hand to compare with"
VERSION_NOTE = "no genuine export of this TIA Portal version was at hand to compare with"
_MAIN_NUMBER = 1


def job_twins(project: DrivePlan, job: DriveJob) -> Callable[[str], Iterator[Document]] | None:
    """Return what makes the documents of a job's FB and of its instance DB from the FB's text."""
    return block_twins(project, job.block, job.instance)


def block_twins(
    project: Frame, block: BlockRef, instance: BlockRef, note: str = RECORD_NOTE
) -> Callable[[str], Iterator[Document]] | None:
    """Return what makes the documents of a function block and of its instance DB from the block's text."""
    if project.target.xml_version is None:
        return None
    return partial(_pair, project, block, instance, note)


def main_twin(project: Project) -> Callable[[str], Iterator[Document]] | None:
    """Return what makes the document of the example OB1 from its text."""
    if project.target.xml_version is None:
        return None
    return partial(_main, project)


def version_note(project: Frame) -> str:
    """Why documents of this version are experimental, if they are."""
    version = VERSIONS[project.target.xml_version or ""]
    return VERSION_NOTE if version.inferred or version.early else ""


def _pair(project: Frame, fb: BlockRef, db: BlockRef, note: str, text: str) -> Iterator[Document]:
    setting = _setting(project)
    block = replace(read_block(text), number=fb.number)
    yield _document(fb, code_document(block, setting), note)
    instance = Block(
        BlockKind.DB,
        db.name,
        (),
        number=db.number,
        instance_of=block.name,
        attributes=block.attributes,
    )
    yield _document(db, instance_document(instance, block, setting), version_note(project))


def _main(project: Project, text: str) -> Iterator[Document]:
    drives, ppi = project.plan(DrivePlan), project.plan(PpiPlan)
    pairs = [(job.instance.name, job.block.name) for job in drives.jobs] if drives else []
    pairs += [(master.instance.name, master.block.name) for master in ppi.masters] if ppi else []
    instances = tuple(Block(BlockKind.DB, name, (), instance_of=block) for name, block in pairs)
    block = replace(read_block(text), number=_MAIN_NUMBER)
    document = code_document(block, _setting(project), instances)
    yield _raw(f"xml/{block.name}.xml", document, version_note(project))


def _setting(project: Frame) -> Setting:
    cultures = tuple(culture(language) for language in project.languages)
    return Setting(VERSIONS[project.target.xml_version or ""], project.target.classic, cultures)


def _document(block: BlockRef, text: str, experimental: str) -> Document:
    return _raw(f"xml/{block.name}.xml", text, experimental)


def _raw(path: str, text: str, experimental: str) -> Document:
    return Document(path, RAW, {"text": text}, "utf-8-sig", "\n", experimental)
