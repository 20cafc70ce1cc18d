"""Scenarios: what a station answers to a PPI master: not yet, a refusal, another reply than the right one."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.ppi.plan.nouns import PpiJob
from plcgen.ppi.proof.replies import TOO_MANY, edits, with_data
from plcgen.ppi.proof.scenario import PpiScenario, fault, loose
from plcgen.ppi.proof.words import WORDS

RETURN_CODES = (0x01, 0x03, 0x05, 0x06, 0x07, 0x0A, 0x42)
"""Return codes of items: those of the S7-200 and one that nobody knows."""
HEADER_ERRORS = (0x8001, 0x8104, 0x8404, 0x8500, 0xD602)


def ready(polls: int) -> Iterator[PpiScenario]:
    """E5 to polls, a bounded number of times and forever."""
    for times in sorted({1, 2, polls - 1}):
        if 0 < times < polls:
            yield PpiScenario(
                name=f"not ready {times} times", faults=(fault("not_ready", times=times),), polls=times + 1
            )
    yield PpiScenario(
        name="never ready", faults=(fault("not_ready", times=None),), status=(WORDS["NOT_READY"],), polls=polls
    )


def _codes(number: int, count: int, *, every: bool) -> tuple[int, ...]:
    """What one of so many items refuses with: the outer ones with every code, those between with one each in turn."""
    if every or number in {1, count}:
        return RETURN_CODES
    return (RETURN_CODES[number % len(RETURN_CODES)],)


def refusals(job: PpiJob, *, every: bool) -> Iterator[PpiScenario]:
    """Return codes at every position, and refusals of the whole job."""
    for code in HEADER_ERRORS:
        yield PpiScenario(
            name=f"job refused with {code:04X}h",
            faults=(fault("header", code=code),),
            status=(WORDS["REFUSED"],),
            header=code,
        )
    yield loose(
        name="job refused with an acknowledgement (ROSCTR 2)",
        faults=(fault("header", code=HEADER_ERRORS[0]),),
        edit=lambda pdu: pdu[:1] + b"\x02" + pdu[2:],
        status=(WORDS["REFUSED"],),
        header=HEADER_ERRORS[0],
    )
    if job.telegrams[0].response is not None:
        yield loose(
            name="an item refused in a reply with a byte too many",
            faults=tuple(fault("item", item=n, code=5) for n, _ in enumerate(job.telegrams[0].items, 1)),
            edit=lambda pdu: with_data(pdu, pdu[14:] + b"\xff"),
            status=(WORDS["REPLY_FORMAT"],),
        )
    for after, telegram in enumerate(job.telegrams):
        for number, wire in enumerate(telegram.items if telegram.response is not None else (), 1):
            positions = sorted({placed.value.position for placed in wire.values})
            for code in _codes(number, len(telegram.items), every=every):
                yield loose(
                    name=f"item {number} of telegram {telegram.number} refused with {code:02X}h",
                    faults=(fault("item", item=number, code=code, after=after),),
                    status=(WORDS["ITEM_ERROR"],),
                    errors=dict.fromkeys(positions, 0x8000 | code),
                )
        count = len(telegram.items) if telegram.response is not None else 0
        for name, numbers in (("first and last item", (1, count)), ("last two items", (count - 1, count))):
            if count < len(numbers) or (numbers[0] == 1 and name != "first and last item"):
                continue
            wrong = [telegram.items[number - 1] for number in numbers]
            places = sorted({placed.value.position for wire in wrong for placed in wire.values})
            yield loose(
                name=f"{name} of telegram {telegram.number} refused",
                faults=tuple(fault("item", item=n, code=5, after=after) for n in numbers),
                status=(WORDS["ITEM_ERROR"],),
                errors=dict.fromkeys(places, 0x8005),
            )


def wrong_replies(job: PpiJob) -> Iterator[PpiScenario]:
    """The read in front of the first write with an item or a parameter too many; then every other wrong reply."""
    for name in ("an item", "a parameter") if job.kind != "read" else ():
        yield loose(
            name=f"first read with {name} too many", edit=TOO_MANY[name], status=(WORDS["REPLY_FORMAT"],), fresh=True
        )
    for name, edit in edits(job):
        yield loose(name=f"reply with {name}", edit=edit, status=(WORDS["REPLY_FORMAT"],))
