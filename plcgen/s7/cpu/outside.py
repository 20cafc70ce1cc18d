"""What Python reaches of a program: symbols and addresses, functions to call, blocks that Python stands in for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from plcgen.base.diagnostics import Diagnostic, DiagnosticError
from plcgen.base.files.yaml import YamlNode, load_yaml
from plcgen.s7.cpu.compiler.places import AREAS
from plcgen.s7.cpu.compiler.scope import function_parameters, scalar_name
from plcgen.s7.cpu.kinds import kind_of, typed
from plcgen.s7.cpu.linkage import Linkage, ProgramBlock
from plcgen.s7.cpu.memory import AREA_L, CODECS, Memory, codec_functions
from plcgen.s7.layout.image import Tree, default_bytes, read_entry, write_member
from plcgen.s7.layout.layout import Entry, Layout, layout_members, locate, split_path
from plcgen.s7.layout.shapes import Shape
from plcgen.s7.types.address import AddressError, parse_address
from plcgen.s7.types.blocks import BlockKind, SectionKind
from plcgen.s7.types.data_types import (
    ELEMENTARY,
    ArrayType,
    Elementary,
    Member,
    StringType,
    UnfitValueError,
    UnknownPathError,
)
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


Answer = Callable[..., Mapping[str, Any] | None]
"""What stands in for a block: takes its inputs by name, returns its outputs by name."""


@dataclass(frozen=True, slots=True)
class Stub:
    """A block without code: ``interface`` is its declaration in SCL, ``answer`` what a call of it does.

    ``answer`` gets inputs and in-outs as keyword arguments; it returns outputs and in-outs by name, the value of an FC
    under the name of the FC. What it does not return stays as it is, or has the default of its type.
    """

    interface: str
    answer: Answer


class Parameters:
    """Parameters of an FC as one structure in memory, between Python values and those of generated code."""

    def __init__(self, entry: ProgramBlock, link: Linkage, given: Mapping[str, Any]) -> None:
        self.entry, self.link = entry, link
        self.rows = function_parameters(entry.block)
        members = [self._member(kind, member, given) for kind, member, _ in self.rows]
        self.layout = layout_members(members, link.types)
        self.memory = Memory(default_bytes(self.layout.shape), AREA_L, optimized=link.optimized(entry))
        self.names = [member.name for member in members]

    def _member(self, kind: SectionKind, member: Member, given: Mapping[str, Any]) -> Member:
        name = self.entry.name if kind is SectionKind.RETURN else member.name
        type_ = member.type
        if isinstance(type_, ArrayType) and not type_.bounds:
            type_ = replace(type_, bounds=((0, len(given.get(name, ())) - 1),))
        return Member(name, type_)

    def write(self, values: Mapping[str, Any]) -> None:
        """Python values by name. Raises ValueError for a name that is no parameter."""
        for name, value in values.items():
            if name.upper() not in {known.upper() for known in self.names}:
                raise UnfitValueError(f"{self.entry.name} has no parameter {name}: {', '.join(self.names)}")
            write_tree(self.memory, self.layout, f'"{name}"', value)

    def read(self, *kinds: SectionKind) -> dict[str, Any]:
        """Python values of the parameters of some sections."""
        wanted = [name for name, (kind, _, _) in zip(self.names, self.rows, strict=True) if kind in kinds]
        return {name: read_entry(self.memory, locate(self.layout, f'"{name}"')) for name in wanted}

    def arguments(self) -> list[Any]:
        """What generated code is called with."""
        found: list[Any] = []
        for (kind, _, how), field in zip(self.rows, self.layout.shape.fields, strict=True):
            if kind is SectionKind.RETURN or (how == "value" and kind is SectionKind.OUTPUT and not self.link.classic):
                continue
            if how == "value":
                found.append(_load(self.memory, field.offset, field.shape))
            else:
                found.append(typed(self.memory, field.offset // 8, field.shape.bits // 8, kind_of(field.shape)))
        return found

    def take(self, arguments: list[Any]) -> None:
        """Put the arguments of a call from generated code into the structure."""
        pending = iter(arguments)
        for (kind, _, how), field in zip(self.rows, self.layout.shape.fields, strict=True):
            if kind is SectionKind.RETURN or (how == "value" and kind is SectionKind.OUTPUT and not self.link.classic):
                continue
            value = next(pending)
            if how == "value":
                _store(self.memory, field.offset, field.shape, value)
            elif value[0] is not None:
                size = field.shape.bits // 8
                self.memory[field.offset // 8 : field.offset // 8 + size] = value[0][value[1] : value[1] + size]

    def results(self) -> list[tuple[bool, int, Shape]]:
        """What comes out as values: whether it is the value of the FC, its offset, its shape; that comes first."""
        rows = zip(self.rows, self.layout.shape.fields, strict=True)
        out = [
            (kind is SectionKind.RETURN, field.offset, field.shape)
            for (kind, _, how), field in rows
            if kind is SectionKind.RETURN or (how == "value" and kind is not SectionKind.INPUT)
        ]
        return sorted(out, key=lambda row: not row[0])


def call_function(
    entry: ProgramBlock, link: Linkage, run: Callable[[list[Any]], Any], inputs: Mapping[str, Any]
) -> dict[str, Any]:
    """Call an FC with Python values and return its outputs, in-outs and its value by name.

    ``run`` runs the generated function. Raises ValueError for a parameter that is none, or a value that does not fit.
    """
    parameters = Parameters(entry, link, inputs)
    parameters.write(inputs)
    returned = run(parameters.arguments())
    results = parameters.results()
    values = [returned]
    if isinstance(returned, tuple) and any(not is_value for is_value, _, _ in results):
        values = list(returned if results[0][0] else returned[1:])
    for (_, offset, shape), value in zip(results, values, strict=False):
        if value is not None:  # nothing comes out behind a fault
            _store(parameters.memory, offset, shape, value)
    return parameters.read(SectionKind.OUTPUT, SectionKind.IN_OUT, SectionKind.RETURN)


def stand_in(entry: ProgramBlock, link: Linkage, answer: Answer) -> Callable[..., Any]:
    """What generated code calls instead of a block without code."""
    return _function(entry, link, answer) if entry.block.kind is BlockKind.FC else _instance(entry, answer)


def _function(entry: ProgramBlock, link: Linkage, answer: Answer) -> Callable[..., Any]:
    def run(*arguments: Any) -> Any:
        parameters = Parameters(entry, link, {})
        parameters.take(list(arguments))
        parameters.write(answer(**parameters.read(SectionKind.INPUT, SectionKind.IN_OUT)) or {})
        values = [_load(parameters.memory, offset, shape) for _, offset, shape in parameters.results()]
        plain = [row for row in parameters.results() if not row[0]]
        if not plain:
            return values[0] if values else None
        return tuple(values) if len(values) > len(plain) else (None, *values)

    return run


def _instance(entry: ProgramBlock, answer: Answer) -> Callable[..., Any]:
    assert entry.shape is not None  # an FB that was laid out
    layout = Layout(entry.shape.bits // 8, entry.shape)
    inputs = [m.name for kind in (SectionKind.INPUT, SectionKind.IN_OUT) for m in entry.block.section(kind)]

    def run(memory: Memory, offset: int = 0) -> None:
        own = Memory(memory[offset : offset + layout.size], AREA_L)
        values = {name: read_entry(own, locate(layout, f'"{name}"')) for name in inputs}
        for name, value in (answer(**values) or {}).items():
            write_tree(own, layout, f'"{name}"', value)
        memory[offset : offset + layout.size] = own

    return run


def _load(memory: Memory, offset: int, shape: Shape) -> Any:
    """Value as generated code has it."""
    type_ = scalar_name(shape)
    if type_ == "BOOL":
        return bool(memory[offset // 8] >> offset % 8 & 1)
    if isinstance(shape.type, StringType):
        template = "r_s({m},{o})" if type_ == "STRING" else "r_ws({m},{o})"
    elif type_ in CODECS:
        template = CODECS[type_].read
    else:
        return typed(memory, offset // 8, shape.bits // 8, kind_of(shape))
    return eval(template.format(m="m", o=offset // 8), dict(codec_functions()), {"m": memory})  # noqa: S307


def _store(memory: Memory, offset: int, shape: Shape, value: Any) -> None:
    type_ = scalar_name(shape)
    if type_ == "BOOL":
        mask = 1 << offset % 8
        memory[offset // 8] = memory[offset // 8] | mask if value else memory[offset // 8] & 255 - mask
        return
    if isinstance(value, tuple):
        memory[offset // 8 : offset // 8 + shape.bits // 8] = value[0][value[1] : value[1] + shape.bits // 8]
        return
    if isinstance(shape.type, StringType):
        template = f"{'w_s' if type_ == 'STRING' else 'w_ws'}({{m}},{{o}},{shape.type.length},{{v}})"
    else:
        template = CODECS[type_].write
    exec(template.format(m="m", o=offset // 8, v="v"), dict(codec_functions()), {"m": memory, "v": value})  # noqa: S102


def read_stubs(path: Path) -> list[Stub]:
    """Stubs of a YAML file: each has its ``interface`` in SCL, and ``outputs`` with the values of every call.

    Raises DiagnosticError if the file is no such list.
    """
    root = load_yaml(path.read_text(encoding="utf-8"), str(path))
    found = []
    for item in root.items:
        interface, outputs = item.get("interface"), item.get("outputs")
        if interface is None or not interface.raw or set(item.pairs) - {"interface", "outputs"}:
            text = "write - interface: |, with the declaration of the block, and outputs: {name: value}"
            raise DiagnosticError([Diagnostic("PG106", "this is no stub", item.span, help=text)])
        found.append(Stub(interface.raw, _constant({} if outputs is None else _plain(outputs))))
    if not found:
        problem = Diagnostic("PG106", "this is no list of stubs", root.span, help="begin with - interface: |")
        raise DiagnosticError([problem])
    return found


def _constant(outputs: Any) -> Answer:
    return lambda **_: outputs


def _plain(node: YamlNode) -> Any:
    if node.kind == "map":
        return {name: _plain(value) for name, (_, value) in node.pairs.items()}
    return [_plain(item) for item in node.items] if node.kind == "seq" else node.value
