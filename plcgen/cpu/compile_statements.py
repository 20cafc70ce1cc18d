"""Statements: assignments, branches, loops, jumps."""

from __future__ import annotations

from collections.abc import Callable

from plcgen.cpu.compile_blocks import MoveCompiler
from plcgen.cpu.compile_emit import Key
from plcgen.cpu.compile_model import UNKNOWN, Place, ProgramBlock, Val
from plcgen.cpu.linkage import Linkage
from plcgen.cpu.semantics_scope import Scope, bare_shape, scalar_name
from plcgen.cpu.semantics_types import BITS, INT_CONST, INTEGERS, limits
from plcgen.diagnostics import Severity
from plcgen.s7.blocks import BlockKind, SectionKind
from plcgen.scl import ast

MAX_INDENT = 90
_BOOL = bare_shape("BOOL")
_COMBINED = {"+=": "+", "-=": "-", "*=": "*", "/=": "/", "&=": "AND", "**=": "**"}


class StatementCompiler(MoveCompiler):
    """Code behind BEGIN; ``leave`` is the code that ends the block."""

    leave = "return"

    def __init__(self, owner: ProgramBlock, scope: Scope, link: Linkage, *, dynamic: bool = False) -> None:
        super().__init__(owner, scope, link, dynamic=dynamic)
        self.loops: list[Callable[[], None]] = []
        self.labels: dict[str, int] = {}

    def body(self, statements: ast.Body) -> bool:
        """Compile statements one level deeper; False if the end of it is never reached."""
        if len(self.indent) > MAX_INDENT and statements:
            self.error("PG827", "the statements are nested too deeply for the soft CPU", statements[0])
            self.emit("pass")
            return True
        reached = True
        before = len(self.lines)
        for statement in statements:
            reached = self.statement(statement) and (reached or isinstance(statement, ast.Label))
        if len(self.lines) == before:
            self.emit("pass")
        return reached

    def statement(self, node: ast.Statement) -> bool:
        """Compile one statement; False if it jumps away."""
        self.line = self.owner.result.tokens.position(node.start)[0]
        if isinstance(node, ast.Region):
            reached = [self.statement(inner) for inner in node.body]
            return all(reached)
        if not isinstance(node, ast.Label):
            self.probe(node, "statement")
        if isinstance(node, ast.Assign):
            self.assign(node)
        elif isinstance(node, ast.CallStatement):
            self.call_statement(node.call)
        elif isinstance(node, ast.If):
            return self.if_statement(node)
        elif isinstance(node, ast.Case):
            return self.case_statement(node)
        elif isinstance(node, ast.For):
            self.for_statement(node)
        elif isinstance(node, ast.While):
            self.while_statement(node)
        elif isinstance(node, ast.Repeat):
            self.repeat_statement(node)
        elif isinstance(node, ast.Jump):
            self.jump(node)
            return False
        elif isinstance(node, ast.Goto):
            self.goto(node)
            return False
        else:
            self.error("PG827", f"the label {node.name} stands inside another statement", node)
        return True

    # --- assignments ----------------------------------------------------------------------------------

    def assign(self, node: ast.Assign) -> None:
        """``target := value``, also combined and chained."""
        value_node = node.value
        if node.operator in _COMBINED:
            value_node = ast.Binary(node.start, node.end, _COMBINED[node.operator], node.target, node.value)
        elif node.operator != ":=":
            self.error("PG827", f"the soft CPU does not execute {node.operator}", node)
            return
        if isinstance(node.target, ast.Slice):
            self.assign_slice(node.target, value_node)
            return
        for target in (node.target, *node.also):
            place = self.target(target)
            value = self.expression(value_node)
            if place is not None:
                self.assign_value(place, value, value_node)

    def target(self, node: ast.Expression) -> Place | None:
        """Place left of ``:=``; PG823 if it must not be written. Computed offsets are evaluated first."""
        if isinstance(node, ast.Name) and node.name.upper() in {"ENO", "OK"} and self.symbol(node) is None:
            value = self.name_value(node)
            return Place(_BOOL, local=value.code)
        place = self.place(node)
        if place is None:
            return None
        if place.section is SectionKind.INPUT:
            # STEP 7 V5 lets an FB write its inputs: public libraries reset their commands that way
            tolerated = not self.link.dialect.is_tia and self.scope.block.kind is BlockKind.FB
            severity = Severity.WARNING if tolerated else Severity.ERROR
            self.error("PG823", f"{self.text(node)} is an input", node, "copy it to a variable of its own", severity)
        if "(" in place.dyn:
            name = self.temporary()
            self.emit(f"{name}={place.dyn}")
            place.dyn = name
        if place.dynbit:
            name = self.temporary()
            self.emit(f"{name}={place.dynbit}")
            place.dynbit = name
        return place

    def assign_slice(self, node: ast.Slice, value_node: ast.Expression) -> None:
        """``x.%X3 := value``: the rest of x stays."""
        place = self.target(node.base)
        value = self.expression(value_node)
        if place is None or value.type == UNKNOWN:
            return
        old = self.load(place)
        part = self.slice_type(node, old)
        if part is None:
            return
        bits, type_ = part
        code = self.coerce(value, type_, value_node)
        code = f"(1 if {code} else 0)" if type_ == "BOOL" else code
        mask = (1 << bits) - 1 << node.index * bits
        whole = scalar_name(place.shape)
        result = Val(f"({old.code}&{~mask}|{code}<<{node.index * bits})", whole, raw=whole not in BITS)
        if whole in BITS:
            result = Val(f"({old.code}&{(1 << BITS[whole]) - 1 & ~mask}|{code}<<{node.index * bits})", whole)
        self.store(place, self.ready(result))

    # --- branches -------------------------------------------------------------------------------------

    def branch(self, body: ast.Body, exits: list[dict[Key, str]], node: ast.Node, kind: str) -> bool:
        """One branch with its own copy of the cache; what is known at its end goes to ``exits``."""
        saved = self.cache
        self.cache = dict(saved)
        self.indent += " "
        self.probe(node, kind)
        reached = self.body(body)
        self.indent = self.indent[:-1]
        if reached:
            exits.append(self.cache)
        self.cache = saved
        return reached

    def if_statement(self, node: ast.If) -> bool:
        """IF, ELSIF, ELSE; a condition that needs lines of its own goes one level deeper."""
        exits: list[dict[Key, str]] = []
        indent = self.indent
        for position, branch in enumerate(node.branches):
            self.line = self.owner.result.tokens.position(branch.start)[0]
            start = len(self.lines)
            if position:
                self.indent += " "
            code = self.truth(self.expression(branch.condition), branch.condition)
            if position:
                if len(self.lines) > start:
                    self.insert(start, self.indent[:-1] + "else:", self.line)
                    self.emit(f"if {code}:")
                else:
                    self.indent = self.indent[:-1]
                    self.emit(f"elif {code}:")
            else:
                self.emit(f"if {code}:")
            self.branch(branch.body, exits, branch, "branch")
        if node.otherwise is not None or self.link.coverage:
            self.emit("else:")
            self.branch(node.otherwise or (), exits, node, "else")
        else:
            exits.append(self.cache)
        self.indent = indent
        self.merge(exits)
        return bool(exits)

    def case_statement(self, node: ast.Case) -> bool:
        """CASE as a chain of comparisons with the selector in a local."""
        value = self.expression(node.selector)
        if value.type not in INTEGERS and value.type not in BITS and value.type not in {UNKNOWN, "CHAR", INT_CONST}:
            self.error("PG821", f"a selector is an integer, not {value.type or 'a structure'}", node.selector)
        name = self.temporary()
        self.emit(f"{name}={self.ready(value)}")
        exits: list[dict[Key, str]] = []
        seen: dict[int, ast.CaseRange] = {}
        word = "if"
        for branch in node.branches:
            self.line = self.owner.result.tokens.position(branch.start)[0]
            tests = [self.label_test(name, label, value.type, seen) for label in branch.labels]
            self.emit(f"{word} {' or '.join(tests)}:")
            self.branch(branch.body, exits, branch, "branch")
            word = "elif"
        if node.otherwise is not None or self.link.coverage:
            self.emit("else:" if node.branches else "if True:")
            self.branch(node.otherwise or (), exits, node, "else")
        else:
            exits.append(self.cache)
        self.merge(exits)
        return bool(exits)

    def label_test(self, name: str, label: ast.CaseRange, type_: str, seen: dict[int, ast.CaseRange]) -> str:
        """Condition of one label of a CASE."""
        ends = []
        for end in (label.low, label.high):
            if end is None:
                continue
            value = self.expression(end)
            if value.type == UNKNOWN and type_ == UNKNOWN:
                return "False"
            const = ord(value.const) if isinstance(value.const, str) and len(value.const) == 1 else value.const
            if not isinstance(const, int):
                self.error("PG821", f"the label {self.text(end)} is no constant", end)
                return "False"
            low, high = limits(type_) or (const, const)
            if not low <= const <= high:
                self.error("PG824", f"the label {const} is outside {type_} ({low}..{high})", end)
            ends.append(const)
        if len(ends) == 1:
            if ends[0] in seen:
                self.error("PG824", f"the label {ends[0]} appears twice", label)
            seen[ends[0]] = label
            return f"{name}=={ends[0]}"
        return f"{ends[0]}<={name}<={ends[1]}"

    # --- loops ----------------------------------------------------------------------------------------

    def open_loop(self, again: Callable[[], None]) -> None:
        """Begin a loop: nothing is known, every pass counts for the watchdog."""
        self.forget()
        if not self.in_loop:
            self.emit("n=W[0]")
        self.emit("while True:")
        self.indent += " "
        self.in_loop += 1
        self.emit("n+=1")
        self.emit("if n>W[1]:late()")
        self.loops.append(again)

    def close_loop(self) -> None:
        """End a loop."""
        self.loops.pop()
        self.in_loop -= 1
        self.indent = self.indent[:-1]
        self.forget()
        if not self.in_loop:
            self.emit("W[0]=n")
        if self.labels:
            self.emit("if g:" + ("break" if self.in_loop else "g=0;continue"))

    def for_statement(self, node: ast.For) -> None:
        """FOR: limit and step are evaluated once, the variable runs past the limit."""
        place = self.target(node.variable)
        if place is None:
            return
        type_ = scalar_name(place.shape)
        if type_ not in INTEGERS:
            self.error("PG821", f"a loop counts with an integer, not {type_ or 'a structure'}", node.variable)
            return
        first = self.expression(node.first)
        self.store(place, self.coerce(first, type_, node.first))
        last = self.limit_code(node.last, type_)
        step = self.limit_code(node.step, type_) if node.step is not None else "1"
        if step == "0":
            self.error("PG824", "a step of 0 never ends", node)
        line = self.line

        def again() -> None:
            current = Val(f"{self.load(place).code}+{step}", type_, raw=True)
            self.store(place, self.ready(current))

        self.probe(node, "loop")
        self.open_loop(again)
        value = self.load(place).code
        fixed = step.lstrip("(-").rstrip(")").isdigit()
        ended = f"{value}{'<' if '-' in step else '>'}{last}"
        if not fixed:
            ended = f"({value}>{last} if {step}>=0 else {value}<{last})"
        self.emit(f"if {ended}:break")
        self.probe(node, "pass")
        if self.body(node.body):
            self.line = line
            again()
        self.close_loop()

    def limit_code(self, node: ast.Expression, type_: str) -> str:
        """Limit or step of a FOR, kept in a local unless it is a constant."""
        value = self.expression(node)
        code = self.coerce(value, type_, node)
        if value.const is not None:
            return code
        name = self.temporary()
        self.emit(f"{name}={code}")
        return name

    def while_statement(self, node: ast.While) -> None:
        """WHILE: the condition is evaluated before every pass."""
        self.open_loop(lambda: None)
        condition = self.truth(self.expression(node.condition), node.condition)
        self.emit(f"if not {condition}:break")
        self.probe(node, "pass")
        self.body(node.body)
        self.close_loop()

    def repeat_statement(self, node: ast.Repeat) -> None:
        """REPEAT: the condition is evaluated behind every pass."""

        def again() -> None:
            condition = self.truth(self.expression(node.condition), node.condition)
            self.emit(f"if {condition}:break")

        self.open_loop(again)
        if self.body(node.body):
            self.line = self.owner.result.tokens.position(node.condition.start)[0]
            again()
        self.close_loop()

    # --- jumps ----------------------------------------------------------------------------------------

    def jump(self, node: ast.Jump) -> None:
        """EXIT, CONTINUE, RETURN."""
        if node.keyword == "RETURN":
            if self.in_loop:
                self.emit("W[0]=n")
            self.emit(self.leave)
        elif not self.loops:
            self.error("PG820", f"{node.keyword} stands outside a loop", node)
            self.emit("pass")
        elif node.keyword == "EXIT":
            self.emit("break")
        else:
            self.loops[-1]()
            self.emit("continue")

    def goto(self, node: ast.Goto) -> None:
        """GOTO a label that stands at the top level of the block."""
        number = self.labels.get(node.label.upper())
        if number is None:
            self.error("PG820", f"there is no label {node.label} at the top level of the block", node)
            self.emit("pass")
        elif self.in_loop:
            self.emit(f"pc={number};g=1;break")
        else:
            self.emit(f"pc={number};continue")

    def segments(self, statements: ast.Body) -> None:
        """Compile a block with labels: a loop over the parts between them."""
        parts: list[list[ast.Statement]] = [[]]
        for statement in _flat(statements):
            if isinstance(statement, ast.Label):
                self.labels[statement.name.upper()] = len(parts)
                parts.append([])
            else:
                parts[-1].append(statement)
        self.line = self.owner.result.tokens.position(statements[0].start)[0]
        self.emit("pc=g=0;k=W[0]")
        self.emit("while True:")
        self.indent += " "
        self.emit("k+=1")
        self.emit("if k>W[1]:late()")
        self.emit("W[0]=k")
        for number, part in enumerate(parts):
            self.forget()
            self.emit(f"if pc<={number}:")
            self.indent += " "
            self.body(tuple(part))
            self.indent = self.indent[:-1]
        self.emit("break")
        self.indent = self.indent[:-1]
        self.forget()


def _flat(statements: ast.Body) -> list[ast.Statement]:
    """Statements with regions opened, so that labels inside regions count as top level."""
    found: list[ast.Statement] = []
    for statement in statements:
        if isinstance(statement, ast.Region):
            found += _flat(statement.body)
        else:
            found.append(statement)
    return found


def has_labels(statements: ast.Body) -> bool:
    """Whether a block has labels at its top level."""
    return any(isinstance(statement, ast.Label) for statement in _flat(statements))
