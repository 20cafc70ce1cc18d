"""Scenarios of a job that compares: a drive that has what it should have, all but one value, none of them."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping

from plcgen.ds47.plan.access import Use
from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.deviation_lists import SIGN, swapped
from plcgen.ds47.proof.keeping import anything, moved, other
from plcgen.ds47.proof.points import ends, positions
from plcgen.ds47.proof.rig import VALUE_SETS
from plcgen.ds47.proof.scenario import Contents, DriveScenario, KindScenarios
from plcgen.ds47.sim.parameters import Keeps
from plcgen.ds47.wire.formats import FormatKind, Value, pack_values, unpack_values


def comparing(job: DriveJob, _: int) -> Iterator[DriveScenario]:
    """All of them."""
    odd: list[Contents] = ["odd"] * VALUE_SETS
    contents: tuple[Contents, ...] = ("factory", "next", "low", "high", *odd)
    for number, values in enumerate(contents, 1):
        yield _run(f"the drive has what it should have, values {values}, set {number}", {}, values)
        yield _run(f"all values have the other sign, values {values}, set {number}", _all(job, _other_sign), values)
        yield _run(f"no value is the right one, values {values}, set {number}", _all(job, anything), values)
        for step in (1, -1, 2, -2):
            floats = {use.parameter.pnu: moved(use, step) for use in job.uses if _is_float(use)}
            if floats:
                name = f"numbers are {step} units of the last place away, values {values}, set {number}"
                yield _run(name, floats, values)
        near = {use.parameter.pnu: _below_zero for use in job.uses if _is_float(use)}
        if near:
            yield _run(f"zeros are the smallest number of the other sign, values {values}, set {number}", near, values)
    for use in {use.format.code: use for use in job.uses}.values():
        yield _run(f"only {use.label} is another one", {use.parameter.pnu: anything(use)}, "next")
    yield _run("all values are 1", dict.fromkeys((use.parameter.pnu for use in job.uses), _one), "next")
    for telegram in ends(job):
        for place in positions(telegram):
            part = telegram.parts[place - 1]
            for at in dict.fromkeys((0, part.count - 1)):
                for octet in range(part.use.format.size):
                    where = f"octet {octet} of value {at} of parameter {place} of telegram {telegram.number}"
                    keeps = {part.use.parameter.pnu: other(part, at, octet)}
                    yield _run(f"the drive has another {where}", keeps, "next")


def _run(name: str, keeps: Mapping[int, Keeps], values: Contents) -> DriveScenario:
    return DriveScenario(name=name, matches=True, keeps=keeps, values=values, follow=False)


def _all(job: DriveJob, make: object) -> dict[int, Keeps]:
    return {use.parameter.pnu: make(use) for use in job.uses}  # type: ignore[operator]


def _is_float(use: Use) -> bool:
    return use.format.kind is FormatKind.FLOAT


def _one(_: int, value: Value) -> Value:
    return type(value)(1)


def _below_zero(_: int, value: Value) -> Value:
    """80000001h instead of 0.0, 00000001h instead of -0.0; other numbers stay."""
    bits = int.from_bytes(struct.pack(">f", value))
    return float(struct.unpack(">f", (bits ^ SIGN | 1).to_bytes(4))[0]) if not bits & ~SIGN else value


def _other_sign(use: Use) -> Keeps:
    def keeps(_: int, value: Value) -> Value:
        return unpack_values(use.format, 1, swapped(use.format, pack_values(use.format, [value])))[0]

    return keeps


SCENARIOS = (KindScenarios(40, lambda job: job.compares, comparing),)
