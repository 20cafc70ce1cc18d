"""The rules of the standard-access layout once more, written for the vectors: every rule can be switched off.

Nothing of plcgen is used. ``offsets`` gives the place of every member in bits, and the length in bytes.
"""

from __future__ import annotations

import re

WIDTHS = {
    "BOOL": 1, "BYTE": 8, "CHAR": 8, "WORD": 16, "INT": 16, "S5TIME": 16, "DATE": 16, "TIMER": 16, "DWORD": 32,
    "DINT": 32, "REAL": 32, "TIME": 32, "TIME_OF_DAY": 32, "DATE_AND_TIME": 64, "ANY": 80, "POINTER": 48,
}  # fmt: skip
SECTIONS = ("Input", "Output", "InOut", "Static")


def up(value: int, step: int) -> int:
    return (value + step - 1) // step * step


class Rulebook:
    """One way to lay members out; ``off`` are the rules that do not hold."""

    def __init__(self, *off: str) -> None:
        self.off = frozenset(off)

    def block(self, case: dict) -> tuple[int, dict[str, int]]:
        """Length in bytes, and the place of every member in bits."""
        found: dict[str, int] = {}
        bits = self.members(case["members"], 0, "", found)
        return (up(bits, 16) if "block-end" not in self.off else up(bits, 8)) // 8, found

    def members(self, members: list[dict], base: int, prefix: str, found: dict[str, int]) -> int:
        """Lay out members from bit ``base``; the end comes back."""
        at = base
        for section in SECTIONS:
            inside = [m for m in members if m.get("section", "Static") == section]
            if inside and "section" in inside[0] and "sections" not in self.off:
                at = up(at, 16)
            for member in inside:
                at = self.place(member, at, prefix + member["name"], found)
        return at

    def place(self, member: dict, at: int, path: str, found: dict[str, int]) -> int:
        """Put one member at or behind bit ``at``; the end comes back."""
        spelling = member["type"]
        array = re.fullmatch(r"ARRAY\[(.+)\] OF (.+)", spelling)
        if array:
            at = up(at, 16) if "array-start" not in self.off else at
            return self.array(member, array, at, path, found)
        if "members" in member or spelling in {"STRUCT", "FB"}:
            at = up(at, 16) if "struct-start" not in self.off else at
            found[path] = at
            end = self.members(member.get("members", []), at, path + ".", found)
            if "struct-end-absolute" in self.off:
                return up(at, 8) + up(end - up(at, 8), 16)
            return up(end, 16) if "struct-end" not in self.off else end
        string = re.fullmatch(r"STRING(?:\[(\d+)\])?", spelling)
        if string:
            at = found[path] = up(at, 16 if "string-start" not in self.off else 8)
            return at + 8 * (int(string[1] or 254) + (2 if "string-head" not in self.off else 0))
        width = WIDTHS[spelling]
        if spelling == "ANY" and "any" in self.off:
            width = 48
        at = found[path] = up(at, self.alignment(width))
        return at + width

    def alignment(self, width: int) -> int:
        """Bits that a type of this width is aligned to."""
        if width == 1:
            return 8 if "bit" in self.off else 1
        if width == 8:
            return 16 if "byte" in self.off else 8
        if "word-even" in self.off:
            return 8
        return min(width, 64) if "word-only-even" in self.off and width in {32, 64} else 16

    def array(self, member: dict, array: re.Match[str], at: int, path: str, found: dict[str, int]) -> int:
        """Lay out all elements; the end comes back."""
        found[path] = at
        bounds = [tuple(map(int, part.split(".."))) for part in array[1].split(",")]
        end = at
        for index in self.indices(bounds):
            element = {"name": "", "type": array[2]}
            if "element" in member:
                element["members"] = member["element"]
            if array[2] == "BOOL" and len(bounds) > 1 and index[-1] == bounds[-1][0] and "bit-rows" not in self.off:
                end = up(end, 8)
            inner: dict[str, int] = {}
            end = self.place(element, end, "", inner)
            text = ",".join(map(str, index))
            found |= {f"{path}[{text}]{key}": place for key, place in inner.items()}
            if array[2].startswith("STRING") and "string-stride" not in self.off:
                end = up(end, 16)
        if array[2] == "BOOL" and "bit-array-end" not in self.off:
            end = up(end, 8)
        return up(end, 16) if "array-end" not in self.off else end

    def indices(self, bounds: list[tuple[int, ...]]) -> list[tuple[int, ...]]:
        """Every index, the last one counting fastest."""
        found: list[tuple[int, ...]] = [()]
        for low, high in bounds:
            found = [(*head, n) for head in found for n in range(low, high + 1)]
        return found
