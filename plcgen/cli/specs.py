"""Specs of the command line: files as they are named, and those below a folder."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import click

from plcgen.api import default_folder
from plcgen.base.files.files import YAML_SUFFIXES

MAX_SEEN = 200_000
"""So many entries of a folder tree are looked at."""
_PLC = r"[\"']?plc[\"']?[ \t]*:"
"""What a spec has, and no drive file, device profile, lock or workflow."""
_FIRST = re.compile(r"^([ ]*)(?!---|[ #%\r])(\S)", re.MULTILINE)
"""Where the keys of a document begin."""


def specs_below(folder: Path) -> list[Path]:
    """Specs in a folder and below: YAML files with a section ``plc`` that no other of them includes.

    Hidden ones and links to folders are left out. One that cannot be read counts: reading it says why.

    Raises:
        OSError: if a folder cannot be read.
        DiagnosticError: PG802 if there are too many files to look at.
    """
    found = sorted(path for path in _files(folder) if _is_spec(path))
    parts = {part for path in found for part in _included(path)}
    return [path for path in found if path.resolve() not in parts] if parts else found


def _included(spec: Path) -> Iterator[Path]:
    """The files that a spec includes, as far as they can be read."""
    from plcgen.base.diagnostics import DiagnosticError
    from plcgen.base.files.text import read_text
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


def _files(folder: Path) -> Iterator[Path]:
    """The YAML files of a folder and below."""
    from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
    from plcgen.base.files.files import walk

    seen = 0
    for where, folders, files in walk(folder):
        seen += len(folders) + len(files)
        if seen > MAX_SEEN:
            message = f"more than {MAX_SEEN} files below this folder"
            raise DiagnosticError([Diagnostic("PG802", message, Span(str(folder)), help="name a smaller folder")])
        yield from (where / name for name in files if Path(name).suffix.lower() in YAML_SUFFIXES)


def _is_spec(path: Path) -> bool:
    """Whether a YAML file has the section, as a block or in braces as JSON has it; True if it cannot be read."""
    from plcgen.base.files.files import read_bounded
    from plcgen.base.files.text import decoded_list
    from plcgen.base.files.yaml import MAX_BYTES

    try:
        text = decoded_list(read_bounded(path, MAX_BYTES))
    except OSError:
        return True
    first = _FIRST.search(text)
    if first is None:
        return False
    before = r"[{,]\s*" if first[2] == "{" else f"^{first[1]}"
    return re.search(before + _PLC, text, re.MULTILINE) is not None
