"""The verbs of the command line as Python functions: check, generate, verify, simulate, layout, encode, ...

Every function returns frozen results with their diagnostics; none prints, none exits. A user's mistake is a
diagnostic in the result, never an exception.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from plcgen.api.project import (
        CheckResult,
        GenerateResult,
        Progress,
        check,
        default_folder,
        generate,
        review,
        simulate,
        verify,
    )
    from plcgen.api.schemas import schema
    from plcgen.api.sources import SPEC_SUFFIXES, ConvertResult, audit, check_lock, convert, diff, layout, lock
    from plcgen.api.telegrams import (
        EncodedTelegram,
        EncodeResult,
        decode,
        decode_status,
        encode,
        encode_read,
        encode_write,
        explain,
    )
    from plcgen.s7.tables.tables import LayoutResult
    from plcgen.s7.types.system import Family

__all__ = [
    "SPEC_SUFFIXES",
    "CheckResult",
    "ConvertResult",
    "EncodeResult",
    "EncodedTelegram",
    "Family",
    "GenerateResult",
    "LayoutResult",
    "Progress",
    "audit",
    "check",
    "check_lock",
    "convert",
    "decode",
    "decode_status",
    "default_folder",
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

_SOURCES = frozenset({"SPEC_SUFFIXES", "ConvertResult", "audit", "check_lock", "convert", "diff", "layout", "lock"})
_TELEGRAMS = frozenset(
    {"EncodeResult", "EncodedTelegram", "decode", "decode_status", "encode", "encode_read", "encode_write", "explain"}
)

_ELSEWHERE = {
    "Family": "plcgen.s7.types.system",
    "LayoutResult": "plcgen.s7.tables.tables",
    "schema": "plcgen.api.schemas",
}


def __getattr__(name: str) -> Any:
    """Import a name of the API when it is first used: a verb starts without the modules of the others."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    module = f"{__name__}.{'sources' if name in _SOURCES else 'telegrams' if name in _TELEGRAMS else 'project'}"
    found = globals()[name] = getattr(import_module(_ELSEWHERE.get(name, module)), name)
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
