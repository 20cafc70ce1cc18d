"""A revision in git as files on disk for a while.

Only specs, profiles, sources and locks are read, blob by blob, of bounded number and size; nothing is checked out, no
attribute, filter or hook of the repository runs.
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path, PurePosixPath
from typing import Any

from plcgen.base.diagnostics import DiagnosticError, Span
from plcgen.base.files.files import YAML_SUFFIXES
from plcgen.base.files.options import usage
from plcgen.base.paths import trap_in
from plcgen.base.programs import find_program
from plcgen.s7.compare.model import Comparison
from plcgen.s7.read.files import TEXT_SUFFIXES, XML_SUFFIXES

MAX_BYTES = 64 * 1024 * 1024
MAX_FILES = 20_000
"""Of a revision, all files together."""

_SOURCES = frozenset({*TEXT_SUFFIXES, *XML_SUFFIXES, ".s7res", ".sdf", ".asc", ".json"})
_FILES = "100"
"""Git's modes of regular files begin like this; links and submodules are left alone."""


def fetched(option: str, revision: str, paths: Sequence[Path], room: Path, top: Path) -> tuple[str, list[Path]]:
    """Copy what a revision has of ``paths``, and every spec, into ``room``: the revision as people know it, the copies.

    ``top`` is the folder of the repository.

    Raises:
        DiagnosticError: PG901 at ``option`` if there is no such revision, or it has too much.
    """
    place = f"{option} {revision}".lstrip()
    name = f"{revision}^{{commit}}"
    arguments = ["rev-parse", "--verify", "--quiet", "--end-of-options", name]
    commit = _git(place, top, arguments, revision).decode().strip()
    inside = [_relative(option or revision, path, top) for path in paths]
    wanted: list[tuple[str, str]] = []
    left = MAX_BYTES
    for line in _git(place, top, ["ls-tree", "-r", "-z", "-l", commit], revision).split(b"\0"):
        head, _, raw = line.partition(b"\t")
        entry = head.decode("ascii", "replace").split()
        path = raw.decode("utf-8", "surrogateescape")
        if len(entry) != 4 or not entry[0].startswith(_FILES) or not _of_interest(path, inside):
            continue
        left -= int(entry[3])
        wanted.append((entry[2], path))
        if left < 0 or len(wanted) > MAX_FILES:
            raise usage(place, "the revision has too many specs and sources to be compared")
    _fetch(place, top, wanted, room, revision)
    return f"{revision} ({commit[:12]})", [room / path for path in inside]


def revisions(folder: Path, most: int) -> list[tuple[str, str]]:
    """Branches, tags and the last commits of a folder's repository, each with what it is; none if it is in none."""
    log = ["-c", "log.showSignature=false", "log", f"-n{most}", "--format=%h%x09%cs %s", "--", "."]
    refs = ["for-each-ref", f"--count={most}", "--format=%(refname:short)%09%(committerdate:short) %(contents:subject)"]
    try:
        lines = b"".join(_git("", folder, one, "") for one in (log, refs)).decode("utf-8", "replace").split("\n")
    except DiagnosticError:
        return []
    return [(name, text) for name, _, text in (line.partition("\t") for line in lines) if name]


def top_of(place: str, path: Path, revision: str) -> Path:
    """The folder of the repository that a path lies in."""
    where = path.absolute() if path.is_dir() else path.absolute().parent
    return Path(_git(place, where, ["rev-parse", "--show-toplevel"], revision).decode().strip()).resolve()


def named(comparison: Comparison, label: str, root: str) -> Comparison:
    """A comparison with the paths of a base under ``root`` as people know them; all of it if there is no root."""
    if not root:
        return comparison
    known: Callable[[Span | None], Any] = partial(_known, label, root)  # a span of a span, None of None
    diagnostics = tuple(
        replace(
            d,
            span=known(d.span),
            message=d.message.replace(root, f"{label}: "),
            notes=tuple(replace(note, span=known(note.span)) for note in d.notes),
        )
        for d in comparison.diagnostics
    )
    changes = tuple(replace(c, old_span=known(c.old_span), new_span=known(c.new_span)) for c in comparison.changes)
    sentences = tuple(replace(one, span=known(one.span)) for one in comparison.sentences)
    old, new = (f"{text}/".replace(root, f"{label}: ")[:-1] for text in (comparison.old, comparison.new))
    return replace(comparison, old=old, new=new, diagnostics=diagnostics, changes=changes, sentences=sentences)


def _known(label: str, root: str, span: Span | None) -> Span | None:
    return span and replace(span, file=span.file.replace(root, f"{label}: "))


def _relative(place: str, path: Path, top: Path) -> str:
    full = path.resolve()
    if not full.is_relative_to(top):
        raise usage(place, f"{path} is not in the repository of the spec", "name a folder to compare with")
    return full.relative_to(top).as_posix()


def _of_interest(path: str, inside: Sequence[str]) -> bool:
    """What is asked for, sources below it, and specs and profiles anywhere, since a spec may name them."""
    if trap_in(path):
        return False
    suffix = PurePosixPath(path).suffix.lower()
    below = any(one == "." or path.startswith(f"{one}/") for one in inside)
    return path in inside or suffix in YAML_SUFFIXES or (below and suffix in _SOURCES)


def _fetch(place: str, top: Path, wanted: Sequence[tuple[str, str]], room: Path, revision: str) -> None:
    asked = "".join(f"{blob}\n" for blob, _ in wanted).encode()
    answer = _git(place, top, ["cat-file", "--batch"], revision, asked)
    at = 0
    for _, path in wanted:
        end = answer.index(b"\n", at)
        size = int(answer[at:end].split()[2])
        target = room / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(answer[end + 1 : end + 1 + size])
        at = end + 2 + size


def _git(place: str, where: Path, arguments: Sequence[str], revision: str, given: bytes = b"") -> bytes:
    program = find_program("git")
    if program is None:
        raise usage(place, "there is no such folder, and git is not installed", "name a folder or a spec")
    environment = {**os.environ, "GIT_TERMINAL_PROMPT": "0", "GIT_NO_LAZY_FETCH": "1", "LC_ALL": "C"}
    done = subprocess.run(  # noqa: S603 - git itself, arguments as a list
        [program, "-C", str(where), *arguments], input=given, capture_output=True, check=False, env=environment
    )
    if done.returncode:
        help_ = "name a folder, a spec, or a revision that git rev-parse knows, for example HEAD~1 or origin/main"
        raise usage(place, f'"{revision}" is not a folder, a spec or a git revision here', help_)
    return done.stdout
