"""Names of a spec: where each is defined, where it is used, and giving it another one.

What a name is stands in ``NAMED``. Places come from the tree in which included files, aliases and variables are
resolved, so that a name is found in whatever file and however it got there; while the text is broken, from its outline.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.files.files import below
from plcgen.base.files.yaml import YamlNode
from plcgen.ds47.registry import kinds
from plcgen.project.includes import KEY as INCLUDE
from plcgen.project.variables import KEY as VARIABLES
from plcgen.project.variables import NAME
from plcgen.workbench.service.results import Edit
from plcgen.workbench.service.specs.sketch import Path, Spot
from plcgen.workbench.service.specs.state import at_start, matches

if TYPE_CHECKING:
    from plcgen.workbench.service.documents import Document
    from plcgen.workbench.service.specs.state import Specs, SpecState


@dataclass(frozen=True, slots=True)
class NameKind:
    """A kind of name: the mappings whose keys are such names, and the values that use one.

    ``bound`` steps at the beginning of a path must be the same: a station is known to its own master only.
    """

    word: str
    homes: tuple[tuple[str, ...], ...]
    uses: tuple[tuple[str, ...], ...] = ()
    bound: int = 0


@cache
def named() -> tuple[NameKind, ...]:
    """Every kind of name."""
    recorded = tuple(("jobs", "*", kind.key) for kind in kinds() if kind.recorded)
    return (
        NameKind(
            "drive", (("drives",), ("units", "*", "drives")), (("jobs", "*", "drive"), ("jobs", "*", "drive", "#"))
        ),
        NameKind("job", (("jobs",), ("ppi", "*", "jobs"))),
        NameKind("unit", (("units",),)),
        NameKind("recipe", (("recipes",),), recorded),
        NameKind("station", (("ppi", "*", "stations"),), (("ppi", "*", "jobs", "*", "station"),), bound=2),
        NameKind("master", (("ppi",),)),
        NameKind("variable", ((VARIABLES,),)),
    )


@dataclass(frozen=True, slots=True)
class Name:
    """A name at a place: its kind, the name, and the steps to which it is bound."""

    kind: NameKind
    text: str
    bound: Path


_VARIABLE = re.compile(rf"(?<!\$)\$\(({NAME})\)")


def name_at(state: SpecState, line: int, column: int) -> tuple[Name, Span] | None:
    """What is named at a place, and the place of the name."""
    spot = state.sketch.at(line, column)
    if spot is None or not state.is_spec:
        return None
    for use in _VARIABLE.finditer(state.document.part(spot.span)):
        start = spot.span.column + use.start(1)
        if start - 2 <= column <= start + len(use[1]) + 1:
            variable = next(kind for kind in named() if kind.word == "variable")
            return Name(variable, use[1], ()), Span(spot.span.file, line, start, line, start + len(use[1]))
    found = _name_of(spot)
    return None if found is None else (found, _bare(state.document, spot.span))


def _name_of(spot: Spot) -> Name | None:
    for kind in named():
        if spot.role == "key" and spot.word and any(matches(spot.path, home) for home in kind.homes):
            return Name(kind, spot.word, spot.path[: kind.bound])
        if spot.role != "key" and spot.word and any(matches(spot.path, use) for use in kind.uses):
            return Name(kind, spot.word, spot.path[: kind.bound])
    return None


def _bare(document: Document, place: Span) -> Span:
    """A place without the quotes of what stands there."""
    text = document.part(place)
    if text[:1] in {'"', "'"} and len(text) > 1 and text[-1] == text[0]:
        return Span(place.file, place.line, place.column + 1, place.end_line, place.end_column - 1)
    return place


def definition(specs: Specs, document: Document, line: int, column: int) -> Span | None:
    """Where what is named at a place is defined: a key, an anchor, an included file."""
    state = specs.state(document)
    spot = state.sketch.at(line, column)
    if spot is None or not state.is_spec:
        return None
    if spot.word[:1] == "*":
        return state.sketch.anchors.get(spot.word[1:])
    if spot.role != "key" and spot.word and _names_file(spot.path):
        path = below(document.path.parent, spot.word)
        return at_start(path.as_posix()) if path is not None and path.is_file() else None
    found = name_at(state, line, column)
    if found is None:
        return None
    return next(_homes(specs, document, found[0]), None)


def _names_file(path: Path) -> bool:
    return path[0] == INCLUDE or path[-1] in {"device", "symbols"}


def _homes(specs: Specs, document: Document, name: Name) -> Iterator[Span]:
    for state, root in _trees(specs, document):
        if root is None:
            entries = state.sketch.entries
            yield from (
                _bare(document, one.key)
                for one in entries
                if str(one.path[-1]) == name.text and _is_home(one.path[:-1], name)
            )
        else:
            yield from (key.span for path, key, _ in _pairs(root) if key.raw == name.text and _is_home(path, name))


def _is_home(path: Path, name: Name) -> bool:
    return any(matches(path, home) for home in name.kind.homes) and path[: name.kind.bound] == name.bound


def _trees(specs: Specs, document: Document) -> list[tuple[SpecState, YamlNode | None]]:
    """The trees in which a document stands: its own, and those of open specs that include it."""
    own = specs.state(document)
    found: list[tuple[SpecState, YamlNode | None]] = [(own, None if own.composed is None else own.composed.root)]
    for other in specs.including(document):
        state = specs.state(other)
        if state.composed is not None:
            found.append((state, state.composed.root))
    return found


def _pairs(root: YamlNode, path: Path = ()) -> Iterator[tuple[Path, YamlNode, YamlNode]]:
    """Every key of a tree with the path of its mapping; names stand four levels deep at most."""
    left: list[tuple[Path, YamlNode]] = [(path, root)]
    while left:
        above, node = left.pop()
        for key, (place, value) in node.pairs.items():
            yield above, place, value
            if len(above) < 4:
                left.append(((*above, key), value))


def references(specs: Specs, document: Document, line: int, column: int) -> tuple[Span, ...]:
    """Every place where what is named at a place stands, where it is defined first."""
    found = name_at(specs.state(document), line, column)
    if found is None:
        return ()
    name = found[0]
    places = [*_homes(specs, document, name), *_uses(specs, document, name)]
    return tuple(dict.fromkeys(_placed(specs, place, name.text) or place for place in places))


def _uses(specs: Specs, document: Document, name: Name) -> Iterator[Span]:
    if name.kind.word == "variable":
        yield from _variable_uses(specs, document, name.text)
        return
    for state, root in _trees(specs, document):
        if root is None:
            yield from (
                one.place
                for one in state.sketch.entries
                if one.value == name.text and _is_use(one.path, name) and not one.open
            )
            continue
        for path, place, value in _pairs(root):
            at = (*path, place.raw)
            if value.kind == "scalar" and value.raw == name.text and _is_use(at, name):
                yield value.span
            for n, item in enumerate(value.items):
                if item.kind == "scalar" and item.raw == name.text and _is_use((*at, n), name):
                    yield item.span


def _is_use(path: Path, name: Name) -> bool:
    return any(matches(path, use) for use in name.kind.uses) and path[: name.kind.bound] == name.bound


def _variable_uses(specs: Specs, document: Document, text: str) -> Iterator[Span]:
    """Every ``$(name)`` in the document and in what is composed with it."""
    files = {document.file: document}
    for state, _ in _trees(specs, document):
        files.setdefault(state.document.file, state.document)
        for file, _ in () if state.composed is None else state.composed.included:
            included = specs.documents.get(file)
            if included is not None:
                files.setdefault(file, included)
    for file, each in files.items():
        for number, line in enumerate(each.lines, 1):
            for use in _VARIABLE.finditer(line) if "$(" in line else ():
                if use[1] == text:
                    yield Span(file, number, use.start(1) + 1, number, use.end(1) + 1)


def _placed(specs: Specs, place: Span, text: str) -> Span | None:
    """A place without quotes; None if the name itself does not stand there."""
    document = specs.documents.get(place.file)
    if document is None:
        return None
    bare = _bare(document, place)
    return bare if document.part(bare) == text else None


_PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_ -]*\Z")


def rename(specs: Specs, document: Document, line: int, column: int, new: str) -> tuple[Edit, ...]:
    """Edits that give what is named at a place another name, wherever it stands.

    Raises:
        DiagnosticError: nothing is named there, the text is broken, or a place of the name cannot be changed.
    """
    state = specs.state(document)
    found = name_at(state, line, column)
    here = Span(document.file, line, column, line, column)
    if found is None:
        raise _refused("there is no name that could be changed", here, "put the cursor on a drive, a job or a recipe")
    name, place = found
    if state.composed is None:
        raise _refused("the text cannot be read as YAML now", place, "correct it first")
    if not _PLAIN.match(new) or new != new.strip() or len(new) > 120:
        raise _refused(f'"{new}" is not a name', place, "letters, digits, _ and -; a letter first")
    taken = next(_homes(specs, document, Name(name.kind, new, name.bound)), None)
    if taken is not None and new != name.text:
        raise _refused(f'there is a {name.kind.word} "{new}" already', taken, "choose another name")
    edits = []
    places = [*_homes(specs, document, name), *_uses(specs, document, name)]
    for each in dict.fromkeys(places):
        bare = _placed(specs, each, name.text) or _value_place(specs, document, each, name.text)
        if bare is None:
            raise _refused(f'"{name.text}" comes from a place that cannot be changed', each, "change it there by hand")
        edits.append(Edit(bare, new))
    return tuple(dict.fromkeys(edits))


def _value_place(specs: Specs, document: Document, use: Span, text: str) -> Span | None:
    """Where the value of a variable stands that is the name, if a use of the variable stands at a place."""
    for state, root in _trees(specs, document):
        origins = () if state.composed is None else state.composed.uses
        for one in origins:
            known = None if root is None else root.find((VARIABLES, one.name))
            if one.place == use and known is not None and known.raw == text:
                return _placed(specs, known.span, text)
    return None


def _refused(message: str, place: Span, help_: str) -> DiagnosticError:
    return DiagnosticError([Diagnostic("PG901", message, place, help=help_)])
