"""What the result of a part depends on, as a hash: the tool, its share of the spec, and the sources that it can reach.

A part runs on a CPU that has the whole program. What it reaches of it are the blocks that it calls and, again and
again, every block, type, tag and constant whose name stands in the code or the declarations of what is reached, so that
rather more is taken in than is used. Other data blocks are there, too, but none of their bytes is
read: a job that reached beyond its own would change them, and its run fails.
"""

from __future__ import annotations

import dataclasses
import enum
import hashlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path, PurePath
from types import FunctionType
from typing import Any, Protocol

from pydantic import BaseModel

from plcgen.base.diagnostics import PlcgenError
from plcgen.proof.effort import Faults
from plcgen.proof.fingerprint import fingerprint
from plcgen.proof.rig import ProgramBench
from plcgen.proof.suite import Procedure, Reads, Suite, WorkPart
from plcgen.s7.cpu.program import Program
from plcgen.s7.scl.lexer import ADDRESS, LOCAL, STRING, tokenize
from plcgen.s7.types.blocks import BlockKind

_LEFT_OUT = frozenset({"loaded", "protocol", "comment", "path"})
"""Fields that no run looks at: the text of the spec and places in it, the code of the tool, texts for people."""


class ExecutionParts(Protocol):
    """The parts of an execution."""

    @property
    def bench(self) -> ProgramBench:
        """The project and its program."""

    @property
    def level(self) -> Faults:
        """How many faults."""

    @property
    def suites(self) -> Sequence[Suite[Any]]:
        """Whose jobs they are."""

    @property
    def procedures(self) -> Sequence[Sequence[Procedure]]:
        """What the jobs of each suite do together."""

    @property
    def parts(self) -> Sequence[WorkPart]:
        """All of them."""


class UnknownError(PlcgenError):
    """Nobody can say what this holds."""


def key_of(*things: object) -> str:
    """Hash over the tool and some things; "" if one of them cannot be told."""
    try:
        return _Digest().of((fingerprint(), *things)).hex()
    except UnknownError:
        return ""


def part_keys(work: ExecutionParts) -> Callable[[int], str]:
    """What each part of an execution depends on."""
    made: list[_Keys] = []

    def key(index: int) -> str:
        if not made:
            made.append(_Keys(work))
        return made[0].of(work.parts[index])

    return key


class _Keys:
    """Keys of the parts of one execution."""

    def __init__(self, work: ExecutionParts) -> None:
        self.work, self.digest = work, _Digest()
        self.sources = _Sources(work.bench.program, work.bench.folder)
        self._whole = ""

    def of(self, part: WorkPart) -> str:
        """Key of a part."""
        suite = self.work.suites[part.suite]
        if part.job is not None:
            name, reads = suite.jobs[part.job].key, suite.reads(suite.jobs[part.job])
        else:
            procedure = self.work.procedures[part.suite][part.procedure]
            name, reads = procedure.name, procedure.reads
        about = (type(suite).__qualname__, suite.prefix, part.job is None, name, self.work.level)
        try:
            seen = self.whole if reads is None else self.read(reads)
            return self.digest.of((fingerprint(), about, seen)).hex()
        except UnknownError:
            return ""

    @property
    def whole(self) -> str:
        """Everything."""
        if not self._whole:
            project = self.work.bench.project
            plans = self.digest.of((project.target, project.loaded.text, project.plans))
            self._whole = self.digest.of((plans, self.sources.everything())).hex()
        return self._whole

    def read(self, reads: Reads) -> tuple[bytes, bytes]:
        """Some blocks, and some of the plan."""
        return self.digest.of(reads.plan), self.digest.of(list(self.sources.reached(reads.blocks)))


class _Sources:
    """The texts of a program, by the names of its blocks."""

    def __init__(self, program: Program, folder: Path) -> None:
        self.program, self.folder = program, folder
        link = program.link
        self.common = [
            link.dialect, link.mixed, link.eno, link.litter, link.coverage, link.iec_check, dict(link.stated),
            any(found.moving for found in program.compiled),
            sorted((entry.number or 0, name) for name, entry in link.blocks.items() if entry.block.kind is BlockKind.DB)
            if link.classic else (),
        ]  # fmt: skip
        self._names: dict[str, frozenset[str]] = {}

    def everything(self) -> list[object]:
        """All texts and tags."""
        parts = self.program.link
        texts = {entry.result.tokens.file: entry.result.tokens.source for entry in parts.blocks.values()}
        return [
            self.common, sorted((self.relative(file), text) for file, text in texts.items()), parts.aliases,
            [(name, repr(tag)) for name, tag in sorted(parts.tags.items())], parts.literals,
        ]  # fmt: skip

    def reached(self, roots: Iterable[str]) -> Iterator[object]:
        """What is common to all parts, then every name that is reached from some blocks, with what it stands for."""
        yield self.common
        link, start = self.program.link, self.program.start_up()
        waiting = [name.upper() for name in (*roots, *((start.name,) if start is not None else ()))]
        seen: set[str] = set()
        files: dict[str, str] = {}
        tags: dict[str, str] = {}
        while waiting:
            name = waiting.pop()
            if name in seen:
                continue
            seen.add(name)
            tags |= {name: repr(link.tags[name])} if name in link.tags else {}
            tags |= {name: link.literals[name]} if name in link.literals else {}
            if name in link.aliases:
                tags[f"alias {name}"] = link.aliases[name]
                waiting.append(link.aliases[name])
            if name in link.blocks:
                key, text = self.text(name)
                files[key] = text
                waiting += self.names(name) - seen
        yield sorted(files.items())
        yield sorted(tags.items())

    def text(self, name: str) -> tuple[str, str]:
        """Where a block stands, and its text."""
        entry = self.program.link.blocks[name]
        tokens = entry.result.tokens
        return f"{self.relative(tokens.file)} {name}", tokens.source[entry.unit.start : entry.unit.end]

    def names(self, name: str) -> frozenset[str]:
        """Names in the text of a block that mean something in the program; those behind a dot are members."""
        link = self.program.link
        key, text = self.text(name)
        if key not in self._names:
            tokens = tokenize(text, key)
            words = {
                word.strip('%"').partition("." if kind == ADDRESS else "\n")[0].upper()
                for kind, word, before in zip(tokens.kinds, tokens.texts, ["", *tokens.kinds], strict=False)
                if kind not in {LOCAL, STRING} and before != "."
            }
            known = (link.blocks, link.tags, link.aliases, link.literals)
            self._names[key] = frozenset(word for word in words if any(word in names for names in known))
        return self._names[key]

    def relative(self, file: str) -> str:
        """Name of a file that does not depend on where the folder lies."""
        path = Path(file)
        return path.relative_to(self.folder).as_posix() if path.is_relative_to(self.folder) else file


class _Digest:
    """Hashes of values that are equal in every process: order of sets and places in memory do not count."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[object, bytes]] = {}
        self._open: set[int] = set()

    def of(self, value: object) -> bytes:
        """Hash of a value.

        Raises:
            UnknownError: if it holds something that cannot be told, such as a function with values of its own.
        """
        if value is None or isinstance(value, bool | int | float | str | bytes):
            return _hash(type(value).__name__, repr(value).encode(errors="surrogatepass"))
        known = self._known.get(id(value))
        if known is not None:
            return known[1]
        if id(value) in self._open:
            raise UnknownError(type(value))
        self._open.add(id(value))
        found = _hash(type(value).__qualname__, *self._inside(value))
        self._open.discard(id(value))
        self._known[id(value)] = value, found  # it is held, so that no other gets its id
        return found

    def _inside(self, value: object) -> Iterator[bytes]:
        if isinstance(value, enum.Enum):
            yield value.name.encode()
        elif isinstance(value, bytearray | PurePath):
            yield repr(value).encode()
        elif isinstance(value, Mapping):
            yield from sorted(self.of(key) + self.of(each) for key, each in value.items())
        elif isinstance(value, set | frozenset):
            yield from sorted(map(self.of, value))
        elif isinstance(value, Sequence):
            yield from map(self.of, value)
        elif isinstance(value, FunctionType | type):
            yield _code(value)
        else:
            for name, each in _fields(value):
                if name not in _LEFT_OUT:
                    yield name.encode()
                    yield self.of(each)


def _code(value: FunctionType | type) -> bytes:
    if isinstance(value, FunctionType) and (value.__closure__ or not value.__module__.startswith("plcgen.")):
        raise UnknownError(value.__qualname__)
    line = value.__code__.co_firstlineno if isinstance(value, FunctionType) else 0
    return f"{value.__module__} {value.__qualname__} {line}".encode()


def _fields(value: object) -> Iterator[tuple[str, Any]]:
    if isinstance(value, BaseModel):
        yield from ((name, getattr(value, name)) for name in type(value).model_fields)
    elif dataclasses.is_dataclass(value):
        yield from ((each.name, getattr(value, each.name)) for each in dataclasses.fields(value))
    else:
        raise UnknownError(type(value).__qualname__)


def _hash(name: str, *parts: bytes) -> bytes:
    digest = hashlib.sha256(name.encode())
    for part in parts:
        digest.update(len(part).to_bytes(8) + part)
    return digest.digest()
