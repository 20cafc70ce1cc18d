"""What a protocol states about the texts of its documents, and how a text is held against such a statement."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from plcgen._version import __version__
from plcgen.base.diagnostics import Diagnostic
from plcgen.project.nouns import BlockRef, PlannedJob
from plcgen.proof.folder import plain, rendered
from plcgen.s7.types.blocks import Block

GENERATOR = ".".join(__version__.split(".")[:2])
"""VERSION in the header of every block that is made from the spec alone: that of plcgen."""
_MARKS = ("(*", "*)", "//", "/*", "*/", "'", "{", "}", ";", '"')
"""What a title must not contain: it would begin or end something else."""
_FACT = re.compile(
    r"(?:[A-Za-z]+#)?16#[0-9A-Fa-fx]+|\b[0-9A-F]{2,8}h\b|\b[rP][0-9]{1,5}(?:\[[0-9.]+\])?(?:\.[0-9]+)?"
    r"|\[[^\[\]]+\]|[0-9]+(?:\.[0-9]+)?"
)
"""What a text states in any language: numbers, parameters, units."""


@dataclass(frozen=True, slots=True)
class Shown:
    """How a watch table shows a place: its display format, and its modify value, None for the start value on disk."""

    format: str
    modify: str | None = ""


@dataclass(frozen=True, slots=True)
class GuideLine:
    """A line that a document must have; ``accepts`` says whether another spelling states the same."""

    text: str
    accepts: Callable[[str], bool] | None = None

    def agrees(self, text: str) -> bool:
        """Whether a line of a document says this."""
        found = rendered(text)
        return found == plain(self.text) or (self.accepts is not None and self.accepts(found))


class Wording(Protocol):
    """What a protocol states of the documents of one plan. Of a block that is not its own, it states nothing: None."""

    @property
    def family(self) -> str:
        """Family of its blocks."""

    @property
    def system_blocks(self) -> Sequence[str]:
        """Blocks of the CPU that STEP 7 V5 must have in the block folder."""

    @property
    def note(self) -> str:
        """Why the documents of its function blocks are experimental."""

    @property
    def jobs_called(self) -> str:
        """What its jobs are called, if they are the only ones."""

    @property
    def symbols(self) -> Mapping[str, str]:
        """Symbols of blocks that come with a module, with their comments."""

    @property
    def tag_table(self) -> str:
        """Name of its tag table, without the prefix of the project."""

    @property
    def controls(self) -> Collection[str]:
        """Names in capitals of the data blocks with the structures of its jobs."""

    def member(self, block: Block, path: Sequence[str], offset: int | None) -> frozenset[str] | None:
        """What the member at a path may say of itself; ``offset`` in bytes, None if there is none."""

    def assigned(self, block: Block, path: str) -> frozenset[str] | None:
        """What may stand behind the start value of a place, below BEGIN of a data block."""

    def title(self, block: Block) -> frozenset[str] | None:
        """What the title of a block may be."""

    def called(self, job: PlannedJob) -> frozenset[str] | None:
        """What a job may be called where it is commanded; None if it is another protocol's."""

    def spoken(self, block: Block) -> Mapping[str, str] | None:
        """Comment of the document of a type or data block, by language of the spec; its title is empty."""

    def head(self, block: Block) -> Iterator[str]:
        """What is wrong with the lines at the head of a block."""

    def remark(self, block: Block, code: str, text: str) -> bool:
        """Whether a comment behind some code states what is so; asked only where it has numbers or parameters."""

    def retains(self, block: Block) -> bool:
        """Whether a data block keeps its values without power."""

    def starts(self, block: Block) -> Mapping[str, bytes | str] | None:
        """Start values of the pins of a function block, as bytes or as a literal; other pins have none."""

    def instructions(self) -> Mapping[str, str]:
        """Instructions of the TIA Portal that its blocks declare, with the version of each."""

    def version(self, block: Block) -> str | None:
        """Version in the header of a block."""

    def sheet(self, block: Block) -> list[frozenset[str]] | None:
        """Lines above the tables of a block in the layout sheet, each with all that it may be."""

    def sheet_title(self, block: Block) -> str:
        """What it is called there if it has no title."""

    def shown(self, block: Block, path: Sequence[str], type_: str) -> Shown | None:
        """How a watch table shows a member of a type in capitals."""

    def guide(self) -> tuple[list[GuideLine], list[GuideLine]]:
        """Lines of the import guide in front of and behind the order."""

    def groundless(self) -> Iterator[Diagnostic]:
        """Where the plan that these texts are held against is not what the spec demands, read a second time."""

    def manifest(self) -> Mapping[str, object]:
        """What the manifest says of the plan."""


def held(text: str) -> bool:
    """Whether sources in Windows-1252, as those of STEP 7 V5, have every character of a text: else it is left out."""
    return text.encode("cp1252", "replace").decode("cp1252") == text


def untitled(text: str) -> str:
    """A text as a title has it."""
    for mark in _MARKS:
        text = text.replace(mark, " ".join(mark) if len(mark) > 1 else " ")
    return plain(text)


def stated_facts(text: str) -> list[str]:
    """Numbers, parameters and units of a text."""
    return _FACT.findall(text)


def states(text: str, wanted: str) -> bool:
    """Whether a text has all numbers, parameters and units of another one, in the same order."""
    found = iter(stated_facts(text))
    return all(fact in found for fact in stated_facts(wanted))


def agrees(found: str, stated: frozenset[str], *, english: bool) -> bool:
    """Whether a text is one of those that are stated.

    In another language than English, it has the same numbers, parameters and units as one of them.
    """
    said = untitled(found)
    if said in {untitled(text) for text in stated}:
        return True
    if english or not said:
        return False
    return any(text and states(said, untitled(text)) for text in stated)


def unlike(what: str, name: str | None, number: int | None, block: BlockRef | None) -> Iterator[str]:
    """Where a block is not called or numbered as the spec says; None: it says nothing."""
    for said, found in ((name, block and block.name), (number, block and block.number)):
        if said not in {None, found}:
            yield f"the {what} is {found}, the spec says {said}"
