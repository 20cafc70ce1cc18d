"""From a spec file to a validated spec, with every problem of the file as a diagnostic at its place."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from plcgen.diagnostics import Report, Span
from plcgen.input.text import read_text
from plcgen.input.validation import Document, read_document
from plcgen.input.yaml import Node
from plcgen.project import schema

SpecPath = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class LoadedSpec:
    """A validated spec together with the positions of its values."""

    file: str
    text: str
    spec: schema.Spec
    root: Node

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
    return None if loaded is None else LoadedSpec(file, text, loaded.model, loaded.root)


_SPEC: Document[schema.Spec] = Document(
    model=lambda root: schema.model_of(root.pairs),
    what="the spec",
    shape="a spec is a mapping with plc, drives and jobs",
    help="start from an example: plcgen new",
    keys=schema.field_names,
)
