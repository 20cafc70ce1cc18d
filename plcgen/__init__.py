"""Verified S7 blocks for drives (PROFIdrive acyclic channel, data set 47) and S7-200 stations (PPI).

The names in ``__all__`` are the public API; they are imported when first used, so that ``import plcgen`` is free.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from plcgen import _moved
from plcgen._version import __version__

if TYPE_CHECKING:
    from plcgen.api import (
        CheckResult,
        ConvertResult,
        EncodedTelegram,
        EncodeResult,
        GenerateResult,
        LayoutResult,
        audit,
        check,
        check_lock,
        convert,
        decode,
        decode_status,
        diff,
        encode,
        encode_read,
        encode_write,
        explain,
        generate,
        layout,
        lock,
        review,
        schema,
        simulate,
        verify,
    )
    from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Note, PlcgenError, Severity, Span

_moved.install()

__all__ = [
    "CheckResult",
    "ConvertResult",
    "Diagnostic",
    "DiagnosticError",
    "EncodeResult",
    "EncodedTelegram",
    "GenerateResult",
    "LayoutResult",
    "Note",
    "PlcgenError",
    "Severity",
    "Span",
    "__version__",
    "audit",
    "check",
    "check_lock",
    "convert",
    "decode",
    "decode_status",
    "diff",
    "encode",
    "encode_read",
    "encode_write",
    "explain",
    "generate",
    "layout",
    "lock",
    "review",
    "schema",
    "simulate",
    "verify",
]

_DIAGNOSTICS = frozenset({"Diagnostic", "DiagnosticError", "Note", "PlcgenError", "Severity", "Span"})


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'plcgen' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module("plcgen.base.diagnostics" if name in _DIAGNOSTICS else "plcgen.api"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
