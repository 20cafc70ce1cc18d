"""What a member's name says it is: the ways of people who write these DBs by hand.

Sources: FAQ 109750712 (figures 4-5 to 4-10), the MM4 guide part 3 (tables 2-1 to 2-4), Siemens'
application examples for SINAMICS, and the names plcgen gives.
"""

from __future__ import annotations

import re

CLASSES = {
    "reference": "reference", "request_id": "id", "drive_object": "axis", "count": "count",
    "attribute": "attribute", "elements": "elements", "pnu": "pnu", "subindex": "subindex", "format": "format",
    "value_count": "elements", "value": "value", "pad": "pad",
}  # fmt: skip
"""Class of names by role of a field: the two counts of elements share one."""

_PATTERNS: tuple[tuple[str, str], ...] = (
    ("pad", r"pad|fill|reserve|dummy|spare|gap"),
    ("error", r"err|fault"),
    ("format", r"format|fmt|datatype|valuetype"),
    ("elements", r"(num|no|nr|cnt|anz|count).*(elem|ind|val)|(elem|val|ind)\w*(count|cnt|num|anz)|elements"),
    ("count", r"^(num|no|nr|n|cnt|count|anz)\w*(of)?par|par\w*(count|cnt|anz)"),
    ("attribute", r"attr"),
    ("subindex", r"sub|index|idx"),
    ("pnu", r"par\w*(no|nr|num|number)|pnu|^par(a|am|ameter)?$"),
    ("axis", r"axis|achse|driveobject|^do(id|no|nr|num|number|mirror)?$|device"),
    ("reference", r"ref"),
    ("id", r"id(mirror)?$|function|service"),
    ("value", r"val|wert|data|^pwe"),
)
_COMPILED = tuple((name, re.compile(pattern)) for name, pattern in _PATTERNS)


def class_of(path: str) -> str:
    """Class of a member by the last step of its path; empty if the name says nothing."""
    name = re.sub(r"\[[^\]]*\]", "", path).rpartition(".")[2]
    plain = re.sub(r"[^a-z]", "", name.lower())
    return next((found for found, pattern in _COMPILED if pattern.search(plain)), "")
