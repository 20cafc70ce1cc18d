"""View of a job that writes bits: the bytes of its request that are made of those that were read."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from plcgen.ds47.plan.access import Use
from plcgen.ds47.plan.nouns import DriveField, DriveJob, DriveTelegram

_BYTE = 0xFF


def bit_inputs(job: DriveJob) -> Iterator[dict[str, Any]]:
    """Inputs that are bits: the byte of the request that has each, the mask of the bit and that of the others."""
    for telegram in job.telegrams:
        for sent, use in _words(telegram):
            for one in use.bits:
                number = one.bit or 0
                if not one.constant:
                    mask = 1 << number % 8
                    octet = use.format.size - 1 - number // 8
                    yield {
                        "interface": one.member,
                        "octet": f"statRequestBytes{job.suffix(telegram)}[{sent.offset + octet}]",
                        "mask": f"B#16#{mask:02X}",
                        "others": f"B#16#{_BYTE ^ mask:02X}",
                    }


def merges(job: DriveJob, telegram: DriveTelegram) -> Iterator[dict[str, Any]]:
    """Every byte of a word in which bits are written: which of its bits are kept, where the others come from."""
    for sent, use in _words(telegram):
        old = job.old(use)
        answer, came = next(
            (one, field) for one in job.telegrams for field in one.response.fields if _value(field, old)
        )
        for octet, own in enumerate(use.mask):
            if own != _BYTE:
                yield {
                    "label": use.label if octet == 0 or use.mask[octet - 1] == _BYTE else "",
                    "octet": f"statRequestBytes{job.suffix(telegram)}[{sent.offset + octet}]",
                    "old": f"statResponseBytes{answer.number}[{came.offset + octet}]",
                    "mask": f"B#16#{own:02X}" if own else "",
                    "others": f"B#16#{_BYTE ^ own:02X}",
                }


def _words(telegram: DriveTelegram) -> Iterator[tuple[DriveField, Use]]:
    for field in telegram.request.fields:
        if field.role == "value" and field.part is not None and field.part.use.bits:
            yield field, field.part.use


def _value(field: DriveField, use: Use) -> bool:
    return field.role == "value" and field.part is not None and field.part.use is use
