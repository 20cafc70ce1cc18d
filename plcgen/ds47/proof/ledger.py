"""Every assumption that a green verification rests on: who says so, and how well that is known."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from plcgen.ds47.device import Device, Fact, limit_text
from plcgen.ds47.plan.access import Use
from plcgen.ds47.plan.nouns import DrivePlan, PlannedDrive
from plcgen.ds47.proof.published import Form
from plcgen.ds47.references import number_of
from plcgen.oracles.documents import device
from plcgen.proof.ledger import Assumption, Grade

_GRADES = {"read": Grade.MANUAL, "inferred": Grade.SECOND, "recalled": Grade.GENERAL}
_ASYNCHRONOUS = 'TIA Portal help, "Difference between synchronous and asynchronous instructions"; "RDREC", "WRREC"'
_COMMON = (
    (
        "a record job starts by the level of REQ or by its edge: both are tried",
        f"{_ASYNCHRONOUS}; LAcycCom",
        Grade.SECOND,
    ),
    ("DONE, VALID, ERROR and STATUS count in the call that returns them", _ASYNCHRONOUS, Grade.MANUAL),
    ("RECORD, ID, INDEX, LEN and MLEN must not change while BUSY", _ASYNCHRONOUS, Grade.MANUAL),
)
"""Of WRREC and RDREC."""
_RETRIES = "SIMATIC system functions, STATUS of SFB 52 and 53; practice of data set 47 for B5h"


_CLOCKS = {
    True: "TIME_TCK counts ms up to 2147483647 and begins at 0 again",
    False: "ET of a TON counts ms as long as IN is TRUE, and stays at PT",
}


def ledger(plan: DrivePlan) -> Iterator[Assumption]:
    """Devices, telegram forms, parameters, then what all projects have in common."""
    used = [drive for drive in plan.drives if any(job.drive is drive for job in plan.jobs)]
    for known in dict.fromkeys(drive.device.key for drive in used):
        drives = [drive for drive in used if drive.device.key == known]
        yield from _device(drives[0].device, drives)
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
        yield from (Assumption("WRREC and RDREC", text, source, grade) for text, source, grade in _COMMON)
        yield Assumption("clock", _CLOCKS[plan.target.classic], "TIA Portal help, TON and TIME_TCK", Grade.MANUAL)


def _device(known: Device, drives: Sequence[PlannedDrive]) -> Iterator[Assumption]:
    """What a profile says of a device; a statement that a document makes too has that document as its source."""
    said = device(known.key)
    own = known.key.endswith((".yaml", ".yml"))
    profile = Grade.SPEC if own else Grade.GENERAL if said is None else Grade.SECOND

    def stated(text: str, *, documented: bool) -> Assumption:
        if said is not None and documented:
            return Assumption(known.key, text, said.source, Grade.MANUAL)
        return Assumption(known.key, text, known.source, profile)

    for number in dict.fromkeys(drive.record_index for drive in drives):
        names = [name for name, index in known.record_index.items() if index == number]
        text = f"parameters are reached through record {number:04X}h ({', '.join(names) or 'as the spec says'})"
        documented = said is not None and any(said.records.get(name) == number for name in names)
        yield stated(text, documented=documented)
    objects = "any" if known.drive_objects is None else ", ".join(map(str, known.drive_objects))
    printed = said is not None and said.drive_object == known.drive_object
    printed = printed and said is not None and (not said.drive_objects or said.drive_objects == known.drive_objects)
    yield stated(f"drive object {known.drive_object} by default, of {objects}", documented=printed)
    by_size = known.answer_format == "size"
    yield stated(
        f"a value is answered {'by size (41h to 43h)' if by_size else 'in its own type'}",
        documented=said is not None and said.by_size is by_size,
    )
    for text in (
        f"an error is answered with {known.error_words} {'word' if known.error_words == 1 else 'words'}",
        f"a telegram has {known.record_limit} bytes, {known.max_parameters} parameters, {known.max_elements} elements",
        "elements in a request without an index: {} to read, {} to write".format(*known.scalar_elements),
    ):
        yield stated(text, documented=False)


def _drive(plan: DrivePlan, drive: PlannedDrive) -> Iterator[Assumption]:
    uses: dict[int, Use] = {}
    for job in plan.jobs:
        if job.drive is drive:
            for use in job.own:
                uses.setdefault(use.parameter.pnu, use)
    own = {number_of(text): (text, one) for text, one in plan.settings(drive).parameters.items()}
    for use in uses.values():
        parameter, name = use.parameter, f"{drive.key} {use.parameter.label}"
        written, defined = own.get(parameter.pnu, ("", None))
        place = f"the spec, {'.'.join(map(str, drive.path))}.parameters.{written}" if written else "the spec"
        known = drive.device.find(parameter.pnu, drive.object_type)
        typed = known is not None and bool(known.type)
        facts: tuple[tuple[Fact, str, bool], ...] = (
            (
                "type",
                "" if use.untyped else use.format.name,
                defined is not None or not (typed or parameter.grades.get("type") == "inferred"),
            ),
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
    return Assumption(str(form), "format and size", form.source, Grade.SECOND)
