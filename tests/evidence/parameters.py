"""Lists of parameters as the package keeps them: one file for each, facts alone, from the help as text.

``python -m tests.evidence HELP --part parameters --save`` makes ``plcgen/ds47/lists/<name>.tsv`` from the file
``SINAMICS Parameter *.md`` of a public copy that is the same package of the information system; a list of another
version begins with a file that has its first two lines. Whether the help of an installed TIA Portal can be read
directly has not been tried.

A parameter can stand several times under one heading, for variants of a drive object: a vector drive with and without
speed control, linear and rotating axes. What is kept holds for all of them: the widest limits, names that no variant
contradicts, and of everything else what all say.
"""

from __future__ import annotations

import html
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from plcgen.ds47 import lists
from tests.evidence.lists import kept

_SECTION = re.compile(r"(?m)^### (?=[prc][0-9])")
_HEAD = re.compile(r"([prc])([0-9]+)(?:\[([^\]]*)\])?(?:\.\S+)? *(.*)")
_LIMITS = re.compile(r"\| \*\*Min:?\*\* \| \*\*Max:?\*\* \| \*\*Factory setting:?\*\* \|\s*\n\|(.*)\|")
_NAMED = re.compile(r"(?m)^\[?\s*\n?(-?[0-9.]+)\]?:[ \t]*\n")
_END = re.compile(r"(?m)^(?:\*\*|#|\|)")
NUMBERED = ("values", "bits", "indexes")


def _cell(part: str, *names: str) -> str:
    match = re.search(rf"\*\*(?:{'|'.join(names)}):\*\*([^|]*)\|", part)
    return " ".join(html.unescape(match[1]).split()).removesuffix("-").strip() if match else ""


def _limits(part: str) -> Sequence[str]:
    """Smallest and greatest value and factory setting, without their unit; nothing for several factory settings."""
    match = _LIMITS.search(part)
    cells = [one.strip() for one in match[1].split("|")] if match else ["", "", ""]
    several = cells[2].count("[ ") > 1 or len(re.findall(r"\[[ 0-9]+\]", cells[2])) > 1
    cells[2] = "" if several else re.sub(r"^\[[ 0-9]*\] *", "", cells[2])
    return [re.sub(r" *\[[^\]]*\]", "", one).strip() for one in cells]


def _unit(part: str) -> str:
    said = _cell(part, "Unit")
    match = _LIMITS.search(part)
    bracket = re.search(r"\[([^\]]*[A-Za-z%°µ][^\]]*)\]", match[1]) if match else None
    return said or (bracket[1] if bracket else "")


def _names(part: str, heading: str) -> str:
    """Numbers with what they stand for, as lists have them."""
    start = re.search(rf"\*\*{heading}:\*\*", part)
    if not start:
        return ""
    rest = part[start.end() :]
    end = _END.search(rest)
    pieces = _NAMED.split(rest[: end.start()] if end else rest)[1:]
    pairs = zip(pieces[::2], pieces[1::2], strict=True)
    return "; ".join(f"{number}={' '.join(html.unescape(text).split())}" for number, text in pairs if "." not in number)


def _bits(part: str) -> str:
    found = re.findall(r"(?m)^\| ([0-9]{2}) \| ([^|]*) \| ([^|]*) \| ([^|]*) \|", part)
    return "; ".join(html.unescape(f"{int(bit)}={name} ({low}/{high})") for bit, name, low, high in found)


def read(text: str) -> Iterator[list[list[str]]]:
    """Of every parameter, its variants as lines of a list."""
    for section in _SECTION.split(text)[1:]:
        head = _HEAD.match(section)
        parts = re.split(r"(?m)^#### ", section)
        if head:
            yield [_line(head, part) for part in (parts[1:] or parts)]


def _line(head: re.Match[str], part: str) -> list[str]:
    own = _HEAD.match(part)
    low, high, default = _limits(part)
    return kept(
        {
            "letter": head[1], "number": str(int(head[2])), "index": (head[3] or "").replace("...", "..").strip(),
            "title": own[4].strip() if own else head[4].strip(), "type": _cell(part, "Data type"),
            "dynamic_index": _cell(part, "Dynamic index", r"Dyn\. index \[0…n\]").partition(",")[0].partition(" ")[0],
            "objects": _cell(part, "Object"), "min": low, "max": high, "default": default, "unit": _unit(part),
            "scaling": _cell(part, "Scaling"),
            "changeable": _cell(part, "Can be changed", "Can be changed in the operating state"),
            "values": _names(part, "Value"), "bit_names": _bits(part), "index_names": _names(part, "Index"),
        }
    )  # fmt: skip


def merged(variants: Sequence[Sequence[str]]) -> list[str]:
    """What holds for all variants of an object."""
    columns = dict(zip(lists.COLUMNS, zip(*variants, strict=True), strict=True))
    line = {name: said[0] if len(set(said)) == 1 else "" for name, said in columns.items()}
    line["title"] = columns["title"][0]
    for name, widest in (("min", min), ("max", max)):
        line[name] = widest(columns[name], key=float) if all(columns[name]) else ""
    for name in NUMBERED:
        line[name] = "; ".join(f"{number}={text}" for number, text in _agreed(columns[name]))
    return list(line.values())


def _agreed(column: Sequence[str]) -> Sequence[tuple[int, str]]:
    """Names that no variant contradicts."""
    pairs = [[pair.partition("=") for pair in re.split(r"; (?=-?[0-9]+=)", one) if pair] for one in column]
    all_names = [{int(number): name for number, _, name in one} for one in pairs]
    numbers = sorted({number for names in all_names for number in names})
    said = {number: {names[number] for names in all_names if number in names} for number in numbers}
    return [(number, *texts) for number, texts in said.items() if len(texts) == 1]


def by_object(variants: Sequence[list[str]]) -> Iterator[list[str]]:
    """A line for every set of objects for which the same variants speak."""
    place = lists.COLUMNS.index("objects")
    of: dict[str, list[int]] = {}
    for number, line in enumerate(variants):
        for one in line[place].split() or [""]:
            of.setdefault(one, []).append(number)
    for those in sorted(set(map(tuple, of.values()))):
        objects = " ".join(sorted(one for one, numbers in of.items() if tuple(numbers) == those))
        line = merged([variants[number] for number in those])
        line[place] = objects
        yield line


def text(head: str, help_text: str) -> str:
    """The file of the package for a list: what it is, headings, and its parameters by number."""
    rows = [line for variants in read(help_text) for line in by_object(variants)]
    rows.sort(key=lambda line: int(line[0]))
    return "\n".join([head, "\t".join(lists.COLUMNS), *("\t".join(row).rstrip("\t") for row in rows), ""])


def report(folder: Path, *, save: bool) -> Iterator[str]:
    """How many parameters each list has; ``save`` writes the files."""
    of_package = {_package(path.read_text("utf-8")): path for path in sorted(lists.FOLDER.glob("*.tsv"))}
    for path in sorted(folder.rglob("SINAMICS Parameter *.md")):
        help_text = path.read_text("utf-8")
        kept_in = of_package.get(_package(help_text))
        if kept_in is not None:
            made = text(kept_in.read_text("utf-8").partition("\n")[0], help_text)
            if save:
                kept_in.write_text(made, "utf-8", newline="\n")
            yield f"parameters: {kept_in.stem:18} {made.count(chr(10)) - 2:5} lines"


def _package(text_: str) -> str:
    match = re.search(r"sdrpa[0-9]+[a-zA-Z]+", text_[:400])
    return match[0] if match else ""
