"""The block that is compiled: its generated lines, and what is found out about it on the way."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field

from plcgen.base.diagnostics import Diagnostic, Severity, Span
from plcgen.s7.cpu.compiler.scope import MemoryPlace, Scope, Val
from plcgen.s7.cpu.linkage import Linkage, Probe, ProgramBlock
from plcgen.s7.cpu.type_rules import TypeRules
from plcgen.s7.layout.shapes import Shape
from plcgen.s7.scl import ast

MAX_DIAGNOSTICS = 100
_LOCAL = re.compile(r"\bc[0-9]+\b")
_TEMPORARY = re.compile(r"q[0-9]+")


@dataclass(slots=True, eq=False)
class Listing:
    """Lines of Python; ``map`` has the line of SCL of each, ``line`` is that of the next one.

    ``folds`` are the lines that put a value into a cached local, with its name: often nobody reads it again.
    ``checks`` counts the expressions with an index that may be outside its array or a divisor that may be 0.
    """

    lines: list[str] = field(default_factory=list)
    map: list[int] = field(default_factory=list)
    indent: str = " "
    line: int = 0
    folds: list[tuple[int, str]] = field(default_factory=list)
    checks: int = 0
    temporaries: int = 0

    def emit(self, code: str) -> None:
        """Add one line."""
        self.lines.append(self.indent + code)
        self.map.append(self.line)

    def cut(self, length: int) -> None:
        """Take back all lines behind the first ``length``."""
        del self.lines[length:], self.map[length:]
        self.folds = [(place, name) for place, name in self.folds if place < length]

    def insert(self, at: int, code: str, line: int) -> None:
        """Put a line before one that is there already."""
        self.lines.insert(at, code)
        self.map.insert(at, line)
        self.folds = [(place + (place >= at), name) for place, name in self.folds]

    def temporary(self) -> str:
        """Return a new Python local."""
        self.temporaries += 1
        return f"q{self.temporaries}"

    def keep(self, name: str, code: str) -> None:
        """Add a line that puts a value into a cached local."""
        self.folds.append((len(self.lines), name))
        self.emit(f"{name}={code}")

    def tidy(self) -> None:
        """Take out locals that nobody reads again."""
        source = "\n".join(self.lines)
        uses = Counter(_LOCAL.findall(source))
        lines = self.lines
        dropped: set[int] = set()
        for at, name in self.folds:
            if uses[name] == 2 and name in lines[at + 1]:
                code = lines[at].partition("=")[2]
                before, _, behind = lines[at + 1].partition(name)
                if not behind[:1].isdigit():
                    lines[at + 1] = before + code + behind
                    dropped.add(at)
            elif uses[name] == 1:
                dropped.add(at)
        self.lines = [line for at, line in enumerate(lines) if at not in dropped]
        self.map = [line for at, line in enumerate(self.map) if at not in dropped]


@dataclass(slots=True, eq=False)
class Context:
    """One block on its way to Python: ``dynamic`` adds a base offset ``o`` to every access to the instance.

    ``preemptive`` adds points at which another OB may run (``Z``), and nothing is known from one access to the next.
    ``known`` are the counters of the same block without points. ``counting`` is the counter of what runs as often as
    the next statement, ``jumps`` how many statements leave what is around them.
    ``names`` of the diagnostics are about unknown names; ``run_tags`` are the places of the variables that the loops
    around count with.
    ``calls`` are the blocks it calls by upper-case name, ``moving`` those that are its multi-instances, ``calling`` how
    many calls it has; ``leave`` is the code that ends the block, ``uses_eno`` says that it needs an ENO of its own.
    """

    owner: ProgramBlock
    scope: Scope
    link: Linkage
    out: Listing
    dynamic: bool
    preemptive: bool = False
    known: Mapping[Probe, int] = field(default_factory=dict)
    unit: ast.Unit = field(init=False)
    classic: bool = field(init=False)
    direct: bool = False
    """Whether nothing shared was read or written since the last point."""
    rules: TypeRules = field(init=False)
    diagnostics: list[Diagnostic] = field(default_factory=list)
    calls: dict[str, Span] = field(default_factory=dict)
    moving: set[str] = field(default_factory=set)
    calling: int = 0
    leave: str = "return"
    uses_eno: bool = False
    names: int = 0
    unsupported: list[str] = field(default_factory=list)
    """What the statement that is being compiled has and nobody executes."""
    run_tags: list[tuple[str, int, str, str]] = field(default_factory=list)
    counting: int | None = None
    jumps: int = 0
    pending: list[Val] = field(default_factory=list)
    """Operands and arguments that stand before the one that is being compiled."""
    borrowed: list[tuple[str, MemoryPlace]] = field(default_factory=list)
    """Memory lent for the variables that are no memory, in the call that is being compiled."""

    def __post_init__(self) -> None:
        self.unit = self.owner.tree
        self.classic = self.link.classic
        self.rules = self.link.rules(self.owner.name)

    def move_to(self, node: ast.Node) -> None:
        """What is generated from here on comes from the line of a node."""
        self.out.line = self.owner.result.tokens.position(node.start)[0]

    def span(self, node: ast.Node) -> Span:
        """Where a node stands."""
        return self.owner.result.span(node)

    def error(
        self, code: str, message: str, node: ast.Node, text: str = "", severity: Severity = Severity.ERROR
    ) -> None:
        """Report a problem at a node; what is not executed (PG827) fails when it is reached, so it is a warning."""
        if code == "PG827":
            severity = Severity.WARNING
            self.unsupported.append(message)
        if len(self.diagnostics) - self.names < MAX_DIAGNOSTICS:
            self.diagnostics.append(Diagnostic(code, message, self.span(node), severity, help=text))

    def is_opaque(self, shape: Shape) -> bool:
        """Whether nobody knows what a variable of this shape holds: a statement with it is not executed."""
        opaque = self.link.is_opaque(shape)
        if opaque:
            self.unsupported.append(f"the members of {getattr(shape.type, 'name', 'a type')} are not known to plcgen")
        return opaque

    def unknown(self, code: str, message: str, names: tuple[str, ...], node: ast.Node, text: str = "") -> None:
        """Report a name that nobody knows, with its keys, at the first of its uses in the program."""
        if not self.link.unknown.add(*names):
            return
        if self.names < MAX_DIAGNOSTICS:  # many unknown tags hide no mistake of another kind
            self.names += 1
            self.diagnostics.append(Diagnostic(code, message, self.span(node), help=text))

    def text(self, node: ast.Node) -> str:
        """Source text of a node on one line."""
        return " ".join(self.owner.result.tokens.source[node.start : node.end].split())

    def probe(self, node: ast.Node, kind: str) -> None:
        """Count this place, if coverage is wanted: a statement with what runs as often as it does."""
        if self.link.coverage:
            shared = self.counting if kind in {"statement", "loop"} else None
            number = self.counter(node, kind, shared)
            if shared is None:
                self.out.emit(f"H[{number}]+=1")
                self.counting = number

    def counter(self, node: ast.Node, kind: str, shared: int | None = None) -> int:
        """Number of this place, which is that of its counter unless it has a ``shared`` one."""
        span = self.span(node)
        probe = Probe(span.file, span.line, span.column, kind, self.owner.name)
        number = self.known.get(probe)
        if number is None:
            number = len(self.link.probes)
            self.link.probes.append(probe)
            self.link.counted_by.append(number if shared is None else shared)
        return number

    @contextmanager
    def apart(self) -> Iterator[None]:
        """Around what has counters of its own; what is before and behind it runs equally often if nothing jumps."""
        counting, jumps = self.counting, self.jumps
        self.counting = None
        yield
        self.counting = counting if self.jumps == jumps else None

    def jump(self) -> None:
        """The statements behind run less often than those before."""
        self.jumps += 1
        self.counting = None

    @property
    def keeps_ok(self) -> bool:
        """Whether ENO is that of the block called last and OK that of the block itself, as in STEP 7 V5."""
        return self.uses_eno and not self.link.dialect.is_tia

    def enable(self, word: str) -> str:
        """Generated place of ENO or OK."""
        return "ok" if self.keeps_ok and word.upper() == "OK" else "eno[0]"

    def settle(self) -> None:
        """Evaluate what stands before a call in an expression: leftmost operands come first (IEC 61131-3, 3.3.1)."""
        for value in self.pending:
            if value.code and value.const is None and not _TEMPORARY.fullmatch(value.code):
                name = self.out.temporary()
                self.out.emit(f"{name}={value.code}")
                value.code, value.parts = name, None

    def called(self) -> None:
        """Behind a call: its ENO, in STEP 7 V5 (S7-SCL V5.3 manual, ENO)."""
        if self.keeps_ok:
            self.out.emit("eno[0]=E[0]")

    def function(self, index: int, *, moving: bool = False) -> str:
        """Python name of a block: ``b``, in preemptive programs ``p``; with ``o`` behind it for multi-instances."""
        return f"{'p' if self.preemptive else 'b'}{index}{'o' if moving else ''}"

    def point(self, kind: str, node: ast.Node | None = None) -> None:
        """Another OB may run here, in a preemptive program."""
        if self.preemptive:
            self.out.emit(self.point_code(kind, node))
            self.direct = True

    def point_code(self, kind: str, node: ast.Node | None = None) -> str:
        """Generated call of a point; its value is None."""
        span = self.span(node) if node is not None else None
        line, column = (span.line, span.column) if span is not None else (self.out.line, 0)
        self.link.points.append(Probe(self.owner.result.tokens.file, line, column, kind, self.owner.name))
        return f"Z({len(self.link.points) - 1})"
