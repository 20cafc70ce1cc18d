"""How a result shall look: what the user asked for, and who is going to read it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from plcgen.base.display.paint import paint

SourceLine = Callable[[str, int], str | None]
"""``lines(file, number)`` gives a line (from 1) without its end, None if it is not known."""

DEFAULT_WIDTH = 100
MIN_WIDTH = 40


def no_source(_file: str, _line: int) -> None:
    """Know no line of any file: diagnostics without excerpts."""


@dataclass(frozen=True, slots=True)
class View:
    """Everything a format may ask; each takes what concerns it.

    ``width`` in columns; ``lines`` gives excerpts of sources; ``grid`` draws telegrams; ``separator`` stands between
    the cells of CSV; ``fail_on`` is the class of changes that fails a comparison; ``ledger`` lists all that a
    verification rests on.
    """

    color: bool = False
    width: int = DEFAULT_WIDTH
    lines: SourceLine = no_source
    target: Literal["screen", "pipe", "file"] = "pipe"
    verbose: bool = False
    grid: bool = True
    separator: str = ","
    fail_on: str = "breaking"
    ledger: bool = False

    @property
    def columns(self) -> int:
        """``width``, but never so few that nothing fits."""
        return max(self.width, MIN_WIDTH)

    def paint(self, text: str, style: str) -> str:
        """Text in the colours of a style, if there are colours."""
        return paint(text, style, color=self.color)


PLAIN = View()
"""No colours, the width of files."""
