"""A spec laid out evenly: two spaces for each level, no spaces at line ends; comments, order and values stay."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Report, Span
from plcgen.base.files.yaml import parse_yaml
from plcgen.workbench.service.results import Edit

if TYPE_CHECKING:
    from plcgen.workbench.service.documents import Document

_KEY = re.compile(r"""(?:"[^"]*"|'[^']*'|[^\s"'#{}\[\],&*!|>%@`][^#]*?)\s*:(?=\s|$)""")
_BLOCK = re.compile(r"[|>][-+0-9]*\s*(?:#.*)?\Z")
STEP = 2


def formatted(document: Document) -> tuple[Edit, ...]:
    """The edits, line by line; none if the text is broken, or would mean anything else afterwards."""
    before = _meaning(document.text)
    if before is None:
        return ()
    lines = [line.rstrip(" \t") for line in document.lines]
    indented = _indented(lines)
    for laid in (_squeezed(indented), indented, _squeezed(lines)):
        text = "\n".join(laid).rstrip("\n") + "\n"
        if _meaning(text) == before and _comments(text) == _comments(document.text):
            return difference(document, text)
    return ()


def _meaning(text: str) -> object:
    report = Report()
    root = parse_yaml(text, "", report)
    return None if root is None or report.has_errors else (root.data(), [each.raw for each in root.walk()])


def _comments(text: str) -> list[str]:
    return [line.partition("#")[2].strip() for line in text.splitlines() if "#" in line]


def _squeezed(lines: list[str]) -> list[str]:
    """Without empty lines at both ends, and with one where there were several."""
    found: list[str] = []
    for line in lines:
        if line or (found and found[-1]):
            found.append(line)
    while found and not found[-1]:
        found.pop()
    return found


def _indented(lines: list[str]) -> list[str]:
    """Every block two spaces deeper than the one it stands in; what goes on over several lines moves as a whole."""
    found: list[str] = []
    levels: list[tuple[int, int]] = []
    carried: tuple[int, int] | None = None
    """Column above which a text or bracket of several lines goes on, and by how much it moves."""
    depth = 0
    comments: list[tuple[int, int, dict[int, int]]] = []
    """Line, its column, and the levels of the block that it comes after: a column and where it goes."""
    for line in lines:
        text = line.lstrip(" ")
        column = len(line) - len(text)
        if not text or (carried is not None and (column > carried[0] or depth > 0)):
            moved = carried[1] if carried is not None and text else 0
            found.append(f"{' ' * max(column + moved, 0)}{text}")
            depth += _opened(text) if depth > 0 else 0
            continue
        carried = None
        if text.startswith("#"):
            comments.append((len(found), column, dict(levels)))
            found.append(line)
            continue
        while levels and levels[-1][0] > column:
            levels.pop()
        if not levels or levels[-1][0] < column:
            own = levels[-1][1] + STEP if levels else 0
            levels.append((column, own))
        own = levels[-1][1]
        for (
            at,
            place,
            above,
        ) in comments:  # of the block that ends there if it is as deep, else of the line that follows
            deep = above[place] if place > column and place in above else own
            found[at] = f"{' ' * deep}{found[at].lstrip(' ')}"
        comments = []
        found.append(f"{' ' * own}{text}")
        inner = column
        while text.startswith("- "):
            rest = text[1:].lstrip(" ")
            inner += len(text) - len(rest)
            own += len(text) - len(rest)
            text = rest
            levels.append((inner, own))
        depth = max(_opened(text), 0)
        if depth or _BLOCK.search(text) or not _KEY.match(text):
            carried = (column, own - inner)
    return found


def _opened(text: str) -> int:
    """How many more brackets a line opens than it closes, quotes and comments left aside."""
    bare = re.sub(r""""(?:[^"\\]|\\.)*"|'[^']*'|(?:^|\s)#.*""", "", text)
    return sum(bare.count(mark) for mark in "[{") - sum(bare.count(mark) for mark in "]}")


def difference(document: Document, text: str) -> tuple[Edit, ...]:
    """What makes the lines of a document those of a text: one edit, from the first line that differs to the last."""
    old, new = list(document.lines), text.split("\n")
    first = next(
        (n for n, (one, other) in enumerate(zip(old, new, strict=False)) if one != other), min(len(old), len(new))
    )
    if first == len(old) == len(new):
        return ()
    same = 0
    while same < min(len(old), len(new)) - first and old[-1 - same] == new[-1 - same]:
        same += 1
    last = len(old) - same
    end_of_line = "\r\n" if "\r\n" in document.text else "\n"
    part = end_of_line.join(new[first : len(new) - same])
    if same:
        end = (last + 1, 1)
        part += end_of_line if len(new) - same > first else ""
    else:
        end = (len(old), len(old[-1]) + 1)
    if first == len(old):  # a line end is missing
        end_place = Span(document.file, len(old), len(old[-1]) + 1, len(old), len(old[-1]) + 1)
        return (Edit(end_place, f"{end_of_line}{part}"),)
    return (Edit(Span(document.file, first + 1, 1, *end), part),)
