"""Scenarios of a job that shows bits: each of them alone is set, each of them alone is not."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.ds47.kinds.single_bits.block import shows_bits
from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.points import replaced_values
from plcgen.ds47.proof.scenario import DriveScenario, KindScenarios


def single_bits(job: DriveJob, _: int) -> Iterator[DriveScenario]:
    """All of them."""
    for telegram in job.telegrams:
        for place, part in enumerate(telegram.parts, 1):
            whole = (1 << 8 * part.size) - 1
            for bit in (one for one in part.use.shown if one.bit is not None):
                alone = 1 << (bit.bit or 0)
                for how, word in (("set", alone), ("not set", whole ^ alone)):
                    data = word.to_bytes(part.size)
                    yield DriveScenario(
                        name=f"only {bit.label} is {how}",
                        reads={telegram.number: replaced_values(telegram, {place: data})},
                        delivers={(telegram.number, place): data},
                        generic=False,
                        follow=False,
                    )


SCENARIOS = (KindScenarios(6, shows_bits, single_bits),)
