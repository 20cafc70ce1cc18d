"""The language server as an editor sees it: every feature asked over the wire, of specs and of sources."""

from __future__ import annotations

import asyncio
import subprocess
import sys
from pathlib import Path

import pytest
from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException
from pygls.workspace import Workspace as PyglsWorkspace

from tests.workbench.client import Editor, at, talk
from tests.workbench.test_sources import DB, FB, UDT
from tests.workbench.test_specs import HEAD, JOB, NAMES, SHARED

GOOD = HEAD + JOB


def _document(uri: str) -> lsp.TextDocumentIdentifier:
    return lsp.TextDocumentIdentifier(uri)


def test_problems_while_typing(tmp_path: Path) -> None:
    """A mistake is told with place, code and remedy; it goes when it is corrected; closing takes all back."""

    async def speak(editor: Editor) -> None:
        uri = editor.open(tmp_path / "plant.yaml", GOOD)
        notes = await editor.diagnostics(uri, lambda _: True)
        assert not [one for one in notes if one.severity == lsp.DiagnosticSeverity.Error]
        place = lsp.Range(lsp.Position(7, 11), lsp.Position(7, 15))
        editor.type(uri, "pmup", place)
        (found,) = await editor.diagnostics(uri, lambda found: any(one.code == "PG202" for one in found))
        assert (found.range.start, found.range.end) == (place.start, place.end)
        assert found.source == "plcgen"
        assert 'did you mean "pump"?' in found.message
        editor.type(uri, "pump", place)
        await editor.diagnostics(uri, lambda found: not any(one.code == "PG202" for one in found))
        editor.type(uri, "plc: [")
        await editor.diagnostics(uri, lambda found: any(one.code == "PG101" for one in found))
        editor.text_document_did_close(lsp.DidCloseTextDocumentParams(_document(uri)))
        await editor.diagnostics(uri, lambda found: not found)

    talk(tmp_path, speak)


def test_problems_of_an_included_file(tmp_path: Path) -> None:
    """They are told for that file, also while it is not open, and again when it is saved otherwise."""
    shared = tmp_path / "shared.yaml"
    shared.write_text(SHARED.replace("sinamics-g120", "sinamics-g12"), "utf-8")

    async def speak(editor: Editor) -> None:
        editor.open(tmp_path / "plant.yaml", NAMES)
        uri = shared.as_uri()
        await editor.diagnostics(uri, lambda found: [one.code for one in found] == ["PG201", "PG201"])
        shared.write_text(SHARED, "utf-8")
        changed = lsp.FileEvent(uri, lsp.FileChangeType.Changed)
        editor.workspace_did_change_watched_files(lsp.DidChangeWatchedFilesParams([changed]))
        await editor.diagnostics(uri, lambda found: not found)

    talk(tmp_path, speak)


@pytest.mark.slow
@pytest.mark.parametrize(
    "encoding", [lsp.PositionEncodingKind.Utf8, lsp.PositionEncodingKind.Utf16, lsp.PositionEncodingKind.Utf32]
)
def test_columns_behind_wide_characters(tmp_path: Path, encoding: lsp.PositionEncodingKind) -> None:
    """In each encoding that an editor may ask for, the range of a drive's name is where the name stands."""
    text = GOOD.replace("    drive: pump", '    comment: "\U0001f527 泵", drive: pump').replace(
        "set_ramps:\n    ", "set_ramps: {"
    )
    text = text.replace("\n    write: {P1120: 10.0, P1121: 12.5}", ", write: {P1120: 10.0}}")
    before = text[: text.index("pump", text.index("jobs:"))].rsplit("\n", 1)[-1]
    column = {
        lsp.PositionEncodingKind.Utf8: len(before.encode()),
        lsp.PositionEncodingKind.Utf16: len(before.encode("utf-16-le")) // 2,
        lsp.PositionEncodingKind.Utf32: len(before),
    }[encoding]

    async def speak(editor: Editor) -> None:
        uri = editor.open(tmp_path / "plant.yaml", text)
        position = lsp.Position(6, column + 1)
        found = await editor.text_document_prepare_rename_async(lsp.PrepareRenameParams(_document(uri), position))
        assert found == lsp.Range(lsp.Position(6, column), lsp.Position(6, column + 4))

    talk(tmp_path, speak, (encoding,))


def test_completion_hover_definition(tmp_path: Path) -> None:
    """What the service knows comes over the wire, each at its place."""
    (tmp_path / "shared.yaml").write_text(SHARED, "utf-8")

    async def speak(editor: Editor) -> None:
        text, here = at(GOOD.replace("P1121: 12.5", "P112|"))
        uri = editor.open(tmp_path / "plant.yaml", text)
        asked = await editor.text_document_completion_async(lsp.CompletionParams(_document(uri), here))
        assert isinstance(asked, lsp.CompletionList)
        found = {one.label: one for one in asked.items}
        edit = found["P1121"].text_edit
        assert isinstance(edit, lsp.TextEdit)
        assert edit == lsp.TextEdit(lsp.Range(lsp.Position(8, here.character - 4), here), "P1121: ")
        assert "ramp-down" in (found["P1121"].detail or "")
        assert asked.is_incomplete
        text, here = at(GOOD.replace("toolchain", "tool|chain"))
        editor.type(uri, text)
        hover = await editor.text_document_hover_async(lsp.HoverParams(_document(uri), here))
        assert hover is not None
        assert isinstance(hover.contents, lsp.MarkupContent)
        assert "engineering tool" in hover.contents.value
        text, here = at(NAMES.replace("one: {drive: pump", "one: {drive: pu|mp"))
        editor.type(uri, text)
        place = await editor.text_document_definition_async(lsp.DefinitionParams(_document(uri), here))
        assert isinstance(place, lsp.Location)
        assert (Path(place.uri).name, place.range.start) == ("shared.yaml", lsp.Position(1, 2))

    talk(tmp_path, speak)


def test_names_fixes_layout_outline(tmp_path: Path) -> None:
    """Rename over files, a quick fix, formatting, references, the outline; a rename that is refused says why."""
    (tmp_path / "shared.yaml").write_text(SHARED, "utf-8")

    async def speak(editor: Editor) -> None:
        text, here = at(NAMES.replace("one: {drive: pump", "one: {drive: pu|mp"))
        uri = editor.open(tmp_path / "plant.yaml", text)
        renamed = await editor.text_document_rename_async(lsp.RenameParams(_document(uri), here, "feed"))
        assert renamed is not None
        assert renamed.changes is not None
        assert {Path(uri).name: len(edits) for uri, edits in renamed.changes.items()} == {
            "plant.yaml": 4,  # both values of variables, a job, a quoted item
            "shared.yaml": 1,
        }
        with pytest.raises(JsonRpcException, match="already"):
            await editor.text_document_rename_async(lsp.RenameParams(_document(uri), here, "axis"))
        context = lsp.ReferenceContext(include_declaration=True)
        places = await editor.text_document_references_async(
            lsp.ReferenceParams(context=context, text_document=_document(uri), position=here)
        )
        assert places is not None
        assert len(places) == 5  # the definition, two jobs, an item in quotes, an item of a variable
        uses = await editor.text_document_references_async(
            lsp.ReferenceParams(
                context=lsp.ReferenceContext(include_declaration=False), text_document=_document(uri), position=here
            )
        )
        assert uses is not None
        assert [one for one in places if one not in uses] == [one for one in places if one.uri.endswith("shared.yaml")]
        editor.type(uri, GOOD.replace("write", "wirte"))
        line = lsp.Range(lsp.Position(8, 0), lsp.Position(8, 1))
        asked = lsp.CodeActionParams(_document(uri), line, lsp.CodeActionContext([]))
        actions = await editor.text_document_code_action_async(asked)
        assert actions is not None
        (action,) = actions
        assert isinstance(action, lsp.CodeAction)
        assert action.edit is not None
        assert action.edit.changes is not None
        ((edit,),) = action.edit.changes.values()
        assert edit.new_text == "write"
        editor.type(uri, GOOD.replace("    drive", "        drive").replace("    write", "        write"))
        options = lsp.FormattingOptions(tab_size=2, insert_spaces=True)
        edits = await editor.text_document_formatting_async(lsp.DocumentFormattingParams(_document(uri), options))
        assert edits is not None
        assert edits[0].new_text == JOB.split("\n", 1)[1]
        editor.type(uri, GOOD)
        symbols = await editor.text_document_document_symbol_async(lsp.DocumentSymbolParams(_document(uri)))
        assert symbols is not None
        assert [one.name for one in symbols] == ["plc", "drives", "jobs"]

    talk(tmp_path, speak)


@pytest.mark.slow
def test_a_request_that_fails_ends_nothing(tmp_path: Path) -> None:
    """Places that are nowhere, documents that are not open, names of no file, halves of characters: it goes on."""

    async def speak(editor: Editor) -> None:
        uri = editor.open(tmp_path / "plant.yaml", GOOD)
        for place in (lsp.Position(9999, 0), lsp.Position(0, 9999)):
            await editor.text_document_hover_async(lsp.HoverParams(_document(uri), place))
        for other in ("untitled:Untitled-1", (tmp_path / "none.yaml").as_uri(), "http://example.com/x.yaml"):
            asked = lsp.HoverParams(_document(other), lsp.Position(0, 0))
            assert await editor.text_document_hover_async(asked) is None
            symbols = await editor.text_document_document_symbol_async(lsp.DocumentSymbolParams(_document(other)))
            assert not symbols
        editor.text_document_did_open(
            lsp.DidOpenTextDocumentParams(lsp.TextDocumentItem("untitled:Untitled-1", "yaml", 1, GOOD))
        )
        with pytest.raises(JsonRpcException):
            await editor.protocol.send_request_async("textDocument/nothing", None)
        editor.type(uri, "plc: {name: \ud83d}\n")
        assert await editor.diagnostics(uri, lambda found: any(one.severity == 1 for one in found))

    talk(tmp_path, speak)


def test_sources(tmp_path: Path) -> None:
    """Problems, hover, signature, colours and outline of a source over the wire."""
    (tmp_path / "point.udt").write_text(UDT, "utf-8")
    (tmp_path / "plant.db").write_text(DB, "utf-8")

    async def speak(editor: Editor) -> None:
        text, here = at(FB.replace("points[2].y", "points[2].|y"))
        uri = editor.open(tmp_path / "mover.scl", text, "scl")
        hover = await editor.text_document_hover_async(lsp.HoverParams(_document(uri), here))
        assert hover is not None
        assert isinstance(hover.contents, lsp.MarkupContent)
        assert "offset: 12.0" in hover.contents.value
        colours = await editor.text_document_semantic_tokens_full_async(lsp.SemanticTokensParams(_document(uri)))
        assert colours is not None
        legend = ["keyword", "variable", "string", "number", "comment", "operator", "function", "type", "property"]
        assert [*colours.data[:5]] == [0, 0, len("FUNCTION_BLOCK"), legend.index("keyword"), 0]
        assert [*colours.data[5:9]] == [0, len("FUNCTION_BLOCK "), len('"Mover"'), 9]
        symbols = await editor.text_document_document_symbol_async(lsp.DocumentSymbolParams(_document(uri)))
        assert symbols is not None
        assert [one.name for one in symbols] == ["Mover"]
        text, here = at(FB.replace("MX := 10.0", "MX := |10.0"))
        editor.type(uri, text)
        help_ = await editor.text_document_signature_help_async(lsp.SignatureHelpParams(_document(uri), here))
        assert help_ is not None
        assert (help_.signatures[0].label, help_.active_parameter) == ("LIMIT(MN, IN, MX)", 2)
        editor.type(uri, FB.replace("+ 1;", "+ ;"))
        await editor.diagnostics(uri, lambda found: [one.code for one in found] == ["PG801"])

    talk(tmp_path, speak)


def test_without_an_editor() -> None:
    """Closed input ends the server at once, without a trace back; started in a terminal it says what it is."""
    done = subprocess.run(
        [sys.executable, "-m", "plcgen", "lsp"], stdin=subprocess.DEVNULL, capture_output=True, timeout=60, check=False
    )
    assert done.returncode == 0
    assert b"Traceback" not in done.stderr


def test_without_pygls(monkeypatch: pytest.MonkeyPatch) -> None:
    """The verb says the one line that installs what is missing."""
    from click.testing import CliRunner

    from plcgen.cli import lsp as verb

    monkeypatch.setattr(verb, "find_spec", lambda _: None)
    result = CliRunner().invoke(verb.command, [])
    assert result.exit_code == 2
    assert "pip install pygls" in result.output


def test_edits_leave_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """10,000 edits without a pause are answered once; afterwards nothing waits, and one document is known."""
    from plcgen.workbench.lsp.server import Server

    monkeypatch.setattr("plcgen.workbench.lsp.server.PAUSE", 0.01)
    uri = (tmp_path / "plant.yaml").as_uri()

    async def type_() -> tuple[Server, list[lsp.PublishDiagnosticsParams]]:
        server = Server()
        server.protocol._workspace = PyglsWorkspace(tmp_path.as_uri())
        told: list[lsp.PublishDiagnosticsParams] = []
        heard = asyncio.Event()
        monkeypatch.setattr(server, "text_document_publish_diagnostics", lambda one: told.append(one) or heard.set())
        for n in range(10_000):
            server.workspace.put_text_document(lsp.TextDocumentItem(uri, "yaml", n, f"{GOOD}# {n}\n"))
            server.take(uri)
        await asyncio.wait_for(heard.wait(), 60)
        return server, told

    server, told = asyncio.run(type_())
    assert [one.uri for one in told] == [uri]
    assert (len(server.pending), len(server.told), len(server.desks)) == (0, 1, 1)
    assert [document.text[-6:] for document in server.desks[0].documents] == [" 9999\n"]


def test_what_is_too_large_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A text beyond the bound of a file is one diagnostic on its first line, and is not kept."""
    from plcgen.workbench.lsp.server import Server

    monkeypatch.setattr("plcgen.workbench.service.documents.MAX_BYTES", 100)
    server = Server()
    server.protocol._workspace = PyglsWorkspace(tmp_path.as_uri())
    told: list[lsp.PublishDiagnosticsParams] = []
    monkeypatch.setattr(server, "text_document_publish_diagnostics", told.append)
    uri = (tmp_path / "plant.yaml").as_uri()
    server.workspace.put_text_document(lsp.TextDocumentItem(uri, "yaml", 1, GOOD))
    server.take(uri)
    assert ["larger" in one.message for one in told[-1].diagnostics] == [True]
    assert not list(server.desks[0].documents)
