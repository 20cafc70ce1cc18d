"""View of a job's function block: every name, number and table row that its template writes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from plcgen.base.diagnostics.counting import shortlist
from plcgen.build.control import signals
from plcgen.build.members import WATCHED, plain
from plcgen.build.nouns import CallerValue, Command, FunctionBlock, TypeBlock
from plcgen.build.simaticml import RECORD_NOTE
from plcgen.build.spelling import clean_title, comment_text, encodable, literal, one_line, type_words
from plcgen.ds47.kind import Poll, Wait
from plcgen.ds47.plan.access import Compare, Mask, Part, Recount, Remember, Use, Verify, Write
from plcgen.ds47.plan.fields import interface_type
from plcgen.ds47.plan.nouns import DriveField, DriveJob, DrivePlan, DriveTelegram
from plcgen.ds47.plan.types import element_type
from plcgen.ds47.registry import kind_called
from plcgen.ds47.views.bits import bit_inputs, merges
from plcgen.ds47.views.conditions import condition_text
from plcgen.ds47.views.engine import engine_names, versions
from plcgen.ds47.views.parts import BlockParts, all_parts, parts_of
from plcgen.ds47.views.rows import buffer_blocks, interface_row
from plcgen.s7.types.data_types import ArrayType, DataType, Elementary


def program(plan: DrivePlan, job: DriveJob, instances: Sequence[DriveJob]) -> FunctionBlock:
    """The function block of a job with its buffers and the commands of its instances."""
    label = _job_title(plan, job)
    return FunctionBlock(
        block=job.block,
        instance=None,
        title=label,
        template="ds47/job.scl.j2",
        view=_view(plan, job, label),
        note=RECORD_NOTE,
        buffers=buffer_blocks(plan, job, label),
        commands=tuple(command(plan, one, label) for one in instances),
        telegrams=[
            f"request `{telegram.request.data.hex(' ').upper()}` (LEN {len(telegram.request.data)}), "
            f"its reference (byte 0) new in every run, "
            f"good answer {telegram.positive_length} bytes, longest answer {telegram.response.size} bytes"
            for telegram in job.telegrams
        ],
    )


def command(plan: DrivePlan, job: DriveJob, label: str) -> Command:
    """An instance as its caller sees it."""
    cyclic = _cyclic(job)
    return Command(
        control=job.caller.control,
        prefix=plan.prefix,
        member=job.member,
        title=label if job.key == job.shape else f"{label} ({job.drive.key})",
        flags=dict(job.trigger.items()),
        signals=signals(plan, {"execute": cyclic} if cyclic else None, starts=bool(cyclic)),
        inputs=_inputs(plan, job),
        outputs=_outputs(plan, job),
        shared=[_diagnosis(plan, job)],
    )


def diagnosis_type(plan: DrivePlan, job: DriveJob) -> TypeBlock:
    """Why a job failed, and what became of each of its parameters."""
    texts = next((part.results for part in parts_of(job) if part.results is not None), _RESULTS)
    words = type_words(tia=not plan.target.v5)
    results = f"{words['ARRAY']}[1..{len(job.uses)}] {words['OF']} {words['WORD']}"
    rows = (
        ("recordStatus", words["WORD"], "bytes 2 and 3 of STATUS of the last WRREC or RDREC"),
        ("retries", words["INT"], "retries of the last telegram"),
        ("errors", results, texts[0]),
        ("errorInfos", results, texts[1]),
    )
    return TypeBlock(job.diagnosis, [plain(plan, *row) for row in rows], job.comment)


def _diagnosis(plan: DrivePlan, job: DriveJob) -> CallerValue:
    watched = [f".errors[{number}]" for number in range(1, min(len(job.uses), WATCHED) + 1)]
    shown = tuple((name, "Hex") for name in (".recordStatus", *watched))
    return CallerValue(
        plain(plan, "diagnosis", f'"{job.diagnosis.name}"', "why it failed, and with which parameter"), shown
    )


def _cyclic(job: DriveJob) -> str:
    """What execute does of a job with a cycle."""
    return f"TRUE: the job runs every {job.cycle} ms" if job.cycle else ""


def _inputs(plan: DrivePlan, job: DriveJob) -> list[CallerValue]:
    """Values that the caller supplies."""
    parts = parts_of(job)
    first = [one for part in parts for one in part.inputs(plan, job)]
    last = [CallerValue(row, ()) for part in parts for row in part.last_inputs(plan, job)]
    return [*first, *(_value(plan, use, start=True) for use in job.inputs), *last]


def _outputs(plan: DrivePlan, job: DriveJob) -> list[CallerValue]:
    """Values that the block delivers."""
    parts = parts_of(job)
    first = [one for part in parts for one in part.outputs(plan, job)]
    last = [one for part in parts for one in part.last_outputs(plan, job)]
    return [*first, *(_value(plan, use, start=False) for use in job.outputs), *last]


def _value(plan: DrivePlan, use: Use, *, start: bool) -> CallerValue:
    type_ = interface_type(use.format, use.count, use.subindex, plan.target)
    if not isinstance(type_, Elementary):
        return CallerValue(interface_row(plan, use, start=start), ())
    shown = {"REAL": "FloatingPoint", "LREAL": "FloatingPoint", "BOOL": "Bool"}.get(type_.name, "DEC")
    return CallerValue(interface_row(plan, use, start=start), (("", shown),))


def _view(plan: DrivePlan, job: DriveJob, label: str) -> dict[str, Any]:
    return {
        "job": _job(plan, job, label),
        "parts": [_TELEGRAMS, *(part.template for part in parts_of(job))],
        "names": engine_names(plan),
        "slots": plan.variant.slots,
    }


def _job_title(plan: DrivePlan, job: DriveJob) -> str:
    """One-line title of a job."""
    own = kind_called(job.kind).title
    text = _accesses(plan, job) if own is None else own(getattr(plan.entry(job), job.kind))
    return clean_title(comment_text(job.comment, plan.languages, plan.target, text))


def _accesses(plan: DrivePlan, job: DriveJob) -> str:
    """What is done with which parameters."""
    kind = kind_called(job.kind)
    verb = (kind.verb or job.kind.capitalize()) + (" and read back" if job.verified else "")
    uses = [use for use in job.uses if not isinstance(use.role, Poll | Verify | Mask)]
    then = ""
    if job.restores:
        uses, then = [use for use in uses if use.writes], ", or restore"
    if job.verified and job.poll is not None:
        uses, then = uses[:-1], f", then {job.then}{then}"
    subject = None if kind.subject is None else kind.subject(getattr(plan.entry(job), job.kind))
    return f"{verb} {subject or shortlist([use.label for use in uses], 4)}{then}"


_TELEGRAMS = "ds47/telegrams.scl.j2"
"""What every job does; it is in front of the parts of kinds."""
_RESULTS = (
    "per parameter: 0 good, 16#80nn error nn, 16#81ff type ff came, 16#FFFF no answer",
    "second error word, or number of values that came",
)


def _job(plan: DrivePlan, job: DriveJob, label: str) -> dict[str, Any]:
    """What the templates know of a job.

    ``times`` and ``statuses`` are its constants: name, number, text. ``open_end``: the last telegram is known only
    while it runs; ``counts_plainly``: telegrams are counted as they are sent; ``paced``: the job itself decides
    when its ticket starts; ``fails``: it may fail although every telegram was answered well.
    """
    where, parts = plan.target, parts_of(job)
    aligned = aligned_results(job)
    views = {part.name: part.view(plan, job) for part in parts}
    comments = [job.comment[lang] for lang in plan.languages if job.comment.get(lang)]
    ends = sorted((part.ends, part.template) for part in parts if part.ends)
    return {
        **dict.fromkeys(part.name for part in all_parts()),
        **views,
        "block": job.block,
        "clock_version": versions(plan)["TON_TIME"],
        "times": [row for part in parts for row in part.times(job)],
        "statuses": [
            (name, f"W#16#{value:04X}", text) for part in parts for name, value, text in part.words(views[part.name])
        ],
        "result": ends[0][1] if ends else _TELEGRAMS,
        "execute_text": _cyclic(job) or "a rising edge starts the job and takes the inputs over",
        "done_text": "stays until the next run" if job.cycle else "stays until execute falls, at least one call",
        "paced": job.waits or bool(job.cycle),
        "open_end": any(part.ends_early(job) for part in parts),
        "counts_plainly": not any(part.counts(job) for part in parts),
        "fails": any(part.fails for part in parts),
        "takes_inputs": not any(part.takes_inputs for part in parts),
        "diagnosis": job.diagnosis.name,
        "pinned": job.pinned,
        "permitted": len(job.permitted.ranges) if job.permitted is not None else 0,
        "many": len(job.telegrams) > 1,
        "telegram_count": len(job.telegrams),
        "title": label,
        "comment_lines": [one_line(text) for text in comments[1:] if encodable(text, where)],
        "labels": [_label(plan, job, use) for use in job.uses],
        "order": _order(job),
        "response_size": job.telegrams[0].response.size,
        "use_count": len(job.uses),
        "use_numbers": range(1, len(job.uses) + 1),
        "in_a_row": len(job.uses) > _UNROLLED,
        "inputs": [value.member for value in _inputs(plan, job)],
        "outputs": [value.member for value in _outputs(plan, job)],
        "telegrams": [_telegram(plan, job, telegram, parts, aligned=aligned) for telegram in job.telegrams],
        "input_copies": [
            copy
            for telegram in job.telegrams
            if not job.pinned
            for copy in copies(plan, job, telegram, aligned=aligned, response=False)
        ],
        "bit_inputs": list(bit_inputs(job)),
        "own_writes": _own_writes(plan, job) if job.pinned else [],
    }


def _order(job: DriveJob) -> list[tuple[str, str]]:
    """What goes with the requests and differs from the start values of the type."""
    standard = (
        ("timeout", job.timeout, 10_000, "L#"),
        ("pause", job.retry_pause, 200, "L#"),
        ("retries", job.retries, 40, ""),
    )
    found = [(name, f"{prefix}{value}") for name, value, default, prefix in standard if value != default]
    if job.once and job.poll is None and not job.in_steps:
        found.append(("once", "TRUE"))
    if job.pinned:
        found.append(("pinned", "TRUE"))
    return found


def _label(plan: DrivePlan, job: DriveJob, use: Use) -> str:
    """Line of the header: which index of ``errors`` belongs to which parameter."""
    if use.as_(Wait):
        title = f", {use.parameter.title}" if use.parameter.title else ""
        return one_line(f"{use.position}: step {use.step} waits for {condition_text(plan, job, use)}{title}")
    does = _DOES.get(type(use.role), "reads")
    does = f"step {use.step} {does}" if use.step else does
    text = f"{use.position}: {does} {use.label} {use.parameter.title}"
    return one_line(text)


_DOES = {
    Write: "writes", Compare: "compares", Verify: "reads back", Remember: "remembers", Recount: "reads again",
}  # fmt: skip

_UNROLLED = 2
"""Parameters of a telegram whose results are copied one by one: fewer bytes than a loop."""


def _single_bool(use: Use) -> bool:
    return use.format.name == "Boolean" and use.count == 1


def aligned_results(job: DriveJob) -> bool:
    """Every parameter lies whole in one telegram: its place there and its index in ``errors`` go in step."""
    return sum(len(telegram.parts) for telegram in job.telegrams) == len(job.uses)


def _asked_first(job: DriveJob, telegram: DriveTelegram) -> bool:
    """Whether the second telegram asks for nothing but what the first one asks for first."""
    first, *_ = job.telegrams[0].parts
    return telegram.number == 2 and [part.use.label for part in telegram.parts] == [first.use.label]


def _telegram(
    plan: DrivePlan, job: DriveJob, telegram: DriveTelegram, parts: Sequence[BlockParts], *, aligned: bool
) -> dict[str, Any]:
    """What the templates know of a telegram; ``closes``: it is behind the others, and asks what the first one asks."""
    first = telegram.parts[0].use.position
    closes = telegram.parts[0].use.as_(Recount) is not None
    blocks = [_block(index, part) for index, part in enumerate(telegram.parts, 1)]
    return {
        **{part.name: part.telegram(plan, job, telegram) for part in parts},
        "starts": telegram.writes and telegram.parts[0].use in job.saving,
        "polls": telegram.parts[0].use.as_(Poll) is not None,
        "step": telegram.step,
        "once": "TRUE" if telegram.once else "FALSE",
        "awaited": telegram.awaited,
        "closes": closes,
        "read_back": any(part.use.as_(Verify) for part in telegram.parts),
        "taken": f"{_way(job, telegram)}:" if _way(job, telegram) else "ELSE",
        "built": f"{_built(job, telegram)}:" if _way(job, telegram) else "ELSE",
        "merges": list(merges(job, telegram)),
        "keeps": not telegram.writes and not closes and not job.compares,
        "suffix": job.suffix(telegram),
        "request_type": telegram.request.type.name,
        "response_type": telegram.response.type.name,
        "request_length": len(telegram.request.data),
        "request_last": len(telegram.request.data) - 1,
        "drive_object": next(field.name for field in telegram.request.fields if field.role == "drive_object"),
        "response_last": telegram.response.size - 1,
        "positive_last": min(telegram.positive_length, telegram.response.size) - 1,
        "count": len(telegram.parts),
        "in_a_row": aligned and len(telegram.parts) > _UNROLLED,
        "use_shift": f" + {first - 1}" if first > 1 else "",
        "blocks": blocks,
        # a question that follows the one in which it was the first expects what is expected already
        "copies": copies(plan, job, telegram, aligned=aligned, response=True) if not job.whole else [],
        "expects": []
        if telegram.writes or (closes and _asked_first(job, telegram)) or telegram is _asked_before(job)
        else blocks,
    }


RETURNS = (4, 5, 6)
"""Telegrams of a job that restores: it asks what the drive has, writes old values back, asks again. They are no planned
ones: in a block that may save instead, what saves is counted behind them."""


def _way(job: DriveJob, telegram: DriveTelegram) -> int:
    """Under which number a block finds what belongs to a telegram; 0 for one that is sent again and again."""
    if telegram is job.telegrams[-1] and (job.poll is not None or job.rounds or job.waits):
        return 0
    return telegram.number + (len(RETURNS) if job.restores and telegram.number >= RETURNS[0] else 0)


def _built(job: DriveJob, telegram: DriveTelegram) -> str:
    """The telegrams that are built like a planned one: what is read back asks for the old values, too."""
    first, _, last = RETURNS
    again = f", {first}, {last}" if job.restores and telegram.number == first - 1 else ""
    return f"{_way(job, telegram)}{again}"


def _asked_before(job: DriveJob) -> DriveTelegram | None:
    """The question of a job that restores whose answer is like that to the old values."""
    return job.telegrams[RETURNS[0] - 2] if job.restores else None


def byte_array(data: bytes, *, v5: bool) -> str:
    """Start value of an array of bytes."""
    values = ", ".join(f"B#16#{byte:02X}" for byte in data)
    return values if v5 else f"[{values}]"


def _block(index: int, part: Part) -> dict[str, Any]:
    return {
        "index": index,
        "label": part.use.label if part.whole else f"{part.use.label} from index {part.subindex}",
        "use": part.use.position,
        "expected": f"DW#16#{0 if part.use.untyped else part.use.format.code:02X}{part.count:02X}00{part.size:02X}",
    }


def copies(
    plan: DrivePlan, job: DriveJob, telegram: DriveTelegram, *, aligned: bool, response: bool
) -> list[dict[str, Any]]:
    """Moves between the block's interface and the value members of the buffers of a telegram."""
    found: list[dict[str, Any]] = []
    wanted = job.compares
    if telegram.writes == response and not wanted:
        return found
    view = f"stat{'WantedView' if wanted else 'Response' if response else 'Request'}{job.suffix(telegram)}"
    blocks = {id(part): number for number, part in enumerate(telegram.parts, 1)}
    for field in telegram.response.fields if response or wanted else telegram.request.fields:
        if field.role != "value" or field.part is None or (not response and field.part.use.constant):
            continue
        if field.part.use in job.timed:
            continue
        copy = _copy(plan, field, field.part, f"{view}.{field.name}", response=response)
        result = f"diagnosis.errors[{field.part.use.position}]"
        if not aligned:
            result = f"unit.errors[{blocks[id(field.part)]}]"
        verifies = field.part.use.as_(Verify) is not None
        found.append({**copy, "result": result, "verifies": verifies})
    return found


_CELLS = {1: ("BYTE", "DBB", "DB"), 2: ("WORD", "DBW", "DW"), 4: ("DWORD", "DBD", "DD")}
"""Cells of a data block by size: type, and how TIA and STEP 7 V5 call them."""


def _own_writes(plan: DrivePlan, job: DriveJob) -> list[tuple[str, str]]:
    """Assignments that put the drive object and the inputs into a request that has its own data block."""
    mark = "" if plan.target.v5 else "#"
    found = []
    for field in job.telegrams[0].request.fields:
        if field.role == "drive_object":
            found.append((_cell(plan, field.offset, 1), f"{mark}driveObject"))
        if field.role != "value" or field.part is None or field.part.use.constant:
            continue
        name = f"{mark}{field.part.use.member}"
        type_: DataType = field.type
        low: int | None = None
        if isinstance(type_, ArrayType):
            low, type_ = type_.bounds[0][0], type_.element
        if not isinstance(type_, Elementary):
            continue
        size = type_.bits // 8
        for number in range(field.part.size // size):  # the interface has no pad behind an odd number of bytes
            source = name if low is None else f"{name}[{low + number}]"
            own = interface_type(field.part.use.format, field.part.use.count, field.part.use.subindex, plan.target)
            own = own.element if isinstance(own, ArrayType) else own  # several Booleans are bytes, one is a BOOL
            cell = _CELLS[size][0]
            given = own.name if isinstance(own, Elementary) else type_.name
            found.append((_cell(plan, field.offset + number * size, size), _as_cell(source, given, cell)))
    return found


def _cell(plan: DrivePlan, offset: int, size: int) -> str:
    _, tia, v5 = _CELLS[size]
    return f"requestDb.{v5}[{offset}]" if plan.target.v5 else f"#requestDb.%{tia}{offset}"


def _as_cell(source: str, type_: str, cell: str) -> str:
    """A value as the bytes that hold it."""
    if type_ == cell:
        return source
    if type_ == "BOOL":
        return f"WORD_TO_BYTE(INT_TO_WORD(BOOL_TO_INT({source})))"
    return f"{type_}_TO_{cell}({source})"


def _copy(plan: DrivePlan, field: DriveField, part: Part, member: str, *, response: bool) -> dict[str, Any]:
    """One move; ``shift`` is what the interface's index is ahead of the buffer's index in a split array."""
    own = part.use.member
    if part.use.recorded:
        mark = "" if plan.target.v5 else "#"
        own = f"records[{mark}{'statRecord' if response else 'recordNumber'}].{own}"
    view: dict[str, Any] = {"bool": _single_bool(part.use), "loop": False, "shift": ""}
    if isinstance(field.type, Elementary) and part.use.count > 1:
        own = f"{own}[{part.subindex}]"
    if view["bool"] and isinstance(field.type, Elementary):
        view["one"] = literal(field.type, b"\x01", v5=plan.target.v5)
        view["zero"] = literal(field.type, b"\x00", v5=plan.target.v5)
    if isinstance(field.type, ArrayType):
        low = field.type.bounds[0][0]
        bytewise = not part.use.format.is_string and element_type(part.use.format, plan.target) is None
        view["loop"] = True
        view["first"], view["last"] = low, low + (part.size if bytewise else part.count) - 1
        if bytewise and part.start:
            view["shift"] = f" + {part.start * part.use.format.size}"
    return {**view, "interface": own, "member": member, "response": response}
