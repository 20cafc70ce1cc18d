"""What is remembered of the documents while they are made: names, calls and rows for the tables behind them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from plcgen.build.nouns import Call, Contribution, DataBlock, FunctionBlock, LibraryInstance, TagRow, TypeBlock
from plcgen.project.nouns import BlockRef


@dataclass(slots=True)
class Overview:
    """All blocks of a project by group, in import order.

    ``types``, ``data`` and ``programs`` are names, ``documented`` those of the data blocks that have a document, as
    instances of library blocks make themselves; ``watched`` are those of the programs with a watch table; ``tags``
    the rows of each tag table that has any; ``symbols`` what an instance DB is in a symbol table; ``notes`` why the
    documents of function blocks are experimental, with their names; ``sheets`` the parts of the layout sheet.
    """

    types: list[str] = field(default_factory=list)
    data: list[str] = field(default_factory=list)
    documented: list[str] = field(default_factory=list)
    programs: list[str] = field(default_factory=list)
    watched: list[str] = field(default_factory=list)
    calls: list[Call] = field(default_factory=list)
    tags: dict[str, list[TagRow]] = field(default_factory=dict)
    symbols: dict[BlockRef, str] = field(default_factory=dict)
    notes: dict[str, list[str]] = field(default_factory=dict)
    sheets: list[dict[str, Any]] = field(default_factory=list)
    contributions: list[Contribution] = field(default_factory=list)

    def stored(self, made: DataBlock | LibraryInstance) -> None:
        """Remember a data block."""
        self.data.append(made.block.name)
        if isinstance(made, LibraryInstance):
            self.symbols[made.block] = made.symbol
        else:
            self.documented.append(made.block.name)

    def program(self, made: FunctionBlock, call: Call | None) -> None:
        """Remember a function block and the call of its instance; its buffers are remembered by :meth:`stored`."""
        self.programs.append(made.block.name)
        self.notes.setdefault(made.note, []).append(made.block.name)
        if call is not None:
            self.calls.append(call)
        if made.instance is not None:
            self.symbols[made.instance] = f"FB {made.block.number}"
        self._sheet(made.block, made.title, made.telegrams, made.buffers)

    def type(self, made: TypeBlock) -> None:
        """Remember a user type."""
        self.types.append(made.block.name)
        if made.notes:
            self._sheet(made.block, "a record", made.notes, [(made, None)])

    def _sheet(
        self, block: BlockRef, title: str, lines: Sequence[str], parts: Sequence[tuple[TypeBlock, DataBlock | None]]
    ) -> None:
        blocks = [
            {
                "block": type_.block if data is None else data.block,
                "numbered": data is not None,
                "rows": type_.members,
                "size": type_.members[-1].offset + type_.members[-1].size,
            }
            for type_, data in parts
        ]
        if blocks:
            self.sheets.append({"title": title, "block": block, "telegrams": lines, "blocks": blocks})
