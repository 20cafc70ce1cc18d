"""A drive that keeps another value than it was sent."""

from __future__ import annotations

from plcgen.ds47.plan.access import Part
from plcgen.ds47.plan.nouns import DriveTelegram
from plcgen.ds47.proof.keeping import other
from plcgen.ds47.proof.scenario import Contents, DriveScenario
from plcgen.ds47.proof.words import DEVIATES, WORDS
from plcgen.ds47.sim.parameters import Keeps


def another(telegram: DriveTelegram, place: int) -> DriveScenario:
    """The drive keeps another first value of a parameter."""
    part = telegram.parts[place - 1]
    name = f"the drive keeps another first value of parameter {place} of telegram {telegram.number}"
    return deviates(name, telegram, {place: 0}, keeps={part.use.parameter.pnu: other(part, 0, 0)})


def deviates(
    name: str,
    telegram: DriveTelegram,
    places: dict[int, int],
    *,
    keeps: dict[int, Keeps] | None = None,
    meanwhile: dict[int, Keeps] | None = None,
    generic: bool | None = None,
    values: Contents = "next",
) -> DriveScenario:
    """Parameters of a telegram by place, and which value of each is the first that is another one."""
    number = telegram.number
    return DriveScenario(
        name=name,
        keeps=keeps or {},
        meanwhile=meanwhile or {},
        generic=generic,
        values=values,
        status=(WORDS["DEVIATES"],),
        telegram=number,
        errors={(number, place): (DEVIATES, index_of(telegram.parts[place - 1], at)) for place, at in places.items()},
    )


def index_of(part: Part, at: int) -> int:
    """Index of a value of a part."""
    return part.subindex + at
