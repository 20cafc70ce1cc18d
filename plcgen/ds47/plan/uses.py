"""One parameter of a job: find it in the catalogue, settle its type, index and value, or say what is wrong."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from dataclasses import replace
from math import inf
from typing import Any

from plcgen.base.diagnostics import Diagnostic, Report, Severity
from plcgen.base.diagnostics.counting import shortlist
from plcgen.base.diagnostics.suggest import Vocabulary, did_you_mean
from plcgen.ds47 import guards
from plcgen.ds47.device import UNKNOWN, Device, Fact, Grade, Parameter, counts, limit_text
from plcgen.ds47.kind import ReadItem, WriteItem
from plcgen.ds47.objects import singular
from plcgen.ds47.plan import untyped
from plcgen.ds47.plan.access import Compare, Read, Use, Write
from plcgen.ds47.plan.nouns import PlannedDrive
from plcgen.ds47.plan.pack import MAX_TELEGRAMS
from plcgen.ds47.references import Reference, number_of, parse_reference, spelling_hint
from plcgen.ds47.types import TypeTextError, read_type
from plcgen.ds47.wire import formats
from plcgen.ds47.wire.bico import parse_bico
from plcgen.ds47.wire.formats import FROM_ANSWER, Format, FormatKind, FormatValueError
from plcgen.project.spec import LoadedSpec, SpecPath
from plcgen.s7.types.names import TIA_LIMIT, V5_LIMIT, camel_case, shorten

HIGHEST_BOUND = 32_767
"""Bounds of arrays are INT; a range is an array with the drive's own indexes, and a pad element behind it."""


_LOOKED_UP: Mapping[Fact, Grade] = {"type": "read", "access": "read", "bico": "read"}
_OF_SIBLINGS: tuple[Fact, ...] = ("type", "title", "unit", "access", "bico")
_LONGEST_VALUE = 40
"""Characters of a value that a help repeats."""
_NAMED = 3
"""Devices that are named as sources of a type."""


class UseResolver:
    """Resolves the parameters of one drive's jobs; problems go to the report, the use is then left out."""

    def __init__(self, loaded: LoadedSpec, drive: PlannedDrive, own: dict[int, Parameter], report: Report) -> None:
        self.loaded = loaded
        self.device = drive.device
        self.object_type = drive.object_type
        self.own = own
        self.report = report
        self.known = {**self.device.parameters, **own}
        named = [(one.name, one) for one in reversed(self.known.values()) if one.name]
        self._by_name, self._words = dict(named), Vocabulary(name for name, _ in reversed(named))
        self.unusable: set[int] = set()
        self.longest_name = V5_LIMIT if loaded.spec.plc.toolchain == "step7-v5" else TIA_LIMIT

    def alike(self, other: UseResolver) -> bool:
        """Whether both resolve every parameter to the same use."""
        return (self.device, self.object_type, self.own) == (other.device, other.object_type, other.own)

    def reporting(self, report: Report) -> UseResolver:
        """The same resolver with another report."""
        other = copy(self)
        other.report = report
        return other

    def check_definition(self, parameter: Parameter, path: SpecPath) -> None:
        """Report a data type that does not exist where the spec defines a parameter, not at every use."""
        if self._format(parameter, path) is None:
            self.unusable.add(parameter.pnu)

    def problem(
        self, code: str, message: str, path: SpecPath, help_: str = "", severity: Severity = Severity.ERROR
    ) -> None:
        """Report what is wrong at a place of the spec."""
        self.report.add(Diagnostic(code, message, self.loaded.span(path), severity, help=help_))

    def confirmed(self, pnu: int) -> Parameter | None:
        """A parameter that the spec defines, or that the drive object is known to have."""
        return self.own.get(pnu) or self.device.confirmed(pnu, self.object_type)

    def lacks(self, names: Iterable[str], path: SpecPath, help_: str = "") -> bool:
        """Whether the drive object is known not to have some parameters; PG262 if so."""
        absent = {name: self.device.absent(number_of(name) or 0, self.object_type) for name in names}
        gone = [name for name, sources in absent.items() if sources and number_of(name) not in self.own]
        if gone:
            sources = dict.fromkeys(source for name in gone for source in absent[name])
            of = f" as {singular(self.object_type)}" if self.object_type else ""
            message = f"{self.device.title}{of} has no {', '.join(gone)}: {'; '.join(sources)}"
            search = f"plcgen catalogue show WORD --device {self.device.key} searches"
            self.problem("PG262", message, path, help_ or f"the drive would answer error 00h: {search}")
        return bool(gone)

    def resolve(
        self, item: ReadItem | WriteItem, position: int, path: SpecPath, *, write: bool, free: bool = False
    ) -> Use | None:
        """Turn one item of a job into a use; None if something about it is wrong. ``free``: it may have no type."""
        place: SpecPath = (*path, "parameter")
        reference = parse_reference(item.parameter)
        if reference is None:
            self.problem(
                "PG203",
                f'"{item.parameter}" is not a parameter',
                place,
                spelling_hint(item.parameter),
            )
            return None
        parameter = self._parameter(reference, item, path, free=free and reference.first == reference.last)
        if parameter is None or parameter.pnu in self.unusable:
            return None
        settled = self._format(parameter, path)
        if settled is None or not self._index_fits(reference, parameter, place):
            return None
        fmt, octets = settled
        doubt = parameter.doubt("type")
        as_ = f" as {parameter.type}{doubt}" if doubt else ""
        values = 1 if reference.first is None or reference.last is None else reference.last - reference.first + 1
        if octets and reference.last:
            message = f"{item.parameter}{as_}: the elements of a string are its octets, and a request has all of them"
            self.problem("PG206", message, place, "leave the index out")
            return None
        count = octets if fmt.is_string else values
        if count * fmt.size > MAX_TELEGRAMS * self.device.record_limit:
            help_ = "use fewer indexes, or several jobs"
            self.problem("PG307", f"{item.parameter} needs more than {MAX_TELEGRAMS} telegrams{as_}", place, help_)
            return None
        if values > 1 and (reference.last or 0) >= HIGHEST_BOUND:
            help_ = f"ask for the indexes from {HIGHEST_BOUND} on one by one"
            message = f"{item.parameter}: arrays of a PLC end before index {HIGHEST_BOUND}"
            self.problem("PG206", message, place, help_)
            return None
        start = item.value if isinstance(item, WriteItem) and item.value is not None else None
        constant, counted = start is not None, parameter
        if isinstance(item, WriteItem) and not constant:
            start = item.start
            if start is None:
                start, counted = _safe_default(parameter, fmt, count), replace(parameter, scale=0.0)
        data = b"\0" * (count * fmt.size)
        if isinstance(item, WriteItem):
            data = self.pack(start, counted, fmt, count, (*path, "value" if constant else "start")) or data
        return Use(
            position=position,
            parameter=parameter,
            format=fmt,
            first=reference.first,
            elements=count if fmt.is_string else self._elements(reference, values, write=write),
            count=count,
            data=data,
            sources=self.device.bico == "drive-object" and _names_sources(start, parameter, fmt),
            member=item.as_ or shorten(_member(parameter, reference), self.longest_name),
            comment=item.comment or {},
            path=path,
            item=item,
            role=_role(item, constant=constant, write=write),
        )

    def _elements(self, reference: Reference, values: int, *, write: bool) -> int:
        return self.device.scalar_elements[1 if write else 0] if reference.first is None else values

    def _parameter(
        self, reference: Reference, item: ReadItem | WriteItem, path: SpecPath, *, free: bool
    ) -> Parameter | None:
        place: SpecPath = (*path, "parameter")
        given = item.type
        if reference.pnu is None:
            found = self._by_name.get(reference.name)
            if found is None:
                hint = (
                    did_you_mean(reference.name, self._words) or f"use its number, for example {self.device.example()}"
                )
                self.problem("PG203", f'{self.device.title} has no parameter called "{reference.name}"', place, hint)
            return found and (self.own.get(found.pnu) or self.device.find(found.pnu, self.object_type))
        if not 1 <= reference.pnu <= 0xFFFF:
            self.problem("PG203", f"parameter number {reference.pnu} is outside 1..65535", place)
            return None
        known = self.own.get(reference.pnu) or self.device.find(reference.pnu, self.object_type)
        written = f"{'r' if reference.read_only else 'P'}{reference.pnu}"
        if given is None and (known is None or not known.type):
            if known is None and self.lacks([written], place):
                return None
            return self._without_type(known or Parameter(reference.pnu, ""), written, item, place, free=free)
        if known is None:
            access = "r" if reference.pnu in guards.READ_ONLY else "rw"
            return Parameter(reference.pnu, given or "", access=access)
        if not known.type and given is not None:
            return replace(known, type=given)
        if given is not None and given.lower() != known.type.lower():
            if reference.pnu not in self.known and not known.read("type"):
                # of the list of another drive: who writes a type has looked it up
                access, grades = "r" if known.pnu in guards.READ_ONLY else "rw", {**known.grades, **_LOOKED_UP}
                return replace(known, type=given, access=access, bico=False, grades=grades)
            if self._format(replace(known, type=given), path) is None:  # a type of the PLC, or a slip of the pen
                return None
            self.problem(
                "PG212",
                f"{known.label} is {known.type} in the catalogue{known.doubt('type')}, not {given}",
                (*path, "type"),
                f"remove the type, or define the parameter under drives.*.parameters if {self.device.key} differs",
            )
            return None
        return known

    def _without_type(
        self, known: Parameter, written: str, item: ReadItem | WriteItem, place: SpecPath, *, free: bool
    ) -> Parameter | None:
        """A number of which the catalogue has no type: the answer to a read tells it, else devices of the family may.

        PG204 if they do not agree, or none has the number. No number that looks like it is offered: the neighbour of a
        parameter is another parameter.
        """
        only_read = written.startswith("r") or known.pnu in guards.READ_ONLY or known.access == "r"
        access = "r" if only_read and isinstance(item, ReadItem) else known.access
        if free:
            return replace(known, type=untyped.ANY, access=access)
        said = untyped.of_siblings(self.device, known.pnu)
        if len(said) == 1:
            ((type_, rows),) = said.items()
            read_only = any(row.access == "r" for row in rows)
            sources = shortlist([row.source for row in rows], _NAMED, f", .. ({len(rows)} devices)")
            return replace(
                known, type=type_, title=known.title or rows[0].title, unit=known.unit or rows[0].unit, source=sources,
                access="r" if read_only else access, bico=all(row.bico for row in rows), indexes=UNKNOWN,
                grades=dict.fromkeys(_OF_SIBLINGS, "inferred"),
            )  # fmt: skip
        message = f"{written} is not in the catalogue of {self.device.key}: its data type is missing"
        if known.source:
            message = f"{written} ({known.title}) is in the catalogue without its data type: {known.source}"
        for type_, rows in said.items():
            message += f"; {type_} in {rows[0].source}"
        own = short = "type: .."
        if isinstance(item, WriteItem) and isinstance(item.value, str) and parse_bico(item.value) is not None:
            own = "type: Unsigned32, bico: true"  # whatever its number: the value is a source
            short = "type: Unsigned32"
        define = f"parameters: {{{written}: {{{own}}}}}"
        given = f"{{parameter: {item.parameter}, {short}}}"
        if isinstance(item, WriteItem):
            given = f"{item.parameter}: {{{short}{_as_written(item)}}}"
        help_ = f"look it up in the list manual and give its type: {given}; or define it in the drive: {define}"
        self.problem("PG204", message, place, help_)
        return None

    def _format(self, parameter: Parameter, path: SpecPath) -> tuple[Format, int] | None:
        """Format and, for strings, the number of octets."""
        if parameter.type == untyped.ANY:
            return FROM_ANSWER, 0
        try:
            return read_type(parameter.type)
        except TypeTextError as wrong:
            self.problem("PG205", str(wrong), (*path, "type"), wrong.help)
            return None

    def _index_fits(self, reference: Reference, parameter: Parameter, place: SpecPath) -> bool:
        if reference.first is None or reference.last is None:
            return True
        label, count, doubt = parameter.label, *_index_count(self.device, parameter)
        if reference.last < reference.first:
            self.problem("PG206", f"{label}[{reference.first}..{reference.last}]: the range runs backwards", place)
        elif reference.last > 0xFFFE:
            self.problem("PG206", f"{label}: subindex {reference.last} is outside 0..65534", place)
        elif reference.last < count or (doubt and parameter.pnu in self.own):
            return True
        else:
            many = count > 1 or parameter.array is not None
            has = f"has the indexes 0..{count - 1}{doubt}, not {reference.last}" if many else f"has no index{doubt}"
            help_ = f"the drive would answer error {'03h' if many else '04h'}"
            if not doubt:
                self.problem("PG206", f"{label} {has}", place, help_)
                return False
            own = f"parameters: {{{label}: {{type: {parameter.type}, array: {reference.last + 1}}}}}"
            help_ += f" then; if the list manual names this index, state the number in the drive: {own}"
            self.problem("PG206", f"{label} {has}", place, help_, Severity.WARNING)
            return True
        return False

    def pack(self, given: Any, parameter: Parameter, fmt: Format, count: int, path: SpecPath) -> bytes | None:
        """Wire bytes of a constant or start value; None after a diagnostic."""
        values: Sequence[Any] = given if isinstance(given, tuple) else (given,)
        if fmt.is_string:
            return self._pack_octets(values, parameter, fmt, count, path)
        if len(values) == 1 and count > 1 and not isinstance(given, tuple):
            one = self._pack_one(given, parameter, fmt, path)
            return None if one is None else one * count
        if len(values) != count:
            help_ = f"give {count} values, or one for all of them"
            self.problem("PG210", f"{parameter.label}: {len(values)} values for {count} elements", path, help_)
            return None
        packed = b""
        ok = True
        for value in values:
            one = self._pack_one(value, parameter, fmt, path)
            ok = ok and one is not None
            packed += one or b""
        return packed if ok else None

    def _pack_one(self, value: Any, parameter: Parameter, fmt: Format, path: SpecPath) -> bytes | None:
        if isinstance(value, str) and value in parameter.values:
            value = parameter.values[value]
        elif parameter.scale and isinstance(value, int | float) and not isinstance(value, bool):
            value = counts(value, parameter.scale)
            if not isinstance(value, int):
                message = f"{parameter.label} = {value * parameter.scale:g} is no multiple of {parameter.unit}"
                self.problem("PG208", message, path, f"one count of the drive is {parameter.unit}")
                return None
        if isinstance(value, str):
            source = parse_bico(value) if fmt.name == "Unsigned32" else None
            bico = source and source.within(self.device.bico)
            if source is not None and bico is None:
                message = f"{value}: BICO values of {self.device.title} have no drive object"
                self.problem("PG211", message, path, f"write {value.partition('@')[0]}")
                return None
            if bico is None and fmt.kind is not FormatKind.OPAQUE:
                help_ = _name_help(value, parameter) or _value_help(fmt)
                if parameter.sink and parse_bico(value) is not None:
                    help_ = "the letter c is a fixed value here: how a source is written into it, no list says"
                if value in parameter.doubted.get("values", {}):
                    named = f"{parameter.doubted['values'][value]}{parameter.doubt('values')}"
                    help_ = f"{value} is {named}: write the number, or define its name in the drive: values"
                text = f"{fmt.name}{parameter.doubt('type')}"
                self.problem("PG211", f'"{value}" is not a value of type {text}', path, help_)
                return None
            value = value if bico is None else bico
        elif parameter.bico and isinstance(value, int | float) and 1 < value < 0x10000:  # its upper word is a number
            meant = f"r{value}" if isinstance(value, float) else f"r{value}.0"
            message = f"{value} names no parameter as the source of {parameter.label}{parameter.doubt('bico')}"
            help_ = f"write {meant if parse_bico(meant) else 'r722.2'}: the letter, and the bit or index"
            self.problem("PG211", message, path, help_)
            return None
        try:
            if fmt.kind is FormatKind.OPAQUE:
                value = _octets(value, fmt.size)
            packed = formats.pack_values(fmt, [value])
        except FormatValueError as problem:
            counted = f", in counts of {parameter.unit}" if parameter.scale else ""
            help_ = (
                "write a value that this type holds; the type is that of the catalogue, or of parameters: in the drive"
            )
            self.problem("PG208", f"{parameter.label}: {problem}{counted}{parameter.doubt('type')}", path, help_)
            return None
        return packed if self._within(value, parameter, path) else None

    def _within(self, value: Any, parameter: Parameter, path: SpecPath) -> bool:
        """Whether a value is within limits that were read; beyond others it is a warning."""
        ends = ((parameter.minimum, parameter.maximum), (parameter.doubted.get("min"), parameter.doubted.get("max")))
        for sure, (low, high) in zip((True, False), ends, strict=True):
            if not isinstance(value, bool | int | float) or not _beyond(value, low, high):
                continue
            if low is not None and high is not None and low > high:
                continue  # no value is within: PG107 says so at the limits
            of = parameter.scale or 1.0
            unit = f" {parameter.unit.removeprefix(f'{of:g} ' if parameter.scale else '')}" if parameter.unit else ""
            ends_text = (limit_text(None if end is None else end * of) for end in (low, high))
            bounds = f"{'..'.join(ends_text)}{unit}"
            how = "" if sure else parameter.doubt(*(end for end in _ENDS if end in parameter.doubted))
            self.problem(
                "PG209",
                f"{parameter.label} = {value * of:g} is outside its limits {bounds}{how}",
                path,
                "the drive would answer error 02h" if sure else _limits_help(value * of, parameter),
                Severity.ERROR if sure else Severity.WARNING,
            )
            return not sure
        return True

    def _pack_octets(
        self, values: Sequence[Any], parameter: Parameter, fmt: Format, count: int, path: SpecPath
    ) -> bytes | None:
        doubt = parameter.doubt("type")
        value = values[0] if len(values) == 1 else None
        if not isinstance(value, str):
            self.problem("PG211", f"{fmt.name}{doubt} takes text", path, _value_help(fmt))
            return None
        try:
            data = value.encode("ascii") if fmt.kind is FormatKind.TEXT else bytes.fromhex(value)
        except ValueError:
            self.problem("PG211", f'"{value}" is not a value of type {fmt.name}{doubt}', path, _value_help(fmt))
            return None
        if len(data) > count:
            self.problem(
                "PG208", f"{len(data)} octets do not fit {fmt.name}[{count}]{doubt}", path, f"write {count} or fewer"
            )
            return None
        if len(data) < count and fmt.kind is FormatKind.OCTETS:
            help_ = "write all of them, two hexadecimal digits for each"
            self.problem("PG208", f"{fmt.name}[{count}] takes {count} octets{doubt}, not {len(data)}", path, help_)
            return None
        return data.ljust(count)


def _role(item: ReadItem | WriteItem, *, constant: bool, write: bool) -> Read | Write | Compare:
    """What an item that has a value of this side is for depends on whether the job writes."""
    if write:
        return Write(constant)
    return Compare(constant) if isinstance(item, WriteItem) else Read()


_ENDS: tuple[Fact, ...] = ("min", "max")
_DATA_SETS = {"MDS": 130, "EDS": 140, "CDS": 170, "DDS": 180}
"""The parameters that hold how many data sets a drive object has (list of VECTOR)."""


def _index_count(device: Device, parameter: Parameter) -> tuple[float, str]:
    """How many indexes a parameter has at most, and how that is known; infinite if nobody knows.

    An array of data sets has no more than the parameter that holds their number allows.
    """
    of = parameter.array or parameter.doubted.get("array") or parameter.indexes
    if isinstance(of, int):
        return of, "" if parameter.array else parameter.doubt("array")
    if of in _DATA_SETS and (sets := device.find(_DATA_SETS[of])) is not None:
        most = sets.doubted.get("max", inf) if sets.maximum is None else sets.maximum
        return most, parameter.doubt("array") or sets.doubt("max")
    return (1 if parameter.source and of in {"", UNKNOWN} else inf), parameter.doubt("array")


def _beyond(value: float, low: float | None, high: float | None) -> bool:
    return (low is not None and value < low) or (high is not None and value > high)


def _names_sources(given: Any, parameter: Parameter, fmt: Format) -> bool:
    """Whether a value is a BICO value: the parameter says so, or the value is written as one."""
    values = given if isinstance(given, tuple) else (given,)
    named = any(isinstance(value, str) and value not in parameter.values for value in values)
    return fmt.name == "Unsigned32" and (parameter.bico or named)


def _as_written(item: WriteItem) -> str:
    """The value or start value of an item, as its long form has it; empty if it has none."""
    texts = {key: json.dumps(value) for key in ("value", "start") if (value := getattr(item, key)) is not None}
    return "".join(f", {key}: {text if len(text) <= _LONGEST_VALUE else '..'}" for key, text in texts.items())


def _limits_help(value: float, parameter: Parameter) -> str:
    """The definition that lets a value pass whose limits nobody has read."""
    of, widest = parameter.scale or 1.0, {"min": min, "max": max}
    known = {end: widest[end](parameter.doubted[end] * of, value) for end in _ENDS if end in parameter.doubted}
    ends = ", ".join(f"{end}: {limit:.12g}" for end, limit in known.items())
    definition = f"parameters: {{{parameter.label}: {{type: {parameter.type}, {ends}}}}}"
    return f"look the limits up; if the value is within them, state them in the drive: {definition}"


def _octets(value: Any, size: int) -> bytes:
    """Octets of an uninterpreted date or time, written as hexadecimal digits."""
    try:
        data = bytes.fromhex(value) if isinstance(value, str) else bytes(size) if value == 0 else b""
    except ValueError:
        data = b""
    if len(data) != size:
        raise FormatValueError(f"write {size} octets as {2 * size} hexadecimal digits")
    return data


def _name_help(value: str, parameter: Parameter) -> str:
    """Which values have a name; empty if none has one."""
    known = list(parameter.values)
    return f"{did_you_mean(value, known)} values with a name: {', '.join(known)}".strip() if known else ""


def _value_help(fmt: Format) -> str:
    if fmt.kind is FormatKind.OCTETS:
        return 'write the octets as hexadecimal digits, for example "0329"'
    if fmt.kind is FormatKind.TEXT:
        return "write the text in quotes, ASCII characters only"
    if fmt.name == "Unsigned32":
        return "write a number or a BICO source such as r722.2, or r722.2@3 of drive object 3"
    return "write a number"


def _safe_default(parameter: Parameter, fmt: Format, count: int) -> Any:
    """Start value of an input: the factory setting, else zero or the nearest limit."""
    if fmt.is_string:
        return parameter.default or ("" if fmt.kind is FormatKind.TEXT else "00" * count)
    if parameter.default is not None:
        return parameter.default
    low, high = parameter.minimum, parameter.maximum
    number = low if low is not None and low > 0 else high if high is not None and high < 0 else 0
    return int(number) if fmt.kind is not FormatKind.FLOAT else float(number)


def _member(parameter: Parameter, reference: Reference) -> str:
    """Default member name: the catalogue's name, else the number; a single element of an array adds its index.

    A sink is called ``p840`` as well: ``c840`` would be a counter.
    """
    base = camel_case(parameter.name) if parameter.name else f"{'r' if parameter.access == 'r' else 'p'}{parameter.pnu}"
    if reference.first is None or reference.last != reference.first:
        return base
    return f"{base}Index{reference.first}"
