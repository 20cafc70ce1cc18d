"""The shape of a device profile: what its file may say, and the device that it describes.

docs/devices.md describes it key by key. Everything wrong is a problem at its place: the checks of one key see the keys
before it, so that one run finds all of them.
"""

from __future__ import annotations

import itertools
import re
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    ValidationError,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    WithJsonSchema,
    field_validator,
)

from plcgen.base.files.printed import Line, Name, Value
from plcgen.base.files.validation import FileShape, Problems, StrictModel, problem
from plcgen.ds47 import guards, lists
from plcgen.ds47 import messages as known_messages
from plcgen.ds47.device import (
    UNKNOWN,
    Absence,
    Device,
    DeviceList,
    Fact,
    Grade,
    ObjectTypes,
    Parameter,
    ParameterDef,
    ParameterNumber,
    counts,
    device_hint,
    parameter_from,
)
from plcgen.ds47.objects import ListedType, ObjectType, single_types
from plcgen.ds47.references import number_of, parse_reference
from plcgen.ds47.types import TypeTextError, read_type
from plcgen.ds47.wire import formats
from plcgen.ds47.wire.bico import Layout, parse_bico
from plcgen.ds47.wire.errors import Table
from plcgen.ds47.wire.formats import Format, FormatKind, FormatValueError, Takes
from plcgen.ds47.wire.model import MAX_ELEMENTS, MAX_PARAMETERS, RECORD_LIMIT

LENDERS = "lenders"
"""In the context of a validation: the shipped devices that a profile may be like, by name, each as what reads it."""

RecordIndex = Annotated[int, Field(ge=1, le=0xFFFF)]
DriveObject = Annotated[int, Field(ge=0, le=255)]


class RecordIndexes(StrictModel):
    """Data records that carry parameter jobs, by access point."""

    profibus: RecordIndex | None = None
    profinet_local: RecordIndex | None = Field(None, alias="profinet-local")
    profinet_global: RecordIndex | None = Field(None, alias="profinet-global")
    default: Literal["profibus", "profinet-local", "profinet-global"] = Field(description="the one that a job takes")

    @field_validator("default")
    @classmethod
    def _exists(cls, name: str, info: ValidationInfo) -> str:
        key = name.replace("-", "_")
        if key in info.data and info.data[key] is None:
            raise problem(f'there is no record index "{name}"', help_=f"add {name}: with its number")
        return name

    def by_name(self) -> dict[str, int]:
        """Those that the device has."""
        return self.model_dump(by_alias=True, exclude_none=True, exclude={"default"})


def _any(allowed: object) -> object:
    if allowed is None or (isinstance(allowed, str) and allowed != "any"):
        raise problem(f'"{allowed or ""}" is neither any nor a list of drive objects')
    return None if allowed == "any" else allowed


_ALLOWED = {"anyOf": [{"const": "any"}, {"type": "array", "items": {"type": "integer", "minimum": 0, "maximum": 255}}]}


class DriveObjects(StrictModel):
    """Numbers of drive objects (axes)."""

    default: DriveObject = Field(description="the one a drive has if the spec says nothing")
    allowed: Annotated[tuple[DriveObject, ...] | None, BeforeValidator(_any), WithJsonSchema(_ALLOWED)] = Field(
        None, description="any, or a list of numbers"
    )
    rule: Line = Field("see the manual", description="how to find the number, for a message")

    @field_validator("allowed")
    @classmethod
    def _default_is_one(cls, allowed: Any, info: ValidationInfo) -> Any:
        if allowed is not None and "default" in info.data and info.data["default"] not in allowed:
            raise problem(f"the default {info.data['default']} is not among the allowed drive objects")
        return allowed


class ProfileObjects(StrictModel):
    """Types of drive objects, for a device that has several."""

    control_unit: DriveObject = Field(description="number of the control unit")
    others: ObjectType = Field(description="type of the other drive objects, if the spec says nothing")
    whole: tuple[ListedType, ...] = Field((), description="types whose lists of parameters were read whole")


class ProfileList(StrictModel):
    """A whole list of parameters that the device has."""

    list: Line = Field(description="its name: a file of the package")
    objects: tuple[Line, ...] = Field((), description="its drive objects; absent: all")
    type: ListedType | None = Field(None, description="the type of drive object that they are in this device")
    grade: Grade = Field("read", description="inferred: it is the list of another device")
    whole: bool = Field(default=True, description="a number that it lacks is not in such a drive object")

    @field_validator("list")
    @classmethod
    def _is_there(cls, name: str) -> str:
        if name not in lists.names():
            raise problem(f'there is no list "{name}"', help_=f"lists: {', '.join(lists.names())}")
        return name

    def known(self) -> DeviceList:
        """The same for a device."""
        whole = self.whole and self.grade == "read"
        return DeviceList(self.list, frozenset(self.objects), self.type or "", self.grade, whole)


class ProfileAbsence(StrictModel):
    """A parameter that the device does not have."""

    source: Line = Field(description="what says so: a text, or a name from sources")
    grade: Grade = Field("read", description="inferred: a conclusion from the source")


class ProfileLimits(StrictModel):
    """How much one telegram may hold."""

    record: int = Field(RECORD_LIMIT, ge=16, le=RECORD_LIMIT, description="longest request and response in bytes")
    parameters: int = Field(MAX_PARAMETERS, ge=1, le=MAX_PARAMETERS, description="parameters in one request")
    elements: int = Field(MAX_ELEMENTS, ge=1, le=MAX_ELEMENTS, description="elements of one parameter in a request")


class Answers(StrictModel):
    """How the device answers."""

    format: Literal["exact", "size"] = Field("exact", description="type of a value: its own, or 41h..43h by size")
    error_words: Literal[1, 2] = Field(2, description="words per error: the number, and a word of information")


class Changes(StrictModel):
    """What the device takes in a change."""

    formats: Takes = Field("any", description="own type and 41h..43h by size, one of the two, or 43h alone")


class ScalarElements(StrictModel):
    """Number of elements in a request for a parameter without an index."""

    read: Literal[0, 1] = 1
    write: Literal[0, 1] = 1


class ParameterEntry(ParameterDef):
    """One parameter of the catalogue."""

    name: Annotated[Name, Field(max_length=64)] | None = Field(None, description="symbolic name, snake_case")
    title: Line | None = Field(None, description="text for comments")
    unit: Line | None = None
    dangerous: Line | None = Field(None, description="why a write needs a sign-off (allow:)")
    harmless: Line | None = Field(None, description="why it needs none, for a number that plcgen does not know")
    source: Line | None = Field(None, description="where this is documented; absent: the source of the profile")
    grade: Grade = Field("read", description="how the facts are known: read, inferred, recalled")
    facts: dict[Fact, Grade] = Field(default_factory=dict, description="the same for single facts")
    observed: Value | None = Field(None, description="a value that a drive had; not its factory setting")
    scaling: Name | None = Field(None, description="reference of its value in process data, for example p2000")
    changeable: Line | None = Field(None, description="states in which the drive takes a write")
    objects: tuple[ListedType, ...] = Field((), description="types of drive objects that have it; absent: unknown")
    note: Line | None = None

    @field_validator("type")
    @classmethod
    def _is_a_type(cls, text: str) -> str:
        try:
            if text != UNKNOWN:
                read_type(text)
        except TypeTextError as wrong:
            raise problem(str(wrong), code="PG205", help_=wrong.help) from None
        return text

    @field_validator("name")
    @classmethod
    def _is_a_name(cls, name: str | None) -> str | None:
        reference = parse_reference(name or "x")
        if reference is None or reference.first is not None or name == "":
            raise problem(f'"{name}" is not a name: letters, digits and underscores', help_="for example ramp_up_time")
        if reference.pnu is not None:
            raise problem(f'the name "{name}" reads as a parameter number')
        return name

    @field_validator("scaling")
    @classmethod
    def _is_a_reference(cls, scaling: str | None) -> str | None:
        if scaling is not None and not re.fullmatch(r"[PpRr][0-9]{1,5}|PERCENT|4000H", scaling):
            raise problem(f'"{scaling}" is not a reference value', help_="write a number, p2000, or PERCENT or 4000H")
        return scaling

    @field_validator("min", "max")
    @classmethod
    def _fits(cls, limit: float | None, info: ValidationInfo) -> float | None:
        if limit is None or info.data.get("type", UNKNOWN) == UNKNOWN:
            return limit
        fmt, _ = read_type(info.data["type"])
        if fmt.kind not in {FormatKind.SIGNED, FormatKind.UNSIGNED, FormatKind.FLOAT}:
            raise problem(f"{fmt.name} has no limits")
        _pack(fmt, limit, info)
        low = info.data.get("min")
        if info.field_name == "max" and low is not None and low > limit:
            raise problem(f"min {low:g} is larger than max {limit:g}")
        return limit

    @field_validator("default", "observed")
    @classmethod
    def _is_a_value(cls, value: Any, info: ValidationInfo) -> Any:
        if value is None or info.data.get("type", UNKNOWN) == UNKNOWN:
            return value
        fmt, octets = read_type(info.data["type"])
        if fmt.is_string or fmt.kind is FormatKind.OPAQUE:
            _check_text(fmt, octets or fmt.size, value)
            return value
        if isinstance(value, str):
            if fmt.name != "Unsigned32" or parse_bico(value) is None:
                raise problem(f'"{value}" is not a value of type {fmt.name}')
            return value
        _pack(fmt, value, info)
        if not _between_limits(value, info):
            raise problem(f"the {info.field_name} value {value:g} is outside min and max")
        return value

    @field_validator("values")
    @classmethod
    def _are_values(cls, values: dict[str, int], info: ValidationInfo) -> dict[str, int]:
        problems = Problems()
        for name, value in values.items() if info.data.get("type", UNKNOWN) != UNKNOWN else ():
            with problems.at(name):
                _pack(read_type(info.data["type"])[0], value)
                if not info.data.get("scale") and not _between_limits(value, info):
                    raise problem(f"{name}: {value} is outside min and max")
        problems.raise_any()
        return values

    @field_validator("bico")
    @classmethod
    def _is_wide_enough(cls, bico: bool, info: ValidationInfo) -> bool:  # noqa: FBT001 - pydantic's signature
        if bico and info.data.get("type", UNKNOWN) != UNKNOWN and read_type(info.data["type"])[0].name != "Unsigned32":
            raise problem("a BICO source is an Unsigned32", help_="remove bico: true, or write type: Unsigned32")
        return bico


def _between_limits(value: float, info: ValidationInfo) -> bool:
    low, high = info.data.get("min"), info.data.get("max")
    return (low is None or value >= low) and (high is None or value <= high)


def _pack(fmt: Format, value: Any, info: ValidationInfo | None = None) -> None:
    scale = info.data.get("scale") if info is not None else None
    if scale and isinstance(value, int | float):
        value = counts(value, scale)
    try:
        formats.pack_values(fmt, [value])
    except FormatValueError as wrong:
        raise problem(str(wrong)) from None


def _check_text(fmt: Format, octets: int, value: Any) -> None:
    """Check the default of a string: text, or octets as hexadecimal digits."""
    if not isinstance(value, str):
        raise problem(f"{fmt.name} takes text", help_='put it in quotes, octets as hexadecimal digits: "0329"')
    try:
        data = value.encode("ascii") if fmt.kind is FormatKind.TEXT else bytes.fromhex(value)
    except ValueError:
        raise problem(f'"{value}" is not a value of type {fmt.name}') from None
    if len(data) < octets and fmt.kind is FormatKind.OCTETS:
        raise problem(f"{fmt.name}[{octets}] takes {octets} octets, not {len(data)}")
    if len(data) > octets:
        raise problem(f"{len(data)} octets do not fit {fmt.name}[{octets}]")


def _read_value(text: str) -> str:
    reference = parse_reference(text)
    if reference is None or reference.pnu is None or (reference.last or 0) != (reference.first or 0):
        raise problem(f'"{text}" is not a parameter with one value', code="PG203", help_="for example r21 or r945[0]")
    return text


MainValue = Annotated[Name, AfterValidator(_read_value)]


class DeviceProfile(StrictModel):
    """A device profile."""

    title: Line = Field(description="name of the device for people")
    source: Line = Field(description="manuals that say so")
    record_index: RecordIndexes = Field(description="data records that carry parameter jobs")
    drive_object: DriveObjects = Field(description="numbers of drive objects")
    object_types: ProfileObjects | None = Field(None, description="types of drive objects, if it has several")
    limits: ProfileLimits = Field(ProfileLimits(), description="how much one telegram may hold")
    answers: Answers = Field(Answers(), description="how the device answers")
    takes: Changes = Field(Changes(), description="what the device takes in a change")
    scalar_elements: ScalarElements = Field(ScalarElements(), description="elements in a request without an index")
    strict_length: bool = Field(default=True, description="a request of another length than its contents is refused")
    bases: tuple[Annotated[int, Field(ge=1, le=0xFFFF)], ...] = Field(
        (), description="numbers of limits and references: an input of a job needs a start value for them"
    )
    bico: Layout = Field("drive-object", description="BICO values carry the drive object, or zeros in its place")
    error_table: Table = Field("sinamics", description="meaning of error numbers")
    like: Line | None = Field(
        None, description="a shipped device whose parameters this one has too, as far as anybody knows"
    )
    sources: dict[Name, Line] = Field(default_factory=dict, description="sources by a short name, for parameters")
    lists: tuple[ProfileList, ...] = Field((), description="whole lists of parameters that it has")
    messages: tuple[known_messages.Family, ...] = Field((), description="families whose messages it has")
    main_values: dict[Name, MainValue] = Field(
        default_factory=dict, description="what read: main_values reads of a drive: names of outputs with parameters"
    )
    absent: dict[ParameterNumber, ProfileAbsence] = Field(
        default_factory=dict, description="parameters that it is known not to have"
    )
    parameters: dict[ParameterNumber, ParameterEntry] = Field(default_factory=dict, description="the catalogue")

    @field_validator("like")
    @classmethod
    def _is_shipped(cls, like: str | None, info: ValidationInfo) -> str | None:
        lenders = (info.context or {}).get(LENDERS, {})
        if like is not None and like not in lenders:
            help_ = f"{device_hint(like, lenders)} shipped devices: {', '.join(lenders)}".strip()
            raise problem(f'like: there is no shipped device "{like}"', code="PG201", help_=help_)
        return like

    @field_validator("parameters", mode="wrap")
    @classmethod
    def _are_different(cls, given: Any, handler: ValidatorFunctionWrapHandler, info: ValidationInfo) -> Any:
        """Numbers and names are compared as they were given, so that other mistakes do not hide them."""
        like = info.data.get("like")
        lent = info.context[LENDERS][like]().parameters if like is not None and info.context else {}
        absent = {number_of(key) for key in info.data.get("absent", ())}
        problems, numbers, names, parameters = Problems(), dict[int, str](), dict[str, str](), None
        try:
            parameters = handler(given)
        except ValidationError as invalid:
            problems.add_all(invalid)
        for key, entry in given.items() if isinstance(given, dict) else ():
            pnu = number_of(key) or 0
            first = numbers.setdefault(pnu, key) if pnu else key
            if first != key:
                problems.add(problem(f"{key} is the same parameter as {first}", code="PG103", at_key=True), key)
            name = entry.get("name") if isinstance(entry, dict) else None
            named = names.setdefault(name.lower(), key) if isinstance(name, str) else key
            if named != key:
                problems.add(problem(f'{named} has the name "{name}" as well'), key, "name")
            if pnu in absent:
                problems.add(problem(f"{key} is among the absent parameters, too", code="PG103", at_key=True), key)
            reason = guards.why_read_only(key, pnu, catalogued=lent[pnu].access if pnu in lent else "")
            if reason and isinstance(entry, dict) and entry.get("access") in {"w", "rw"}:
                problems.add(problem(f"{key} cannot be written: {reason}", code="PG207"), key, "access")
        problems.raise_any()
        return parameters

    def device(self, key: str) -> Device:
        """The device that this profile describes; ``key`` is what a spec calls it."""
        return Device(
            key=key,
            title=self.title,
            source=self.source,
            record_index=self.record_index.by_name(),
            default_index=self.record_index.default,
            drive_object=self.drive_object.default,
            drive_objects=self.drive_object.allowed,
            drive_object_rule=self.drive_object.rule,
            record_limit=self.limits.record,
            max_parameters=self.limits.parameters,
            max_elements=self.limits.elements,
            answer_format=self.answers.format,
            takes=self.takes.formats,
            error_words=self.answers.error_words,
            scalar_elements=(self.scalar_elements.read, self.scalar_elements.write),
            strict_length=self.strict_length,
            bases=self.bases,
            bico=self.bico,
            error_table=self.error_table,
            object_types=None if self.object_types is None else _object_types(self.object_types),
            lists=tuple(one.known() for one in self.lists),
            messages=self.messages,
            main_values=self.main_values,
            absences={
                number_of(key) or 0: Absence(self.sources.get(one.source, one.source), one.grade)
                for key, one in self.absent.items()
            },
            parameters={found.pnu: found for found in itertools.starmap(self._parameter, self.parameters.items())},
        )

    def _parameter(self, key: str, entry: ParameterEntry) -> Parameter:
        pnu = number_of(key) or 0
        given = {"source": self.source} | entry.model_dump(exclude_none=True)
        given["source"] = self.sources.get(given["source"], given["source"])
        return parameter_from(pnu, given, "r" if guards.why_read_only(key, pnu) else key[:1])


def _object_types(said: ProfileObjects) -> ObjectTypes:
    return ObjectTypes(said.control_unit, said.others, single_types(said.whole))


PROFILE = FileShape(
    model=DeviceProfile,
    what="the profile",
    shape="a device profile is a mapping with title, source, record_index and drive_object",
    help="docs/devices.md describes it",
)
