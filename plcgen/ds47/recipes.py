"""The shape of the section ``recipes``: parameter sets of which one is chosen by number when a job starts."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from plcgen.base.files.printed import Name, Value
from plcgen.base.files.validation import StrictModel
from plcgen.ds47.kind import ReadItem
from plcgen.project.schema import COMMENT, ONE_OR_MORE, Text, short_item

MOST_RECORDS = 1000
RecordValue = Value | tuple[Value, ...]


class RecipeItem(ReadItem):
    """One parameter of a recipe."""

    start: RecordValue | None = Field(None, description="value of the records that say nothing else")


class RecipeEntry(StrictModel):
    """A parameter set and its records."""

    parameters: Annotated[tuple[Annotated[RecipeItem, short_item("parameter")], ...], ONE_OR_MORE] = Field(
        min_length=1, description="parameters, each a member of a record"
    )
    records: (
        Annotated[int, Field(ge=2, le=MOST_RECORDS)]
        | Annotated[dict[Name, dict[Name, RecordValue]], Field(min_length=2, max_length=MOST_RECORDS)]
    ) = Field(description="how many there are, or their names with parameter: value, 2 to 1000")
    retain: bool = Field(default=True, description="the records keep their values without power")
    comment: Text | None = Field(None, description=COMMENT)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the records; empty texts if they have none."""
        return ("",) * self.records if isinstance(self.records, int) else tuple(self.records)
