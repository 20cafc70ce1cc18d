"""What the service answers: frozen values, places as spans with lines and columns that count from 1, in characters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeVar, get_args

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.base.display.page import Page

OfferKind = Literal[
    "key", "value", "name", "device", "parameter", "variable", "file", "instruction", "type", "member", "snippet"
]
SymbolKind = Literal["section", "unit", "drive", "job", "recipe", "station", "variable", "block", "type", "member"]


@dataclass(frozen=True, slots=True)
class Edit:
    """Text in the place of what stands at a span; an empty span inserts."""

    span: Span
    text: str


@dataclass(frozen=True, slots=True)
class Fix:
    """A way to get rid of a problem: what it does in a few words, and the edits."""

    title: str
    edits: tuple[Edit, ...]


@dataclass(frozen=True, slots=True)
class Finding:
    """A problem with the reason that its code has, the remedy and quick fixes."""

    diagnostic: Diagnostic
    reason: str
    remedy: str
    fixes: tuple[Fix, ...] = ()


@dataclass(frozen=True, slots=True)
class Offer:
    """Something that may stand at a place: ``detail`` is a few words beside it, ``text`` the documentation.

    ``also`` is another name under which it is found.
    """

    label: str
    kind: OfferKind
    edit: Edit
    detail: str = ""
    text: str = ""
    also: str = ""


@dataclass(frozen=True, slots=True)
class Hover:
    """What there is to know of what stands at a span."""

    span: Span
    page: Page


@dataclass(frozen=True, slots=True)
class Symbol:
    """Something with a name: all that belongs to it, the name itself, what is in it."""

    name: str
    kind: SymbolKind
    detail: str
    whole: Span
    place: Span
    children: tuple[Symbol, ...] = ()


TokenKind = Literal[
    "keyword", "variable", "string", "number", "comment", "operator", "function", "type", "property", "namespace"
]
TOKEN_KINDS: tuple[TokenKind, ...] = get_args(TokenKind)
"""Kinds of tokens by the names of the language server protocol."""


@dataclass(frozen=True, slots=True)
class Token:
    """A part of a line in one colour."""

    span: Span
    kind: TokenKind


@dataclass(frozen=True, eq=False)
class Painted:
    """The tokens of a text in their colours, and its lines; the same object while the text is the same."""

    lines: Sequence[str]
    tokens: tuple[Token, ...]


@dataclass(frozen=True, slots=True)
class SignaturePart:
    """A parameter as the label of its signature has it, and in which section it is declared."""

    text: str
    section: str


@dataclass(frozen=True, slots=True)
class Signature:
    """What is called at a place, its parameters, and the number of the one that is being given."""

    label: str
    text: str
    parameters: tuple[SignaturePart, ...]
    active: int


Placed = TypeVar("Placed", Edit, Offer, Hover, Symbol)


def moved(answer: Placed, place: Callable[[Span], Span]) -> Placed:
    """An answer with other places: ``place`` says where each of them is."""
    if isinstance(answer, Offer):
        return replace(answer, edit=moved(answer.edit, place))
    if isinstance(answer, Symbol):
        children = tuple(moved(one, place) for one in answer.children)
        return replace(answer, whole=place(answer.whole), place=place(answer.place), children=children)
    return replace(answer, span=place(answer.span))
