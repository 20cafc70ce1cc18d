"""What the catalogue knows about parameters: every fact with its grade, for people and for programs."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, get_args

from plcgen.base.display.page import Page
from plcgen.ds47.device import DECIDING, Device, Fact, Grade, Parameter, facts

GRADES: tuple[Grade, ...] = get_args(Grade)


def counts(parameters: Iterable[Parameter]) -> Counter[Grade]:
    """Facts of parameters by grade; without the access, which the letter of a number says."""
    known = (facts(one) for one in parameters)
    return Counter(grade for one in known for fact, (_, grade) in one.items() if fact != "access")


def parameter_page(device: Device, parameter: Parameter) -> Page:
    """One parameter of a device."""
    known = facts(parameter)
    names, how = known.pop("values", ({}, ""))
    sections = [("Facts", "\n".join(_line(device, fact, value, grade) for fact, (value, grade) in known.items()))]
    if not parameter.type:
        sections.append(("Type", "unknown: a job must give it, {parameter: .., type: ..}"))
    if names:
        sections.append((f"Names of values ({how})", told_value(names)))
    every = device.names(parameter.pnu, "bits")
    for of, bits in every.items():
        whose = f" of {', '.join(of)}" if len(every) > 1 else ""
        sections.append((f"Bits (0/1){whose}", "\n".join(f".{bit:<3} {name}" for bit, name in bits.items())))
    if parameter.observed is not None:
        sections.append(("Seen in a drive", f"{parameter.observed}, which is not a factory setting"))
    danger = device.danger(parameter.pnu) if "w" in parameter.access else ""
    if danger:
        sections.append(("Dangerous", f"{danger}; a job that writes it needs a sign-off"))
    for heading, text in (("Can be changed", parameter.changeable), ("Note", parameter.note)):
        if text:
            sections.append((heading, text))
    sections.append(("Source", parameter.source))
    name = f"{parameter.name}: " if parameter.name else ""
    return Page(f"{parameter.label} of {device.key}", f"{name}{parameter.title}", tuple(sections))


def data(device: Device, parameter: Parameter) -> Mapping[str, Any]:
    """The same for programs."""
    return {
        "device": device.key,
        "parameter": parameter.label,
        "name": parameter.name,
        "facts": {fact: {"value": value, "grade": grade} for fact, (value, grade) in facts(parameter).items()},
        "observed": parameter.observed,
        "dangerous": device.danger(parameter.pnu) if "w" in parameter.access else "",
        "changeable": parameter.changeable,
        "note": parameter.note,
        "source": parameter.source,
    }


def draw(device: Device, number: int, seed: int) -> Sequence[Parameter]:
    """Parameters for a spot check: the same ones for the same seed, in the order of their numbers."""
    known = sorted(device.parameters)
    chosen = random.Random(seed).sample(known, min(number, len(known)))  # noqa: S311 - a spot check, no secret
    return [device.parameters[pnu] for pnu in sorted(chosen)]


def _line(device: Device, fact: Fact, value: Any, grade: Grade) -> str:
    decides = grade == "read" or fact not in DECIDING
    told = told_value(value)
    if fact == "bico":
        told = "a source such as r722.2" + (", with its drive object" if device.bico == "drive-object" else "")
    return f"{fact:<8} {told}  ({grade}{'' if decides else ', decides nothing'})"


def told_value(value: Any) -> str:
    """A fact for people; the names of values as ``20 = speed_control``."""
    if isinstance(value, Mapping):
        return ", ".join(f"{number} = {name}" for name, number in value.items())
    if isinstance(value, list):
        return ", ".join(value)
    return f"{value:g}" if isinstance(value, float) else str(value)
