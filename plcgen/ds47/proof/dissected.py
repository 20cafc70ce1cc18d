"""Telegrams through Wireshark's dissector, field by field: an oracle that nobody of this project wrote.

Every request of the files, the answer of the simulated drive to it, and the refusal of a parameter that does not exist.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator, Sequence

from plcgen.base.diagnostics import Diagnostic
from plcgen.base.programs import find_program
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.ds47.proof.exchanges import ExchangeError, sound_image, talk, telegram_name
from plcgen.ds47.proof.second import mistakes
from plcgen.ds47.sim.bench import build_drive
from plcgen.ds47.wire import codec, formats
from plcgen.ds47.wire.model import ErrorBlock, Request, Response, ValueBlock
from plcgen.oracles import wireshark
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.folder import Folder

PROFIBUS, GLOBAL = 47, 0xB02F
Expected = tuple[str, int | float | str]
"""A field by its name in the dissector, and its value; values have the name ``value``. ``STOP`` has a reason."""
STOP = "stop"
FILL = "the fill byte after an odd number of bytes"
TEXT = "a VisibleString"
_PRECISION = 1e-5
"""A REAL is shown with six digits."""


def dissected_checks(plan: DrivePlan, folder: Folder) -> Iterator[Check]:
    """One check for each request of the files."""
    program = find_program("tshark")
    version = wireshark.version(program) if program else None
    if program is None or version is None:
        yield Check("wireshark", "Wireshark", "", Outcome.NOT_RUN, "not run: tshark is not installed")
        return
    telegrams = [
        (job, telegram, request)
        for job in plan.shapes
        for telegram in job.telegrams
        if (request := sound_image(plan, folder, job, telegram)) is not None
    ]
    try:
        spoken = [_spoken(plan, job, request) for job, _, request in telegrams]
        shown = wireshark.run_tshark(program, [record for records in spoken for record in records])
    except (wireshark.WiresharkError, ExchangeError) as problem:
        found = Diagnostic(
            "PG640",
            str(problem),
            plan.loaded.key_span(("plc",)),
            help="look at the installation of tshark, and at the group Simulated drive",
        )
        yield Check("wireshark", "Wireshark", "", Outcome.ERROR, str(problem), found)
        return
    for (job, telegram, _), records in zip(telegrams, spoken, strict=True):
        pairs, shown = shown[: len(records)], shown[len(records) :]
        unknown: set[str] = set()
        wrong = ""
        for record, (sent, received) in zip(records, pairs, strict=True):
            asked = codec.decode_request(record.request)
            read = codec.decode_response(record.answer, strict=False)
            wrong = wrong or compare_dissection("request", request_facts(asked), sent, unknown)
            wrong = wrong or compare_dissection("answer", response_facts(read), received, unknown)
        id_, subject = f"wireshark.{telegram.request.home.name}", telegram_name(job, telegram)
        text = f"{version}{_notes(job, unknown)}"
        if wrong:
            found = Diagnostic("PG640", wrong, folder.place((telegram.request.db or job.block).name))
            yield Check(id_, subject, text, Outcome.ERROR, wrong, found)
        else:
            yield Check(
                id_,
                subject,
                text,
                Outcome.OK,
                f"{2 * len(records)} telegrams, every field{' that it knows' if unknown else ''}",
            )


def _spoken(plan: DrivePlan, job: DriveJob, request: bytes) -> list[wireshark.WireRecord]:
    index = GLOBAL if job.drive.record_index == PROFIBUS else job.drive.record_index
    said = [request, *(data for what, data in mistakes(request, job) if what.startswith("a parameter"))]
    return [
        wireshark.WireRecord(index, data, talk(job, data, build_drive(plan, job.drive, distinct=True))) for data in said
    ]


def _notes(job: DriveJob, unknown: set[str]) -> str:
    notes = ["record 002Fh shown as B02Fh"] if job.drive.record_index == PROFIBUS else []
    if unknown:
        notes.append(f"it does not know {', '.join(sorted(unknown))}: what follows is not compared")
    return "".join(f"; {note}" for note in notes)


def request_facts(request: Request) -> list[Expected]:
    """What the dissector must show of a request."""
    found: list[Expected] = [
        ("request_reference", request.reference),
        ("request_id", request.request_id),
        ("do", request.drive_object),
        ("no_of_parameters", len(request.addresses)),
    ]
    for one in request.addresses:
        found += [
            ("attribute", one.attribute),
            ("no_of_elems", one.elements),
            ("number", one.pnu),
            ("index", one.subindex),
        ]
    for block in request.values:
        found += _values(block)
    return found


def response_facts(response: Response) -> list[Expected]:
    """What the dissector must show of an answer."""
    found: list[Expected] = [
        ("request_reference", response.reference),
        ("response_id", response.response_id),
        ("do", response.drive_object),
        ("no_of_parameters", response.count),
    ]
    for block in response.blocks:
        if isinstance(block, ValueBlock):
            found += _values(block)
        elif isinstance(block, ErrorBlock):
            words = 1 if block.info is None else 2
            found += [("format", formats.ERROR), ("no_of_values", words), ("error_num", block.number)]
            found += [("error_subindex", block.info)] if block.info is not None else []
        else:
            found += [("format", formats.ZERO), ("no_of_values", 0)]
    return found


def _values(block: ValueBlock) -> Iterator[Expected]:
    yield "format", block.format
    yield "no_of_values", block.count
    fmt = formats.by_code(block.format)
    if fmt.code == formats.FLOATING_POINT:
        yield from (("value", value) for (value,) in struct.iter_unpack(">f", block.data))
    elif fmt.code == formats.VISIBLE_STRING:
        yield STOP, TEXT
    else:
        step = fmt.size
        for at in range(0, len(block.data), step):
            yield "value", int.from_bytes(block.data[at : at + step], "big")
    if len(block.data) % 2:
        yield STOP, FILL


def compare_dissection(what: str, expected: Sequence[Expected], shown: wireshark.Dissected, unknown: set[str]) -> str:
    """The first field that differs; empty if none does. What the dissector does not know is added to ``unknown``."""
    if not shown.fields:
        return f"Wireshark sees no parameter {what} in the record"
    for position, (name, value) in enumerate(expected):
        if name == STOP:
            unknown.add(str(value))
            return ""
        if position >= len(shown.fields):
            return f"Wireshark sees the {what} end before {name} = {value}"
        field, text = shown.fields[position]
        if field == wireshark.UNKNOWN:
            unknown.add(f"the format {expected[position - 2][1]:02X}h")
            return ""
        if not _agrees(name, value, field, text):
            return f"{what}, field {position + 1}: {name} = {value} here, {field} = {text} in Wireshark"
    if len(shown.fields) > len(expected):
        return f"Wireshark sees {len(shown.fields) - len(expected)} fields more in the {what}"
    return ""


def _agrees(name: str, value: float | str, field: str, text: str) -> bool:
    """A second word behind an error is shown as a value where the number of the error defines no meaning for it."""
    if name != "value":
        second_word = name == "error_subindex" and field == "value_w"
        return (field == name or second_word) and int(text, 0) == value
    if not field.startswith("value_"):
        return False
    if field == "value_float":
        return isinstance(value, float) and math.isclose(float(text), value, rel_tol=_PRECISION)
    return int(text, 0) == value
