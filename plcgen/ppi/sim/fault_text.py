"""Faults as people write them: on the command line and in YAML."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, ValidationInfo, field_validator

from plcgen.base.files.options import read_fault
from plcgen.base.files.validation import FileShape, Octets, StrictModel, counting, problem, validate_option
from plcgen.base.files.yaml import resolve_plain
from plcgen.ppi.sim.faults import KINDS, At, Fault, FaultKind

MOST = 1_000_000
_FAULT = Fault(FaultKind.SILENCE)
_FOR_EVER = ("always", "forever")


class FaultKeys(StrictModel):
    """One fault: see ``Fault``."""

    kind: Annotated[FaultKind, Field(strict=False)] = Field(description="what goes wrong")
    times: Annotated[int, Field(ge=1, le=MOST)] | Literal["once", "always", "forever"] = Field(
        1, description="how often it strikes"
    )
    after: int = Field(_FAULT.after, ge=0, le=MOST, description="how many occasions pass first")
    at: At = Field(_FAULT.at, description="the frame whose answer is damaged")
    station: int | None = Field(None, ge=0, le=126, description="this address only")
    value: int | None = Field(None, ge=0, le=0xFFFF, description="the wrong value; see the kind")
    milliseconds: int = Field(_FAULT.milliseconds, ge=0, le=MOST, description="how much later the answer comes")
    data: Octets = Field(_FAULT.data, description="other bytes, hexadecimal")
    item: int = Field(_FAULT.item, ge=1, le=19, description="which item is refused")
    code: int | None = Field(None, ge=1, le=0xFFFF, description="return code of the item, or error of the header")

    @field_validator("*")
    @classmethod
    def _counts(cls, value: Any, info: ValidationInfo) -> Any:
        """Refuse a key that does nothing for the kind."""
        return counting(value, info, KINDS)

    @field_validator("code")
    @classmethod
    def _is_an_error(cls, code: int | None, info: ValidationInfo) -> int | None:
        """Return code of an item (not FFh, success) or error of a header (not 0)."""
        if code is not None and code > 0xFE and info.data.get("kind") is FaultKind.ITEM:
            raise problem(f"the return code of an item is 1 to 254, not {code}")
        return code

    def fault(self) -> Fault:
        """Build the fault."""
        times = None if self.times in _FOR_EVER else 1 if self.times == "once" else self.times
        return Fault(**{**dict(self), "times": times})


_OPTION = FileShape(FaultKeys, "the fault", "a fault is a mapping")


def parse_fault(text: str) -> Fault:
    """Read ``KIND[:KEY=VALUE,...]`` as the command line takes it. Raises DiagnosticError.

    ``times`` is ``once``, a number or ``always``.
    """
    option = f"--fault {text}"
    entry = read_fault(text, option, [item.value for item in FaultKind], _plain)
    return validate_option(entry, option, _OPTION).fault()


def _plain(key: str, text: str) -> Any:
    return text if key == "data" else _hexadecimal(text) if key == "code" else resolve_plain(text)


def _hexadecimal(text: str) -> Any:
    """Codes are hexadecimal, as manuals print them: 05, 8404, 8404h."""
    try:
        return int(text.removesuffix("h").removeprefix("16#"), 16)
    except ValueError:
        return text
