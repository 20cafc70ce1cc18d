"""Builds blocks from tests/vectors/layouts.yaml."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

from plcgen.s7.types.blocks import Block, BlockKind, Section, SectionKind
from plcgen.s7.types.data_types import ArrayType, DataType, Member, NamedType, StringType, StructType, elementary
from tests.yaml_files import read_yaml

VECTORS = Path(__file__).parent / "vectors" / "layouts.yaml"


@cache
def cases() -> dict[str, dict]:
    return {case["id"]: case for case in read_yaml(VECTORS.read_text(encoding="utf-8"))["cases"]}


def to_type(text: str) -> DataType:
    """Make a type from its S7 spelling, without STRUCT bodies."""
    array = re.fullmatch(r"ARRAY\s*\[(.+?)\]\s*OF\s+(.+)", text, re.IGNORECASE)
    if array:
        bounds = tuple(tuple(int(n) for n in part.split("..")) for part in array[1].split(","))
        return ArrayType(bounds, to_type(array[2]))
    string = re.fullmatch(r"(W?STRING)(?:\[(\d+)\])?", text, re.IGNORECASE)
    if string:
        return StringType(string[1].upper(), int(string[2] or 254))
    return elementary(text) or NamedType(text.strip('"'), quoted=text.startswith('"'))


def block(case: dict, starts: dict[str, str] | None = None) -> tuple[Block, dict[str, Block]]:
    """Make the block of a vector and its types; multi-instances become FBs of their own."""
    types: dict[str, Block] = {}

    def member(data: dict, prefix: str) -> Member:
        path = prefix + data["name"]
        name, text = data["name"], data["type"]
        start = (starts or {}).get(path)
        if text == "FB":
            fb = f"FB_{len(types)}"
            types[fb] = sections_block(BlockKind.FB, fb, data["members"], path + ".")
            return Member(name, NamedType(fb), start)
        inner = data.get("members") or data.get("element")
        if inner is None:
            return Member(name, to_type(text), start)
        struct = StructType(tuple(member(m, path + ".") for m in inner))
        if "element" not in data:
            return Member(name, struct, start)
        array = to_type(text)
        assert isinstance(array, ArrayType)
        return Member(name, ArrayType(array.bounds, struct), start)

    def sections_block(kind: BlockKind, name: str, members: list[dict], prefix: str) -> Block:
        groups: dict[SectionKind, list[Member]] = {}
        for data in members:
            section = SectionKind(data.get("section", "Static"))
            groups.setdefault(section, []).append(member(data, prefix))
        return Block(kind, name, tuple(Section(kind, tuple(group)) for kind, group in groups.items()))

    kind = BlockKind.DB if case["kind"] == "GlobalDB" else BlockKind.FB
    return sections_block(kind, case["id"], case["members"], ""), types


def db(*declarations: str, kind: BlockKind = BlockKind.DB, name: str = "test") -> Block:
    """Make a DB from ``name : TYPE := start`` lines."""
    return Block(kind, name, (Section(SectionKind.STATIC, members(*declarations)),))


def members(*declarations: str) -> tuple[Member, ...]:
    result = []
    for text in declarations:
        name, _, rest = text.partition(":")
        type_text, _, start = rest.partition(":=")
        result.append(Member(name.strip(), to_type(type_text.strip()), start.strip() or None))
    return tuple(result)
