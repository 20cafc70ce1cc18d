"""Results of verbs that have no room of their own: what was found, and short answers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from plcgen.base.diagnostics import Diagnostic
from plcgen.base.display.view import View


@dataclass(frozen=True, slots=True)
class Findings:
    """Diagnostics of a verb by the file they belong to; ``more`` are the verb's own keys for programs."""

    verb: str
    subjects: Sequence[tuple[str, Sequence[Diagnostic]]]
    more: Mapping[str, Any] = field(default_factory=dict)

    @property
    def diagnostics(self) -> list[Diagnostic]:
        """All of them, in order."""
        return [diagnostic for _, diagnostics in self.subjects for diagnostic in diagnostics]


@dataclass(frozen=True, slots=True)
class Answer:
    """What a verb tells: as data for programs, diagnostics included, and as text for people, without them."""

    data: Mapping[str, Any]
    text: Callable[[View], str]
    diagnostics: Sequence[Diagnostic] = ()
