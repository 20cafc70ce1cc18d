"""Files of shards: what one of several runs has found, and all of them put together."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from plcgen._version import __version__
from plcgen.base.diagnostics import ArgumentError, Diagnostic, DiagnosticError, Span, has_errors
from plcgen.base.files.files import read_bounded
from plcgen.proof.results import Result
from plcgen.proof.sharing import Shard
from plcgen.proof.stored import RESULT, portable, with_folder

MAX_FILE = 512 * 1024 * 1024
MAX_SHARDS = 1000
_RUN = "run every shard with the same copy of plcgen, spec, files and options, and name all of their files"


class ShardFile(BaseModel):
    """What a shard leaves; ``inputs`` is a hash of all that decides about its parts."""

    model_config = ConfigDict(extra="forbid", strict=True)

    tool: Literal["plcgen"]
    version: str
    format: Literal[1]
    kind: Literal["shard"]
    ok: bool
    inputs: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    shard: Annotated[int, Field(ge=1, le=MAX_SHARDS)]
    of: Annotated[int, Field(ge=1, le=MAX_SHARDS)]
    parts: dict[str, dict[str, Any]]


@dataclass(frozen=True, slots=True)
class ShardResult:
    """The parts that one shard has run. ``failed`` are the names of those that found something."""

    spec: str
    folder: str
    shard: Shard
    inputs: str
    parts: dict[str, Result]
    diagnostics: tuple[Diagnostic, ...] = ()

    @property
    def failed(self) -> tuple[str, ...]:
        """Parts that found something."""
        return tuple(name for name, result in self.parts.items() if result.failures or result.broken)

    @property
    def ok(self) -> bool:
        """Whether nothing was found."""
        return not self.failed and not self.unusable

    @property
    def unusable(self) -> bool:
        """Whether nothing could be run at all."""
        return has_errors(self.diagnostics)

    def data(self) -> dict[str, Any]:
        """For the file."""
        folder = Path(self.folder)
        parts = {name: RESULT.dump_python(portable(result, folder), mode="json") for name, result in self.parts.items()}
        head = {"tool": "plcgen", "version": __version__, "format": 1, "kind": "shard", "ok": self.ok}
        return {**head, "inputs": self.inputs, "shard": self.shard.number, "of": self.shard.of, "parts": parts}


def parse_shard(text: str) -> Shard:
    """``3/10``. Raises ArgumentError."""
    number, slash, of = text.partition("/")
    if not (slash and number.isascii() and number.isdecimal() and of.isascii() and of.isdecimal() and len(text) < 10):
        raise ArgumentError("a shard is written as 3/10, the third of ten")
    shard = Shard(int(number), int(of))
    if not 1 <= shard.number <= shard.of <= MAX_SHARDS:
        raise ArgumentError(f"a shard is one of 1/n to n/n, with n up to {MAX_SHARDS}")
    return shard


def inputs_digest(things: Iterable[object], folder: Path) -> str:
    """Hash over some things and every file below a folder."""
    from plcgen.proof.fingerprint import files_digest

    return files_digest((folder,), hashlib.sha256(repr(tuple(things)).encode()).hexdigest())


def merge_shards(files: Sequence[Path], inputs: str, folder: Path) -> dict[str, Result]:
    """The parts of all shards.

    Raises:
        DiagnosticError: PG625 if a file is none of a shard, was made from something else, or a shard is missing or
            there twice.
    """
    problems: list[Diagnostic] = []
    seen: dict[int, Path] = {}
    of = 0
    parts: dict[str, Result] = {}
    for path in files:
        found = _read(path, inputs)
        if isinstance(found, str):
            problems.append(Diagnostic("PG625", found, Span(str(path)), help=_RUN))
            continue
        shard, results = found
        of = of or shard.of
        if shard.of != of:
            problems.append(
                Diagnostic("PG625", f"shard {shard} together with shards of {of}", Span(str(path)), help=_RUN)
            )
        elif shard.number in seen:
            message = f"shard {shard} is given twice, first in {seen[shard.number]}"
            problems.append(Diagnostic("PG625", message, Span(str(path)), help="name each file once"))
        else:
            seen[shard.number] = path
            parts |= {name: with_folder(result, folder) for name, result in results.items()}
    missing = [str(Shard(number, of)) for number in range(1, of + 1) if number not in seen]
    if missing and not problems:
        where = Span(str(files[0])) if files else Span("")
        problems.append(Diagnostic("PG625", f"missing: shard {', '.join(missing)}", where, help=_RUN))
    if problems:
        raise DiagnosticError(problems)
    return parts


def _read(path: Path, inputs: str) -> tuple[Shard, dict[str, Result]] | str:
    """A shard and its parts, or what is wrong."""
    try:
        data = read_bounded(path, MAX_FILE)
        if len(data) > MAX_FILE:
            return f"the file has more than {MAX_FILE:,} bytes"
        found = ShardFile.model_validate_json(data)
        results = {name: RESULT.validate_python(result) for name, result in found.parts.items()}
    except OSError as problem:
        return f"the file cannot be read: {problem.strerror or problem}"
    except ValidationError:
        return "not the file of a shard"
    if found.inputs != inputs:
        return "made from another spec, other files or options, or by another copy of plcgen"
    return Shard(found.shard, found.of), results
