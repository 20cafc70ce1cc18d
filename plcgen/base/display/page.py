"""Explanations: a title and named sections, as text or as data."""

from __future__ import annotations

from dataclasses import dataclass

from plcgen.base.display.cells import clean, wrap
from plcgen.base.display.data import head
from plcgen.base.display.results import Answer
from plcgen.base.display.view import View


@dataclass(frozen=True, slots=True)
class Page:
    """What a code or number means. Sections are (heading, text); a text with line ends is shown as it is."""

    key: str
    title: str
    sections: tuple[tuple[str, str], ...]


def page_text(page: Page, view: View) -> str:
    """One page; running text is wrapped, examples keep their lines."""
    lines = [f"{view.paint(page.key, 'bold')}  {clean(page.title)}"]
    for heading, text in page.sections:
        if not text.strip():
            continue
        lines += ["", view.paint(heading, "help")]
        if "\n" in text.strip("\n"):
            lines += [f"  {clean(line)}".rstrip() for line in text.strip("\n").split("\n")]
        else:
            lines += [f"  {line}" for line in wrap(clean(text), min(view.width, 100) - 2)]
    return "\n".join(lines) + "\n"


def page_answer(page: Page) -> Answer:
    """Answer of ``explain``."""
    sections = [{"heading": heading, "text": text} for heading, text in page.sections if text.strip()]
    data = {**head("explanation", ok=True), "key": page.key, "title": page.title, "sections": sections}
    return Answer(data, lambda view: page_text(page, view))
