"""What loading, planning and the rules of a project need of a protocol; the whole face is ``plcgen.protocol.base``."""

from __future__ import annotations

import typing
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pydantic import BaseModel

    from plcgen.base.diagnostics import Diagnostic, Report, Span
    from plcgen.base.display.page import Page
    from plcgen.base.telegrams.dissection import ByteField
    from plcgen.project.nouns import Plan
    from plcgen.project.numbering import Numbering
    from plcgen.project.spec import LoadedSpec, SpecPath


@dataclass(frozen=True, slots=True)
class Named:
    """A name of the spec: what it names, its role as in ``s7.names.check_name``, how to find its place."""

    what: str
    name: str
    role: str
    place: Callable[[], Span]


@dataclass(frozen=True, slots=True)
class Rules:
    """What a protocol adds to the rules: checks of its own, and what the shared rules must know.

    ``names`` are all names that reach a source or a file, ``texts`` all comments, ``untranslated`` texts without
    languages, ``taken`` names that blocks must not have: name, what has it, where it stands. ``partners`` are what one
    program alone may talk to: an address, what it is, where it stands. ``remarks`` tell what is worth knowing of a plan
    in which nothing is wrong.
    """

    checks: tuple[Callable[[Any], Iterator[Diagnostic]], ...]
    names: Callable[[Any], Iterator[Named]]
    texts: Callable[[Any], Iterator[tuple[SpecPath, dict[str, str]]]]
    untranslated: Callable[[Any], Iterator[tuple[SpecPath, str]]]
    taken: Callable[[Any], Iterator[tuple[str, str, Span | None]]]
    partners: Callable[[Any], Iterator[tuple[str, str, Span]]]
    remarks: tuple[Callable[[Any], Iterator[Diagnostic]], ...] = ()


class SpecPart(typing.Protocol):
    """What one protocol owns of a spec: its sections, their plan, its rules, its words for numbers and telegrams."""

    @property
    def key(self) -> str:
        """Name of the protocol and of its entry point."""

    @property
    def sections(self) -> tuple[str, ...]:
        """The keys of a spec that belong to the protocol, the one that is always there first."""

    @property
    def entries(self) -> tuple[str, ...]:
        """Keys below which entries stand by name: of a file with mistakes, one that is wrong is left out as a whole."""

    @property
    def details(self) -> tuple[str, ...]:
        """Keys of entries on which nothing else depends: a wrong one is left out alone."""

    def section(self, *, alone: bool) -> type[BaseModel]:
        """Shape of these keys; ``alone`` if the spec uses no other protocol."""

    def complete(self, schema: dict[str, Any], profiles: Sequence[str]) -> None:
        """Put the short forms into the JSON schema of a spec, and what the user's own device profiles name."""

    def pinned(self, loaded: LoadedSpec) -> Iterable[tuple[str, int]]:
        """Block numbers that the spec fixes: kind and number."""

    def plan(self, loaded: LoadedSpec, numbering: Numbering, report: Report) -> Plan:
        """Plan what the sections describe; what cannot be resolved is a diagnostic, the rest is planned."""

    def rules(self) -> Rules:
        """What may be wrong with such a plan."""

    def request_fields(self, data: bytes) -> list[ByteField]:
        """A request of the protocol field by field; what follows from other fields may be left out."""

    @property
    def length_note(self) -> str:
        """What the length of a request is called where the block is called, in brackets; may be empty."""

    def explain(self, digits: str) -> Page | None:
        """What a hexadecimal number means in this protocol; None if nothing."""
