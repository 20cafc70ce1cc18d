"""The block that is compiled, and what is found out about it on the way."""

from __future__ import annotations

from dataclasses import dataclass, field

from plcgen.cpu.compiler.listing import Listing
from plcgen.cpu.compiler.scope import Scope
from plcgen.cpu.linkage import Linkage, Probe, ProgramBlock
from plcgen.diagnostics import Diagnostic, Severity, Span
from plcgen.scl import ast

MAX_DIAGNOSTICS = 100


@dataclass(slots=True, eq=False)
class Context:
    """One block on its way to Python: ``dynamic`` adds a base offset ``o`` to every access to the instance.

    ``calls`` are the blocks it calls by upper-case name, ``moving`` says that it has multi-instances; ``leave`` is the
    code that ends the block, ``uses_eno`` says that it needs one of its own.
    """

    owner: ProgramBlock
    scope: Scope
    link: Linkage
    out: Listing
    dynamic: bool
    classic: bool = field(init=False)
    diagnostics: list[Diagnostic] = field(default_factory=list)
    calls: dict[str, Span] = field(default_factory=dict)
    moving: bool = False
    leave: str = "return"
    uses_eno: bool = False

    def __post_init__(self) -> None:
        self.classic = self.link.classic

    def move_to(self, node: ast.Node) -> None:
        """What is generated from here on comes from the line of a node."""
        self.out.line = self.owner.result.tokens.position(node.start)[0]

    def span(self, node: ast.Node) -> Span:
        """Where a node stands."""
        return self.owner.result.span(node)

    def error(
        self, code: str, message: str, node: ast.Node, text: str = "", severity: Severity = Severity.ERROR
    ) -> None:
        """Report a problem at a node."""
        if len(self.diagnostics) < MAX_DIAGNOSTICS:
            self.diagnostics.append(Diagnostic(code, message, self.span(node), severity, help=text))

    def text(self, node: ast.Node) -> str:
        """Source text of a node on one line."""
        return " ".join(self.owner.result.tokens.source[node.start : node.end].split())

    def probe(self, node: ast.Node, kind: str) -> None:
        """Count this place, if coverage is wanted."""
        if self.link.coverage:
            span = self.span(node)
            self.link.probes.append(Probe(span.file, span.line, span.column, kind))
            self.out.emit(f"H[{len(self.link.probes) - 1}]+=1")
