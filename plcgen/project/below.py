"""Which YAML files of a folder are specs: by their names and keys, without those that others include."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.diagnostics.counting import quantity
from plcgen.base.diagnostics.suggest import one_letter_wrong
from plcgen.base.files.files import YAML_SUFFIXES, read_bounded, walk
from plcgen.base.files.text import decoded_list, read_text
from plcgen.base.files.yaml import MAX_BYTES
from plcgen.project.composing import included_files
from plcgen.project.loading import spec_keys

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
    try:
        text = read_text(spec)
    except DiagnosticError:
        return
    if "include" in text:
        yield from (path.resolve() for path in included_files(text, spec))


def _files(folder: Path) -> Iterator[Path]:
    """The YAML files of a folder and below."""
    seen = 0
    for where, folders, files in walk(folder):
        seen += len(folders) + len(files)
        if seen > MAX_SEEN:
            message = f"more than {MAX_SEEN} files below this folder"
            raise DiagnosticError([Diagnostic("PG802", message, Span(str(folder)), help="name a smaller folder")])
        yield from (where / name for name in files if Path(name).suffix.lower() in YAML_SUFFIXES)


def _keys(path: Path) -> list[str] | None:
    """The keys of a YAML file, in a block or in braces as JSON has it, without those of lists; None: it is not read."""
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
