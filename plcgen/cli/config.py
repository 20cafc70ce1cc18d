"""``plcgen.toml``: what a repository wants the verbs to do unless the command line says otherwise.

It comes with the files that are judged, so it is believed least: it cannot name what is believed (a cache), and where
it asks for less than the default of a verb, the result says so.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Report, Severity, Span
from plcgen.base.files.files import below, refusal
from plcgen.base.files.printed import Line
from plcgen.base.files.text import read_text
from plcgen.base.files.toml import parse_toml
from plcgen.base.files.validation import FileShape, StrictModel, problem, validate
from plcgen.base.files.yaml import YamlNode
from plcgen.proof.effort import Faults

NAME = "plcgen.toml"

FailOn = Literal["breaking", "compatible", "any", "never"]
_Path = Annotated[Line, Field(max_length=500)]
Paths = Annotated[tuple[_Path, ...], Field(max_length=1000)]


def _no_folder(name: object) -> object:
    if isinstance(name, str) and name != "off":
        help_ = 'name it with --cache or PLCGEN_CACHE; cache = "off" uses none'
        raise problem("a repository does not say where the verdicts about it lie", help_=help_)
    return name


class VerifySection(StrictModel):
    """Options of ``verify``, and of the verification in ``review``."""

    faults: Faults | None = Field(None, description="how many faults the generated SCL runs through")
    oracle: Literal["tshark"] | None = Field(None, description="also check every telegram with Wireshark's dissector")
    cache: Annotated[Literal["off"], BeforeValidator(_no_folder)] | None = Field(
        None, description="off: no verdict is taken from a cache, or kept"
    )


class DiffSection(StrictModel):
    """Options of ``diff``."""

    fail_on: FailOn | None = Field(None, alias="fail-on", description="the lowest class of change that fails")
    policy: Paths = Field((), description="ID=CLASS, or a file of them")


class LockSection(DiffSection):
    """Options of ``lock``."""

    file: _Path | None = Field(None, description="the lock file")


class Config(StrictModel):
    """The defaults of a repository."""

    specs: Paths = Field((), description="files and folders that check, generate and verify take without a path")
    strict: bool | None = Field(None, description="treat facts for which no document was found as errors")
    verify: VerifySection = VerifySection()
    diff: DiffSection = DiffSection()
    lock: LockSection = LockSection()


STRICTEST: dict[str, FailOn] = {"diff": "breaking", "lock": "any"}
"""``--fail-on`` of the verbs that have it, if nobody says anything."""
_ORDER: tuple[FailOn, ...] = ("any", "compatible", "breaking", "never")

_SHAPE: FileShape[Config] = FileShape(model=Config, what=NAME, shape=f"{NAME} has keys and tables")


def find_config(folder: Path) -> Path | None:
    """The file of the folder, or of the next one above in the same repository (as far as ``.git``)."""
    above = (folder, *folder.parents)
    root = next((place for place, each in enumerate(above) if (each / ".git").exists()), 0)
    return next((each / NAME for each in above[: root + 1] if (each / NAME).is_file()), None)


def configured(verb: str) -> tuple[dict[str, Any], dict[str, Diagnostic]]:
    """The parameters of a verb that the file of the current folder says something about, as click wants them.

    Also, by parameter, PG903 for each that asks for less than the default of the verb.

    Raises:
        DiagnosticError: with everything wrong in the file.
    """
    file = find_config(Path.cwd())
    if file is None:
        return {}, {}
    shown = file.name if file.parent == Path.cwd() else os.path.relpath(file)
    config, root = load_config(Path(shown))
    weak = {param: _weak(root, keys, what) for param, keys, what in weakened(config, verb)}
    return defaults(config, Path(shown).parent, verb), weak


def load_config(file: Path) -> tuple[Config, YamlNode]:
    """Read and validate the file; the node has the places of its keys.

    Raises:
        DiagnosticError: with everything wrong in it.
    """
    report = Report()
    root = parse_toml(read_text(file), file.as_posix(), report)
    config = None if root is None else validate(root, _SHAPE, report)
    if root is not None and config is not None:
        for key, name in _files(config):
            if below(file.parent, name) is None:
                place = root.find(key).span
                help_ = "name files and folders in its folder or below"
                report.add(Diagnostic("PG107", f"{name} {refusal(name, f'the folder of {NAME}')}", place, help=help_))
    report.raise_on_errors()
    if config is None or root is None:
        raise DiagnosticError([Diagnostic("PG101", "not readable", Span(file.as_posix()))])
    return config, root


def _files(config: Config) -> Iterator[tuple[tuple[str, ...], str]]:
    """Every path in the file, with the keys that lead to it."""
    yield from ((("specs",), name) for name in config.specs)
    for section, policy in (("diff", config.diff.policy), ("lock", config.lock.policy)):
        yield from (((section, "policy"), name) for name in policy if "=" not in name)
    if config.lock.file is not None:
        yield ("lock", "file"), config.lock.file


def weakened(config: Config, verb: str) -> Iterator[tuple[str, tuple[str, ...], str]]:
    """The parameters of a verb for which the file asks for less, each with its keys and what that means."""
    if verb in STRICTEST:
        section = config.diff if verb == "diff" else config.lock
        own, weakest = STRICTEST[verb], section.fail_on
        if weakest is not None and _ORDER.index(weakest) > _ORDER.index(own):
            yield "fail_on", (verb, "fail-on"), f'fail-on is "{weakest}" instead of "{own}"'
        if section.policy:
            yield "policy", (verb, "policy"), "changes are classified by a policy of the repository"
    if verb in {"verify", "review"} and config.verify.faults == "none":
        yield "faults", ("verify", "faults"), 'no faults are tried: faults is "none" instead of "quick"'


def _weak(root: YamlNode, keys: tuple[str, ...], what: str) -> Diagnostic:
    help_ = f"whoever judges says it himself: --{keys[-1]} on the command line"
    return Diagnostic("PG903", f"{NAME} asks for less: {what}", root.find(keys).span, Severity.WARNING, help=help_)


def defaults(config: Config, folder: Path, verb: str) -> dict[str, Any]:
    """The parameters of a verb that the file says something about; its paths are those of ``folder``."""
    found: dict[str, Any] = {}
    if verb in {"check", "generate", "verify"}:
        found["paths"] = tuple(folder / name for name in config.specs) or None
    if verb in {"check", "verify"}:
        found["strict"] = config.strict
    if verb in {"verify", "review"}:
        found["faults"] = config.verify.faults
    if verb == "verify":
        found |= {"oracle": config.verify.oracle}
        found["cache"] = None if config.verify.cache is None else Path(config.verify.cache)
    if verb in {"diff", "lock"}:
        section = config.diff if verb == "diff" else config.lock
        policy = tuple(each if "=" in each else str(folder / each) for each in section.policy)
        found |= {"fail_on": section.fail_on, "policy": policy or None}
    if verb in {"lock", "review"} and config.lock.file is not None:
        found["path" if verb == "lock" else "lock"] = folder / config.lock.file
    return {key: value for key, value in found.items() if value is not None}
