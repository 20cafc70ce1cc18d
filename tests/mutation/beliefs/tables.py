"""The corpus: tables of single breaks, each a replacement in one file of the source.

A table is a TOML file in ``tables``. ``[specs]`` has the specs that its breaks try, by name; any other name is a
shipped spec. Every ``[[break]]`` says

- ``id``: a name, once in all tables; ``what``: what a plant would suffer from
- ``file``, ``old``, ``new``: ``old`` stands exactly once in the file and becomes ``new``
- ``spec``: the name of a spec that uses the fact, or a list of names: it is noticed if one of them is red
- ``reason``: why nobody notices it; a reason for a break that is noticed is a mistake in the table
- ``sample``: whether the tests run it
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
TABLES = Path(__file__).parent / "tables"


@dataclass(frozen=True, slots=True)
class Break:
    """One fact that is wrong: ``old`` in ``file`` becomes ``new``; ``specs`` are texts of specs that use it."""

    id: str
    what: str
    file: str
    old: str
    new: str
    specs: tuple[str, ...]
    reason: str = ""
    sample: bool = False

    def broken(self, text: str) -> str:
        """The file with the wrong fact.

        Raises:
            LookupError: the file does not have it, or has it more than once: the table is out of date.
        """
        found = text.count(self.old)
        if found != 1 or self.old == self.new:
            raise LookupError(f"{self.id}: {self.old!r} is {found} times in {self.file}, not once")
        return text.replace(self.old, self.new)


def names() -> list[str]:
    """Names of all tables."""
    return sorted(path.stem for path in TABLES.glob("*.toml"))


def breaks(tables: Iterable[str]) -> Iterator[Break]:
    """Every break of some tables.

    Raises:
        LookupError: a break is not in its file.
    """
    for name in tables:
        table = tomllib.loads((TABLES / f"{name}.toml").read_text("utf-8"))
        for row in table["break"]:
            wanted = row.pop("spec")
            chosen = [wanted] if isinstance(wanted, str) else wanted
            made = Break(specs=tuple(_spec(one, table.get("specs", {})) for one in chosen), **row)
            made.broken((ROOT / made.file).read_text("utf-8"))
            yield made


def _spec(name: str, own: dict[str, str]) -> str:
    return own[name] if name in own else (ROOT / "specs" / f"{name}.yaml").read_text("utf-8")
