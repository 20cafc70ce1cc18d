"""What is wrong, where, why and how to fix it: the vocabulary every level speaks.

``model`` holds the frozen values, ``codes`` the one table of codes, ``suggest`` the near-name search.
"""

from plcgen.base.diagnostics.model import (
    ArgumentError,
    Diagnostic,
    DiagnosticError,
    Note,
    PlcgenError,
    PluginError,
    Report,
    Severity,
    Span,
    has_errors,
)

__all__ = [
    "ArgumentError",
    "Diagnostic",
    "DiagnosticError",
    "Note",
    "PlcgenError",
    "PluginError",
    "Report",
    "Severity",
    "Span",
    "has_errors",
]
