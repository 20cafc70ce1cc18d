"""A program: sources read, blocks laid out and compiled, everything wrong with them in ``diagnostics``."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import groupby, islice
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Severity, Span, has_errors
from plcgen.s7.cpu.compiler.block import compile_block
from plcgen.s7.cpu.linkage import ENO, Compiled, Linkage, Probe, ProgramBlock
from plcgen.s7.cpu.outside import Answer, Stub
from plcgen.s7.cpu.start_values import unfit_constants, with_constants
from plcgen.s7.cpu.surroundings import Surroundings, add_unknown_types, without_refused
from plcgen.s7.cpu.system.interfaces import SystemFb, system_fbs
from plcgen.s7.cpu.type_rules import IecCheck
from plcgen.s7.layout.image import StartValueError, image
from plcgen.s7.layout.layout import layout_block
from plcgen.s7.layout.shapes import OPEN_ARRAY, TypeTable
from plcgen.s7.read.text import has_bodies, load_text
from plcgen.s7.scl.constants import is_bits_of_real
from plcgen.s7.scl.declarations import blocks as declared_blocks
from plcgen.s7.scl.declarations import circles, recursive_types
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.grammar.documents import IEC_CHECK, is_document
from plcgen.s7.scl.parser import ParseResult, parse
from plcgen.s7.types.blocks import OF_BLOCKS, Block, BlockKind
from plcgen.s7.types.data_types import NamedType

Source = Path | str | tuple[str, str]
"""A file, a text with line breaks, or (file name, text)."""

MAX_PROGRAM_BYTES = 4 * 1024 * 1024
"""Largest data block the soft CPU holds."""

_ONE_ELEMENT = re.compile(r"index -?\d+ is outside (-?\d+)\.\.\1$|more than 1 values$")
_CODE = frozenset({BlockKind.FB, BlockKind.FC, BlockKind.OB})


@dataclass(slots=True)
class Program:
    """Compiled blocks; ``images`` are the start contents of the data blocks by index."""

    link: Linkage
    diagnostics: list[Diagnostic] = field(default_factory=list)
    compiled: list[Compiled] = field(default_factory=list)
    images: dict[int, bytes] = field(default_factory=dict)
    interruptible: list[Compiled] = field(default_factory=list)
    answers: dict[str, Answer] = field(default_factory=dict)
    """What Python does instead of blocks without code, by their upper-case names."""
    lean: bool = False
    """Whether no trees are kept, which take more memory than all else: a block that is compiled is parsed again."""
    circles: bool = False
    """Whether types that contain themselves have been reported: the layout finds them again."""
    _runs: tuple[tuple[str, int, int], ...] = ()

    @property
    def ok(self) -> bool:
        """Whether no diagnostic is an error."""
        return not has_errors(self.diagnostics)

    @property
    def probes(self) -> list[Probe]:
        """Places of which coverage says how often they were passed."""
        return self.link.probes

    def passed(self, counters: Sequence[int], first: int = 0) -> list[int]:
        """How often the places from number ``first`` on were passed, from as many counters of a CPU."""
        counted_by = self.link.counted_by[first : first + len(counters)]
        return [counters[number - first] for number in counted_by]

    def runs(self) -> tuple[tuple[str, int, int], ...]:
        """Source, begin and end of the probes that follow each other in one block: a few pieces for each block."""
        if not self._runs:
            found, begin = [], 0
            for source, group in groupby(self.probes, lambda probe: probe.source):
                end = begin + sum(1 for _ in group)
                found.append((source, begin, end))
                begin = end
            self._runs = tuple(found)
        return self._runs

    @property
    def systems(self) -> Mapping[str, SystemFb]:
        """System function blocks of the target."""
        return system_fbs(classic=self.link.classic)

    @classmethod
    def load(
        cls,
        sources: Iterable[Source],
        dialect: Dialect,
        *,
        tags: Mapping[str, str | tuple[str, str]] | None = None,
        numbers: Mapping[str, int] | None = None,
        constants: Mapping[str, int] | None = None,
        coverage: bool = False,
        litter: bool = False,
        iec_check: IecCheck = IecCheck.AS_STATED,
        foreign: Collection[Source] = (),
        stated: Mapping[str, bool] | None = None,
        encoding: str | None = None,
        beside: Surroundings | None = None,
        lean: bool = False,
        stubs: Iterable[Stub] = (),
    ) -> Program:
        """Read, check and compile sources in any order.

        ``tags`` maps names to addresses (``M50.0``, or with a type ``("MW22", "INT")``), or block symbols to
        numbers (``DB 471``); ``numbers`` maps names of data blocks to their numbers, ``constants`` names of system
        constants to theirs. ``coverage`` counts statements, branches and deciding operands; with ``litter`` local data
        holds garbage at the start of a call, of two kinds in turn. ``iec_check`` says which implicit conversions are
        right, ``stated`` the same of single blocks, and those of ``foreign`` sources, which plcgen did not generate,
        have none unless it is stated; ``encoding`` names the code page of ANSI files. What
        ``beside`` knows counts where nothing else says it; ``lean`` is for large programs. ``stubs`` are blocks that
        Python stands in for.
        """
        program = cls(Linkage(dialect, coverage=coverage, litter=litter, iec_check=iec_check), lean=lean)
        beside = beside or Surroundings()
        program.link.add_constants(constants or {}, beside.constants)
        program.link.stated = beside.stated | {name.upper(): checked for name, checked in (stated or {}).items()}
        for source in sorted(sources, key=lambda source: isinstance(source, Path) and is_document(source.name)):
            before = len(program.link.blocks)
            program.read(source, encoding)
            if source in foreign:
                program.link.foreign.update(islice(program.link.blocks, before, None))
        for stub in stubs:
            before = len(program.link.blocks)
            program.read(("stub.scl", stub.interface))
            program.answers |= dict.fromkeys(islice(program.link.blocks, before, None), stub.answer)
        for file, text in beside.interfaces:
            program.read_interface(file, text)
        program.link.add_tags(beside.tags)
        for name in program.link.add_tags(tags or {}):
            program.report("PG820", f"the address of the tag {name} makes no sense")
        for name, number in (numbers or {}).items():
            program.link.aliases[f"DB{number}"] = name.upper()
        program.lay_out()
        program.compile()
        program.check_recursion()
        known = {file for file, _ in beside.interfaces}
        unique = dict.fromkeys([*beside.diagnostics, *(d for d in program.diagnostics if d.span.file not in known)])
        replaced = program.link.unknown.replaced()
        said = (d for d in _without_refused(unique) if d.severity is not Severity.WARNING or d.span not in replaced)
        program.diagnostics = sorted(said, key=lambda d: d.sort_key)
        return program

    def report(
        self,
        code: str,
        message: str,
        span: Span | None = None,
        text: str = "",
        severity: Severity = Severity.ERROR,
    ) -> None:
        """Add a diagnostic."""
        self.diagnostics.append(Diagnostic(code, message, span or Span(""), severity, help=text))

    # --- reading --------------------------------------------------------------------------------------

    def read(self, source: Source, encoding: str | None = None) -> None:
        """Parse one source and keep its blocks; of a statement list the code is skipped."""
        found = self.text_of(source, encoding)
        if found is None:
            return
        file, text = found
        self.keep(parse(text, file, self.link.dialect, bodies=has_bodies(file)))

    def keep(self, result: ParseResult) -> None:
        """Add the blocks of a source that is parsed already."""
        self.diagnostics += result.diagnostics
        link = self.link
        declared, problems = declared_blocks(result, link.dialect, link.numbers, link.unknown)
        self.diagnostics += problems
        kept = replace(result, units=(), tokens=result.tokens.text_alone())
        link.guessed_bounds = link.guessed_bounds or any(
            problem.code == "PG806" and problem.severity is Severity.WARNING for problem in problems
        )
        for unit, written in zip(result.units, declared, strict=True):
            block, elsewhere = with_constants(written, link.literals, link.dialect)
            block = without_refused(block, link.dialect) if link.classic else block
            self.diagnostics += elsewhere
            key = block.name.upper()
            if is_document(result.tokens.file) and link.iec_check is IecCheck.AS_STATED:
                checked = block.attributes.get(IEC_CHECK, OF_BLOCKS[IEC_CHECK.upper()]).upper() == "TRUE"
                link.stated.setdefault(key, checked)
            if key in self.link.blocks:
                known, words = self.link.blocks[key], result.tokens.source[unit.start : unit.end].split()
                if known.words == words and known.result.tokens.file != result.tokens.file:
                    continue  # exports of single blocks repeat the types that these use
                if is_document(result.tokens.file) and not is_document(known.result.tokens.file):
                    continue  # of a block that is there as source, too, the source counts
                self.report("PG805", f"{block.name} is declared twice", block.span, "delete one of the two")
                continue
            entry = ProgramBlock(len(self.link.blocks), unit, block, kept, number=block.number)
            self.link.blocks[key] = entry
            if self.lean:
                entry.release()

    def read_interface(self, file: str, text: str) -> None:
        """Keep the declarations of blocks that no source has; nothing is said about them."""
        result = parse(text, file, bodies=False)
        declared, _ = declared_blocks(result, self.link.dialect, self.link.numbers)
        for unit, written in zip(result.units, declared, strict=True):
            block, _ = with_constants(written, self.link.literals, self.link.dialect)
            entry = ProgramBlock(len(self.link.blocks), unit, block, result, number=block.number)
            self.link.blocks.setdefault(block.name.upper(), entry)

    def text_of(self, source: Source, encoding: str | None = None) -> tuple[str, str] | None:
        """File name and text of a source."""
        if isinstance(source, tuple):
            return source
        if isinstance(source, str) and "\n" in source:
            return "<text>", source
        loaded = load_text(source, encoding=encoding)
        if isinstance(loaded, Diagnostic):
            self.diagnostics.append(loaded)
            return None
        return str(source), loaded[0]

    # --- layout ---------------------------------------------------------------------------------------

    def lay_out(self) -> None:
        """Offsets of everything that has memory, and what the data blocks hold after a download."""
        link = self.link
        link.types = {name: system.block for name, system in self.systems.items()}
        link.types |= {name: entry.block for name, entry in link.blocks.items()}
        for other, name in [*link.aliases.items(), *link.addresses.items()]:
            if name in link.blocks and link.blocks[name].block.kind in {BlockKind.UDT, BlockKind.FB}:
                link.types.setdefault(other, link.blocks[name].block)
        self.diagnostics += add_unknown_types(link)
        circles = list(recursive_types(entry.block for entry in link.blocks.values()))
        self.diagnostics += circles
        self.circles = bool(circles)
        types = TypeTable.of(link.types)
        for entry in link.blocks.values():
            if entry.block.kind in {BlockKind.FB, BlockKind.DB}:
                self.lay_out_block(entry, types)
            elif entry.block.kind is BlockKind.UDT:
                with suppress(DiagnosticError):
                    self.start_values(entry.block, types)
            self.diagnostics += unfit_constants(entry.block)
        for number, name in link.aliases.items():
            aliased = link.blocks.get(name)
            if aliased is not None and number.startswith("DB") and number[2:].isdigit():
                aliased.number = int(number[2:])
        texts = {id(entry.result): entry.result.tokens.source for entry in link.blocks.values()}
        link.eno = any(ENO.search(text) for text in texts.values())
        link.mixed = len({link.optimized(e) for e in link.blocks.values() if e.block.kind is not BlockKind.UDT}) > 1
        for entry in link.blocks.values():
            if entry.block.kind is BlockKind.DB and entry.block.instance_of and link.instance_type(entry):
                link.instance_regions.add(f"d{entry.index}")

    def lay_out_block(self, entry: ProgramBlock, types: TypeTable) -> None:
        """One FB or DB."""
        block = entry.block
        try:
            entry.shape = layout_block(block, types, MAX_PROGRAM_BYTES).shape
            if block.instance_of is not None and block.instance_of.upper() in self.link.opaque:
                entry.shape = replace(entry.shape, type=NamedType(block.instance_of))
            if not isinstance(entry.shape.type, NamedType):
                content = self.start_values(block, types)
                if block.kind is BlockKind.DB:
                    self.images[entry.index] = content
        except DiagnosticError as problem:
            self.diagnostics += (d for d in problem.diagnostics if d.code != "PG807" or not self.circles)

    def start_values(self, block: Block, types: TypeTable) -> bytes:
        """What a block holds after a download; PG824 for every start value that does not fit."""
        unfit: list[StartValueError] = []
        content = bytes(image(block, types, unfit))
        for problem in unfit:
            inside = bool(self.link.opaque) and "there is no member" in str(problem)
            guessed = self.link.guessed_bounds and _ONE_ELEMENT.search(str(problem))
            bits = is_bits_of_real(problem.text, problem.type_name)
            code = "PG827" if inside or guessed or bits else "PG824"
            self.report(code, str(problem), problem.span or block.span)
        return content

    # --- code -----------------------------------------------------------------------------------------

    def compile(self) -> None:
        """Compile every code block; those that are multi-instances twice."""
        moving: set[str] = set()
        for entry in self.link.blocks.values():
            if entry.skipped:
                drawn = next((network.language for network in entry.unit.networks if network.drawn), "")
                what = f"has a network in {drawn}" if drawn else "is a statement list"
                message = f"the code of {entry.name} {what}: the soft CPU does not execute it"
                self.report("PG827", message, entry.block.span, severity=Severity.WARNING)
            elif entry.block.kind in _CODE and (entry.shape is not None or entry.block.kind is not BlockKind.FB):
                found = compile_block(entry, self.link)
                self.compiled.append(found)
                self.diagnostics += found.diagnostics
                moving |= found.moving
        for entry in self.link.blocks.values():
            if entry.name.upper() in moving and entry.shape is not None and not entry.skipped:
                self.compiled.append(compile_block(entry, self.link, dynamic=True))
        if self.lean:
            for found in self.compiled:
                found.source = ""

    def preemptive(self) -> list[Compiled]:
        """Code blocks once more with points for interrupts (``preemption``); compiled when first asked."""
        if not self.interruptible:
            for found in self.compiled:
                entry = self.link.blocks[found.name.upper()]
                dynamic = found.function.endswith("o")
                self.interruptible.append(compile_block(entry, self.link, dynamic=dynamic, plain=found))
        return self.interruptible

    def check_recursion(self) -> None:
        """PG826 for every block that calls itself, directly or through others."""
        for circle, span in circles({found.name.upper(): found.calls.items() for found in self.compiled}):
            self.report("PG826", "blocks call each other in a circle: " + " -> ".join(circle), span)

    def main(self) -> ProgramBlock | None:
        """The cyclic OB: OB1 or "Main", else the only one."""
        obs = [entry for entry in self.link.blocks.values() if entry.block.kind is BlockKind.OB]
        for name in ("OB1", "MAIN"):
            for entry in obs:
                if entry.name.upper() == name:
                    return entry
        cyclic = [entry for entry in obs if entry.name.upper() not in {"OB100", "STARTUP"}]
        return cyclic[0] if len(cyclic) == 1 else None

    def start_up(self) -> ProgramBlock | None:
        """The start-up OB, if there is one."""
        return self.link.find("OB100") or self.link.find("Startup")


def _without_refused(found: Collection[Diagnostic]) -> Iterator[Diagnostic]:
    """Leave out that an array has no bounds or that there is no function, where PG803 says what the target lacks."""
    places = {(d.span.file, d.span.line, d.span.column) for d in found if d.code == "PG803"}
    lines = {place[:2] for place in places}
    for problem in found:
        span = problem.span
        again = problem.code == "PG820" and (span.file, span.line, span.column) in places
        if not again and (OPEN_ARRAY not in problem.message or (span.file, span.line) not in lines):
            yield problem


def unfit_start_values(results: Iterable[ParseResult], dialect: Dialect) -> list[Diagnostic]:
    """PG824 for every start value of these sources that does not fit; what other sources declare is not judged."""
    program = Program(Linkage(dialect))
    for result in results:
        program.keep(result)
    program.lay_out()
    return [d for d in dict.fromkeys(program.diagnostics) if d.code == "PG824"]
