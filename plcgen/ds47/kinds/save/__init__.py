"""Jobs after which the drive keeps its parameters without power."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import AfterValidator, BeforeValidator, Field

from plcgen.base.files.validation import StrictModel, problem
from plcgen.ds47.device import Parameter
from plcgen.ds47.kind import JobKind, Poll, ReadItem, Unfit, WriteItem, short_form, within_limit
from plcgen.project.schema import Duration, short_item
from plcgen.s7.types.durations import spelled

SAVES = {"drive_object": 971, "unit": 977}
"""Set to 1, the parameter starts saving, and returns to 0 when that has ended (S120: p0971, S210: p0977)."""


_EFFECTS = {"drive_object": "object", "unit": "unit"}


def _lasting(value: object) -> object:
    if value == "ram":
        message = "a value is in the RAM of the drive as soon as it is written: there is nothing to save"
        raise problem(message, help_="choose drive_object or unit; beside write, ram says that nothing is saved")
    return value


def _what(value: object) -> object:
    """``save: true`` leaves open what is saved."""
    if isinstance(value, bool):
        help_ = "save: drive_object saves the drive object of the job (p0971), save: unit the whole unit (p0977)"
        raise problem(f'"{str(value).lower()}" does not say what is saved', help_=help_)
    return value


class SaveSettings(StrictModel):
    """What a drive saves, how long that may take, and how often it may happen."""

    persist: Annotated[Literal["drive_object", "unit"], BeforeValidator(_lasting)] = Field(
        description="drive_object: p0971, parameters of the job's drive object; unit: p0977, those of the whole unit"
    )
    limit: Annotated[Duration, Field(ge=1_000, le=600_000)] = Field(
        30_000, description="longest time until the parameter returns to 0, 1 s to 10 min"
    )
    interval: Annotated[Duration, Field(ge=100, le=10_000), AfterValidator(within_limit)] = Field(
        1_000, description="time between two polls for its return to 0, 100 ms to 10 s"
    )
    distance: Annotated[Duration, Field(ge=60_000)] = Field(
        600_000, description="shortest time from one save to the next, at least 1 min"
    )
    setting: Literal[10, 11, 12] | None = Field(
        None, description="saves as this setting, in addition to the one that is loaded at power-on"
    )


_SAVING = {"en-US": "as last read: 0 when the drive has saved"}


def _save_items(settings: SaveSettings) -> tuple[ReadItem | WriteItem, ...]:
    name = f"P{SAVES[settings.persist]}"
    asked = {"parameter": name, "as": "saving", "comment": _SAVING}
    return WriteItem(parameter=name, value=settings.setting or 1), ReadItem.model_validate(asked)


def _save_permits(settings: SaveSettings) -> dict[int, str]:
    return {SAVES[settings.persist]: f"the job says save, once in {spelled(settings.distance)} at most"}


def _unfit(
    item: ReadItem | WriteItem, found: Parameter | None, known: Mapping[int, Parameter], device: str
) -> Unfit | None:
    """The parameter that saves must be known with its type, and with its range where it shall save as a setting."""
    name = item.parameter
    setting = item.value if isinstance(item, WriteItem) and item.value != 1 else None
    if found is None or not found.type:
        others = "; ".join(f"save: {word}" for word, pnu in SAVES.items() if pnu in known and f"P{pnu}" != name)
        message = f"{name} is not in the catalogue of {device}: it is not known whether writing it saves anything"
        return Unfit(
            message, f"if your drive has it, define it there: parameters: {{{name}: {{type: Unsigned16}}}}", others
        )
    if setting is not None and found.maximum is None:
        message = f"nobody has looked up whether {name} of {device} takes {setting}"
        help_ = f"if your drive does, define it there: parameters: {{{name}: {{type: {found.type}, max: 12}}}}"
        return Unfit(message, help_, key="setting")
    return None


SAVE = JobKind(
    key="save",
    place=40,
    writes=True,
    shape=Annotated[SaveSettings, short_item("persist"), BeforeValidator(_what)],
    description="drive_object or unit: what the drive must keep without power, or {persist, limit, ..}",
    example="save: drive_object",
    items=_save_items,
    short=short_form(SaveSettings, (*SAVES, "ram")),
    poll=lambda settings: Poll(settings.interval, settings.limit, settings.distance, _EFFECTS[settings.persist]),
    unfit=_unfit,
    follows=True,
    instead={SAVES["unit"]: (SAVES["drive_object"], "save: drive_object saves what {drive} has")},
    void=lambda value: value in ("ram", {"persist": "ram"}),
    permits=_save_permits,
)
KINDS = (SAVE,)
