"""Read a simulated drive from YAML: habits, drive objects with their parameters, faults.

The file is described in docs/drive-yaml.md. Every problem is collected with its position: PG104 unknown key,
PG105 missing key, PG106 wrong kind of value, PG107 value out of range.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Literal, TypeVar, cast

from plcgen.diagnostics import Diagnostic, Report, Span
from plcgen.ds47 import formats
from plcgen.ds47.formats import Format, FormatValueError, Value
from plcgen.sim.drive import Drive
from plcgen.sim.faults import Fault, FaultKind
from plcgen.sim.habits import Habits
from plcgen.sim.parameters import READY, Condition, DriveObject, Limits, Parameter
from plcgen.spec.source import Node, load_yaml

T = TypeVar("T")

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
    return _drive(_node(data, Span(file)), file)


def faults_from(data: Sequence[Mapping[str, Any]], file: str = "<faults>") -> list[Fault]:
    """Build faults from plain mappings, as the key ``faults`` of a drive file holds them."""
    report = Report()
    found = _faults(_Reader(_node({"faults": data}, Span(file)), report, "the faults"))
    report.raise_on_errors()
    return found


def _drive(root: Node, file: str) -> Drive:
    report = Report()
    reader = _Reader(root, report, "a drive")
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


def _node(data: Any, span: Span) -> Node:
    """Wrap plain data as nodes without a position."""
    if isinstance(data, Mapping):
        pairs = {str(key): (Node("scalar", span, str(key)), _node(value, span)) for key, value in data.items()}
        return Node("map", span, pairs=pairs)
    if isinstance(data, list | tuple):
        return Node("seq", span, items=[_node(item, span) for item in data])
    return Node("scalar", span, data, str(data))


@dataclass(slots=True)
class _Reader:
    """Reads the keys of one mapping; problems go to the report and the default is used instead."""

    node: Node
    report: Report
    what: str

    def error(self, code: str, message: str, span: Span, help_: str = "") -> None:
        self.report.add(Diagnostic(code, message, span, help=help_))

    def only(self, *keys: str) -> None:
        if self.node.kind != "map":
            self.error("PG106", f"{self.what} is a mapping", self.node.span)
            return
        for key in self.node.pairs:
            if key not in keys:
                self.error(
                    "PG104",
                    f'unknown key "{key}" in {self.what}',
                    self.node.key_span(key),
                    "keys here: " + ", ".join(keys),
                )

    def require(self, key: str) -> None:
        if self.node.kind == "map" and self.node.get(key) is None:
            self.error("PG105", f'{self.what} lacks the key "{key}"', self.node.span)

    def child(self, key: str, what: str) -> _Reader:
        node = self.node.get(key) or Node("map", self.node.span)
        return _Reader(node, self.report, what)

    def children(self, key: str, what: str) -> list[_Reader]:
        return [_Reader(item, self.report, what) for item in self.items(key)]

    def items(self, key: str) -> list[Node]:
        node = self.node.get(key)
        if node is None:
            return []
        if node.kind != "seq":
            self.error("PG106", f'"{key}" of {self.what} is a list', node.span)
            return []
        return node.items

    def number(self, key: str, default: int, low: int, high: int) -> int:
        node = self.node.get(key)
        if node is None:
            return default
        return self._integer(node, key, default, low, high)

    def _integer(self, node: Node, key: str, default: int, low: int, high: int) -> int:
        value = node.value
        if node.kind != "scalar" or isinstance(value, bool) or not isinstance(value, int):
            self.error("PG106", f'"{key}" of {self.what} is a whole number', node.span)
            return default
        if not low <= value <= high:
            self.error("PG107", f'"{key}" of {self.what} is {value}, allowed: {low} to {high}', node.span)
            return default
        return value

    def optional(self, key: str, low: int, high: int) -> int | None:
        node = self.node.get(key)
        if node is None or (node.kind == "scalar" and node.value is None):
            return None
        return self._integer(node, key, low, low, high)

    def real(self, key: str) -> float | None:
        node = self.node.get(key)
        if node is None:
            return None
        if isinstance(node.value, bool) or not isinstance(node.value, int | float):
            self.error("PG106", f'"{key}" of {self.what} is a number', node.span)
            return None
        return node.value

    def flag(self, key: str, *, default: bool = False) -> bool:
        node = self.node.get(key)
        if node is None:
            return default
        if not isinstance(node.value, bool):
            self.error("PG106", f'"{key}" of {self.what} is true or false', node.span)
            return default
        return node.value

    def text(self, key: str, default: str = "") -> str:
        node = self.node.get(key)
        if node is None:
            return default
        if not isinstance(node.value, str):
            self.error("PG106", f'"{key}" of {self.what} is text', node.span)
            return default
        return node.value

    def choice(self, key: str, default: T, choices: Mapping[Any, T]) -> T:
        node = self.node.get(key)
        if node is None:
            return default
        if node.kind != "scalar" or node.value not in choices:
            names = ", ".join(str(name) for name in choices)
            self.error("PG107", f'"{key}" of {self.what} is one of: {names}', node.span)
            return default
        return choices[node.value]

    def numbers(self, key: str, default: Sequence[int], high: int) -> tuple[int, ...]:
        if self.node.get(key) is None:
            return tuple(default)
        return tuple(self._integer(item, key, 0, 0, high) for item in self.items(key))

    def texts(self, key: str) -> tuple[str, ...]:
        for item in self.items(key):
            if not isinstance(item.value, str):
                self.error("PG106", f'"{key}" of {self.what} is a list of texts', item.span)
        return tuple(item.value for item in self.items(key) if isinstance(item.value, str))


def _habits(reader: _Reader) -> Habits:
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


def _aliases(reader: _Reader) -> dict[int, int]:
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


def _object(reader: _Reader) -> DriveObject:
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


def _parameter(reader: _Reader) -> Parameter | None:
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


def _format(reader: _Reader) -> Format:
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


def _value(reader: _Reader, fmt: Format, node: Node) -> Value | None:
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


def _limits(reader: _Reader, fmt: Format) -> Limits:
    found = Limits(reader.real("low"), reader.real("high"))
    for key, value in (("low", found.low), ("high", found.high)):
        node = reader.node.get(key)
        if value is not None and node is not None and _value(reader, fmt, node) is None:
            return Limits()
    return found


def _state_limits(reader: _Reader, fmt: Format) -> dict[str, Limits]:
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


def _condition(reader: _Reader) -> Condition:
    reader.only(*_REFUSE_KEYS)
    reader.require("error")
    while_in, unless_in = frozenset(reader.texts("while")), frozenset(reader.texts("unless"))
    if not while_in and not unless_in and reader.node.kind == "map":
        reader.error("PG105", 'a refusal needs "while" or "unless" with states', reader.node.span)
    return Condition(reader.number("error", 0x11, 0, 0xFF), while_in, unless_in, reader.flag("read"))


def _faults(reader: _Reader) -> list[Fault]:
    return [_fault(child) for child in reader.children("faults", "a fault")]


def _fault(reader: _Reader) -> Fault:
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


def _data(reader: _Reader, default: bytes) -> bytes:
    try:
        return bytes.fromhex(reader.text("data")) if reader.node.get("data") is not None else default
    except ValueError:
        node = reader.node.get("data") or reader.node
        reader.error("PG107", f'"data" of {reader.what} is hexadecimal text', node.span)
        return default
