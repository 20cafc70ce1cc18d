"""Read a simulated drive from YAML: habits, drive objects with their parameters, faults.

The file is described in docs/drive-yaml.md. Every problem is collected with its position: PG104 unknown key,
PG105 missing key, PG106 wrong kind of value, PG107 value out of range.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any, Literal, cast

from plcgen.diagnostics import Diagnostic, Report, Span
from plcgen.input.keys import Reader, plain_node
from plcgen.input.yaml import Node, load_yaml
from plcgen.protocols.ds47.sim.drive import Drive
from plcgen.protocols.ds47.sim.faults import Fault, FaultKind
from plcgen.protocols.ds47.sim.habits import Habits
from plcgen.protocols.ds47.sim.parameters import READY, Condition, DriveObject, Limits, Parameter
from plcgen.protocols.ds47.wire import formats
from plcgen.protocols.ds47.wire.formats import Format, FormatValueError, Value

_PARAMETER_KEYS = (
    "pnu", "name", "type", "value", "values", "array", "low", "high", "state_limits", "read_only",
    "reset_only", "allowed", "refuse", "texts", "described", "clears_after", "saves",
)  # fmt: skip
_REFUSE_KEYS = ("error", "while", "unless", "read")


def load_drive(text: str, file: str = "<drive>") -> Drive:
    """Build a drive from YAML text; DiagnosticError with every problem and its position."""
    return _drive(load_yaml(text, file), file)


def drive_from_mapping(data: Mapping[str, Any], file: str = "<mapping>") -> Drive:
    """Build a drive from data already parsed; DiagnosticError with every problem."""
    return _drive(plain_node(data, Span(file)), file)


def faults_from(data: Sequence[Mapping[str, Any]], file: str = "<faults>") -> list[Fault]:
    """Build faults from plain mappings, as the key ``faults`` of a drive file holds them."""
    report = Report()
    found = _faults(Reader(plain_node({"faults": data}, Span(file)), report, "the faults"))
    report.raise_on_errors()
    return found


def _drive(root: Node, file: str) -> Drive:
    report = Report()
    reader = Reader(root, report, "a drive")
    reader.only("habits", "objects", "faults")
    habits = _habits(reader.child("habits", "the habits"))
    objects = [_object(item) for item in reader.children("objects", "a drive object")]
    if root.kind == "map" and not objects:
        report.add(Diagnostic("PG105", "a drive needs at least one drive object", Span(file)))
    for number in {item.number for item in objects if [o.number for o in objects].count(item.number) > 1}:
        report.add(Diagnostic("PG107", f"drive object {number} appears twice", root.key_span("objects")))
    faults = _faults(reader)
    report.raise_on_errors()
    return Drive(habits, objects, faults)


def _habits(reader: Reader) -> Habits:
    reader.only(*(item.name for item in fields(Habits)))
    base = Habits()
    aliases = reader.child("aliases", "the aliases")
    return Habits(
        error_words=reader.choice("error_words", base.error_words, _words()),
        answer_format=reader.choice("answer_format", base.answer_format, {"exact": "exact", "size": "size"}),
        record_indexes=reader.numbers("record_indexes", base.record_indexes, 0xFFFF),
        aliases=_aliases(aliases),
        local_object=reader.optional("local_object", 0, 255),
        max_parameters=reader.number("max_parameters", base.max_parameters, 1, 255),
        max_elements=reader.number("max_elements", base.max_elements, 1, 255),
        record_limit=reader.number("record_limit", base.record_limit, 10, 65535),
        multi_supported=reader.flag("multi_supported", default=base.multi_supported),
        attributes=frozenset(reader.numbers("attributes", sorted(base.attributes), 255)),
        strict_length=reader.flag("strict_length", default=base.strict_length),
        error_table=reader.choice(
            "error_table", base.error_table, {"sinamics": "sinamics", "profidrive": "profidrive"}
        ),
        processing=reader.number("processing", base.processing, 0, 1_000_000),
    )


def _words() -> Mapping[Any, Literal[1, 2]]:
    return {1: 1, 2: 2}


def _aliases(reader: Reader) -> dict[int, int]:
    if reader.node.kind != "map":
        reader.only()
        return {}
    found = {}
    for key in reader.node.pairs:
        if key.isdecimal() and int(key) <= 0xFF:
            found[int(key)] = reader.number(key, 0, 0, 255)
        else:
            reader.error("PG107", f'"{key}" is no drive object number', reader.node.key_span(key))
    return found


def _object(reader: Reader) -> DriveObject:
    reader.only("number", "state", "parameters")
    reader.require("number")
    number = reader.number("number", 0, 0, 255)
    found: dict[int, Parameter] = {}
    for child in reader.children("parameters", f"a parameter of drive object {number}"):
        parameter = _parameter(child)
        if parameter is None:
            continue
        if parameter.pnu in found:
            reader.error("PG107", f"parameter {parameter.pnu} appears twice", child.node.span)
        found[parameter.pnu] = parameter
    return DriveObject(number, found, reader.text("state", READY))


def _parameter(reader: Reader) -> Parameter | None:
    reader.only(*_PARAMETER_KEYS)
    reader.require("pnu")
    pnu = reader.number("pnu", 1, 1, 65535)
    reader.what = f"parameter {pnu}"
    fmt = _format(reader)
    nodes = reader.items("values") or [node for node in [reader.node.get("value")] if node is not None]
    if not nodes:
        reader.error("PG105", f'{reader.what} needs "value" or "values"', reader.node.span)
    array = reader.flag("array", default=reader.node.get("values") is not None)
    if len(nodes) > 1 and not array:
        reader.error("PG107", f"{reader.what} is no array but has {len(nodes)} values", reader.node.span)
    values = [value for node in nodes if (value := _value(reader, fmt, node)) is not None]
    allowed = [value for node in reader.items("allowed") if (value := _value(reader, fmt, node)) is not None]
    found = Parameter(
        pnu,
        fmt,
        values,
        name=reader.text("name"),
        array=array,
        limits=_limits(reader, fmt),
        state_limits=_state_limits(reader, fmt),
        read_only=reader.flag("read_only"),
        reset_only=reader.flag("reset_only"),
        allowed=frozenset(allowed),
        conditions=tuple(_condition(child) for child in reader.children("refuse", "a refusal")),
        texts=reader.texts("texts"),
        described=reader.flag("described", default=True),
        clears_after=reader.optional("clears_after", 0, 1_000_000),
        saves=reader.choice("saves", "", {"object": "object", "unit": "unit"}),
    )
    return found if values else None


def _format(reader: Reader) -> Format:
    reader.require("type")
    name = reader.text("type", "Unsigned16")
    try:
        fmt = formats.by_name(name)
    except KeyError:
        fmt = formats.by_name("Unsigned16")
        known = ", ".join(item.name for item in formats.FORMATS if item.writable)
        span = (reader.node.get("type") or reader.node).span
        reader.error("PG107", f'"{name}" is no data type', span, f"types: {known}")
    return fmt


def _value(reader: Reader, fmt: Format, node: Node) -> Value | None:
    """Return one value in the parameter's type; octets are written as hexadecimal text."""
    value: Any = node.value
    try:
        if fmt.kind in {formats.Kind.OCTETS, formats.Kind.OPAQUE} and isinstance(value, str):
            value = bytes.fromhex(value)
        formats.pack_values(fmt, [value])
    except FormatValueError as problem:
        reader.error("PG107", f"{reader.what}: {problem}", node.span)
        return None
    except ValueError:
        reader.error("PG107", f"{reader.what}: {value!r} is no hexadecimal text", node.span)
        return None
    return cast("Value", value)


def _limits(reader: Reader, fmt: Format) -> Limits:
    found = Limits(reader.real("low"), reader.real("high"))
    for key, value in (("low", found.low), ("high", found.high)):
        node = reader.node.get(key)
        if value is not None and node is not None and _value(reader, fmt, node) is None:
            return Limits()
    return found


def _state_limits(reader: Reader, fmt: Format) -> dict[str, Limits]:
    states = reader.child("state_limits", f"the state limits of {reader.what}")
    if states.node.kind != "map":
        states.only()
        return {}
    found = {}
    for state in states.node.pairs:
        child = states.child(state, f'the limits in the state "{state}"')
        child.only("low", "high")
        found[state] = _limits(child, fmt)
    return found


def _condition(reader: Reader) -> Condition:
    reader.only(*_REFUSE_KEYS)
    reader.require("error")
    while_in, unless_in = frozenset(reader.texts("while")), frozenset(reader.texts("unless"))
    if not while_in and not unless_in and reader.node.kind == "map":
        reader.error("PG105", 'a refusal needs "while" or "unless" with states', reader.node.span)
    return Condition(reader.number("error", 0x11, 0, 0xFF), while_in, unless_in, reader.flag("read"))


def _faults(reader: Reader) -> list[Fault]:
    return [_fault(child) for child in reader.children("faults", "a fault")]


def _fault(reader: Reader) -> Fault:
    reader.only(*(item.name for item in fields(Fault)))
    reader.require("kind")
    kinds: dict[Any, FaultKind] = {kind.value: kind for kind in FaultKind}
    base = Fault(FaultKind.STATUS)
    kind = reader.choice("kind", base.kind, kinds)
    if kind is FaultKind.STATUS and reader.node.kind == "map" and reader.node.get("kind") is not None:
        reader.require("status")
    times = reader.node.get("times")
    forever = times is not None and times.value == "forever"
    return Fault(
        kind,
        times=None if forever else reader.number("times", 1, 1, 1_000_000),
        after=reader.number("after", base.after, 0, 1_000_000),
        call=reader.choice("call", base.call, {"read": "read", "write": "write"}),
        status=reader.number("status", base.status, 1, 0xFFFFFFFF),
        code=reader.number("code", base.code, 0, 0xFF),
        milliseconds=reader.number("milliseconds", base.milliseconds, 0, 10_000_000),
        value=reader.optional("value", 0, 0xFF),
        data=_data(reader, base.data),
        number=reader.number("number", base.number, 0, 0xFFFF),
        position=reader.number("position", base.position, 0, 255),
        words=reader.choice("words", base.words, _words()),
        info=reader.number("info", base.info, 0, 0xFFFF),
    )


def _data(reader: Reader, default: bytes) -> bytes:
    try:
        return bytes.fromhex(reader.text("data")) if reader.node.get("data") is not None else default
    except ValueError:
        node = reader.node.get("data") or reader.node
        reader.error("PG107", f'"data" of {reader.what} is hexadecimal text', node.span)
        return default
