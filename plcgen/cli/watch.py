"""``--watch``: run a verb again when a file of its specs or sources changes, until Ctrl-C."""

from __future__ import annotations

import functools
import os
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import Any, TypeVar

import click

from plcgen.api import default_folder
from plcgen.base.diagnostics.counting import quantity
from plcgen.cli.options import console
from plcgen.cli.output import OK, Console

Callback = TypeVar("Callback", bound=Callable[..., Any])

PAUSE = 0.5
"""Seconds between two looks."""
MAX_WATCHED = 20_000
"""So many entries of a folder tree are looked at."""
SUFFIXES = frozenset(
    {".yaml", ".yml", ".toml", ".scl", ".udt", ".db", ".awl", ".stl", ".xml", ".sdf", ".asc", ".csv", ".json", ".inp"}
    | {".s7dcl", ".s7res"}
)
State = dict[Path, tuple[int, int]]
"""Time of the last change in nanoseconds and size of each file."""

pause = time.sleep


def watch_option(*, generated: bool) -> Callable[[Callback], Callback]:
    """Add ``--watch`` to a verb with ``paths``, ``folder`` and ``format_``; ``generated``: it reads that folder."""

    def add(verb: Callback) -> Callback:
        @functools.wraps(verb)
        def watching(*, watch: bool, **given: Any) -> int:
            if not watch:
                code: int = verb(**given)
                return code
            if given["format_"].name != "text" and given.get("output") is None:
                file = "; a result in another format needs a file: --output FILE" if "output" in given else " only"
                raise click.UsageError(f"--watch shows text{file}")
            return again(console(), lambda: verb(**given), lambda: state(_files(given, generated=generated)))

        return click.option("--watch", is_flag=True, help="Run again when a file changes, until Ctrl-C.")(watching)  # type: ignore[return-value]

    return add


def again(out: Console, run: Callable[[], int], look: Callable[[], State]) -> int:
    """Run, wait for a change that has settled, run again; Ctrl-C is the end, and no error."""
    try:
        while True:
            before = look()
            _run(out, run)
            out.say(f"watching {quantity(len(before), 'file')}; Ctrl-C ends")
            after = _changed(before, look)
            out.say(f"\n{_what(before, after)}")
    except KeyboardInterrupt:
        out.say("")
        return OK


def _run(out: Console, run: Callable[[], int]) -> None:
    """A mistake that ends a single run does not end the watch: it may be gone after the next change."""
    from plcgen.base.diagnostics import DiagnosticError

    try:
        run()
    except DiagnosticError as problem:
        out.complain(problem.diagnostics)
    except click.UsageError as problem:
        out.say(f"error: {problem.format_message()}")


def _changed(before: State, look: Callable[[], State]) -> State:
    """Wait until something is different and stays so from one look to the next: an editor may write in steps."""
    last = before
    while True:
        pause(PAUSE)
        now = look()
        if now != before and now == last:
            return now
        last = now


def _what(before: State, after: State) -> str:
    files = sorted(path for path in before.keys() | after.keys() if before.get(path) != after.get(path))
    more = f" and {len(files) - 1} more" if len(files) > 1 else ""
    verb = "is new" if files[0] not in before else "is gone" if files[0] not in after else "has changed"
    return f"{files[0]}{more} {verb}"


def state(files: Iterable[Path]) -> State:
    """What a look sees."""
    found: State = {}
    for path in files:
        try:
            status = path.stat()
        except OSError:
            continue
        found[path] = (status.st_mtime_ns, status.st_size)
    return found


def _files(given: dict[str, Any], *, generated: bool) -> Iterator[Path]:
    """Files that a spec or source may read: its folder and below, without what the verb itself writes."""
    from plcgen.cli.specs import named

    paths: Sequence[Path] = named(given["paths"])
    folders = {path if path.is_dir() else path.parent for path in paths}
    single = [each for key in ("drive", "baseline") if isinstance(each := given.get(key), Path)]
    single += [path for path in (*paths, *given.get("tags", ())) if not path.is_dir()]
    folder: Path | None = given.get("folder")
    if generated:
        specs = [path for path in paths if not path.is_dir()]
        folders |= {folder} if folder is not None else {default_folder(spec) for spec in specs}
    left = None if generated else folder.resolve() if folder is not None else None
    output = given.get("output")
    seen: dict[Path, None] = dict.fromkeys(single)
    for each in sorted(folders):
        seen |= dict.fromkeys(islice(_below(each, left, generated=generated), MAX_WATCHED))
    return (path for path in seen if path != output)


def _below(folder: Path, left: Path | None, *, generated: bool) -> Iterator[Path]:
    from plcgen.s7.read.generated import MANIFEST

    for name, folders, files in os.walk(folder):
        made = MANIFEST in files and not generated
        if made or (left is not None and Path(name).resolve() == left):
            folders[:] = []
            continue
        folders[:] = sorted(each for each in folders if not each.startswith("."))
        yield from (Path(name, each) for each in sorted(files) if Path(each).suffix.lower() in SUFFIXES)
