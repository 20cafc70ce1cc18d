"""What the statement is made from: the resolved spec as plain data, and profiles as their files have them."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from types import FunctionType, MappingProxyType, ModuleType
from typing import Any

from plcgen.base.files.text import read_text
from plcgen.base.files.yaml import load_yaml
from plcgen.base.plugins import plugins
from plcgen.base.resources import specs_dir
from plcgen.oracles.spec.ds47.signing import Effects
from plcgen.oracles.spec.ds47.state import StatesKind
from plcgen.oracles.spec.place import Keys, SpecPlace, SpecSource
from plcgen.project.spec import LoadedSpec

GROUP, DEVICES = "plcgen.statements", "plcgen.devices"
"""Entry points: what a kind of job of another distribution demands; profiles of a package."""


def spec_source(loaded: LoadedSpec) -> SpecSource:
    """The spec for the statement."""
    data = loaded.root.data()

    def place(keys: Keys) -> SpecPlace:
        span = loaded.span(keys)
        return SpecPlace(span.file, span.line, span.column)

    profiles = dict(_profiles(data, Path(loaded.file).parent))

    def family(device: str) -> SpecSource:
        names = [file.stem for file in (specs_dir() / "devices").glob(f"{device.partition('-')[0]}-*.yaml")]
        every = dict(_with_lenders(names, Path()))
        return SpecSource(data, place, every, _lists(every))

    return SpecSource(data, place, profiles, _lists(profiles), family)


def _lists(profiles: Mapping[str, Mapping[str, Any]]) -> Mapping[str, Sequence[str]]:
    named = {str(one["list"]) for profile in profiles.values() for one in profile.get("lists") or ()}
    return {name: _lines(name) for name in named}


@lru_cache(maxsize=16)
def _lines(name: str) -> Sequence[str]:
    """A list of parameters as it lies there."""
    return (Path(__file__).resolve().parents[2] / "lists" / f"{name}.tsv").read_text("utf-8").splitlines()


@lru_cache(maxsize=1)
def effects() -> Effects:
    """What writes do, from the two files of the table as they lie there."""
    table = Path(__file__).resolve().parents[2] / "effects.toml"
    return Effects(tomllib.loads(table.read_text("utf-8")), table.with_suffix(".tsv").read_text("utf-8").splitlines())


def kinds_of_others() -> Mapping[str, StatesKind]:
    """Statements about kinds of jobs that other distributions bring, by the keys of the kinds."""
    return MappingProxyType(plugins(GROUP, FunctionType))


def _profiles(data: Mapping[str, Any], folder: Path) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Every profile that the spec names, with those that it is ``like``."""
    entries = [*(data.get("drives") or {}).values(), *(data.get("units") or {}).values()]
    yield from _with_lenders([str(entry["device"]) for entry in entries if entry and "device" in entry], folder)


def _with_lenders(asked: list[str], folder: Path) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Profiles, with those that they are ``like``."""
    known: set[str] = set()
    while asked:
        name = asked.pop()
        if name in known:
            continue
        known.add(name)
        profile = _profile(_file(name, folder))
        if profile.get("like"):
            asked.append(str(profile["like"]))
        yield name, profile


def _file(name: str, folder: Path) -> Path:
    """A path beside the spec, a shipped profile, or one of a package."""
    if "/" in name or name.endswith((".yaml", ".yml")):
        return folder / name
    shipped = specs_dir() / "devices" / f"{name}.yaml"
    return shipped if shipped.is_file() else next(_packaged(name), shipped)


def _packaged(name: str) -> Iterator[Path]:
    for found in plugins(DEVICES, object).values():
        place = Path(str(found.__file__)).parent if isinstance(found, ModuleType) else Path(str(found))
        file = place / f"{name}.yaml" if place.is_dir() else place
        if file.stem == name and file.is_file():
            yield file


@lru_cache(maxsize=32)
def _read(file: str, _changed: int) -> Mapping[str, Any]:
    found: Mapping[str, Any] = load_yaml(read_text(Path(file)), file).data()
    return found


def _profile(file: Path) -> Mapping[str, Any]:
    return _read(str(file), file.stat().st_mtime_ns)
