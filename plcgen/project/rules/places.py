"""Where things of a plan stand in the spec: the spans rules point at."""

from __future__ import annotations

from typing import TYPE_CHECKING, get_args

from pydantic import BaseModel

if TYPE_CHECKING:
    from collections.abc import Iterable

    from plcgen.base.diagnostics import Span
    from plcgen.base.files.yaml import YamlNode
    from plcgen.project.nouns import BlockRef, Frame
    from plcgen.project.spec import SpecPath

_IMPORTANCE = {"FB": 0, "DB": 1, "UDT": 2}
_NUMBER_KEYS = {"request": "db", "response": "db", "block": "number", "instance": "number"}


def node_at(project: Frame, path: SpecPath) -> YamlNode | None:
    """Find the value at a path of the spec; None if the spec leaves it out."""
    node: YamlNode | None = project.loaded.root
    for step in path:
        if node is None:
            return None
        node = node.get(step) if isinstance(step, str) else _item(node, step)
    return node


def _item(node: YamlNode, index: int) -> YamlNode | None:
    """Find the n-th value of a list, or of a mapping that stands for a list."""
    return node.children[index] if index < len(node.children) else None


def key_or_value(project: Frame, path: SpecPath) -> Span:
    """Where the value at ``path`` stands; if the spec leaves it out, the key above it."""
    node = node_at(project, path)
    if node is not None:
        return node.span
    return owner_span(project, path)


def owner_span(project: Frame, path: SpecPath) -> Span:
    """Find the key of the job, drive or station a path belongs to, else the section's key."""
    shape: type[BaseModel] = type(project.loaded.spec)
    depth = 0
    while depth + 1 < len(path) and (inner := _named(shape, path[depth])) is not None:
        depth, shape = depth + 2, inner
    return project.loaded.key_span(path[: depth or 1])


def _named(shape: type[BaseModel], key: str | int) -> type[BaseModel] | None:
    """What a section has by name, as ``jobs`` has jobs; None if its keys are not chosen by whoever writes the spec."""
    field = shape.model_fields.get(str(key))
    kinds = get_args(field.annotation) if field is not None else ()
    if len(kinds) == 2 and isinstance(kinds[1], type) and issubclass(kinds[1], BaseModel):
        return kinds[1]
    return None


def name_span(project: Frame, block: BlockRef) -> Span:
    """Where a block's name comes from: its ``name``, else the key of its job or drive."""
    return key_or_value(project, (*block.path, "name"))


def number_span(project: Frame, block: BlockRef) -> Span:
    """Where a pinned block number is written."""
    return key_or_value(project, (*block.path, _NUMBER_KEYS.get(str(block.path[-1]), "number")))


def by_importance(blocks: Iterable[BlockRef]) -> list[BlockRef]:
    """Sort blocks so that those a person named come before the types made from them."""
    return sorted(blocks, key=lambda block: _IMPORTANCE[block.kind])
