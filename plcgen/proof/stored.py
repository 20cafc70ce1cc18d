"""Results as JSON, for caches; names of files do not depend on where the folder lies."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from pydantic import TypeAdapter

from plcgen.proof.results import Result

RESULT: TypeAdapter[Result] = TypeAdapter(Result)


def portable(result: Result, folder: Path) -> Result:
    """With the names of files below the folder, and the counters of these alone."""

    def name(file: str) -> str:
        path = Path(file)
        return path.relative_to(folder).as_posix() if path.is_relative_to(folder) else file

    counts = {name(file): own for file, own in result.counts.items() if Path(file).is_relative_to(folder)}
    failures = [replace(failure, file=name(failure.file)) for failure in result.failures]
    return replace(result, counts=counts, failures=failures)


def with_folder(result: Result, folder: Path) -> Result:
    """The same for the files of a folder."""

    def file(name: str) -> str:
        return str(folder / name) if name and (folder / name).is_file() else name

    failures = [replace(failure, file=file(failure.file)) for failure in result.failures]
    return replace(result, counts={str(folder / name): own for name, own in result.counts.items()}, failures=failures)
