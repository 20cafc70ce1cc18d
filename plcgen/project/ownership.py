"""Which files of an output folder are the user's own: ``user_owned`` of a spec."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import PurePosixPath


def is_owned(path: str, names: Collection[str]) -> bool:
    """Whether a path is named, as such (``scl/Main.scl``) or by its block (``Main``: source and document)."""
    return path in names or PurePosixPath(path).stem in names


def owning(path: str) -> str:
    """The key of a spec that makes a generated file the user's own, for messages."""
    return f"declare it as yours: plc: {{user_owned: [{PurePosixPath(path).stem}]}}"
