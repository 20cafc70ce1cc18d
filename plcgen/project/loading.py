"""From a spec file to a validated spec, with every problem of the file as a diagnostic at its place."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from plcgen.diagnostics import Report, Span
from plcgen.input.text import read_text
from plcgen.input.validation import Document, keys_at, read_document
from plcgen.input.yaml import Node
from plcgen.project import schema
from plcgen.protocols.registry import protocols

if TYPE_CHECKING:
    from pydantic import BaseModel

    from plcgen.protocols.base import Protocol

SpecPath = tuple[str | int, ...]
Sections = TypeVar("Sections", bound="BaseModel")


@dataclass(frozen=True, slots=True)
class LoadedSpec:
    """A validated spec together with the positions of its values."""

    file: str
    text: str
    spec: schema.Spec
    root: Node
    protocols: tuple[Protocol, ...]
    """The protocols that the spec uses."""

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled as its text: the model is made anew for the protocols that the spec uses."""
        return _parsed, (self.text, self.file)

    def sections(self, shape: type[Sections]) -> Sections:
        """The spec as one protocol sees it."""
        if not isinstance(self.spec, shape):
            raise TypeError(f"the spec has no {shape.__name__}")
        return self.spec

    def span(self, path: SpecPath) -> Span:
        """Where the value at ``path`` stands (or the nearest value above it).

        A parameter in short form (``P50304: 100.0``) stands where its key does.
        """
        if len(path) > 2 and path[-1] in {"parameter", "item"} and isinstance(path[-2], int):
            items = self.root.find(path[:-2])
            if items.kind == "map":
                return next(islice(items.pairs.values(), path[-2], None), (items, items))[0].span
        return self.root.find(path).span

    def key_span(self, path: SpecPath) -> Span:
        """Where the key at ``path`` stands."""
        return self.root.find(path[:-1]).key_span(str(path[-1]))


def load_spec(path: Path, report: Report) -> LoadedSpec | None:
    """Read and validate a spec file.

    Raises:
        DiagnosticError: if the file cannot be read as text at all.
    """
    return parse_spec(read_text(path), path.as_posix(), report)


def parse_spec(text: str, file: str, report: Report) -> LoadedSpec | None:
    """Validate spec text; problems go to ``report``; None if it cannot be used."""
    loaded = read_document(text, file, _SPEC, report)
    return None if loaded is None else LoadedSpec(file, text, loaded.model, loaded.root, _used(loaded.root))


def _parsed(text: str, file: str) -> LoadedSpec:
    loaded = parse_spec(text, file, Report())
    if loaded is None:
        raise ValueError(f"{file} was valid before")
    return loaded


def _used(root: Node) -> tuple[Protocol, ...]:
    """The protocols whose sections stand in a spec; without any, the first one, whose keys are missing then."""
    used = tuple(protocol for protocol in protocols() if any(key in root.pairs for key in protocol.sections))
    return used or protocols()[:1]


def spec_keys(path: SpecPath) -> list[str]:
    """Keys that a spec may have at a path, whatever protocols it uses."""
    return keys_at(schema.spec_model(protocols()), path)


_SPEC: Document[schema.Spec] = Document(
    model=lambda root: schema.spec_model(_used(root)),
    what="the spec",
    shape="a spec is a mapping with plc, drives and jobs",
    help="start from an example: plcgen new",
    keys=spec_keys,
)
