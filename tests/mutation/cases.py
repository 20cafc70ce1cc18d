"""Which source is damaged how: every mutant of the shipped examples in its place."""

from __future__ import annotations

import atexit
import os
import re
import shutil
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from plcgen import api
from plcgen.base.diagnostics import Report
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.project.loading import load_spec
from plcgen.project.nouns import Project
from plcgen.project.resolve import resolve
from plcgen.proof.suite import CodeBlock
from plcgen.s7.scl.dialect import Dialect
from tests.mutation.engine import ENGINE, FILES
from tests.mutation.known import KNOWN
from tests.mutation.operators import Mutant, dropped, swapped, tokens
from tests.projects import per_block_spec

ROOT = Path(__file__).resolve().parents[2]
PPI = tuple(sorted(path.stem for path in (ROOT / "tests" / "mutation" / "specs").glob("*.yaml")))
"""PPI masters that have one of everything, each in a spec of its own."""
_RUN = "PLCGEN_MUTATION_RUN"
"""Names the temporary folder of a run to the processes that it starts."""
KINDS: dict[str, Callable[[str], Iterable[Mutant]]] = {"dropped": dropped, "exchanged": swapped, "changed": tokens}
"""Kinds of damage by name: statements dropped, neighbours exchanged, operators and constants changed."""


@dataclass(frozen=True, slots=True)
class Case:
    """A mutant in its place; ``key`` is that of the block, empty for the main program.

    ``turn`` counts the mutants of a file that are described alike, from 1.
    """

    spec: str
    file: str
    key: str
    mutant: Mutant
    turn: int = 1

    @property
    def group(self) -> str:
        """Line of the table: the engine of a target, or the blocks of a spec."""
        return f"engine, {project_of(self.spec).target.dialect.label}" if self.key == ENGINE else self.spec


_projects: dict[str, Project] = {}


def path_of(spec: str) -> Path:
    """A shipped spec, or one that is only damaged here; its blocks are a file each."""
    return ROOT / "tests" / "mutation" / "specs" / f"{spec}.yaml" if spec in PPI else per_block_spec(spec)


def project_of(spec: str) -> Project:
    """The plan of a shipped spec."""
    if spec not in _projects:
        loaded = load_spec(path_of(spec), Report())
        if loaded is None:
            raise SystemExit(f"{spec} cannot be read")
        _projects[spec] = resolve(loaded, Report())
    return _projects[spec]


def blocks_of(spec: str) -> list[CodeBlock]:
    """The function blocks of a shipped spec."""
    plans = project_of(spec).plans
    return [block for plan in plans for suite in plan.protocol.proof(plan).suites() for block in suite.blocks()]


def run_folder() -> Path:
    """The temporary folder of this run: no other run touches it, and it goes when the run ends."""
    if _RUN not in os.environ:
        os.environ[_RUN] = tempfile.mkdtemp(prefix="plcgen-mutation-")
        atexit.register(shutil.rmtree, os.environ[_RUN], ignore_errors=True)
    return Path(os.environ[_RUN])


def golden(spec: str) -> Path:
    """The generated files of a shipped spec, made once in a temporary folder of this process."""
    folder = run_folder() / f"{os.getpid()}-whole" / spec
    if not folder.exists() and not api.generate(path_of(spec), folder).ok:
        raise SystemExit(f"{spec} cannot be generated")
    return folder


def encoding_of(spec: str) -> str:
    """Encoding of the sources of a spec."""
    return "cp1252" if project_of(spec).target.v5 else "utf-8-sig"


def cases(specs: Iterable[str], kinds: Iterable[str] = tuple(KINDS), *, main: bool = False) -> Iterator[Case]:
    """Every mutant of every function block, of the shared ones once for each target; ``main`` takes the OB too.

    The values of a request are those of its type.
    """
    engines: set[Dialect] = set()
    for spec in specs:
        files = {f"scl/{block.block}.scl": block.key for block in blocks_of(spec)}
        files |= {request: key for file, key in files.items() for request in requests(spec, file)}
        if project_of(spec).plan(DrivePlan) and project_of(spec).target.dialect not in engines:
            engines.add(project_of(spec).target.dialect)
            files |= {f"scl/{name}.scl": ENGINE for name in FILES}
        for file, key in {**files, **({"scl/Main.scl": ""} if main else {})}.items():
            text = (golden(spec) / file).read_text(encoding=encoding_of(spec))
            turns: Counter[str] = Counter()
            of_code = [kind for kind in kinds if file.startswith("scl/") or kind == "changed"]
            for mutant in (mutant for kind in of_code for mutant in KINDS[kind](text)):
                turns[mutant.what] += 1
                yield Case(spec, file, key, mutant, turns[mutant.what])


def requests(spec: str, file: str) -> list[str]:
    """The files of the types of a block's requests."""
    folder = golden(spec)
    text = (folder / file).read_text(encoding=encoding_of(spec))
    names = re.findall(r'"(type\w*Request\w*)"', text)
    return [path.relative_to(folder).as_posix() for name in names for path in folder.glob(f"udt/{name}.*")]


def classic(text: str) -> str:
    """A text without the # before the names of a block: that of a constant such as W#16#7000 stays."""
    return re.sub(r"(?<!\w)#", "", text)


def spread(work: Iterable[Case]) -> list[Case]:
    """Mutants of the engine that are spelled the same in several targets in one of them, in turn; all others."""
    found: dict[tuple[object, ...], list[Case]] = {}
    for case in work:
        place = (case.file, classic(case.mutant.what), case.turn)
        found.setdefault(("" if case.key == ENGINE else case.spec, *place), []).append(case)
    return [same[number % len(same)] for number, same in enumerate(found.values())]


def known_cases() -> Iterator[Case]:
    """The ten faults of other libraries."""
    for known in KNOWN:
        text = (golden(known.spec) / known.file).read_text(encoding=encoding_of(known.spec))
        if known.old not in text:
            raise SystemExit(f"{known.name}: {known.old!r} is not in {known.file}")
        keys = {f"scl/{block.block}.scl": block.key for block in blocks_of(known.spec)}
        keys |= {request: key for file, key in keys.items() for request in requests(known.spec, file)}
        key = keys.get(known.file, ENGINE)
        yield Case(known.spec, known.file, key, Mutant(known.name, 0, text.replace(known.old, known.new)))
