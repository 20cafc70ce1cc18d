"""Other programs: found where the user installed programs, never where he happens to stand."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path, PurePath, PurePosixPath, PureWindowsPath


def find_program(name: str) -> str | None:
    """Absolute path of a program in one of the folders of PATH; None if it is not there.

    The current folder is left out, also if PATH names it: Windows and ``shutil.which`` look there first, and it may be
    a repository of somebody else with a ``git.exe`` in it.
    """
    windows = sys.platform == "win32"
    here = Path.cwd().resolve()
    for candidate in candidates(name, os.environ.get("PATH", ""), windows=windows):
        path = Path(candidate)
        try:
            if path.is_file() and os.access(path, os.X_OK) and path.parent.resolve() != here:
                return str(path)
        except OSError:
            continue
    return None


def candidates(name: str, path: str, *, windows: bool) -> Iterator[PurePath]:
    """Where a program may be by the variable PATH: in absolute folders only.

    On Windows it is an ``.exe``: a batch file would hand its arguments to a shell.
    """
    kind = PureWindowsPath if windows else PurePosixPath
    for folder in path.split(";" if windows else ":"):
        where = kind(folder.strip('"') if windows else folder)
        if where.is_absolute():
            yield where / (f"{name}.exe" if windows else name)
