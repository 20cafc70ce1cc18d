"""The verbs of the command line as Python functions: check, generate, verify, simulate, layout, encode, ...

Every function returns frozen results with their diagnostics; none prints, none exits. A user's mistake is a
diagnostic in the result, never an exception.
"""

from __future__ import annotations

from plcgen.api.project import (
    CheckResult,
    EncodedTelegram,
    EncodeResult,
    GenerateResult,
    Progress,
    check,
    default_folder,
    encode,
    generate,
    review,
    schema,
    simulate,
    verify,
)
from plcgen.api.sources import (
    SPEC_SUFFIXES,
    ConvertResult,
    Family,
    audit,
    check_lock,
    convert,
    diff,
    layout,
    lock,
)
from plcgen.api.telegrams import (
    decode,
    decode_status,
    encode_read,
    encode_write,
    explain,
)
from plcgen.review.layout.tables import LayoutResult

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
