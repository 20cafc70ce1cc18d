"""Nine jobs done in an editor that knows nothing of plcgen but its language server: what is typed, and what is chosen.

Each begins with an empty file and ends with files that pass a verification without faults.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest
from lsprotocol import types as lsp

from plcgen import api
from tests.workbench.client import Editor, talk

pytestmark = pytest.mark.slow


@dataclass(frozen=True)
class Task:
    """The PLC, and lines of the spec: ``text`` is typed, ``<label>`` is chosen of what is offered there.

    ``fix`` is the title of the quick fix that is taken at the end, ``seen`` stands in the spec then.
    """

    family: str
    toolchain: str
    lines: tuple[str, ...]
    seen: str
    fix: str = ""


TASKS = {
    "read the speed of a pump": Task(
        "s7-1500", "tia-v19", ("drives:", "  <sinamics-g120>", "jobs:", "  speed:", "    drive: <drive1>",
        "    read: [<r21>, motor temp<r35>]"), "read: [r21, r35]",
    ),
    "set ramps from a panel": Task(
        "s7-1200", "tia-v17", ("drives:", "  <sinamics-g120>", "jobs:", "  <write drive1>"), "write: {P1120: }",
    ),
    "show the fault memory": Task(
        "s7-1500", "tia-v20", ("drives:", "  <sinamics-s120>", "jobs:", "  <messages drive1>"), "faults: current",
    ),
    "save to ROM": Task(
        "s7-1500", "tia-v19", ("drives:", "  <sinamics-s120>", "jobs:", "  <save drive1>"), "save: drive_object",
    ),
    "an MM440 on PROFIBUS": Task(
        "s7-300", "step7-v5", ("drives:", "  <micromaster-4>", "jobs:", "  <read drive1>"), "address: 256",
    ),
    "a DCM with the buffers of the FAQ": Task(
        "s7-300", "tia-v16", ("drives:", "  <sinamics-dcm>", "jobs:", "  ramp:", "    drive: <drive1>",
        "    <names>: <faq>", "    <buffers>: <db>", "    write: {<P50304>: 10.0}"), "buffers: db",
    ),
    "log an S7-200": Task("s7-1200", "tia-v19", ("ppi:", "  <a line>"), "read: [VW100]"),
    "a drive of another maker": Task(
        "s7-1500", "tia-v18", ("drives:", "  <profidrive>", "jobs:", "  set_it:", "    drive: <drive1>",
        "    write: {P64010: 1.0}"), "P64010: {type: FloatingPoint}", "define P64010 in the drive as FloatingPoint",
    ),
    "a recipe": Task(
        "s7-1500", "tia-v21", ("drives:", "  <sinamics-s120>", "recipes:", "  <recipe of drive1>", "jobs:",
        "  <write_recipe drive1>"), "write_recipe: material",
    ),
}  # fmt: skip


class Typing:
    """A file in the editor, and somebody who types at its end."""

    def __init__(self, editor: Editor, path: Path) -> None:
        self.editor, self.text = editor, ""
        self.uri = editor.open(path, "")
        self.document = lsp.TextDocumentIdentifier(self.uri)

    def type(self, text: str) -> None:
        """Type on."""
        self.text += text
        self.editor.type(self.uri, self.text)

    @property
    def here(self) -> lsp.Position:
        """The end of the text."""
        lines = self.text.split("\n")
        return lsp.Position(len(lines) - 1, len(lines[-1]))

    async def choose(self, label: str) -> None:
        """Take something that is offered; it replaces the word that has been begun, up to the cursor."""
        asked = lsp.CompletionParams(self.document, self.here)
        found = await self.editor.text_document_completion_async(asked)
        assert isinstance(found, lsp.CompletionList)
        labels = [one.label for one in found.items]
        assert label in labels, (self.text, labels[:20])
        edit = found.items[labels.index(label)].text_edit
        assert isinstance(edit, lsp.TextEdit)
        self.replace(edit)

    def replace(self, edit: lsp.TextEdit) -> None:
        """Make an edit of the server."""
        lines = self.text.split("\n")
        first, last = edit.range.start, edit.range.end
        before = "\n".join([*lines[: first.line], lines[first.line][: first.character]])
        behind = "\n".join([lines[last.line][last.character :], *lines[last.line + 1 :]])
        self.text = before + edit.new_text + behind
        self.editor.type(self.uri, self.text)

    async def fix(self, title: str) -> None:
        """Take a quick fix."""
        whole = lsp.Range(lsp.Position(0, 0), self.here)
        asked = lsp.CodeActionParams(self.document, whole, lsp.CodeActionContext([]))
        actions = await self.editor.text_document_code_action_async(asked) or []
        (action,) = [one for one in actions if isinstance(one, lsp.CodeAction) and one.title == title]
        assert action.edit is not None
        assert action.edit.changes is not None
        ((edit,),) = action.edit.changes.values()
        assert isinstance(edit, lsp.TextEdit)
        self.replace(edit)


async def done(typing: Typing, task: Task) -> None:
    """Type a spec, and have no error left."""
    typing.type("plc: {name: My station, family: ")
    await typing.choose(task.family)
    typing.type(", toolchain: ")
    await typing.choose(task.toolchain)
    typing.type("}\n")
    for line in task.lines:
        rest = line
        while rest:
            typed, chosen, rest = rest.partition("<")
            typing.type(typed)
            if chosen:
                label, _, rest = rest.partition(">")
                await typing.choose(label)
                rest = rest.removeprefix(": ") if typing.text.endswith(": ") else rest
        typing.type("\n")
    if task.fix:
        await typing.fix(task.fix)
    typing.type("")

    def sound(found: list[lsp.Diagnostic]) -> bool:
        return all(one.severity != lsp.DiagnosticSeverity.Error for one in found)

    await typing.editor.diagnostics(typing.uri, sound)


@pytest.mark.parametrize("name", TASKS)
def test_a_job_is_done(name: str, tmp_path: Path) -> None:
    """The spec says what was wanted; its files are generated and verified."""
    task = TASKS[name]
    spec = tmp_path / "job.yaml"

    async def speak(editor: Editor) -> str:
        typing = Typing(editor, spec)
        await done(typing, task)
        return typing.text

    text = talk(tmp_path, speak)
    assert task.seen in text
    spec.write_text(text, "utf-8")
    made = api.generate(spec)
    assert made.ok, [one.message for one in made.diagnostics]
    assert api.verify(spec, faults="none").ok
