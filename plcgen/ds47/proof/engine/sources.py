"""The engine as it lies in a folder: its blocks and types, its sizes, and the hash over its tokens."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain
from pathlib import Path
from typing import Any

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.files.files import read_bounded
from plcgen.ds47.proof.engine.stimulus import Sizes, engine_stimulus
from plcgen.proof.rig import layout_of
from plcgen.s7.cpu.program import Program
from plcgen.s7.layout.layout import locate
from plcgen.s7.read.text import MAX_BYTES, decode_source
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.lexer import KEYWORDS, tokenize
from plcgen.s7.types.data_types import ArrayType

NAMES: Mapping[str, str] = {
    "channel": "DriveChannel", "ticket": "DriveTicket", "gate": "DriveGate", "unit": "typeDriveUnit",
    "order": "typeDriveOrder", "turn": "typeDriveTurn", "ask": "typeDriveAsk", "gate_data": "typeDriveGate",
    "place": "typeDrivePlace",
}  # fmt: skip
"""Blocks and types of the engine, by their roles."""
BLOCKS = ("channel", "ticket", "gate")
SHORT = 12
"""Hexadecimal digits of a hash that a report shows."""
_DECLARED = re.compile(r'^\s*(?:FUNCTION_BLOCK|TYPE)\s+"?([^"\s:]+)"?', re.MULTILINE | re.IGNORECASE)
_CALLERS = re.compile(
    r"""("(?:Unit[1-3]|GateData|ProofCalls|OB[0-9]+)"(?: : Void)?\s*\{ S7_Optimized_Access := )'FALSE'"""
)
"""Access of the data that others share, and of those who call with it."""
_TITLE = re.compile(r"^\s*TITLE\s*=.*$", re.MULTILINE)
_LIBRARY_VERSION = re.compile(r"(LibVersion\s*:=\s*)'[0-9.]*'")


@dataclass(frozen=True)
class DriveEngine:
    """The engine of one target: file names and texts; ``names`` are those of its blocks and types by their roles.

    ``mixed``: units and their callers have optimised access.
    """

    dialect: Dialect
    sources: tuple[tuple[str, str], ...]
    names: Mapping[str, str] = field(default_factory=lambda: dict(NAMES))
    mixed: bool = False

    @classmethod
    def of(cls, files: Iterable[Path], dialect: Dialect, names: Mapping[str, str] = NAMES) -> DriveEngine:
        """Pick the engine out of the sources of a project. Raises DiagnosticError if something of it is missing."""
        wanted = {name.upper() for name in names.values()}
        found: list[tuple[str, str]] = []
        missing = set(wanted)
        for file in files:
            text = decode_source(read_bounded(file, MAX_BYTES), str(file))
            if isinstance(text, Diagnostic):
                raise DiagnosticError([text])
            declared = {name.upper() for name in _DECLARED.findall(text)} & wanted
            if declared:
                missing -= declared
                found.append((str(file), text))
        if missing:
            absent = ", ".join(sorted(name for name in names.values() if name.upper() in missing))
            raise DiagnosticError(
                [Diagnostic("PG825", f"the drive engine is not complete: {absent} missing", Span(""))]
            )
        return cls(dialect, tuple(sorted(found)), dict(names))

    @cached_property
    def program(self) -> Program:
        """The engine with the stimulus around it, compiled. Raises DiagnosticError."""
        text = engine_stimulus(self.dialect, self.names, self.sizes)
        if self.mixed:
            text = _CALLERS.sub(r"\1'TRUE'", text)
        sources = [*self.sources, ("stimulus.scl", text)]
        program = Program.load(sources, self.dialect, coverage=True, litter=True)
        if not program.ok:
            raise DiagnosticError([d for d in program.diagnostics if d.severity.label == "error"])
        return program

    @cached_property
    def sizes(self) -> Sizes:
        """Sizes of the unit's arrays. Raises DiagnosticError."""
        members = f' unit : "{self.names["unit"]}";\n gate : "{self.names["gate_data"]}";\n'
        text = f'DATA_BLOCK "Sizes"\nSTRUCT\n{members}END_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'
        program = Program.load([*self.sources, ("sizes.db", text)], self.dialect)
        if not program.ok:
            raise DiagnosticError([d for d in program.diagnostics if d.severity.label == "error"])
        layout = layout_of(program, "Sizes")

        def last(member: str) -> int:
            type_ = locate(layout, f"unit.{member}").type
            return type_.bounds[0][1] if isinstance(type_, ArrayType) else 0

        gate = locate(layout, "gate.channels").type
        return Sizes(
            last("telegram"), last("errors"), last("asks"), gate.bounds[0][1] if isinstance(gate, ArrayType) else 0
        )

    @cached_property
    def hash(self) -> str:
        """SHA-256 over target and tokens. Comments, titles, versions of library blocks, names and case do not count."""
        digest = hashlib.sha256(self.dialect.value.encode())
        for unit in self.units:
            digest.update(b"\n" + " ".join(unit).encode())
        return digest.hexdigest()

    @cached_property
    def units(self) -> list[list[str]]:
        """The tokens of every block and type, in the order of their roles."""
        return sorted(unit for _, text in self.sources for unit in self._units(text))

    def differs_in_sizes_only(self, other: DriveEngine) -> bool:
        """Whether another engine of the target has the same text but for the numbers that are its sizes."""
        if self.dialect is not other.dialect or [len(u) for u in self.units] != [len(u) for u in other.units]:
            return False
        pairs = zip(chain(*self.units), chain(*other.units), strict=True)
        known = {
            (a, b) for one, two in zip(self.sizes.numbers, other.sizes.numbers, strict=True) for a, b in ((one, two),)
        }
        return all(one == two or (one, two) in known for one, two in pairs)

    def _units(self, text: str) -> Iterator[list[str]]:
        """The tokens of every block or type of the engine in a source."""
        roles = {name.upper(): f"<{role}>" for role, name in self.names.items()}
        tokens = tokenize(_LIBRARY_VERSION.sub(r"\1''", _TITLE.sub("", text)), "")
        unit: list[str] = []
        for kind, spelled in zip(tokens.kinds, tokens.texts, strict=True):
            plain = spelled.strip('"').upper()
            unit.append(roles.get(plain, kind if kind in KEYWORDS else spelled))
            if kind in {"END_FUNCTION_BLOCK", "END_TYPE"}:
                if any(word in roles.values() for word in unit[:2]):
                    yield unit
                unit = []

    def __reduce__(self) -> tuple[Any, ...]:
        """A program cannot be pickled: a worker compiles it again."""
        return DriveEngine, (self.dialect, self.sources, self.names, self.mixed)
