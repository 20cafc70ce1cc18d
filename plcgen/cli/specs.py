"""Specs of the command line: files as they are named, and those of folders."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.api import default_folder
from plcgen.base.files.files import YAML_SUFFIXES

if TYPE_CHECKING:
    from plcgen.cli.output import Console
    from plcgen.project.below import Below


def named(paths: Sequence[Path]) -> tuple[Path, ...]:
    """The paths of the command line, else those of ``plcgen.toml``.

    Raises:
        UsageError: if there are none.
    """
    ctx = click.get_current_context()
    found: tuple[Path, ...] = tuple(paths) or (ctx.default_map or {}).get("paths", ())
    if not found:
        raise click.UsageError('name a spec or a folder, or set "specs" in plcgen.toml', ctx)
    return found


def find_specs(paths: Sequence[Path], out: Console) -> list[Path]:
    """The named files, and of each folder the specs in it, each once; without any those of ``plcgen.toml``.

    What of a folder was taken and what was left is reported.

    Raises:
        UsageError: if there is none, or none in a folder.
    """
    found: list[Path] = []
    from plcgen.project.below import specs_below

    for path in named(paths):
        if path.suffix.lower() in YAML_SUFFIXES or not path.is_dir():
            found.append(path)
            continue
        below = specs_below(path)
        tell(below, out)
        if not below.specs:
            raise click.UsageError(f"there is no spec ({SPEC}) below {path}")
        found += below.specs
    return list(dict.fromkeys(found))


SPEC = "a YAML file with plc, jobs, ppi or include, or named *.plcgen.yaml"


def tell(below: Below, out: Console) -> None:
    """Say what of a folder was taken and what was left."""
    for line in below.told():
        out.say(line)


def one_folder(specs: Sequence[Path], folder: Path | None) -> None:
    """Refuse ``--out`` for several specs, and specs that differ in their suffix only: each has a folder of its own."""
    if folder is not None and len(specs) > 1:
        raise click.UsageError(f"--out is the folder of one spec, not of {len(specs)}: leave it out, or name one spec")
    made: dict[Path, Path] = {}
    for spec in specs:
        other = made.setdefault(default_folder(spec), spec)
        if other != spec:
            raise click.UsageError(
                f"{other} and {spec} have the same folder {default_folder(spec)}: rename one of them"
            )
