"""JSON schemas of files as an editor needs them: what the tool reads, in the spelling of a file.

pydantic describes what stands in memory. In a file an integer may be ``16#B02E``, which is a text to every YAML reader
but ours, and a duration has a unit, its default value too.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaWarningKind

from plcgen.project.variables import WHOLE

VERSION = 1
"""Of files without a version of their own."""
S7_NUMBER = "^((B|W|DW|L|BYTE|WORD|DWORD)#)?(16#[0-9A-Fa-f_]+|8#[0-7_]+|2#[01_]+)$"
"""Numbers in the spelling of STEP 7, see ``plcgen.base.files.yaml``."""
DURATION = r"^[0-9]{1,7}\s*(ms|s|min|h)$"


def suggested(names: Iterable[str]) -> dict[str, Any]:
    """Any text, of which an editor offers some."""
    return {"anyOf": [{"enum": list(names)}, {"type": "string"}]}


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


def with_variables(definitions: dict[str, Any]) -> dict[str, Any]:
    """Definitions in which ``$(name)`` may stand for every value; ``Variable`` is a new one of them."""
    found = {name: _inside(each) for name, each in definitions.items()}
    return {**found, "Variable": {"type": "string", "pattern": WHOLE}}


def _inside(schema: Any) -> Any:
    """A schema with variables for the values below it."""
    if isinstance(schema, list):
        return [_inside(each) for each in schema]
    if not isinstance(schema, dict):
        return schema
    found = {key: value if key in _DATA else _inside(value) for key, value in schema.items()}
    if isinstance(found.get("properties"), dict):
        found["properties"] = {name: _or_variable(each) for name, each in found["properties"].items()}
    for key in ("items", "additionalProperties"):
        if isinstance(found.get(key), dict):
            found[key] = _or_variable(found[key])
    return found


_BESIDE = ("description", "default", "examples", "maxLength")


def _or_variable(schema: dict[str, Any]) -> dict[str, Any]:
    """The schema of a value, which may be a variable: said only where not every text will do."""
    if _any_text(schema):
        return schema
    beside = {key: schema[key] for key in _BESIDE if key in schema}
    rest = {key: value for key, value in schema.items() if key not in beside}
    options = rest["anyOf"] if set(rest) == {"anyOf"} else [rest]
    return {**beside, "anyOf": [*options, {"$ref": "#/$defs/Variable"}]}


def _any_text(schema: dict[str, Any]) -> bool:
    if "anyOf" in schema:
        return any(_any_text(each) for each in schema["anyOf"])
    kinds = schema.get("type", "")
    return "string" in ([kinds] if isinstance(kinds, str) else kinds) and not {"pattern", "enum", "const"} & set(schema)


@dataclass(slots=True)
class Requirements:
    """Takes the required keys out of a schema and its ``definitions``: what is taken out may stand in another file.

    Below the key ``whole`` they stay.
    """

    definitions: dict[str, Any]
    whole: str
    taken: dict[str, dict[str, Any]] = field(default_factory=dict)

    def take(self, schema: dict[str, Any]) -> dict[str, Any]:
        """A schema that says again what was taken out of this one."""
        name = schema.get("$ref", "").rpartition("/")[2]
        if name not in self.taken:
            found = self.take_below(self.definitions[name] if name else schema)
            if not name:
                return found
            self.taken[name] = found
        return self.taken[name]

    def take_below(self, schema: dict[str, Any]) -> dict[str, Any]:
        """The same for a schema that is not named."""
        found: dict[str, Any] = {key: schema.pop(key) for key in ("required", "minProperties") if key in schema}
        keys = {name: each for name, each in schema.get("properties", {}).items() if name != self.whole}
        below = {name: more for name, each in keys.items() if (more := self.take(each))}
        if below:
            found["properties"] = below
        if isinstance(schema.get("additionalProperties"), dict) and (more := self.take(schema["additionalProperties"])):
            found["additionalProperties"] = more
        return found


class _Quiet(GenerateJsonSchema):
    """Says nothing about defaults that are bytes: a file writes hexadecimal digits."""

    def emit_warning(self, kind: JsonSchemaWarningKind, detail: str) -> None:
        """Every other kind is told."""
        if kind != "non-serializable-default":
            super().emit_warning(kind, detail)


def file_schema(kind: str, description: str, *models: type[BaseModel]) -> dict[str, Any]:
    """JSON schema (draft 2020-12) of a kind of file for editors; with two models the second one has ``stations``."""
    found = [model.model_json_schema(by_alias=True, schema_generator=_Quiet) for model in models]
    parts = {name: part for each in found for name, part in each.pop("$defs", {}).items()}
    body = found[0]
    if len(found) > 1:
        body = {"type": "object", "if": {"required": ["stations"]}, "then": found[1], "else": found[0]}
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": f"urn:plcgen:{kind}:{VERSION}"}
    more = {"$defs": parts} if parts else {}
    return {**head, "title": f"plcgen {kind}", **in_a_file({**body, **more}), "description": description}
