"""View of a job that restores: where values lie in its telegrams, and how the drive says that it runs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from plcgen.build.members import plain
from plcgen.build.nouns import CallerValue
from plcgen.build.spelling import type_words
from plcgen.ds47.plan.access import Running, Verify
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.ds47.views.parts import BlockParts
from plcgen.ds47.wire.model import ADDRESS_SIZE
from plcgen.ds47.words import RESTORE_WORDS


def cause_value(plan: DrivePlan, _: DriveJob) -> Iterator[CallerValue]:
    """Why a job that restores has failed, at the block and in the control DB."""
    word = type_words(tia=not plan.target.v5)["WORD"]
    yield CallerValue(plain(plan, "cause", word, "why it failed, 0: it did not"), (("", "HEX"),))


def restore_view(plan: DrivePlan, job: DriveJob) -> dict[str, Any]:
    """What a block needs that restores.

    ``places`` and ``sizes`` are those of the values in every answer; ``place`` is that of the first one, ``sent`` where
    it lies in the request that writes, ``size_last`` the number of its last byte. In that request values lie ``ahead``
    bytes further than in an answer, their formats ``formats`` bytes. Behind the indexes ``written`` and ``back`` of
    ``errors`` come those of the parameters; ``state`` are the last two bytes of the status word, None if it does not
    matter whether the drive runs.
    """
    _, written, back = job.telegrams[:3]
    fields = [field for field in back.response.fields if field.role == "value" and field.part is not None]
    values = [field for field in fields if field.part is not None and field.part.use.as_(Verify)]
    state = next((field for field in fields if field.part is not None and field.part.use.as_(Running)), None)
    sizes = [field.part.size for field in values if field.part is not None]
    tia, ahead = not plan.target.v5, ADDRESS_SIZE * len(values)
    last = state.offset + state.part.size - 1 if state is not None and state.part is not None else 0
    return {
        "count": len(values),
        "length": len(written.request.data),
        "request_last": len(written.request.data) - 1,
        "place": values[0].offset,
        "sent": values[0].offset + ahead,
        "size_last": sizes[0] - 1,
        "places": _start((field.offset for field in values), tia=tia),
        "sizes": _start(sizes, tia=tia),
        "odd": any(size % 2 for size in sizes),
        "ahead": ahead,
        "formats": ahead - 2,
        "written": written.parts[0].use.position - 1,
        "back": back.parts[0].use.position - 1,
        "state": {"high": last - 1, "low": last} if last else None,
    }


def _start(numbers: Any, *, tia: bool) -> str:
    """Start value of an array of numbers; one repetition if all are equal, as TIA exports it."""
    each = [str(number) for number in numbers]
    text = f"{len(each)}({each[0]})" if len(each) > 1 and len(set(each)) == 1 else ", ".join(each)
    return f"[{text}]" if tia else text


PARTS = (
    BlockParts(
        name="restore",
        precedence=40,
        has=lambda job: job.restores,
        members=frozenset({"cause"}),
        template="plcgen.ds47.kinds.restore:parts.scl.j2",
        view=restore_view,
        ends=1,
        words=lambda view: (row for row in RESTORE_WORDS if row[0] != "STATUS_RUNS" or view["state"]),
        outputs=cause_value,
        ends_early=lambda _: True,
        counts=lambda job: job.poll is not None,
    ),
)
