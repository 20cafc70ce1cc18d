"""View of a job that lists messages: its list, the type of an entry, and where the columns of a buffer come from."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from plcgen.build.members import plain
from plcgen.build.nouns import CallerValue, TypeBlock
from plcgen.build.spelling import declared_type, literal, one_line, type_words
from plcgen.ds47.kinds.messages import PLACES
from plcgen.ds47.plan.access import Column, Part, Use
from plcgen.ds47.plan.fields import interface_type
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan, DriveTelegram
from plcgen.ds47.plan.pack import BLOCK_HEADER
from plcgen.ds47.views.parts import BlockParts
from plcgen.ds47.wire.model import HEADER_SIZE
from plcgen.ds47.words import MESSAGE_WORDS
from plcgen.s7.types.data_types import Elementary
from plcgen.s7.types.names import camel_case


def list_values(plan: DrivePlan, job: DriveJob) -> Iterator[CallerValue]:
    """The list of messages and how many are present, at the block and in the control DB."""
    found = job.messages
    if found is None:
        return
    words = type_words(tia=not plan.target.v5)
    type_ = f'{words["ARRAY"]}[1..{found.places}] {words["OF"]} "{found.type.name}"'
    text = "the latest first, empty places after them"
    if found.places > PLACES:
        text = f"{PLACES} places for those that are present, {PLACES} for each group of the history; in each {text}"
    watched = tuple((f"[{place}].code", "DEC") for place in range(1, PLACES + 1))
    yield CallerValue(plain(plan, found.member, type_, text), watched)
    yield CallerValue(plain(plan, found.count, words["INT"], f"how many {found.member} are present"), (("", "DEC"),))


def entry_types(plan: DrivePlan, job: DriveJob) -> Iterator[TypeBlock]:
    """The type of a message: a member for each column."""
    if job.messages is not None:
        rows = [
            plain(plan, camel_case(column.name), _column_type(plan, use), one_line(_column_text(use)))
            for use in job.uses
            if (column := use.as_(Column)) and column.group == 0
        ]
        yield TypeBlock(job.messages.type, rows, job.comment)


def _column_type(plan: DrivePlan, use: Use) -> str:
    return declared_type(interface_type(use.format, 1, 0, plan.target), tia=not plan.target.v5)


def _column_text(use: Use) -> str:
    unit = f" [{use.parameter.unit}]" if use.parameter.unit else ""
    return f"r{use.parameter.pnu:04d} {use.parameter.title}{unit}"


def messages_view(plan: DrivePlan, job: DriveJob) -> dict[str, Any]:
    """What a block needs that lists messages: words, where the counter lies, for each group where its columns do."""
    found = job.messages
    assert found is not None  # of such jobs only
    views = {part.use.position: _view_of(telegram, part) for telegram in job.telegrams for part in telegram.parts}
    first = HEADER_SIZE + BLOCK_HEADER
    counted = job.uses[0].as_(Column) is None
    return {
        "member": found.member,
        "count": found.count,
        "bytes": range(first, first + job.uses[0].format.size) if counted else [],
        "codes": [] if counted else list(_codes(job)),
        "last": len(job.telegrams) * found.settings.tries,
        "groups": [
            {
                "place": PLACES * group,
                "last": PLACES * group + PLACES,
                "indexes": _indexes(group, latest_last=latest_last),
                "columns": columns,
                "code": next(column for column in columns if column["name"] == "code"),
            }
            for group, latest_last in enumerate(found.settings.latest_last)
            if (
                columns := [
                    _column(plan, use, column, views)
                    for use in job.uses
                    if (column := use.as_(Column)) and column.group == group
                ]
            )
        ],
    }


def _codes(job: DriveJob) -> Iterator[dict[str, Any]]:
    """Where the codes of each group lie in the last answer, and where in the answer that is kept."""
    kept = {
        part.use.place: (telegram, _offset(telegram, part))
        for telegram in job.telegrams[:-1]
        for part in telegram.parts
    }
    for part in job.telegrams[-1].parts:
        telegram, offset = kept[part.use.place]
        yield {
            "again": _offset(job.telegrams[-1], part),
            "kept": f"statResponseBytes{job.suffix(telegram)}",
            "offset": offset,
            "last": part.size - 1,
        }


def _offset(telegram: DriveTelegram, part: Part) -> int:
    return next(field.offset for field in telegram.response.fields if field.role == "value" and field.part is part)


def _column(plan: DrivePlan, use: Use, column: Column, views: dict[int, str]) -> dict[str, str]:
    return {"name": camel_case(column.name), "view": views[use.position], "zero": _zero(plan, use)}


def _view_of(telegram: DriveTelegram, part: Part) -> str:
    name = next(field.name for field in telegram.response.fields if field.role == "value" and field.part is part)
    return f"statResponse{telegram.number}.{name}"


def _indexes(group: int, *, latest_last: bool) -> str:
    """The indexes of a group from the latest message to the oldest."""
    first, last = PLACES * group, PLACES * group + PLACES - 1
    return f"{last} TO {first} BY -1" if latest_last else f"{first} TO {last}"


def _zero(plan: DrivePlan, use: Use) -> str:
    type_ = interface_type(use.format, 1, 0, plan.target)
    return literal(type_, bytes(use.format.size), v5=plan.target.v5) if isinstance(type_, Elementary) else "0"


PARTS = (
    BlockParts(
        name="messages",
        precedence=50,
        has=lambda job: job.messages is not None,
        template="plcgen.ds47.kinds.messages:parts.scl.j2",
        view=messages_view,
        ends=6,
        words=lambda _: MESSAGE_WORDS,
        last_outputs=list_values,
        fails=True,
        ends_early=lambda _: True,
        counts=lambda _: True,
        types=entry_types,
    ),
)
