"""A device and its parameters, as a profile or a spec describes them."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isclose
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias, get_args

from pydantic import AfterValidator, Field, ValidationInfo

from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.base.files.printed import Name, Printed, Value
from plcgen.base.files.validation import StrictModel, problem
from plcgen.ds47 import effects, guards, lists
from plcgen.ds47.objects import CONTROL_UNIT_TYPE, OTHER, kindred, single_types
from plcgen.ds47.references import parse_reference
from plcgen.ds47.types import TypeTextError, read_type
from plcgen.ds47.wire.formats import FormatKind

if TYPE_CHECKING:
    from plcgen.ds47.wire.bico import Layout
    from plcgen.ds47.wire.errors import Table
    from plcgen.ds47.wire.formats import Takes


def _number(key: str) -> str:
    reference = parse_reference(key)
    if reference is None or reference.first is not None or not 1 <= (reference.pnu or 0) <= 0xFFFF:
        raise problem(f'"{key}" is not a parameter number', code="PG203", help_="write P1120: or r0945:")
    return key


def _value_name(name: str) -> str:
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) or re.fullmatch(r"[PpRr]0*[0-9]+", name):
        raise problem(
            f'"{name}" is not a valid name of a value: letters, digits and underscores', help_="for example inactive"
        )
    return name


ValueName = Annotated[Name, AfterValidator(_value_name), Field(max_length=64)]
ParameterNumber = Annotated[Name, AfterValidator(_number)]
DataSets = Literal["CDS", "DDS", "EDS", "MDS", "n"]
"""What the number of indexes follows: command, drive, encoder or motor data sets, or something else."""
Indexes = Annotated[int, Field(ge=1, le=65535)] | DataSets
Grade: TypeAlias = Literal["read", "inferred", "recalled"]
"""How a fact is known: read in its source, concluded from something else that was read, or from memory."""
Fact: TypeAlias = Literal[
    "title", "type", "unit", "access", "array", "min", "max", "default", "bico", "values", "scaling", "objects"
]
_DOUBTS: Mapping[Grade, str] = {"inferred": "inferred", "recalled": "from general knowledge"}
DECIDING: tuple[Fact, ...] = ("array", "min", "max", "default", "values")
"""What decides something about jobs, and therefore counts only if it was read."""
_PRODUCT = re.compile("[a-z]*[0-9]+[a-z]*")
UNLISTED = range(980, 990)
"""Numbers of the lists of numbers: no list prints them."""
UNKNOWN = "unknown"
"""What stands for a type or a number of indexes that nobody knows."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A drive parameter as the catalogue or the spec defines it.

    ``type`` is the DS47 data type on the wire, empty if nobody knows it; ``array`` the number of indexes (None: not
    indexed, or ``indexes`` says what the number follows, or that nobody read whether it is indexed); ``access`` is r, w
    or rw; ``minimum``/``maximum`` in the parameter's unit; ``dangerous`` and ``harmless`` say why a write needs a
    sign-off, or none, where its profile says so: ``Device.danger`` knows the numbers too. ``grades`` says how each
    stated fact is known. Limits, factory setting, number of indexes and names of values that were not read decide
    nothing: they stand in ``doubted`` alone. ``observed`` is a value that a drive had once; ``values`` are single
    values by their names; ``scaling`` is the reference of the value in process data, p2000 for example;
    ``objects`` are the types of the drive objects that have it, empty if nobody knows. ``scale`` is what one count of a
    whole number is worth in the unit of its manual, 0 of one that has none: limits and values are in counts then, and
    ``unit`` says what a count is, ``0.01 s``. ``sink``: its list has the letter c, an interconnection or a fixed value.
    """

    pnu: int
    type: str
    name: str = ""
    title: str = ""
    unit: str = ""
    access: str = "rw"
    array: int | None = None
    minimum: float | None = None
    maximum: float | None = None
    default: bool | float | str | None = None
    bico: bool = False
    dangerous: str = ""
    harmless: str = ""
    source: str = ""
    indexes: str = ""
    observed: bool | float | str | None = None
    changeable: str = ""
    note: str = ""
    grades: Mapping[Fact, Grade] = field(default_factory=dict, compare=False)
    doubted: Mapping[Fact, Any] = field(default_factory=dict, compare=False)
    values: Mapping[str, int] = field(default_factory=dict)
    scaling: str = ""
    objects: frozenset[str] = frozenset()
    scale: float = 0.0
    sink: bool = False

    @property
    def letter(self) -> str:
        """``r``, ``P``, or ``c`` of a sink of firmware 6."""
        return "r" if self.access == "r" else "c" if self.sink else "P"

    @property
    def label(self) -> str:
        """``P1120``, ``r21`` or ``c840``."""
        return f"{self.letter}{self.pnu}"

    def read(self, fact: Fact) -> bool:
        """Whether a fact was read in its source."""
        return self.grades.get(fact) == "read"

    def doubt(self, *facts: Fact) -> str:
        """What a message adds that rests on some facts: how those are known that were not read; empty if all were."""
        known = {self.grades.get(fact, "read") for fact in facts}
        shown = [words for grade, words in _DOUBTS.items() if grade in known]
        return f" ({' and '.join(shown)}, not read in a manual)" if shown else ""

    @property
    def type_note(self) -> str:
        """How every report says that the type was not read; empty if it was."""
        grade = self.grades.get("type", "read")
        return "" if grade == "read" else f"type {grade}, not read in a manual"


def counts(value: float, scale: float) -> float:
    """How many counts of ``scale`` a value is, whole if it is no more than a rounding error beside that."""
    found = value / scale
    return round(found) if isclose(found, round(found), rel_tol=1e-9, abs_tol=1e-9) else found


def limit_text(limit: float | None) -> str:
    """One end of a range, empty if it has none."""
    return "" if limit is None else f"{limit:g}"


def facts(parameter: Parameter) -> dict[Fact, tuple[Any, Grade]]:
    """Every fact that is stated, with its grade; also those that decide nothing."""
    values: dict[Fact, Any] = {
        "title": parameter.title,
        "type": parameter.type,
        "unit": parameter.unit,
        "access": parameter.access,
        "array": parameter.array or parameter.indexes.removeprefix(UNKNOWN),
        "min": parameter.minimum,
        "max": parameter.maximum,
        "default": parameter.default,
        "bico": parameter.bico or None,
        "values": dict(parameter.values),
        "scaling": parameter.scaling,
        "objects": sorted(parameter.objects),
    }
    values |= parameter.doubted
    stated = {fact: value for fact, value in values.items() if value not in (None, "", {}, [])}
    return {fact: (value, parameter.grades.get(fact, "read")) for fact, value in stated.items()}


@dataclass(frozen=True, slots=True)
class ObjectTypes:
    """Types of the drive objects of a unit: number of the control unit, type of the others if nobody says more.

    ``whole`` are the types whose lists were read whole: what they do not name, an object of the type does not have.
    """

    control_unit: int
    others: str
    whole: frozenset[str]


def device_hint(name: str, known: Iterable[str]) -> str:
    """``did you mean "sinamics-g120"?`` for a slip of the pen; a G220 is no G120, so letters and digits of a product
    must be the same.
    """
    product = _PRODUCT.findall(name.lower())
    return did_you_mean(
        name, [one for one in known if _PRODUCT.findall(one) == product or one.startswith(name.lower())]
    )


@dataclass(frozen=True, slots=True)
class DeviceList:
    """A list that a device has: the rows of some ``objects`` (of all without any) for a ``type`` of drive object.

    ``whole``: a number that it lacks is not in such a drive object; else it is another device's, or not complete.
    """

    name: str
    objects: frozenset[str]
    type: str
    grade: Grade
    whole: bool

    def rows(self, pnu: int) -> list[lists.Listed]:
        """What it says of a number."""
        found = lists.find(self.name, pnu)
        return [one for one in found if not self.objects or one.objects & {*self.objects, lists.ALL}]


def _candidates(known: Iterable[DeviceList], object_type: str) -> list[DeviceList]:
    """The lists that speak of a type of drive object; those without a type speak of every one."""
    types = single_types([object_type]) if object_type else frozenset()
    return [one for one in known if not one.type or not object_type or single_types([one.type]) & types]


def _listed(known: Iterable[DeviceList], pnu: int, object_type: str) -> Parameter | None:
    """What lists say of a number. Where several speak of it, a fact counts if all say the same; it was read for this
    drive if all of them were read for it, are whole and have the number.
    """
    those = _candidates(known, object_type)
    said = [(one, row) for one in those for row in one.rows(pnu)]
    if not said:
        return None
    sure = all(one.whole and one.grade == "read" and one.rows(pnu) for one in those)
    facts_, *others = (lists.facts(row) for _, row in said)
    agreed = {key: value for key, value in facts_.items() if all(other.get(key) == value for other in others)}
    sources = dict.fromkeys(lists.source(one.name) for one, _ in said)
    entry = {
        "type": UNKNOWN, "title": facts_["title"], **agreed, "objects": [one.type for one, _ in said if one.type],
        "grade": "read" if sure else "inferred", "source": "; ".join(sources),
    }  # fmt: skip
    letters = {row.texts["letter"] for _, row in said}
    differ = {"title": "title" not in agreed, "access": len(letters) > 1}
    entry["facts"] = {fact: "inferred" for fact, does in differ.items() if does}
    return parameter_from(pnu, entry, "r" if "r" in letters else "".join(letters))


def _completed(own: Parameter, said: Parameter) -> Parameter:
    """A row with what it leaves open and a list says: names of values, and limits, which are inferred ones then and
    decide nothing.
    """
    if own.type != said.type:
        return own
    doubted, grades = {**own.doubted}, {**own.grades}
    if said.type == "FloatingPoint" and not grades.keys() & {"min", "max"}:
        known: dict[Fact, float | None] = {"min": said.minimum, "max": said.maximum}
        stated = {end: said.doubted.get(end, limit) for end, limit in known.items()}
        stated = {end: limit for end, limit in stated.items() if limit is not None}
        doubted |= stated
        grades |= dict.fromkeys(stated, "inferred")
    if own.values or "values" in own.doubted:
        return replace(own, doubted=doubted, grades=grades)
    if "values" in said.doubted:
        doubted["values"] = said.doubted["values"]
    if said.values or "values" in said.doubted:
        grades["values"] = said.grades.get("values", "read")
    return replace(own, doubted=doubted, grades=grades, values=said.values)


@dataclass(frozen=True, slots=True)
class Absence:
    """Why a device is known not to have a parameter: a source, and how it says so."""

    source: str
    grade: Grade

    def __str__(self) -> str:
        return self.source if self.grade == "read" else f"{self.source} ({self.grade})"


@dataclass(frozen=True, slots=True)
class Device:
    """A device profile: limits and behaviour of one drive family (source: its manuals, named in ``source``).

    ``record_index`` maps access points to data record indexes; ``default_index`` names the default one.
    ``drive_objects`` is None when every number is possible. ``answer_format`` is ``exact`` (the parameter's
    type) or ``size`` (41h/42h/43h), ``takes`` what it takes in a change. ``scalar_elements`` is the number of
    elements this device wants in a request without an index: (read, write). ``bases`` are the numbers of limits and
    references, which other values are measured by. ``bico`` says whether BICO values carry the drive object, ``like``
    from which device those parameters come that the profile does not name. ``object_types`` is None if all parameters
    are in one drive object, or nobody knows in which. ``main_values`` are parameters by what they are called as
    outputs, ``absences`` numbers that it is known not to have, beside those that its lists lack.
    """

    key: str
    title: str
    source: str
    record_index: dict[str, int]
    default_index: str
    drive_object: int
    drive_objects: tuple[int, ...] | None
    drive_object_rule: str
    record_limit: int
    max_parameters: int
    max_elements: int
    answer_format: Literal["exact", "size"]
    error_words: Literal[1, 2]
    scalar_elements: tuple[int, int]
    strict_length: bool
    bases: tuple[int, ...]
    bico: Layout
    error_table: Table
    parameters: dict[int, Parameter]
    takes: Takes = "any"
    like: str = field(default="", compare=False)
    object_types: ObjectTypes | None = None
    lists: tuple[DeviceList, ...] = ()
    messages: tuple[str, ...] = ()
    main_values: Mapping[str, str] = field(default_factory=dict)
    absences: Mapping[int, Absence] = field(default_factory=dict)

    def find(self, pnu: int, object_type: str = "") -> Parameter | None:
        """What is known of a number: the profile's own row, else what lists say of it for a type of drive object, or
        for the usual one.
        """
        own, types = self.parameters.get(pnu), self.object_types
        if own is None and pnu in self.absences:
            return None
        usual = _listed(self.lists, pnu, types.others) if types is not None and not object_type else None
        said = usual or _listed(self.lists, pnu, object_type)
        if own is None or said is None:
            return said if own is None else own
        usual_types = single_types([types.others]) if types is not None else frozenset()
        of_another = bool(object_type and usual_types) and not single_types([object_type]) & usual_types
        if of_another and said.read("type"):  # a row speaks for the usual drive object; this one has its own list
            return replace(said, name=own.name, dangerous=own.dangerous, harmless=own.harmless, note=own.note)
        return _completed(own, said)

    def confirmed(self, pnu: int, object_type: str) -> Parameter | None:
        """A parameter that a drive object is known to have, with a type that is not from memory; None if nobody knows,
        or only a list of another device has it.
        """
        own = self.parameters.get(pnu)
        if own is None:
            those = [one for one in _candidates(self.lists, object_type) if one.grade == "read"]
            return self.find(pnu, object_type) if those and all(one.rows(pnu) for one in those) else None
        return own if own.type and own.grades.get("type") != "recalled" else None

    def names(self, pnu: int, column: str) -> dict[tuple[str, ...], Mapping[int, str]]:
        """What numbers stand for, of ``values`` or ``bits``: by the types of drive objects that have it like that, or
        by the lists where none names a type.
        """
        said: dict[str, dict[int, str]] = {}
        for one in self.lists:
            for row in one.rows(pnu):
                said.setdefault(one.type or one.name, {}).update(row.names(column))
        alike: dict[tuple[tuple[int, str], ...], list[str]] = {}
        for of, names in said.items():
            alike.setdefault(tuple(sorted(names.items())), []).append(of)
        return {tuple(of): dict(names) for names, of in alike.items() if names}

    def bit_text(self, pnu: int, bit: int, object_type: str) -> str:
        """What the lists call a bit; empty if none does, or they differ."""
        rows = [row for one in _candidates(self.lists, object_type) for row in one.rows(pnu)]
        texts = {row.names("bits").get(bit, "") for row in rows}
        return texts.pop() if len(texts) == 1 else ""

    def search(self, text: str) -> list[Parameter]:
        """Parameters by number whose titles have every word of a text, in the catalogue and in the lists."""
        words = text.split()
        own = {
            pnu
            for pnu, one in self.parameters.items()
            if all(word.casefold() in one.title.casefold() for word in words)
        }
        listed = {pnu for one in self.lists for pnu in lists.search(one.name, words)}
        found = (self.find(pnu) for pnu in sorted(own | listed))
        return [one for one in found if one is not None]

    def example(self) -> str:
        """A parameter that the catalogue of this device has; P1120 if it has none."""
        number = 1120 if 1120 in self.parameters else next(iter(self.parameters), 1120)
        known = self.parameters.get(number)
        return known.label if known is not None else f"P{number}"

    def object_type(self, number: int) -> str:
        """Type of a drive object of which only the number is known; empty if the device has no types."""
        types = self.object_types
        if types is None:
            return ""
        return CONTROL_UNIT_TYPE if number == types.control_unit else types.others

    def lacks(self, pnu: int, object_type: str) -> Literal["surely", "perhaps", ""]:
        """Whether a drive object of a type has no such parameter.

        ``surely``: its list was read whole, or a source says so; ``perhaps``: that is a conclusion, or lists name it
        for objects of other groups alone.
        """
        known, types = self.parameters.get(pnu), self.object_types
        if known is None and pnu in self.absences:
            return "surely" if self.absences[pnu].grade == "read" else "perhaps"
        if known is None and self.absent(pnu, object_type):
            return "surely"
        if known is None or types is None or not known.objects or object_type in ("", OTHER):
            return ""
        own = single_types([object_type])
        if own & known.objects:
            return ""
        if own & types.whole and known.read("objects"):
            return "surely"
        return "" if kindred(own) & known.objects else "perhaps"

    def absent(self, pnu: int, object_type: str) -> tuple[str, ...]:
        """What says that a drive object does not have a number: the profile, or the lists of its type that were read
        whole; nothing if nobody knows.
        """
        if pnu in self.absences:
            return (str(self.absences[pnu]),)
        those = _candidates(self.lists, object_type)
        if pnu in UNLISTED or not all(one.whole for one in those) or any(one.rows(pnu) for one in those):
            return ()
        return tuple(dict.fromkeys(lists.source(one.name) for one in those))

    def listed(self, object_type: str) -> Sequence[int]:
        """Every number that lists name for a type of drive object; the catalogue's if the device has no lists."""
        those = _candidates(self.lists, object_type)
        found = {number for one in those for number in lists.numbers(one.name) if one.rows(number)}
        return sorted(found or self.parameters)

    def danger(self, pnu: int, values: Collection[object] | None = None, object_type: str = "") -> str:
        """Why a write of these values needs a sign-off, whatever a spec says about the parameter; empty if it needs
        none. None are values that nobody knows yet: then any that would need one counts.
        """
        known = self.parameters.get(pnu)
        own = known.dangerous if known is not None else ""
        return own or effects.danger(pnu, (object_type, self.key, self.like), values)

    def harmless(self, object_type: str) -> set[int]:
        """Numbers of which a write is known to be harmless in a drive object of a type, whatever the value.

        What only other families say of a number does not count: it may be another parameter here.
        """
        said = effects.harmless((object_type, self.key, self.like))
        said |= {pnu for pnu, one in self.parameters.items() if one.harmless}
        return said - {pnu for pnu, one in self.parameters.items() if one.dangerous} - guards.NOT_SERVED

    def left_to_chance(self, pnu: int, object_type: str = "") -> str:
        """Why nobody's choice must not be written to a number: its class of effect; empty if it may."""
        known = self.parameters.get(pnu)
        if known is not None and (known.dangerous or known.harmless):
            return "dangerous" if known.dangerous else ""
        return (
            effects.left_to_chance(pnu, (object_type, self.key, self.like)) if self.classified(pnu) else "unclassified"
        )

    def classified(self, pnu: int) -> bool:
        """Whether anybody has said what a write of this number does."""
        known = self.parameters.get(pnu)
        return effects.classified(pnu) or (known is not None and bool(known.dangerous or known.harmless))

    def by_name(self, name: str) -> Parameter | None:
        """Catalogue parameter by symbolic name."""
        return next((p for p in self.parameters.values() if p.name == name), None)


def _of_whole_numbers(scale: float | None, info: ValidationInfo) -> float | None:
    try:
        fmt, _ = read_type(info.data.get("type") or "")
    except TypeTextError:
        return scale
    if scale is not None and fmt.kind not in {FormatKind.SIGNED, FormatKind.UNSIGNED}:
        help_ = "leave scale out: the value is in its unit"
        raise problem(f"scale is for whole numbers, not for {fmt.name}", help_=help_)
    return scale


Scale = Annotated[float, Field(gt=0, lt=1e9)]


class ParameterDef(StrictModel):
    """A drive parameter that the device catalogue does not hold (or holds differently)."""

    type: Name = Field(description="DS47 data type, e.g. FloatingPoint, Unsigned16, OctetString[4]")
    name: Name | None = Field(None, description="symbolic name, snake_case; becomes the block's member name")
    title: Printed | None = Field(None, description="text for comments")
    unit: Printed | None = Field(None, description="text for comments, such as s or rpm")
    access: Literal["r", "w", "rw"] | None = Field(None, description="absent: rw, or r where it can only be read")
    array: Indexes | None = Field(
        None, description="number of indexes, or what it follows: CDS, DDS, EDS, MDS, n; absent: not indexed"
    )
    scale: Annotated[Scale | None, AfterValidator(_of_whole_numbers)] = Field(
        None, description="fixed point: what one count is worth in the unit, such as 0.01; values are given in the unit"
    )
    min: float | None = Field(None, description="least value that a constant may have")
    max: float | None = Field(None, description="greatest value that a constant may have")
    default: Value | None = Field(None, description="factory setting")
    bico: bool = Field(default=False, description="value is a BICO source such as r722.2")
    values: dict[ValueName, int] = Field(
        default_factory=dict, description="single values by names that a job may write"
    )


def parameter_from(pnu: int, entry: Mapping[str, Any], letter: str) -> Parameter:
    """Build a parameter from its catalogue or spec entry, already validated, and its letter: r, p or c."""
    every: tuple[Fact, ...] = get_args(Fact)
    general: Grade = entry.get("grade") or "read"
    own: Mapping[Fact, Grade] = entry.get("facts", {})
    stated = {fact: entry[fact] for fact in every if entry.get(fact) not in (None, {}, ())}
    grades = {fact: own.get(fact, general) for fact in every if fact in stated or fact in {"access", "array"}}
    if entry["type"] == UNKNOWN:
        del grades["type"]
    doubted = {fact: stated[fact] for fact in DECIDING if fact in stated and grades[fact] != "read"}
    array = stated.get("array")
    scale, unit = entry.get("scale") or 0.0, entry.get("unit") or ""
    if scale:
        for known in (stated, doubted):
            known |= {key: counts(known[key], scale) for key in ("min", "max", "default") if _number_in(known, key)}
        unit = f"{scale:g} {unit}".strip()
    observed = counts(entry["observed"], scale) if scale and _number_in(entry, "observed") else entry.get("observed")
    return Parameter(
        pnu=pnu,
        type="" if entry["type"] == UNKNOWN else entry["type"],
        name=entry.get("name") or "",
        title=entry.get("title") or "",
        unit=unit,
        access=entry.get("access") or ("r" if letter in {"r", "R"} else "rw"),
        array=array if isinstance(array, int) and "array" not in doubted else None,
        indexes=array if isinstance(array, str) else UNKNOWN if grades["array"] != "read" else "",
        minimum=None if "min" in doubted else stated.get("min"),
        maximum=None if "max" in doubted else stated.get("max"),
        default=None if "default" in doubted else stated.get("default"),
        observed=observed,
        bico=entry.get("bico", False),
        dangerous=entry.get("dangerous") or "",
        harmless=entry.get("harmless") or "",
        source=entry.get("source", ""),
        changeable=entry.get("changeable", ""),
        note=entry.get("note", ""),
        grades=grades,
        doubted=doubted,
        values={} if "values" in doubted else stated.get("values", {}),
        scaling=stated.get("scaling", ""),
        objects=single_types(stated.get("objects", ())),
        scale=scale,
        sink=letter in {"c", "C"},
    )


def _number_in(values: Mapping[Any, Any], key: str) -> bool:
    return isinstance(values.get(key), int | float) and not isinstance(values[key], bool)
