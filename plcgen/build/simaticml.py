"""SimaticML for TIA Portal V14 SP1..V21: the nouns of documents once more, and code blocks from their SCL text.

Source of the structure: genuine exports as described by Siemens' Openness manual; the interface island follows
``SW.InterfaceSections``. IDs are upper-case hexadecimal in document order; attribute lists are alphabetical. Code is
made from the rendered source, so that text and document can never differ.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import count
from typing import Any

from plcgen.build.document import Document
from plcgen.build.nouns import Call, DataBlock, FunctionBlock, LibraryInstance, TagRow, TypeBlock, WatchRow
from plcgen.build.spelling import culture, one_line
from plcgen.build.voice import voice_of
from plcgen.project.nouns import Frame
from plcgen.s7.types.blocks import Block, BlockKind
from plcgen.s7.xml.spelling import VERSIONS
from plcgen.s7.xml.writing.documents import Setting
from plcgen.s7.xml.writing.structured_text import code_document, instance_document

RECORD_NOTE = "the call form of WRREC and RDREC is inferred; no genuine export was available to compare with"
VERSION_NOTE = "no genuine export of this TIA Portal version was available to compare with"
WATCH_NOTE = "watch tables follow the Openness manual; no genuine export was available to compare with"
_MAIN_NUMBER = 1

Twins = Callable[[Block], Iterator[Document]]
"""Makes documents from the block of a finished source."""


class SimaticMl:
    """Documents of one project; its target has an ``xml_version``."""

    def __init__(self, frame: Frame) -> None:
        version = VERSIONS[frame.target.xml_version or ""]
        self._languages = frame.languages
        self._cultures = tuple(culture(language) for language in frame.languages)
        self._texts_of = voice_of(frame).texts
        self._setting = Setting(version, frame.target.classic, self._cultures, self._texts_of)
        self._early = VERSION_NOTE if version.early else ""
        self.note = VERSION_NOTE if version.inferred or version.early else ""
        """Why documents of this version are experimental, if they are."""
        self._base = {
            "version": version.name,
            "namespace": version.interface_namespace,
            "layout": "Standard" if frame.target.t15 else "",
            "with_namespace": version.has_type_namespace,
        }

    def type(self, made: TypeBlock) -> Document:
        """A user type."""
        return self._declared(made, "simaticml/type.xml.j2", starts=made.starts)

    def data(self, made: DataBlock | LibraryInstance) -> Iterator[Document]:
        """A global data block; instances of library blocks make themselves in the TIA Portal."""
        if isinstance(made, DataBlock):
            yield self._declared(made, "simaticml/db.xml.j2")

    def _declared(self, made: TypeBlock | DataBlock, template: str, *, starts: bool = True) -> Document:
        ids = _ids()
        block = made.block
        view = {"name": block.name, "number": block.number, "members": made.members, "starts": starts, "id": next(ids)}
        view["retain"] = block.retain
        return self._document(block.name, template, {**view, "texts": self._texts(made.comment, ids)}, self._early)

    def watch(self, name: str, rows: Sequence[WatchRow]) -> Document:
        """The watch table of a function block."""
        ids = _ids()
        view = {"name": f"Watch_{name}", "id": next(ids), "rows": [(next(ids), row) for row in rows]}
        return self._document(f"Watch_{name}", "simaticml/watch.xml.j2", view, WATCH_NOTE)

    def tags(self, name: str, rows: Sequence[TagRow]) -> Document:
        """A tag table."""
        ids = _ids()
        view: dict[str, Any] = {"name": name, "id": next(ids), "tags": []}
        for row in rows:
            tag = {**row._asdict(), "id": next(ids), "text_id": next(ids)}
            texts = dict(self._texts_of(row.text))
            tag["entries"] = [
                {"id": next(ids), "culture": shown, "text": texts.get(shown, "")} for shown in self._cultures
            ]
            view["tags"].append(tag)
        return self._document(name, "simaticml/tags.xml.j2", view, self._early)

    def program(self, made: FunctionBlock) -> Twins:
        """What makes the documents of a function block and of its instance DB from the block as it is read."""
        return partial(self._pair, made)

    def main(self, calls: Sequence[Call]) -> Twins:
        """What makes the document of the example OB1 from the block as it is read."""
        return partial(self._main, calls)

    def _pair(self, made: FunctionBlock, block: Block) -> Iterator[Document]:
        block, db = replace(block, number=made.block.number), made.instance
        called = [each for each in made.data if isinstance(each, LibraryInstance)]
        others = tuple(Block(BlockKind.DB, each.block.name, (), instance_of=each.of.strip('"')) for each in called)
        yield self._finished(made.block.name, code_document(block, self._setting, others), made.note)
        if db is None:
            return
        header = {key: text for key, text in block.attributes.items() if key != "NAME"} | {"VERSION": "0.1"}
        instance = Block(BlockKind.DB, db.name, (), number=db.number, instance_of=block.name, attributes=header)
        yield self._finished(db.name, instance_document(instance, block, self._setting), self.note)

    def _main(self, calls: Sequence[Call], block: Block) -> Iterator[Document]:
        instances = tuple(Block(BlockKind.DB, call.instance, (), instance_of=call.block) for call in calls)
        block = replace(block, number=_MAIN_NUMBER)
        yield self._finished(block.name, code_document(block, self._setting, instances), self.note)

    def _finished(self, name: str, text: str, experimental: str) -> Document:
        return Document(f"xml/{name}.xml", text=text, encoding="utf-8-sig", experimental=experimental)

    def _document(self, name: str, template: str, view: Mapping[str, Any], experimental: str) -> Document:
        made = {**self._base, **view}
        return Document(f"xml/{name}.xml", template, made, encoding="utf-8-sig", experimental=experimental)

    def _texts(self, comment: Mapping[str, str], ids: Iterator[str]) -> list[dict[str, Any]]:
        """Comment and Title objects of a block, one item a language."""
        objects = []
        for name in ("Comment", "Title"):
            text_id = next(ids)
            items = [
                {
                    "id": next(ids),
                    "culture": culture(language),
                    "text": one_line(comment.get(language, "")) if name == "Comment" else "",
                }
                for language in self._languages
            ]
            objects.append({"id": text_id, "name": name, "entries": items})
        return objects


def _ids() -> Iterator[str]:
    """IDs of a document, in order."""
    return (f"{number:X}" for number in count())
