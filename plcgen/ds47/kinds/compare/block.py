"""View of a job that compares: its list of deviations, and the answer that would be right."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from plcgen.build.members import fixed, plain
from plcgen.build.nouns import CallerValue, TypeBlock
from plcgen.build.spelling import type_words
from plcgen.ds47.plan.nouns import DeviationList, DriveJob, DrivePlan, DriveTelegram
from plcgen.ds47.views.parts import BlockParts
from plcgen.ds47.views.program import byte_array
from plcgen.ds47.wire.formats import Format, FormatKind, padded
from plcgen.ds47.wire.model import HEADER_SIZE

_ENTRY = (
    ("parameter", "DINT", "number of the parameter"),
    ("index", "DINT", "index, 0 without one"),
    ("wanted", "REAL", "what the drive should have"),
    ("found", "REAL", "what it has"),
    ("wantedBits", "DWORD", "what the drive should have, as it is on the wire"),
    ("foundBits", "DWORD", "what it has, as it is on the wire"),
)
_WATCHED = 8
"""Entries in the watch table."""


def deviation_values(plan: DrivePlan, job: DriveJob) -> Iterator[CallerValue]:
    """The list of deviations, how many there are, and whether there is none, at the block and in the control DB."""
    found = job.deviations
    if found is None:
        return
    words = type_words(tia=not plan.target.v5)
    type_ = f'{words["ARRAY"]}[1..{found.places}] {words["OF"]} "{found.type.name}"'
    shown = (("parameter", "DEC"), ("found", "FloatingPoint"))
    places = range(1, min(found.places, _WATCHED) + 1)
    watched = tuple((f"[{place}].{name}", format_) for place in places for name, format_ in shown)
    text = "values that deviate, empty places after them"
    yield CallerValue(plain(plan, found.member, type_, text), watched)
    text = "how many values deviate, those without a place too"
    yield CallerValue(plain(plan, found.count, words["INT"], text), (("", "DEC"),))
    yield CallerValue(plain(plan, found.equal, words["BOOL"], "no value deviates"), (("", "Bool"),))


def deviation_types(plan: DrivePlan, job: DriveJob) -> Iterator[TypeBlock]:
    """The type of an entry."""
    if job.deviations is not None:
        yield TypeBlock(job.deviations.type, fixed(plan, _ENTRY), job.comment)


def _list(job: DriveJob) -> DeviationList:
    assert job.deviations is not None  # of jobs that compare only
    return job.deviations


def deviations_view(plan: DrivePlan, job: DriveJob) -> dict[str, Any]:
    """What a block needs that compares; ``name`` and ``counted`` are what it fills while answers come."""
    found, many = _list(job), len(job.telegrams) > 1
    formats = [compared_view(plan, job, telegram) for telegram in job.telegrams]
    return {
        "type": found.type.name,
        "member": found.member,
        "count": found.count,
        "equal": found.equal,
        "places": found.places,
        "name": "statDeviations" if many else found.member,
        "counted": "statOthers" if many else "tempOthers",
        "by_size": any(one["by_size"] for one in formats),
        "by_format": any(one["by_format"] for one in formats),
    }


def compared_view(plan: DrivePlan, job: DriveJob, telegram: DriveTelegram) -> dict[str, Any]:
    """How the answer to a telegram is compared.

    ``sizes``: branches of the sizes of values in bytes, the largest last; ``kinds``: branches of how values become
    numbers; ``floats``: code of the format of those in floating point, 0 if there is none; ``more``: by then there may
    be more deviations than places.
    """
    sizes: dict[int, list[int]] = {}
    kinds: dict[str, list[int]] = {}
    for code, format_ in sorted({part.use.format.code: part.use.format for part in telegram.parts}.items()):
        sizes.setdefault(format_.size, []).append(code)
        kinds.setdefault(_kind(format_), []).append(code)
    compared = sum(part.count for one in job.telegrams[: telegram.number] for part in one.parts)
    return {
        "first": telegram is job.telegrams[0],
        "last": telegram is job.telegrams[-1],
        "last_part": len(telegram.parts) - 1,
        "by_size": len(sizes) > 1,
        "by_kind": len(kinds) > 1,
        "by_format": len(sizes) > 1 or len(kinds) > 1,
        "sizes": _branches(dict(sorted(sizes.items()))),
        "kinds": _branches(kinds),
        "floats": kinds.get("float", [0])[0],
        "size": min(sizes),
        "short": min(sizes) < 4,
        "odd": any(size % 2 for size in sizes),
        "more": compared > _list(job).places,
        "wanted": byte_array(right_answer(telegram), v5=plan.target.v5),
        "asks_for_inputs": any(not part.use.constant for part in telegram.parts),
    }


def _branches(cases: Mapping[Any, list[int]]) -> list[tuple[str, Any]]:
    """Labels of a CASE over codes with what each of them stands for; the last one is for all others."""
    *rows, (last, _) = cases.items()
    return [*((f"{', '.join(map(str, codes))}:", found) for found, codes in rows), ("ELSE", last)]


def _kind(format_: Format) -> str:
    if format_.kind is FormatKind.FLOAT:
        return "float"
    signed = format_.kind is FormatKind.SIGNED
    return f"signed{format_.size}" if signed else "unsigned4" if format_.size == 4 else "unsigned"


def right_answer(telegram: DriveTelegram) -> bytes:
    """The answer of a drive that has what it should have, without its header, as long as the longest answer."""
    found = bytes(HEADER_SIZE)
    for part in telegram.parts:
        found += bytes((part.use.format.code, part.count)) + part.data.ljust(padded(part.size), b"\0")
    return found.ljust(telegram.response.size, b"\0")


PARTS = (
    BlockParts(
        name="compare",
        precedence=60,
        has=lambda job: job.compares,
        members=frozenset({"deviations", "deviationcount", "equal"}),
        template="plcgen.ds47.kinds.compare:parts.scl.j2",
        view=deviations_view,
        telegram=compared_view,
        last_outputs=deviation_values,
        types=deviation_types,
    ),
)
