"""``compare``: paths in, changes out."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Severity, Span, has_errors
from plcgen.base.diagnostics.counting import shortlist
from plcgen.base.files.files import YAML_SUFFIXES
from plcgen.base.files.options import usage
from plcgen.report.diff.jobs import compare_jobs
from plcgen.report.diff.lockfile import read_lock, reduced
from plcgen.report.diff.planned import spec_snapshot
from plcgen.report.diff.sentences import sentences
from plcgen.report.revision import fetched, named, top_of
from plcgen.s7.compare.blocks import compare_blocks
from plcgen.s7.compare.model import TAG_TABLE, Change, Comparison, Snapshot
from plcgen.s7.compare.policy import Level, load_policy
from plcgen.s7.compare.states import snapshot_of
from plcgen.s7.read.blocks import Sources, read_sources
from plcgen.s7.read.files import TEXT_SUFFIXES, XML_SUFFIXES

LOCKS = ".json"
_STATES = frozenset({*YAML_SUFFIXES, LOCKS})
_FILES = frozenset({*_STATES, *TEXT_SUFFIXES, *XML_SUFFIXES})
"""What ends like this is a file, whether it is there or not."""
_DERIVED = frozenset({"block-text", "member-comment"})
"""What follows from a change of the spec anyway, where both sides are specs. Code and start values do not: which bit an
input writes, what a sequence waits for and the records of a recipe are in no telegram."""


def compare(
    old: Sequence[Path],
    new: Sequence[Path],
    policy: Sequence[str] = (),
    *,
    classic: bool = False,
    keep_going: bool = False,
) -> Comparison:
    """Compare two sets of sources, folders or specs; every problem is a diagnostic of the result.

    A spec against sources means the sources that would be generated from it. ``keep_going``: files with errors are left
    out, with a warning.
    """
    try:
        levels = load_policy(policy)
        with TemporaryDirectory(prefix="plcgen-base-") as room:
            first, second = _side(old, new, Path(room, "old")), _side(new, old, Path(room, "new"))
            before, after = _both(first.paths, second.paths, classic=classic, keep_going=keep_going)
            result = compare_snapshots(before, after, levels, classic=classic)
    except DiagnosticError as problem:
        return Comparison(_label(old), _label(new), (), problem.diagnostics)
    for side in (first, second):
        result = named(result, side.label, side.root)
    return result


@dataclasses.dataclass(frozen=True, slots=True)
class _Side:
    """Paths of one side; those of a revision lie under ``root``, which means nothing to people."""

    paths: Sequence[Path]
    label: str = ""
    root: str = ""


def _side(paths: Sequence[Path], other: Sequence[Path], room: Path) -> _Side:
    """The paths as they are, or what a revision of git has of them: ``HEAD~1`` of the other side, ``HEAD~1:job.yaml``.

    Raises:
        DiagnosticError: PG901 if there is no such revision.
    """
    text = paths[0].as_posix()
    revision, _, inside = text.partition(":")
    file = paths[0].suffix.lower() in _FILES and not inside
    if len(paths) != 1 or paths[0].exists() or file or _is_void(paths) or len(revision) < 2:  # C: is a drive
        return _Side(paths)
    if not inside and not other[0].exists():
        raise usage(text, "neither side is a file or a folder", f"name one: {revision}:job.yaml")
    top = top_of(text, Path() if inside else other[0], revision)
    path = other[0] if not inside else Path(inside) if inside.startswith(".") else top / inside
    label, (found,) = fetched("", revision, [path], room, top)
    if not found.exists():
        raise usage(text, f"{label} has no {path.name}", f"what it has: git ls-tree -r --name-only {revision}")
    return _Side([found], label, f"{room.as_posix()}/")


def compare_snapshots(
    old: Snapshot, new: Snapshot, policy: Mapping[str, Level], *, classic: bool = False
) -> Comparison:
    """Compare two states."""
    diagnostics = tuple(dict.fromkeys([*old.diagnostics, *new.diagnostics]))
    if any(not side.blocks and has_errors(side.diagnostics) for side in (old, new)):
        return Comparison(old.label, new.label, (), diagnostics)
    changes = compare_jobs(old, new, policy)
    specs = old.jobs is not None or new.jobs is not None  # which have no tag tables
    before, after = ([block for block in side.blocks if not (specs and block.kind == TAG_TABLE)] for side in (old, new))
    blocks = compare_blocks(before, after, policy, comments=old.complete and new.complete, classic=classic)
    if old.jobs is not None and new.jobs is not None:
        twins = old.mirrored & new.mirrored
        blocks = [c for c in blocks if c.kind not in _DERIVED and not _is_twin(c, twins)]
        blocks = [dataclasses.replace(change, old_span=None, new_span=None) for change in blocks]
    told = sentences(old, new, changes)
    inside = _inside(old, new, {one.job for one in told}) if told else frozenset[str]()
    inside &= {change.subject for change in blocks}
    return Comparison(old.label, new.label, (*changes, *blocks), diagnostics, len(new.blocks), told, inside)


def _inside(old: Snapshot, new: Snapshot, told: set[str]) -> frozenset[str]:
    """Instances, and function blocks but for those of jobs of which nothing is told: what changes there follows."""
    jobs = [*(old.jobs or {}).values(), *(new.jobs or {}).values()]
    silent = {job.block for job in jobs} - {job.block for job in jobs if job.group in told}
    blocks = (block for side in (old, new) for block in side.blocks)
    return frozenset(b.title for b in blocks if b.instance_of or (b.kind == "FB" and b.name not in silent))


def _is_twin(change: Change, names: frozenset[str]) -> bool:
    """Whether the comparison of the telegrams says the same."""
    kind, _, name = change.subject.partition(" ")
    return name.strip('"').upper() in names and (kind.startswith("UDT") or change.kind == "start-value")


def _both(old: Sequence[Path], new: Sequence[Path], *, classic: bool, keep_going: bool) -> tuple[Snapshot, Snapshot]:
    """Both states; a type that only one side's files declare serves the other side too."""
    if any(path.suffix.lower() in _STATES for path in (*old, *new)):
        first, second = (snapshot(side, classic=classic, keep_going=keep_going) for side in (old, new))
        locked = any(path.suffix.lower() == LOCKS for path in (*old, *new))
        return (reduced(first), reduced(second)) if locked else (first, second)
    before, after = (_read(side, classic=classic, keep_going=keep_going) for side in (old, new))
    lent = dict(before.types)
    for side, other in ((before, after.types), (after, lent)):
        for part in (side, *side.parts.values()):
            for name, block in other.items():
                part.types.setdefault(name, block)
    return snapshot_of(before, _label(old)), snapshot_of(after, _label(new))


def snapshot(paths: Sequence[Path], *, classic: bool = False, keep_going: bool = False) -> Snapshot:
    """State of a spec or a lock, or of files and folders; a spec or lock stands alone."""
    specs = [path for path in paths if path.suffix.lower() in _STATES]
    if not specs:
        return snapshot_of(_read(paths, classic=classic, keep_going=keep_going), _label(paths))
    if len(paths) > 1:
        message = "a spec or lock is compared on its own: name it without other files"
        return Snapshot(_label(paths), diagnostics=[Diagnostic("PG632", message, Span(str(specs[0])))])
    if specs[0].suffix.lower() != LOCKS:
        return spec_snapshot(specs[0])
    try:
        return read_lock(specs[0]).snapshot
    except DiagnosticError as wrong:
        return Snapshot(_label(paths), diagnostics=list(wrong.diagnostics))


def _read(paths: Sequence[Path], *, classic: bool, keep_going: bool) -> Sources:
    """Read the sources of one side; what would never be compared is an error.

    That is a second declaration of a block, and files in which there is neither a block nor a tag table.
    """
    found = read_sources(paths, classic=classic)
    found.diagnostics[:] = [
        dataclasses.replace(d, severity=Severity.ERROR) if d.code == "PG805" else d for d in found.diagnostics
    ]
    if keep_going:
        _leave_out(found)
    if not (found.blocks or found.tables) and not has_errors(found.diagnostics) and not _is_void(paths):
        found.diagnostics.append(Diagnostic("PG804", "there is no block in these files", Span(str(paths[0]))))
    return found


def _leave_out(sources: Sources) -> None:
    """Without the files that have errors, each of which becomes a warning."""
    bad = {d.span.file for d in sources.diagnostics if d.severity is Severity.ERROR}
    for part in (sources, *sources.parts.values()):
        part.blocks = [block for block in part.blocks if block.file not in bad]
    sources.diagnostics[:] = [
        dataclasses.replace(d, severity=Severity.WARNING, message=f"left out: {d.message}")
        if d.severity is Severity.ERROR
        else d
        for d in sources.diagnostics
    ]


def _is_void(paths: Sequence[Path]) -> bool:
    """Whether there is nothing to read on purpose: git names the null device for a file that one side lacks."""
    return all(path == Path(os.devnull) for path in paths)


def _label(paths: Sequence[Path]) -> str:
    return shortlist([path.as_posix() for path in paths], 3, f" (+{len(paths) - 3})")
