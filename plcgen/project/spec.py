"""A validated spec together with the positions of its values."""

from __future__ import annotations

import hashlib
import posixpath
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, TypeVar

from plcgen.base.diagnostics import Span
from plcgen.base.files.hashes import text_digest
from plcgen.base.files.yaml import YamlNode
from plcgen.project.schema import Spec
from plcgen.project.variables import VariableUse

if TYPE_CHECKING:
    from pydantic import BaseModel

SpecPath = tuple[str | int, ...]
Sections = TypeVar("Sections", bound="BaseModel")


@dataclass(frozen=True, slots=True)
class LoadedSpec:
    """A validated spec together with the positions of its values."""

    file: str
    text: str
    spec: Spec
    root: YamlNode
    included: tuple[tuple[str, str], ...] = ()
    """The included files, each with its text."""
    uses: tuple[VariableUse, ...] = ()
    """Where variables were used."""
    whole: bool = True
    """Whether nothing was left out because it cannot be read."""

    @property
    def digest(self) -> str:
        """SHA-256 of the text without its line ends; with included files, that of a list of all hashes."""
        own = text_digest(self.text.encode())
        if not self.included:
            return own
        lines = [f"{text_digest(text.encode())}  {self.below(file)}\n" for file, text in self.included]
        return hashlib.sha256("".join([f"{own}\n", *sorted(lines)]).encode()).hexdigest()

    @property
    def included_names(self) -> tuple[str, ...]:
        """Paths of the included files, beginning at the spec, sorted."""
        return tuple(sorted(self.below(file) for file, _ in self.included))

    def below(self, file: str) -> str:
        """Path of an included file, beginning at the spec."""
        return posixpath.relpath(file, posixpath.dirname(self.file) or ".")

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
