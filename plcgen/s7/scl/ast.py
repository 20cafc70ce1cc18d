"""The syntax tree: nodes with character offsets; ``Tokens.span(node.start, node.end)`` gives the span.

Offsets take no part in comparisons: two trees are equal if they say the same.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field, fields
from typing import TypeAlias

from plcgen.base.frozen import frozen


@frozen
class Node:
    """Anything with a place: ``start`` and ``end`` are character offsets, the end exclusive."""

    start: int = field(compare=False)
    end: int = field(compare=False)


# --- expressions -----------------------------------------------------------------------------------------
@frozen
class Name(Node):
    """``x`` (scope bare), ``#x`` (local) or ``"x"`` (quoted); ``name`` has neither ``#`` nor quotes."""

    name: str
    scope: str


@frozen
class Address(Node):
    """An absolute operand as written: ``%DB3.DBW6``, ``M50.0``, ``DB3.DBX0.0``, ``PIW256``."""

    text: str


@frozen
class Literal(Node):
    """A constant as written; ``kind`` is int, real, string, typed, pointer or bool."""

    text: str
    kind: str


@frozen
class Member(Node):
    """``base.name``; ``name`` has no quotes."""

    base: Expression
    name: str


@frozen
class Slice(Node):
    """``base.%X0``, ``.%B1``, ``.%W0``, ``.%D0``: ``width`` is the letter in upper case."""

    base: Expression
    width: str
    index: int


@frozen
class Index(Node):
    """``base[i, j]``."""

    base: Expression
    indices: tuple[Expression, ...]


@frozen
class Dereference(Node):
    """``base^``."""

    base: Expression


@frozen
class Peripheral(Node):
    """``"tag":P``: the process image is passed by."""

    base: Expression


@frozen
class Unary(Node):
    """``-``, ``+`` or ``NOT`` before an operand."""

    operator: str
    operand: Expression


@frozen
class Binary(Node):
    """Two operands; keywords are in upper case, ``&`` stays ``&``."""

    operator: str
    left: Expression
    right: Expression


@frozen
class Omitted(Node):
    """The value of an argument that has none: ``Q => ,``."""


@frozen
class Argument(Node):
    """One argument of a call or one field of a structure value; ``operator`` is ``:=``, ``=>`` or empty."""

    name: str | None
    operator: str
    value: Expression


@frozen
class Call(Node):
    """``target(arguments)``: function, instance, ``"FB"."DB"``, ``SFB53.DB53`` or ``%DB1.DW(..)``."""

    target: Expression
    arguments: tuple[Argument, ...]


@frozen
class Aggregate(Node):
    """An initial value in brackets ``[``, parentheses ``(`` or without (a list of STEP 7 V5)."""

    bracket: str
    items: tuple[Argument, ...]


@frozen
class Repetition(Node):
    """``count(items)`` in an initial value."""

    count: Expression
    items: tuple[Argument, ...]


Expression: TypeAlias = (
    Name | Address | Literal | Member | Slice | Index | Dereference | Peripheral | Unary | Binary | Call
    | Aggregate | Repetition | Omitted
)  # fmt: skip


# --- statements ------------------------------------------------------------------------------------------
@frozen
class Assign(Node):
    """``target := value``; the operator may be ``+=``; ``also`` holds b, c of ``a := b := c := value``."""

    target: Expression
    operator: str
    value: Expression
    also: tuple[Expression, ...] = ()


@frozen
class CallStatement(Node):
    """A call that stands alone."""

    call: Call


@frozen
class IfBranch(Node):
    """IF or ELSIF with its statements."""

    condition: Expression
    body: Body


@frozen
class If(Node):
    """``otherwise`` is None if there is no ELSE."""

    branches: tuple[IfBranch, ...]
    otherwise: Body | None


@frozen
class CaseRange(Node):
    """A label of CASE; ``high`` is None for a single value."""

    low: Expression
    high: Expression | None


@frozen
class CaseBranch(Node):
    """Labels and statements; ``regions`` are titles of REGIONs opened just before the labels."""

    labels: tuple[CaseRange, ...]
    body: Body
    regions: tuple[str, ...] = ()


@frozen
class Case(Node):
    """``otherwise`` is None if there is no ELSE."""

    selector: Expression
    branches: tuple[CaseBranch, ...]
    otherwise: Body | None


@frozen
class For(Node):
    """``step`` is None if there is no BY."""

    variable: Expression
    first: Expression
    last: Expression
    step: Expression | None
    body: Body


@frozen
class While(Node):
    """WHILE condition DO body."""

    condition: Expression
    body: Body


@frozen
class Repeat(Node):
    """REPEAT body UNTIL condition."""

    body: Body
    condition: Expression


@frozen
class Jump(Node):
    """EXIT, CONTINUE or RETURN."""

    keyword: str


@frozen
class Goto(Node):
    """GOTO label."""

    label: str


@frozen
class Label(Node):
    """``label:`` in front of a statement; a statement of its own here."""

    name: str


@frozen
class Region(Node):
    """REGION title .. END_REGION around statements."""

    title: str
    body: Body


Statement: TypeAlias = (
    Assign | CallStatement | If | Case | For | While | Repeat | Jump | Goto | Label | Region
)  # fmt: skip
Body: TypeAlias = tuple[Statement, ...]


# --- declarations ----------------------------------------------------------------------------------------
@frozen
class Attribute(Node):
    """``name := 'value'`` in braces; ``value`` has no quotes."""

    name: str
    value: str


@frozen
class TypeName(Node):
    """An elementary, system or user type by name; ``attributes`` are the braces before the name."""

    name: str
    quoted: bool
    attributes: tuple[Attribute, ...] = ()


@frozen
class StringSpec(Node):
    """``STRING[length]`` or ``WSTRING[length]``; ``length`` is None if not given."""

    name: str
    length: Expression | None


@frozen
class ArraySpec(Node):
    """``ARRAY[low..high, ...] OF element``; no bounds at all means ``ARRAY[*]`` with so many ``open_dimensions``."""

    bounds: tuple[tuple[Expression, Expression], ...]
    element: TypeSpec
    open_dimensions: int = 1


@frozen
class StructSpec(Node):
    """``STRUCT .. END_STRUCT``."""

    members: tuple[Declaration, ...]


@frozen
class ReferenceSpec(Node):
    """``REF_TO target``."""

    target: TypeSpec


TypeSpec: TypeAlias = TypeName | StringSpec | ArraySpec | StructSpec | ReferenceSpec


@frozen
class DeclaredName(Node):
    """One name of a declaration with the attributes behind it."""

    name: str
    quoted: bool
    attributes: tuple[Attribute, ...]


@frozen
class Declaration(Node):
    """``a, b {..} AT x : type := initial; // comment``; a CONST of STEP 7 V5 has no type."""

    names: tuple[DeclaredName, ...]
    at: str | None
    type: TypeSpec | None
    initial: Expression | None
    comment: str


@frozen
class Section(Node):
    """``VAR_INPUT .. END_VAR``, ``CONST``, ``LABEL``; modifiers such as CONSTANT, RETAIN in upper case."""

    keyword: str
    modifiers: tuple[str, ...]
    declarations: tuple[Declaration, ...]


@frozen
class Network(Node):
    """A network of a SIMATIC SD document: its statements if its language is SCL.

    ``drawn``: it is of another language and not empty. ``inside`` are the offsets of its text.
    """

    language: str
    attributes: tuple[Attribute, ...]
    statements: Body
    drawn: bool
    inside: tuple[int, int] = field(compare=False)


@frozen
class Unit(Node):
    """A block or type. ``body_type`` is a DB's or UDT's structure, or the type an instance DB is made from.

    ``properties`` are TITLE, AUTHOR, NAME, FAMILY, VERSION as text; ``flags`` NON_RETAIN and the like.
    ``statements`` are the code, or the assignments behind BEGIN of a DB; ``code`` are the offsets of its text
    (-1 if the code was skipped or drawn). ``networks`` are those of a SIMATIC SD document.
    """

    keyword: str
    name: str
    quoted: bool
    return_type: TypeSpec | None
    attributes: tuple[Attribute, ...]
    properties: tuple[tuple[str, str], ...]
    flags: tuple[str, ...]
    comment: str
    sections: tuple[Section, ...]
    body_type: TypeSpec | None
    statements: Body
    code: tuple[int, int] = field(default=(0, 0), compare=False)
    networks: tuple[Network, ...] = field(default=(), compare=False)


def walk(root: Node) -> Iterator[Node]:
    """Every node below ``root``, itself included, in source order; no recursion, whatever the depth."""
    stack: list[Node] = [root]
    while stack:
        node = stack.pop()
        yield node
        children: list[Node] = []
        cls = type(node)
        names = _FIELDS.get(cls)
        if names is None:
            names = _FIELDS[cls] = tuple(f.name for f in fields(cls) if f.name not in {"start", "end"})
        for name in names:
            _collect(getattr(node, name), children)
        stack.extend(reversed(children))


def _collect(value: object, into: list[Node]) -> None:
    if isinstance(value, Node):
        into.append(value)
    elif isinstance(value, tuple):
        for item in value:
            _collect(item, into)


_FIELDS: dict[type, tuple[str, ...]] = {}
