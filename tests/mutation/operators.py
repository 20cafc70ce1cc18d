"""Mutants of an SCL source: one statement dropped, one operator, constant, index or order changed."""

from __future__ import annotations

import dataclasses
import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass

from plcgen.s7.scl import ast
from plcgen.s7.scl.parser import parse

SWAPS = {
    "<>": ("=",), "=": ("<>",), "<": ("<=", ">="), ">": (">=", "<="), "<=": ("<",), ">=": (">",),
    "+": ("-",), "-": ("+",), "*": ("+",), "AND": ("OR",), "OR": ("AND",), "XOR": ("OR",),
    "TRUE": ("FALSE",), "FALSE": ("TRUE",),
}  # fmt: skip
KINDS = (ast.Assign, ast.CallStatement, ast.If, ast.Case, ast.For, ast.While, ast.Repeat, ast.Jump, ast.Region)
_TOKEN = re.compile(
    r"(?P<skip>//[^\n]*|\(\*.*?\*\)|'[^'\n]*'|\"[^\"\n]*\"|P#\S+ BYTE \d+|=>|:=)"
    r"|(?P<number>\b(?:[A-Z]+#)?(?:16#[0-9A-F]+|\d+(?:ms)?)\b)"
    r"|(?P<op><>|<=|>=|[<>=+\-*]|\b(?:AND|OR|XOR|TRUE|FALSE|NOT)\b)"
    r"|(?P<other>[#\w.]+|.)",
    re.DOTALL,
)


@dataclass(frozen=True, slots=True)
class Mutant:
    """One damaged source: what was done, in which line, and the text."""

    what: str
    line: int
    text: str


def line_of(text: str, at: int) -> int:
    """Line of a position, from 1."""
    return text.count("\n", 0, at) + 1


def mutants(text: str) -> Iterator[Mutant]:
    """Every mutant of a source."""
    yield from dropped(text)
    yield from swapped(text)
    yield from tokens(text)


def bodies(node: object) -> Iterator[tuple[ast.Statement, ...]]:
    """Every list of statements below a node."""
    if isinstance(node, tuple):
        if node and all(isinstance(item, KINDS) for item in node):
            yield node
        for item in node:
            yield from bodies(item)
    elif dataclasses.is_dataclass(node) and not isinstance(node, type):
        for part in dataclasses.fields(node):
            yield from bodies(getattr(node, part.name))


def dropped(text: str) -> Iterator[Mutant]:
    """Delete one statement."""
    for body in all_bodies(text):
        for node in body:
            if isinstance(node, ast.Region):
                continue
            end = text.find(";", node.end - 1) + 1 if text[node.end - 1] != ";" else node.end
            shown = " ".join(text[node.start : node.end].split())[:60]
            yield Mutant(f"dropped: {shown}", line_of(text, node.start), f"{text[: node.start]};{text[end:]}")


def swapped(text: str) -> Iterator[Mutant]:
    """Exchange two neighbouring statements on one line each, where one needs what the other writes."""
    for body in all_bodies(text):
        for one, two in itertools.pairwise(body):
            first, second = text[one.start : one.end], text[two.start : two.end]
            if "\n" in first or "\n" in second or first == second or not depend(first, second):
                continue
            changed = text[: one.start] + second + text[one.end : two.start] + first + text[two.end :]
            yield Mutant(f"exchanged: {first[:40]} / {second[:40]}", line_of(text, one.start), changed)


def depend(first: str, second: str) -> bool:
    """Whether the order of two assignments matters."""
    targets = [statement.partition(":=")[0].strip() for statement in (first, second)]
    return all(targets) and (targets[0] in second or targets[1] in first)


def all_bodies(text: str) -> Iterator[tuple[ast.Statement, ...]]:
    """Lists of statements of every block in a source."""
    for unit in parse(text, "mutant").units:
        yield from bodies(unit.statements)


def tokens(text: str) -> Iterator[Mutant]:
    """Change one operator or constant of the code or of the constants, or a start value of a type."""
    start = re.search(r"^(CONST|VAR CONSTANT)$", text, re.MULTILINE)
    begin = start.end() if start is not None else max(text.find("BEGIN"), text.find("STRUCT"))
    for found in _TOKEN.finditer(text, begin):
        old = found[0]
        if found["op"]:
            changes = SWAPS.get(old, ("",) if old == "NOT" else ())
        elif found["number"]:
            changes = numbers(old)
        else:
            continue
        for new in changes:
            changed = text[: found.start()] + new + text[found.end() :]
            line = line_of(text, found.start())
            shown = text.splitlines()[line - 1].strip()[:60]
            yield Mutant(f"{old} -> {new or 'nothing'}: {shown}", line, changed)


def numbers(old: str) -> tuple[str, ...]:
    """One more; times by a fifth, because a scan is longer than a millisecond."""
    prefix, _, digits = old.rpartition("#")
    if old.endswith("ms") or prefix == "L":
        value = int(digits.removesuffix("ms"))
        bigger = value - 7 if value > 10**9 else value + max(1, value // 5)
        return (f"{prefix}#{bigger}{'ms' if old.endswith('ms') else ''}",)
    if prefix.endswith("16"):
        return (f"{prefix}#{int(digits, 16) ^ 1:0{len(digits)}X}",)
    return (f"{prefix}#{int(digits) + 1}" if prefix else str(int(digits) + 1),)
