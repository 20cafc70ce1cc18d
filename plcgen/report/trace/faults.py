"""Faults for somebody who chooses: what each kind does, and the values that its keys can have."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from enum import Enum
from typing import Any

from pydantic import BaseModel

from plcgen.report.trace.face import FaultKey, FaultKind

Known = Mapping[str, Sequence[tuple[str, str]]]
"""By key: values with a meaning, and what each means."""


def fault_kinds(
    shape: type[BaseModel],
    kinds: Mapping[Any, tuple[str, tuple[str, ...]]],
    known: Known,
    choices: Mapping[str, Sequence[str]] | None = None,
) -> tuple[FaultKind, ...]:
    """The kinds with the keys of ``shape`` that count for each; ``choices`` are the only values of some keys."""
    own = {key for _, keys in kinds.values() for key in keys}
    common = [key for key in shape.model_fields if key != "kind" and key not in own]
    keys = {key.key: key for key in _keys(shape, known, choices or {})}
    return tuple(
        FaultKind(kind.value, text, tuple(keys[key] for key in (*special, *common)))
        for kind, (text, special) in kinds.items()
        if isinstance(kind, Enum)
    )


def _keys(shape: type[BaseModel], known: Known, choices: Mapping[str, Sequence[str]]) -> Iterator[FaultKey]:
    schemas: Mapping[str, Any] = shape.model_json_schema()["properties"]
    for key, entry in shape.model_fields.items():
        default: Any = None if entry.is_required() else entry.get_default(call_default_factory=True, validated_data={})
        words = [word for each in (schemas[key], *schemas[key].get("anyOf", ())) for word in _words(each)]
        parts = schemas[key].get("anyOf", [schemas[key]])
        closed = not any("type" in each and not list(_words(each)) for each in parts)
        yield FaultKey(
            key,
            entry.description or "",
            _spelled(default, hexadecimal=any(value.startswith("16#") for value, _ in known.get(key, ()))),
            tuple(choices.get(key, ())) or (tuple(words) if closed else ()),
            (*known.get(key, ()), *((word, "") for word in words if not closed)),
        )


def _spelled(value: Any, *, hexadecimal: bool) -> str:
    if isinstance(value, bytes):
        return value.hex(" ").upper()
    return "" if value is None else f"16#{value:02X}" if hexadecimal else str(value)


def _words(schema: Mapping[str, Any]) -> Iterable[str]:
    return [str(word) for word in schema.get("enum", [schema["const"]] if "const" in schema else [])]
