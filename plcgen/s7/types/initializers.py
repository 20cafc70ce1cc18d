"""Start values of arrays and structures: ``[1, 2(0)]``, ``3(0.0)``, ``(1, TRUE, 'x')``, ``(a := 1)``."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from plcgen.s7.types.literals import LiteralError

if TYPE_CHECKING:
    from collections.abc import Iterator


@dataclass(frozen=True, slots=True)
class Group:
    """A bracketed list; ``kind`` is ``[`` or ``(``, or empty for a bare list."""

    kind: str
    items: tuple[InitialItem, ...]


@dataclass(frozen=True, slots=True)
class InitialItem:
    """One value of a list, ``count`` times, for the member ``name`` if given; None keeps the default."""

    value: Node
    name: str | None = None
    count: int = 1


Node: TypeAlias = "Group | str | None"

MAX_DEPTH = 32
_REPEAT = re.compile(r"(\d[\d_]*)\s*\(", re.ASCII)
_NAME = re.compile(r'(?:"([^"]+)"|([^\W\d]\w*))\s*:=\s*')
_TEXT = re.compile(r"'(?:[^'$]|\$.)*'", re.DOTALL)


class _Reader:
    def __init__(self, text: str) -> None:
        self.text = text
        self.position = 0

    def fail(self, reason: str) -> LiteralError:
        return LiteralError(self.text, "start value", reason)

    def skip(self) -> str:
        while self.position < len(self.text) and self.text[self.position].isspace():
            self.position += 1
        return self.text[self.position : self.position + 1]

    def items(self, closing: str, depth: int) -> tuple[InitialItem, ...]:
        if depth > MAX_DEPTH:
            raise self.fail("nested too deeply")
        items: list[InitialItem] = []
        while True:
            items.append(self.item(closing, depth))
            char = self.skip()
            self.position += 1
            if char == closing:
                return () if items == [InitialItem(None)] else tuple(items)
            if char != ",":
                raise self.fail(f"expected , or {closing or 'the end'}")

    def item(self, closing: str, depth: int) -> InitialItem:
        char = self.skip()
        name = _NAME.match(self.text, self.position)
        if name is not None:
            self.position = name.end()
            return InitialItem(self.value(closing, depth), name[1] or name[2])
        repeat = _REPEAT.match(self.text, self.position)
        if repeat is not None:
            self.position = repeat.end()
            items = self.items(")", depth + 1)
            value = items[0].value if len(items) == 1 and items[0].count == 1 else Group("", items)
            return InitialItem(value, count=int(repeat[1].replace("_", "")))
        if char in ("", ",") or char == closing:
            return InitialItem(None)
        return InitialItem(self.value(closing, depth))

    def value(self, closing: str, depth: int) -> Node:
        char = self.skip()
        if char in ("[", "("):
            self.position += 1
            return Group(char, self.items("]" if char == "[" else ")", depth + 1))
        return self.literal(closing)

    def literal(self, closing: str) -> str:
        start, level = self.position, 0
        while self.position < len(self.text):
            text = _TEXT.match(self.text, self.position)
            if text is not None:
                self.position = text.end()
                continue
            char = self.text[self.position]
            if not level and char in (",", closing):
                break
            level += (char == "(") - (char == ")")
            self.position += 1
        return self.text[start : self.position].strip()


def parse_initializer(text: str) -> tuple[InitialItem, ...]:
    """Take a start value apart. Raises LiteralError with a reason if brackets or commas are wrong."""
    return _Reader(text).items("", 0)


def flatten(items: tuple[InitialItem, ...], limit: int, kinds: str = "[") -> Iterator[Node]:
    """Values in order, repetitions written out, groups of ``kinds`` opened; ends one after ``limit``."""
    produced = 0
    for item in items:
        opened = isinstance(item.value, Group) and (item.value.kind == "" or item.value.kind in kinds)
        for _ in range(min(item.count, limit + 1)):
            if produced > limit:
                return
            if opened and isinstance(item.value, Group):
                before = produced
                for node in flatten(item.value.items, limit - produced, kinds):
                    produced += 1
                    yield node
                    if produced > limit:
                        return
                if produced == before:
                    break
            else:
                produced += 1
                yield item.value
