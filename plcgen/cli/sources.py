"""Source lines for excerpts: files read once, when a diagnostic first needs them."""

from __future__ import annotations

import re
from pathlib import Path

from plcgen.base.files.files import read_bounded

_MAX_BYTES = 64 * 1024 * 1024
_LINE_END = re.compile("\r\n|[\n\r\x85\u2028\u2029]")
"""Line ends as YAML counts them."""


class SourceCache:
    """Gives any line of any readable text file; ``known`` holds texts that are no files (stdin, arguments)."""

    def __init__(self, known: dict[str, str] | None = None) -> None:
        self._lines: dict[str, list[str]] = {name: _LINE_END.split(text) for name, text in (known or {}).items()}

    def line(self, file: str, number: int) -> str | None:
        """Return line ``number`` (from 1) without its end; None if there is none."""
        lines = self._lines.get(file)
        if lines is None:
            lines = self._lines[file] = _LINE_END.split(_read(Path(file)))
        return lines[number - 1] if 1 <= number <= len(lines) else None


def _read(path: Path) -> str:
    try:
        data = read_bounded(path, _MAX_BYTES)
    except OSError:
        return ""
    if len(data) > _MAX_BYTES:
        return ""
    try:
        if b"\0" not in data:
            return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        pass
    from plcgen.s7.read.text import decode_source

    text = decode_source(data, str(path))
    return text if isinstance(text, str) else data.decode("cp1252", "replace")
