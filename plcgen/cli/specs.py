"""Specs of the command line: files as they are named, and those below a folder."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path

import click

from plcgen.input.files import YAML_SUFFIXES

MAX_SEEN = 200_000
"""So many entries of a folder tree are looked at."""
_PLC = re.compile(rb"^(?:\xef\xbb\xbf)?(?:\{[ ]*)?[\"']?plc[\"']?[ \t]*:", re.MULTILINE)
"""What a spec has, and no drive file, device profile, lock or workflow."""


def specs_below(folder: Path) -> list[Path]:
    """Specs in a folder and below: YAML files with a section ``plc`` that no other of them includes.

    Hidden ones and links to folders are left out.
    """
    found = sorted(
        path for path in islice(_files(folder), MAX_SEEN) if path.suffix.lower() in YAML_SUFFIXES and _is_spec(path)
    )
    parts = {part for path in found for part in _included(path)}
    return [path for path in found if path.resolve() not in parts] if parts else found


def _included(spec: Path) -> Iterator[Path]:
    """The files that a spec includes, as far as they can be read."""
    from plcgen.diagnostics import DiagnosticError
    from plcgen.input.text import read_text
    from plcgen.project.composing import included_files

    try:
        text = read_text(spec)
    except DiagnosticError:
        return
    if "include" in text:
        yield from (path.resolve() for path in included_files(text, spec))


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


def find_specs(paths: Sequence[Path]) -> list[Path]:
    """The named files, and of each folder the specs in it, each once; without any those of ``plcgen.toml``.

    Raises:
        UsageError: if there is none, or none in a folder.
    """
    found: list[Path] = []
    for path in named(paths):
        below = [path] if path.suffix.lower() in YAML_SUFFIXES or not path.is_dir() else specs_below(path)
        if not below:
            raise click.UsageError(f"there is no spec (a YAML file with plc:) below {path}")
        found += below
    return list(dict.fromkeys(found))


def one_folder(specs: Sequence[Path], folder: Path | None) -> None:
    """Refuse ``--out`` for several specs: each has a folder of its own."""
    if folder is not None and len(specs) > 1:
        raise click.UsageError(f"--out is the folder of one spec, not of {len(specs)}: leave it out, or name one spec")


def _files(folder: Path) -> Iterator[Path]:
    for name, folders, files in os.walk(folder):
        folders[:] = sorted(each for each in folders if not each.startswith("."))
        yield from (Path(name, each) for each in sorted(files) if not each.startswith("."))


def _is_spec(path: Path) -> bool:
    from plcgen.input.files import read_bounded
    from plcgen.input.yaml import MAX_BYTES

    try:
        return _PLC.search(read_bounded(path, MAX_BYTES)) is not None
    except OSError:
        return False
