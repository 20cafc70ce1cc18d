"""A hook of MkDocs: pages outside ``docs`` join the site, and links lead where they lead in the repository."""

from __future__ import annotations

import json
import os
import posixpath
import re
import sys
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


FIELDS = {"title": {"boost": 20}, "text": {"boost": 1}, "about": {"boost": 40}}
"""Where the search looks, and what a word counts there; ``about`` are the words by which people look for a page."""
_LATER = re.compile(r"codes/|adr/|CHANGELOG|s7[.-](?!200)")
"""Pages for somebody who comes from a message or from the source: no answer to a question."""


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
    """Links of the site, and what the page counts in the search: tasks come first, what explains a code last."""
    uri = page.file.src_uri
    page.meta["search"] = {"boost": 0.2 if _LATER.match(uri) else 1.3 if uri.startswith("tasks/") else 1}
    return relinked(markdown, page.file.src_uri)


def on_post_build(config: Any) -> None:
    """Give the search the words of ``docs/words.toml`` and the spellings of ``plcgen docs``."""
    sys.path.insert(0, str(ROOT))  # the package of this checkout, not one installed beside MkDocs
    from plcgen.base import page_search

    site = Path(config["site_dir"])
    index = site / "search" / "search_index.json"
    content = json.loads(index.read_text("utf-8"))
    content["config"]["fields"] = FIELDS
    for entry in content["docs"]:
        page = ROOT / origin(entry["location"].removesuffix(".html") + ".md")
        if page.is_file():
            name = page.relative_to(ROOT / "docs").with_suffix("").as_posix() if "docs" in page.parts else page.stem
            about = page_search.subjects(name, page.read_text("utf-8"))
            entry["about"] = " ".join(stem for stem, value in about.items() for _ in range(1 if value < 10 else 3))
    index.write_text(json.dumps(content, ensure_ascii=False, separators=(",", ":")), "utf-8")
    script = site / "search.js"
    lists = {
        "words": json.dumps(sorted(page_search.common_words()), ensure_ascii=False),
        "endings": f"/{page_search.ENDINGS}/",
        "spelled": ", ".join(f'[/{front}/g, "{instead}"]' for front, instead in page_search.SPELLED),
    }
    text = re.sub(r"/\* (\w+) \*/", lambda found: lists[found[1]], script.read_text("utf-8"))
    script.write_text(text, "utf-8")
