"""The shape of the ``ppi`` part of a spec: masters, their stations and jobs. Imported only if a spec has one."""

from __future__ import annotations

from types import MappingProxyType
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, WithJsonSchema

from plcgen.base.files.printed import Name, Printed, Value
from plcgen.base.files.validation import StrictModel
from plcgen.ppi.wire.profiles import profiles
from plcgen.project.editor import suggested
from plcgen.project.schema import (
    COMMENT,
    OF_AN_INPUT,
    ONE_OR_MORE,
    TRIGGER_SCHEMA,
    BlockName,
    CpuName,
    Duration,
    Text,
    Trigger,
    short_item,
    short_item_schema,
    short_items,
    short_items_schema,
    trigger_short,
)

Module = Literal["cm1241", "cb1241", "cm-ptp", "cp341"]
VERBS = ("read", "write", "run", "stop")


_FIRMWARE = r"^[Vv]?[0-9]{1,2}\.[0-9]{1,2}(\.[0-9]{1,2})?$"
Firmware = Annotated[
    str,
    BeforeValidator(str),
    Field(pattern=_FIRMWARE),
    WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string", "pattern": _FIRMWARE}]}),
]


class PpiBuffer(StrictModel):
    """A telegram table or response data block; further telegrams of a job get numbers and names of their own."""

    db: int | None = Field(None, ge=1, le=65535, description="DB number; absent: automatic")
    name: Name | None = Field(None, min_length=1, max_length=125, description="DB name; absent: from the job's name")


class PpiReadItem(StrictModel):
    """One address to read."""

    item: Name = Field(description="VB100, VW100, VD100, V100.3, M0.0, SMB34, AIW0, T32, C5, VB100[20] or a symbol")
    as_: Name | None = Field(None, alias="as", description="name of the block's output")
    type: Name | None = Field(None, description="type of the output, e.g. Int or Real; default Byte, Word, DWord, Bool")
    comment: Text | None = Field(None, description=COMMENT)


class PpiWriteItem(StrictModel):
    """One address to write; without a value it becomes an input of the block."""

    item: Name = Field(description="VB100, VW100, VD100, V100.3, M0.0, Q0.0 or a symbol")
    value: Value | None = Field(None, description="constant; absent: block input")
    as_: Name | None = Field(None, alias="as", description="name of the block's input")
    type: Name | None = Field(None, description="type of the input, e.g. Int or Real; default Byte, Word, DWord, Bool")
    start: Annotated[Value | None, OF_AN_INPUT] = Field(None, description="start value of the input")
    comment: Text | None = Field(None, description=COMMENT)


class PpiStation(StrictModel):
    """One S7-200 on the line."""

    address: int = Field(ge=0, le=126, description="PPI address of the CPU; 2 is the factory setting")
    cpu: CpuName = Field(
        "226", description="221, 222, 224R1 (release 1), 224, 224XP, 226, ST20 or ST40: how much memory it has"
    )
    symbols: Printed | dict[Name, Name] | None = Field(
        None, description="CSV export of the Micro/WIN symbol table beside the spec, or symbols with their addresses"
    )
    comment: Text | None = Field(None, description=COMMENT)


class MasterJob(StrictModel):
    """One job: read or write some addresses of one station, or switch it to RUN or STOP."""

    FOREIGN = MappingProxyType(
        dict.fromkeys(
            ("every", "interval", "period", "repeat", "poll"), "cycle: 1s repeats the job while execute is TRUE"
        )
    )

    station: Name = Field(description="key of a station of this master")
    read: Annotated[tuple[Annotated[PpiReadItem, short_item("item")], ...], ONE_OR_MORE] | None = Field(
        None, description="addresses or symbols to read"
    )
    write: Annotated[tuple[PpiWriteItem, ...], short_items("item")] | None = Field(
        None, description="address: value, address: {value, as, type, start}, or a list of such"
    )
    run: Literal[True] | None = Field(None, description="true: switch the CPU to RUN")
    stop: Literal[True] | None = Field(None, description="true: switch the CPU to STOP")
    cycle: Duration | None = Field(None, description="repeat while execute is TRUE; absent: once per rising edge")
    request: PpiBuffer = Field(PpiBuffer(), description="request DB, the telegram table")
    response: PpiBuffer = Field(PpiBuffer(), description="response DB")
    trigger: Annotated[Trigger, BeforeValidator(trigger_short)] | None = Field(
        None, description="flag that starts the job, or a flag per signal"
    )
    timeout: Duration = Field(10_000, description="whole job, waiting for the port and all retries included")
    split: Literal["auto", "never"] = Field("auto", description="whether the job may be split into several telegrams")
    merge: bool = Field(
        default=True, description="whether neighbouring addresses may share an item and its return code"
    )
    comment: Text | None = Field(None, description=COMMENT)


class PpiMaster(StrictModel):
    """One serial port as PPI master."""

    module: Module = Field(description="cm1241, cb1241 (S7-1200), cm-ptp (S7-1200/1500) or cp341 (S7-300)")
    firmware: Firmware | None = Field(None, description="firmware of the module, to be checked")
    port: int | None = Field(None, ge=1, le=65535, description="hardware identifier of the port (S7-1200/1500)")
    address: int | None = Field(None, ge=0, le=32767, description="logical address of the CP 341 (S7-300/400)")
    own_address: int = Field(0, ge=0, le=126, description="PPI address of this master; 0 is that of a PC")
    baud: Annotated[int, WithJsonSchema({"enum": [9600, 19200]})] = Field(9600, description="9600 or 19200")
    stations: dict[Name, PpiStation] = Field(
        min_length=1, description="stations on the line by key, such as {press: {address: 2}}"
    )
    jobs: dict[Name, MasterJob] = Field(min_length=1, description="jobs by key")
    block: BlockName = Field(BlockName(), description="the master's function block")
    instance: BlockName = Field(BlockName(), description="the function block's instance DB")
    ob1_cycle: Duration = Field(50, ge=1, description="longest cycle time of OB1; the timeouts are computed with it")
    ack_timeout: Duration | None = Field(None, description="waiting for E5 after a request; absent: computed")
    reply_timeout: Duration | None = Field(None, description="waiting for the reply after a poll; absent: computed")
    retry_pause: Duration = Field(50, description="pause before a telegram is repeated")
    poll_pause: Duration = Field(20, description="pause before the next poll of a station that is not ready")
    retries: int = Field(3, ge=0, le=20, description="repetitions of one telegram that is not answered")
    polls: int = Field(10, ge=1, le=100, description="polls of one request that is answered with E5")
    comment: Text | None = Field(None, description=COMMENT)


class PpiSection(StrictModel):
    """PPI masters."""

    ppi: dict[Name, PpiMaster] = Field(min_length=1, description="PPI masters, one per serial port")


def complete(schema: dict[str, Any]) -> None:
    """Put the short forms of masters' jobs into the JSON schema of a spec."""
    definitions = schema["$defs"]
    job = definitions["MasterJob"]["properties"]
    shapes = {
        "read": short_item_schema("PpiReadItem"),
        "write": short_items_schema(definitions, "PpiWriteItem", "item", lists=False),
        "trigger": TRIGGER_SCHEMA,
    }
    station = definitions["PpiStation"]["properties"]["cpu"]
    station["anyOf"] = [*suggested(profiles())["anyOf"], {"type": "integer"}]
    station.pop("type", None)
    for key, shape in shapes.items():
        job[key] = {**shape, "description": job[key]["description"]}
