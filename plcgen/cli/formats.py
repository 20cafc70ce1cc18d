"""Machine formats by name: the one place where ``--format`` meets the report modules."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from plcgen.diagnostics import Diagnostic

if TYPE_CHECKING:
    from plcgen.proof.checks import Verification

Subjects = Sequence[tuple[str, Sequence[Diagnostic]]]


def diagnostics_in(format_: str, verb: str, subjects: Subjects, **more: Any) -> str:
    """Diagnostics of a verb, by the spec they belong to; ``more`` are further keys of the JSON."""
    found = [diagnostic for _, diagnostics in subjects for diagnostic in diagnostics]
    if format_ == "sarif":
        from plcgen.output.sarif import diagnostics_sarif

        return diagnostics_sarif(found)
    if format_ == "junit":
        from plcgen.output.junit import diagnostics_junit

        return diagnostics_junit(verb, subjects)
    if format_ == "github":
        from plcgen.output.github import diagnostics_github

        return diagnostics_github(found)
    from plcgen.output.json import diagnostics_json

    return diagnostics_json(verb, found, specs=[subject for subject, _ in subjects], **more)


def verification_in(format_: str, verification: Verification, verb: str = "verify") -> str:
    """Write a verification (or what an audit found) in a machine format."""
    if format_ == "sarif":
        from plcgen.output.sarif import verification_sarif

        return verification_sarif(verification)
    if format_ == "junit":
        from plcgen.output.junit import verification_junit

        return verification_junit(verification, verb)
    if format_ == "github":
        from plcgen.output.github import verification_github

        return verification_github(verification)
    from plcgen.output.json import verification_json

    return verification_json(verification, "verification" if verb == "verify" else verb)
