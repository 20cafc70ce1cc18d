"""View of a sequence: the numbers of its parameters, and for each step that waits how an answer is compared."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from plcgen.build.members import plain
from plcgen.build.nouns import CallerValue
from plcgen.build.spelling import literal, type_words
from plcgen.ds47.kind import Wait
from plcgen.ds47.plan.fields import interface_type
from plcgen.ds47.plan.nouns import DriveField, DriveJob, DrivePlan, DriveTelegram
from plcgen.ds47.views.conditions import condition_text
from plcgen.ds47.views.parts import BlockParts
from plcgen.ds47.wire.formats import FormatKind
from plcgen.ds47.words import SEQUENCE_WORDS
from plcgen.s7.types.data_types import Elementary

_OTHERWISE = {"=": "<>", "<>": "=", "<": ">=", ">": "<=", "<=": ">", ">=": "<"}
"""When a comparison is false."""


def step_values(plan: DrivePlan, _: DriveJob) -> Iterator[CallerValue]:
    """Which step has failed, and which parameter of it, at the block and in the control DB."""
    words = type_words(tia=not plan.target.v5)
    step = plain(plan, "failedStep", words["INT"], "step of the sequence that failed, 0: none")
    parameter = plain(plan, "failedParameter", words["DINT"], "number of its parameter that failed, 0: none")
    yield CallerValue(step, (("", "DEC"),))
    yield CallerValue(parameter, (("", "DEC"),))


def sequence_view(plan: DrivePlan, job: DriveJob) -> dict[str, Any]:
    """What a block needs that goes through steps: numbers of parameters, and how it waits."""
    sign = "L#" if plan.target.v5 else ""
    each = [f"{sign}{use.parameter.pnu}" for use in job.uses]
    numbers = f"{len(each)}({each[0]})" if len(each) > 1 and len(set(each)) == 1 else ", ".join(each)
    waiting = [telegram for telegram in job.telegrams if telegram.awaited is not None]
    always = len(waiting) == len(job.telegrams)
    waits = [_wait(plan, job, telegram, always=always) for telegram in waiting]
    return {
        "numbers": numbers if plan.target.v5 else f"[{numbers}]",
        "triggers": any(telegram.once for telegram in job.telegrams),
        "waits": waits,
        "bytes": any(condition["bytes"] for wait in waits for condition in wait["conditions"]),
        "ends": [wait["number"] for wait in waits] == [len(job.telegrams)],  # nothing is behind the only one that waits
        "partly": len(job.telegrams) > 1
        or len(job.uses) > 1
        or bool(waits),  # an error may stand beside parameters that were answered well
    }


def _wait(plan: DrivePlan, job: DriveJob, telegram: DriveTelegram, *, always: bool) -> dict[str, Any]:
    """How the answer to a question is compared; a copy of it is needed first where numbers in floating point are."""
    suffix = job.suffix(telegram)
    fields = [field for field in telegram.response.fields if field.role == "value" and field.part is not None]
    uses = [field.part.use for field in fields if field.part is not None]
    floats = any(use.as_(Wait) and use.format.kind is FormatKind.FLOAT for use in uses)
    return {
        "number": telegram.number,
        "branch": "ELSE" if always and telegram is job.telegrams[-1] else f"{telegram.number}:",
        "copied": f"statResponseBytes{suffix}" if floats else "",
        "last": telegram.positive_length - 1,
        "conditions": [
            _comparison(plan, job, field, f"statResponse{suffix}.{field.name}")
            for field in fields
            if field.part is not None and field.part.use.as_(Wait)
        ],
    }


def _told(job: DriveJob) -> str:
    """The last byte of the value that the first telegram writes."""
    fields = job.telegrams[0].request.fields
    last = next(one.offset + one.part.size - 1 for one in fields if one.role == "value" and one.part is not None)
    return f"statRequestBytes1[{last}]"


def _comparison(plan: DrivePlan, job: DriveJob, field: DriveField, member: str) -> dict[str, Any]:
    """One comparison: of a number in floating point as such, of others byte by byte, the first one with its sign."""
    assert field.part is not None  # fields of values only
    use = field.part.use
    awaited = use.as_(Wait)
    assert awaited is not None  # all parts of such a telegram wait
    shown = {"label": condition_text(plan, job, use), "number": use.parameter.pnu, "operator": awaited.operator}
    if use.format.kind is FormatKind.FLOAT:
        type_ = interface_type(use.format, 1, 0, plan.target)
        assert isinstance(type_, Elementary)  # what has no type is refused
        return {**shown, "bytes": [], "member": member, "value": literal(type_, use.data, v5=plan.target.v5)}
    masks = [0xFF] * use.format.size
    if awaited.bit is not None:
        masks = list((1 << awaited.bit).to_bytes(use.format.size))
    signed = use.format.kind is FormatKind.SIGNED and awaited.operator not in {"=", "<>"}
    flips = [0x80 if signed and index == 0 else 0 for index in range(use.format.size)]
    found: list[dict[str, Any]] = [
        {
            "at": field.offset + index,
            "mask": f"B#16#{mask:02X}" if mask < 0xFF else "",
            "flip": f"B#16#{flip:02X}" if flip else "",
            "wanted": byte & mask ^ flip,
            "told": "",
        }
        for index, (byte, mask, flip) in enumerate(zip(use.data, masks, flips, strict=True))
        if mask
    ]
    if awaited.follows:
        found[-1]["told"] = _told(job)
    return {**shown, "bytes": found, "otherwise": _OTHERWISE[awaited.operator]}


def _times(_: DriveJob) -> list[tuple[str, int, str]]:
    return [("STEP_LIMIT", 1000, "ms, the longest time between two calls that counts")]


PARTS = (
    BlockParts(
        name="sequence",
        precedence=90,
        has=lambda job: job.in_steps and not job.waits,
        template="plcgen.ds47.kinds.sequence:parts.scl.j2",
        view=sequence_view,
        ends=4,
        outputs=step_values,
        fails=True,
    ),
    BlockParts(
        name="sequence",
        precedence=90,
        has=lambda job: job.waits,
        reserved=frozenset({"failedstep", "failedparameter", "step_limit"}),
        template="plcgen.ds47.kinds.sequence:waiting.scl.j2",
        view=sequence_view,
        ends=5,
        times=_times,
        words=lambda _: SEQUENCE_WORDS,
        outputs=step_values,
        fails=True,
        ends_early=lambda _: True,
        counts=lambda _: True,
    ),
)
