"""The shape of a job spec: what all protocols share, and how their sections come together.

Short forms (``P50303``, ``M50.0``, ``10s``) are widened to the full form before validation, so that every later
step sees one shape. Whatever needs knowledge of devices, types or targets is checked later, by the rules.
"""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, ValidationInfo, WithJsonSchema

from plcgen.base.files.printed import Name, Printed
from plcgen.base.files.validation import StrictModel, problem
from plcgen.project.editor import DURATION
from plcgen.project.target import toolchain_id
from plcgen.project.variables import NAME
from plcgen.s7.types.system import Family

Toolchain = Literal[
    "step7-v5", "tia-v13sp1", "tia-v14", "tia-v14sp1", "tia-v15", "tia-v15.1",
    "tia-v16", "tia-v17", "tia-v18", "tia-v19", "tia-v20", "tia-v21",
]  # fmt: skip
Naming = Literal["style", "faq"]

_DURATION = re.compile(r"([0-9]{1,7})\s*(ms|s|min|h)\Z")
_UNIT_MS = {"ms": 1, "s": 1000, "min": 60_000, "h": 3_600_000}


def _duration(value: object) -> object:
    if isinstance(value, str):
        match = _DURATION.match(value)
        if match:
            return int(match[1]) * _UNIT_MS[match[2]]
    raise ValueError("a duration is a number with a unit: 200ms, 10s, 1min or 1h")


def _text(value: object) -> object:
    return {"en-US": value} if isinstance(value, str) else value


def _cpu_name(value: object) -> object:
    """``cpu: 314`` is a name."""
    return str(value) if isinstance(value, int) and not isinstance(value, bool) else value


def _toolchain(value: object) -> object:
    """``V19`` and ``TIA-V19`` are ``tia-v19``."""
    return toolchain_id(value) if isinstance(value, str) else value


def trigger_short(value: object) -> object:
    """Widen ``M50.0`` to ``{execute: M50.0}``."""
    return {"execute": value} if isinstance(value, str) else value


TRIGGER_SCHEMA = {"anyOf": [{"type": "string"}, {"$ref": "#/$defs/Trigger"}, {"type": "null"}]}
"""JSON schema of what :func:`trigger_short` widens."""


def short_item(key: str) -> BeforeValidator:
    """Widens what names one thing: ``P50`` to ``{key: P50}``."""

    def widen(value: object) -> object:
        if key == "parameter" and type(value) is int:
            help_ = f"write r{value}, or P{value} if it can be written"
            raise problem(f"{value} is a number without its letter", code="PG203", help_=help_)
        return {key: value} if isinstance(value, str) else value

    return BeforeValidator(widen)


ONE_OR_MORE = BeforeValidator(lambda value: (value,) if isinstance(value, str) else value)
"""Widens a text where a list stands: ``P50`` to ``[P50]``."""


def short_items(key: str) -> BeforeValidator:
    """Widens a mapping to a list: ``{P50: 1, P51: {as: x}}`` to ``[{key: P50, value: 1}, {key: P51, as: x}]``."""

    def widen(value: object) -> object:
        if not isinstance(value, dict):
            return value
        return tuple(
            {**entry, key: str(name)} if isinstance(entry, dict) else {key: str(name), "value": entry}
            for name, entry in value.items()
        )

    return BeforeValidator(widen)


def short_item_schema(item: str) -> dict[str, Any]:
    """JSON schema of a list of what :func:`short_item` widens to the definition ``item``, or of a single text."""
    items = {"anyOf": [{"type": "string"}, {"$ref": f"#/$defs/{item}"}]}
    return {"anyOf": [{"type": "string"}, {"type": "array", "items": items}, {"type": "null"}]}


def short_items_schema(definitions: dict[str, Any], item: str, key: str, *, lists: bool) -> dict[str, Any]:
    """JSON schema of what :func:`short_items` widens to ``item``; ``lists``: a value may be a list of values.

    What stands below a name, ``WriteEntry`` of ``WriteItem``, becomes a definition of its own.
    """
    name = f"{item.removesuffix('Item')}Entry"
    entry = {**definitions[item], "required": [], "title": name}
    entry["properties"] = {each: what for each, what in entry["properties"].items() if each != key}
    definitions[name] = entry
    value = {"type": ["boolean", "integer", "number", "string", "null"]}
    below = [value, *([{"type": "array", "items": value}] if lists else []), {"$ref": f"#/$defs/{name}"}]
    return {
        "anyOf": [
            {"type": "object", "additionalProperties": {"anyOf": below}},
            {"type": "array", "items": {"$ref": f"#/$defs/{item}"}},
            {"type": "null"},
        ]
    }


Duration = Annotated[
    int,
    BeforeValidator(_duration),
    Field(ge=1, le=3_600_000),
    WithJsonSchema({"type": "string", "pattern": DURATION, "examples": ["200ms", "10s"]}),
]
CpuName = Annotated[
    Name, BeforeValidator(_cpu_name), Field(max_length=40), WithJsonSchema({"type": ["string", "integer"]})
]
Text = Annotated[
    dict[Name, Printed],
    BeforeValidator(_text),
    WithJsonSchema(
        {"anyOf": [{"type": "string"}, {"type": "object", "additionalProperties": {"type": "string"}}]},
    ),
]
COMMENT = "for readers: text, or one text per language"


def _of_an_input(start: Any, info: ValidationInfo) -> Any:
    if start is not None and info.data.get("value") is not None:
        raise problem("a constant has no start value", help_="remove value: it is an input then; or remove start")
    return start


OF_AN_INPUT = AfterValidator(_of_an_input)
"""Validator of a key ``start`` after a key ``value``: only what is no constant has a start value."""


class Numbers(StrictModel):
    """First number of each automatic numbering range."""

    fb: int = Field(470, ge=1, le=65535, description="first automatic FB number")
    db: int = Field(470, ge=1, le=65535, description="first automatic DB number")
    udt: int = Field(470, ge=1, le=65535, description="first automatic UDT number (STEP 7 V5)")


Version = Annotated[str, Field(pattern=r"^[0-9]{1,3}\.[0-9]{1,3}$")]


class Instructions(StrictModel):
    """Versions of instructions, where a project needs others than the default ones (TIA Portal)."""

    WRREC: Version | None = Field(None, description="default: 1.1 on S7-1200/1500, 1.0 on S7-300/400")
    RDREC: Version | None = Field(None, description="default: 1.0")
    TON_TIME: Version | None = Field(None, description="default: 1.0")


class Plc(StrictModel):
    """The controller the blocks are for."""

    name: Name = Field(min_length=1, max_length=120, description="project or station name, used in headers")
    family: Family = Field(description="CPU family")
    cpu: CpuName | None = Field(None, description="CPU type, such as 315-2DP: what does not fit it is a warning")
    toolchain: Annotated[Toolchain, BeforeValidator(_toolchain)] = Field(
        description="engineering tool that imports the sources"
    )
    names: Naming = Field("style", description="member names: style guide (camelCase) or FAQ 109750712")
    languages: tuple[Name, ...] = Field(
        ("en-US",), min_length=1, max_length=16, description="comment languages; the first is the main one"
    )
    numbers: Numbers = Field(Numbers(), description="where automatic block numbers start")
    prefix: Annotated[str, Field(max_length=8, pattern=r"^([A-Za-z][A-Za-z0-9]*_?)?$")] = Field(
        "", description="in front of every name that plcgen makes, so that two specs can go into one PLC"
    )
    sources: Literal["one", "per_block"] = Field(
        "one", description="one text source with every block in order, or a file for each block"
    )
    user_owned: tuple[Annotated[Printed, Field(min_length=1, max_length=200)], ...] = Field(
        (), max_length=1000, description="blocks or files of the output folder that are yours: never written over"
    )
    instructions: Instructions = Field(Instructions(), description="versions of WRREC, RDREC and TON_TIME")


class BlockName(StrictModel):
    """Name and number of the job's function block or its instance DB."""

    name: Name | None = Field(None, min_length=1, max_length=125, description="name; absent: from the job's key")
    number: int | None = Field(None, ge=1, le=65535, description="number; absent: automatic")


class Trigger(StrictModel):
    """Flags or symbols of the job's call; absent ones are members of the control DB."""

    execute: Printed | None = Field(None, description="bit that starts the job, e.g. M50.0 or Plant.start")
    busy: Printed | None = Field(None, description="bit that says that the job runs")
    done: Printed | None = Field(None, description="bit that says that the job ended well, e.g. M50.5")
    error: Printed | None = Field(None, description="bit that says that the job ended with an error")
    status: Printed | None = Field(None, description="word for the status, e.g. MW52")


_FILE: dict[str, Any] = {"type": "string", "minLength": 1, "maxLength": 500, "pattern": r"\.[yY][aA]?[mM][lL]$"}
Include = Annotated[
    tuple[Annotated[Printed, Field(min_length=1, max_length=500, pattern=_FILE["pattern"])], ...],
    ONE_OR_MORE,
    WithJsonSchema({"anyOf": [_FILE, {"type": "array", "items": _FILE}]}),
]
Variables = Annotated[
    dict[str, Any],
    WithJsonSchema({"type": "object", "propertyNames": {"pattern": f"^{NAME}$"}}),
]


class Spec(StrictModel):
    """What every spec has; each protocol that it uses adds its sections, see ``shape``."""

    version: Literal[1] = Field(1, description="version of the spec format")
    include: Include = Field(
        (), description="files with more of this spec, in its folder or below; this file overrides them"
    )
    variables: Variables = Field({}, description="values by name: $(name) stands for one, inside a text for its text")
    plc: Plc = Field(description="the controller")
