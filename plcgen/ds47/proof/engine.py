"""The engine as it lies in a folder, the hash over its tokens, and the engines on record as proven (``proven.json``).

The proof itself, every fault of every engine of every target, is ``tests/engine`` in the source tree.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from pathlib import Path
from typing import Self, TypedDict

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.files.files import read_bounded
from plcgen.proof.checks import Check, Outcome
from plcgen.s7.read.text import MAX_BYTES, decode_source
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.lexer import KEYWORDS, tokenize

FILE = Path(__file__).with_name("proven.json")
"""Written by ``make engine``."""
NAMES: Mapping[str, str] = {
    "channel": "DriveChannel", "ticket": "DriveTicket", "gate": "DriveGate", "unit": "typeDriveUnit",
    "order": "typeDriveOrder", "turn": "typeDriveTurn", "ask": "typeDriveAsk", "gate_data": "typeDriveGate",
    "place": "typeDrivePlace",
}  # fmt: skip
"""Blocks and types of the engine, by their roles."""
SHORT = 12
"""Hexadecimal digits of a hash that a report shows."""
_DECLARED = re.compile(r'^\s*(?:FUNCTION_BLOCK|TYPE)\s+"?([^"\s:]+)"?', re.MULTILINE | re.IGNORECASE)
_UNIT = re.compile(
    r"^[ \t]*(?P<kind>FUNCTION_BLOCK|TYPE|DATA_BLOCK|ORGANIZATION_BLOCK)[ \t]+"
    r'(?P<name>"[^"\n]+"|[^"\s:]+).*?^[ \t]*END_(?P=kind)\b',
    re.MULTILINE | re.IGNORECASE | re.DOTALL,
)
_TITLE = re.compile(r"^\s*(?:TITLE\s*=.*|REGION\b.*|END_REGION\s*;?\s*)$", re.MULTILINE)
"""Titles of blocks, and of regions, which the TIA Portal knows from V14 on: before, they are comments."""
_LIBRARY_VERSION = re.compile(r"(LibVersion\s*:=\s*)'[0-9.]*'")


PROVER = ("ds47/proof", "ds47/sim", "ds47/wire", "proof", "s7")
"""The folders of plcgen that take part in the proof of an engine: soft CPU, front end, simulated drive, scenarios."""


class Proven(TypedDict):
    """What is known about an engine: its target, sizes of its arrays, release and hash of the prover, what was run."""

    target: str
    bytes: int
    parameters: int
    slots: int
    channels: int
    release: str
    prover: str
    scenarios: int
    runs: int
    effort: str


def proven() -> Mapping[str, Proven]:
    """Proven engines by their hashes."""
    return json.loads(FILE.read_text(encoding="ascii")) if FILE.is_file() else {}


@cache
def prover_hash(package: Path = FILE.parents[2]) -> str:
    """SHA-256 over names and code of all that proves an engine; line ends of a Windows checkout do not count."""
    digest = hashlib.sha256()
    for folder in PROVER:
        for path in sorted((package / folder).rglob("*")):
            if path.suffix in {".py", ".scl"} and "__pycache__" not in path.parts:
                data = path.read_bytes().replace(b"\r\n", b"\n")
                digest.update(f"{path.relative_to(package).as_posix()} {len(data)}\n".encode() + data)
    return digest.hexdigest()


def _kept(unit: re.Match[str], wanted: Collection[str]) -> str:
    """A unit of the engine; of another one, which stands in the same source, its lines alone."""
    return unit[0] if unit["name"].strip('"').upper() in wanted else "\n" * unit[0].count("\n")


@dataclass(frozen=True)
class DriveEngine:
    """The engine of one target: file names and texts; ``names`` are those of its blocks and types by their roles."""

    dialect: Dialect
    sources: tuple[tuple[str, str], ...]
    names: Mapping[str, str] = field(default_factory=lambda: dict(NAMES))

    @classmethod
    def of(cls, files: Iterable[Path], dialect: Dialect, names: Mapping[str, str] = NAMES) -> Self:
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
                found.append((str(file), _UNIT.sub(lambda unit: _kept(unit, wanted), text)))
        if missing:
            absent = ", ".join(sorted(name for name in names.values() if name.upper() in missing))
            raise DiagnosticError(
                [Diagnostic("PG825", f"the drive engine is not complete: {absent} missing", Span(""))]
            )
        return cls(dialect, tuple(sorted(found)), dict(names))

    @cached_property
    def hash(self) -> str:
        """SHA-256 over target and tokens; comments, titles, regions, library versions, names and case do not count."""
        digest = hashlib.sha256(self.dialect.value.encode())
        for unit in self.units:
            digest.update(b"\n" + " ".join(unit).encode())
        return digest.hexdigest()

    @cached_property
    def units(self) -> list[list[str]]:
        """The tokens of every block and type, in the order of their roles."""
        return sorted(unit for _, text in self.sources for unit in self._units(text))

    def place(self) -> Span:
        """Where the first block of the engine begins, as far as there is one."""
        heads = tuple(f'FUNCTION_BLOCK "{name}"' for name in self.names.values())
        places = (
            Span(file, number, 1, end_column=len(line) + 1)
            for file, text in self.sources
            for number, line in enumerate(text.splitlines(), 1)
            if line.startswith(heads)
        )
        return next(places, Span(self.sources[0][0]))

    def _units(self, text: str) -> Iterator[list[str]]:
        """The tokens of every block or type of the engine in a source."""
        roles = {name.upper(): f"<{role}>" for role, name in self.names.items()}
        tokens = tokenize(_LIBRARY_VERSION.sub(r"\1''", _TITLE.sub("", text)), "")
        unit: list[str] = []
        for kind, spelled in zip(tokens.kinds, tokens.texts, strict=True):
            plain = spelled.strip('"').upper()
            unit.append(roles.get(plain, kind if kind in KEYWORDS else spelled))
            if kind in {"END_FUNCTION_BLOCK", "END_TYPE", "END_DATA_BLOCK"}:
                if any(word in roles.values() for word in unit[:2]):
                    yield unit
                unit = []


def engine_check(engine: DriveEngine) -> Check:
    """Whether the engine in a folder is one that was proven: its text is none of the project's, so nothing is run."""
    known = proven().get(engine.hash)
    short = engine.hash[:SHORT]
    if known is None:
        message = f"the drive engine in this folder (channel, ticket, gate) is none that was proven: {short}"
        remedy = "generate the folder again; who changes a template of the engine runs make engine"
        found = Diagnostic("PG621", message, engine.place(), help=remedy)
        return Check("engine", f"engine {short}", "", Outcome.ERROR, message, found)
    by, here = known["prover"][:SHORT], prover_hash()[:SHORT]
    checks = "the checks of this copy" if by == here else f"earlier checks ({by}, now {here}); the text is the same"
    verdict = f"engine {short}: proven with release {known['release']} by {checks}; not repeated here, nothing to do"
    return Check("engine", f"engine {short}", f"{known['scenarios']:,} scenarios", Outcome.NOT_RUN, verdict)
