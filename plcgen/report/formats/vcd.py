"""A recorded run as a value change dump (IEEE 1364) for GTKWave and other wave viewers.

BOOL is a wire, words are vectors, integers ``integer``, REAL ``real``; texts, states by name and telegrams are
``string`` variables, as GTKWave reads them. One time step is one millisecond; there is no date in the file.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from plcgen._version import __version__
from plcgen.report.registry import OutputFormat

if TYPE_CHECKING:
    from plcgen.base.display.view import View
    from plcgen.report.trace.model import Kind, Signal, Step, Trace, Value

_FIRST, _LAST = 33, 126
_UNSAFE = re.compile(r"[^A-Za-z0-9_]+", re.ASCII)


@dataclass(frozen=True, slots=True)
class _Variable:
    """One variable: where it stands in the tree, how it is declared, its short identifier."""

    scope: str
    name: str
    kind: Kind
    bits: int
    code: str

    @property
    def declaration(self) -> str:
        """The ``$var`` line."""
        type_, size = {"bool": ("wire", 1), "real": ("real", 64), "text": ("string", 1)}.get(
            self.kind, ("integer" if self.kind == "integer" else "wire", self.bits)
        )
        return f"$var {type_} {size} {self.code} {self.name} $end"

    def change(self, value: Value) -> str:
        """The line that gives the variable a value."""
        if self.kind == "text":
            return f"s{_word(str(value))} {self.code}"
        if self.kind == "real":
            number = float(value) if isinstance(value, int | float) else math.nan
            return f"r{number:.9g} {self.code}"
        number = int(value) if isinstance(value, int) else 0
        if self.kind == "bool":
            return f"{number & 1}{self.code}"
        return f"b{number & (1 << self.bits) - 1:b} {self.code}"


def _code(number: int) -> str:
    """Identifier of the n-th variable: its digits as printable characters, the lowest first."""
    base = _LAST - _FIRST + 1
    text = chr(_FIRST + number % base)
    while number := number // base:
        text += chr(_FIRST + number % base)
    return text


def _word(text: str) -> str:
    """A text without white space, as string values must be; an empty one is a dash."""
    return re.sub(r"\s+", "_", text.encode("ascii", "backslashreplace").decode()) or "-"


def _safe(name: str) -> str:
    return _UNSAFE.sub("_", name).strip("_") or "x"


class _Dump:
    """Builds the file: declarations first, then one time stamp per step."""

    def __init__(self, trace: Trace) -> None:
        self.trace = trace
        self.count = 0
        self.names: set[tuple[str, str]] = set()
        self.variables: list[list[_Variable]] = []
        self.labels: dict[int, _Variable] = {}
        for position, signal in enumerate(trace.signals):
            self.variables.append(self._declare(signal, trace.start[position]))
            if signal.names:
                self.labels[position] = self._new(signal.group, f"{signal.name}_name", "text", 1)
        partners = sorted({contact.partner for step in trace.steps for contact in step.contacts})
        self.telegrams = {
            partner: {d: self._new(partner, d, "text", 1) for d in ("request", "response")} for partner in partners
        }

    def _new(self, group: str, name: str, kind: Kind, bits: int) -> _Variable:
        scope, short = _safe(group), _safe(name)
        unique, number = short, 2
        while (scope, unique.lower()) in self.names:
            unique, number = f"{short}_{number}", number + 1
        self.names.add((scope, unique.lower()))
        self.count += 1
        return _Variable(scope, unique, kind, bits, _code(self.count - 1))

    def _declare(self, signal: Signal, value: Value) -> list[_Variable]:
        """One variable, or one for every element of an array."""
        if not isinstance(value, list):
            kind = "text" if isinstance(value, str) else signal.kind
            return [self._new(signal.group, signal.name, kind, signal.bits)]
        kind = "text" if any(isinstance(item, str | list | dict) for item in value) else signal.kind
        return [self._new(signal.group, f"{signal.name}_{n}", kind, signal.bits) for n in range(len(value))]

    def lines(self) -> Iterator[str]:
        """The whole file, line by line."""
        yield f"$version plcgen {__version__} $end"
        yield f"$comment {_word(self.trace.project)} $end"
        yield "$timescale 1 ms $end"
        yield from self._declarations()
        yield "$enddefinitions $end"
        yield "#0"
        yield "$dumpvars"
        for position, value in enumerate(self.trace.start):
            yield from self._changes(position, value)
        for both in self.telegrams.values():
            yield from (variable.change("") for variable in both.values())
        yield "$end"
        for step in self.trace.steps:
            yield f"#{step.time}"
            yield from self._step(step)
        last = self.trace.steps[-1].time if self.trace.steps else 0
        if self.trace.time > last:
            yield f"#{self.trace.time}"

    def _declarations(self) -> Iterator[str]:
        every = [variable for group in self.variables for variable in group]
        every += [*self.labels.values(), *(v for both in self.telegrams.values() for v in both.values())]
        yield f"$scope module {_safe(self.trace.project)} $end"
        for scope in dict.fromkeys(variable.scope for variable in every):
            yield f"$scope module {scope} $end"
            yield from (variable.declaration for variable in every if variable.scope == scope)
            yield "$upscope $end"
        yield "$upscope $end"

    def _step(self, step: Step) -> Iterator[str]:
        for position, value in step.changes:
            yield from self._changes(position, value)
        for contact in step.contacts:
            name = "request" if contact.direction == "write" else "response"
            text = f"STATUS_{contact.status:08X}" if contact.status else contact.data.hex().upper()
            yield self.telegrams[contact.partner][name].change(text)

    def _changes(self, position: int, value: Value) -> Iterator[str]:
        values = value if isinstance(value, list) else [value]
        yield from (variable.change(item) for variable, item in zip(self.variables[position], values, strict=False))
        if position in self.labels and isinstance(value, int):
            yield self.labels[position].change(self.trace.signals[position].names.get(value, str(value)))


def _trace(trace: Trace, _view: View) -> str:
    return "\n".join(_Dump(trace).lines()) + "\n"


FORMAT = OutputFormat(name="vcd", complete=False, comment=("$comment ", " $end"), trace=_trace)
