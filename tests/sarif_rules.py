"""What GitHub asks of a SARIF file for code scanning: the properties that its documentation calls required.

Source: docs.github.com, "SARIF support for code scanning", tables of the supported properties.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Any

RULE = (("id",), ("shortDescription", "text"), ("fullDescription", "text"), ("help", "text"))
PLACE = (
    ("artifactLocation", "uri"),
    *(("region", key) for key in ("startLine", "startColumn", "endLine", "endColumn")),
)


def refused(log: dict[str, Any]) -> Iterator[str]:
    """What is missing, and fingerprints of several results, which would be one alert."""
    for run in log["runs"]:
        rules = run["tool"]["driver"]["rules"]
        for number, rule in enumerate(rules):
            yield from (f"rule {number} lacks {'.'.join(path)}" for path in RULE if not _at(rule, path))
        prints = Counter(each for result in run["results"] for each in result.get("partialFingerprints", {}).items())
        yield from (f"{each} is the fingerprint of {count} results" for each, count in prints.items() if count > 1)
        for number, result in enumerate(run["results"]):
            if not _at(result, ("message", "text")):
                yield f"result {number} lacks a message"
            if rules[result.get("ruleIndex", -1)]["id"] != result["ruleId"]:
                yield f"result {number} is of no rule"
            if not result.get("locations"):
                yield f"result {number} lacks a place"
            for place in (*result.get("locations", ()), *result.get("relatedLocations", ())):
                physical = place.get("physicalLocation", {})
                yield from (f"result {number} lacks {'.'.join(path)}" for path in PLACE if not _at(physical, path))


def _at(value: Any, path: tuple[str, ...]) -> Any:
    for key in path:
        value = value.get(key) if isinstance(value, dict) else None
    return value
