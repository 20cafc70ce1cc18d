"""A device and its parameters, as a profile or a spec describes them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field

from plcgen.input.validation import StrictModel
from plcgen.project.schema import Value

if TYPE_CHECKING:
    from plcgen.protocols.ds47.wire.bico import Layout
    from plcgen.protocols.ds47.wire.errors import Table


@dataclass(frozen=True, slots=True)
class Parameter:
    """A drive parameter as the catalogue or the spec defines it.

    ``type`` is the DS47 data type on the wire; ``array`` the number of indexes (None: not indexed);
    ``access`` is r, w or rw; ``minimum``/``maximum`` in the parameter's unit; ``dangerous`` says why a write
    needs a sign-off.
    """

    pnu: int
    type: str
    name: str = ""
    title: str = ""
    unit: str = ""
    access: str = "rw"
    array: int | None = None
    minimum: float | None = None
    maximum: float | None = None
    default: bool | float | str | None = None
    bico: bool = False
    dangerous: str = ""
    source: str = ""


@dataclass(frozen=True, slots=True)
class Device:
    """A device profile: limits and habits of one drive family (source: its manuals, named in ``source``).

    ``record_index`` maps access points to data record indexes; ``default_index`` names the default one.
    ``drive_objects`` is None when every number is possible. ``answer_format`` is ``exact`` (the parameter's
    type) or ``size`` (41h/42h/43h). ``scalar_elements`` is the number of elements this device wants in a
    request without an index: (read, write). ``bico`` says whether BICO values carry the drive object.
    """

    key: str
    title: str
    source: str
    record_index: dict[str, int]
    default_index: str
    drive_object: int
    drive_objects: tuple[int, ...] | None
    drive_object_rule: str
    record_limit: int
    max_parameters: int
    answer_format: Literal["exact", "size"]
    error_words: Literal[1, 2]
    scalar_elements: tuple[int, int]
    strict_length: bool
    bico: Layout
    error_table: Table
    parameters: dict[int, Parameter]

    def by_name(self, name: str) -> Parameter | None:
        """Catalogue parameter by symbolic name."""
        return next((p for p in self.parameters.values() if p.name == name), None)


class ParameterDef(StrictModel):
    """A drive parameter that the device catalogue does not hold (or holds differently)."""

    type: str = Field(description="DS47 data type, e.g. FloatingPoint, Unsigned16, OctetString[4]")
    name: str | None = Field(None, description="symbolic name, snake_case; becomes the block's member name")
    title: str | None = Field(None, description="text for comments")
    unit: str | None = None
    access: Literal["r", "w", "rw"] = "rw"
    array: int | None = Field(None, ge=1, le=65535, description="number of indexes; absent: not indexed")
    min: float | None = None
    max: float | None = None
    default: Value | None = None
    bico: bool = Field(default=False, description="value is a BICO source such as r722.2")


def parameter_from(pnu: int, entry: dict[str, Any]) -> Parameter:
    """Build a parameter from its catalogue or spec entry (already validated)."""
    return Parameter(
        pnu=pnu,
        type=entry["type"],
        name=entry.get("name") or "",
        title=entry.get("title") or "",
        unit=entry.get("unit") or "",
        access=entry.get("access", "rw"),
        array=entry.get("array"),
        minimum=entry.get("min"),
        maximum=entry.get("max"),
        default=entry.get("default"),
        bico=entry.get("bico", False),
        dangerous=entry.get("dangerous", ""),
        source=entry.get("source", ""),
    )
