"""Bytes of machine code of the statements of a block."""

from __future__ import annotations

from plcgen.s7.memory import costs
from plcgen.s7.memory.calls import CallCost
from plcgen.s7.memory.names import BlockNames, CodeOperand
from plcgen.s7.memory.values import ValueSize
from plcgen.s7.scl import ast

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
            return self._if(node)
        if isinstance(node, ast.Case):
            return self._case(node)
        if isinstance(node, ast.For):
            return self._for(node)
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

    def _if(self, node: ast.If) -> int:
        size = 0
        for number, branch in enumerate(node.branches, 1):
            size += self._asked(branch.condition) + costs.JUMP + self.body(branch.body)
            if number < len(node.branches) or node.otherwise:
                size += costs.JUMP
        return size + self.body(node.otherwise or ())

    def _case(self, node: ast.Case) -> int:
        size = self.values.load_size(node.selector) + costs.SELECTOR
        for branch in node.branches:
            size += sum(costs.LABEL if label.high is None else costs.RANGE for label in branch.labels)
            size += costs.BRANCH + self.body(branch.body)
        return size + self.body(node.otherwise or ())

    def _for(self, node: ast.For) -> int:
        variable = self.names.place(node.variable)
        width = self.names.width(variable.type) if variable is not None else None
        wide = width == _DOUBLE
        size = self.values.load_size(node.first, width) + costs.ACCESS
        last = self.values.load_size(node.last, width)
        if self.names.constant(node.last) is None:
            last += 2 * costs.ACCESS
        # round: load, compare, jump; load, add the step, store, jump
        return size + last + costs.FOR_ROUND + (2 if wide else 0) + self.body(node.body)
