"""Every document of a project, from what the protocols contribute; which protocol it is does not matter here."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from plcgen.build import control
from plcgen.build.document import Document
from plcgen.build.nouns import Command, Contribution, DataBlock, FunctionBlock, LibraryInstance, TypeBlock
from plcgen.build.openness import openness_documents
from plcgen.build.overview import Overview
from plcgen.build.simaticml import SimaticMl
from plcgen.build.sources import SourceWriter
from plcgen.build.tables import table_documents, watch_document
from plcgen.project.nouns import Project


def emit(project: Project) -> Iterator[Document]:
    """Every document, one function block after the other; the import order is made of what was emitted."""
    sources, seen = SourceWriter(project), Overview()
    xml = SimaticMl(project) if project.target.xml_version is not None else None
    for plan in project.plans:
        if plan.jobs:
            contribution: Contribution = plan.protocol.documents(plan)
            seen.contributions.append(contribution)
            yield from _Emitter(project, contribution, sources, xml, seen).documents()
    only = seen.contributions[0].jobs if len(seen.contributions) == 1 else "jobs"
    main = sources.main(seen.calls, only, next((found.family for found in seen.contributions), ""))
    yield main if xml is None else replace(main, twins=xml.main(seen.calls))
    if xml is not None:
        for name, rows in seen.tags.items():
            yield xml.tags(name, rows)
        yield from openness_documents(project, seen, xml.note)
    yield from table_documents(project, seen, sources)


class _Emitter:
    """Writes what one protocol contributes, and remembers it for the tables."""

    def __init__(
        self, project: Project, contribution: Contribution, sources: SourceWriter, xml: SimaticMl | None, seen: Overview
    ) -> None:
        self.project, self.contribution = project, contribution
        self.sources, self.xml, self.seen = sources, xml, seen

    def documents(self) -> Iterator[Document]:
        """Shared blocks, function blocks one by one, the control DB."""
        contribution = self.contribution
        commands: list[Command] = []
        for type_ in contribution.types:
            yield from self.type(type_)
        for data in contribution.data:
            yield from self.data(data)
        for program in contribution.programs:
            yield from self.program(program)
            commands += program.commands
        for block, title in contribution.controls.items():
            made = [control.structure(self.project, command) for command in commands if command.control == block]
            members = [one for one in made if one.members] or [control.placeholder(self.project)]
            yield from self.data(DataBlock(block, title, members))
        if tags := [tag for command in commands for tag in control.tags(command)]:
            self.seen.tags[contribution.tag_table] = tags

    def type(self, made: TypeBlock) -> Iterator[Document]:
        """A user type, as source and as document."""
        self.seen.type(made)
        yield self.sources.type(made)
        if self.xml is not None:
            yield self.xml.type(made)

    def data(self, made: DataBlock | LibraryInstance) -> Iterator[Document]:
        """A data block, as source and as document."""
        self.seen.stored(made)
        yield self.sources.stored(made, self.contribution.family)
        if self.xml is not None:
            yield from self.xml.data(made)

    def program(self, made: FunctionBlock) -> Iterator[Document]:
        """A function block with buffers, instance and watch table."""
        for type_, data in made.buffers:
            yield from self.type(type_)
            if data is not None:
                yield from self.data(data)
        for block in made.data:
            yield from self.data(block)
        self.seen.program(made, control.call(made))
        source = self.sources.program(made)
        yield source if self.xml is None else replace(source, twins=self.xml.program(made))
        if made.instance is not None:
            yield self.sources.instance(made.instance, f'"{made.block.name}"', self.contribution.family)
        rows = [row for command in made.commands for row in control.watch_rows(command)]
        rows += [row for type_, _ in made.buffers for member in type_.members for row in member.watch]
        if rows:
            self.seen.watched.append(made.block.name)
            yield watch_document(made.block.name, rows)
            if self.xml is not None:
                yield self.xml.watch(made.block.name, rows)
