"""One block of the program to one Python function (and a second one for multi-instances)."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from plcgen.base.diagnostics import Diagnostic, Span, has_errors
from plcgen.s7.cpu.compiler.access import Access
from plcgen.s7.cpu.compiler.arguments import Arguments, References
from plcgen.s7.cpu.compiler.assignments import Assignments
from plcgen.s7.cpu.compiler.calls import Calls
from plcgen.s7.cpu.compiler.context import Context, Listing
from plcgen.s7.cpu.compiler.functions import Functions
from plcgen.s7.cpu.compiler.library import Library, Moves
from plcgen.s7.cpu.compiler.operators import Operands, Operators
from plcgen.s7.cpu.compiler.places import OpenedBlocks, Places
from plcgen.s7.cpu.compiler.scope import Expressions, Scope, Symbol, Val, function_parameters, is_open, scalar_name
from plcgen.s7.cpu.compiler.statements import Branches, Labels, Loops, Statements, Watchdog, has_labels
from plcgen.s7.cpu.linkage import ENO, Compiled, Decision, Linkage, ProgramBlock
from plcgen.s7.cpu.memory import CODECS
from plcgen.s7.layout.image import default_bytes
from plcgen.s7.layout.layout import Layout, leaves
from plcgen.s7.scl import ast
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.logic import DECIDES, MOST, Joined, Leaf, Logic, joints, logic_of, operands_of
from plcgen.s7.types.blocks import BlockKind, SectionKind
from plcgen.s7.types.data_types import Elementary, Member, StringType

_HARD = re.compile(r"\b(?:power|Z)\(")
"""Code that takes long, or lets another OB run: only where the operands before ask for it."""


@dataclass(slots=True, eq=False)
class Decisions:
    """Binary and unary operators, of which the outermost AND, OR, XOR and NOT are kept in a table.

    ``plain`` compiles an operator; ``inside`` are the nodes of the condition that is being compiled.
    """

    context: Context
    out: Listing
    expressions: Expressions
    plain: dict[type[ast.Expression], Callable[[Any], Val]]
    inside: set[int] = field(default_factory=set)

    def value(self, node: ast.Binary | ast.Unary) -> Val:
        """Compile an operator."""
        operands = [] if id(node) in self.inside else operands_of(node)
        if not 1 < len(operands) <= MOST:
            return self.plain[type(node)](node)
        wanted = {id(operand) for operand in operands}
        shown: dict[int, Val] = {}

        pending = self.context.pending

        def watch(operand: ast.Expression, value: Val) -> None:
            if id(operand) in wanted and id(operand) not in shown:
                shown[id(operand)] = value
                pending.append(value)

        around = self.inside, self.expressions.watch
        self.inside, self.expressions.watch = joints(node), watch
        before = len(pending)
        whole = self.plain[type(node)](node)
        del pending[before:]
        self.inside, self.expressions.watch = around
        found = [shown[id(operand)] for operand in operands]
        boolean = whole.type == "BOOL" and all(each.type == "BOOL" and each.pure for each in found)
        return Val(self.code(logic_of(node), operands, found), "BOOL", pure=whole.pure) if boolean else whole

    def code(self, logic: Logic, operands: list[ast.Expression], found: list[Val]) -> str:
        """Look the outcome up by the negated values."""
        counter, decisions = self.context.counter, self.context.link.decisions
        rows = [(counter(operand, DECIDES[True]), counter(operand, DECIDES[False])) for operand in operands]
        decisions.append(Decision(logic, tuple(rows)))
        hard = [_HARD.search(each.code) is not None for each in found]
        names: list[str] = []
        parts = []
        for number, each in enumerate(found):
            code, asked = f"not {each.code}", _asked(logic, number, names) if hard[number] else []
            if any(hard[number + 1 :]):
                names.append(self.out.temporary())
                code = f"({names[-1]}:={code})"
            if asked:
                code = f"({code} if {' and '.join(asked)} else None)"
            parts.append(code)
        return f"D[{len(decisions) - 1}][{','.join(parts)}]"


def _asked(logic: Logic, number: int, names: list[str]) -> list[str]:
    """Conditions under which an operand is looked at: what stands before it lets it through."""
    found: list[str] = []
    while isinstance(logic, Joined):
        if len(logic.sides) == 2 and number > _last(logic.sides[0]):
            if logic.operator != "XOR":
                before = _shown(logic.sides[0], names)
                found.append(before if logic.operator == "AND" else f"not {before}")
            logic = logic.sides[1]
        else:
            logic = logic.sides[0]
    return found


def _last(logic: Logic) -> int:
    """Number of the last operand."""
    while isinstance(logic, Joined):
        logic = logic.sides[-1]
    return logic.number


def _shown(logic: Logic, names: list[str]) -> str:
    """Code of a condition over the names that hold its negated operands."""
    if isinstance(logic, Leaf):
        return f"(not {names[logic.number]})"
    sides = [_shown(side, names) for side in logic.sides]
    word = {"AND": " and ", "OR": " or ", "XOR": "!="}.get(logic.operator)
    return f"({word.join(sides)})" if word else f"(not {sides[0]})"


_LITTER = {"0": "0xA0 if g else 0xC3", "0.0": "1e30 if g else -1e30", "False": "g"}
"""Garbage in local data at the start of a call by the default values of the types: of two kinds in turn, by ``g``.

Blocks with optimised access find those defaults (help of the TIA Portal, "Parameter assignment to functions", Temp).
"""


def compile_block(
    owner: ProgramBlock, link: Linkage, *, dynamic: bool = False, plain: Compiled | None = None
) -> Compiled:
    """Generate the code of an FB, FC or OB; what is wrong with it is in ``diagnostics``.

    With ``plain``, the same block once more, it has points for interrupts and counts with the same counters.
    """
    untyped = link.dialect is Dialect.STEP7_V5
    scope = Scope(owner.block, owner.shape, link.types, untyped=untyped, classic=link.classic)
    out = Listing()
    first = len(link.probes)
    known = {link.probes[number]: number for number in plain.counters} if plain is not None else {}
    context = Context(owner, scope, link, out, dynamic, plain is not None, known)
    name = context.function(owner.index, moving=dynamic)
    file = owner.result.tokens.file
    access = Access(context, out)
    expressions, statements = Expressions(), Statements(context, out, access)
    source, code = "", None
    try:
        _frame(context, access, expressions, statements).compile(name)
        out.tidy()
        source = "\n".join(out.lines)
        if not has_errors(context.diagnostics):
            code = compile(source, f"<{file}>", "exec", dont_inherit=True, optimize=1)
    except (RecursionError, SyntaxError, MemoryError, OverflowError):
        source, out.map = "", []
        span = owner.block.span or Span(file)
        context.diagnostics.append(Diagnostic("PG802", f"{owner.name} is nested too deeply", span))
    finally:
        # the parts hold each other: their memory is free now, not when the garbage collector comes
        expressions.parts.clear()
        statements.parts.clear()
    diagnostics = [*context.diagnostics, *(found for problem in scope.problems for found in problem.diagnostics)]
    moving, counters = frozenset(context.moving), range(first, len(link.probes))
    return Compiled(owner.name, name, source, out.map, file, code, diagnostics, context.calls, moving, counters)


def _frame(context: Context, access: Access, expressions: Expressions, statements: Statements) -> _Frame:
    """Put the parts together: each is given those it needs."""
    out = context.out
    places = Places(context, out, access, expressions, OpenedBlocks(context, expressions))
    references = References(context, out, access, expressions, places)
    operators = Operators(context, access, expressions, places)
    operands = Operands(context, access, expressions, places, references)
    assignments = Assignments(context, out, access, expressions, places)
    arguments = Arguments(context, access, expressions, places, references, assignments, out)
    functions = Functions(context, expressions)
    library = Library(context, out, access, expressions, references, assignments, functions)
    moves = Moves(context, out, access, expressions, places, references, assignments, functions)
    watchdog = Watchdog(out)
    calls = Calls(
        context, out, access, expressions, places, references, assignments, arguments, functions, library,
        moves, watchdog,
    )  # fmt: skip
    expressions.parts |= {
        ast.Name: operands.name, ast.Literal: operands.literal, ast.Slice: operands.slice,
        ast.Omitted: operands.omitted, ast.Aggregate: operands.listed, ast.Repetition: operands.listed,
        ast.Binary: operators.binary, ast.Unary: operators.unary, ast.Call: references.lending(calls.call_value),
    }  # fmt: skip
    if context.link.coverage:
        decisions = Decisions(context, out, expressions, dict(expressions.parts))
        expressions.parts |= {ast.Binary: decisions.value, ast.Unary: decisions.value}
    paths = (ast.Member, ast.Index, ast.Address, ast.Peripheral, ast.Dereference)
    expressions.parts |= dict.fromkeys(paths, operands.variable)
    labels = Labels(context, out, access, watchdog, statements)
    branches = Branches(context, out, access, expressions, statements)
    loops = Loops(context, out, access, expressions, assignments, watchdog, labels, statements)
    statements.parts |= {
        ast.Assign: assignments.assign, ast.CallStatement: references.lending(calls.call_statement),
        ast.If: branches.if_statement, ast.Case: branches.case_statement, ast.For: loops.for_statement,
        ast.While: loops.while_statement, ast.Repeat: loops.repeat_statement, ast.Jump: loops.jump,
        ast.Goto: labels.goto,
    }  # fmt: skip
    return _Frame(context, out, access, statements, labels)


@dataclass(slots=True, eq=False)
class _Frame:
    """The frame around the statements: parameters, local data, results."""

    context: Context
    out: Listing
    access: Access
    statements: Statements
    labels: Labels

    def compile(self, name: str) -> None:
        """Generate the whole function."""
        unit = self.context.unit
        self.context.move_to(unit)
        head, leave = self.frame()
        self.context.leave = self.eno(unit) + leave
        leave = self.context.leave
        self.out.lines.append(f"def {name}({head}):")
        self.out.map.append(self.out.line)
        self.prologue()
        begin = len(self.out.lines)
        if has_labels(unit.statements):
            self.labels.segments(unit.statements)
            self.out.emit(leave)
        elif self.statements.body(unit.statements):
            self.out.emit(leave)
        if self.context.calling:
            # blocks that call others may call each other without end; what they call counts for them
            watch = f" W[0]+={self.context.calling}", " if W[0]>W[1]:late()"
            for line in reversed(watch):
                self.out.insert(begin, line, self.out.map[0])
        if self.context.uses_eno:
            self.out.insert(begin, " eno=[True];ok=True" if self.context.keeps_ok else " eno=[True]", self.out.map[0])

    def eno(self, unit: ast.Unit) -> str:
        """Code that hands out the block's ENO when it ends: its own, TRUE if the block does not speak of it."""
        if not self.context.link.eno:
            return ""
        text = self.context.owner.result.tokens.source[unit.start : unit.end]
        self.context.uses_eno = ENO.search(text) is not None
        return f"E[0]={self.context.enable('OK')};" if self.context.uses_eno else "E[0]=True;"

    def frame(self) -> tuple[str, str]:
        """Python parameters, and the statement that leaves the block."""
        if self.context.owner.block.kind is BlockKind.FB:
            return ("m,o" if self.context.dynamic else "m"), "return"
        parameters: list[str] = []
        results: list[str] = []
        returned = ""
        for kind, _, how, symbol in self.parameters():
            value = self.value(symbol, how)
            if kind is SectionKind.RETURN:
                returned = value
                continue
            if how != "value" or kind is not SectionKind.OUTPUT or self.context.classic:
                parameters.append(symbol.type_name)
            if how == "value" and kind is not SectionKind.INPUT:
                results.append(value)
        if results:
            return ",".join(parameters), f"return {returned or 'None'},{','.join(results)}"
        return ",".join(parameters), f"return {returned}".rstrip()

    def value(self, symbol: Symbol, how: str) -> str:
        """Code of what a parameter of an FC is in the end."""
        assert symbol.place is not None  # every parameter has one
        if symbol.place.local or (how == "reference" and not isinstance(symbol.place.shape.type, StringType)):
            return symbol.type_name
        type_ = scalar_name(symbol.place.shape)
        read = {"STRING": "r_s({m},{o})", "WSTRING": "r_ws({m},{o})"}.get(type_) or CODECS[type_].read
        return read.format(m=f"{symbol.type_name}_m", o=0)

    def parameters(self) -> list[tuple[SectionKind, Member, str, Symbol]]:
        """Parameters of an FC with their symbols."""
        rows = []
        for kind, member, how in function_parameters(self.context.owner.block):
            name = self.context.owner.name if kind is SectionKind.RETURN else member.name
            rows.append((kind, member, how, self.context.scope.symbols[name.upper()]))
        return rows

    def prologue(self) -> None:
        """Initial values of locals, memory for local data, references."""
        if self.context.owner.block.kind is not BlockKind.FB:
            for kind, member, how, symbol in self.parameters():
                self.parameter_prologue(kind, member, how, symbol)
        for name, symbol in self.context.scope.copied:
            if symbol.place is not None:
                pointer = f"r_x(m,{self.access.address(symbol.place)},6)"
                self.out.emit(f"{name}_m,{name}_o=deref({pointer})")
                declared = self.context.scope.symbols[symbol.name.upper()].place
                if declared is not None and is_open(declared.shape):
                    self.out.emit(f"{name}_r=pointed({pointer})")
        base = "o" if self.context.dynamic else "0"
        for name, key in self.context.scope.variants:
            self.out.emit(f"{name}=kept(m,{base},{key!r})")
        groups: dict[str, list[str]] = {}
        for name, type_ in self.context.scope.locals:
            if name.startswith("v"):
                default = CODECS[type_].default if type_ in CODECS else "False"
                default = "(None,0,0)" if type_ == "VARIANT" else default
                groups.setdefault(default, []).append(name)
        link = self.context.link
        litter = _LITTER if link.litter and not link.optimized(self.context.owner) else {}
        if litter and (groups or self.context.scope.temp_shape is not None):
            self.out.emit("g=G[0]=not G[0]")
        for default, names in groups.items():
            self.out.emit(f"{'='.join(names)}={litter.get(default, default)}")
        if self.context.scope.temp_shape is not None:
            optimized = ",True" if link.mixed and link.optimized(self.context.owner) else ""
            size = self.context.scope.temp_shape.bits // 8
            self.out.emit(f"t=local({size}{optimized})")
            if litter:
                self.out.emit(f"t[:]=(b'\\xa5' if g else b'<')*{size}")
                self.empty_texts(Layout(size, self.context.scope.temp_shape))
            elif link.optimized(self.context.owner) and any(defaults := default_bytes(self.context.scope.temp_shape)):
                self.out.emit(f"t[:]={defaults!r}")
            if self.context.owner.block.kind is BlockKind.OB and self.context.classic:
                self.out.emit(f"ob_info(t,{link.ob_number(self.context.owner)})")

    def empty_texts(self, layout: Layout) -> None:
        """Texts in local data are empty in blocks of the TIA Portal (help, as above)."""
        heads = {"STRING": (1,), "WSTRING": (2, 3)}
        texts = [(entry.offset // 8, entry.type.name) for entry in leaves(layout) if isinstance(entry.type, StringType)]
        lengths = tuple(at + head for at, name in texts for head in heads[name])
        if lengths and self.context.link.dialect.is_tia:
            self.out.emit(f"for k in {lengths}:t[k]=0")

    def parameter_prologue(self, kind: SectionKind, member: Member, how: str, symbol: Symbol) -> None:
        """Make one parameter of an FC ready."""
        name = symbol.type_name
        if how == "value":
            type_ = member.type.name if isinstance(member.type, Elementary) else ""
            if kind is SectionKind.RETURN or (kind is SectionKind.OUTPUT and not self.context.classic):
                self.out.emit(f"{name}={CODECS[type_].default if type_ in CODECS else 'False'}")
            if symbol.place is not None and not symbol.place.local:
                self.out.emit(f"{name}_m=local({CODECS[type_].size})")
                self.out.emit(CODECS[type_].write.format(m=f"{name}_m", o=0, v=name))
        elif how == "reference":
            if kind is SectionKind.RETURN and symbol.place is not None:
                self.out.emit(f"{name}=(local({symbol.place.shape.bits // 8}),0,0)")
            self.out.emit(f"{name}_m,{name}_o=there({name})")
            if symbol.place is not None and is_open(symbol.place.shape):
                self.out.emit(f"{name}_r={name}")
