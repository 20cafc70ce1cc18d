"""Loops and jumps, under a watchdog that counts passes and calls."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from plcgen.s7.cpu.compiler.access import Access
from plcgen.s7.cpu.compiler.assignments import Assignments
from plcgen.s7.cpu.compiler.context import Context, Listing
from plcgen.s7.cpu.compiler.conversions import coerce, truth
from plcgen.s7.cpu.compiler.expressions import Expressions
from plcgen.s7.cpu.compiler.scope import scalar_name
from plcgen.s7.cpu.compiler.statements import Statements
from plcgen.s7.cpu.compiler.values import Val
from plcgen.s7.cpu.type_rules import INTEGERS
from plcgen.s7.scl import ast


@dataclass(slots=True, eq=False)
class Watchdog:
    """Inside loops the count is a Python local, ``n``; ``depth`` is how many loops are open."""

    out: Listing
    depth: int = 0

    def hand_over(self) -> None:
        """Hand the count of loop passes to what is called."""
        if self.depth:
            self.out.emit("W[0]=n")

    def take_back(self) -> None:
        """Take the count of loop passes back."""
        if self.depth:
            self.out.emit("n=W[0]")


@dataclass(slots=True, eq=False)
class Labels:
    """A block with labels is a loop over the parts between them; ``numbers`` are those of its labels."""

    context: Context
    out: Listing
    access: Access
    watchdog: Watchdog
    statements: Statements
    numbers: dict[str, int] = field(default_factory=dict)

    def goto(self, node: ast.Goto) -> bool:
        """GOTO a label that stands at the top level of the block."""
        self.context.jump()
        number = self.numbers.get(node.label.upper())
        if number is None:
            body = self.context.unit.statements
            inside = any(label.name.upper() == node.label.upper() for label in _labels(body))
            where = "the soft CPU jumps to labels at the top level of a block only" if inside else ""
            code = "PG827" if inside else "PG820"
            self.context.error(code, where or f"there is no label {node.label}", node)
            self.out.emit("pass")
        elif self.watchdog.depth:
            self.out.emit(f"pc={number};g=1;break")
        else:
            self.out.emit(f"pc={number};continue")
        return False

    def segments(self, statements: ast.Body) -> None:
        """Compile a block with labels: a loop over the parts between them."""
        parts: list[list[ast.Statement]] = [[]]
        for statement in _flat(statements):
            if isinstance(statement, ast.Label):
                if statement.name.upper() in self.numbers:
                    message = f"the label {statement.name} appears twice"
                    self.context.error("PG805", message, statement, "rename one of them")
                self.numbers[statement.name.upper()] = len(parts)
                parts.append([])
            else:
                parts[-1].append(statement)
        self.context.move_to(statements[0])
        self.out.emit("pc=g=0")
        self.out.emit("while True:")
        self.out.indent += " "
        self.out.emit("W[0]+=1")
        self.out.emit("if W[0]>W[1]:late()")
        for number, part in enumerate(parts):
            self.access.forget()
            self.out.emit(f"if pc<={number}:")
            self.out.indent += " "
            with self.context.apart():
                self.statements.body(tuple(part))
            self.out.indent = self.out.indent[:-1]
        self.out.emit("break")
        self.out.indent = self.out.indent[:-1]
        self.access.forget()


@dataclass(slots=True, eq=False)
class Loops:
    """Loops under the watchdog; ``loops`` has for each open one what CONTINUE does before the next pass."""

    context: Context
    out: Listing
    access: Access
    expressions: Expressions
    assignments: Assignments
    watchdog: Watchdog
    labels: Labels
    statements: Statements
    loops: list[Callable[[], None]] = field(default_factory=list)

    @contextmanager
    def loop(self, again: Callable[[], None]) -> Iterator[None]:
        """Around the code of one pass: nothing is known before and behind it, every pass counts for the watchdog."""
        self.access.forget()
        if not self.watchdog.depth:
            self.out.emit("n=W[0]")
        self.out.emit("while True:")
        self.out.indent += " "
        self.watchdog.depth += 1
        self.out.emit("n+=1")
        self.out.emit("if n>W[1]:late()")
        self.loops.append(again)
        with self.context.apart():
            yield
        self.loops.pop()
        self.watchdog.depth -= 1
        self.out.indent = self.out.indent[:-1]
        self.access.forget()
        if not self.watchdog.depth:
            self.out.emit("W[0]=n")
        if self.labels.numbers:
            self.out.emit("if g:" + ("break" if self.watchdog.depth else "g=0;continue"))

    def for_statement(self, node: ast.For) -> None:
        """FOR: limit and step are evaluated once, the variable runs past the limit."""
        place = self.assignments.target(node.variable)
        type_ = scalar_name(place.shape) if place is not None else ""
        if place is None or type_ not in INTEGERS:
            if place is not None and not self.context.is_opaque(place.shape):
                message = f"a loop counts with an integer, not {type_ or 'a structure'}"
                self.context.error("PG821", message, node.variable)
            with self.loop(lambda: None):  # what is inside is checked all the same
                self.statements.body(node.body)
            return
        first = self.expressions.value(node.first)
        self.access.store(place, coerce(self.context, first, type_, node.first))
        last = self.limit_code(node.last, type_)
        step = self.limit_code(node.step, type_) if node.step is not None else "1"
        if step == "0":
            self.context.error("PG824", "a step of 0 never ends", node)
        line = self.out.line

        def again() -> None:
            current = Val(f"{self.access.load(place).code}+{step}", type_, raw=True)
            self.access.store(place, current.wrapped)

        self.context.probe(node, "loop")
        with self.loop(again):
            value = self.access.load(place).code
            fixed = step.lstrip("(-").rstrip(")").isdigit()
            ended = f"{value}{'<' if '-' in step else '>'}{last}"
            if not fixed:
                ended = f"({value}>{last} if {step}>=0 else {value}<{last})"
            self.out.emit(f"if {ended}:break")
            self.context.probe(node, "pass")
            self.context.run_tags.append((place.mem, place.off, place.dyn, place.local))
            reached = self.statements.body(node.body)
            self.context.run_tags.pop()
            if reached:
                self.out.line = line
                again()

    def limit_code(self, node: ast.Expression, type_: str) -> str:
        """Limit or step of a FOR, kept in a local unless it is a constant."""
        value = self.expressions.value(node)
        code = coerce(self.context, value, type_, node)
        if value.const is not None:
            return code
        name = self.out.temporary()
        self.out.emit(f"{name}={code}")
        return name

    def while_statement(self, node: ast.While) -> None:
        """WHILE: the condition is evaluated before every pass."""
        with self.loop(lambda: None):
            self.context.point("condition", node.condition)
            condition = truth(self.context, self.expressions.value(node.condition), node.condition)
            self.out.emit(f"if not {condition}:break")
            self.context.probe(node, "pass")
            self.statements.body(node.body)

    def repeat_statement(self, node: ast.Repeat) -> None:
        """REPEAT: the condition is evaluated behind every pass."""

        def again() -> None:
            self.context.point("condition", node.condition)
            condition = truth(self.context, self.expressions.value(node.condition), node.condition)
            self.out.emit(f"if {condition}:break")

        with self.loop(again):
            if self.statements.body(node.body):
                self.context.move_to(node.condition)
                again()

    def jump(self, node: ast.Jump) -> bool:
        """EXIT, CONTINUE, RETURN."""
        self.context.jump()
        if node.keyword == "RETURN":
            if self.watchdog.depth:
                self.out.emit("W[0]=n")
            self.out.emit(self.context.leave)
        elif not self.loops:
            self.context.error("PG820", f"{node.keyword} is outside a loop", node)
            self.out.emit("pass")
        elif node.keyword == "EXIT":
            self.out.emit("break")
        else:
            self.loops[-1]()
            self.out.emit("continue")
        return False


def _labels(statements: ast.Body) -> Iterator[ast.Label]:
    """Labels at any depth."""
    return (node for statement in statements for node in ast.walk(statement) if isinstance(node, ast.Label))


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
