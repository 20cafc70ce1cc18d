"""``plcgen.toml``: what a repository wants the verbs to do unless the command line says otherwise."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from plcgen.diagnostics import Diagnostic, DiagnosticError, Report, Span
from plcgen.input.files import below, refusal
from plcgen.input.text import read_text
from plcgen.input.toml import parse_toml
from plcgen.input.validation import FileShape, StrictModel, validate
from plcgen.proof.effort import Faults

NAME = "plcgen.toml"

FailOn = Literal["breaking", "compatible", "any", "never"]
Paths = Annotated[tuple[Annotated[str, Field(min_length=1, max_length=500)], ...], Field(max_length=1000)]


class VerifySection(StrictModel):
    """Options of ``verify``, and of the verification in ``review``."""

    faults: Faults | None = Field(None, description="how many faults the generated SCL runs through")
    engine: bool | None = Field(None, description="run the proof of the drive engine, even if the engine is known")
    oracle: Literal["tshark"] | None = Field(None, description="also check every telegram with Wireshark's dissector")
    cache: Annotated[str, Field(min_length=1, max_length=500)] | None = Field(
        None, description="the folder where verdicts are kept, or off"
    )


class DiffSection(StrictModel):
    """Options of ``diff``."""

    fail_on: FailOn | None = Field(None, alias="fail-on", description="the lowest class of change that fails")
    policy: Paths = Field((), description="ID=CLASS, or a file of them")


class LockSection(DiffSection):
    """Options of ``lock``."""

    file: str | None = Field(None, min_length=1, max_length=500, description="the lock file")


class Config(StrictModel):
    """The defaults of a repository."""

    specs: Paths = Field((), description="files and folders that check, generate and verify take without a path")
    strict: bool | None = Field(None, description="treat facts for which no document was found as errors")
    verify: VerifySection = VerifySection()
    diff: DiffSection = DiffSection()
    lock: LockSection = LockSection()


_SHAPE: FileShape[Config] = FileShape(model=Config, what=NAME, shape=f"{NAME} has keys and tables")


def find_config(folder: Path) -> Path | None:
    """The file of the folder, or of the next one above in the same repository (as far as ``.git``)."""
    above = (folder, *folder.parents)
    root = next((place for place, each in enumerate(above) if (each / ".git").exists()), 0)
    return next((each / NAME for each in above[: root + 1] if (each / NAME).is_file()), None)


def default_map(verb: str) -> dict[str, Any]:
    """The parameters of a verb that the file of the current folder says something about, as click wants them.

    Raises:
        DiagnosticError: with everything wrong in the file.
    """
    file = find_config(Path.cwd())
    if file is None:
        return {}
    shown = file.name if file.parent == Path.cwd() else os.path.relpath(file)
    return defaults(load_config(Path(shown)), Path(shown).parent, verb)


def load_config(file: Path) -> Config:
    """Read and validate the file.

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
    if config is None:
        raise DiagnosticError([Diagnostic("PG101", "not readable", Span(file.as_posix()))])
    return config


def _files(config: Config) -> Iterator[tuple[tuple[str, ...], str]]:
    """Every path in the file, with the keys that lead to it."""
    yield from ((("specs",), name) for name in config.specs)
    for section, policy in (("diff", config.diff.policy), ("lock", config.lock.policy)):
        yield from (((section, "policy"), name) for name in policy if "=" not in name)
    if config.lock.file is not None:
        yield ("lock", "file"), config.lock.file
    if config.verify.cache not in {None, "off"}:
        yield ("verify", "cache"), str(config.verify.cache)


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
        kept = config.verify.cache
        found |= {"engine": config.verify.engine, "oracle": config.verify.oracle}
        found["cache"] = None if kept is None else Path(kept) if kept == "off" else folder / kept
    if verb in {"diff", "lock"}:
        section = config.diff if verb == "diff" else config.lock
        policy = tuple(each if "=" in each else str(folder / each) for each in section.policy)
        found |= {"fail_on": section.fail_on, "policy": policy or None}
    if verb in {"lock", "review"} and config.lock.file is not None:
        found["path" if verb == "lock" else "lock"] = folder / config.lock.file
    return {key: value for key, value in found.items() if value is not None}
