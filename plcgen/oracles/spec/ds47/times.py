"""Times as a spec writes them: a whole number with a unit, ``200ms``, ``10s``, ``2min``, ``1h``."""

from __future__ import annotations

import re
from typing import Any

from plcgen.oracles.spec.place import NotStatedError

_UNITS = {"ms": 1, "s": 1000, "min": 60_000, "h": 3_600_000}
_TIME = re.compile(r"\s*(\d+)\s*(ms|s|min|h)\s*")


def milliseconds(text: Any, default: int) -> int:
    """A time in milliseconds; ``default`` if none is given."""
    if text is None:
        return default
    match = _TIME.fullmatch(str(text))
    if match is None:
        raise NotStatedError(f"{text!r} is no time")
    return int(match[1]) * _UNITS[match[2]]
