"""Telegrams on the wire: the start values go to the simulated drive, the answer comes back through the members.

What is sent is what the start values on disk define, of the request DB or of the bytes in the job's block; nothing of
the generator is used. A job on several drives has one block: its first instance stands for all.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import product
from typing import Literal

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, PlcgenError, Span
from plcgen.base.diagnostics.counting import shortlist
from plcgen.ds47.plan.access import Part
from plcgen.ds47.plan.nouns import DriveField, DriveJob, DrivePlan, DriveTelegram
from plcgen.ds47.sim.bench import build_drive
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.sim.faults import Fault, FaultKind
from plcgen.ds47.wire import errors, formats, status
from plcgen.ds47.wire.codec import TelegramError, decode_request, decode_response
from plcgen.ds47.wire.model import ErrorBlock, Request, RequestId
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.folder import Folder
from plcgen.proof.making import Pending
from plcgen.proof.rig import shown_value
from plcgen.s7.layout.image import StartValueError, image, read_member, start_place
from plcgen.s7.layout.layout import layout_block, locate
from plcgen.s7.layout.shapes import TypeTable
from plcgen.s7.types.blocks import Block
from plcgen.s7.types.literals import LiteralError

ATTEMPTS = 40
RETRY_PAUSE = 200


class ExchangeError(PlcgenError):
    """A finding that ends the check of one telegram."""

    def __init__(self, code: str, message: str, place: Span | None = None) -> None:
        self.code, self.place = code, place
        super().__init__(message)


def check_telegrams(plan: DrivePlan, folder: Folder) -> Iterator[Pending]:
    """Checks of the group ``telegrams``: start values of each request DB against the spec and DS47."""
    for job in plan.shapes:
        for telegram in job.telegrams:
            shown = telegram.request.data.hex(" ").upper()
            text = f"{_short(shown)}  LEN {len(telegram.request.data)}"

            def run(job: DriveJob = job, telegram: DriveTelegram = telegram) -> str:
                data = request_image(plan, folder, job, telegram)
                _agree(folder, job, telegram, ("start", data), ("telegram", telegram.request.data))
                _check_request(job, telegram, data)
                return "start values form exactly this telegram"

            yield _pending(
                f"telegram.{telegram.request.home.name}", telegram_name(job, telegram), text, folder, job, telegram, run
            )


def check_drive(
    plan: DrivePlan, folder: Folder, own: Drive | None, progress: Callable[[str, int, int], None] | None
) -> Iterator[Pending]:
    """Checks of the group ``drive``: a good exchange and every negative answer."""
    total = len(plan.shapes)
    for number, job in enumerate(plan.shapes):
        if progress is not None:
            progress("exchange", number, total)
        for telegram in job.telegrams:
            name = telegram_name(job, telegram)

            def good(job: DriveJob = job, telegram: DriveTelegram = telegram) -> str:
                _exchange(plan, folder, job, telegram, build_drive(plan, job.drive, distinct=True))
                return _exchange(plan, folder, job, telegram, own or build_drive(plan, job.drive))

            yield _pending(f"drive.{telegram.request.home.name}", f"answer {name}", "", folder, job, telegram, good)
            numbers, positions = len(errors.known_numbers()), len(telegram.parts)
            count, other = (numbers + 1) * positions, "1 word" if _other_words(job) == 1 else "2 words"
            text = f"{numbers} error numbers x {positions} positions, and one of {other} at each"

            def bad(job: DriveJob = job, telegram: DriveTelegram = telegram, count: int = count) -> str:
                longest = _negative(plan, folder, job, telegram)
                return f"{count} negative answers fit, longest {longest} of {telegram.response.size} B"

            yield _pending(
                f"negative.{telegram.response.home.name}", f"errors {name}", text, folder, job, telegram, bad
            )


def _pending(
    id_: str, subject: str, text: str, folder: Folder, job: DriveJob, telegram: DriveTelegram, run: Callable[[], str]
) -> Pending:
    """One check; a finding becomes its outcome."""
    place = partial(folder.place, (telegram.request.db or job.block).name)
    return Pending(id_, subject, place, lambda: _run(id_, subject, text, place, run))


def _run(id_: str, subject: str, text: str, place: Callable[[], Span], run: Callable[[], str]) -> Check:
    try:
        return Check(id_, subject, text, Outcome.OK, run())
    except ExchangeError as finding:
        code, message, line = finding.code, str(finding), finding.place
    except DiagnosticError as problem:
        code, message, line = problem.diagnostics[0].code, problem.diagnostics[0].message, problem.diagnostics[0].span
    except StartValueError as problem:
        code, message, line = "PG604", str(problem), problem.span
    except (LiteralError, TelegramError) as problem:
        code, message, line = "PG604", str(problem), None
    return Check(id_, subject, text, Outcome.ERROR, message, Diagnostic(code, message, line or place()))


def telegram_name(job: DriveJob, telegram: DriveTelegram) -> str:
    """The job, and which of its telegrams where there are several."""
    return job.shape if len(job.telegrams) == 1 else f"{job.shape} {telegram.number}/{len(job.telegrams)}"


def _short(text: str) -> str:
    return text if len(text) <= 96 else f"{text[:92]} .."


def _block(folder: Folder, blocks: dict[str, Block], name: str) -> Block:
    block = blocks.get(name.upper())
    if block is None:
        raise ExchangeError("PG608", f'"{name}" is missing in {folder.path.name}')
    return block


def request_image(plan: DrivePlan, folder: Folder, job: DriveJob, telegram: DriveTelegram) -> bytes:
    """Bytes of a request at start, from the text source; the SimaticML must give the same ones."""
    data = _start_values(folder, folder.text, job, telegram)
    if plan.target.xml_version:
        twin = _start_values(folder, folder.xml, job, telegram)
        _agree(folder, job, telegram, ("text source", data), ("SimaticML", twin))
    return data


def _agree(folder: Folder, job: DriveJob, telegram: DriveTelegram, *both: tuple[str, bytes]) -> None:
    """Raises ExchangeError with the line that says the first byte that differs."""
    (one, data), (two, other) = both
    if data == other:
        return
    at = next((i for i, (a, b) in enumerate(zip(data, other, strict=False)) if a != b), min(len(data), len(other)))
    block, first, _ = _buffer(folder, folder.text, job, telegram)
    message = f"byte {at} differs: {one} {data.hex(' ').upper()}, {two} {other.hex(' ').upper()}"
    raise ExchangeError("PG604", message, start_place(block, folder.text, first + at))


def sound_image(plan: DrivePlan, folder: Folder, job: DriveJob, telegram: DriveTelegram) -> bytes | None:
    """The same; None if they are not the planned telegram, which :func:`check_telegrams` tells."""
    try:
        data = request_image(plan, folder, job, telegram)
    except (ExchangeError, DiagnosticError, LiteralError):
        return None
    return data if data == telegram.request.data else None


def _start_values(folder: Folder, blocks: TypeTable, job: DriveJob, telegram: DriveTelegram) -> bytes:
    block, first, size = _buffer(folder, blocks, job, telegram)
    return bytes(image(block, blocks)[first : first + size])


def _buffer(folder: Folder, blocks: TypeTable, job: DriveJob, telegram: DriveTelegram) -> tuple[Block, int, int]:
    """The request DB, or the instance of the job; first byte and length of the request in it."""
    if telegram.request.db is not None:
        block = _block(folder, blocks, telegram.request.db.name)
        return block, 0, layout_block(block, blocks).size
    block = _block(folder, blocks, job.block.name)
    try:
        entry = locate(layout_block(block, blocks), f"statRequest{suffix(job, telegram)}")
    except KeyError as problem:
        raise ExchangeError("PG604", str(problem.args[0])) from None
    return block, entry.byte, entry.size // 8


def suffix(job: DriveJob, telegram: DriveTelegram) -> str:
    """What follows the names of the buffers in a block with several telegrams."""
    return str(telegram.number) if len(job.telegrams) > 1 else ""


def _check_request(job: DriveJob, telegram: DriveTelegram, data: bytes) -> None:
    """The planned telegram decodes to what the spec asks for."""
    request = decode_request(data)
    if request.request_id != (RequestId.CHANGE if telegram.writes else RequestId.READ) or request.reference == 0:
        raise ExchangeError("PG604", "request id or reference is wrong")
    if request.drive_object != job.drive.drive_object:
        raise ExchangeError("PG604", f"drive object {request.drive_object} instead of {job.drive.drive_object}")
    if len(request.addresses) != len(telegram.parts):
        raise ExchangeError("PG604", f"{len(request.addresses)} parameters instead of {len(telegram.parts)}")
    for position, part in enumerate(telegram.parts):
        _check_part(request, position, part)


def _check_part(request: Request, position: int, part: Part) -> None:
    address = request.addresses[position]
    use = part.use
    if (address.pnu, address.subindex) != (use.parameter.pnu, part.subindex):
        raise ExchangeError(
            "PG604", f"parameter {position + 1} is P{address.pnu}[{address.subindex}] instead of {use.label}"
        )
    if use.writes and request.values[position].data != part.data:
        raise ExchangeError(
            "PG604", f"value of {use.label} is {request.values[position].data.hex(' ')}, not {part.data.hex(' ')}"
        )


def _exchange(plan: DrivePlan, folder: Folder, job: DriveJob, telegram: DriveTelegram, drive: Drive) -> str:
    """Send the image, fetch the answer, read it back through the declared members."""
    answer = talk(job, request_image(plan, folder, job, telegram), drive)
    if answer[1] & 0x80:
        has = drive.objects[job.drive.drive_object].parameters
        if job.serves and not any(part.use.parameter.pnu in has for part in telegram.parts):
            # the number is an input: not every drive object has the one that it begins with, and says 00h then
            return f"{_short(answer.hex(' ').upper())}  {_refusals(telegram, answer)}"
        raise ExchangeError("PG606", f"the drive answered {_refusals(telegram, answer)}")
    if len(answer) != telegram.positive_length:
        raise ExchangeError("PG606", f"the answer has {len(answer)} bytes, {telegram.positive_length} were planned")
    memory = _store(folder, telegram, answer)
    shown = [
        _read_back(folder, telegram, job, field, field.part, memory, drive)
        for field in telegram.response.fields
        if field.role == "value" and field.part is not None
    ]
    if telegram.writes:
        for part in telegram.parts:
            _written(job, part, drive)
            shown.append(f"{part.use.label} accepted")
    values = shortlist(shown, 6, f", .. ({len(shown)})")
    return f"{_short(answer.hex(' ').upper())}  {values}"


def _refusals(telegram: DriveTelegram, answer: bytes) -> str:
    """Which parameters the drive refused and why."""
    found = []
    for number, block in enumerate(decode_response(answer).blocks):
        if isinstance(block, ErrorBlock):
            label = telegram.parts[number].use.label if number < len(telegram.parts) else "the request"
            found.append(f"{label}: error {block.number:02X}h, {errors.error_text(block.number).meaning}")
    return "; ".join(found) or f"response id {answer[1]:02X}h"


def talk(job: DriveJob, request: bytes, drive: Drive) -> bytes:
    """WRREC and RDREC of one request; a temporary error is repeated as the job block would, at most 40 times."""
    index = job.drive.record_index
    for _ in range(ATTEMPTS):
        code = drive.write_record(index, request)
        if status.explain_status(code, "write").retry is not status.Retry.TEMPORARY:
            break
        drive.advance(RETRY_PAUSE)
    if code:
        raise ExchangeError("PG606", f"WRREC ends with {code:08X}: {status.explain_status(code).text}")
    drive.advance(drive.behaviour.processing)
    for _ in range(ATTEMPTS):
        code, answer = drive.read_record(index, 240)
        if status.explain_status(code, "read").retry is not status.Retry.TEMPORARY:
            break
        drive.advance(RETRY_PAUSE)
    if code:
        raise ExchangeError("PG606", f"RDREC ends with {code:08X}: {status.explain_status(code).text}")
    return answer


def _store(folder: Folder, telegram: DriveTelegram, answer: bytes) -> bytearray:
    """The response after RDREC."""
    block = _block(folder, folder.text, telegram.response.home.name)
    memory = bytearray(layout_block(block, folder.text).size)
    if len(answer) > len(memory):
        short = len(answer) - len(memory)
        raise ExchangeError("PG605", f"response buffer {short} bytes too small: the answer has {len(answer)}")
    memory[: len(answer)] = answer
    return memory


def _held(job: DriveJob, part: Part, drive: Drive) -> list[formats.Value]:
    """The values that a drive has where a part reads or writes."""
    parameter = drive.objects[job.drive.drive_object].parameters[part.use.parameter.pnu]
    return [parameter.values[0]] if part.use.format.is_string else parameter.values[part.subindex :][: part.count]


def _read_back(
    folder: Folder,
    telegram: DriveTelegram,
    job: DriveJob,
    field: DriveField,
    part: Part,
    memory: bytearray,
    drive: Drive,
) -> str:
    block = _block(folder, folder.text, telegram.response.home.name)
    layout = layout_block(block, folder.text)
    entry = locate(layout, field.name)
    expected = formats.pack_values(part.use.format, _held(job, part, drive))
    found = bytes(memory[entry.byte : entry.byte + len(expected)])
    if found != expected:
        raise ExchangeError(
            "PG607",
            f'"{block.name}".{field.name} holds {found.hex(" ").upper()}, the drive has {expected.hex(" ").upper()}',
        )
    value = read_member(memory, layout, field.name)
    unit = f" {part.use.parameter.unit}" if part.use.parameter.unit else ""
    db = telegram.response.db
    address = f" at DB{db.number}.DBD{entry.byte}" if db is not None and entry.size == 32 else ""
    return f"{part.use.label} = {shown_value(value)}{unit}{address}"


def _written(job: DriveJob, part: Part, drive: Drive) -> None:
    values = _held(job, part, drive)
    if formats.pack_values(part.use.format, values) != part.data:
        raise ExchangeError("PG607", f"{part.use.label}: the drive has {values} after the write")


def _other_words(job: DriveJob) -> Literal[1, 2]:
    """Words of an error that the drive of a job does not send by its profile."""
    return 1 if job.drive.device.error_words == 2 else 2


def _negative(plan: DrivePlan, folder: Folder, job: DriveJob, telegram: DriveTelegram) -> int:
    """Every error number at every position, and one in the other length; the longest answer in bytes."""
    longest = 0
    drive = build_drive(plan, job.drive)
    request = request_image(plan, folder, job, telegram)
    size = layout_block(_block(folder, folder.text, telegram.response.home.name), folder.text).size
    forms = [(number, job.drive.device.error_words) for number in errors.known_numbers()] + [(2, _other_words(job))]
    for (number, words), position in product(forms, range(1, len(telegram.parts) + 1)):
        fault = Fault(FaultKind.ERROR, number=number, position=position, words=words, info=position)
        drive.faults = [fault]
        answer = talk(job, request, drive)
        longest = max(longest, len(answer))
        if len(answer) > size:
            raise ExchangeError(
                "PG605", f"response buffer {len(answer) - size} bytes too small: it has {size}, an answer {len(answer)}"
            )
        if not answer[1] & 0x80:
            raise ExchangeError("PG606", f"error {number:02X}h at parameter {position} was not answered")
    drive.faults = [Fault(FaultKind.ERROR, number=2, position=p, words=2) for p in range(1, len(telegram.parts) + 1)]
    answer = talk(job, request, drive)
    if len(answer) > size:
        raise ExchangeError("PG605", f"response buffer {len(answer) - size} bytes too small: every parameter may fail")
    return max(longest, len(answer))
