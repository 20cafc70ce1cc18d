"""The outline of a YAML text that may be broken: every key and item with its path and place, by indentation.

While somebody types, a text is wrong most of the time. The reader of ``base.files.yaml`` says where, and gives nothing
else; this one never fails. A bracket that is left open ends where a line begins no deeper than the key it belongs to.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

from plcgen.base.diagnostics import Span
from plcgen.base.files.brackets import hide_indexes, show_indexes
from plcgen.workbench.service.positions import split_lines

Path = tuple[str | int, ...]
Role = Literal["key", "value", "item"]
MAX_TEXT = 2 * 1024 * 1024
"""Of a longer text the beginning is looked at: nobody types into it by hand."""


@dataclass(frozen=True, slots=True)
class Entry:
    """A key or a list item: its path, the place of the key (of an item: of its value), and the value if it is a scalar.

    ``open`` says that nothing stands behind it on its line.
    """

    path: Path
    key: Span
    value: str
    place: Span
    open: bool


class Spot(NamedTuple):
    """Where a cursor stands.

    ``key``: in the mapping at ``path``, or in what will be one; ``value``: behind the key that ``path`` ends with;
    ``item``: in the list item at ``path``. ``word`` is what stands there, ``before`` the part of it before the cursor.
    """

    path: Path
    role: Role
    word: str
    before: str
    span: Span
    fresh: bool = False
    """Whether nothing stands below ``path`` yet, so that a scalar may come there."""


class _Slot(NamedTuple):
    """Columns of a line, from 0, in which a word may stand, and the word."""

    start: int
    end: int
    path: Path
    role: Role
    first: int
    last: int


class _Level(NamedTuple):
    """An open block: its column, its kind, its path, the path of its last entry, whether that had a value."""

    column: int
    kind: Literal["map", "seq"]
    path: Path
    last: Path
    filled: bool


@dataclass(slots=True)
class _Frame:
    """An open bracket."""

    kind: Literal["map", "seq"]
    path: Path
    count: int = 0
    key: str | None = None

    @property
    def place(self) -> tuple[Path, Role]:
        if self.kind == "seq":
            return (*self.path, self.count), "item"
        return (self.path, "key") if self.key is None else ((*self.path, self.key), "value")


_KEY = re.compile(
    r"""("(?:[^"\\]|\\.)*"|'(?:[^']|'')*'|[^\s"'#{}\[\],&*!|>%@`](?:[^:#]|:(?=\S)|(?<=\S)\#)*?)\s*:(?=\s|$)"""
)
_PREFIX = re.compile(r"(?:[&!][^\s,\[\]{}]*\s*)+")
_QUOTED = {'"': re.compile(r'"(?:[^"\\]|\\.)*"?'), "'": re.compile(r"'(?:[^']|'')*'?")}
_PLAIN_FLOW = re.compile(
    r"(?:[^,\[\]{}:#\s]|:(?![\s,\[\]{}]|$)|(?<=\S)\#|[ \t]+(?=[^,\[\]{}:#\s]|:(?![\s,\[\]{}]|$)))+"
)
_PLAIN = re.compile(r"(?:[^\s#]|(?<=\S)\#|[ \t]+(?=[^\s#]))+")


def unquoted(word: str) -> str:
    """A scalar without its quotes; an escape in it is none of a name."""
    if word[:1] == '"':
        return word[1:-1] if word.endswith('"') and len(word) > 1 else word[1:]
    if word[:1] == "'":
        return (word[1:-1] if word.endswith("'") and len(word) > 1 else word[1:]).replace("''", "'")
    return word


@dataclass(slots=True)
class Sketch:
    """The outline of one text."""

    file: str
    lines: list[str]
    entries: list[Entry] = field(default_factory=list)
    anchors: dict[str, Span] = field(default_factory=dict)
    """Where ``&name`` stands."""
    _slots: dict[int, list[_Slot]] = field(default_factory=dict)
    _levels: list[tuple[_Level, ...]] = field(default_factory=list)

    def below(self, path: Path) -> Iterator[Entry]:
        """The entries of the mapping or list at a path."""
        return (each for each in self.entries if each.path[:-1] == path)

    def get(self, *path: str | int) -> Entry | None:
        """The entry at a path."""
        return next((each for each in self.entries if each.path == path), None)

    def value(self, *path: str | int) -> str:
        """The scalar at a path, empty if there is none."""
        found = self.get(*path)
        return found.value if found is not None else ""

    def at(self, line: int, column: int) -> Spot | None:
        """What stands at a line and column; None in a comment or a text of several lines."""
        number, offset = line - 1, column - 1
        if not 0 <= number < len(self._levels):
            return None
        for slot in self._slots.get(number, ()):
            if slot.start <= offset <= slot.end:
                first, last = (slot.first, slot.last) if slot.first <= offset <= slot.last else (offset, offset)
                return self._spot(slot.path, slot.role, number, first, last, offset, fresh=slot.role != "key")
        if self.lines[number].strip():
            return None
        path, fresh = _parent(self._levels[number], offset)
        return self._spot(path, "key", number, offset, offset, offset, fresh=fresh)

    def _spot(self, path: Path, role: Role, number: int, first: int, last: int, offset: int, *, fresh: bool) -> Spot:
        text = self.lines[number]
        place = Span(self.file, number + 1, first + 1, number + 1, last + 1)
        return Spot(path, role, unquoted(text[first:last]), unquoted(text[first:offset]), place, fresh)


def _parent(levels: tuple[_Level, ...], column: int) -> tuple[Path, bool]:
    """The mapping that goes on where a line begins at a column, and whether it begins there."""
    open_ = [level for level in levels if level.column <= column]
    if not open_:
        return (levels[0].path if levels else ()), False
    top = open_[-1]
    if column > top.column and not top.filled:
        return top.last, True
    maps = [level for level in open_ if level.kind == "map"]
    return (maps[-1].path, False) if maps else (top.last, True)


def sketch(text: str, file: str) -> Sketch:
    """Read the outline of a text."""
    shown = text[:MAX_TEXT]
    scanner = _Scanner(Sketch(file, split_lines(shown)), split_lines(hide_indexes(shown)))
    scanner.run()
    return scanner.found


@dataclass(slots=True)
class _Scanner:
    """Goes through the lines; ``lines`` have the indexes of names hidden, one for one."""

    found: Sketch
    lines: list[str]
    levels: tuple[_Level, ...] = ()
    frames: list[_Frame] = field(default_factory=list)
    floor: int = -1
    """Column of the key that open brackets or a text of several lines belong to."""
    inside: str = ""
    """The mark of the text of several lines in which the next line stands: a quote or ``|``."""

    def run(self) -> None:
        for number, text in enumerate(self.lines):
            self.found._levels.append(self.levels)  # noqa: SLF001 - the outline in the making
            column = len(text) - len(text.lstrip(" \t"))
            bare = column == len(text)
            if self.inside and (bare or column > self.floor):
                self.skip(text)
            elif self.frames and (bare or column > self.floor or text[column] in "]}"):
                self.flow(number, 0)
            else:
                self.frames, self.inside = [], ""
                if not bare and text[column] != "#" and not text.startswith(("---", "...", "%")):
                    self.block(number, column)

    def skip(self, text: str) -> None:
        """A line of a text of several lines."""
        if self.inside != "|" and self.inside in text:
            self.inside = ""

    def slot(self, number: int, start: int, end: int, place: tuple[Path, Role], first: int, last: int) -> None:
        slots = self.found._slots.setdefault(number, [])  # noqa: SLF001 - the outline in the making
        slots.append(_Slot(start, end, *place, first, last))

    def entry(self, path: Path, key: Span, value: str, place: Span, *, open_: bool = False) -> None:
        self.found.entries.append(Entry(path, key, show_indexes(unquoted(value)), place, open_))

    def prefix(self, number: int, column: int) -> int:
        """Where a value begins behind its anchor and tag."""
        found = _PREFIX.match(self.lines[number], column)
        if found is None:
            return column
        for name in re.finditer(r"&(\S+)", found[0]):
            self.found.anchors[name[1]] = self.span(number, column + name.start(), column + name.end())
        return found.end()

    def span(self, number: int, first: int, last: int) -> Span:
        return Span(self.found.file, number + 1, first + 1, number + 1, last + 1)

    # --- blocks --------------------------------------------------------------------------------------------------

    def block(self, number: int, column: int) -> None:
        """A line of a block: dashes, then a key with its value, or a scalar."""
        text = self.lines[number]
        self.levels = tuple(level for level in self.levels if level.column <= column)
        while text[column : column + 1] == "-" and text[column + 1 : column + 2] in {"", " ", "\t"}:
            path = self.dash(column)
            start = column + 1
            column = start + len(text[start:]) - len(text[start:].lstrip(" \t"))
            if column >= len(text) or text[column] == "#":
                self.entry(path, self.span(number, start, start), "", self.span(number, start, start), open_=True)
                self.slot(number, start, max(start, min(column, len(text))), (path, "item"), start, start)
                return
            if not _KEY.match(text, column) and not text.startswith("- ", column):
                self.floor = self.levels[-1].column
                self.value(number, start, path, None)
                return
        found = _KEY.match(text, column)
        if found is None:
            self.loose(number, column)
            return
        self.key(number, column, found)

    def dash(self, column: int) -> Path:
        """The path of the next item of the list whose dashes stand in a column."""
        top = self.levels[-1] if self.levels else _Level(-1, "map", (), (), filled=False)
        if top.column != column or top.kind != "seq":
            top = _Level(column, "seq", top.last, (*top.last, -1), filled=False)
            self.levels = (*self.levels, top)
        at = top.last[-1]
        path = (*top.path, at + 1 if isinstance(at, int) else 0)
        self.levels = (*self.levels[:-1], top._replace(last=path, filled=False))
        return path

    def key(self, number: int, column: int, found: re.Match[str]) -> None:
        """A key, and what stands behind it on its line."""
        while self.levels and self.levels[-1].column == column and self.levels[-1].kind == "seq":
            self.levels = self.levels[:-1]
        top = self.levels[-1] if self.levels else None
        if top is None or top.column < column:
            below = () if top is None else top.last
            top = _Level(column, "map", below, below, filled=False)
            self.levels = (*self.levels, top)
        path = (*top.path, show_indexes(unquoted(found[1])))
        self.levels = (*self.levels[:-1], top._replace(last=path, filled=False))
        self.slot(number, column, found.end(1), (top.path, "key"), column, found.end(1))
        self.floor = column
        self.value(number, found.end(), path, self.span(number, column, found.end(1)))

    def loose(self, number: int, column: int) -> None:
        """A word that is no key yet, or the rest of a text."""
        word = _PLAIN.match(self.lines[number], column)
        if word is None:
            return
        path, _ = _parent(self.levels, column)
        self.slot(number, column, word.end(), (path, "key"), column, word.end())

    def value(self, number: int, start: int, path: Path, key: Span | None) -> None:
        """What stands behind a key or a dash: a scalar, brackets, the beginning of a text, or nothing."""
        text = self.lines[number]
        role: Role = "item" if key is None else "value"
        first = start + len(text[start:]) - len(text[start:].lstrip(" \t"))
        first = self.prefix(number, first)
        mark = text[first : first + 1]
        here = self.span(number, min(first, len(text)), min(first, len(text)))
        if not mark or (mark == "#" and (first == 0 or text[first - 1] in " \t")):
            self.entry(path, key or here, "", here, open_=True)
            if start < len(text):
                self.slot(number, start + (key is not None), max(first, start + 1), (path, role), first, first)
            return
        self.levels = (*self.levels[:-1], self.levels[-1]._replace(filled=True))
        if mark in "[{":
            self.entry(path, key or here, "", here)
            if key is None:
                self.slot(number, start, first, (path, role), first, first)
            self.frames = [_Frame("map" if mark == "{" else "seq", path)]
            self.flow(number, first + 1)
            return
        if mark in "|>":
            self.inside = "|"
            self.entry(path, key or here, "", here)
            return
        word = (_QUOTED.get(mark) or _PLAIN).match(text, first)
        last = word.end() if word is not None else len(text)
        if mark in _QUOTED and (last - first < 2 or text[last - 1] != mark):
            self.inside = mark
        place = self.span(number, first, last)
        self.entry(path, key or place, text[first:last], place)
        self.slot(number, start + (key is not None), last, (path, role), first, last)

    # --- brackets ------------------------------------------------------------------------------------------------

    def flow(self, number: int, column: int) -> None:
        """A line inside brackets, as far as they are open."""
        text = self.lines[number]
        start = first = last = column
        place = self.frames[-1].place
        while self.frames:
            while column < len(text) and text[column] in " \t":
                column += 1
            mark = text[column : column + 1]
            if not mark or (mark == "#" and (column == 0 or text[column - 1] in " \t,")):
                self.slot(number, start, column if mark else len(text), place, first, last)
                return
            if mark in ",:{}[]" and not self.goes_on(text, column):
                self.slot(number, start, column, place, first, last)
                self.mark(self.frames[-1], mark, number, column)
                column += 1
                start = first = last = column
                place = self.frames[-1].place if self.frames else place
                continue
            after = self.prefix(number, column)
            if after > column:
                column = after
                continue
            word = (_QUOTED.get(mark) or _PLAIN_FLOW).match(text, column)
            first, last = column, word.end() if word is not None else column + 1
            self.word(self.frames[-1], number, first, last)
            column = last

    @staticmethod
    def goes_on(text: str, column: int) -> bool:
        """Whether a colon belongs to a word."""
        return (
            text[column] == ":"
            and text[column + 1 : column + 2] not in {"", " ", "\t", ",", "[", "]", "{", "}"}
            and (text[column - 1 : column] not in {'"', "'"})
        )

    def word(self, frame: _Frame, number: int, first: int, last: int) -> None:
        """A key, a value or an item."""
        text, place = self.lines[number][first:last], self.span(number, first, last)
        path, role = frame.place
        if role == "key":
            after = self.lines[number][last:].lstrip(" \t")
            if after[:1] == ":":
                frame.key = show_indexes(unquoted(text))
                self.entry((*path, frame.key), place, "", Span(*_end(place)), open_=True)
            return
        if role == "value":
            self.fill(path, text, place)
        else:
            self.entry(path, place, text, place)

    def fill(self, path: Path, text: str, place: Span) -> None:
        """Give the key that was read last its value."""
        entries = self.found.entries
        if entries and entries[-1].path == path:
            entries[-1] = Entry(path, entries[-1].key, show_indexes(unquoted(text)), place, open=False)

    def mark(self, frame: _Frame, mark: str, number: int, column: int) -> None:
        """A bracket, a comma or a colon."""
        if mark in "{[":
            path, role = frame.place
            if role != "value":
                here = self.span(number, column, column)
                path = path if role == "item" else (*path, "")
                self.entry(path, here, "", here)
            elif self.found.entries:
                last = self.found.entries[-1]
                self.found.entries[-1] = Entry(last.path, last.key, "", last.place, open=False)
            self.frames.append(_Frame("map" if mark == "{" else "seq", path))
        elif mark in "}]":
            self.frames.pop()
        elif mark == ",":
            frame.count += 1
            frame.key = None


def _end(place: Span) -> tuple[str, int, int, int, int]:
    return place.file, place.end_line, place.end_column, place.end_line, place.end_column
