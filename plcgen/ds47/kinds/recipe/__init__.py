"""Jobs between the records of a recipe and a drive."""

from __future__ import annotations

from typing import Any

from plcgen.base.files.printed import Name
from plcgen.ds47.kind import JobKind, WriteItem


def _members(recipe: Any) -> tuple[WriteItem, ...]:
    """The parameters of a recipe, whatever becomes of them: what they start with is that of the records."""
    return tuple(WriteItem(**item.model_dump(by_alias=True)) for item in recipe.parameters)


def _recipe_kind(key: str, does: str, place: int) -> JobKind:
    return JobKind(
        key=f"{key}_recipe",
        place=place,
        verb=key.capitalize(),
        subject=lambda recipe: f"recipe {recipe}",
        writes=key == "write",
        shape=Name,
        description=f"key of a recipe: {does}",
        example=f"{key}_recipe: winding",
        items=_members,
        compares=key == "compare",
        recorded=True,
        read_back=key == "write",
    )


KINDS = (
    _recipe_kind("write", "the drive gets the values of a record", 110),
    _recipe_kind("read", "a record gets the values of the drive", 120),
    _recipe_kind("compare", "a record is compared with the drive", 130),
)
