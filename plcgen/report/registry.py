"""Output formats by name: one file each in ``plcgen.report.formats``, others as entry points of ``plcgen.outputs``.

A format is imported when it is asked for; all of them only to list their names.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

from plcgen.base.diagnostics import PluginError
from plcgen.base.display.view import View
from plcgen.base.plugins import plugins

if TYPE_CHECKING:
    from plcgen.base.display.results import Answer, Findings
    from plcgen.proof.checks import Verification
    from plcgen.report.review.model import Review
    from plcgen.report.trace.model import Trace
    from plcgen.s7.compare.model import Comparison
    from plcgen.s7.tables.tables import LayoutResult

Result = TypeVar("Result")
Renderer: TypeAlias = Callable[[Result, View], str]

GROUP = "plcgen.outputs"
"""Group of the entry points: name of the format = object of class OutputFormat."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputFormat:
    """One output format: a pure function for every kind of result that it can show.

    ``complete`` says that the diagnostics stand in its results; otherwise a verb tells them on stderr. ``comment`` is
    what stands around a remark in it: a result in a file ends with one by which it is known; None if there are none.
    """

    name: str
    complete: bool = True
    comment: tuple[str, str] | None = None
    findings: Renderer[Findings] | None = None
    verification: Renderer[Verification] | None = None
    verifications: Renderer[Sequence[Verification]] | None = None
    layout: Renderer[LayoutResult] | None = None
    comparison: Renderer[Comparison] | None = None
    trace: Renderer[Trace] | None = None
    review: Renderer[Review] | None = None
    answer: Renderer[Answer] | None = None

    def shows(self, kind: str) -> bool:
        """Whether the format can show this kind of result."""
        return kind in KINDS and getattr(self, kind) is not None

    def render(self, kind: str, result: Any, view: View) -> str:
        """The result as text. Raises ValueError if the format cannot show its kind."""
        if not self.shows(kind):
            raise ValueError(f"the format {self.name} does not show a {kind}")
        text: str = getattr(self, kind)(result, view)
        return text


KINDS = tuple(field.name for field in fields(OutputFormat) if field.name not in {"name", "complete", "comment"})


def output_format(name: str) -> OutputFormat | None:
    """The format of a name, None if there is none. Raises PluginError if an entry point is none."""
    return shipped_format(name) if name in _shipped() else _foreign().get(name)


def shipped_format(name: str) -> OutputFormat:
    """One of plcgen's own formats. Raises ModuleNotFoundError if it is none."""
    found: OutputFormat = import_module(f"plcgen.report.formats.{name}").FORMAT
    return found


def formats_for(kind: str) -> tuple[str, ...]:
    """Names of all formats that show a kind of result: ``text`` first, then in alphabetical order."""
    known = [output_format(name) for name in _shipped()] + list(_foreign().values())
    return tuple(sorted((found.name for found in known if found and found.shows(kind)), key=lambda n: (n != "text", n)))


def _shipped() -> list[str]:
    return [path.stem for path in Path(__file__).with_name("formats").iterdir() if path.match("[!_]*.py")]


def _foreign() -> dict[str, OutputFormat]:
    """Formats of other distributions; the shipped names are taken."""
    found = plugins(GROUP, OutputFormat)
    for name, loaded in found.items():
        if loaded.name != name:
            raise PluginError(f"the entry point {name} in {GROUP} is a format called {loaded.name}")
    return found
