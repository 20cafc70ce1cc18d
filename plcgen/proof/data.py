"""What was verified as plain data for programs."""

from __future__ import annotations

from typing import Any

from plcgen.base.display.data import diagnostic_data, head
from plcgen.proof.checks import Verification


def verification_data(verification: Verification) -> dict[str, Any]:
    """Groups of checks, then the diagnostics that belong to no check."""
    groups = [
        {
            "name": group.name,
            "title": group.title,
            "checks": [
                {
                    "id": check.id,
                    "subject": check.subject,
                    "text": check.text,
                    "outcome": check.outcome.value,
                    "verdict": check.verdict,
                    "diagnostic": diagnostic_data(check.diagnostic) if check.diagnostic else None,
                }
                for check in group.checks
            ],
        }
        for group in verification.groups
    ]
    counts: dict[str, int] = {}
    for check in verification.checks():
        key = check.outcome.value.replace(" ", "_")
        counts[key] = counts.get(key, 0) + 1
    return {
        **head("verification" if verification.verb == "verify" else verification.verb, ok=verification.ok),
        "spec": verification.spec,
        "folder": verification.folder,
        "project": verification.project,
        "target": verification.target,
        "summary": dict(sorted(counts.items())),
        "groups": groups,
        "ledger": [
            {"subject": one.subject, "text": one.text, "source": one.source, "grade": one.grade.value}
            for one in verification.ledger
        ],
        "diagnostics": [diagnostic_data(d) for d in verification.outside],
    }
