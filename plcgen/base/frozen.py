"""Values of which there are very many."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeVar, dataclass_transform

_Class = TypeVar("_Class")


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def frozen(cls: type[_Class]) -> type[_Class]:
    """Make a dataclass with slots that is frozen for type checkers only: at run time that would cost four times."""
    return dataclass(slots=True, unsafe_hash=True)(cls)
