"""What a job adds to its block that shows bits of words."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from plcgen.build.nouns import CallerValue
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan, DriveTelegram
from plcgen.ds47.views.parts import BlockParts
from plcgen.ds47.views.rows import interface_row


def bit_values(plan: DrivePlan, job: DriveJob) -> Iterator[CallerValue]:
    """The bits, behind the words that they belong to."""
    for _, bit in job.shown:
        if bit.bit is not None:
            yield CallerValue(interface_row(plan, bit, start=False), (("", "Bool"),))


def shows_bits(job: DriveJob) -> bool:
    """Whether a bit is an output of its own."""
    return any(one.bit is not None for _, one in job.shown)


def _telegram(_: DrivePlan, job: DriveJob, telegram: DriveTelegram) -> list[dict[str, Any]]:
    """Where each bit lies in an answer: octets begin with the highest bits."""
    found = []
    for field in telegram.response.fields:
        if field.role != "value" or field.part is None:
            continue
        use = field.part.use
        for bit in use.shown:
            number = bit.bit
            if number is None:
                continue
            octet = field.offset + use.format.size - 1 - number // 8
            found.append(
                {
                    "name": bit.member,
                    "use": use.position,
                    "octet": f"statResponseBytes{job.suffix(telegram)}[{octet}]",
                    "mask": f"B#16#{1 << number % 8:02X}",
                }
            )
    return found


PARTS = (
    BlockParts(
        name="shown_bits",
        precedence=8,
        has=shows_bits,
        template="plcgen.ds47.kinds.single_bits:parts.scl.j2",
        view=lambda *_: True,
        telegram=_telegram,
        last_outputs=bit_values,
    ),
)
