"""JSON schemas of files as an editor needs them: what the tool reads, in the spelling of a file.

pydantic describes what stands in memory. In a file an integer may be ``16#B02E``, which is a text to every YAML reader
but ours, and a duration has a unit, its default value too.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaWarningKind

S7_NUMBER = "^((B|W|DW|L|BYTE|WORD|DWORD)#)?(16#[0-9A-Fa-f_]+|8#[0-7_]+|2#[01_]+)$"
"""Numbers in the spelling of STEP 7, see ``plcgen.input.yaml``."""
DURATION = r"^[0-9]{1,7}\s*(ms|s|min)$"


def offered(names: Iterable[str], kind: str = "string") -> dict[str, Any]:
    """Any text (or another ``kind`` of value), of which an editor offers some."""
    return {"anyOf": [{"enum": list(names)}, {"type": kind}]}


def in_a_file(schema: Any, *, named: bool = False) -> Any:
    """The schema with numbers and durations as they are written, without titles that repeat their keys.

    ``named`` says that the keys of ``schema`` are names of properties or definitions, not words of JSON schema.
    """
    if isinstance(schema, list):
        return [in_a_file(each) for each in schema]
    if not isinstance(schema, dict):
        return schema
    if named:
        return {name: in_a_file(each) for name, each in schema.items()}
    found = {
        key: value if key in _DATA else in_a_file(value, named=key in _NAMING)
        for key, value in schema.items()
        if key != "title"
    }
    if found.get("default") is None or isinstance(found.get("default"), dict):
        found.pop("default", None)
    return _number(_duration(found))


_NAMING = frozenset({"properties", "$defs"})
_DATA = frozenset({"default", "enum", "const", "examples"})


def _duration(schema: dict[str, Any]) -> dict[str, Any]:
    milliseconds = schema.get("default")
    if schema.get("pattern") != DURATION or not isinstance(milliseconds, int):
        return schema
    text = f"{milliseconds // 1000}s" if milliseconds % 1000 == 0 else f"{milliseconds}ms"
    return {**schema, "default": text}


def _number(schema: dict[str, Any]) -> dict[str, Any]:
    """An integer, and a number that may be one, may be spelled as in STEP 7, too; its bounds hold for decimals only."""
    if schema.get("type") not in ("integer", "number") or "const" in schema:
        return schema
    number = {key: schema.pop(key) for key in ("type", "minimum", "maximum") if key in schema}
    return {**schema, "anyOf": [number, {"type": "string", "pattern": S7_NUMBER}]}


class _Quiet(GenerateJsonSchema):
    """Says nothing about defaults that are bytes: a file writes hexadecimal digits."""

    def emit_warning(self, kind: JsonSchemaWarningKind, detail: str) -> None:
        """Every other kind is told."""
        if kind != "non-serializable-default":
            super().emit_warning(kind, detail)


def file_schema(kind: str, version: int, description: str, *models: type[BaseModel]) -> dict[str, Any]:
    """JSON schema (draft 2020-12) of a kind of file for editors; with two models the second one has ``stations``."""
    found = [model.model_json_schema(by_alias=True, schema_generator=_Quiet) for model in models]
    parts = {name: part for each in found for name, part in each.pop("$defs", {}).items()}
    body = found[0]
    if len(found) > 1:
        body = {"type": "object", "if": {"required": ["stations"]}, "then": found[1], "else": found[0]}
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": f"urn:plcgen:{kind}:{version}"}
    more = {"$defs": parts} if parts else {}
    return {**head, "title": f"plcgen {kind}", **in_a_file({**body, **more}), "description": description}
