"""Members by the names people type, and constants as SCL writes them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from plcgen.base.diagnostics import Diagnostic
from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.report.trace.recorder import watch
from plcgen.report.trace.settings import TimedValue
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.layout.layout import layout_block
from plcgen.s7.types.blocks import BlockKind, SectionKind
from plcgen.s7.types.data_types import Elementary, StringType
from plcgen.s7.types.literals import LiteralError, parse_literal


def full_path(cpu: Cpu, path: str, controls: Sequence[str]) -> str:
    """Path of a member as the CPU knows it; ``setRamps.execute`` means the member of one of the ``controls``.

    Raises:
        LookupError: there is no such member, tag or address; it says what there is.
    """
    for candidate in (path, *(f'"{control}".{path}' for control in controls)):
        try:
            watch(cpu, candidate)
        except (KeyError, ValueError):
            continue
        return candidate
    raise LookupError(_known(cpu, path, controls))


def _known(cpu: Cpu, path: str, controls: Sequence[str]) -> str:
    names = [f"{control}.{name}" for control in controls for name in _members(cpu, control)]
    first = path.split(".", maxsplit=1)[0].strip('"')
    entry = cpu.program.link.find(first)
    if entry is not None and entry.block.kind is BlockKind.DB:
        names = [f"{entry.name}.{name}" for name in _members(cpu, first)]
    hint = did_you_mean(path, [*names, *(name.split(".", 1)[-1] for name in names)])
    return hint or "name a member (DriveJobs.readSpeed.execute), a tag, or an address (M50.0, DB3.DBW6)"


def _members(cpu: Cpu, name: str) -> list[str]:
    entry = cpu.program.link.find(name)
    if entry is None or entry.shape is None:
        return []
    return [e.path for e in layout_block(entry.block, cpu.program.link.types).entries if not e.shape.fields]


def valued_members(cpu: Cpu) -> Iterator[str]:
    """Paths of all members of all data blocks that hold a value or an array, instances included, as the CPU knows them.

    A member without a value of its own (a pointer) is left out.
    """
    for entry in [one for one in cpu.program.link.blocks.values() if one.index in cpu.blocks]:
        for name in _members(cpu, entry.name):
            path = f'"{entry.name}".{name}'
            try:
                cpu[path]
            except ValueError:
                continue
            yield path


def input_members(cpu: Cpu, block: str, commands: str) -> Iterator[tuple[str, str]]:
    """Inputs of a function block that a structure of commands has too, without what starts it; with their comments."""
    entry = cpu.program.link.find(block)
    for member in () if entry is None else entry.block.section(SectionKind.INPUT):
        try:
            watch(cpu, f"{commands}.{member.name}")
        except (KeyError, ValueError):
            continue
        if member.name != "execute":
            yield member.name, member.comment or member.name


def located(cpu: Cpu, item: TimedValue, controls: Sequence[str]) -> tuple[int, str, object] | Diagnostic:
    """Scan, path of the member as the CPU knows it, value; or what is wrong with it."""
    try:
        path = full_path(cpu, item.path, controls)
    except LookupError as problem:
        return item.wrong(no_member(item.path), str(problem))
    _, type_ = watch(cpu, path)
    if not isinstance(type_, Elementary | StringType):
        return item.wrong(f"{item.path} is an array or structure", "name one element, for example [0]")
    try:
        return item.scan, path, parse_literal(item.value, type_)
    except LiteralError as problem:
        return item.wrong(str(problem), f"{item.path} is a {type_.name}")


def no_member(path: str) -> str:
    """Of a path that names nothing."""
    return f"there is no member, tag or address {path}"
