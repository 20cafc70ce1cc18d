"""The shape of the sections ``drives`` and ``jobs`` of a spec.

Short forms (``P50303``, ``M50.0``, ``10s``) are widened to the full form before validation, so that every later
step sees one shape. Whatever needs knowledge of devices, types or targets is checked later, by the rules.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import AfterValidator, BeforeValidator, Field, WithJsonSchema, create_model, model_validator

from plcgen.base.files.printed import MAX_TEXT, Name, Printed, Reason
from plcgen.base.files.validation import StrictModel, problem
from plcgen.base.plugins import expect_free
from plcgen.ds47.device import Parameter, ParameterDef, ParameterNumber
from plcgen.ds47.devices import named_parameters, offer_names
from plcgen.ds47.kind import JobKind, ReadItem, WriteItem
from plcgen.ds47.objects import ObjectType
from plcgen.ds47.recipes import RecipeEntry
from plcgen.ds47.registry import GROUP, kinds
from plcgen.ds47.wire.formats import format_names
from plcgen.project.editor import suggested
from plcgen.project.schema import (
    COMMENT,
    ONE_OR_MORE,
    TRIGGER_SCHEMA,
    BlockName,
    Duration,
    Naming,
    Text,
    Trigger,
    short_item_schema,
    trigger_short,
)


def _address(value: int) -> int:
    if value > _LAST_ADDRESS:
        help_ = f"write address: {value & _LAST_ADDRESS}, and output_address: true if the module has outputs only"
        raise problem(f"address {value} is over {_LAST_ADDRESS}: bit 15 of an ID means output", help_=help_)
    return value


def _hardware_id(value: int | str) -> int | str:
    where = "it is in the device view or among the system constants"
    if value == 0:
        raise problem("0 is not a hardware identifier", help_=where)
    if isinstance(value, str) and '"' in value:
        raise problem(f"{value!r} is not the name of a system constant", help_=where)
    return value


_LAST_ADDRESS = 32767
Address = Annotated[
    int,
    Field(ge=0, le=65535),
    AfterValidator(_address),
    WithJsonSchema({"type": "integer", "minimum": 0, "maximum": _LAST_ADDRESS}),
]
HardwareNumber = Annotated[
    int, Field(ge=0, le=65535), WithJsonSchema({"type": "integer", "minimum": 1, "maximum": 65535})
]
HardwareId = Annotated[HardwareNumber | Name, AfterValidator(_hardware_id)]


class DriveSettings(StrictModel):
    """What a drive may say, alone or in a unit."""

    address: Address | None = Field(None, description="logical base address (S7-300/400), 0..32767")
    output_address: bool = Field(
        default=False, description="the address belongs to an output-only module (sets bit 15)"
    )
    hardware_id: HardwareId | None = Field(
        None, description="hardware identifier (S7-1200/1500), 1..65535, or the name of its system constant"
    )
    drive_object: int | None = Field(None, ge=0, le=255, description="drive object / axis; default of the device")
    object_type: ObjectType | None = Field(
        None, description="type of the drive object, where its number does not say it: vector, a_inf, tm31, .."
    )
    parameters: dict[Name, ParameterDef] = Field(default_factory=dict, description="parameters outside the catalogue")
    comment: Text | None = Field(None, description=COMMENT)


RecordIndex = Annotated[
    int | Literal["profibus", "profinet-local", "profinet-global"] | None,
    Field(None, description="data record index; default of the device: 47, 16#B02E or 16#B02F"),
]
Profile = Annotated[
    Printed,
    Field(
        description="device profile, see plcgen devices, or the path of one beside the spec",
        json_schema_extra=offer_names,
    ),
]


class UnitSettings(StrictModel):
    """What belongs to the parameter server of a device: its profile, its data record, how long jobs wait for it."""

    device: Profile
    record_index: RecordIndex = None
    wait: Duration = Field(60_000, description="longest time that a job waits for its turn")


class DriveEntry(DriveSettings, UnitSettings):
    """One drive the PLC talks to; it is a unit of its own."""


class UnitEntry(UnitSettings):
    """A device whose drive objects share one parameter server, whatever their addresses: a control unit."""

    drives: dict[Name, DriveSettings] = Field(min_length=1, description="the drive objects by key")


class PlacedDrive(NamedTuple):
    """A drive of the spec with its unit: keys, where it stands, what it says, what its unit says."""

    key: str
    unit: str
    path: tuple[str, ...]
    drive: DriveSettings
    settings: UnitSettings
    settings_path: tuple[str, ...]


def _signed(value: object) -> object:
    if not isinstance(value, dict):
        help_ = "for example {P971: saved once after commissioning}"
        raise problem("a sign-off gives each parameter by number, with the reason", help_=help_)
    return value


SignOff = Annotated[
    dict[ParameterNumber, Reason],
    BeforeValidator(_signed),
    WithJsonSchema(
        {
            "type": "object",
            "propertyNames": {"pattern": "^[PpRr]?[0-9]{1,9}$"},
            "additionalProperties": {"type": "string", "maxLength": MAX_TEXT},
        }
    ),
]
"""Parameters that a job may write although that can do harm, and why."""


def _restored(value: object) -> object:
    if isinstance(value, str) and value != "restore":
        raise problem(
            f'"{value}" is not something that can be done on an error', help_="write restore, or leave on_error out"
        )
    return {} if value == "restore" else value


class ErrorSettings(StrictModel):
    """What a job that fails does with what it has written."""

    restore: Literal["stopped", "running"] = Field(
        "stopped",
        description="stopped: old values come back while the drive reports that it does not run; running: always",
    )
    reason: Reason | None = Field(None, description="why restoring may happen while the drive runs")

    @model_validator(mode="after")
    def _signed_off(self) -> ErrorSettings:
        if self.restore == "running" and not self.reason:
            help_ = "for example {restore: running, reason: ramps may change at any speed}"
            raise problem("restoring while the drive runs needs a reason", help_=help_)
        return self


class BufferSettings(StrictModel):
    """A request or response data block."""

    db: int | None = Field(None, ge=1, le=65535, description="DB number; absent: automatic")
    name: Name | None = Field(None, min_length=1, max_length=125, description="DB name; absent: from the job's name")
    size: int | None = Field(None, ge=1, le=65534, description="pinned length in bytes; absent: as needed")
    members: dict[Name, Name] = Field(default_factory=dict, description="own member names: generated name -> yours")


class JobTarget(StrictModel):
    """What every job begins with."""

    drive: Annotated[tuple[Name, ...], ONE_OR_MORE] = Field(
        min_length=1, description="key of a drive, or a list of them: one function block, an instance for each"
    )


class JobSettings(StrictModel):
    """What every job may say, whatever its kind."""

    request: BufferSettings = Field(BufferSettings(), description="request DB")
    response: BufferSettings = Field(BufferSettings(), description="response DB")
    block: BlockName = Field(BlockName(), description="the job's function block")
    buffers: Literal["instance", "db"] = Field(
        "instance", description="where the telegrams are: in the block's instance, or in data blocks of their own"
    )
    names: Naming | None = Field(None, description="overrides plc.names for this job")
    verify: Literal["readback"] | None = Field(
        None, description="readback: what was written is read again and compared in the same run"
    )
    on_error: Annotated[ErrorSettings, BeforeValidator(_restored)] | None = Field(
        None, description="restore: if what was read back is not right, the old values are written back"
    )
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
    split: Literal["auto", "never"] = Field("auto", description="whether the job may be split into several telegrams")
    allow: SignOff = Field(default_factory=dict, description="dangerous parameters this job may write: why")
    allow_safety: SignOff = Field(default_factory=dict, description="Safety parameters this job may write: why")
    cycle: Annotated[Duration, Field(ge=100)] | None = Field(
        None, description="repeat while execute is TRUE, which it is at start; absent: once per rising edge"
    )
    comment: Text | None = Field(None, description=COMMENT)


class JobEntry(JobSettings, JobTarget):
    """One job on one drive; the keys of its kind stand between ``drive`` and the settings, see ``drive_sections``."""

    FOREIGN = MappingProxyType(
        {
            key: meant
            for keys, meant in (
                ("every interval period repeat poll", "cycle: 1s lets the job run every second"),
                ("wait until delay", "sequence: [{until: {r722.0: 1, timeout: 5s}}] waits for a value"),
                ("step steps", "sequence: [{write: {P10: 1}}, {until: {P10: 1}}] has steps"),
                ("sign_off reason", "allow: {P971: the reason} signs a write off"),
            )
            for key in keys.split()
        }
    )

    @model_validator(mode="before")
    @classmethod
    def _without_void(cls, given: Any) -> Any:
        """``save: ram`` beside what is written says that nothing is saved."""
        if not isinstance(given, dict):
            return given
        void = {one.key for one in kinds() if one.void is not None and one.void(given.get(one.key))}
        others = {kind.key for kind in kinds() if kind.writes} - void
        return {key: value for key, value in given.items() if key not in void} if others & given.keys() else given


class DriveSections(StrictModel):
    """Units, drives and their jobs."""

    units: dict[Name, UnitEntry] = Field(default_factory=dict, description="devices with several drive objects")
    drives: dict[Name, DriveEntry] = Field(default_factory=dict, description="drives by key")
    recipes: dict[Name, RecipeEntry] = Field(default_factory=dict, description="parameter sets by key")
    jobs: Mapping[Name, JobEntry] = Field(min_length=1, description="jobs by key")

    def items(self, job: JobEntry, kind: JobKind) -> tuple[ReadItem | WriteItem, ...]:
        """The accesses of a job of a kind; none if it names a recipe that is not there."""
        value = getattr(job, kind.key)
        if not kind.recorded:
            return kind.items(value)
        return kind.items(self.recipes[value]) if value in self.recipes else ()

    def placed(self) -> Iterator[PlacedDrive]:
        """Every drive, those of units first."""
        for unit, entry in self.units.items():
            for key, drive in entry.drives.items():
                yield PlacedDrive(key, unit, ("units", unit, "drives", key), drive, entry, ("units", unit))
        for key, own in self.drives.items():
            yield PlacedDrive(key, key, ("drives", key), own, own, ("drives", key))


@functools.cache
def drive_sections(*, alone: bool) -> type[DriveSections]:
    """Shape of drives and jobs with every kind of job; both may be missing beside another protocol.

    Raises PluginError if a kind has a key that every job has.
    """
    expect_free(GROUP, (kind.key for kind in kinds()), [*JobTarget.model_fields, *JobEntry.model_fields])
    shapes: dict[str, Any] = {
        kind.key: (kind.shape | None, Field(None, description=kind.description)) for kind in kinds()
    }
    keys = create_model("JobKinds", __base__=JobTarget, **shapes)
    job = create_model("Job", __base__=(JobEntry, keys), __doc__="One parameter job on one drive.")
    least: dict[str, Any] = {"min_length": 1} if alone else {"default_factory": dict}
    return create_model(
        "DriveSections",
        __base__=DriveSections,
        jobs=(dict[Name, job], Field(**least, description="jobs by key")),
    )


def _offer(definition: dict[str, Any], key: str, names: Iterable[str]) -> None:
    """Let an editor complete a text, which may be null if it could be before."""
    entry = definition["properties"][key]
    null = [{"type": "null"}] if "null" in str(entry.pop("anyOf", "")) else []
    entry.pop("type", None)
    entry["anyOf"] = [*suggested(names)["anyOf"], *null]


def _offer_parameters(definitions: dict[str, Any], names: Mapping[str, list[Parameter]]) -> None:
    """Let an editor complete the names of parameters wherever one may stand: in jobs, steps and recipes."""
    for name in ("ReadItem", "RecipeItem", "WriteItem"):
        _offer(definitions[name], "parameter", names)
    job, step, recipe = (definitions[name]["properties"] for name in ("Job", "SequenceStep", "RecipeEntry"))
    for texts, more in (
        (job["read"]["anyOf"], ("main_values",)), (step["read"]["anyOf"], ()), (recipe["parameters"]["anyOf"], ()),
    ):  # fmt: skip
        texts[0] = texts[1]["items"]["anyOf"][0] = suggested([*more, *names])
    write, compare, written = (shape["anyOf"][0] for shape in (job["write"], job["compare"], step["write"]))
    definitions["WriteValue"] = write["additionalProperties"]
    for shape in (write, compare, written):
        shape["additionalProperties"] = {"$ref": "#/$defs/WriteValue"}
    for shape, access in ((write, "w"), (compare, "r"), (written, "w"), (step["until"]["anyOf"][1], "r")):
        offered = {
            name: {**shape["additionalProperties"], "description": called[-1].title}
            for name, called in names.items()
            if any(access in parameter.access for parameter in called)
        }
        shape["properties"] = {**offered, **shape.get("properties", {})}


def complete(schema: dict[str, Any], profiles: Iterable[str] = ()) -> None:
    """Put the short forms of jobs, data types and names of parameters into the JSON schema of a spec.

    ``profiles`` are files of the user's own. Raises DiagnosticError if one is no profile.
    """
    definitions = schema["$defs"]
    for name in ("ParameterDef", "ReadItem", "RecipeItem", "WriteItem"):
        _offer(definitions[name], "type", format_names())
    parameters = definitions["RecipeEntry"]["properties"]["parameters"]
    items = short_item_schema("RecipeItem")["anyOf"][:2]
    definitions["RecipeEntry"]["properties"]["parameters"] = {"anyOf": items, "description": parameters["description"]}
    job = definitions["Job"]["properties"]
    for kind in kinds():
        if kind.short is not None:
            job[kind.key] = {**kind.short(definitions), "description": kind.description}
    _offer_parameters(definitions, named_parameters(profiles))
    restores: dict[str, Any] = {"anyOf": [{"const": "restore"}, {"$ref": "#/$defs/ErrorSettings"}, {"type": "null"}]}
    job["on_error"] = {**restores, "description": job["on_error"]["description"]}
    job["drive"] = {"anyOf": [{"type": "string"}, job["drive"]], "description": job["drive"]["description"]}
    job["trigger"] = {**TRIGGER_SCHEMA, "description": job["trigger"]["description"]}
