"""One block of the program to one Python function (and a second one for multi-instances)."""

from __future__ import annotations

from plcgen.cpu.compile_calls import function_parameters
from plcgen.cpu.compile_model import Compiled, ProgramBlock, Symbol
from plcgen.cpu.compile_statements import StatementCompiler, has_labels
from plcgen.cpu.linkage import Linkage
from plcgen.cpu.memory import CODECS
from plcgen.cpu.semantics_scope import Scope
from plcgen.diagnostics import Diagnostic, Severity, Span
from plcgen.s7.blocks import BlockKind, SectionKind
from plcgen.s7.types import Elementary, Member
from plcgen.scl.dialect import Dialect


def compile_block(owner: ProgramBlock, link: Linkage, *, dynamic: bool = False) -> Compiled:
    """Generate the code of an FB, FC or OB; what is wrong with it is in ``diagnostics``."""
    untyped = link.dialect is Dialect.STEP7_V5
    scope = Scope(owner.block, owner.shape, link.types, untyped=untyped)
    compiler = _BlockCompiler(owner, scope, link, dynamic=dynamic)
    name = f"b{owner.index}{'o' if dynamic else ''}"
    file = owner.result.tokens.file
    try:
        compiler.block(name)
        compiler.tidy()
        source = "\n".join(compiler.lines)
        result = Compiled(owner.name, name, source, compiler.map, file)
        if all(found.severity is not Severity.ERROR for found in compiler.diagnostics):
            result.code = compile(source, f"<{file}>", "exec", dont_inherit=True, optimize=1)
    except (RecursionError, SyntaxError, MemoryError, OverflowError):
        result = Compiled(owner.name, name, "", [], file)
        span = owner.block.span or Span(file)
        compiler.diagnostics.append(Diagnostic("PG827", f"{owner.name} is nested too deeply for the soft CPU", span))
    result.diagnostics = compiler.diagnostics
    for problem in scope.problems:
        result.diagnostics += problem.diagnostics
    result.calls = compiler.calls
    result.moving = compiler.moving
    return result


class _BlockCompiler(StatementCompiler):
    """The frame around the statements: parameters, local data, results."""

    def block(self, name: str) -> None:
        """Generate the whole function."""
        unit = self.owner.unit
        self.line = self.owner.result.tokens.position(unit.start)[0]
        head, leave = self.frame()
        self.leave = leave
        self.lines.append(f"def {name}({head}):")
        self.map.append(self.line)
        self.prologue()
        begin = len(self.lines)
        if has_labels(unit.statements):
            self.segments(unit.statements)
            self.emit(leave)
        elif self.body(unit.statements):
            self.emit(leave)
        if self.uses_eno:
            self.insert(begin, " E[0]=True", self.map[0])

    def frame(self) -> tuple[str, str]:
        """Python parameters, and the statement that leaves the block."""
        if self.owner.block.kind is BlockKind.FB:
            return ("m,o" if self.dynamic else "m"), "return"
        parameters: list[str] = []
        results: list[str] = []
        returned = ""
        for kind, _, how, symbol in self.parameters():
            if kind is SectionKind.RETURN:
                returned = symbol.type_name if how == "value" else f"r_s({symbol.type_name}_m,0)"
                continue
            if how != "value" or kind is not SectionKind.OUTPUT:
                parameters.append(symbol.type_name)
            if how == "value" and kind is not SectionKind.INPUT:
                results.append(symbol.type_name)
        if results:
            return ",".join(parameters), f"return {returned or 'None'},{','.join(results)}"
        return ",".join(parameters), f"return {returned}".rstrip()

    def parameters(self) -> list[tuple[SectionKind, Member, str, Symbol]]:
        """Parameters of an FC with their symbols."""
        rows = []
        for kind, member, how in function_parameters(self.owner):
            name = self.owner.name if kind is SectionKind.RETURN else member.name
            rows.append((kind, member, how, self.scope.symbols[name.upper()]))
        return rows

    def prologue(self) -> None:
        """Initial values of locals, memory for local data, references."""
        if self.owner.block.kind is not BlockKind.FB:
            for kind, member, how, symbol in self.parameters():
                self.parameter_prologue(kind, member, how, symbol)
        for name, symbol in self.scope.copied:
            if symbol.place is not None:
                self.emit(f"{name}_m,{name}_o=deref(r_x(m,{self.address(symbol.place)},6))")
        groups: dict[str, list[str]] = {}
        for name, type_ in self.scope.locals:
            if name.startswith("v"):
                default = CODECS[type_].default if type_ in CODECS else "False"
                groups.setdefault(default, []).append(name)
        for default, names in groups.items():
            self.emit(f"{'='.join(names)}={default}")
        if self.scope.temp_shape is not None:
            self.emit(f"t=local({self.scope.temp_shape.bits // 8})")

    def parameter_prologue(self, kind: SectionKind, member: Member, how: str, symbol: Symbol) -> None:
        """Make one parameter of an FC ready."""
        name = symbol.type_name
        if how == "value":
            if kind in {SectionKind.OUTPUT, SectionKind.RETURN}:
                type_ = member.type.name if isinstance(member.type, Elementary) else ""
                self.emit(f"{name}={CODECS[type_].default if type_ in CODECS else 'False'}")
        elif how == "reference":
            if kind is SectionKind.RETURN and symbol.place is not None:
                self.emit(f"{name}=(local({symbol.place.shape.bits // 8}),0,0)")
            self.emit(f"{name}_m,{name}_o=there({name})")
