"""Completion of specs: keys and words by the schema, names that are defined, parameters of the drive in question."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cache
from itertools import islice
from typing import TYPE_CHECKING, Any

from plcgen.base.diagnostics import DiagnosticError, Span
from plcgen.base.files.files import YAML_SUFFIXES, walk
from plcgen.ds47.device import Parameter
from plcgen.ds47.devices import find_device, named_parameters
from plcgen.ds47.registry import kinds
from plcgen.project.includes import KEY as INCLUDE
from plcgen.project.variables import KEY as VARIABLES
from plcgen.workbench.service.results import Edit, Offer
from plcgen.workbench.service.specs.drives import MOST, KnownDrive, drives_at, in_full, in_short, spelled
from plcgen.workbench.service.specs.form import begun
from plcgen.workbench.service.specs.jobs import job_offers
from plcgen.workbench.service.specs.names import named
from plcgen.workbench.service.specs.others import kind_of
from plcgen.workbench.service.specs.shape import Shape, spec_shape
from plcgen.workbench.service.specs.shape import spelled as word_of
from plcgen.workbench.service.specs.sketch import Path, Spot
from plcgen.workbench.service.specs.state import matches
from plcgen.workbench.service.specs.stations import names_items, symbols_at

if TYPE_CHECKING:
    from plcgen.workbench.service.documents import Document
    from plcgen.workbench.service.specs.state import Specs, SpecState


def offers(specs: Specs, document: Document, line: int, column: int) -> tuple[Offer, ...]:
    """Everything that may stand at a place; an editor shows of it what fits to what was typed."""
    state = specs.state(document)
    spot = state.sketch.at(line, column)
    if spot is None:
        return ()
    if not state.is_spec:
        kind = kind_of(state)
        return () if kind is None else tuple(_by_shape(state, spot, kind.shape))
    if spot.before[:1] == "$":
        return tuple(_variables(state, spot))
    found: list[Offer] = []
    if spot.role == "key":
        found += [*_begun(state, spot), *_keys(state, spot)]
    if spot.role != "key" or spot.fresh:
        found += _values(state, spot, spot.path, "")
    if spot.role == "item":
        found += _keys(state, spot)
    if spot.role == "key" and spot.fresh:
        found += _values(state, spot, (*spot.path, 0), "- ")
    if spot.role != "key":
        found += _variables(state, spot)
    return tuple({one.label: one for one in reversed(found)}.values())[::-1]


def _by_shape(state: SpecState, spot: Spot, shape: Shape) -> Iterator[Offer]:
    """Keys, words and examples, as a schema alone says them."""
    if spot.role in {"key", "item"}:
        present = {str(one.path[-1]) for one in state.sketch.below(spot.path) if one.key != spot.span}
        for key in shape.keys(spot.path):
            if key not in present:
                place = (*spot.path, key)
                yield _offer(state, spot, key, "key", detail=shape.meaning(place), text=shape.said(place), key=True)
    if spot.role != "key":
        for word in dict.fromkeys([*shape.words(spot.path), *shape.examples(spot.path)]):
            yield _offer(state, spot, word_of(word), "value")


# --- keys ------------------------------------------------------------------------------------------------------------


def _keys(state: SpecState, spot: Spot) -> Iterator[Offer]:
    shape, path = spec_shape(), spot.path
    known = shape.keys(path)
    if names_parameters(path):
        yield from _parameters(state, spot, path, written=path[-1] == "write", key=True)
        known = {key: each for key, each in known.items() if key not in parameter_names()}
    yield from _members(state, spot)
    yield from _symbols(state, spot, path, key=True)
    present = {str(one.path[-1]) for one in state.sketch.below(path) if one.key != spot.span}
    lacking = _lacking(state, path)
    for key in sorted(known, key=lambda key: key in lacking):
        if key not in present and key not in _other_kinds(path, present):
            meaning = lacking.get(key) or shape.meaning((*path, key))
            yield _offer(state, spot, key, "key", detail=meaning, text=_said(shape, (*path, key)), key=True)


def _lacking(state: SpecState, path: Path) -> dict[str, str]:
    """Keys of a job for which its drive lacks something, and what that is."""
    drives = drives_at(state, path) if matches(path, ("jobs", "*")) else []
    if len(drives) != 1:
        return {}
    found = job_offers(state, drives[0].key)
    could = {one.text.partition(":")[0] for one in found if not one.lacks}
    keys = {one.text.partition(":")[0]: one.lacks for one in found if one.lacks}
    return {key: f"not for {drives[0].key}: {why}" for key, why in keys.items() if key not in could}


def _begun(state: SpecState, spot: Spot) -> Iterator[Offer]:
    """Whole entries to begin with, where a section of the spec has keys of the user's own."""
    for one in begun(state, spot.path):
        offer = _offer(state, spot, one.label, "snippet", detail=one.detail, key=True)
        yield replace(offer, edit=replace(offer.edit, text=f"{one.key}: {one.body}"))


def _said(shape: Shape, path: Path) -> str:
    return shape.said(path, listed=not names_parameters(path))


def _other_kinds(path: Path, present: set[str]) -> set[str]:
    """Kinds of job that cannot stand beside the one that is there."""
    if not matches(path, ("jobs", "*")):
        return set()
    whole = {kind.key for kind in kinds() if not kind.follows}
    return whole if whole & present else set()


# --- values ----------------------------------------------------------------------------------------------------------


def _values(state: SpecState, spot: Spot, path: Path, lead: str) -> Iterator[Offer]:
    """``lead`` is what must stand before the value where it goes."""
    for kind in named():
        if any(matches(path, use) for use in kind.uses):
            for home in kind.homes:
                bound = (*map(str, path[: kind.bound]), *home[kind.bound :])
                for place, name in state.names(*bound):
                    detail = state.sketch.value(*place, "device") or kind.word
                    yield _offer(state, spot, name, "name", detail=detail, lead=lead)
    if path[:1] == (INCLUDE,):
        yield from (_offer(state, spot, name, "file", lead=lead) for name in _files(state))
        return
    yield from _symbols(state, spot, path, key=False, lead=lead)
    words = spec_shape().words(path)
    if words and names_parameters(path, words):
        yield from _parameters(state, spot, path, written="write" in path, key=False, lead=lead)
        return
    if path and path[-1] == "device":
        for name in words:
            yield _offer(state, spot, name, "device", detail=find_device(name).title, lead=lead)
        for name in _files(state):
            if _is_profile(state, name):
                yield _offer(state, spot, f"./{name}", "file", detail="a profile of your own", lead=lead)
        return
    yield from _value_names(state, spot, path, lead)
    for word in words:
        yield _offer(state, spot, word_of(word), "value", lead=lead)
    for example in spec_shape().examples(path):
        yield _offer(state, spot, word_of(example), "value", detail="example", lead=lead)


def _files(state: SpecState) -> Iterator[str]:
    """YAML files below the folder of the spec, some of them."""
    own = state.document.path
    found = (
        (folder / name).relative_to(own.parent).as_posix()
        for folder, _, names in walk(own.parent)
        for name in names
        if (folder / name).suffix.lower() in YAML_SUFFIXES and folder / name != own
    )
    return islice(found, MOST)


_PROFILE = re.compile(r"(?m)^record_index\s*:")


def _is_profile(state: SpecState, name: str) -> bool:
    path = state.document.path.parent / name
    try:
        return _PROFILE.search(state.read(path, path.as_posix())) is not None
    except DiagnosticError:
        return False


def _variables(state: SpecState, spot: Spot) -> Iterator[Offer]:
    for _, name in state.names(VARIABLES):
        yield _offer(state, spot, f"$({name})", "variable", detail=state.sketch.value(VARIABLES, name))


# --- parameters ------------------------------------------------------------------------------------------------------


@cache
def parameter_names() -> frozenset[str]:
    """Names of parameters of all devices: where the schema offers one of them, any parameter may stand."""
    return frozenset(named_parameters())


def names_parameters(path: Path, words: Iterable[Any] | None = None) -> bool:
    """Whether parameters stand at a path: as keys of the mapping there, or as one of the ``words`` of the value."""
    if words is not None:
        return not parameter_names().isdisjoint(word for word in words if isinstance(word, str))
    if path[-1:] in {("allow",), ("allow_safety",)} or (path[:1] != ("jobs",) and path[-1:] == ("parameters",)):
        return True
    return not parameter_names().isdisjoint(spec_shape().keys(path))


def _parameters(
    state: SpecState, spot: Spot, path: Path, *, written: bool, key: bool, lead: str = ""
) -> Iterator[Offer]:
    """Parameters that every drive in question has."""
    drives = drives_at(state, path)
    if not drives:
        return
    first, *others = drives
    fitting = (
        one
        for one in first.matching(spot.before)
        if ("w" if written else "r") in one.access and all(other.find(spelled(one)) is not None for other in others)
    )
    for risky, one in sorted(
        ((_is_risky(first, one, written=written), one) for one in islice(fitting, MOST)), key=_risk
    ):
        name, text = spelled(one), "\n".join(f"{heading}: {said}" for heading, said in in_full(one) if said)
        short = " · ".join(filter(None, (in_short(one), "needs a sign-off" if risky else "")))
        yield _offer(state, spot, name, "parameter", detail=short, text=text, key=key, lead=lead, also=one.name)
        if one.name and not spot.before[:1].isdigit():
            detail = f"{name} · {short}"
            yield _offer(state, spot, one.name, "parameter", detail=detail, text=text, key=key, lead=lead)


def _is_risky(drive: KnownDrive, one: Parameter, *, written: bool) -> bool:
    return written and bool(drive.device.danger(one.pnu, object_type=drive.object_type))


def _risk(pair: tuple[bool, Parameter]) -> bool:
    return pair[0]


def parameter_at(state: SpecState, path: Path) -> tuple[str, list[tuple[KnownDrive, Parameter]]] | None:
    """The parameter whose value stands at a path, as it is written, and what each drive knows of it."""
    place: Path = path
    if place[-1:] in {("value",), ("start",)}:
        named_ = state.sketch.value(*place[:-1], "parameter")
        place = place[:-1]
    else:
        named_ = ""
    if not named_ and place and names_parameters(place[:-1]) and isinstance(place[-1], str):
        named_ = place[-1]
    found = [(drive, one) for drive in drives_at(state, path) if named_ and (one := drive.find(named_)) is not None]
    return (named_, found) if found else None


def _value_names(state: SpecState, spot: Spot, path: Path, lead: str) -> Iterator[Offer]:
    """Names of the values of a parameter, with their numbers."""
    known = parameter_at(state, path)
    for _, one in known[1] if known is not None else ():
        grade = one.grades.get("values", "read")
        for name, number in {**one.doubted.get("values", {}), **one.values}.items():
            doubt = "" if grade == "read" else f" ({grade}: write the number)"
            yield _offer(state, spot, name, "value", detail=f"{number}{doubt}", text=one.title, lead=lead)


def _symbols(state: SpecState, spot: Spot, path: Path, *, key: bool, lead: str = "") -> Iterator[Offer]:
    """Symbols of the station that a job asks."""
    if names_items(path, key=key):
        for one in islice(symbols_at(state, path), MOST):
            yield _offer(
                state, spot, one.name, "name", detail=f"{one.address} {one.comment}".strip(), key=key, lead=lead
            )


def _members(state: SpecState, spot: Spot) -> Iterator[Offer]:
    """In a record of a recipe: its parameters."""
    if not matches(spot.path, ("recipes", "*", "records", "*")):
        return
    place: Path = (*spot.path[:2], "parameters")
    for entry in state.sketch.below(place):
        name = entry.value or state.sketch.value(*entry.path, "as") or state.sketch.value(*entry.path, "parameter")
        if name:
            yield _offer(state, spot, name, "name", detail="parameter of the recipe", key=True)


def _offer(
    state: SpecState,
    spot: Spot,
    label: str,
    kind: Any,
    *,
    detail: str = "",
    text: str = "",
    key: bool = False,
    lead: str = "",
    also: str = "",
) -> Offer:
    """An offer in the place of the word at a spot; a key gets its colon unless there is one."""
    line = state.document.lines[spot.span.line - 1]
    before, after = line[: spot.span.column - 1], line[spot.span.end_column - 1 :].lstrip(" \t")
    space = "" if not before or before[-1:] in {" ", "\t", "[", "{"} or spot.role == "key" else " "
    quote = state.document.part(spot.span)[:1]
    if quote in {'"', "'"} and not lead:
        shown = f"{quote}{label}{quote}"
    elif not key and not label.startswith("$(") and any(mark in label for mark in ":#,[]{}"):
        shown = json.dumps(label)
    else:
        shown = label
    colon = ": " if key and not after.startswith(":") else ""
    place = Span(spot.span.file, spot.span.line, spot.span.column, spot.span.end_line, spot.span.end_column)
    return Offer(label, kind, Edit(place, f"{space}{lead}{shown}{colon}"), detail, text, also)
