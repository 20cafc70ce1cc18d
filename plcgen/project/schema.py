"""The shape of a job spec; every part of it as a pydantic model.

Short forms (``P50303``, ``M50.0``, ``10s``) are widened to the full form before validation, so that every later
step sees one shape. Whatever needs knowledge of devices, types or targets is checked later, by the rules.
"""

from __future__ import annotations

import re
from collections.abc import Container
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, WithJsonSchema

from plcgen.input.validation import StrictModel, keys_at
from plcgen.protocols.ds47.devices import offer_names

Family = Literal["s7-300", "s7-400", "s7-1200", "s7-1500"]
Toolchain = Literal[
    "step7-v5", "tia-v13sp1", "tia-v14", "tia-v14sp1", "tia-v15", "tia-v15.1",
    "tia-v16", "tia-v17", "tia-v18", "tia-v19", "tia-v20", "tia-v21",
]  # fmt: skip
Naming = Literal["style", "faq"]

_DURATION = re.compile(r"([0-9]{1,7})\s*(ms|s|min)\Z")
_UNIT_MS = {"ms": 1, "s": 1000, "min": 60_000}


def _duration(value: object) -> object:
    if isinstance(value, str):
        match = _DURATION.match(value)
        if match:
            return int(match[1]) * _UNIT_MS[match[2]]
    raise ValueError("a duration is a number with a unit: 200ms, 10s or 1min")


def _text(value: object) -> object:
    return {"en-US": value} if isinstance(value, str) else value


def _read_item(value: object) -> object:
    return {"parameter": value} if isinstance(value, str) else value


def _write_items(value: object) -> object:
    if not isinstance(value, dict):
        return value
    items: list[dict[str, Any]] = []
    for key, entry in value.items():
        if isinstance(entry, dict):
            items.append({**entry, "parameter": str(key)})
        else:
            items.append({"parameter": str(key), "value": entry})
    return tuple(items)


def trigger_short(value: object) -> object:
    """Widen ``M50.0`` to ``{execute: M50.0}``."""
    return {"execute": value} if isinstance(value, str) else value


Duration = Annotated[
    int,
    BeforeValidator(_duration),
    Field(ge=1, le=3_600_000),
    WithJsonSchema({"type": "string", "pattern": r"^[0-9]{1,7}\s*(ms|s|min)$", "examples": ["200ms", "10s"]}),
]
Text = Annotated[
    dict[str, str],
    BeforeValidator(_text),
    WithJsonSchema(
        {"anyOf": [{"type": "string"}, {"type": "object", "additionalProperties": {"type": "string"}}]},
    ),
]
Value = bool | int | float | str


class Numbers(StrictModel):
    """First number of each automatic numbering range."""

    fb: int = Field(470, ge=1, le=65535, description="first automatic FB number")
    db: int = Field(470, ge=1, le=65535, description="first automatic DB number")
    udt: int = Field(470, ge=1, le=65535, description="first automatic UDT number (STEP 7 V5)")


class Plc(StrictModel):
    """The controller the blocks are for."""

    name: str = Field(min_length=1, max_length=120, description="project or station name, used in headers")
    family: Family = Field(description="CPU family")
    toolchain: Toolchain = Field(description="engineering tool that imports the sources")
    names: Naming = Field("style", description="member names: style guide (camelCase) or FAQ 109750712")
    languages: tuple[str, ...] = Field(
        ("en-US",), min_length=1, max_length=16, description="comment languages; the first is the main one"
    )
    numbers: Numbers = Field(Numbers(), description="where automatic block numbers start")


class ParameterDef(StrictModel):
    """A drive parameter that the device catalogue does not hold (or holds differently)."""

    type: str = Field(description="DS47 data type, e.g. FloatingPoint, Unsigned16, OctetString[4]")
    name: str | None = Field(None, description="symbolic name, snake_case; becomes the block's member name")
    title: str | None = Field(None, description="text for comments")
    unit: str | None = None
    access: Literal["r", "w", "rw"] = "rw"
    array: int | None = Field(None, ge=1, le=65535, description="number of indexes; absent: not indexed")
    min: float | None = None
    max: float | None = None
    default: Value | None = None
    bico: bool = Field(default=False, description="value is a BICO source such as r0722.0")


class Drive(StrictModel):
    """One drive the PLC talks to."""

    device: str = Field(
        description="device profile, see plcgen schema --devices, or the path of one beside the spec",
        json_schema_extra=offer_names,
    )
    address: int | None = Field(None, ge=0, le=65535, description="logical base address (S7-300/400)")
    output_address: bool = Field(
        default=False, description="the address belongs to an output-only module (sets bit 15)"
    )
    hardware_id: int | None = Field(None, ge=0, le=65535, description="hardware identifier (S7-1200/1500)")
    drive_object: int | None = Field(None, ge=0, le=255, description="drive object / axis; default of the device")
    record_index: int | Literal["profibus", "profinet-local", "profinet-global"] | None = Field(
        None, description="data record index; default of the device: 47, 16#B02E or 16#B02F"
    )
    parameters: dict[str, ParameterDef] = Field(default_factory=dict, description="parameters outside the catalogue")
    comment: Text | None = None


class ReadItem(StrictModel):
    """One parameter to read."""

    parameter: str = Field(description="P50303, p2155[1..2], r0945[0..7] or a catalogue name")
    as_: str | None = Field(None, alias="as", description="name of the block's output")
    type: str | None = Field(None, description="DS47 data type if the catalogue has none")
    comment: Text | None = None


class WriteItem(StrictModel):
    """One parameter to write; without a value it becomes an input of the block."""

    parameter: str = Field(description="P50304, p2155[1..2] or a catalogue name")
    value: Value | tuple[Value, ...] | None = Field(None, description="constant; absent: block input")
    as_: str | None = Field(None, alias="as", description="name of the block's input")
    type: str | None = Field(None, description="DS47 data type if the catalogue has none")
    start: Value | tuple[Value, ...] | None = Field(None, description="start value of the input")
    comment: Text | None = None


class Buffer(StrictModel):
    """A request or response data block."""

    db: int | None = Field(None, ge=1, le=65535, description="DB number; absent: automatic")
    name: str | None = Field(None, min_length=1, max_length=125, description="DB name; absent: from the job's name")
    size: int | None = Field(None, ge=1, le=65534, description="pinned length in bytes; absent: as needed")
    members: dict[str, str] = Field(default_factory=dict, description="own member names: generated name -> yours")


class BlockName(StrictModel):
    """Name and number of the job's function block or its instance DB."""

    name: str | None = Field(None, min_length=1, max_length=125)
    number: int | None = Field(None, ge=1, le=65535)


class Trigger(StrictModel):
    """Absolute flags of the job's call; absent ones are symbolic members of the control DB."""

    execute: str | None = Field(None, description="bit that starts the job, e.g. M50.0")
    busy: str | None = None
    done: str | None = None
    error: str | None = None
    status: str | None = Field(None, description="word for the status, e.g. MW52")


class Job(StrictModel):
    """One parameter job: read some parameters or write some, on one drive."""

    drive: str = Field(description="key of a drive")
    read: tuple[Annotated[ReadItem, BeforeValidator(_read_item)], ...] | None = Field(
        None, description="parameters to read"
    )
    write: Annotated[tuple[WriteItem, ...], BeforeValidator(_write_items)] | None = Field(
        None, description="parameter: value, parameter: {value, as, type, start}, or a list of such"
    )
    request: Buffer = Field(Buffer(), description="request DB")
    response: Buffer = Field(Buffer(), description="response DB")
    block: BlockName = Field(BlockName(), description="the job's function block")
    instance: BlockName = Field(BlockName(), description="the function block's instance DB")
    names: Naming | None = Field(None, description="overrides plc.names for this job")
    trigger: Annotated[Trigger, BeforeValidator(trigger_short)] | None = Field(
        None, description="flag that starts the job, or a flag per signal"
    )
    reference: int | None = Field(None, description="request reference of the start values, 1..255")
    timeout: Duration = Field(10_000, description="whole job, all retries included")
    retry_pause: Duration = Field(200, description="pause before a retry or the next poll")
    retries: int | None = Field(
        None,
        ge=0,
        le=10_000,
        description="bound on retries of one telegram; absent: as many as have pauses of 80 % of the timeout together",
    )
    split: Literal["auto", "never"] = Field("auto", description="may the job be split into several telegrams")
    allow: tuple[str, ...] = Field((), description="dangerous parameters this job may write")
    comment: Text | None = None


class Spec(StrictModel):
    """A complete job spec: one PLC, its drives, their jobs."""

    version: Literal[1] = Field(1, description="version of the spec format")
    plc: Plc
    drives: dict[str, Drive] = Field(min_length=1)
    jobs: dict[str, Job] = Field(min_length=1)

    @property
    def masters(self) -> dict[str, Any]:
        """PPI masters by key: see ``ppi_schema``, which is imported only for a spec that has some."""
        return {}


def model_of(keys: Container[str]) -> type[Spec]:
    """Model of a spec that has these keys: masters and what belongs to them are imported only for a spec with some."""
    if "ppi" in keys:
        from plcgen.protocols.ppi.schema import SpecWithPpi

        return SpecWithPpi
    return Spec


def json_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of a job spec for editors, short forms included."""
    from plcgen.protocols.ppi.schema import SpecWithPpi, complete

    schema = SpecWithPpi.model_json_schema(by_alias=True)
    definitions = schema["$defs"]
    items, text = {"$ref": "#/$defs/ReadItem"}, {"type": "string"}
    value = {"type": ["boolean", "integer", "number", "string", "null"]}
    entry = {**definitions["WriteItem"], "required": [], "title": "WriteEntry"}
    entry["properties"] = {name: what for name, what in entry["properties"].items() if name != "parameter"}
    definitions["WriteEntry"] = entry
    by_parameter = {"anyOf": [value, {"type": "array", "items": value}, {"$ref": "#/$defs/WriteEntry"}]}
    job = definitions["Job"]["properties"]
    job["read"] = {"type": "array", "items": {"anyOf": [text, items]}, "description": job["read"]["description"]}
    job["write"] = {
        "anyOf": [
            {"type": "object", "additionalProperties": by_parameter},
            {"type": "array", "items": {"$ref": "#/$defs/WriteItem"}},
        ],
        "description": job["write"]["description"],
    }
    job["trigger"] = {"anyOf": [text, {"$ref": "#/$defs/Trigger"}], "description": job["trigger"]["description"]}
    complete(schema, definitions)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema, "title": "plcgen job spec"}


def field_names(path: tuple[str | int, ...]) -> list[str]:
    """Keys that are allowed at a path of the spec, for "did you mean"; empty if the path is no mapping."""
    return keys_at(model_of({"ppi"}), path)
