"""The shape of the sections ``drives`` and ``jobs`` of a spec.

Short forms (``P50303``, ``M50.0``, ``10s``) are widened to the full form before validation, so that every later
step sees one shape. Whatever needs knowledge of devices, types or targets is checked later, by the rules.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from plcgen.input.validation import StrictModel
from plcgen.project.schema import BlockName, Duration, Naming, Text, Trigger, Value, trigger_short
from plcgen.protocols.ds47.devices import offer_names


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


class DriveSections(StrictModel):
    """Drives and their jobs."""

    drives: dict[str, Drive] = Field(min_length=1)
    jobs: dict[str, Job] = Field(min_length=1)


class OptionalDriveSections(DriveSections):
    """Drives and their jobs in a spec that has jobs of another protocol."""

    drives: dict[str, Drive] = Field(default_factory=dict)
    jobs: dict[str, Job] = Field(default_factory=dict)


def complete(schema: dict[str, Any]) -> None:
    """Put the short forms of jobs into the JSON schema of a spec."""
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
