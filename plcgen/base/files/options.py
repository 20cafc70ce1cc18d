"""What options of the command line say in a text of their own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.diagnostics.suggest import did_you_mean

USAGE = "PG901"


def usage(option: str, message: str, help_: str = "") -> DiagnosticError:
    """Build the error of an argument that makes no sense; ``option`` is quoted as the place."""
    return DiagnosticError([Diagnostic(USAGE, message, Span(option), help=help_)])


def read_fault(text: str, option: str, kinds: Sequence[str], value: Callable[[str, str], Any]) -> dict[str, Any]:
    """Read ``KIND[:KEY=VALUE,...]`` as the mapping that a file would hold; ``value`` reads the value of a key.

    Raises:
        DiagnosticError: PG901 for a kind that does not exist, or a key without a value.
    """
    kind, _, rest = (part.strip() for part in text.partition(":"))
    if kind not in kinds:
        hint = did_you_mean(kind, kinds) or f"faults: {', '.join(kinds)}"
        raise usage(option, f'there is no fault "{kind}"', hint)
    entry: dict[str, Any] = {"kind": kind}
    for pair in filter(None, (part.strip() for part in rest.split(","))):
        key, equals, typed = (part.strip() for part in pair.partition("="))
        if not equals or not typed:
            raise usage(option, f'"{pair}" has no value', f"for example {kind}:times=2")
        entry[key] = value(key, typed)
    return entry
