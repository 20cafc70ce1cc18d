"""Access from outside by symbol or address: ``"DriveJobs".readRampUp.execute``, ``M50.0``, ``DB3.DBW6``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from plcgen.s7.cpu.compiler.places import AREAS
from plcgen.s7.cpu.linkage import Linkage
from plcgen.s7.cpu.memory import Memory
from plcgen.s7.layout.image import Tree, read_entry, write_member
from plcgen.s7.layout.layout import Entry, Layout, locate, split_path
from plcgen.s7.types.address import AddressError, parse_address
from plcgen.s7.types.data_types import ELEMENTARY, Elementary
from plcgen.s7.types.errors import UnfitValueError, UnknownPathError
from plcgen.s7.types.values import pack_value, unpack_value

_Place = tuple[Memory, tuple[Layout, str, Entry] | None, int, Elementary | None]
"""Memory, and either the member of a data block with its path, or an offset in bits and a type (None: all of it)."""


class Symbols:
    """Reads and writes members of data blocks, tags and addresses with Python values."""

    def __init__(self, link: Linkage, blocks: Mapping[int, Memory], areas: Mapping[str, Memory]) -> None:
        self.link = link
        self.blocks = blocks
        self.areas = areas
        self._places: dict[str, _Place] = {}

    def read(self, path: str) -> Tree:
        """Value at a path. Raises KeyError if there is no such member."""
        memory, member, offset, type_ = self.find(path)
        if member is not None:
            return read_entry(memory, member[2])
        if type_ is None:
            return bytes(memory)  # type: ignore[return-value]
        if type_.name == "BOOL":
            return bool(memory[offset // 8] >> offset % 8 & 1)
        return unpack_value(bytes(memory[offset // 8 : offset // 8 + type_.bits // 8]), type_)

    def write(self, path: str, value: Any) -> None:
        """Store a value; lists and dicts go to the elements and members. KeyError, ValueError if it does not fit."""
        memory, member, offset, type_ = self.find(path)
        if member is not None:
            write_tree(memory, member[0], member[1], value)
        elif type_ is None:
            raise UnfitValueError(f"{path} is a whole data block: name a member")
        elif type_.name == "BOOL":
            mask = 1 << offset % 8
            memory[offset // 8] = memory[offset // 8] | mask if value else memory[offset // 8] & 255 - mask
        else:
            data = pack_value(value, type_)
            memory[offset // 8 : offset // 8 + len(data)] = data

    def find(self, path: str) -> _Place:
        """Memory and place of a path; looked up once."""
        known = self._places.get(path)
        if known is None:
            known = self._places[path] = self._find(path)
        return known

    def _find(self, path: str) -> _Place:
        tag = self.link.tags.get(path.strip('"# ').upper())
        if tag is not None:
            memory, offset = self._address(str(tag[0]), path)
            return memory, None, offset, ELEMENTARY.get(tag[1], ELEMENTARY["WORD"])
        steps = split_path(path)
        first = steps[0] if steps else ""
        entry = self.link.find(first) if isinstance(first, str) else None
        compact = path.replace(" ", "").lstrip("%").upper()
        if entry is not None and entry.index in self.blocks and entry.shape is not None:
            memory = self.blocks[entry.index]
            if len(steps) == 1:
                return memory, None, 0, None
            rest = _join(steps[1:])
            layout = Layout(entry.shape.bits // 8, entry.shape)
            try:
                found = locate(layout, rest)
            except KeyError as problem:
                if not compact.startswith("DB"):
                    raise UnknownPathError(f"{path}: {problem.args[0]}") from None
            else:
                return memory, (layout, rest, found), 0, None
        memory, offset = self._address(compact, path)
        return memory, None, offset, ELEMENTARY[parse_address(compact).type_name or "DWORD"]

    def _address(self, text: str, path: str) -> tuple[Memory, int]:
        try:
            address = parse_address(text)
        except AddressError:
            raise UnknownPathError(f"{path}: there is no such data block, tag or address") from None
        if address.area != "DB":
            return self.areas[AREAS[address.area]], address.offset
        entry = self.link.data_block(address.db or 0)
        if entry is None or entry.index not in self.blocks:
            raise UnknownPathError(f"{path}: there is no DB{address.db}")
        return self.blocks[entry.index], address.offset


def write_tree(memory: Memory, layout: Layout, path: str, value: Any) -> None:
    """Store a value; lists and dicts go to the elements and members. KeyError, ValueError if it does not fit."""
    if isinstance(value, dict):
        for name, inner in value.items():
            write_tree(memory, layout, f"{path}.{name}", inner)
        return
    entry = locate(layout, path)
    if isinstance(value, list | tuple) and entry.shape.element is not None:
        bounds = entry.shape.type.bounds if hasattr(entry.shape.type, "bounds") else ()
        first = bounds[0][0] if bounds else 0
        for position, inner in enumerate(value):
            write_tree(memory, layout, f"{path}[{first + position}]", inner)
        return
    write_member(memory, layout, path, value)


def _join(steps: list[str | tuple[int, ...]]) -> str:
    text = ""
    for step in steps:
        if isinstance(step, tuple):
            text += f"[{','.join(map(str, step))}]"
        else:
            text += f'{"." if text else ""}"{step}"'
    return text
