"""The estimate of a whole program: every block with its bytes of code and data."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.s7.layout.layout import layout_block
from plcgen.s7.layout.shapes import TypeTable
from plcgen.s7.memory import costs
from plcgen.s7.memory.names import BlockNames, CodeOperand
from plcgen.s7.memory.values import CallCost, ValueSize
from plcgen.s7.read.blocks import SourceBlock, Sources, read_sources
from plcgen.s7.scl import ast
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.types.blocks import Block, BlockKind

_DOUBLE = 32
_LONG = 64


class CodeSize:
    """Adds up the statements of one block by the rules of README.md."""

    def __init__(self, names: BlockNames) -> None:
        self.names = names
        self.values = ValueSize(names)
        self.calls = CallCost(names, self.values.load_size, self.values.access)

    def block(self, body: ast.Body) -> int:
        """The whole code: what the compiler puts around it, and its statements."""
        return costs.OK_FLAG + self.body(body)

    def body(self, body: ast.Body) -> int:
        """Statements one after the other."""
        return sum(self.statement(node) for node in body)

    def statement(self, node: ast.Statement) -> int:
        """One statement with everything inside it."""
        self.values.opened = ""
        if isinstance(node, ast.Assign):
            return self._assign(node)
        if isinstance(node, ast.CallStatement):
            return self._call(node.call)
        if isinstance(node, ast.If):
            size = 0
            for number, branch in enumerate(node.branches, 1):
                size += self._asked(branch.condition) + costs.JUMP + self.body(branch.body)
                if number < len(node.branches) or node.otherwise:
                    size += costs.JUMP
            return size + self.body(node.otherwise or ())
        if isinstance(node, ast.Case):
            return self._case(node)
        if isinstance(node, ast.For):
            variable = self.names.place(node.variable)
            width = self.names.width(variable.type) if variable is not None else None
            wide = width == _DOUBLE
            size = self.values.load_size(node.first, width) + costs.ACCESS
            last = self.values.load_size(node.last, width)
            if self.names.constant(node.last) is None:
                last += 2 * costs.ACCESS
            # round: load, compare, jump; load, add the step, store, jump
            return size + last + costs.FOR_ROUND + (2 if wide else 0) + self.body(node.body)
        if isinstance(node, ast.While):
            return self.values.condition(node.condition) + 2 * costs.JUMP + self.body(node.body)
        if isinstance(node, ast.Repeat):
            return self.body(node.body) + self._asked(node.condition) + costs.JUMP
        if isinstance(node, ast.Region):
            return self.body(node.body)
        return 0 if isinstance(node, ast.Label) else costs.JUMP

    def _asked(self, node: ast.Expression) -> int:
        self.values.opened = ""
        return self.values.condition(node)

    def _assign(self, node: ast.Assign) -> int:
        targets = [node.target, *node.also]
        places = [self.names.place(target) for target in targets]
        type_ = places[0].type if places[0] is not None else None
        width = self.names.width(type_)
        if width is None:
            return costs.COPY * len(targets)
        if width == _LONG:
            return sum(
                2 * (self.values.load_size(node.value) + self._stored(p, t))
                for p, t in zip(places, targets, strict=True)
            )
        value = self.values.load_size(node.value, width)
        if node.operator not in {":=", ""}:
            value += self.values.load_size(node.target) + costs.OPERATION
        return value + sum(self._stored(p, t) for p, t in zip(places, targets, strict=True))

    def _stored(self, place: CodeOperand | None, target: ast.Expression) -> int:
        if isinstance(target, ast.Index) and (numbered := self.values.by_number(target)) is not None:
            return numbered.size + costs.KEEP_WHILE_INDEXING
        if place is None:
            return costs.ACCESS
        return self.values.access(place) + (costs.KEEP_WHILE_INDEXING if place.indices else 0)

    def _call(self, node: ast.Call) -> int:
        size = self.calls.block(node)
        return self.calls.function(node)[0] if size is None else size

    def _case(self, node: ast.Case) -> int:
        size = self.values.load_size(node.selector) + costs.SELECTOR
        for branch in node.branches:
            size += sum(costs.LABEL if label.high is None else costs.RANGE for label in branch.labels)
            size += costs.BRANCH + self.body(branch.body)
        return size + self.body(node.otherwise or ())


_CODE = frozenset({BlockKind.FB, BlockKind.FC, BlockKind.OB})
_ONLY_COMMENT = ("//", "(*")


@dataclass(frozen=True, slots=True)
class BlockSize:
    """One block: bytes of code and of data in the work memory of an S7-300/400, both with the block's header.

    On an S7-1200/1500 ``code`` is 0, and ``data`` the bytes of a data block (standard access) alone. ``lines`` are the
    lines of its text, ``code_lines`` those of its statements, without empty lines and comments.
    """

    kind: str
    name: str
    number: int | None
    code: int
    data: int
    lines: int = 0
    code_lines: int = 0

    @property
    def total(self) -> int:
        """Bytes of the block."""
        return self.code + self.data


@dataclass(frozen=True, slots=True)
class Estimate:
    """Sizes of all blocks of a program, in the order of its files.

    ``classic`` says that they are for an S7-300/400: the code of other families is not estimated. ``diagnostics`` tell
    what could not be read or laid out: it is not counted.
    """

    blocks: tuple[BlockSize, ...]
    classic: bool
    diagnostics: tuple[Diagnostic, ...] = ()

    @property
    def code(self) -> int | None:
        """Bytes of code; None for an S7-1200/1500."""
        return sum(block.code for block in self.blocks) if self.classic else None

    @property
    def data(self) -> int:
        """Bytes of data blocks."""
        return sum(block.data for block in self.blocks)

    @property
    def total(self) -> int | None:
        """Bytes of everything; None for an S7-1200/1500."""
        return None if self.code is None else self.code + self.data

    @property
    def lines(self) -> int:
        """Lines of the text of all FBs, FCs and OBs."""
        return sum(block.lines for block in self.blocks)

    def count(self, kind: str = "") -> int:
        """Number of blocks of a kind; without one, of all that a CPU holds: types are none."""
        return sum(block.kind == kind if kind else block.kind != BlockKind.UDT for block in self.blocks)

    def summary(self) -> dict[str, int | None]:
        """The figures for programs."""
        kinds = {f"{kind.lower()}s": self.count(kind) for kind in ("FB", "FC", "OB", "DB")}
        return {"lines": self.lines, **kinds, "code": self.code, "data": self.data, "total": self.total}


def estimate(what: Path | str | Sources, dialect: Dialect) -> Estimate:
    """Estimate the work memory of a program for the S7-300/400; for the S7-1200/1500 add up its data blocks.

    ``what`` is a folder or file, or sources that are read already.
    """
    classic = dialect.classic
    sources = what if isinstance(what, Sources) else read_sources([Path(what)], classic=classic)
    blocks = {source.block.name.upper(): source.block for source in sources.blocks}
    found: list[BlockSize] = []
    problems = list(sources.diagnostics)
    for source in sources.blocks:
        if source.block.kind in _CODE:
            names = BlockNames(source, blocks, sources.types, classic=classic) if classic else None
            found.append(_code_size(source, names, problems))
        else:
            found.append(_data_size(source.block, sources.types, problems, costs.HEADER if classic else 0))
    return Estimate(tuple(found), classic, tuple(problems))


def _code_size(source: SourceBlock, names: BlockNames | None, problems: list[Diagnostic]) -> BlockSize:
    """Without ``names`` only the lines are counted."""
    block = source.block
    body = source.unit.statements if source.unit is not None else ()
    lines, code_lines = _line_counts(source)
    size = 0
    try:
        if names is not None:
            size = costs.HEADER + CodeSize(names).block(body)
    except RecursionError:
        problems.append(Diagnostic("PG802", f"{block.name} is nested too deeply", block.span or Span(source.file)))
    return BlockSize(block.kind.value, block.name, block.number, size, 0, lines, code_lines)


def _data_size(block: Block, types: TypeTable, problems: list[Diagnostic], header: int) -> BlockSize:
    size = 0
    if block.kind is BlockKind.DB:
        try:
            size = header + layout_block(block, types).size
        except DiagnosticError as problem:
            problems.extend(problem.diagnostics)
    return BlockSize(block.kind.value, block.name, block.number, 0, size)


def _line_counts(source: SourceBlock) -> tuple[int, int]:
    """Lines of a block's text, and lines of it on which a statement stands."""
    if source.unit is None or source.parsed is None:
        return 0, 0
    text = source.parsed.tokens.source
    start, end = source.unit.code
    code = text[start:end] if start >= 0 else ""
    lines = text.count("\n", source.unit.start, source.unit.end) + 1
    return lines, sum(1 for _ in _statement_lines(code.splitlines()))


def _statement_lines(lines: Iterable[str]) -> Iterable[str]:
    stripped = (line.strip() for line in lines)
    return (line for line in stripped if line and not line.startswith(_ONLY_COMMENT))
