"""The files of the page; the bundle of the editor is made of CodeMirror when the wheel is built (``make editor``)."""

from __future__ import annotations

from pathlib import Path

FOLDER = Path(__file__).parent
TYPES = {".js": "text/javascript; charset=utf-8", ".css": "text/css; charset=utf-8"}
EDITOR = "codemirror.bundle.js"


def has_editor() -> bool:
    """Whether the bundle is there: a checkout may not have it."""
    return (FOLDER / EDITOR).is_file()


def asset(name: str) -> tuple[bytes, str] | None:
    """Bytes and type of a file of the page; None if there is none of that name."""
    path = FOLDER / name
    if path.parent != FOLDER or path.suffix not in TYPES or not path.is_file():
        return None
    return path.read_bytes(), TYPES[path.suffix]
