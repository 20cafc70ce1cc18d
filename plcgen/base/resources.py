"""Where the files that ship with the tool lie (beside the package, or inside it in a wheel)."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parents[1]


def _locate(installed: str, checkout: str) -> Path:
    inside = _PACKAGE / installed
    return inside if inside.is_dir() else _PACKAGE.parent / checkout


def templates_dir() -> Path:
    """Directory of the Jinja2 templates."""
    return _locate("_templates", "templates")


def specs_dir() -> Path:
    """Directory of the shipped job specs, device profiles and parameter catalogues."""
    return _locate("_specs", "specs")


def docs_dir() -> Path:
    """Directory of the documentation."""
    return _locate("_docs", "docs")


def documented() -> dict[str, Path]:
    """Every page of the documentation by its name, ``spec`` or ``codes/PG209``."""
    folder = docs_dir()
    return {path.relative_to(folder).with_suffix("").as_posix(): path for path in sorted(folder.rglob("*.md"))}
