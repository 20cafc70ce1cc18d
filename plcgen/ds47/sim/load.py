"""Read a simulated drive from YAML: behaviour, drive objects with their parameters, faults.

The file is described in docs/drive-yaml.md. The checks of one key see the keys before it, so that one run finds every
problem, each at its place.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    PlainValidator,
    ValidationInfo,
    WithJsonSchema,
    field_validator,
)

from plcgen.base.files.printed import Name, Printed
from plcgen.base.files.validation import (
    FileShape,
    Octets,
    Problems,
    StrictModel,
    counting,
    load_document,
    problem,
    unique,
)
from plcgen.ds47 import guards
from plcgen.ds47.sim.behaviour import Behaviour
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.sim.faults import KINDS, Fault, FaultKind
from plcgen.ds47.sim.parameters import READY, Condition, DriveObject, SimulatedParameter, ValueLimits
from plcgen.ds47.wire import formats
from plcgen.ds47.wire.errors import Table
from plcgen.ds47.wire.formats import Format, FormatKind, FormatValueError, Value

Byte = Annotated[int, Field(ge=0, le=0xFF)]
Word = Annotated[int, Field(ge=0, le=0xFFFF)]
Count = Annotated[int, Field(ge=0, le=1_000_000)]
_BEHAVIOUR, _FAULT = Behaviour(), Fault(FaultKind.STATUS)


def load_drive(text: str, file: str = "<drive>") -> Drive:
    """Build a drive from YAML text; DiagnosticError with every problem and its position."""
    return load_document(text, file, DRIVE).model.drive()


def _object_number(key: object) -> object:
    if isinstance(key, str) and key.isdecimal() and int(key) <= 0xFF:
        return int(key)
    raise problem(f'"{key}" is not a drive object number')


class BehaviourKeys(StrictModel):
    """Key ``behaviour``: see ``Behaviour``."""

    error_words: Literal[1, 2] = Field(
        _BEHAVIOUR.error_words, description="words in an error block; 1 leaves the information word out"
    )
    answer_format: Literal["exact", "size"] = Field(
        _BEHAVIOUR.answer_format, description="size answers reads with 41h, 42h, 43h where the type has 1, 2 or 4 bytes"
    )
    record_indexes: tuple[Word, ...] = Field(
        _BEHAVIOUR.record_indexes, description="data records that carry DS47; others end with B0h"
    )
    aliases: dict[Annotated[int, BeforeValidator(_object_number)], Byte] = Field(
        default_factory=dict, description="further drive object numbers and the object each one means"
    )
    local_object: Byte | None = Field(
        None, description="object that record B02Eh addresses, whatever the request's byte says"
    )
    max_parameters: int = Field(
        _BEHAVIOUR.max_parameters, ge=1, le=255, description="more parameters in one request: error 22h"
    )
    max_elements: int = Field(_BEHAVIOUR.max_elements, ge=1, le=255, description="more elements: error 16h")
    record_limit: int = Field(
        _BEHAVIOUR.record_limit,
        ge=10,
        le=65535,
        description="longest request (B1h) and longest response (15h) in bytes",
    )
    multi_supported: bool = Field(_BEHAVIOUR.multi_supported, description="false: more than one parameter is error 23h")
    attributes: tuple[Byte, ...] = Field(
        tuple(sorted(_BEHAVIOUR.attributes)), description="supported attributes; others are error 16h"
    )
    strict_length: bool = Field(
        _BEHAVIOUR.strict_length, description="a request longer or shorter than its contents: 18h, nothing is written"
    )
    error_table: Table = Field(
        _BEHAVIOUR.error_table, description="profidrive answers a state's limit with 02h instead of C8h or C9h"
    )
    processing: Count = Field(_BEHAVIOUR.processing, description="milliseconds until the response is available")

    def behaviour(self) -> Behaviour:
        """Build the behaviour."""
        return Behaviour(**{**dict(self), "attributes": frozenset(self.attributes)})


def _format(name: object) -> Format:
    try:
        if isinstance(name, str):
            return formats.by_name(name)
    except KeyError:
        pass
    known = ", ".join(item.name for item in formats.FORMATS if item.writable)
    raise problem(f'"{name}" is not a data type', help_=f"types: {known}")


_TYPES: dict[str, Any] = {
    "anyOf": [{"enum": [each.name for each in formats.FORMATS if each.writable]}, {"type": "string"}]
}


def value_of(fmt: Format, value: Any) -> Value:
    """Return a value in the parameter's type; octets are written as hexadecimal text."""
    try:
        if fmt.kind in {FormatKind.OCTETS, FormatKind.OPAQUE} and isinstance(value, str):
            value = bytes.fromhex(value)
        formats.pack_values(fmt, [value])
    except FormatValueError as wrong:
        raise problem(str(wrong)) from None
    except ValueError:
        raise problem(f'"{value}" is not hexadecimal text') from None
    found: Value = value
    return found


def _not_below(high: float | None, info: ValidationInfo) -> float | None:
    low = info.data.get("low")
    if high is not None and low is not None and high < low:
        raise problem(f"the upper limit {high:g} is below the lower limit {low:g}", help_="no value fits")
    return high


UpperLimit: TypeAlias = Annotated[float | None, AfterValidator(_not_below)]


class LimitsKeys(StrictModel):
    """Keys ``low`` and ``high``."""

    low: float | None = Field(None, description="lower limit")
    high: UpperLimit = Field(None, description="upper limit")

    def limits(self) -> ValueLimits:
        """Build the limits."""
        return ValueLimits(self.low, self.high)


class Refusal(StrictModel):
    """One entry of ``refuse``."""

    error: Byte = Field(description="error number of the answer")
    while_: tuple[Name, ...] = Field((), alias="while", description="states in which it is refused")
    unless: tuple[Name, ...] = Field((), validate_default=True, description="states in which it is not refused")
    read: bool = Field(default=False, description="true refuses reads too")

    @field_validator("unless")
    @classmethod
    def _names_states(cls, states: tuple[str, ...], info: ValidationInfo) -> tuple[str, ...]:
        if not states and info.data.get("while_") == ():
            raise problem('a refusal needs "while" or "unless" with states', code="PG105")
        return states

    def condition(self) -> Condition:
        """Build the condition."""
        return Condition(self.error, frozenset(self.while_), frozenset(self.unless), self.read)


class ParameterKeys(StrictModel):
    """One entry of ``parameters``."""

    pnu: int = Field(ge=1, le=65535, description="parameter number")
    type: Annotated[Format, PlainValidator(_format), WithJsonSchema(_TYPES)] = Field(
        description="data type, for example FloatingPoint, Unsigned16, VisibleString"
    )
    name: Printed = Field("", description="name in the parameter description")
    value: Any = Field(None, description="the value; octets as hexadecimal text")
    values: tuple[Any, ...] | None = Field(
        None, validate_default=True, description="one value for each element of the array"
    )
    array: bool | None = Field(None, description="whether the parameter is indexed; true by default with values")
    low: float | None = Field(None, description="lower limit: 02h")
    high: UpperLimit = Field(None, description="upper limit: 02h")
    state_limits: dict[Name, LimitsKeys] = Field(
        default_factory=dict, description="narrower limits in a state: C8h, C9h"
    )
    read_only: bool = Field(default=False, description="every write is refused: 01h")
    reset_only: bool = Field(default=False, description="06h for any value but 0")
    allowed: tuple[Any, ...] = Field((), description="the only values taken: 14h")
    refuse: tuple[Refusal, ...] = Field((), description="what is refused, and in which states")
    texts: tuple[Printed, ...] = Field((), description="texts of attribute 30h, 16 characters each")
    described: bool = Field(default=True, description="false: attribute 20h answers 09h")
    clears_after: Count | None = Field(None, description="ms after which a value that was set returns to 0")
    saves: Literal["object", "unit"] | None = Field(
        None, description="what setting the parameter saves; changes are refused (11h) meanwhile"
    )
    acknowledges: bool = Field(
        default=False, description="true: setting it acknowledges the faults, when it is 0 again"
    )
    remaining: int = Field(0, ge=0, le=8, description="so many faults are there again when they were acknowledged")
    step: Annotated[float, Field(gt=0, allow_inf_nan=False)] | None = Field(
        None, description="a value that is written becomes a multiple of it"
    )
    clips: bool = Field(default=False, description="a value beyond the limits becomes the limit, without an error")

    @field_validator("value", "low", "high")
    @classmethod
    def _fits(cls, value: Any, info: ValidationInfo) -> Any:
        if "type" not in info.data or (value is None and info.field_name != "value"):
            return value
        return value_of(info.data["type"], value)

    @field_validator("values")
    @classmethod
    def _is_given_once(cls, values: tuple[Any, ...] | None, info: ValidationInfo) -> tuple[Any, ...] | None:
        if "value" in info.data and not values and info.data["value"] is None:
            raise problem('a parameter needs "value" or "values"', code="PG105")
        if values and info.data.get("value") is not None:
            raise problem('a parameter has "value" or "values", not both')
        return None if values is None else cls._all_fit(values, info)

    @field_validator("allowed")
    @classmethod
    def _all_fit(cls, values: tuple[Any, ...], info: ValidationInfo) -> tuple[Any, ...]:
        problems, found = Problems(), []
        for index, value in enumerate(values if "type" in info.data else ()):
            with problems.at(index):
                found.append(value_of(info.data["type"], value))
        problems.raise_any()
        return tuple(found)

    @field_validator("array")
    @classmethod
    def _holds_all(cls, array: bool | None, info: ValidationInfo) -> bool | None:  # noqa: FBT001 - pydantic's signature
        if array is False and len(info.data.get("values") or ()) > 1:
            raise problem(f"the parameter is not an array but has {len(info.data['values'])} values")
        return array

    @field_validator("state_limits")
    @classmethod
    def _limits_fit(cls, states: dict[str, LimitsKeys], info: ValidationInfo) -> dict[str, LimitsKeys]:
        problems = Problems()
        for state, limits in states.items() if "type" in info.data else ():
            for key, limit in limits:
                if limit is not None:
                    with problems.at(state, key):
                        value_of(info.data["type"], limit)
        problems.raise_any()
        return states

    def parameter(self) -> SimulatedParameter:
        """Build the parameter."""
        return SimulatedParameter(
            self.pnu,
            self.type,
            [self.value] if self.values is None else list(self.values),
            name=self.name,
            array=self.values is not None if self.array is None else self.array,
            limits=ValueLimits() if self.clips else ValueLimits(self.low, self.high),
            state_limits={state: keys.limits() for state, keys in self.state_limits.items()},
            read_only=self.read_only or self.pnu in guards.READ_ONLY,
            reset_only=self.reset_only,
            allowed=frozenset(self.allowed),
            conditions=tuple(refusal.condition() for refusal in self.refuse),
            texts=self.texts,
            described=self.described,
            clears_after=self.clears_after,
            saves=self.saves or "",
            acknowledges=self.acknowledges,
            remaining=self.remaining,
            keeps=self._keeps if self.clips or self.step is not None else None,
        )

    def _keeps(self, _: int, value: Value) -> Value:
        """What is kept of a number: a multiple of the step, the nearest limit."""
        if isinstance(value, bool | str | bytes):
            return value
        found: float = value
        if self.step is not None and math.isfinite(found):
            found = round(found / self.step) * self.step
        if self.clips and self.low is not None:
            found = max(found, self.low)
        if self.clips and self.high is not None:
            found = min(found, self.high)
        return found if self.type.kind is FormatKind.FLOAT else int(found)


class ObjectKeys(StrictModel):
    """One entry of ``objects``."""

    number: Byte = Field(description="drive object number")
    state: Name = Field(READY, description="operating state")
    parameters: Annotated[tuple[ParameterKeys, ...], unique("pnu", "parameter {} appears twice")] = Field(
        (), description="its parameters"
    )

    def drive_object(self) -> DriveObject:
        """Build the drive object."""
        return DriveObject(self.number, {keys.pnu: keys.parameter() for keys in self.parameters}, self.state)


class FaultKeys(StrictModel):
    """One fault: see ``Fault``."""

    kind: Annotated[FaultKind, Field(strict=False)] = Field(description="what goes wrong")
    times: Annotated[int, Field(ge=1, le=1_000_000)] | Literal["forever"] = Field(1, description="how often it strikes")
    after: Count = Field(_FAULT.after, description="how many occasions it lets pass first")
    call: Literal["read", "write"] = Field(_FAULT.call, description="read means RDREC, write WRREC")
    status: Annotated[int, Field(ge=1, le=0xFFFFFFFF)] | None = Field(
        None, validate_default=True, description="STATUS with which the call ends"
    )
    code: Byte = Field(_FAULT.code, description="error code of the call")
    milliseconds: int = Field(
        _FAULT.milliseconds, ge=0, le=10_000_000, description="how much longer the response takes"
    )
    value: Byte | None = Field(None, description="the wrong byte, or how many bytes of the response come")
    data: Octets = Field(
        default_factory=lambda: _FAULT.data, description="other bytes instead of a response, hexadecimal"
    )
    number: Word = Field(_FAULT.number, description="error number of the parameter")
    position: Byte = Field(_FAULT.position, description="which parameter fails; 0: the whole request")
    words: Literal[1, 2] = Field(_FAULT.words, description="words of the error block")
    info: Word = Field(_FAULT.info, description="its information word")

    @field_validator("*")
    @classmethod
    def _counts(cls, value: Any, info: ValidationInfo) -> Any:
        """Refuse a key that does nothing for the kind."""
        return counting(value, info, KINDS)

    @field_validator("status")
    @classmethod
    def _is_given(cls, status: int | None, info: ValidationInfo) -> int | None:
        if status is None and info.data.get("kind") is FaultKind.STATUS:
            raise problem('a fault of the kind status lacks the key "status"', code="PG105")
        return status

    def fault(self) -> Fault:
        """Build the fault."""
        given = {name: value for name, value in self if name in Fault.__slots__}
        return Fault(**{**given, "times": None if self.times == "forever" else self.times, "status": self.status or 0})


class DriveKeys(StrictModel):
    """A drive file."""

    behaviour: BehaviourKeys = Field(BehaviourKeys(), description="how the drive answers")
    objects: Annotated[tuple[ObjectKeys, ...], unique("number", "drive object {} appears twice")] = Field(min_length=1)
    faults: tuple[FaultKeys, ...] = Field((), description="what goes wrong")

    def drive(self) -> Drive:
        """Build the drive."""
        objects = [keys.drive_object() for keys in self.objects]
        return Drive(self.behaviour.behaviour(), objects, [keys.fault() for keys in self.faults])


DRIVE = FileShape(DriveKeys, "the drive", "a drive is a mapping with objects", "docs/drive-yaml.md describes it")
