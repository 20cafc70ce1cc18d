"""DriveJobs as it is delivered: a structure for each job, no job started, inputs with the values of the spec.

Signals and their types as docs/generated-code.md has them; values are compared as bytes, which are the same in the
telegram and in the CPU.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

from plcgen.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.diagnostics.counting import quantity
from plcgen.input.files import read_bounded
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.folder import Folder, table_rows
from plcgen.proof.rig import Spot
from plcgen.protocols.ds47.plan.nouns import DriveJob, DrivePlan, PlannedRecipe, Use
from plcgen.protocols.ds47.proof import clocked, listed
from plcgen.protocols.ds47.proof.recorded import NUMBER, recipe_signals
from plcgen.protocols.ds47.proof.restored import CAUSE
from plcgen.protocols.ds47.proof.stepped import FAILED
from plcgen.protocols.ds47.wire import formats
from plcgen.s7.image import image
from plcgen.s7.layout import Layout, layout_block, locate
from plcgen.s7.literals import LiteralError
from plcgen.s7.types import Elementary

MAX_BYTES = 16 * 1024 * 1024
"""What divides the cells of a table."""
SIGNALS = {"execute": "BOOL", "busy": "BOOL", "done": "BOOL", "error": "BOOL", "status": "WORD"}


def check_commands(plan: DrivePlan, folder: Folder) -> Iterator[Check]:
    """One check of each control DB, in the text source; its document is held against it elsewhere."""
    for caller in plan.callers if plan.jobs else ():
        yield from _check_control(caller.control.name, [job for job in plan.jobs if job.caller is caller], folder)

    for recipe in plan.recipes:
        yield from _check_records(recipe, folder)


def _check_records(recipe: PlannedRecipe, folder: Folder) -> Iterator[Check]:
    """Every record as delivered: the values of the spec."""
    block = folder.text.get(recipe.db.name.upper())
    if block is None:
        return  # what is missing is told elsewhere
    problems = []
    try:
        layout, start = layout_block(block, folder.text), bytes(image(block, folder.text))
        for number, values in enumerate(recipe.values, 1):
            for use in recipe.uses:
                path = f"records[{number}].{use.member}"
                found = Spot.of(layout, path).bytes(bytearray(start), len(values[use.member]))
                if found != values[use.member]:
                    said = f"the spec says {values[use.member].hex(' ').upper()}"
                    problems.append(f"{path} starts with {found.hex(' ').upper()}, {said}")
    except (DiagnosticError, LiteralError, KeyError) as problem:
        problems = [str(problem)]
    yield _verdict(recipe.db.name, f"{recipe.count} records", problems, "every record as in the spec", folder)


def _check_control(name: str, jobs: list[DriveJob], folder: Folder) -> Iterator[Check]:
    block = folder.text.get(name.upper())
    if block is None:
        return  # what is missing is told elsewhere
    try:
        layout, start = layout_block(block, folder.text), bytes(image(block, folder.text))
        members = _members(layout)
        problems = [p for job in jobs for p in _job(job, layout, start, members.get(job.member, set()))]
        expected = {f"{job.member}.{use.member}" for job in jobs for use in job.inputs}
        expected |= {f"{job.member}.{NUMBER}" for job in jobs if job.recipe is not None}
        problems += [
            f"{entry.path} has the start value {entry.member.start}"
            for entry in layout.entries
            if entry.member.start is not None and entry.path.replace('"', "").partition("[")[0] not in expected
        ]
    except (DiagnosticError, LiteralError) as problem:
        problems = [str(problem)]
    yield _verdict(name, quantity(len(jobs), "job"), problems, "inputs as in the spec, no job started", folder)


def _verdict(name: str, figures: str, problems: list[str], good: str, folder: Folder) -> Check:
    if problems:
        found = Diagnostic("PG614", f'"{name}": {problems[0]}', folder.place(name))
        return Check("commands", f'"{name}"', "", Outcome.ERROR, problems[0], found)
    return Check("commands", f'"{name}"', figures, Outcome.OK, good)


def check_guide(plan: DrivePlan, folder: Folder) -> Iterator[Check]:
    """What IMPORT.md says that the blocks write: every value of the spec, and no other."""
    wanted = {(job.block.name, job.drive.key, use.label): use for job in plan.jobs for use in job.uses if use.writes}
    path = folder.path / "IMPORT.md"
    try:
        text = read_bounded(path, MAX_BYTES).decode("utf-8", "replace").replace("\r\n", "\n")
    except OSError:
        return  # told as missing
    below = text.partition("\n## What these blocks write\n")[2]
    rows = list(table_rows(below))[1:]
    found = {(row[0], row[1], row[2]): row[4] for row in rows if len(row) == 6}
    problems = [f"{key[0]} writes {key[2]} of {key[1]}: it is not listed" for key in wanted if key not in found]
    problems += [f"{key[0]} does not write {key[2]} of {key[1]}" for key in found if key not in wanted]
    problems += [
        f"{key[0]} writes {key[2]} = {value}, the spec says otherwise"
        for key, value in found.items()
        if key in wanted and not _said(wanted[key], value)
    ]
    if problems:
        problem = Diagnostic("PG614", problems[0], Span(str(path)))
        yield Check("guide", "IMPORT.md", "", Outcome.ERROR, problems[0], problem)
    elif wanted:
        yield Check("guide", "IMPORT.md", quantity(len(wanted), "value"), Outcome.OK, "lists what is written")


def _said(use: Use, text: str) -> bool:
    """Whether a text names the value of a use; values that are no single number are not compared."""
    if use.recorded:
        return text.startswith("record of ")
    if use.bits:
        return text == "; ".join(
            f"bit {one.bit} = {any(one.data):d}"
            if one.constant
            else f"bit {one.bit} = input {one.member}, {any(one.data):d} if nothing is connected"
            for one in use.bits
        )
    if text.startswith("input, ") == use.constant:
        return False
    if use.count != 1 or use.format.is_string or use.sources:
        return True
    if digits := "".join(re.findall(r"16#([0-9A-F]+)", text)):
        return use.data.hex().upper().startswith(digits)  # a long one is cut short
    value = formats.unpack_values(use.format, 1, use.data)[0]
    number = re.search(r"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?", text)
    if number is None or isinstance(value, str | bytes | bool):
        return True
    return math.isclose(float(number[0]), value, rel_tol=1e-6)


def _members(layout: Layout) -> dict[str, set[str]]:
    """Members of every structure."""
    found: dict[str, set[str]] = {}
    for entry in layout.entries:
        if entry.depth == 1:
            above, _, name = entry.path.replace('"', "").partition(".")
            found.setdefault(above, set()).add(name)
    return found


def _job(job: DriveJob, layout: Layout, start: bytes, found: set[str]) -> Iterator[str]:
    """What is wrong with the structure of a job."""
    flags = {name for name, _ in job.trigger.items()}
    values = {*clocked.inputs(job), *(use.member for use in job.outputs)}
    values |= {*(FAILED if job.in_steps else ()), *recipe_signals(job)}
    values |= {CAUSE} if job.restores else set()
    values |= {path.partition("[")[0] for path in listed.paths(job)}
    wanted = {name for name in SIGNALS if name not in flags} | values
    prefix = f"{job.member}."
    for name in sorted(wanted ^ found):
        yield f"{prefix}{name} {'is missing' if name in wanted else 'is not a member of the job'}"
    types = SIGNALS if job.clock is None else {**SIGNALS, clocked.TIME: job.clock.name}
    for name in sorted(wanted & found & set(types) - {use.member for use in (*job.inputs, *job.outputs)}):
        entry = locate(layout, f"{prefix}{name}")
        if not isinstance(entry.type, Elementary) or entry.type.name != types[name]:
            yield f"{prefix}{name} is not of type {types[name]}"
    for use in job.inputs:
        if use.member in found:
            entry = locate(layout, f"{prefix}{use.member}")
            held = start[entry.byte : entry.byte + len(use.data)]
            if entry.size == 1:
                held = bytes((held[0] >> entry.bit & 1,))
            if held != use.data:
                said = f"the spec says {use.data.hex(' ').upper()}"
                yield f"{prefix}{use.member} starts with {held.hex(' ').upper()}, {said}"
