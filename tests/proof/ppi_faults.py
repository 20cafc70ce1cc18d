"""Single faults in generated PPI masters as people make them: another name, a missing parameter, crossed wires.

``faults`` draws them from the text of the files, the same for the same seed; they are not the mutants of
``tests.mutation``, which change one operator, number or statement.
"""

from __future__ import annotations

import itertools
import random
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

_NAME = re.compile(r"#[A-Za-z]\w*")
_DECLARED = re.compile(r"^  (\w+) : ([\w.\[\] ]+?)(?: := (.+?))?;", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Fault:
    """One fault: what kind, in which file and line, and the lines as they are and as they become."""

    kind: str
    file: str
    line: int
    old: str
    new: str

    def put(self, folder: Path) -> None:
        """Write it into a folder."""
        path = folder / self.file
        data = path.read_bytes()
        coding = "utf-8-sig" if data.startswith(b"\xef\xbb\xbf") else "cp1252"
        lines = data.decode(coding).split("\n")
        assert lines[self.line - 1].rstrip("\r") == self.old
        lines[self.line - 1] = self.new
        path.write_bytes("\n".join(lines).encode(coding))


def faults(folder: Path, seed: int, count: int) -> list[Fault]:
    """So many faults, as many of each kind as there are."""
    rng = random.Random(seed)  # which faults are tried
    kinds: dict[str, list[Fault]] = {}
    for path in sorted([*(folder / "scl").glob("*.scl"), *(folder / "db").glob("*.db")]):
        name = path.relative_to(folder).as_posix()
        text = path.read_bytes().decode("utf-8-sig" if path.read_bytes()[:3] == b"\xef\xbb\xbf" else "cp1252")
        for fault in _of(name, text.replace("\r\n", "\n"), rng):
            kinds.setdefault(fault.kind, []).append(fault)
    for rows in kinds.values():
        rng.shuffle(rows)
    found: list[Fault] = []
    while len(found) < count and any(kinds.values()):
        found += [rows.pop() for _, rows in sorted(kinds.items()) if rows]
    return found[:count]


def _of(file: str, text: str, rng: random.Random) -> Iterator[Fault]:
    """Every fault of a file."""
    lines = text.split("\n")
    begin = next((n for n, line in enumerate(lines) if line.strip() == "BEGIN"), len(lines))
    types = {name: kind for name, kind, _ in _DECLARED.findall(text)}
    for number, line in enumerate(lines, 1):
        code = line.split("//")[0]
        if not code.strip() or line.lstrip().startswith("//"):
            continue
        for kind, new in _changed(code, types, rng) if number > begin else _declared(code):
            yield Fault(kind, file, number, line, new + line[len(code) :])
    yield from _crossed(file, lines)


def _changed(code: str, types: dict[str, str], rng: random.Random) -> Iterator[tuple[str, str]]:
    """What a line of code can become."""
    for found in _NAME.finditer(code):
        kind = types.get(found[0][1:])
        others = [name for name, other in types.items() if other == kind and f"#{name}" != found[0]]
        others = [name for name in others if name[:4] == found[0][1:5]] or others
        if kind is not None and others and ":" not in found[0]:
            yield "another name of the same type", f"{code[: found.start()]}#{rng.choice(others)}{code[found.end() :]}"
    condition = re.search(r"\b(?:IF|ELSIF|WHILE) (.+?) (THEN|DO)\s*$", code)
    if condition:
        for value in ("TRUE", "FALSE") if condition[2] == "THEN" else ("FALSE",):
            yield "a condition that is always the same", code[: condition.start(1)] + value + code[condition.end(1) :]
    loop = re.search(r"FOR (\S+) := (.+?) TO (.+?)( BY -1)? DO", code)
    if loop:
        for group, more in ((2, " + 1"), (3, " - 1")):
            yield "a loop that is too short", code[: loop.end(group)] + more + code[loop.end(group) :]
    for index in re.finditer(r"\[(#\w+(?: [+-] [#\w]+)*)\]", code):
        yield "the next element", f"{code[: index.start(1)]}{index[1]} + 1{code[index.end(1) :]}"
    label = re.fullmatch(r"(\s*)(\d+):\s*", code)
    if label:
        yield "a case that never comes", f"{label[1]}{int(label[2]) + 90}:"
    literal = re.search(r"\b([A-Z_]+) := (\d+|TRUE|FALSE|'\w'),?\s*$", code)
    if literal:
        other = {"TRUE": "FALSE", "FALSE": "TRUE"}.get(literal[2], "")
        value = other or ("'R'" if "'" in literal[2] else str(int(literal[2]) + 1))
        yield "another parameter of a call", code[: literal.start(2)] + value + code[literal.end(2) :]
    if re.fullmatch(r"\s*(#|\").+ := .+;\s*", code):
        yield "the block ends here", f"{re.match(r' *', code)[0]}RETURN;"  # type: ignore[index]
    constant = re.search(r"(telegram\.\w+) := (16#)([0-9A-F]+);", code)
    if constant:
        digits = f"{int(constant[3], 16) ^ 1 << rng.randrange(4 * len(constant[3])):0{len(constant[3])}X}"
        yield "a bit of a telegram", code[: constant.start(3)] + digits + code[constant.end(3) :]


def _declared(code: str) -> Iterator[tuple[str, str]]:
    """What a declaration can become: another start value or constant."""
    found = re.search(r" := (.*?)(\d+)(;?)\s*$", code)
    if found and ":" in code[: found.start()]:
        yield "another start value", f"{code[: found.start(2)]}{int(found[2]) + 1}{code[found.end(2) :]}"


def _crossed(file: str, lines: list[str]) -> Iterator[Fault]:
    """Right sides of two neighbouring wires of the main program exchanged: the first gets that of the second."""
    if not file.endswith("Main.scl"):
        return
    wire = re.compile(r"^(\s*[\w\".#]+ (?::=|=>) )(.+?)([,;)]*)$")
    for number, (one, two) in enumerate(itertools.pairwise(lines), 1):
        first, second = wire.match(one), wire.match(two)
        if first and second and first[2] != second[2]:
            yield Fault("a crossed wire", file, number, one, f"{first[1]}{second[2]}{first[3]}")
