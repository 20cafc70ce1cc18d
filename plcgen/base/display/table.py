"""Plain tables in four spellings: aligned text, Markdown, CSV and (through ``json``) data."""

from __future__ import annotations

from collections.abc import Sequence

from plcgen.base.display.cells import clean, pad, width, wrap

Row = Sequence[str]

_NARROW = 16


def text_table(
    header: Row, rows: Sequence[Row], *, right: frozenset[int] = frozenset(), indent: int = 2, limit: int = 0
) -> list[str]:
    """Align columns; those in ``right`` to the right. ``limit`` (0: none) wraps the last column.

    One item a row, header first; a wrapped row has line ends inside.
    """
    cleaned = [[clean(cell) for cell in row] for row in [header, *rows]]
    widths = [max(width(row[n]) for row in cleaned) for n in range(len(header))]
    margin = indent + sum(widths[:-1]) + 2 * (len(widths) - 1)
    lines = []
    for row in cleaned:
        cells = [
            " " * (widths[n] - width(cell)) + cell if n in right else pad(cell, widths[n])
            for n, cell in enumerate(row[:-1])
        ]
        last = wrap(row[-1], max(limit - margin, _NARROW)) if limit else [row[-1]]
        first = (" " * indent + "  ".join([*cells, last[0]])).rstrip()
        lines.append("\n".join([first, *(" " * margin + line for line in last[1:])]))
    return lines


def markdown_table(header: Row, rows: Sequence[Row], *, right: frozenset[int] = frozenset()) -> list[str]:
    """Write a GitHub Markdown table."""
    rule = ["---:" if n in right else "---" for n in range(len(header))]
    return [_markdown(header), "|" + "|".join(rule) + "|", *(_markdown(row) for row in rows)]


def _markdown(row: Row) -> str:
    cells = [
        clean(cell).replace("\\", "\\\\").replace("|", "\\|").replace("&", "&amp;").replace("<", "&lt;") for cell in row
    ]
    return "| " + " | ".join(cells) + " |"


def csv_table(header: Row, rows: Sequence[Row], separator: str = ",") -> str:
    """Write CSV (RFC 4180 quoting, LF line ends); a leading = + - @ is quoted so that no sheet computes it."""
    special = {separator, '"', "\r", "\n"}
    return "".join(separator.join(_csv(cell, special) for cell in row) + "\n" for row in [header, *rows])


def _csv(cell: str, special: set[str]) -> str:
    if not cell:
        return cell
    if cell[0] in "=@\t\r" or (cell[0] in "+-" and not _number(cell)):
        cell = f"'{cell}"
    quoted = not special.isdisjoint(cell)
    return '"' + cell.replace('"', '""') + '"' if quoted else cell


def _number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
