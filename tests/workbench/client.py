"""An editor without a screen: a client of the language server in a process of its own."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any, TypeVar

from lsprotocol import types as lsp
from pygls.lsp.client import LanguageClient
from pygls.uris import from_fs_path

Result = TypeVar("Result")
PATIENCE = 20


class Editor(LanguageClient):
    """Opens files, types into them, and keeps what the server says of them."""

    def __init__(self) -> None:
        super().__init__("editor", "1")
        self.said: dict[str, list[lsp.Diagnostic]] = {}
        self.heard = asyncio.Event()
        self.messages: list[str] = []
        self.versions: dict[str, int] = {}

    async def diagnostics(self, uri: str, wanted: Callable[[list[lsp.Diagnostic]], bool]) -> list[lsp.Diagnostic]:
        """What is said of a file, as soon as it is what is wanted."""

        async def wait() -> list[lsp.Diagnostic]:
            while uri not in self.said or not wanted(self.said[uri]):
                self.heard.clear()
                await self.heard.wait()
            return self.said[uri]

        return await asyncio.wait_for(wait(), PATIENCE)

    def open(self, path: Path, text: str, language: str = "yaml") -> str:
        """Open a file with a text; its URI."""
        uri = from_fs_path(str(path)) or ""
        self.text_document_did_open(lsp.DidOpenTextDocumentParams(lsp.TextDocumentItem(uri, language, 1, text)))
        self.versions[uri] = 1
        return uri

    def type(self, uri: str, text: str, place: lsp.Range | None = None) -> None:
        """Replace a part of the text, or all of it."""
        self.versions[uri] += 1
        change: Any = lsp.TextDocumentContentChangeWholeDocument(text)
        if place is not None:
            change = lsp.TextDocumentContentChangePartial(place, text)
        document = lsp.VersionedTextDocumentIdentifier(self.versions[uri], uri)
        self.text_document_did_change(lsp.DidChangeTextDocumentParams(document, [change]))


def at(text: str) -> tuple[str, lsp.Position]:
    """A text without its cursor ``|``, and the position of that, in UTF-16."""
    before, _, after = text.partition("|")
    line = before.rsplit("\n", 1)[-1]
    return before + after, lsp.Position(before.count("\n"), len(line.encode("utf-16-le")) // 2)


def talk(
    folder: Path,
    speak: Callable[[Editor], Awaitable[Result]],
    encodings: tuple[lsp.PositionEncodingKind, ...] = (lsp.PositionEncodingKind.Utf16,),
) -> Result:
    """Start ``plcgen lsp`` in a folder, speak to it, end it as an editor does."""

    async def session() -> Result:
        editor = Editor()

        @editor.feature(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        def heard(params: lsp.PublishDiagnosticsParams) -> None:
            editor.said[params.uri] = list(params.diagnostics)
            editor.heard.set()

        @editor.feature(lsp.WINDOW_LOG_MESSAGE)
        def logged(params: lsp.LogMessageParams) -> None:
            editor.messages.append(params.message)

        await editor.start_io(sys.executable, "-m", "plcgen", "lsp", cwd=str(folder))
        general = lsp.GeneralClientCapabilities(position_encodings=list(encodings))
        root = from_fs_path(str(folder)) or ""
        folders = [lsp.WorkspaceFolder(root, "folder")]
        asked = lsp.InitializeParams(
            lsp.ClientCapabilities(general=general), process_id=None, root_uri=root, workspace_folders=folders
        )
        await editor.initialize_async(asked)
        editor.initialized(lsp.InitializedParams())
        try:
            return await asyncio.wait_for(speak(editor), PATIENCE)
        finally:
            await editor.shutdown_async(None)
            editor.exit(None)
            await editor.stop()

    return asyncio.run(session())
