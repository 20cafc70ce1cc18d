"""Lists of statements, IF and CASE, loops and jumps under a watchdog that counts passes and calls."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from plcgen.s7.cpu.compiler.access import Access, Key
from plcgen.s7.cpu.compiler.assignments import Assignments
from plcgen.s7.cpu.compiler.context import Context, Listing
from plcgen.s7.cpu.compiler.conversions import coerce, truth
from plcgen.s7.cpu.compiler.scope import UNKNOWN, Expressions, Val, scalar_name
from plcgen.s7.cpu.type_rules import BITS, INT_CONST, INTEGERS, TYPE_NAME
from plcgen.s7.scl import ast
from plcgen.s7.types.values import RANGES

MAX_INDENT = 90


@dataclass(slots=True, eq=False)
class Statements:
    """Code behind BEGIN; ``parts`` maps a class of nodes to what compiles it and returns False if it jumps away."""

    context: Context
    out: Listing
    access: Access
    parts: dict[type[ast.Statement], Callable[[Any], bool | None]] = field(default_factory=dict)

    def body(self, statements: ast.Body) -> bool:
        """Compile statements one level deeper; False if the end of it is never reached."""
        if len(self.out.indent) > MAX_INDENT and statements:
            self.context.error("PG802", "the statements are nested too deeply", statements[0])
            self.out.emit("pass")
            return True
        reached = True
        before = len(self.out.lines)
        for statement in statements:
            reached = self.statement(statement) and (reached or isinstance(statement, ast.Label))
        if len(self.out.lines) == before:
            self.out.emit("pass")
        return reached

    def statement(self, node: ast.Statement) -> bool:
        """Compile one statement; False if it jumps away."""
        self.context.move_to(node)
        if isinstance(node, ast.Region):
            reached = [self.statement(inner) for inner in node.body]
            return all(reached)
        self.context.point("statement", node)
        self.context.probe(node, "statement")
        begin, indent = len(self.out.lines), self.out.indent
        if isinstance(node, ast.Label):
            self.context.error("PG827", f"the label {node.name} is inside another statement", node)
            goes_on = True
        else:
            goes_on = self.parts[type(node)](node) is not False
        if self.context.unsupported:
            self.out.cut(begin)
            self.out.indent = indent
            self.context.move_to(node)
            self.out.emit(f"unsupported({self.context.unsupported[0]!r})")
            self.context.unsupported.clear()
            self.access.forget()
            return True
        return goes_on


@dataclass(slots=True, eq=False)
class Branches:
    """Branches, each with what it knows of the memory."""

    context: Context
    out: Listing
    access: Access
    expressions: Expressions
    statements: Statements

    def branch(self, body: ast.Body, exits: list[dict[Key, str]], node: ast.Node, kind: str) -> bool:
        """One branch with its own copy of the cache; what is known at its end goes to ``exits``."""
        saved = self.access.cache
        self.access.cache = dict(saved)
        self.out.indent += " "
        with self.context.apart():
            self.context.probe(node, kind)
            reached = self.statements.body(body)
        self.out.indent = self.out.indent[:-1]
        if reached:
            exits.append(self.access.cache)
        self.access.cache = saved
        return reached

    def if_statement(self, node: ast.If) -> bool:
        """IF, ELSIF, ELSE; a condition that needs lines of its own goes one level deeper."""
        exits: list[dict[Key, str]] = []
        indent = self.out.indent
        for position, branch in enumerate(node.branches):
            self.context.move_to(branch)
            start = len(self.out.lines)
            if position:
                self.out.indent += " "
                self.context.point("condition", branch.condition)
            code = truth(self.context, self.expressions.value(branch.condition), branch.condition)
            if position:
                if len(self.out.lines) > start:
                    self.out.insert(start, self.out.indent[:-1] + "else:", self.out.line)
                    self.out.emit(f"if {code}:")
                else:
                    self.out.indent = self.out.indent[:-1]
                    self.out.emit(f"elif {code}:")
            else:
                self.out.emit(f"if {code}:")
            self.branch(branch.body, exits, branch, "branch")
        if node.otherwise is not None or self.context.link.coverage:
            self.out.emit("else:")
            self.branch(node.otherwise or (), exits, node, "else")
        else:
            exits.append(self.access.cache)
        self.out.indent = indent
        self.access.merge(exits)
        return bool(exits)

    def case_statement(self, node: ast.Case) -> bool:
        """CASE as a chain of comparisons with the selector in a local."""
        value = self.expressions.value(node.selector)
        if value.type == TYPE_NAME:
            pass
        elif value.type not in INTEGERS and value.type not in BITS and value.type not in {UNKNOWN, "CHAR", INT_CONST}:
            self.context.error("PG821", f"a selector is an integer, not {value.type or 'a structure'}", node.selector)
        name = self.out.temporary()
        self.out.emit(f"{name}={value.wrapped}")
        exits: list[dict[Key, str]] = []
        seen: dict[int, ast.CaseRange] = {}
        word = "if"
        for branch in node.branches:
            self.context.move_to(branch)
            tests = [self.label_test(name, label, value.type, seen) for label in branch.labels]
            self.out.emit(f"{word} {' or '.join(tests)}:")
            self.branch(branch.body, exits, branch, "branch")
            word = "elif"
        if node.otherwise is not None or self.context.link.coverage:
            self.out.emit("else:" if node.branches else "if True:")
            self.branch(node.otherwise or (), exits, node, "else")
        else:
            exits.append(self.access.cache)
        self.access.merge(exits)
        return bool(exits)

    def label_test(self, name: str, label: ast.CaseRange, type_: str, seen: dict[int, ast.CaseRange]) -> str:
        """Condition of one label of a CASE."""
        ends = []
        for end in (label.low, label.high):
            if end is None:
                continue
            value = self.expressions.value(end)
            if value.type == UNKNOWN:
                return "False"
            if value.type == type_ == TYPE_NAME and label.high is None:
                return f"{name}=={value.code}"
            const = ord(value.const) if isinstance(value.const, str) and len(value.const) == 1 else value.const
            if not isinstance(const, int):
                self.context.error("PG821", f"the label {self.context.text(end)} is not a constant", end)
                return "False"
            low, high = RANGES.get(type_, (const, const))
            if not low <= const <= high:
                self.context.error("PG824", f"the label {const} is outside {type_} ({low}..{high})", end)
            ends.append(const)
        if len(ends) == 1:
            if ends[0] in seen:
                self.context.error("PG824", f"the label {ends[0]} appears twice", label)
            seen[ends[0]] = label
            return f"{name}=={ends[0]}"
        return f"{ends[0]}<={name}<={ends[1]}"


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
            inside = any(
                label.name.upper() == node.label.upper()
                for label in (node for statement in body for node in ast.walk(statement) if isinstance(node, ast.Label))
            )
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
