"""Source texts for the compiler: types, data blocks, instance DBs, function blocks and the example OB."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from plcgen.build.document import Document
from plcgen.build.nouns import Call, DataBlock, FunctionBlock, LibraryInstance, TypeBlock
from plcgen.build.reread import Promise
from plcgen.build.spelling import spelling_of
from plcgen.build.voice import voice_of
from plcgen.project.nouns import BlockRef, Frame


class SourceWriter:
    """Sources of one project in the target's spelling, encoding, line ends and file names."""

    def __init__(self, frame: Frame) -> None:
        where = frame.target
        system = "s7-1500" if where.t15 else "s7-300"
        self.v5, self.classic = where.v5, where.classic
        self._encoding, self._spelling = where.encoding, spelling_of(where)
        voice = voice_of(frame)
        self._voice, self._say = voice.source, voice.line
        self.one = frame.loaded.spec.plc.sources == "one"
        self.main_path = "example/Main.scl" if self.one else "scl/Main.scl"
        self._newline = "\r\n" if where.v5 else "\n"
        self._common = {"s7_1500": where.t15, "system": system, "calls": "step7-v5" if where.v5 else system}

    def path(self, folder: str, name: str) -> str:
        """Path of the source of a block in one of the folders udt, db and scl: STEP 7 V5 knows only the ending .scl."""
        return f"{folder}/{name}.{'scl' if self.v5 else folder}"

    def type(self, made: TypeBlock) -> Document:
        """A user type."""
        view = {"name": made.block.name, "members": made.members, "starts": made.starts}
        promise = Promise("UDT", made.block.name, self._say, made.members, starts=made.starts)
        return self._document(self.path("udt", made.block.name), promise, "shared/type.udt.j2", view, group=1)

    def data(self, made: DataBlock, family: str) -> Document:
        """A global data block."""
        view: dict[str, Any] = {"name": made.block.name, "title": made.title, "family": family}
        view |= {"members": made.members, "assignments": made.assignments, "retain": made.block.retain}
        promise = Promise("DB", made.block.name, self._say, made.members, made.assignments)
        return self._document(self.path("db", made.block.name), promise, "shared/data.db.j2", view, group=2)

    def instance(self, block: BlockRef, of: str, family: str, group: int = 4) -> Document:
        """An instance DB of ``of``, as a source writes it."""
        template = "shared/instance_v5.db.j2" if self.v5 else "shared/instance.db.j2"
        promise = Promise("DB", block.name, self._say)
        view = {"name": block.name, "of": of, "family": family}
        return self._document(self.path("db", block.name), promise, template, view, group=group)

    def stored(self, made: DataBlock | LibraryInstance, family: str) -> Document:
        """A data block of either kind; what the compiler brings needs no function block before it."""
        if isinstance(made, DataBlock):
            return self.data(made, family)
        return self.instance(made.block, made.of, family, group=2)

    def program(self, made: FunctionBlock) -> Document:
        """A function block."""
        promise = Promise("FB", made.block.name, self._say, commands=made.commands)
        return self._document(self.path("scl", made.block.name), promise, made.template, made.view, group=3)

    def main(self, calls: Sequence[Call], jobs: str, family: str) -> Document:
        """The example OB1."""
        view = {
            "block": "OB1" if self.v5 else '"Main"',
            "title": f"Example: calls of all {jobs}",
            "family": family,
            "start_information": self.classic,
            "calls": calls,
            "call_form": "shared/call_v5.scl.j2" if self.v5 else "shared/call.scl.j2",
        }
        promise = Promise("OB", "OB1" if self.v5 else "Main", self._say)
        return self._document(self.main_path, promise, "shared/main.scl.j2", view)

    def table(self, path: str, text: str) -> Document:
        """A finished text for the same tool."""
        return Document(path, text=text, encoding=self._encoding, newline=self._newline)

    def _document(
        self, path: str, promise: Promise, template: str, view: Mapping[str, Any], group: int = 0
    ) -> Document:
        return Document(
            path,
            template,
            {**self._common, **view},
            encoding=self._encoding,
            newline=self._newline,
            spelling=self._spelling,
            voice=self._voice,
            promise=promise,
            group=group,
        )
