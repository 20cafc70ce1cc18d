"""View of a job whose parameter is named at run time: its inputs, and one form more of what has come."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.build.members import plain
from plcgen.build.nouns import CallerValue
from plcgen.build.spelling import type_words
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.ds47.views.parts import BlockParts
from plcgen.ds47.words import SERVICE_WORDS

ROOM = 8
"""Bytes of an answer that are kept."""


def asked_values(plan: DrivePlan, job: DriveJob) -> Iterator[CallerValue]:
    """What is asked for, at the block and in the control DB."""
    words = type_words(tia=not plan.target.v5)
    sign = "L#" if plan.target.v5 else ""
    use = job.uses[0]
    for name, type_, start, text in (
        ("number", words["DINT"], f"{sign}{use.parameter.pnu}", "number of the parameter"),
        ("index", words["DINT"], "", "its first index"),
        ("count", words["INT"], str(use.count), "number of values; 0 where a drive wants it of what has no index"),
        ("axis", words["INT"], "-1", "drive object, -1: that of the spec"),
    ):
        yield CallerValue(plain(plan, name, type_, text, start=start), (("", "DEC"),))


def more_values(plan: DrivePlan, job: DriveJob) -> Iterator[CallerValue]:
    """The bits of the first value."""
    words = type_words(tia=not plan.target.v5)
    text = "bits of the first value, at the right"
    yield CallerValue(plain(plan, f"{job.uses[0].member}Dword", words["DWORD"], text), (("", "HEX"),))


PARTS = (
    BlockParts(
        name="service",
        precedence=65,
        has=lambda job: job.serves,
        template="plcgen.ds47.kinds.service:parts.scl.j2",
        view=lambda _, job: {"room": ROOM, "value": job.uses[0].member},
        ends=7,
        words=lambda _: SERVICE_WORDS,
        inputs=asked_values,
        last_outputs=more_values,
    ),
)
