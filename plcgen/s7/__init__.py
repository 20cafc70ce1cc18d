"""The S7 part, a library: read, lay out, compare and run PLC sources; knows no drive, no spec and no protocol.

It stands on ``plcgen.base`` alone. The names in ``__all__`` are its API; they are imported when first used. README.md
beside this file shows them at work.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from plcgen.s7.compare import compare_sources
    from plcgen.s7.compare.states import snapshot_of
    from plcgen.s7.cpu.cpu import Cpu
    from plcgen.s7.cpu.program import Program
    from plcgen.s7.cpu.testing import Bench, load_scl
    from plcgen.s7.layout.layout import Layout, layout_block, leaves, locate
    from plcgen.s7.read.blocks import Sources, read_sources, read_texts
    from plcgen.s7.scl.dialect import Dialect
    from plcgen.s7.scl.parser import parse

_HOMES = {
    "Bench": "cpu.testing",
    "Cpu": "cpu.cpu",
    "Dialect": "scl.dialect",
    "Layout": "layout.layout",
    "Program": "cpu.program",
    "Sources": "read.blocks",
    "compare_sources": "compare",
    "layout_block": "layout.layout",
    "leaves": "layout.layout",
    "load_scl": "cpu.testing",
    "locate": "layout.layout",
    "parse": "scl.parser",
    "read_sources": "read.blocks",
    "read_texts": "read.blocks",
    "snapshot_of": "compare.states",
}
__all__ = [
    "Bench",
    "Cpu",
    "Dialect",
    "Layout",
    "Program",
    "Sources",
    "compare_sources",
    "layout_block",
    "leaves",
    "load_scl",
    "locate",
    "parse",
    "read_sources",
    "read_texts",
    "snapshot_of",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'plcgen.s7' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(f"plcgen.s7.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
