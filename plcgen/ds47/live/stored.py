"""Data blocks that hold no telegram, against those in a CPU: commands and results, units, records of recipes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from plcgen.base.diagnostics.counting import quantity
from plcgen.build.engine import emit
from plcgen.build.environment import render_all
from plcgen.ds47.live.comparison import EQUAL, TOLD, LiveRow, read_stored
from plcgen.ds47.live.connection import Reader
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.project.nouns import BlockRef, Project
from plcgen.s7.layout.image import image
from plcgen.s7.read.blocks import read_texts
from plcgen.s7.read.text import decode_source


def stored(plan: DrivePlan) -> tuple[BlockRef, ...]:
    """Those data blocks, in the order in which they are made. Their numbers are plcgen's, not the spec's."""
    units = (unit.db for unit in plan.units)
    recipes = (recipe.db for recipe in plan.recipes)
    controls = (caller.control for caller in plan.callers)
    return (plan.engine.gate_db, *units, *recipes, *controls)


def compare_stored(project: Project, plan: DrivePlan, reader: Reader) -> Iterator[LiveRow]:
    """Length of each; of recipes it is told whether the records are still those of the spec, which jobs may change."""
    images = _images(project, {block.name for block in stored(plan)})
    recipes = {recipe.db.name for recipe in plan.recipes}
    for block in stored(plan):
        wanted = images[block.name]
        name = f'DB{block.number} "{block.name}"'
        length, data = read_stored(name, block.number, len(wanted), reader)
        yield length
        if data and block.name in recipes:
            differ = sum(one != other for one, other in zip(wanted, data, strict=True))
            found = quantity(differ, "byte differs", "bytes differ") if differ else "start values"
            yield LiveRow(name, "records", "start values", found, TOLD if differ else EQUAL)


def _images(project: Project, names: set[str]) -> dict[str, bytes]:
    """Start values of data blocks by name, from the files that would be generated."""
    documents = (replace(one, twins=None) for one in emit(project) if one.path.startswith(("udt/", "db/")))
    texts = ((file.path, decode_source(file.data, file.path)) for file in render_all(documents))
    sources = read_texts((path, text) for path, text in texts if isinstance(text, str))
    found = (one.block for one in sources.blocks if one.block.name in names)
    return {block.name: bytes(image(block, sources.types)) for block in found}
