"""What a schema says about a place of a file: keys, words, what they are for."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from plcgen.workbench.service.specs.sketch import Path

Schema = Mapping[str, Any]


@dataclass(frozen=True)
class Shape:
    """A JSON schema (draft 2020-12) as ``plcgen schema`` writes it: references, alternatives, no conditions but one."""

    schema: Schema

    def at(self, path: Path) -> list[Schema]:
        """Every alternative of what may stand at a path."""
        found = list(self._alternatives(self.schema))
        for step in path:
            found = [each for below in found for part in _below(below, step) for each in self._alternatives(part)]
        return found

    def keys(self, path: Path) -> dict[str, Schema]:
        """The keys that may stand in a mapping at a path, each with its schema."""
        return {key: each for one in self.at(path) for key, each in one.get("properties", {}).items()}

    def words(self, path: Path) -> list[Any]:
        """The words and truth values that may stand at a path, in their order."""
        found: list[Any] = []
        for one in self.at(path):
            found += one.get("enum", [one["const"]] if "const" in one else [])
            if "boolean" in _types(one):
                found += [True, False]
        return [each for n, each in enumerate(found) if each is not None and each not in found[:n]]

    def examples(self, path: Path) -> list[Any]:
        """Examples of values, and the default one."""
        found = [each for one in self.at(path) for each in one.get("examples", [])]
        return list(dict.fromkeys(each for each in [*found, self.default(path)] if isinstance(each, str | int | float)))

    def default(self, path: Path) -> Any:
        """The value that counts if the key is absent; None if it has none."""
        return self._said(path, "default")

    def meaning(self, path: Path) -> str:
        """What a key is for."""
        return str(self._said(path, "description") or "")

    def bounds(self, path: Path) -> tuple[Any, Any]:
        """The least and the greatest number."""
        low, high = ([one[key] for one in self.at(path) if key in one] for key in ("minimum", "maximum"))
        return min(low, default=None), max(high, default=None)

    def said(self, path: Path, *, listed: bool = True) -> str:
        """What there is to say of a value: its words if they are to be ``listed``, bounds, default, examples."""
        words, (low, high), default = self.words(path), self.bounds(path), self.default(path)
        lines = [f"one of: {', '.join(map(spelled, words[:40]))}"] if words and listed else []
        lines += [f"{low} to {high}"] if low is not None and high is not None else []
        lines += [f"default: {spelled(default)}"] if isinstance(default, str | int | float) else []
        examples = [each for each in self.examples(path) if each != default]
        return "\n".join([*lines, f"for example: {', '.join(map(spelled, examples))}"] if examples else lines)

    def _said(self, path: Path, word: str) -> Any:
        """What stands beside the alternatives of a value, else in one of them."""
        below = self.at(path[:-1]) if path else [self.schema]
        told = [part for one in below for part in _below(one, path[-1])] if path else below
        return next((each[word] for each in (*told, *self.at(path)) if each.get(word) not in (None, [])), None)

    def _alternatives(self, schema: Any) -> Iterator[Schema]:
        if not isinstance(schema, dict):
            return
        if "$ref" in schema:
            name = schema["$ref"].rpartition("/")[2]
            yield from self._alternatives(self.schema["$defs"].get(name))
        if {"properties", "type", "enum", "const", "items", "additionalProperties"} & schema.keys():
            yield schema
        for word in ("anyOf", "oneOf", "allOf"):
            for each in schema.get(word, ()):
                yield from self._alternatives(each)
        for word in ("then", "else"):
            yield from self._alternatives(schema.get(word))


def _below(schema: Schema, step: str | int) -> Iterator[Any]:
    if isinstance(step, int):
        yield from (schema[key] for key in ("items",) if isinstance(schema.get(key), dict))
    elif step in schema.get("properties", {}):
        yield schema["properties"][step]
    elif isinstance(schema.get("additionalProperties"), dict):
        yield schema["additionalProperties"]


def spelled(value: Any) -> str:
    """A value as YAML has it."""
    return value if isinstance(value, str) else json.dumps(value)


def _types(schema: Schema) -> list[str]:
    kinds = schema.get("type", [])
    return [kinds] if isinstance(kinds, str) else list(kinds)


@cache
def spec_shape() -> Shape:
    """The shape of a spec."""
    from plcgen import api

    return Shape(api.schema("spec"))
