"""What documents call a parameter: its letter, number and indexes, its title and unit.

Numbers and indexes come from the bytes of the requests; what the parameter is called, from the spec and the profile.
"""

from __future__ import annotations

import math
import re

from plcgen.ds47.kind import Wait
from plcgen.ds47.plan.access import Use, Verify
from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.wording.meanings import AskedValue, numbers, subindices
from plcgen.ds47.wire.formats import unpack_values
from plcgen.proof.wording.model import stated_facts

MOST_LABELS = 4
"""So many parameters stand in the title of a job."""
_CONDITION = re.compile(r"(?P<label>\S+) (?P<operator>[=<>]+) (?P<value>.+)")


def label_of(use: Use, number: int, first: int) -> str:
    """``P1120``, ``r945[0..7]``, ``P1030.0, .2``, with number and first index as a request has them."""
    if use.served:
        return "number[index]"
    text = f"{use.parameter.letter}{number}"
    if use.first is not None:
        last = first + (0 if use.format.is_string else use.count - 1)
        text += f"[{first}]" if last == first else f"[{first}..{last}]"
    bits = [str(one.bit) for one in (use.bits or (use,)) if one.bit is not None]
    return text + (f".{', .'.join(bits)}" if bits else "")


def bit_label(word: Use, bit: Use, called: str) -> str:
    """``P1030.3`` of a word that is called ``P1030.0, .3``."""
    return f"{called.partition('.')[0] if word.first is None else called[: called.index(']') + 1]}.{bit.bit}"


def labels(job: DriveJob) -> dict[int, str]:
    """What each access of a job is called, by its position; the first telegram with a part of it says its index."""
    found: dict[int, str] = {}
    for telegram in job.telegrams:
        data = telegram.request.data
        for number, first, part in zip(numbers(data), subindices(data), telegram.parts, strict=True):
            found.setdefault(part.use.position, label_of(part.use, number, first))
    return found


def in_unit(use: Use) -> str:
    """`` [s]``, or nothing."""
    return f" [{use.parameter.unit}]" if use.parameter.unit else ""


def titles(use: Use) -> frozenset[str]:
    """What the spec says of a value in any language; else what the parameter is called."""
    said = {line(text) for text in use.comment.values() if text}
    return frozenset(said | {line(use.parameter.title)}) if use.parameter.title or said else frozenset({"value", ""})


def value_texts(use: Use, called: str) -> frozenset[str]:
    """What a member with the value of an access may say."""
    if use.as_(Wait) or use.as_(Verify):
        when = "read back" if use.as_(Verify) else f"as last read in step {use.step}"
        found = {f"{called} {title or 'value'}, {when}" for title in titles(use)}
        return frozenset(f"{text}{in_unit(use)}" for text in found)
    return frozenset(line(f"{called} {title}{in_unit(use)}") for title in titles(use))


def telegram_values(job: DriveJob, number: int) -> list[AskedValue]:
    """The parameters of one telegram of a job, from 0."""
    telegram, called = job.telegrams[number], labels(job)
    return [AskedValue(part.size, called[part.use.position], _inside(part.use, called[part.use.position]))
            for part in telegram.parts]  # fmt: skip


def _inside(use: Use, called: str) -> frozenset[str]:
    """What a member of a telegram may say: as one of the block, but for what the spec says of something else."""
    words = titles(use) | {line(use.parameter.title) or "value"}
    return frozenset(line(f"{called} {word}{in_unit(use)}") for word in words)


def line(text: str) -> str:
    """A text on one line, with single blanks."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def first_labels(names: list[str]) -> str:
    """The first names, and ``..`` for more."""
    return ", ".join(names[:MOST_LABELS]) + (", .." if len(names) > MOST_LABELS else "")


def waits_for(text: str, job: DriveJob, use: Use, called: str, *, english: bool = True) -> bool:
    """Whether a text says what an access waits for: ``r722.0 = 1``, ``r21 > 100.0``, ``r106 = bit 0 of P105``."""
    awaited, found = use.as_(Wait), _CONDITION.fullmatch(text)
    if awaited is None or found is None or found["operator"] != awaited.operator:
        return False
    if awaited.follows:
        wanted = f"bit 0 of {labels(job)[1]}"
        same = found["value"] == wanted if english else stated_facts(found["value"]) == stated_facts(wanted)
        return found["label"] == called and same
    if awaited.bit is not None:
        return found["label"] == f"{called}.{awaited.bit}" and found["value"] == str(int(any(use.data)))
    return found["label"] == called and same_number(found["value"], use, use.data[: use.format.size])


def same_number(text: str, use: Use, data: bytes) -> bool:
    """Whether a literal stands for a value of an access, as it is on the wire."""
    if (digits := re.fullmatch(r"(?:[A-Z]+#)?16#([0-9A-F]+)", text)) is not None:
        return int(digits[1], 16) == int.from_bytes(data)
    value = unpack_values(use.format, 1, data)[0]
    if text.upper() in {"TRUE", "FALSE"}:
        return (text.upper() == "TRUE") == any(data)
    try:
        number = float(text.rpartition("#")[2])
    except ValueError:
        return str(value) == text
    return isinstance(value, int | float) and math.isclose(number, value, rel_tol=1e-6, abs_tol=1e-38)
