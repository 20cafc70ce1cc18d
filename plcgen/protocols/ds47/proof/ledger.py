"""Every assumption that a green verification rests on: who says so, and how well that is known."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from plcgen.oracles.documents import device
from plcgen.proof.ledger import Assumption, Grade
from plcgen.protocols.ds47.device import Device, Fact, Parameter
from plcgen.protocols.ds47.plan.nouns import DrivePlan, PlannedDrive, Use
from plcgen.protocols.ds47.plan.references import number_of
from plcgen.protocols.ds47.proof.published import Form
from plcgen.protocols.ds47.wire import formats

_GRADES = {"read": Grade.MANUAL, "inferred": Grade.SECOND, "recalled": Grade.GENERAL}
_RETRIES = "SIMATIC system functions, STATUS of SFB 52 and 53; practice of data set 47 for B5h"


def ledger(plan: DrivePlan) -> Iterator[Assumption]:
    """Devices, telegram forms, parameters, then what all projects have in common."""
    used = [drive for drive in plan.drives if any(job.drive is drive for job in plan.jobs)]
    for known in dict.fromkeys(drive.device.key for drive in used):
        yield from _device(next(drive.device for drive in used if drive.device.key == known))
    for drive in used:
        yield from _drive(plan, drive)
    for form in dict.fromkeys(Form.of(job, use) for job in plan.shapes for use in job.uses):
        yield _form(form)
    if any(use.format.is_string for job in plan.shapes for use in job.uses):
        yield Assumption(
            "strings",
            "their elements are octets, in reads and in changes",
            "ABB RETA-02 user's manual, table 17; Siemens' PROFIdrive application example (AC4)",
            Grade.SECOND,
        )
    if plan.jobs:
        yield Assumption("records", "A2h to A4h, A7h, B5h, C0h to C6h and A1h of WRREC pass", _RETRIES, Grade.SECOND)


def _device(known: Device) -> Iterator[Assumption]:
    said = device(known.key)
    unseen = Grade.SPEC if known.key.endswith((".yaml", ".yml")) else Grade.GENERAL
    source, grade = (said.source, Grade.MANUAL) if said is not None else (known.source, unseen)
    numbers = ", ".join(f"{number:04X}h on {name}" for name, number in known.record_index.items())
    yield Assumption(known.key, f"records for parameters: {numbers}", source, grade)
    yield Assumption(known.key, f"drive objects: {known.drive_object_rule}", source, grade)
    profile = unseen if said is None else Grade.SECOND
    words = "word" if known.error_words == 1 else "words"
    by_size = "by size (41h to 43h)" if known.answer_format == "size" else "in its own type"
    for text in (
        f"a value is answered {by_size}, an error in {known.error_words} {words}",
        f"a telegram has {known.record_limit} bytes, {known.max_parameters} parameters, {known.max_elements} elements",
        "elements in a request without an index: {} to read, {} to write".format(*known.scalar_elements),
    ):
        yield Assumption(known.key, text, known.source, profile)


def _drive(plan: DrivePlan, drive: PlannedDrive) -> Iterator[Assumption]:
    uses: dict[int, Use] = {}
    for job in plan.jobs:
        if job.drive is drive:
            for use in job.uses:
                uses.setdefault(use.parameter.pnu, use)
    own = {number_of(text) for text in plan.settings(drive).parameters}
    for use in uses.values():
        parameter, name = use.parameter, f"{drive.key} {'r' if use.parameter.access == 'r' else 'P'}{use.parameter.pnu}"
        source = parameter.source or "the spec"
        yield Assumption(name, f"type {use.format.name}", source, _grade(parameter, "type", own))
        limits: tuple[tuple[Fact, float | None], ...] = (("min", parameter.minimum), ("max", parameter.maximum))
        for fact, limit in limits:
            if limit is not None:
                yield Assumption(name, f"{fact} {limit:g}", source, _grade(parameter, fact, own))


def _grade(parameter: Parameter, fact: Fact, own: Collection[int | None]) -> Grade:
    """``own`` are the numbers of the parameters that the spec defines for the drive."""
    if parameter.pnu in own or not parameter.source:
        return Grade.SPEC
    return _GRADES[parameter.grades.get(fact, "read")]


def _form(form: Form) -> Assumption:
    known = form.telegrams()
    if known:
        return Assumption(str(form), "published telegram", "; ".join(one.source for one in known), Grade.MANUAL)
    return Assumption(str(form), "format and size", formats.by_name(form.type).source, Grade.SECOND)
