"""Colours as a flag, never as a guess: who calls decides whether there is a terminal."""

from __future__ import annotations

_CODES = {
    "error": "1;31", "warning": "1;33", "note": "1;36", "ok": "32", "not run": "2", "gutter": "1;34",
    "bold": "1", "dim": "2", "help": "1;36", "added": "32", "removed": "31", "hunk": "36",
}  # fmt: skip


def paint(text: str, style: str, *, color: bool) -> str:
    """Wrap text in the ANSI codes of a style, or return it as it is; the style may be empty."""
    return f"\x1b[{_CODES[style]}m{text}\x1b[0m" if color and text and style else text


def paint_diff(diff: str, *, color: bool) -> str:
    """Colour a unified diff line by line."""
    if not color:
        return diff
    return "".join(_diff_line(line) for line in diff.splitlines(keepends=True))


def _diff_line(line: str) -> str:
    body = line.rstrip("\r\n")
    end = line[len(body) :]
    if line.startswith(("---", "+++")):
        return paint(body, "bold", color=True) + end
    style = {"+": "added", "-": "removed", "@": "hunk"}.get(line[:1])
    return (paint(body, style, color=True) if style else body) + end
