"""Keys of a simulator's YAML file, read one by one; every problem is collected with its position.

PG104 unknown key, PG105 missing key, PG106 wrong kind of value, PG107 value out of range.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from plcgen.diagnostics import Diagnostic, Report, Span
from plcgen.input.yaml import Node

T = TypeVar("T")


def plain_node(data: Any, span: Span) -> Node:
    """Wrap plain data as nodes without a position."""
    if isinstance(data, Mapping):
        pairs = {str(key): (Node("scalar", span, str(key)), plain_node(value, span)) for key, value in data.items()}
        return Node("map", span, pairs=pairs)
    if isinstance(data, list | tuple):
        return Node("seq", span, items=[plain_node(item, span) for item in data])
    return Node("scalar", span, data, str(data))


@dataclass(slots=True)
class Reader:
    """Reads the keys of one mapping; problems go to the report and the default is used instead."""

    node: Node
    report: Report
    what: str

    def error(self, code: str, message: str, span: Span, help_: str = "") -> None:
        """Note a problem at a place."""
        self.report.add(Diagnostic(code, message, span, help=help_))

    def only(self, *keys: str) -> None:
        """Complain about keys that are none of ``keys``."""
        if self.node.kind != "map":
            self.error("PG106", f"{self.what} is a mapping", self.node.span)
            return
        for key in self.node.pairs:
            if key not in keys:
                self.error(
                    "PG104",
                    f'unknown key "{key}" in {self.what}',
                    self.node.key_span(key),
                    "keys here: " + ", ".join(keys),
                )

    def require(self, key: str) -> None:
        """Complain if a key is missing."""
        if self.node.kind == "map" and self.node.get(key) is None:
            self.error("PG105", f'{self.what} lacks the key "{key}"', self.node.span)

    def child(self, key: str, what: str) -> Reader:
        """Return the reader of a mapping below; an empty one if the key is absent."""
        node = self.node.get(key) or Node("map", self.node.span)
        return Reader(node, self.report, what)

    def children(self, key: str, what: str) -> list[Reader]:
        """Return the readers of a list of mappings."""
        return [Reader(item, self.report, what) for item in self.items(key)]

    def items(self, key: str) -> list[Node]:
        """Return the nodes of a list; none if the key is absent."""
        node = self.node.get(key)
        if node is None:
            return []
        if node.kind != "seq":
            self.error("PG106", f'"{key}" of {self.what} is a list', node.span)
            return []
        return node.items

    def number(self, key: str, default: int, low: int, high: int) -> int:
        """Whole number of a key."""
        node = self.node.get(key)
        if node is None:
            return default
        return self._integer(node, key, default, low, high)

    def _integer(self, node: Node, key: str, default: int, low: int, high: int) -> int:
        value = node.value
        if node.kind != "scalar" or isinstance(value, bool) or not isinstance(value, int):
            self.error("PG106", f'"{key}" of {self.what} is a whole number', node.span)
            return default
        if not low <= value <= high:
            self.error("PG107", f'"{key}" of {self.what} is {value}, allowed: {low} to {high}', node.span)
            return default
        return value

    def optional(self, key: str, low: int, high: int) -> int | None:
        """Whole number of a key, None if it is absent or null."""
        node = self.node.get(key)
        if node is None or (node.kind == "scalar" and node.value is None):
            return None
        return self._integer(node, key, low, low, high)

    def real(self, key: str) -> float | None:
        """Number of a key, None if it is absent."""
        node = self.node.get(key)
        if node is None:
            return None
        if isinstance(node.value, bool) or not isinstance(node.value, int | float):
            self.error("PG106", f'"{key}" of {self.what} is a number', node.span)
            return None
        return node.value

    def flag(self, key: str, *, default: bool = False) -> bool:
        """Truth value of a key."""
        node = self.node.get(key)
        if node is None:
            return default
        if not isinstance(node.value, bool):
            self.error("PG106", f'"{key}" of {self.what} is true or false', node.span)
            return default
        return node.value

    def text(self, key: str, default: str = "") -> str:
        """Text of a key."""
        node = self.node.get(key)
        if node is None:
            return default
        if not isinstance(node.value, str):
            self.error("PG106", f'"{key}" of {self.what} is text', node.span)
            return default
        return node.value

    def choice(self, key: str, default: T, choices: Mapping[Any, T]) -> T:
        """What the value of a key stands for."""
        node = self.node.get(key)
        if node is None:
            return default
        if node.kind != "scalar" or node.value not in choices:
            names = ", ".join(str(name) for name in choices)
            self.error("PG107", f'"{key}" of {self.what} is one of: {names}', node.span)
            return default
        return choices[node.value]

    def numbers(self, key: str, default: Sequence[int], high: int) -> tuple[int, ...]:
        """List of whole numbers from 0 to ``high``."""
        if self.node.get(key) is None:
            return tuple(default)
        return tuple(self._integer(item, key, 0, 0, high) for item in self.items(key))

    def texts(self, key: str) -> tuple[str, ...]:
        """List of texts."""
        for item in self.items(key):
            if not isinstance(item.value, str):
                self.error("PG106", f'"{key}" of {self.what} is a list of texts', item.span)
        return tuple(item.value for item in self.items(key) if isinstance(item.value, str))
