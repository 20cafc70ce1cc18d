"""What whole lists say of a number (docs/devices.md, "Whole lists"): read here a second time, from the same files.

There is one source for a fact that only a list states: the ledger names it, and this reading proves that nothing was
lost between the file and the telegram, not that the file is right.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

_GROUPS = {"drive": {"servo", "vector"}, "infeed": {"a_inf", "b_inf", "s_inf"}}
_ONLY_READ = ("min", "max", "default", "array", "values")
Lines = Mapping[str, Sequence[str]]
"""The lines of each list by its name; the second one has the headings."""


class StatedLists:
    """The lists of one drive object; ``lent`` if they are those of a device that its own is like."""

    def __init__(self, asked: Sequence[Mapping[str, Any]], lines: Lines, object_type: str, *, lent: bool) -> None:
        self._asked = [one for one in asked if _speaks(str(one.get("type") or ""), object_type)]
        self._lines, self._lent = lines, lent

    def facts(self, number: int, *, defined: bool = False) -> dict[str, Any]:
        """What they agree on; empty if none has the number.

        ``defined``: the spec says something of it too, to which gives way whether it can be written if nobody read it.
        """
        found = [[*self._rows(one, number)] for one in self._asked]
        said = [_meant(row) for rows in found for row in rows]
        if not said:
            return {}
        first = said[0]
        agreed = {key: value for key, value in first.items() if all(one.get(key) == value for one in said)}
        agreed["title"] = first["title"]
        letters = {one["letter"] for one in said}
        agreed["letter"] = "r" if "r" in letters else "c" if letters == {"c"} else "P"
        if all(found) and not self._lent and all(_own(one) for one in self._asked):
            return agreed
        doubted = {*_ONLY_READ, *(["letter"] if defined else [])}
        return {key: value for key, value in agreed.items() if key not in doubted}

    def read(self, number: int) -> dict[str, Any]:
        """The same if they are whole, of this device, and all have it; nothing from lists that nobody gave."""
        whole = all(str(one["list"]) in self._lines for one in self._asked) and all(
            _own(one) and any(self._rows(one, number)) for one in self._asked
        )
        return self.facts(number) if self._asked and whole and not self._lent else {}

    def name_it(self, number: int) -> bool:
        """Whether all lists that are this device's own have the number."""
        own = [one for one in self._asked if one.get("grade", "read") == "read"]
        return not self._lent and bool(own) and all(any(self._rows(one, number)) for one in own)

    def bit_name(self, number: int, bit: int) -> str:
        """What they call a bit, in snake_case; empty if they do not, or differ."""
        texts = set()
        for row in (row for one in self._asked for row in self._rows(one, number)):
            found = re.search(f"(?:^|; ){bit}=((?:(?!; -?[0-9]+=).)*)", row["bits"])
            texts.add(found[1] if found else "")
        name = re.sub("[^a-z0-9]+", "_", texts.pop().split(" (")[0].lower()).strip("_") if len(texts) == 1 else ""
        return name if re.match("[a-z]", name) else ""

    def _rows(self, asked: Mapping[str, Any], number: int) -> Iterator[dict[str, str]]:
        _, headings, *lines = self._lines[str(asked["list"])]
        for line in lines:
            if line.startswith(f"{number}\t"):
                row = dict.fromkeys(headings.split("\t"), "") | dict(
                    zip(headings.split("\t"), line.split("\t"), strict=False)
                )
                if not asked.get("objects") or {"ALL", *asked["objects"]} & set(row["objects"].split()):
                    yield row


def _own(asked: Mapping[str, Any]) -> bool:
    return asked.get("grade", "read") == "read" and bool(asked.get("whole", True))


def _speaks(of: str, object_type: str) -> bool:
    """Whether a list for some type of drive object speaks of this one."""
    return not of or not object_type or alike(of, object_type)


def alike(of: str, object_type: str) -> bool:
    """Whether two types of drive objects, or groups of them, have one in common."""
    one, other = (_GROUPS.get(name, {name}) for name in (of, object_type))
    modules = object_type == "terminal_module" and re.match("t[mb][0-9]", of) is not None
    return bool(one & other) or modules


def _meant(row: Mapping[str, str]) -> dict[str, Any]:
    found: dict[str, Any] = {key: row[key] for key in ("letter", "title", "type", "unit") if row[key]}
    for key in ("min", "max", "default"):
        if row[key]:
            found[key] = float(row[key]) if re.search("[.e]", row[key]) else int(row[key])
    if row["bico"]:
        found["bico"] = True
    if row["array"]:
        found["array"] = row["array"]
    pairs = re.findall(r"(?:^|; )(-?[0-9]+)=((?:(?!; -?[0-9]+=).)*)", row["values"])
    named = [(_name(text), int(number)) for number, text in pairs]
    if row["type"] != "FloatingPoint":
        every = [name for name, _ in named]
        found["values"] = {name: number for name, number in named if name and every.count(name) == 1}
    return found


def _name(text: str) -> str:
    """In lower case, with underscores; a name begins with a letter and is no number of a parameter."""
    name = re.sub("[^a-z0-9]+", "_", text.lower())[:64].strip("_")
    return "" if not re.match("[a-z]", name) or re.fullmatch("[prc][0-9]+", name) else name
