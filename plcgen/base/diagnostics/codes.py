"""The one table of codes: what each one means, what goes wrong otherwise, how to fix it, by example.

The table is ``codes.toml`` beside this module. It is read on first use only, so that start-up does not pay for it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from plcgen.base.diagnostics.model import Severity


@dataclass(frozen=True, slots=True)
class CodeInfo:
    """One code. ``also`` is the severity that some cases have instead. ``bad`` and ``good`` are short examples in
    ``language`` (yaml, scl, text, xml, sh).
    """

    code: str
    title: str
    why: str
    fix: str
    severity: Severity
    also: Severity | None
    bad: str
    good: str
    language: str

    @property
    def levels(self) -> str:
        """``error``, or ``error or warning`` where it depends on the case."""
        return self.severity.label if self.also is None else f"{self.severity.label} or {self.also.label}"

    @property
    def page(self) -> str:
        """File name of the code's page in the documentation."""
        return f"{self.code}.md"


AREAS = {
    "1": "Reading the spec",
    "2": "Devices and parameters",
    "3": "Telegrams, buffers and times",
    "4": "Blocks, flags and names",
    "5": "Writing the output folder",
    "6": "Verification",
    "7": "Telegrams on the command line",
    "8": "Reading sources and XML",
    "9": "Using the tool",
}
"""What the first digit of a code says."""


@cache
def _table() -> dict[str, CodeInfo]:
    import tomllib
    from importlib.resources import files

    table = tomllib.loads(files("plcgen.base.diagnostics").joinpath("codes.toml").read_text("utf-8"))
    return {
        code: CodeInfo(
            code=code,
            title=entry["title"],
            why=entry["why"],
            fix=entry["fix"],
            severity=Severity[entry.get("severity", "error").upper()],
            also=Severity[entry["also"].upper()] if "also" in entry else None,
            bad=entry["bad"].strip("\n"),
            good=entry["good"].strip("\n"),
            language=entry.get("language", "yaml"),
        )
        for code, entry in sorted(table.items())
    }


def all_codes() -> tuple[str, ...]:
    """Every code of the table, in ascending order."""
    return tuple(_table())


def code(code: str) -> CodeInfo:
    """What the table says about a code, in any letter case. Raises KeyError if there is no such code."""
    return _table()[code.strip().upper()]
