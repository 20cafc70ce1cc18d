"""Explanations: a title and named sections, as text or as data."""

from __future__ import annotations

from dataclasses import dataclass

from plcgen.output.cells import clean, wrap
from plcgen.output.json import dump, head
from plcgen.output.paint import paint


@dataclass(frozen=True, slots=True)
class Page:
    """What a code or number means. Sections are (heading, text); a text with line ends is shown as it is."""

    key: str
    title: str
    sections: tuple[tuple[str, str], ...]


def page_text(page: Page, *, color: bool = False, width: int = 100) -> str:
    """One page; running text is wrapped, examples keep their lines."""
    lines = [f"{paint(page.key, 'bold', color=color)}  {clean(page.title)}"]
    for heading, text in page.sections:
        if not text.strip():
            continue
        lines += ["", paint(heading, "help", color=color)]
        if "\n" in text.strip("\n"):
            lines += [f"  {clean(line)}".rstrip() for line in text.strip("\n").split("\n")]
        else:
            lines += [f"  {line}" for line in wrap(clean(text), min(width, 100) - 2)]
    return "\n".join(lines) + "\n"


def page_json(page: Page) -> str:
    """Write JSON of ``explain``."""
    sections = [{"heading": heading, "text": text} for heading, text in page.sections if text.strip()]
    return dump({**head("explanation", ok=True), "key": page.key, "title": page.title, "sections": sections})
