"""Prints a tree as an s-expression, so that a test can say what it expects in one line."""

from __future__ import annotations

from plcgen.s7.scl import ast


def expression(node: ast.Expression) -> str:
    """One expression; names keep their ``#`` or quotes."""
    match node:
        case ast.Name():
            return {"local": f"#{node.name}", "quoted": f'"{node.name}"', "bare": node.name}[node.scope]
        case ast.Address() | ast.Literal():
            return node.text
        case ast.Member():
            return f"(. {expression(node.base)} {node.name})"
        case ast.Slice():
            return f"(slice {expression(node.base)} {node.width}{node.index})"
        case ast.Index():
            return _list("[]", expression(node.base), *map(expression, node.indices))
        case ast.Dereference():
            return f"(^ {expression(node.base)})"
        case ast.Peripheral():
            return f"(:P {expression(node.base)})"
        case ast.Unary():
            return f"({node.operator} {expression(node.operand)})"
        case ast.Binary():
            return f"({node.operator} {expression(node.left)} {expression(node.right)})"
        case ast.Call():
            return _list("call", expression(node.target), *map(argument, node.arguments))
        case ast.Aggregate():
            return _list(f"list{node.bracket}", *map(argument, node.items))
        case ast.Omitted():
            return "-"
        case ast.Repetition():
            return _list("times", expression(node.count), *map(argument, node.items))


def argument(node: ast.Argument) -> str:
    """A named argument is a list of three."""
    value = expression(node.value)
    return value if node.name is None else f"({node.name} {node.operator} {value})"


def statement(node: ast.Statement) -> str:
    """One statement with everything inside."""
    match node:
        case ast.Assign():
            return _list(node.operator, *map(expression, (node.target, *node.also, node.value)))
        case ast.CallStatement():
            return expression(node.call)
        case ast.If():
            parts = [_list(expression(b.condition), *map(statement, b.body)) for b in node.branches]
            return _list("if", *parts, *_otherwise(node.otherwise))
        case ast.Case():
            parts = [_branch(b) for b in node.branches]
            return _list("case", expression(node.selector), *parts, *_otherwise(node.otherwise))
        case ast.For():
            heads = [node.variable, node.first, node.last, *([node.step] if node.step else [])]
            return _list("for", _list(*map(expression, heads)), *map(statement, node.body))
        case ast.While():
            return _list("while", expression(node.condition), *map(statement, node.body))
        case ast.Repeat():
            return _list("repeat", *map(statement, node.body), "until", expression(node.condition))
        case ast.Jump():
            return node.keyword.lower()
        case ast.Goto():
            return f"(goto {node.label})"
        case ast.Label():
            return f"(label {node.name})"
        case ast.Region():
            return _list("region", f"<{node.title}>", *map(statement, node.body))


def body(nodes: ast.Body) -> str:
    """Statements, separated by blanks."""
    return " ".join(map(statement, nodes))


def _branch(node: ast.CaseBranch) -> str:
    labels = [
        expression(label.low) if label.high is None else f"{expression(label.low)}..{expression(label.high)}"
        for label in node.labels
    ]
    regions = [f"<{title}>" for title in node.regions]
    return _list(*regions, ",".join(labels) + ":", *map(statement, node.body))


def _otherwise(nodes: ast.Body | None) -> list[str]:
    return [] if nodes is None else [_list("else", *map(statement, nodes))]


def _list(*parts: str) -> str:
    return "(" + " ".join(parts) + ")"
