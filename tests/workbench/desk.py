"""A document with a cursor: ``|`` in a text is where the cursor stands."""

from __future__ import annotations

from pathlib import Path

from plcgen.workbench.service import Document, Edit, Workspace

CURSOR = "|"


class Desk:
    """A workspace with one document after the other in it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.workspace = Workspace(folder)

    def open(self, text: str, name: str = "plant.yaml") -> tuple[Document, int, int]:
        """Open a text; the document without its cursor, and where that was."""
        before, _, after = text.partition(CURSOR)
        document = self.workspace.open(self.folder / name, before + after)
        return document, before.count("\n") + 1, len(before) - (before.rfind("\n") + 1) + 1

    def offers(self, text: str, name: str = "plant.yaml") -> dict[str, tuple[str, str]]:
        """What is offered at the cursor: what each offer inserts, and its detail."""
        found = self.workspace.complete(*self.open(text, name))
        return {one.label: (one.edit.text, one.detail) for one in found}

    def hover(self, text: str, name: str = "plant.yaml") -> str:
        """Everything that is shown at the cursor, in one text."""
        found = self.workspace.hover(*self.open(text, name))
        if found is None:
            return ""
        page = found.page
        return "\n".join([f"{page.key}: {page.title}", *(f"{heading}: {said}" for heading, said in page.sections)])


def edited(text: str, edits: tuple[Edit, ...]) -> str:
    """A text after edits."""
    lines = text.split("\n")
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line) + 1)
    for edit in sorted(edits, key=lambda one: (one.span.line, one.span.column), reverse=True):
        span = edit.span
        first, last = starts[span.line - 1] + span.column - 1, starts[span.end_line - 1] + span.end_column - 1
        text = text[:first] + edit.text + text[last:]
    return text
