"""Every place of a file in which a text may stand, found in its JSON schema, each with a file that has one there."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

Step = str | int
KEY = "key"
"""Stands for a key that whoever writes the file chooses."""


@dataclass(frozen=True)
class Place:
    """A text in a file: the way to it, whether it is the key at the end of the way, and whether something else must be
    beside it in its mapping.
    """

    path: tuple[Step, ...]
    is_key: bool = False
    beside: bool = False

    def __str__(self) -> str:
        return ".".join(map(str, self.path)) + (" (key)" if self.is_key else "")

    def file(self, text: str) -> tuple[str, int]:
        """A file that has the text there and as little else as leads there, and the line in which it stands."""
        inner: Any = text
        for number, step in enumerate(reversed(self.path)):
            if self.is_key and number == 0:
                inner = {text: 1 if self.beside else {}}
            elif self.beside and number == 0:
                inner = {step: inner, KEY: 1}
            else:
                inner = [inner] if isinstance(step, int) else {step: inner}
        lines = json.dumps(inner, indent=1).splitlines()
        spelled = json.dumps(text)
        line = next(number for number, one in enumerate(lines, 1) if spelled in one)
        whole = "\n".join(lines).replace(spelled, _yaml(text))
        return f"{whole}\n", line


def _yaml(text: str) -> str:
    """A text in quotes of YAML: JSON spells what is beyond FFFFh as two surrogates."""
    return '"' + "".join(c if c.isascii() and c.isalnum() else f"\\U{ord(c):08X}" for c in text) + '"'


class Walk:
    """The places of a schema; ``seen`` are the parts of it that were there, by identity."""

    def __init__(self, schema: dict[str, Any]) -> None:
        self.schema = schema
        self.seen: set[int] = set()
        self.places = list(dict.fromkeys(self._places(schema, (), ())))

    def missed(self) -> list[Any]:
        """Texts of the schema that the walk did not come to."""
        return [one for one in texts_in(self.schema) if id(one) not in self.seen]

    def _places(
        self, schema: Any, path: tuple[Step, ...], through: tuple[str, ...], *, beside: bool = False
    ) -> Iterator[Place]:
        """``through`` are the definitions on the way; one that contains itself is gone through twice."""
        if not isinstance(schema, dict):
            return
        self.seen.add(id(schema))
        name = schema.get("$ref", "").rpartition("/")[2]
        if name and through.count(name) < 2:
            yield from self._places(self.schema["$defs"][name], path, (*through, name), beside=beside)
        for key in ("anyOf", "oneOf", "allOf"):
            for one in schema.get(key, ()):
                yield from self._places(one, path, through, beside=beside)
        for key in ("then", "else"):
            yield from self._places(schema.get(key), path, through)
        if _is_text(schema):
            yield Place(path, beside=beside)
        yield from self._places(schema.get("items"), (*path, 0), through)
        more = schema.get("additionalProperties")
        values = isinstance(more, dict) and "properties" in schema
        for key, one in schema.get("properties", {}).items():
            if isinstance(more, dict) and {**one, "description": ""} == {**more, "description": ""}:
                self.seen.update(id(text) for text in texts_in(one))  # an editor offers this name: any other will do
            else:
                yield from self._places(one, (*path, key), through, beside=values)
        if isinstance(more, dict) or "propertyNames" in schema:
            yield Place((*path, KEY), is_key=True, beside=values)
            yield from self._places(more, (*path, KEY), through)


def _is_text(schema: dict[str, Any]) -> bool:
    """Whether any text may stand there, or one of a pattern."""
    kinds = schema.get("type", ())
    return "string" in ([kinds] if isinstance(kinds, str) else kinds) and not {"enum", "const"} & schema.keys()


def texts_in(schema: Any) -> Iterator[dict[str, Any]]:
    """Every part of a schema that is a text, wherever it stands."""
    if isinstance(schema, list):
        for one in schema:
            yield from texts_in(one)
    elif isinstance(schema, dict):
        if _is_text(schema):
            yield schema
        for key, one in schema.items():
            if key not in {"default", "examples", "enum", "const", "propertyNames"}:
                yield from texts_in(one)
