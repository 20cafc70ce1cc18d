"""Every assumption that a green verification rests on: who says so, and how well that is known."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.oracles.documents import device
from plcgen.proof.ledger import Assumption, Grade
from plcgen.protocols.ds47.device import Device, Fact, limit_text
from plcgen.protocols.ds47.plan.nouns import DrivePlan, PlannedDrive, Use
from plcgen.protocols.ds47.proof.published import Form
from plcgen.protocols.ds47.references import number_of
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
            for use in job.own:
                uses.setdefault(use.parameter.pnu, use)
    own = {number_of(text): (text, one) for text, one in plan.settings(drive).parameters.items()}
    for use in uses.values():
        parameter, name = use.parameter, f"{drive.key} {'r' if use.parameter.access == 'r' else 'P'}{use.parameter.pnu}"
        written, defined = own.get(parameter.pnu, ("", None))
        place = f"the spec, {'.'.join(map(str, drive.path))}.parameters.{written}" if written else "the spec"
        known = drive.device.parameters.get(parameter.pnu)
        typed = known is not None and bool(known.type)
        facts: tuple[tuple[Fact, str, bool], ...] = (
            ("type", use.format.name, defined is not None or not typed),
            ("min", limit_text(parameter.minimum), defined is not None and defined.min is not None),
            ("max", limit_text(parameter.maximum), defined is not None and defined.max is not None),
        )
        for fact, value, stated in facts:
            if value and (stated or not parameter.source):
                yield Assumption(name, f"{fact} {value}", place, Grade.SPEC)
            elif value:
                grade = _GRADES[parameter.grades.get(fact, "read")]
                yield Assumption(name, f"{fact} {value}", parameter.source, grade)


def _form(form: Form) -> Assumption:
    known = form.telegrams()
    if known:
        return Assumption(str(form), "published telegram", "; ".join(one.source for one in known), Grade.MANUAL)
    return Assumption(str(form), "format and size", formats.by_name(form.type).source, Grade.SECOND)
