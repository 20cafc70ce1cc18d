"""The generated lines of one block."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field

_LOCAL = re.compile(r"\bc[0-9]+\b")


@dataclass(slots=True, eq=False)
class Listing:
    """Lines of Python; ``map`` has the line of SCL of each, ``line`` is that of the next one.

    ``folds`` are the lines that put a value into a cached local, with its name: often nobody reads it again.
    """

    lines: list[str] = field(default_factory=list)
    map: list[int] = field(default_factory=list)
    indent: str = " "
    line: int = 0
    folds: list[tuple[int, str]] = field(default_factory=list)
    temporaries: int = 0

    def emit(self, code: str) -> None:
        """Add one line."""
        self.lines.append(self.indent + code)
        self.map.append(self.line)

    def insert(self, at: int, code: str, line: int) -> None:
        """Put a line before one that is there already."""
        self.lines.insert(at, code)
        self.map.insert(at, line)
        self.folds = [(place + (place >= at), name) for place, name in self.folds]

    def temporary(self) -> str:
        """Return a new Python local."""
        self.temporaries += 1
        return f"q{self.temporaries}"

    def keep(self, name: str, code: str) -> None:
        """Add a line that puts a value into a cached local."""
        self.folds.append((len(self.lines), name))
        self.emit(f"{name}={code}")

    def tidy(self) -> None:
        """Take out locals that nobody reads again."""
        source = "\n".join(self.lines)
        uses = Counter(_LOCAL.findall(source))
        lines = self.lines
        dropped: set[int] = set()
        for at, name in self.folds:
            if uses[name] == 2 and name in lines[at + 1]:
                code = lines[at].partition("=")[2]
                before, _, behind = lines[at + 1].partition(name)
                if not behind[:1].isdigit():
                    lines[at + 1] = before + code + behind
                    dropped.add(at)
            elif uses[name] == 1:
                dropped.add(at)
        self.lines = [line for at, line in enumerate(lines) if at not in dropped]
        self.map = [line for at, line in enumerate(self.map) if at not in dropped]
