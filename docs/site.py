"""A hook of MkDocs: pages outside ``docs`` join the site, and links lead where they lead in the repository."""

from __future__ import annotations

import os
import posixpath
import re
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
PAGES = {
    "README.md": "index.md",
    "README.de.md": "README.de.md",
    "README.zh.md": "README.zh.md",
    "plcgen/s7/README.md": "s7.md",
    "plcgen/s7/layout/README.md": "s7-layout.md",
    "plcgen/s7/memory/README.md": "s7-memory.md",
    "tests/engine/README.md": "engine.md",
    "examples/README.md": "examples.md",
    "templates/README.md": "templates.md",
    "CHANGELOG.md": "CHANGELOG.md",
}
"""Where the pages outside ``docs`` stand in the site."""
FOLDERS = {"docs/adr": "docs/architecture.md", "docs/codes": "docs/codes/README.md", "specs/devices": "docs/devices.md"}
"""The page for a folder; for one of the examples it is theirs."""
_LINK = re.compile(r"(\]\()([^)#\s]+)(#[^)\s]*)?(\))")
_FENCE = re.compile(r"^(```.*?^```)", re.MULTILINE | re.DOTALL)


BOOSTS = {
    "codes/": 0.2,
    "adr/": 0.2,
    "CHANGELOG": 0.2,
    "evidence": 0.5,
    "s7-layout": 0.3,
    "s7-memory": 0.3,
    "s7.": 0.3,
    "tasks/": 2,
}
"""What a page counts in the search, by the front of its address: tasks come first, what explains a code last."""


def origin(uri: str) -> str:
    """Path in the repository of a page of the site."""
    return next((path for path, page in PAGES.items() if page == uri), f"docs/{uri}")


def target(path: str) -> str:
    """Page or file of the site for a path of the repository."""
    path = FOLDERS.get(path, path)
    if path in PAGES:
        return PAGES[path]
    if path.split("/", 1)[0] == "examples":
        return PAGES["examples/README.md"]
    return path.removeprefix("docs/")


def relinked(markdown: str, uri: str) -> str:
    """A page with its relative links as they are in the site; what stands in fences is left alone."""

    def link(found: re.Match[str]) -> str:
        start, address, anchor, end = found.groups()
        if "://" in address or address.startswith("mailto:"):
            return found[0]
        path = posixpath.normpath(posixpath.join(posixpath.dirname(origin(uri)), address))
        there = posixpath.relpath(target(path), posixpath.dirname(uri) or ".")
        return f"{start}{there}{anchor or ''}{end}"

    parts = _FENCE.split(markdown)
    return "".join(part if part.startswith("```") else _LINK.sub(link, part) for part in parts)


def on_files(files: Any, config: Any) -> Any:
    """Add the pages outside ``docs``, and the specs that pages name."""
    from mkdocs.structure.files import File

    for path, uri in PAGES.items():
        files.append(File.generated(config, uri, content=(ROOT / path).read_text("utf-8")))
    for folder, _, names in os.walk(ROOT / "specs"):
        for name in names:
            place = Path(folder, name)
            files.append(File.generated(config, place.relative_to(ROOT).as_posix(), abs_src_path=str(place)))
    for name in ("LICENSE", "pyproject.toml"):
        files.append(File.generated(config, name, abs_src_path=str(ROOT / name)))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Links of the site, and what the page counts in the search."""
    boost = next((value for front, value in BOOSTS.items() if page.file.src_uri.startswith(front)), 1)
    page.meta["search"] = {"boost": boost}
    return relinked(markdown, page.file.src_uri)
