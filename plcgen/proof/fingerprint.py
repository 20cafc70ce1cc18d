"""What a verdict depends on besides the project: every file of this copy of plcgen, and what runs it."""

from __future__ import annotations

import hashlib
import platform
import sys
from functools import lru_cache
from pathlib import Path

from plcgen._version import __version__
from plcgen.base.plugins import offered
from plcgen.base.resources import specs_dir, templates_dir

LIBRARIES = ("jinja2", "lxml", "click", "pydantic", "PyYAML")


@lru_cache(maxsize=1)
def fingerprint() -> str:
    """Hash over the version, the Python and libraries that run it, and every file of code, data and templates."""
    from importlib.metadata import PackageNotFoundError, version

    said = [__version__, sys.version, platform.machine()]
    for name in LIBRARIES:
        try:
            said.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            said.append(name)
    folders = (Path(__file__).resolve().parent.parent, templates_dir(), specs_dir())
    return files_digest(folders, "\n".join(said))


def has_plugins() -> bool:
    """Whether code of others takes part, of which nobody knows what it reads."""
    return any(group.startswith("plcgen.") for group in offered(tuple(sys.path)).groups)


def files_digest(folders: tuple[Path, ...], said: str = "") -> str:
    """Hash over the names and contents of all files below some folders."""
    digest = hashlib.sha256(said.encode())
    for number, folder in enumerate(folders):
        for path in sorted(folder.rglob("*")):
            name = path.relative_to(folder)
            if "__pycache__" in name.parts or not path.is_file():
                continue
            data = path.read_bytes()
            digest.update(f"\n{number} {name.as_posix()} {len(data)}\n".encode(errors="surrogatepass"))
            digest.update(data)
    return digest.hexdigest()
