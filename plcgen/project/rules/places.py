"""Where things of a plan stand in the spec: the spans rules point at."""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from plcgen.diagnostics import Span
    from plcgen.input.yaml import Node
    from plcgen.project.loading import SpecPath
    from plcgen.project.model import BlockRef, PlannedJob, Project, Use

_IMPORTANCE = {"FB": 0, "DB": 1, "UDT": 2}
_NUMBER_KEYS = {"request": "db", "response": "db", "block": "number", "instance": "number"}


def node_at(project: Project, path: SpecPath) -> Node | None:
    """Find the value at a path of the spec; None if the spec leaves it out."""
    node: Node | None = project.loaded.root
    for step in path:
        if node is None:
            return None
        node = node.get(step) if isinstance(step, str) else _item(node, step)
    return node


def _item(node: Node, index: int) -> Node | None:
    """Find the n-th value of a list, or of a mapping that stands for a list."""
    if node.kind == "map":
        return next((value for _, value in islice(node.pairs.values(), index, index + 1)), None)
    return node.items[index] if index < len(node.items) else None


def key_or_value(project: Project, path: SpecPath) -> Span:
    """Where the value at ``path`` stands; if the spec leaves it out, the key above it."""
    node = node_at(project, path)
    if node is not None:
        return node.span
    return owner_span(project, path)


def owner_span(project: Project, path: SpecPath) -> Span:
    """Find the key of the job or drive a path belongs to, else the section's key."""
    if path[0] == "ppi":
        return project.loaded.key_span(path[: 4 if len(path) > 3 and path[2] in {"jobs", "stations"} else 2])
    return project.loaded.key_span(path[:2] if path[0] in {"jobs", "drives"} else path[:1])


def parameter_span(project: Project, use: Use) -> Span:
    """Where a use's parameter is written: the key of a short form, else the value of ``parameter``."""
    return project.loaded.span((*use.path, "parameter"))


def value_span(project: Project, use: Use) -> Span:
    """Where a use is written as a whole."""
    return project.loaded.span(use.path)


def name_span(project: Project, block: BlockRef) -> Span:
    """Where a block's name comes from: its ``name``, else the key of its job or drive."""
    return key_or_value(project, (*block.path, "name"))


def number_span(project: Project, block: BlockRef) -> Span:
    """Where a pinned block number is written."""
    return key_or_value(project, (*block.path, _NUMBER_KEYS.get(str(block.path[-1]), "number")))


def member_span(project: Project, use: Use) -> Span:
    """Where a use's member name comes from: ``as``, else the parameter."""
    given = node_at(project, (*use.path, "as"))
    return parameter_span(project, use) if given is None else given.span


def spelling(project: Project, job: PlannedJob, use: Use) -> str:
    """Quote the parameter as the spec writes it."""
    items = project.loaded.spec.jobs[job.key].write if job.write else project.loaded.spec.jobs[job.key].read
    return items[use.position - 1].parameter if items else ""


def by_importance(project: Project) -> list[BlockRef]:
    """Sort the blocks so that those a person named come before the types made from them."""
    return sorted(project.blocks, key=lambda block: _IMPORTANCE[block.kind])
