"""Specs of the command line: files as they are named, and those below a folder."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.api import default_folder
from plcgen.base.diagnostics.counting import quantity
from plcgen.base.files.files import YAML_SUFFIXES

if TYPE_CHECKING:
    from plcgen.cli.output import Console

MAX_SEEN = 200_000
"""So many entries of a folder tree are looked at."""
SUFFIXES = (".plcgen.yaml", ".plcgen.yml")
"""What a file that ends in it is, nobody needs to guess."""
SURE = frozenset({"plc", "ppi"})
"""Top-level keys that nothing but a spec has."""
SHARED = frozenset({"jobs", "include"})
"""Those that pipelines and other tools have, too: what else the file has decides."""
COMMON = frozenset({"version", "variables"})
"""Those that say nothing."""
_NAMES = 8
"""So many names are written in a line."""
_FIRST = re.compile(r"^([ ]*)(?!---|[ #%\r])(\S)", re.MULTILINE)
"""Where the keys of a document begin."""
_KEY = r"""(?:"([\w .-]+)"|'([\w .-]+)'|([\w.-]+))[ \t]*:(?=[ \t\r]|$)(?![ \t]*(?:#.*)?\r?\n[ ]*- )"""
"""A key as a block begins it, if no list follows: pipelines have a list of jobs."""
_ALWAYS = r"""["']?(include|plc|ppi)["']?[ \t]*:"""
_IN_BRACES = re.compile(r""""((?:[^"\\\n]|\\.)*)"?|'([^'\n]*)'?|(#[^\n]*)|([{\[])|([}\]])|([\w.-]+)|(:)""")


@dataclass(frozen=True, slots=True)
class Below:
    """What of a folder is a spec, and what is left: parts of the specs, and YAML files of others.

    ``misspelt`` are specs by a key that is nearly one: the key as it stands, and what it should be.
    """

    specs: Sequence[Path] = ()
    parts: Sequence[Path] = ()
    others: Sequence[Path] = ()
    misspelt: Mapping[Path, tuple[str, str]] = field(default_factory=dict)

    def told(self) -> Iterator[str]:
        """What was taken and what was left, a line each."""
        named = [f"{path}{self._key(path)}" for path in self.specs]
        if named:
            yield f"{quantity(len(named), 'spec')}: {_listed(named)}"
        if self.parts:
            yield f"not on their own, a spec includes them: {_listed(map(str, self.parts))}"
        if self.others:
            yield f"left, no specs: {_listed(map(str, self.others))}"

    def _key(self, path: Path) -> str:
        written, meant = self.misspelt.get(path, ("", ""))
        return f' (its "{written}" should be "{meant}")' if written else ""


def _listed(names: Iterable[str]) -> str:
    shown = list(names)
    more = f" and {len(shown) - _NAMES} more" if len(shown) > _NAMES else ""
    return ", ".join(shown[:_NAMES]) + more


def specs_below(folder: Path) -> Below:
    """Specs in a folder and below: YAML files that are named or begin like one and that no other of them includes.

    Hidden ones and links to folders are left out. One that cannot be read counts: reading it says why.

    Raises:
        OSError: if a folder cannot be read.
        DiagnosticError: PG802 if there are too many files to look at.
    """
    found, others, misspelt = list[Path](), list[Path](), dict[Path, tuple[str, str]]()
    for path in sorted(_files(folder)):
        keys = _keys(path)
        written, meant = ("", "") if keys is None else _mark(keys)
        if keys is None or written or path.name.lower().endswith(SUFFIXES):
            found.append(path)
            if written != meant:
                misspelt[path] = (written, meant)
        else:
            others.append(path)
    included = {path: set(_included(path)) for path in found}
    parts = set[Path]().union(*included.values())
    tops = [path for path in found if path.resolve() not in parts]
    reached = set[Path]().union(*(included[path] for path in tops))  # not those that only include each other
    return Below(
        [path for path in found if path.resolve() not in reached],
        [path for path in (*found, *others) if path.resolve() in reached],
        [path for path in others if path.resolve() not in reached],
        misspelt,
    )


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


def find_specs(paths: Sequence[Path], out: Console) -> list[Path]:
    """The named files, and of each folder the specs in it, each once; without any those of ``plcgen.toml``.

    What of a folder was taken and what was left is reported.

    Raises:
        UsageError: if there is none, or none in a folder.
    """
    found: list[Path] = []
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


def _keys(path: Path) -> list[str] | None:
    """The keys of a YAML file, in a block or in braces as JSON has it, without those of lists; None: it is not read."""
    from plcgen.base.files.files import read_bounded
    from plcgen.base.files.text import decoded_list
    from plcgen.base.files.yaml import MAX_BYTES

    try:
        text = decoded_list(read_bounded(path, MAX_BYTES))
    except OSError:
        return None
    first = _FIRST.search(text)
    if first is None:
        return []
    if first[2] in "{[":
        return list(_keys_in_braces(text, first.start(2)))
    return [
        next(filter(None, each.groups()))
        for each in re.finditer(f"^{first[1]}(?:{_KEY}|{_ALWAYS})", text, re.MULTILINE)
    ]


def _keys_in_braces(text: str, start: int) -> Iterator[str]:
    """The keys of the outer braces."""
    depth, last = 0, ""
    for token in _IN_BRACES.finditer(text, start):
        depth += (token[4] is not None) - (token[5] is not None)
        if token[7] and depth == 1 and last:
            yield last
        last = token[1] or token[2] or token[6] or ""
        if depth <= 0:
            return


def _mark(keys: Sequence[str]) -> tuple[str, str]:
    """The key by which a file is a spec, as it stands and as it should be; empty if it is none.

    One that other tools have, too, or that is misspelt, counts if more than half of the keys are a spec's, and one of
    them at least in full.
    """
    from plcgen.base.diagnostics.suggest import one_letter_wrong
    from plcgen.project.loading import spec_keys

    sure = next((key for key in keys if key in SURE), "")
    if sure:
        return sure, sure
    known = [name for name in spec_keys(()) if name not in COMMON]
    meant = {
        key: next((name for name in known if key.lower() == name or one_letter_wrong(key.lower(), name)), "")
        for key in keys
        if key.lower() not in COMMON
    }
    right = [key for key, name in meant.items() if key.lower() == name]
    if not right or 2 * sum(map(bool, meant.values())) <= len(meant):
        return "", ""
    marks = ((key, name) for key, name in meant.items() if name in SURE | SHARED)
    return next(marks, ("", ""))
