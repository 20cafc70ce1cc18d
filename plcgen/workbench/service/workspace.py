"""The documents of a folder, and everything that can be asked about them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.workbench.service.documents import Document, Documents
from plcgen.workbench.service.results import moved
from plcgen.workbench.service.sources.state import Sources
from plcgen.workbench.service.sources.version import SourceState, is_source
from plcgen.workbench.service.specs.state import Specs

if TYPE_CHECKING:
    from collections.abc import Callable

    from plcgen.workbench.service.results import Edit, Finding, Hover, Offer, Painted, Signature, Symbol

MOST = 1_000
"""Findings of one source; nobody reads more at once."""


class Workspace:
    """The documents that are open in an editor, and everything that can be asked about them.

    Every question takes a document as ``open`` has returned it. Files are read from what is open, else from disk; edits
    are made for files of the folder only. Questions raise PlcgenError where a plugin, a profile or a file cannot be
    used.
    """

    def __init__(self, folder: Path | str) -> None:
        self.documents = Documents(Path(folder).absolute())
        self.specs = Specs(self.documents)
        self.sources = Sources(self.documents)

    def open(self, path: Path | str, text: str) -> Document:
        """Take the text of a document that was opened or changed. Raises ArgumentError if it is too large."""
        new = self.documents.find(path) is None
        document = self.documents.open(path, text)
        if new:
            self.sources.renewed()
        return document

    def close(self, path: Path | str) -> None:
        """Forget a document."""
        self.documents.close(path)
        self.specs.forget()
        self.sources.renewed()

    def changed(self) -> None:
        """Files on disk may be others than before."""
        self.documents.changed()
        self.sources.renewed()

    def diagnostics(self, document: Document) -> tuple[Finding, ...]:
        """All that ``check`` says of a spec, also in files that it includes, or of a source."""
        from plcgen.workbench.service.specs.findings import finding, findings

        if document.is_yaml:
            return findings(self.specs, document)
        found = self.sources.file(document).diagnostics if is_source(document) else ()
        return tuple(finding(self.specs, one) for one in found[:MOST])

    def complete(self, document: Document, line: int, column: int) -> tuple[Offer, ...]:
        """What may stand at a place; the text may be broken."""
        from plcgen.workbench.service.sources.offers import source_offers
        from plcgen.workbench.service.specs.offers import offers

        if document.is_yaml:
            return offers(self.specs, document, line, column)
        if not is_source(document):
            return ()
        state, own = self.sources.at(document, line)
        return tuple(moved(one, self.sources.real) for one in source_offers(state, own, column))

    def hover(self, document: Document, line: int, column: int) -> Hover | None:
        """What there is to know of what stands at a place."""
        from plcgen.workbench.service.sources import views
        from plcgen.workbench.service.specs.hover import hover

        if document.is_yaml:
            return hover(self.specs, document, line, column)
        if not is_source(document):
            return None
        state, own = self.sources.at(document, line)
        found = views.hover(state, own, column)
        return None if found is None else moved(found, self.sources.real)

    def definition(self, document: Document, line: int, column: int) -> Span | None:
        """Where what is named at a place is defined."""
        from plcgen.workbench.service.sources import names
        from plcgen.workbench.service.specs.names import definition

        if document.is_yaml:
            return definition(self.specs, document, line, column)
        return self._placed(names.definition, document, line, column) if is_source(document) else None

    def references(self, document: Document, line: int, column: int) -> tuple[Span, ...]:
        """Every place where what stands at a place is named, its definition first."""
        from plcgen.workbench.service.sources.references import source_references
        from plcgen.workbench.service.specs.names import references

        if document.is_yaml:
            return references(self.specs, document, line, column)
        return source_references(self.sources, document, line, column) if is_source(document) else ()

    def rename(self, document: Document, line: int, column: int, name: str) -> tuple[Edit, ...]:
        """Edits that give what stands at a place another name, wherever it is named.

        Raises:
            DiagnosticError: why that cannot be done.
        """
        from plcgen.workbench.service.sources import renaming
        from plcgen.workbench.service.specs.names import rename

        if is_source(document):
            return renaming.rename(self.sources, document, line, column, name)
        edits = rename(self.specs, document, line, column, name) if document.is_yaml else ()
        outside = next((edit.span for edit in edits if not self.documents.writable(edit.span.file)), None)
        if outside is not None:
            raise DiagnosticError([Diagnostic("PG901", "it is named in a file outside the workspace", outside)])
        return edits

    def name_at(self, document: Document, line: int, column: int) -> Span | None:
        """The place of the name that ``rename`` would change."""
        from plcgen.workbench.service.sources.renaming import name_place
        from plcgen.workbench.service.specs.names import name_at

        if is_source(document):
            return self._placed(name_place, document, line, column)
        found = name_at(self.specs.state(document), line, column) if document.is_yaml else None
        return None if found is None else found[1]

    def format(self, document: Document) -> tuple[Edit, ...]:
        """Edits that lay a spec, or another file of plcgen, out evenly; comments, order and values stay."""
        from plcgen.workbench.service.specs.layout import formatted
        from plcgen.workbench.service.specs.others import kind_of

        state = self.specs.state(document) if document.is_yaml else None
        ours = state is not None and (state.is_spec or kind_of(state) is not None)
        return formatted(document) if ours else ()

    def outline(self, document: Document) -> tuple[Symbol, ...]:
        """What is defined in the text."""
        from plcgen.workbench.service.sources import views
        from plcgen.workbench.service.specs.outline import outline

        if document.is_yaml:
            return outline(self.specs.state(document))
        parts = self.sources.file(document).parts if is_source(document) else ()
        return tuple(moved(one, self.sources.real) for _, state in parts for one in views.outline(state))

    def tokens(self, document: Document) -> tuple[tuple[int, Painted], ...]:
        """The parts of a source in their colours, with the lines in front of each; the same object while a part is.

        Specs have the colours of YAML, which every editor knows.
        """
        from plcgen.workbench.service.sources import views

        parts = self.sources.file(document).parts if is_source(document) else ()
        return tuple((first, views.painted(state)) for first, state in parts)

    def signature(self, document: Document, line: int, column: int) -> Signature | None:
        """What is called at a place of a source."""
        from plcgen.workbench.service.sources import views

        if not is_source(document):
            return None
        state, own = self.sources.at(document, line)
        return views.signature(state, own, column)

    def _placed(
        self, ask: Callable[[SourceState, int, int], Span | None], document: Document, line: int, column: int
    ) -> Span | None:
        """A place that a part of a source says, as one of a file."""
        state, own = self.sources.at(document, line)
        found = ask(state, own, column)
        return None if found is None else self.sources.real(found)
