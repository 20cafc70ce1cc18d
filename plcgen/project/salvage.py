"""What can still be used of a file with mistakes in its shape, so that one run finds what else is wrong with it.

Misspelt keys and words are read as what they look like. What else is wrong is left out: the element of a list, else the
whole entry (a drive, a job, a station) in which it stands. Nobody can tell what follows from that, so nothing more is
told of such an entry, and of those that name it.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any, Generic, NamedTuple

from pydantic import ValidationError

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.base.diagnostics.suggest import near
from plcgen.base.files.validation import FileShape, Loaded, Model, Path, keys_at
from plcgen.base.files.yaml import YamlNode

_ROUNDS = 12
"""What is left out may leave something else incomplete; files have fewer levels."""


@dataclass(frozen=True, slots=True)
class Salvaged(Generic[Model]):
    """A file without its mistakes; regions of which nothing is told any more, and parts of these that are sound.

    ``whole`` says whether nothing was left out: keys and values were replaced or forgotten alone.
    """

    loaded: Loaded[Model]
    doubtful: tuple[Span, ...]
    sound: tuple[Span, ...]
    whole: bool

    def told(self, diagnostics: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
        """The diagnostics that do not follow from what was left out."""
        doubtful, sound = _Regions(self.doubtful), _Regions(self.sound)
        for diagnostic in diagnostics:
            places = (diagnostic.span, *(note.span for note in diagnostic.notes))
            if not any(doubtful.have(place) and not sound.have(place) for place in places):
                yield diagnostic


@dataclass(frozen=True, slots=True)
class Parts:
    """The parts of a file: the one that is never left out, keys below which entries stand by name, details of entries.

    Nothing else depends on a detail.
    """

    head: tuple[str]
    sections: frozenset[str]
    details: frozenset[str]


def salvage(
    root: YamlNode, problems: Iterable[Diagnostic], shape: FileShape[Model], parts: Parts
) -> Salvaged[Model] | None:
    """Use a tree whose shape is wrong as far as that makes sense; None if nothing is left.

    ``problems`` are those that were found before its shape was looked at. The tree is changed.
    """
    if root.kind != "map":
        return None
    mending = _Mending(root, shape, parts)
    mending.doubt_at([found.span for found in problems])
    for _ in range(_ROUNDS):
        model = mending.model()
        try:
            valid = model.model_validate(root.data())
        except ValidationError as wrong:
            if not mending.mend(model, wrong.errors(include_url=False)):
                return None
        else:
            mending.doubt_names()
            whole = not (mending.gone or mending.names)
            return Salvaged(Loaded(valid, root), tuple(mending.doubtful), tuple(mending.sound), whole)
    return None


class _Step(NamedTuple):
    """One step from a node to what stands below it; ``item``: to an element of a list, short forms included."""

    above: YamlNode
    key: str | int
    item: bool

    @property
    def below(self) -> YamlNode:
        return self.above.pairs[self.key][1] if isinstance(self.key, str) else self.above.items[self.key]

    @property
    def region(self) -> Span:
        """From the key to the end of the value."""
        start = self.above.key_span(self.key) if isinstance(self.key, str) else self.below.span
        end = self.below.span
        if end.file != start.file or (end.line, end.column) < (start.line, start.column):  # the value stands elsewhere
            return start
        return Span(start.file, start.line, start.column, end.end_line, end.end_column)

    def siblings(self) -> Iterator[_Step]:
        """The other elements of the list."""
        keys: Iterable[str | int] = range(len(self.above.items)) if isinstance(self.key, int) else self.above.pairs
        return (_Step(self.above, key, item=True) for key in keys if key != self.key)


@dataclass(slots=True)
class _Mending(Generic[Model]):
    """The tree while it is mended; ``names`` are those of entries that are gone."""

    root: YamlNode
    shape: FileShape[Model]
    parts: Parts
    doubtful: list[Span] = field(default_factory=list)
    sound: list[Span] = field(default_factory=list)
    names: set[str] = field(default_factory=set)
    gone: bool = False

    def model(self) -> type[Model]:
        chosen = self.shape.model
        return chosen if isinstance(chosen, type) else chosen(self.root)

    def mend(self, model: type[Model], errors: list[Any]) -> bool:
        """Repair what can be repaired; if nothing can, leave out what is wrong. False if nothing would be left."""
        if sum(self.repaired(model, error) for error in errors):
            return True
        paths = (error["loc"][:-1] if error["type"] == "missing" else error["loc"] for error in errors)
        out = [self.leaves_out(self.steps(path)) for path in paths]
        if not all(out):
            return False
        self.gone = True
        for container, value in filter(None, out):
            container.items = [item for item in container.items if item is not value]
            container.pairs = {key: pair for key, pair in container.pairs.items() if pair[1] is not value}
        return True

    # --- repairs -------------------------------------------------------------------------------------------------

    def repaired(self, model: type[Model], error: Any) -> bool:
        """Whether a key or value could be replaced by what it looks like."""
        path: Path = tuple(error["loc"])
        if error["type"] == "extra_forbidden":
            return self.renamed(model, path)
        node = self.root.find(path)
        if node.kind != "scalar":
            return False
        if path[:1] == self.parts.head and error["type"] == "string_type" and not isinstance(node.value, str | None):
            node.value = node.raw
            self.doubtful.append(node.span)
            return True
        if error["type"] == "literal_error":
            options = [option.strip(" '") for option in error["ctx"]["expected"].replace(" or ", ",").split(",")]
            meant = near(str(node.value), options)
            if meant and node.value != meant[0]:
                node.value = meant[0]
                self.doubtful.append(node.span)
                return True
        return False

    def renamed(self, model: type[Model], path: Path) -> bool:
        """Read an unknown key as one that looks like it, or without one forget it."""
        above, name = self.root.find(path[:-1]), str(path[-1])
        if name not in above.pairs:
            return False
        item = next((step.region for step in self.steps(path) if step.item), None)
        key, value = above.pairs.pop(name)
        known = (self.shape.keys or (lambda at: keys_at(model, at)))(path[:-1])
        meant = near(name, [one for one in known if one not in above.pairs])
        if meant:
            above.pairs[meant[0]] = (key, value)
        self.doubtful.append(key.span if meant or item is None else item)
        return True

    # --- leaving out ---------------------------------------------------------------------------------------------

    def steps(self, path: Path) -> list[_Step]:
        """The way along a path, as far as it exists."""
        node = self.root
        found: list[_Step] = []
        for step in path:
            item = isinstance(step, int)
            key: str | int | None = None
            if node.kind == "map" and str(step) in node.pairs:
                key = str(step)
            elif node.kind == "map" and isinstance(step, int) and step < len(node.pairs):
                key = list(node.pairs)[step]
            elif node.kind == "seq" and isinstance(step, int) and step < len(node.items):
                key = step
            if key is not None:
                found.append(_Step(node, key, item))
                node = found[-1].below
        return found

    def leaves_out(self, steps: list[_Step]) -> tuple[YamlNode, YamlNode] | None:
        """Where something is left out, and what: an element of a list, else an entry; None if that would be all."""
        keys = [step.key for step in steps]
        if not keys or tuple(keys) == self.parts.head or (len(keys) == 1 and keys[0] in self.parts.sections):
            return None
        if tuple(keys[:1]) == self.parts.head or len(keys) == 1:
            self.doubtful.append(steps[-1].region)
            return steps[-1].above, steps[-1].below
        entry = max((i + 1 for i, key in enumerate(keys[:-1]) if key in self.parts.sections), default=1)
        if len(keys) > entry + 1 and keys[entry + 1] in self.parts.details:
            inside = steps[entry].below
            details = (_Step(inside, key, item=False) for key in inside.pairs if key in self.parts.details)
            self.doubtful += [detail.region for detail in details]
            return inside, steps[entry + 1].below
        self.doubtful.append(steps[entry].region)
        item = next((step for step in steps[entry + 1 :] if step.item), None)
        if item is not None:
            self.sound += [other.region for other in item.siblings()]
            self.doubtful.append(item.region)
            return item.above, item.below
        self.names |= {str(keys[entry]), *_entries(steps[entry].below, self.parts.sections)}
        return steps[entry].above, steps[entry].below

    def doubt_at(self, places: list[Span]) -> None:
        """Places that could not be read well: their entries are in doubt, and everything that names these."""
        if not places:
            return
        starts = sorted((place.file, place.line, place.column) for place in places)
        for step in self.all_entries(self.root):
            start, end = _bounds(step.region)
            if bisect_left(starts, start) < bisect_left(starts, end):
                self.doubtful.append(step.region)
                self.names.add(str(step.key))
        self.doubtful += places

    def doubt_names(self) -> None:
        """Doubt every entry that names one that is gone."""
        if self.names:
            for step in self.all_entries(self.root):
                if any(node.kind == "scalar" and node.raw in self.names for node in step.below.walk()):
                    self.doubtful.append(step.region)

    def all_entries(self, node: YamlNode) -> Iterator[_Step]:
        """Every entry of a node's sections, entries of entries included."""
        for key, (_, value) in node.pairs.items():
            for name, (_, below) in value.pairs.items():
                if key in self.parts.sections:
                    yield _Step(value, name, item=False)
                yield from self.all_entries(below)
            if key not in self.parts.sections:
                yield from self.all_entries(value)


def _entries(node: YamlNode, sections: frozenset[str]) -> Iterator[str]:
    for key in sections & node.pairs.keys():
        yield from node.pairs[key][1].pairs


class _Regions:
    """Regions of files joined where they overlap, so that a place is found among many of them at once."""

    def __init__(self, regions: Iterable[Span]) -> None:
        self._starts: list[tuple[str, int, int]] = []
        self._ends: list[tuple[str, int, int]] = []
        for start, end in sorted(map(_bounds, regions)):
            if self._ends and start <= self._ends[-1]:
                self._ends[-1] = max(end, self._ends[-1])
            else:
                self._starts.append(start)
                self._ends.append(end)

    def have(self, place: Span) -> bool:
        """Whether a place begins in one of the regions."""
        start = (place.file, place.line, place.column)
        number = bisect_right(self._starts, start)
        return number > 0 and start < self._ends[number - 1]


def _bounds(region: Span) -> tuple[tuple[str, int, int], tuple[str, int, int]]:
    """Where a region begins and ends, the end exclusive."""
    return (region.file, region.line, region.column), (region.file, region.end_line, region.end_column)
