"""Loading of case files and the short form of diagnostics that they use."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from plcgen.base.diagnostics import Diagnostic
from tests.yaml_files import read_yaml

HERE = Path(__file__).parent


def load(name: str) -> list[Any]:
    """Cases of one file below ``cases``."""
    return list(read_yaml((HERE / "cases" / f"{name}.yaml").read_text(encoding="utf-8")))


def source(name: str) -> str:
    """A source below ``sources``."""
    return (HERE / "sources" / name).read_text(encoding="utf-8")


def short(diagnostic: Diagnostic) -> str:
    """``line:column code message``."""
    span = diagnostic.span
    return f"{span.line}:{span.column} {diagnostic.code} {diagnostic.message}"


def assert_begins(expected: list[str], actual: list[str]) -> None:
    """Each actual text begins with the expected one, and there are no others."""
    assert len(expected) == len(actual), actual
    for want, have in zip(expected, actual, strict=True):
        assert have.startswith(want), f"expected {want!r}, found {have!r}"
