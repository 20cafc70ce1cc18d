"""The documents of a folder, and everything that can be asked about them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.workbench.service.documents import Document, Documents
from plcgen.workbench.service.specs.state import Specs

if TYPE_CHECKING:
    from plcgen.workbench.service.results import Edit, Finding, Hover, Offer, Symbol


class Workspace:
    """The documents that are open in an editor, and everything that can be asked about them.

    Every question takes a document as ``open`` has returned it. Files are read from what is open, else from disk; edits
    are made for files of the folder only. Questions raise PlcgenError where a plugin, a profile or a file cannot be
    used.
    """

    def __init__(self, folder: Path | str) -> None:
        self.documents = Documents(Path(folder).absolute())
        self.specs = Specs(self.documents)

    def open(self, path: Path | str, text: str) -> Document:
        """Take the text of a document that was opened or changed. Raises ArgumentError if it is too large."""
        return self.documents.open(path, text)

    def close(self, path: Path | str) -> None:
        """Forget a document."""
        self.documents.close(path)
        self.specs.forget()

    def changed(self) -> None:
        """Files on disk may be others than before."""
        self.documents.generation += 1

    def diagnostics(self, document: Document) -> tuple[Finding, ...]:
        """All that ``check`` says of a spec, also in files that it includes."""
        from plcgen.workbench.service.specs.findings import findings

        return findings(self.specs, document) if document.is_yaml else ()

    def complete(self, document: Document, line: int, column: int) -> tuple[Offer, ...]:
        """What may stand at a place; the text may be broken."""
        from plcgen.workbench.service.specs.offers import offers

        return offers(self.specs, document, line, column) if document.is_yaml else ()

    def hover(self, document: Document, line: int, column: int) -> Hover | None:
        """What there is to know of what stands at a place."""
        from plcgen.workbench.service.specs.hover import hover

        return hover(self.specs, document, line, column) if document.is_yaml else None

    def definition(self, document: Document, line: int, column: int) -> Span | None:
        """Where what is named at a place is defined."""
        from plcgen.workbench.service.specs.names import definition

        return definition(self.specs, document, line, column) if document.is_yaml else None

    def references(self, document: Document, line: int, column: int) -> tuple[Span, ...]:
        """Every place where what stands at a place is named, its definition first."""
        from plcgen.workbench.service.specs.names import references

        return references(self.specs, document, line, column) if document.is_yaml else ()

    def rename(self, document: Document, line: int, column: int, name: str) -> tuple[Edit, ...]:
        """Edits that give what stands at a place another name.

        Raises:
            DiagnosticError: why that cannot be done.
        """
        from plcgen.workbench.service.specs.names import rename

        edits = rename(self.specs, document, line, column, name) if document.is_yaml else ()
        outside = next((edit.span for edit in edits if not self.documents.writable(edit.span.file)), None)
        if outside is not None:
            raise DiagnosticError([Diagnostic("PG901", "it is named in a file outside the workspace", outside)])
        return edits

    def format(self, document: Document) -> tuple[Edit, ...]:
        """Edits that lay the text out evenly; comments, order and values stay."""
        from plcgen.workbench.service.specs.layout import formatted

        return formatted(document) if document.is_yaml else ()

    def outline(self, document: Document) -> tuple[Symbol, ...]:
        """What is defined in the text."""
        from plcgen.workbench.service.specs.outline import outline

        return outline(self.specs.state(document)) if document.is_yaml else ()
