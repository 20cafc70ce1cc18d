"""What a panel needs of the blocks that a spec becomes: every member of their data blocks by name and address."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

from plcgen.s7.read.text import parse_source
from plcgen.s7.tables.tables import PanelTag, panel_tags

if TYPE_CHECKING:
    from plcgen.project.nouns import Project


def tags_of(project: Project, sources: Iterable[tuple[str, str]]) -> dict[str, list[PanelTag]]:
    """Members of each global data block by its name; ``sources`` are generated files by name.

    A source names its blocks only: their numbers are those of the plan.
    """
    blocks = [block for name, text in sources for block in parse_source(text, name, bodies=False)[0]]
    types = {block.name.upper(): block for block in blocks}
    numbers = {(ref.kind, ref.name): ref.number for ref in project.blocks}
    numbered = (replace(one, number=numbers.get((one.kind.value, one.name), one.number)) for one in blocks)
    found = {block.name: list(panel_tags(block, types)) for block in numbered if not block.instance_of}
    return {name: tags for name, tags in found.items() if tags}
