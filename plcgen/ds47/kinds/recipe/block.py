"""View of recipes: the type of a record, the data block with them, and how a job takes one over or gives it back."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, floor
from typing import Any

from plcgen.build.members import plain
from plcgen.build.nouns import CallerValue, DataBlock, MemberRow, StartAssignment, TypeBlock
from plcgen.build.spelling import literal, type_words
from plcgen.ds47.plan.access import Part, Use
from plcgen.ds47.plan.fields import interface_type
from plcgen.ds47.plan.nouns import DriveField, DriveJob, DrivePlan, DriveTelegram, PlannedRecipe
from plcgen.ds47.plan.types import element_type
from plcgen.ds47.views.parts import BlockParts
from plcgen.ds47.views.program import aligned_results, copies
from plcgen.ds47.views.rows import interface_row
from plcgen.ds47.wire.formats import FormatKind, integer_range, pack_values
from plcgen.ds47.words import RECIPE_WORDS
from plcgen.s7.layout.layout import layout_members
from plcgen.s7.types.data_types import ArrayType, DataType, Elementary, Member

LARGEST = 1.7976931348623157e308
"""Of the numbers that an LREAL has."""


def recipe_inputs(plan: DrivePlan, job: DriveJob) -> Iterator[CallerValue]:
    """Which record it is, at the block and in the control DB."""
    if job.recipe is not None:
        words = type_words(tia=not plan.target.v5)
        text = f"number of the record, 1 to {job.recipe.count}"
        yield CallerValue(plain(plan, "recordNumber", words["INT"], text, start="1"), (("", "DEC"),))


def recipe_values(plan: DrivePlan, job: DriveJob) -> Iterator[CallerValue]:
    """Which value of the record is outside its limits, at the block and in the control DB."""
    if job.recipe is not None and job.writes:
        type_ = type_words(tia=not plan.target.v5)["DINT"]
        text = "number of the first parameter that is outside its limits, 0: none"
        yield CallerValue(plain(plan, "failedParameter", type_, text), (("", "DEC"),))
        yield CallerValue(plain(plan, "failedIndex", type_, "its index, 0 without one"), (("", "DEC"),))


def recipe_types(plan: DrivePlan) -> Iterator[TypeBlock]:
    """The types of records: a member for each parameter."""
    for recipe in plan.recipes:
        types = [interface_type(use.format, use.count, use.subindex, plan.target) for use in recipe.uses]
        members = [Member(use.member, type_) for use, type_ in zip(recipe.uses, types, strict=True)]
        layout = layout_members(members, {})
        places = [entry for entry in layout.entries if entry.depth == 0]
        rows = [
            interface_row(plan, use, start=True)._replace(offset=place.byte, size=(place.size + 7) // 8)
            for use, place in zip(recipe.uses, places, strict=True)
        ]
        note = f"record n begins at byte (n - 1) x {layout.size} of DB{recipe.db.number}"
        yield TypeBlock(recipe.type, rows, recipe.comment, starts=True, notes=[note])


def recipe_data(plan: DrivePlan) -> Iterator[DataBlock]:
    """The data blocks with the records; a start value that the type does not have stands there."""
    for recipe in plan.recipes:
        words = type_words(tia=not plan.target.v5)
        type_ = f'{words["ARRAY"]}[1..{recipe.count}] {words["OF"]} "{recipe.type.name}"'
        starts = [list(_starts(plan, recipe, use)) for use in recipe.uses]
        expanded = [
            MemberRow(row.name, row.type, subs=tuple((path, value) for path, _, value, _ in found))
            for row, found in zip((interface_row(plan, use, start=False) for use in recipe.uses), starts, strict=True)
            if found
        ]
        row = plain(plan, "records", type_, "one of them is chosen by its number")
        assigned = [StartAssignment(name, value, text) for found in starts for _, name, value, text in found]
        title = f"Records of recipe {recipe.key}"
        members = (row._replace(expanded=tuple(expanded)),)
        yield DataBlock(recipe.db, title, members, assigned, recipe.comment)


def _starts(plan: DrivePlan, recipe: PlannedRecipe, use: Use) -> Iterator[tuple[str, str, str, str]]:
    """Start values of a member: path in a document, name in a source, literal, name of the record."""
    type_ = interface_type(use.format, use.count, use.subindex, plan.target)
    usual = bytes(len(use.data))
    if not isinstance(type_, ArrayType) or interface_row(plan, use, start=True).start:
        usual = use.data
    for number, (title, values) in enumerate(zip(recipe.names, recipe.values, strict=True), 1):
        for index, element, data, standard in _elements(type_, values[use.member], usual):
            if data != standard:
                path = f"{number}" if index is None else f"{number},{index}"
                name = f"records[{number}].{use.member}" + ("" if index is None else f"[{index}]")
                yield path, name, literal(element, data, v5=plan.target.v5), title


def _elements(type_: DataType, data: bytes, usual: bytes) -> Iterator[tuple[int | None, Elementary, bytes, bytes]]:
    if isinstance(type_, ArrayType) and isinstance(type_.element, Elementary):
        low, high = type_.bounds[0]
        step = len(data) // (high - low + 1)
        for index in range(low, high + 1):
            at = slice((index - low) * step, (index - low + 1) * step)
            yield index, type_.element, data[at], usual[at]
    elif isinstance(type_, Elementary):
        yield None, type_, data, usual


def _recipe(job: DriveJob) -> PlannedRecipe:
    assert job.recipe is not None  # of jobs with one only
    return job.recipe


def _stored(plan: DrivePlan, job: DriveJob, telegram: DriveTelegram) -> dict[str, Any]:
    """With the last answer the record gets all values at once."""
    last, aligned = telegram is job.telegrams[-1], aligned_results(job)
    each = [one for asked in job.telegrams for one in copies(plan, job, asked, aligned=aligned, response=True)]
    return {"stores": each if job.stores and last else []}


def recipe_view(plan: DrivePlan, job: DriveJob) -> dict[str, Any]:
    """What a block needs that takes a record over or gives it back; ``checks`` from the last value to the first.

    Until one of them has an index, the index is 0 as it stands.
    """
    recipe = _recipe(job)
    checks = [
        check
        for telegram in job.telegrams
        for field in telegram.request.fields
        if job.writes and field.role == "value" and field.part is not None and field.part.use.recorded
        if (check := _check(plan, field, field.part, f"statRequest{job.suffix(telegram)}.{field.name}"))
    ]
    return {
        "type": recipe.type.name,
        "db": recipe.db.name,
        "count": recipe.count,
        "checks": [
            {**check, "tells_index": any(each["loop"] or each["index"] for each in checks[-number:])}
            for number, check in enumerate(reversed(checks), 1)
        ],
        "stores": job.stores,
        "writes": job.writes,
    }


def _check(plan: DrivePlan, field: DriveField, part: Part, member: str) -> dict[str, Any] | None:
    """How the values of a part are held against their limits; None if every value is allowed."""
    use = part.use
    element = element_type(use.format, plan.target)
    limits = _limits(use)
    if element is None or limits is None:
        return None
    array, mark = isinstance(field.type, ArrayType), "" if plan.target.v5 else "#"
    value = f"{mark}{member}[{mark}tempIndex]" if array else f"{mark}{member}"
    shown = _read_as(use, element, value)
    compared = ((sign, limit) for sign, limit in zip((">=", "<="), limits, strict=True) if limit is not None)
    inside = [f"{shown} {sign} {_comparable(use, element, limit, plan)}" for sign, limit in compared]
    if element.name == "REAL" and None in limits:
        inside.append(f"(REAL_TO_DWORD({value}) AND DW#16#7F800000) <> DW#16#7F800000")
    first = field.type.bounds[0][0] if isinstance(field.type, ArrayType) else part.subindex
    return {
        "label": use.label,
        "number": use.parameter.pnu,
        "loop": array,
        "first": first,
        "last": first + part.count - 1,
        "index": part.subindex,
        "shift": f" + L#{part.subindex - first}" if part.subindex != first else "",
        "inside": " AND ".join(inside),
    }


def _limits(use: Use) -> tuple[float | None, float | None] | None:
    """The lowest and the highest allowed value, None where the type has no other; None if it has all of them."""
    low, high = use.parameter.minimum, use.parameter.maximum
    if use.format.kind is FormatKind.FLOAT:
        least, most = (None, None) if use.format.size == 4 else (-LARGEST, LARGEST)
        return least if low is None else low, most if high is None else high
    range_ = integer_range(use.format)
    if range_ is None:
        return None
    least = ceil(low) if low is not None and ceil(low) > range_[0] else None
    most = floor(high) if high is not None and floor(high) < range_[1] else None
    return None if least is None and most is None else (least, most)


def _comparable(use: Use, element: Elementary, limit: float, plan: DrivePlan) -> str:
    """A limit as what :func:`_read_as` compares it with."""
    v5 = plan.target.v5
    if element.name == "BYTE":
        return str(int(limit) + (128 if use.format.kind is FormatKind.SIGNED else 0))
    if element.name == "WORD":
        return f"L#{int(limit)}"
    if element.name == "DWORD":
        return f"L#{int(limit) - 0x80000000}"
    data = pack_values(use.format, [limit if use.format.kind is FormatKind.FLOAT else int(limit)])
    return literal(element, data, v5=v5)


def _read_as(use: Use, element: Elementary, value: str) -> str:
    """An expression that has an order: BYTE, WORD and DWORD of S7-300/400 have none."""
    if element.name == "BYTE":
        moved = f"{value} XOR B#16#80" if use.format.kind is FormatKind.SIGNED else value
        return f"WORD_TO_INT(BYTE_TO_WORD({moved}))"
    if element.name == "WORD":
        return f"DWORD_TO_DINT(WORD_TO_DWORD({value}))"
    if element.name == "DWORD":
        return f"DWORD_TO_DINT({value} XOR DW#16#80000000)"
    return value


PARTS = (
    BlockParts(
        name="recipe",
        precedence=80,
        has=lambda job: job.recipe is not None,
        reserved=frozenset({"records"}),
        members=frozenset({"recordnumber", "failedindex"}),
        template="plcgen.ds47.kinds.recipe:parts.scl.j2",
        view=recipe_view,
        telegram=_stored,
        words=lambda view: (row for row in RECIPE_WORDS if row[0] != "STATUS_OUTSIDE" or view["checks"]),
        inputs=recipe_inputs,
        outputs=recipe_values,
        arguments=lambda job: (("records", f'"{_recipe(job).db.name}".records'),),
        takes_inputs=True,
        shared_types=recipe_types,
        shared_data=recipe_data,
    ),
)
