"""View of a job whose parameter is named at run time: its inputs, and one form more of what has come."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.build.members import assignments, plain
from plcgen.build.nouns import CallerValue, DataBlock
from plcgen.build.spelling import array_elements, declared_type, type_words
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.ds47.views.parts import BlockParts
from plcgen.ds47.words import SERVICE_WORDS
from plcgen.s7.types.data_types import ELEMENTARY, ArrayType

ROOM = 8
"""Bytes of an answer that are kept."""
NUMBERS = "first and last number of each range, ascending"


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


def written_values(plan: DrivePlan, job: DriveJob) -> Iterator[CallerValue]:
    """What is written, and whether anything may be."""
    words = type_words(tia=not plan.target.v5)
    for name, type_, shown, text in (
        ("enableWrite", "BOOL", "Bool", "TRUE: this instance may write; from the program, not from a panel"),
        ("write", "BOOL", "Bool", "TRUE: the start writes one value, FALSE: it reads"),
        ("writeFormat", "BYTE", "HEX", "type of the value: 02..08 or 41, 42, 43"),
        ("writeReal", "REAL", "FloatingPoint", "value of type 08, REAL"),
        ("writeDint", "DINT", "DEC", "value of types 02 to 06, integers"),
        ("writeDword", "DWORD", "HEX", "value of types 07 and 41 to 43, at the right"),
    ):
        if job.permitted is not None:
            yield CallerValue(plain(plan, name, words[type_], text), (("", shown),))


def number_tables(plan: DrivePlan) -> Iterator[DataBlock]:
    """The numbers that each service may write."""
    for job in plan.shapes:
        if job.permitted is not None:
            edges = [edge for pair in job.permitted.ranges for edge in pair]
            type_ = ArrayType(((1, len(edges)),), ELEMENTARY["DINT"])
            starts = array_elements(type_, b"".join(edge.to_bytes(4) for edge in edges), v5=plan.target.v5)
            row = plain(plan, "numbers", declared_type(type_, tia=not plan.target.v5), NUMBERS)
            rows = (row._replace(subs=tuple(starts)),)
            title = f"Numbers that {job.block.name} may write"
            yield DataBlock(job.permitted.db, title, rows, assignments(rows), job.comment)


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
        reserved=frozenset({"numbers"}),
        view=lambda _, job: {
            "room": ROOM,
            "value": job.uses[0].member,
            "writes": job.permitted is not None,
            "edges": 2 * len(job.permitted.ranges) if job.permitted else 0,
        },
        ends=7,
        words=lambda view: SERVICE_WORDS if view["writes"] else SERVICE_WORDS[:1],
        inputs=lambda plan, job: (*asked_values(plan, job), *written_values(plan, job)),
        arguments=lambda job: (("numbers", f'"{job.permitted.db.name}".numbers'),) if job.permitted else (),
        shared_data=number_tables,
        last_outputs=more_values,
    ),
)
