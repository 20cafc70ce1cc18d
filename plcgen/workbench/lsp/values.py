"""Results of the service as values of the language server protocol."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from weakref import WeakKeyDictionary

from lsprotocol import types as lsp
from pygls.uris import from_fs_path

from plcgen.base.diagnostics import Severity, Span
from plcgen.base.display.markdown import escape
from plcgen.base.display.page import Page
from plcgen.workbench.service import Document, Edit, Finding, Offer, Symbol, Workspace
from plcgen.workbench.service.positions import Encoding, from_units, to_units
from plcgen.workbench.service.results import TOKEN_KINDS, Painted

_SEVERITIES = {
    Severity.ERROR: lsp.DiagnosticSeverity.Error,
    Severity.WARNING: lsp.DiagnosticSeverity.Warning,
    Severity.NOTE: lsp.DiagnosticSeverity.Information,
}
_OFFERS = {
    "key": lsp.CompletionItemKind.Property,
    "value": lsp.CompletionItemKind.EnumMember,
    "name": lsp.CompletionItemKind.Reference,
    "device": lsp.CompletionItemKind.Class,
    "parameter": lsp.CompletionItemKind.Field,
    "variable": lsp.CompletionItemKind.Variable,
    "file": lsp.CompletionItemKind.File,
    "instruction": lsp.CompletionItemKind.Function,
    "type": lsp.CompletionItemKind.Struct,
    "member": lsp.CompletionItemKind.Field,
    "snippet": lsp.CompletionItemKind.Snippet,
}
_SYMBOLS = {
    "section": lsp.SymbolKind.Namespace,
    "unit": lsp.SymbolKind.Module,
    "drive": lsp.SymbolKind.Object,
    "job": lsp.SymbolKind.Function,
    "recipe": lsp.SymbolKind.Struct,
    "station": lsp.SymbolKind.Object,
    "variable": lsp.SymbolKind.Variable,
    "block": lsp.SymbolKind.Class,
    "type": lsp.SymbolKind.Struct,
    "member": lsp.SymbolKind.Field,
}


_PACKED: WeakKeyDictionary[Painted, dict[str, tuple[Sequence[int], int]]] = WeakKeyDictionary()


@dataclass(frozen=True, slots=True)
class Values:
    """Makes values for a client that counts columns in an encoding."""

    workspace: Workspace
    encoding: Encoding

    def place(self, document: Document, position: lsp.Position) -> tuple[int, int]:
        """Line and column of a position."""
        return from_units(document.lines, position.line, position.character, self.encoding)

    def range(self, span: Span, document: Document | None = None) -> lsp.Range:
        """Range of a span; a file as a whole is its first line."""
        found = document or self.workspace.documents.get(span.file)
        lines: Sequence[str] = found.lines if found is not None else ("",) * span.end_line
        start = to_units(lines, span.line, span.column, self.encoding)
        end = to_units(lines, span.end_line, span.end_column, self.encoding) if span.end_line else start
        return lsp.Range(lsp.Position(*start), lsp.Position(*max(start, end)))

    def location(self, span: Span) -> lsp.Location:
        """Location of a span."""
        return lsp.Location(uri_of(span.file), self.range(span))

    def diagnostic(self, finding: Finding, document: Document | None) -> lsp.Diagnostic:
        """A finding: what is wrong and the remedy; the reason is in its page."""
        found = finding.diagnostic
        notes = [lsp.DiagnosticRelatedInformation(self.location(note.span), note.message) for note in found.notes]
        return lsp.Diagnostic(
            range=self.range(found.span, document),
            message=f"{found.message}\n{finding.remedy}" if finding.remedy else found.message,
            severity=_SEVERITIES[found.severity],
            code=found.code,
            source="plcgen",
            related_information=notes or None,
            data={"reason": finding.reason},
        )

    def edits(self, edits: Iterable[Edit]) -> lsp.WorkspaceEdit:
        """Edits of several files."""
        changes: dict[str, list[lsp.TextEdit]] = {}
        for edit in edits:
            changes.setdefault(uri_of(edit.span.file), []).append(self.edit(edit))
        return lsp.WorkspaceEdit(changes=changes)

    def edit(self, edit: Edit, document: Document | None = None) -> lsp.TextEdit:
        """One edit."""
        return lsp.TextEdit(self.range(edit.span, document), edit.text)

    def item(self, offer: Offer, number: int, document: Document) -> lsp.CompletionItem:
        """An offer; the order is ours."""
        said = f" {offer.also} {offer.detail}" if offer.kind == "parameter" else ""
        return lsp.CompletionItem(
            label=offer.label,
            kind=_OFFERS[offer.kind],
            detail=offer.detail or None,
            documentation=lsp.MarkupContent(lsp.MarkupKind.PlainText, offer.text) if offer.text else None,
            sort_text=f"{number:05}",
            filter_text=f"{offer.edit.text.strip(' -').removesuffix(':')}{said}",
            text_edit=self.edit(offer.edit, document),
        )

    def packed(self, painted: Painted) -> tuple[Sequence[int], int]:
        """Tokens as the protocol packs them: five numbers each, places counted from the token before; the last line.

        What has been packed is kept as long as the text.
        """
        known = _PACKED.get(painted, {})
        if self.encoding not in known:
            data: list[int] = []
            line = start = 0
            for token in painted.tokens:
                span = token.span
                at, first = to_units(painted.lines, span.line, span.column, self.encoding)
                _, end = to_units(painted.lines, span.end_line, span.end_column, self.encoding)
                data += (
                    at - line,
                    first - start if at == line else first,
                    end - first,
                    TOKEN_KINDS.index(token.kind),
                    0,
                )
                line, start = at, first
            known = _PACKED[painted] = {**known, self.encoding: (data, line)}
        return known[self.encoding]

    def symbol(self, symbol: Symbol, document: Document) -> lsp.DocumentSymbol:
        """A symbol with what is in it."""
        return lsp.DocumentSymbol(
            name=symbol.name or "?",
            kind=_SYMBOLS[symbol.kind],
            range=self.range(symbol.whole, document),
            selection_range=self.range(symbol.place, document),
            detail=symbol.detail or None,
            children=[self.symbol(below, document) for below in symbol.children],
        )


def uri_of(file: str) -> str:
    """URI of a file."""
    return from_fs_path(str(Path(file).absolute())) or ""


def markdown(page: Page) -> str:
    """A page as Markdown: running text as text, lines with an order of their own as they are."""
    parts = [f"**{escape(page.key)}** {escape(page.title)}".strip()]
    for heading, text in page.sections:
        if text.strip():
            fence = "`" * 3
            while fence in text:
                fence += "`"
            body = f"{fence}text\n{text.strip()}\n{fence}" if "\n" in text.strip() else escape(text.strip())
            parts.append(f"*{escape(heading)}*\n\n{body}")
    return "\n\n".join(parts)
