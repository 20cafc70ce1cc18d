"""The language server: documents in, answers of the service out.

A request that fails answers with an error and leaves the server as it was. Diagnostics come when somebody has stopped
typing for a moment, of what is open then.
"""

from __future__ import annotations

import asyncio
import logging
from pathlib import Path
from typing import Any, cast

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException
from pygls.lsp.server import LanguageServer
from pygls.uris import to_fs_path

from plcgen._version import __version__
from plcgen.base.diagnostics import ArgumentError, DiagnosticError, PlcgenError
from plcgen.workbench.lsp.values import Values, markdown, uri_of
from plcgen.workbench.service import Document, Workspace
from plcgen.workbench.service.positions import Encoding
from plcgen.workbench.service.results import TOKEN_KINDS
from plcgen.workbench.service.specs.drives import MOST

log = logging.getLogger(__name__)
PAUSE = 0.15
"""Seconds without an edit until diagnostics are worked out."""
FAILED = -32803
"""RequestFailed of the protocol, 3.17."""


class Server(LanguageServer):
    """A server with one workspace for each folder of the client."""

    def __init__(self) -> None:
        super().__init__("plcgen", __version__)
        self.desks: list[Workspace] = []
        self.pending: dict[Path, asyncio.TimerHandle] = {}
        self.told: dict[Path, dict[str, list[lsp.Diagnostic]]] = {}
        """What was last said of each open document, by the URI for which it was said."""

    def desk(self, path: Path) -> Workspace:
        """The workspace whose folder a file is in, else the first one."""
        if not self.desks:
            folders = [to_fs_path(folder.uri) for folder in self.workspace.folders.values()]
            root = [self.workspace.root_path] if self.workspace.root_path else []
            self.desks = [Workspace(folder) for folder in (*folders, *root) if folder] or [Workspace(path.parent)]
        inside = (desk for desk in self.desks if path.is_relative_to(desk.documents.folder))
        return next(inside, self.desks[0])

    def values(self, desk: Workspace) -> Values:
        """What makes values of the protocol."""
        return Values(desk, cast("Encoding", str(self.workspace.position_encoding or "utf-16")))

    def find(self, uri: str) -> tuple[Workspace, Document, Values] | None:
        """An open document."""
        path = to_fs_path(uri)
        if path is None:
            return None
        desk = self.desk(Path(path))
        document = desk.documents.find(path)
        return None if document is None else (desk, document, self.values(desk))

    # --- diagnostics ---------------------------------------------------------------------------------------------

    def take(self, uri: str) -> None:
        """Take over the text that an editor has now, and tell later what is wrong with it."""
        path = to_fs_path(uri)
        if path is None:  # a text that is no file yet
            return
        place = Path(path)
        try:
            self.desk(place).open(place, self.workspace.get_text_document(uri).source)
        except ArgumentError as refused:
            self.desk(place).close(place)
            self.publish(place, {uri_of(place.as_posix()): [_whole_file(refused)]})
        else:
            self.tell_later(place)

    def tell_later(self, path: Path) -> None:
        """Tell what is wrong with a document when nothing has changed for a moment."""
        earlier = self.pending.pop(path, None)
        if earlier is not None:
            earlier.cancel()
        self.pending[path] = asyncio.get_running_loop().call_later(PAUSE, self.tell, path)

    def tell(self, path: Path) -> None:
        """Tell what is wrong with a document and with the files that it includes."""
        self.pending.pop(path, None)
        desk = self.desk(path)
        document = desk.documents.find(path)
        if document is None:
            return
        values = self.values(desk)
        found: dict[str, list[lsp.Diagnostic]] = {uri_of(document.file): []}
        try:
            for finding in desk.diagnostics(document):
                file = finding.diagnostic.span.file
                own = document if file == document.file else desk.documents.get(file)
                found.setdefault(uri_of(file), []).append(values.diagnostic(finding, own))
        except PlcgenError as problem:
            found[uri_of(document.file)].append(_whole_file(problem))
        except Exception as problem:  # a bug must not end the server: it is told, and the next edit is another chance
            log.exception("diagnostics of %s", path)
            self.window_log_message(lsp.LogMessageParams(lsp.MessageType.Error, f"plcgen: {problem!r}"))
            return
        self.publish(path, found)

    def publish(self, path: Path, found: dict[str, list[lsp.Diagnostic]]) -> None:
        """Replace what was told because of a document."""
        before = self.told.pop(path, {})
        if found:
            self.told[path] = found
        for uri in {**before, **found}:
            every = {repr(one): one for said in self.told.values() for one in said.get(uri, ())}
            self.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri, list(every.values())))


def _whole_file(problem: PlcgenError) -> lsp.Diagnostic:
    """What keeps a file from being looked at, on its first line."""
    return lsp.Diagnostic(lsp.Range(lsp.Position(0, 0), lsp.Position(0, 0)), str(problem), source="plcgen")


server = Server()


def _at(params: Any) -> tuple[Workspace, Document, Values, int, int] | None:
    """What a request at a position is about; None for a document that is not open."""
    found = server.find(params.text_document.uri)
    if found is None:
        return None
    desk, document, values = found
    return desk, document, values, *values.place(document, params.position)


@server.feature(lsp.TEXT_DOCUMENT_DID_OPEN)
def _opened(params: lsp.DidOpenTextDocumentParams) -> None:
    server.take(params.text_document.uri)


@server.feature(lsp.TEXT_DOCUMENT_DID_CHANGE)
def _changed(params: lsp.DidChangeTextDocumentParams) -> None:
    server.take(params.text_document.uri)


@server.feature(lsp.TEXT_DOCUMENT_DID_CLOSE)
def _closed(params: lsp.DidCloseTextDocumentParams) -> None:
    path = to_fs_path(params.text_document.uri)
    if path is not None:
        place = Path(path)
        earlier = server.pending.pop(place, None)
        if earlier is not None:
            earlier.cancel()
        server.desk(place).close(place)
        server.publish(place, {})


@server.feature(lsp.TEXT_DOCUMENT_DID_SAVE)
def _saved(params: lsp.DidSaveTextDocumentParams) -> None:
    del params
    _all_again()


@server.feature(lsp.WORKSPACE_DID_CHANGE_WATCHED_FILES)
def _files_changed(params: lsp.DidChangeWatchedFilesParams) -> None:
    del params
    _all_again()


def _all_again() -> None:
    """Files on disk are others: everything that is open is looked at again."""
    for desk in server.desks:
        desk.changed()
        for document in desk.documents:
            server.tell_later(document.path)


@server.feature(lsp.TEXT_DOCUMENT_COMPLETION, lsp.CompletionOptions(trigger_characters=list(' :[{,-$"#.')))
def _completion(params: lsp.CompletionParams) -> lsp.CompletionList:
    found = _at(params)
    if found is None:
        return lsp.CompletionList(is_incomplete=False, items=[])
    desk, document, values, line, column = found
    offers = desk.complete(document, line, column)
    items = [values.item(offer, number, document) for number, offer in enumerate(offers)]
    more = len(items) >= MOST or any(offer.kind == "parameter" for offer in offers)
    return lsp.CompletionList(is_incomplete=more, items=items)


@server.feature(lsp.TEXT_DOCUMENT_HOVER)
def _hover(params: lsp.HoverParams) -> lsp.Hover | None:
    found = _at(params)
    if found is None:
        return None
    desk, document, values, line, column = found
    known = desk.hover(document, line, column)
    if known is None:
        return None
    content = lsp.MarkupContent(lsp.MarkupKind.Markdown, markdown(known.page))
    return lsp.Hover(content, values.range(known.span, document))


@server.feature(lsp.TEXT_DOCUMENT_SIGNATURE_HELP, lsp.SignatureHelpOptions(trigger_characters=["(", ","]))
def _signature(params: lsp.SignatureHelpParams) -> lsp.SignatureHelp | None:
    found = _at(params)
    known = None if found is None else found[0].signature(found[1], found[3], found[4])
    if known is None:
        return None
    parameters = [lsp.ParameterInformation(one.text, one.section) for one in known.parameters]
    shown = lsp.SignatureInformation(known.label, known.text or None, parameters)
    return lsp.SignatureHelp([shown], 0, known.active)


@server.feature(lsp.TEXT_DOCUMENT_DEFINITION)
def _definition(params: lsp.DefinitionParams) -> lsp.Location | None:
    found = _at(params)
    if found is None:
        return None
    desk, document, values, line, column = found
    place = desk.definition(document, line, column)
    return None if place is None else values.location(place)


@server.feature(lsp.TEXT_DOCUMENT_REFERENCES)
def _references(params: lsp.ReferenceParams) -> list[lsp.Location]:
    found = _at(params)
    if found is None:
        return []
    desk, document, values, line, column = found
    places = desk.references(document, line, column)
    home = None if params.context.include_declaration else desk.definition(document, line, column)
    declared = home and (home.file, home.line)
    return [values.location(place) for place in places if (place.file, place.line) != declared]


@server.feature(lsp.TEXT_DOCUMENT_PREPARE_RENAME)
def _prepare_rename(params: lsp.PrepareRenameParams) -> lsp.Range | None:
    found = _at(params)
    if found is None:
        return None
    desk, document, values, line, column = found
    place = desk.name_at(document, line, column)
    return None if place is None else values.range(place, document)


@server.feature(lsp.TEXT_DOCUMENT_RENAME, lsp.RenameOptions(prepare_provider=True))
def _rename(params: lsp.RenameParams) -> lsp.WorkspaceEdit | None:
    found = _at(params)
    if found is None:
        return None
    desk, document, values, line, column = found
    try:
        return values.edits(desk.rename(document, line, column, params.new_name))
    except DiagnosticError as refused:
        told = refused.diagnostics[0]
        raise JsonRpcException(f"{told.message}: {told.help}" if told.help else told.message, FAILED) from None
    except PlcgenError as refused:
        raise JsonRpcException(str(refused), FAILED) from None


@server.feature(lsp.TEXT_DOCUMENT_CODE_ACTION, lsp.CodeActionOptions(code_action_kinds=[lsp.CodeActionKind.QuickFix]))
def _code_actions(params: lsp.CodeActionParams) -> list[lsp.CodeAction]:
    found = server.find(params.text_document.uri)
    if found is None:
        return []
    desk, document, values = found
    first, last = params.range.start.line + 1, params.range.end.line + 1
    return [
        lsp.CodeAction(
            title=fix.title,
            kind=lsp.CodeActionKind.QuickFix,
            diagnostics=[values.diagnostic(finding, document)],
            edit=values.edits(fix.edits),
        )
        for finding in desk.diagnostics(document)
        if finding.diagnostic.span.file == document.file and first <= finding.diagnostic.span.line <= last
        for fix in finding.fixes
    ]


@server.feature(lsp.TEXT_DOCUMENT_FORMATTING)
def _formatting(params: lsp.DocumentFormattingParams) -> list[lsp.TextEdit]:
    found = server.find(params.text_document.uri)
    if found is None:
        return []
    desk, document, values = found
    return [values.edit(edit, document) for edit in desk.format(document)]


@server.feature(lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
def _symbols(params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol]:
    found = server.find(params.text_document.uri)
    if found is None:
        return []
    desk, document, values = found
    return [values.symbol(symbol, document) for symbol in desk.outline(document)]


@server.feature(
    lsp.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL, lsp.SemanticTokensLegend(token_types=list(TOKEN_KINDS), token_modifiers=[])
)
def _colours(params: lsp.SemanticTokensParams) -> lsp.SemanticTokens:
    found = server.find(params.text_document.uri)
    if found is None:
        return lsp.SemanticTokens([])
    desk, document, values = found
    data: list[int] = []
    last = 0
    for first, painted in desk.tokens(document):
        packed, end = values.packed(painted)
        if packed:
            data += (first + packed[0] - last, *packed[1:])
            last = first + end
    return lsp.SemanticTokens(data)
