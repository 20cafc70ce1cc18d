"""The parts of IMPORT.md about drives, line by line, and what the manifest says of jobs, stated a second time."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from plcgen.ds47.plan.access import Use
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan, PlannedDrive
from plcgen.ds47.proof.wording.grounds import Stated, service_numbers
from plcgen.ds47.proof.wording.naming import labels, same_number
from plcgen.ds47.wire.formats import unpack_values
from plcgen.oracles.spec.ds47.signing import SAFETY
from plcgen.project.target import Target
from plcgen.proof.folder import plain
from plcgen.proof.wording.languages import title_in
from plcgen.proof.wording.model import GuideLine
from plcgen.s7.types.data_types import Elementary

OUTPUT, RECORD_47 = 0x8000, 47
"""Bit 15 of the ID of an output address, and of the data records of PROFINET; the data record of PROFIBUS."""
MOST_VALUES = 4
PARAMETER = 4
"""Lines of the panel's table up to the one of the parameter; what is written stands behind them."""
_OCTET = re.compile(r"(?:B#)?16#[0-9A-F]{2}")
_SOURCE = re.compile(r"r(?P<number>\d+)\.(?P<index>\d+)(?:@(?P<object>\d+))?")
SELF = 0x3F
"""The drive object that is addressed, in bits 15..10 of a BICO value (G110M operating instructions p. 198)."""


@cache
def sentences() -> Mapping[str, Any]:
    """Texts by what a block is and the name of a member, and the lines of the guide."""
    return tomllib.loads((Path(__file__).parent / "sentences.toml").read_text("utf-8"))


def _said(part: str, **words: object) -> list[str]:
    return [line.format(**words) for line in sentences()["guide"][part]]


def guide_before(plan: DrivePlan) -> list[GuideLine]:
    """Which identifier leads to which drive; numbers of data blocks that lie outside the instances."""
    asked = {job.drive.key for job in plan.jobs}
    found = _said("identifiers", what="address" if plan.target.classic else "identifier")
    found += [_drive(drive, classic=plan.target.classic) for drive in plan.drives if drive.key in asked]
    used = {drive.record_index for drive in plan.drives if drive.key in asked}
    found += [] if plan.target.classic else _said("constant")
    found += _said("record_47") if RECORD_47 in used and not plan.target.classic else []
    found += _errors(plan.target)
    named = sentences()["guide"]["named"] if any(job.trigger.items() for job in plan.jobs) else ""
    controls = ", ".join(f"`{one.control.name}`" for one in plan.callers)
    found += [line + named for line in _said("jobs", controls=controls)]
    found += [] if plan.target.v5 else _said("by_name")
    if served := [job for job in plan.jobs if job.serves]:
        jobs = ", ".join(f'`"{job.caller.control.name}".{job.member}`' for job in served)
        said = _said("panel", jobs=jobs)
        more = _said("panel_writes") if any(job.permitted is not None for job in served) else []
        found += [*said[:PARAMETER], *more, *said[PARAMETER:]]
    numbered = [
        buffer.db for job in plan.shapes for one in job.telegrams for buffer in one.buffers if buffer.db is not None
    ]
    if numbered:
        found += [" ".join([*_said("numbers"), *_said("v5" if plan.target.v5 else "tia")]), *_said("buffers")]
        found += [f"| {db.name} | DB{db.number} |" for db in numbered]
    return [GuideLine(text) for text in found]


def _errors(target: Target) -> list[str]:
    """Error OBs of the family; CPUs of the S7-300 without PROFINET have no OB83."""
    if target.t15:
        return _said(f"errors_{target.family}")
    without = target.family == "s7-300" and target.cpu is not None and "PN" not in target.cpu.name
    return [line for line in _said("errors") if not (without and line.startswith("| OB83 "))]


def _drive(drive: PlannedDrive, *, classic: bool) -> str:
    address = drive.id_value & ~OUTPUT if classic else drive.id_value
    name = drive.id_name or f"{address}{', output' if classic and drive.id_value & OUTPUT else ''}"
    index = f"16#{drive.record_index:X}" if drive.record_index >= OUTPUT else drive.record_index
    where = "classic" if classic else "profibus" if drive.record_index == RECORD_47 else "profinet"
    text = sentences()["guide"][where].format(object=drive.drive_object)
    return f"| {drive.key} | `{name}` | {drive.drive_object} | {index} | {text} |"


def behind(plan: DrivePlan, stated: Stated) -> list[GuideLine]:
    """What the blocks write: a row for every parameter of every telegram that is a change, for each drive."""
    rows = [(job, use) for job in plan.jobs for use in job.own if use.writes]
    services = [
        line for job in plan.jobs if job.permitted for line in _permitted(plan, stated, job, job.permitted.db.name)
    ]
    if not rows and not services:
        return []
    found = [*map(GuideLine, _said("writes")), *(_written(plan, stated, job, use) for job, use in rows), *services]
    for job, use in rows:
        if use.parameter.pnu in SAFETY:
            what = {"block": job.block.name, "parameter": labels(job)[use.position], "drive": job.drive.key}
            found += map(GuideLine, _said("safety", **what))
    return [*found, *map(GuideLine, _said("lost"))]


def _permitted(plan: DrivePlan, stated: Stated, job: DriveJob, table: str) -> Iterator[GuideLine]:
    """What a service may write, and what the spec names of it, with why that asks and who answers for it."""
    numbers, named = service_numbers(plan, stated, job)
    front, notes = f"| {job.block.name} | {job.drive.key}", sentences()["guide"]["service"]
    yield GuideLine(plain(f"{front} | {len(numbers)} numbers | those of {table} | an input | {notes} |"))
    for number, reason in sorted(named.items()):
        danger = next(stated.danger(plan, job, number), f"signed off: {reason}")
        yield GuideLine(plain(f"{front} | P{number} | named by the spec | an input | {danger} |"))


def _written(plan: DrivePlan, stated: Stated, job: DriveJob, use: Use) -> GuideLine:
    title = use.parameter.title
    fronts = [
        plain(f"| {job.block.name} | {job.drive.key} | {labels(job)[use.position]} | {one} |")
        for one in (title, title_in(plan.languages[0], title))
    ]
    end = plain(f"| {'; '.join(_notes(plan, stated, job, use))} |")

    def accepts(text: str) -> bool:
        front = next((one for one in fronts if text.startswith(one)), None)
        inside = text.removeprefix(front or "").removesuffix(end).strip()
        return front is not None and text.endswith(end) and says_value(job, use, inside)

    return GuideLine(f"{fronts[0]} {_value(job, use)} {end}", accepts)


def _value(job: DriveJob, use: Use) -> str:
    """What is written as a person reads it, in place of the literals of the target."""
    if job.recipe is not None and use.recorded:
        return f"record of {job.recipe.db.name}"
    if use in job.timed:
        return "input, made of the time at utc"
    if use.bits:
        return "; ".join(f"bit {one.bit} = {int(any(one.data))}" for one in use.bits)
    values = unpack_values(use.format, use.count, use.data)[:MOST_VALUES]
    text = ", ".join(f"{value:.7g}" if isinstance(value, float) else str(value) for value in values)
    return text if use.constant else f"input, {text} if nothing is connected"


def _notes(plan: DrivePlan, stated: Stated, job: DriveJob, use: Use) -> Iterator[str]:
    number = use.parameter.pnu
    yield from stated.danger(plan, job, number)
    if use.bits:
        yield "all other bits as they are read in front of the write"
    restores = plan.entry(job).on_error
    if restores is not None and use not in job.saving:
        signed = f", too; signed off: {restores.reason}"
        runs = "restored if the job fails and the drive does not run"
        yield f"restored while the drive runs{signed}" if restores.reason else runs
    if use.constant and not use.bits and job.pinned:
        yield _held(job, use)
    grade = use.parameter.grades.get("type", "read")
    if grade != "read":
        yield f"type {grade}, not read in a manual"


def _held(job: DriveJob, use: Use) -> str:
    """The member of the request that has the value, by its first byte and its width."""
    for telegram in job.telegrams:
        request = telegram.request
        for field in request.fields:
            if field.role == "value" and field.part is not None and field.part.use.position == use.position:
                letter = {1: "B", 2: "W", 4: "D"}.get(field.size, "B") if isinstance(field.type, Elementary) else "B"
                at, name = f"DB{request.home.number}.DB{letter}{field.offset}", request.db.name if request.db else ""
                return f"start value. A run sends what {name}.{field.name} ({at}) holds"
    return ""


def says_value(job: DriveJob, use: Use, text: str) -> bool:
    """Whether a cell names what is written: constants, the start values of an input, or where else they come from."""
    if job.recipe is not None and use.recorded:
        return text == f"record of {job.recipe.db.name}"
    if use in job.timed:
        return text == "input, made of the time at utc"
    if use.bits:
        return text == "; ".join(map(_bit, use.bits))
    if not use.constant:
        if not (text.startswith("input, ") and text.endswith(" if nothing is connected")):
            return False
        text = text.removeprefix("input, ").removesuffix(" if nothing is connected")
    return _all_values(use, text)


def _bit(one: Use) -> str:
    value = int(any(one.data))
    return (
        f"bit {one.bit} = {value}"
        if one.constant
        else f"bit {one.bit} = input {one.member}, {value} if nothing is connected"
    )


def _all_values(use: Use, text: str) -> bool:
    """The first four values, and two points for more; octets in hexadecimal digits."""
    if re.fullmatch(r"[0-9a-f]{2}(?: [0-9a-f]{2})*", text) and bytes.fromhex(text) == use.data:
        return True
    shown = text.removesuffix(", ..").split(", ") if not use.format.is_string else _letters(text)
    step = 1 if all(map(_OCTET.fullmatch, shown)) else max(1, use.format.size)  # what has no type here is octets
    pieces = [use.data[at : at + step] for at in range(0, len(use.data), step)]
    if step == 1 and use.format.size > 1:
        return _as_many(shown, pieces, text) and all(
            int(said.rpartition("#")[2], 16) == piece[0] for said, piece in zip(shown, pieces, strict=False)
        )
    if not _as_many(shown, pieces, text):
        return False
    return all(_one_value(use, said, piece) for said, piece in zip(shown, pieces, strict=False))


def _as_many(shown: Sequence[str], pieces: Sequence[bytes], text: str) -> bool:
    return len(shown) == min(len(pieces), MOST_VALUES) and text.endswith(", ..") == (len(pieces) > MOST_VALUES)


def _letters(text: str) -> list[str]:
    return re.findall(r"(?:'(?:\$.|[^'])*'|[^,\s]+)(?=, |$)", text.removesuffix(", .."))


def _one_value(use: Use, said: str, piece: bytes) -> bool:
    if use.sources:
        found = _SOURCE.fullmatch(said)
        if found is None:
            return False
        value = int(found["number"]) << 16 | int(found["object"] or SELF) << 10 | int(found["index"])
        return value == int.from_bytes(piece)
    if said.startswith("'"):
        return len(piece) == 1 and said[1:-1].encode("latin-1", "replace").endswith(piece)
    return same_number(said, use, piece)


def listed_job(job: DriveJob, sizes: Sequence[tuple[int, int]]) -> dict[str, object]:
    """A job in the manifest: its telegrams as they lie on disk, and how long their answers are."""
    telegrams = []
    for telegram, (good, longest) in zip(job.telegrams, sizes, strict=True):
        found: dict[str, object] = {"request": telegram.request.data.hex(" ").upper()}
        if telegram.request.db is not None and telegram.response.db is not None:
            found |= {
                "request_db": f"DB{telegram.request.db.number}",
                "response_db": f"DB{telegram.response.db.number}",
            }
        telegrams.append({**found, "positive_bytes": good, "longest_bytes": longest})
    return {"job": job.key, "drive": job.drive.key, "block": job.block.name, "telegrams": telegrams}
