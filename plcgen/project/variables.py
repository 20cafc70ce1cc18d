"""``$(name)``: values with a name, defined under ``variables:``.

A value that is nothing but ``$(name)``, without quotes, is the variable's value with its type: a number, a list, a
mapping. In quotes or inside a text it is the variable's text.
``$$(`` stands for ``$(``. Variables do not refer to each other, so nothing can go in circles.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from itertools import islice

from plcgen.base.diagnostics import Diagnostic, Note, Report, Span
from plcgen.base.diagnostics.suggest import Vocabulary, did_you_mean
from plcgen.base.files.yaml import MAX_BYTES, MAX_NODES, YamlNode

KEY = "variables"
NAME = "[A-Za-z_][A-Za-z0-9_-]{0,60}"
WHOLE = rf"^\$\({NAME}\)$"
_NAME = re.compile(NAME)
_USE = re.compile(r"(\$?)\$\(([^()]*)\)")
_MARK = "$("


@dataclass(frozen=True, slots=True)
class VariableUse:
    """Where a variable is used, and where it is defined."""

    name: str
    place: Span
    origin: Span


def substitute(root: YamlNode, report: Report) -> tuple[VariableUse, ...]:
    """Put values in the place of variables, in the tree itself; what is wrong goes to ``report``."""
    filling = _Filling(root, report)
    filling.fill()
    return tuple(filling.uses)


def with_origins(found: Iterable[Diagnostic], uses: Iterable[VariableUse]) -> Iterator[Diagnostic]:
    """Diagnostics at a variable's use with a note that shows its definition."""
    origins: dict[tuple[str, int, int], list[Note]] = {}
    for use in uses:
        place = (use.place.file, use.place.line, use.place.column)
        origins.setdefault(place, []).append(Note(f'the value of "{use.name}"', use.origin))
    for diagnostic in found:
        notes = origins.get((diagnostic.span.file, diagnostic.span.line, diagnostic.span.column), [])
        more = tuple(note for note in notes if note not in diagnostic.notes)
        yield replace(diagnostic, notes=(*diagnostic.notes, *more)) if more else diagnostic


@dataclass(slots=True)
class _Filling:
    root: YamlNode
    report: Report
    uses: list[VariableUse] = field(default_factory=list)
    words: Vocabulary | None = None
    room: int = MAX_BYTES
    """So many characters more may come from variables in texts."""

    def fill(self) -> None:
        """Every node once; aliases share theirs."""
        node = self.root.get(KEY)
        seen: set[int] = set()
        left = [self.root]
        if node is not None:
            seen.add(id(node))
            self.plain(node)
        while left:
            above = left.pop()
            for name, (key, value) in list(above.pairs.items()):
                if _MARK in key.raw and _USE.search(key.raw):
                    self.refuse("a variable is not allowed in a key", key.span, "write the key out")
                above.pairs[name] = (key, self.filled(value))
            above.items = [self.filled(item) for item in above.items]
            left += [each for each in above.children if each.kind != "scalar" and id(each) not in seen]
            seen.update(map(id, above.children))
        if self.room < 0 or _size(self.root, {}) > MAX_NODES:
            message = f"the spec expands to more than {MAX_NODES} values or {MAX_BYTES // 1024 // 1024} MiB"
            self.report.add(Diagnostic("PG109", message, self.root.span, help="use fewer variables"))

    def plain(self, variables: YamlNode) -> None:
        """Refuse names that are none, and variables in the values of variables."""
        for name, (key, _) in variables.pairs.items():
            if not _NAME.fullmatch(name):
                self.refuse(
                    f'"{name}" is not a valid variable name', key.span, "letters, digits, _ and -; a letter first"
                )
        for one in variables.walk():
            if one.kind == "scalar" and _MARK in one.raw and self.names(one):
                self.refuse("a variable cannot refer to another one", one.span, "write the value out")

    def names(self, node: YamlNode) -> list[str]:
        return [use[2] for use in _USE.finditer(node.raw) if not use[1]]

    def filled(self, node: YamlNode) -> YamlNode:
        """A node with the values of its variables."""
        if node.kind != "scalar" or _MARK not in node.raw or not isinstance(node.value, str):
            return node
        names = self.names(node)
        if node.plain and names and node.raw == f"$({names[0]})":
            found = self.find(names[0], node.span)
            if found is None or found.kind != "scalar":
                return found or node
            return YamlNode("scalar", node.span, found.value, found.raw, found.plain)
        texts = {name: self.text(name, node.span) for name in dict.fromkeys(names)}
        if None in texts.values():
            return node
        self.room -= sum(len(texts[name] or "") for name in names)
        if self.room < 0:
            return node
        raw = _USE.sub(lambda use: use[0][1:] if use[1] else texts[use[2]] or "", node.raw)
        return YamlNode("scalar", node.span, raw, raw)

    def text(self, name: str, place: Span) -> str | None:
        found = self.find(name, place)
        if found is None:
            return None
        if found.kind == "scalar":
            return found.raw
        what = "a list" if found.kind == "seq" else "a mapping"
        self.refuse(
            f'"{name}" is {what}, which cannot be used inside a text', place, f"write $({name}) alone, without quotes"
        )
        return None

    def find(self, name: str, place: Span) -> YamlNode | None:
        variables = self.root.get(KEY)
        known = variables.pairs if variables is not None else {}
        if name in known:
            self.uses.append(VariableUse(name, place, known[name][0].span))
            return known[name][1]
        if not _NAME.fullmatch(name):
            self.refuse(f'"{name}" is not a valid variable name', place, f"for the text write $$({name})")
        else:
            if self.words is None:
                self.words = Vocabulary(known)
            listed = f"variables: {', '.join(islice(known, 20))}" if known else "define it under variables:"
            self.refuse(f'unknown variable "{name}"', place, f"{did_you_mean(name, self.words)} {listed}".strip())
        return None

    def refuse(self, message: str, place: Span, help_: str) -> None:
        self.report.add(Diagnostic("PG114", message, place, help=help_))


def _size(node: YamlNode, known: dict[int, int]) -> int:
    """Number of values below a node and itself, each as often as it stands there; the depth is bounded."""
    if id(node) not in known:
        known[id(node)] = 1 + sum(_size(each, known) for each in node.children)
    return known[id(node)]
