"""What lies in an output folder: manifest, blocks from the text sources, blocks from SimaticML."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from plcgen.diagnostics import Diagnostic, Span
from plcgen.plan.target import Dialect as TargetDialect
from plcgen.plan.target import Target
from plcgen.read.simaticml import read_simaticml
from plcgen.read.text import read_source
from plcgen.render.manifest import MANIFEST, known_files
from plcgen.s7.blocks import Block
from plcgen.scl.dialect import Dialect

SOURCES = (".scl", ".udt", ".db", ".awl")
DIALECTS = {
    TargetDialect.V5: Dialect.STEP7_V5,
    TargetDialect.T3: Dialect.TIA_300_400,
    TargetDialect.T15: Dialect.TIA_1200_1500,
}


@dataclass(slots=True)
class Folder:
    """Blocks by upper-case name, with the file each came from; ``problems`` is what could not be read."""

    path: Path
    text: dict[str, Block] = field(default_factory=dict)
    xml: dict[str, Block] = field(default_factory=dict)
    files: dict[str, Path] = field(default_factory=dict)
    problems: list[Diagnostic] = field(default_factory=list)

    def place(self, name: str) -> Span:
        """Where a block of the text sources stands."""
        block = self.text.get(name.upper())
        if block is not None and block.span is not None:
            return block.span
        return Span(str(self.files.get(name.upper(), self.path)))


def manifest_of(folder: Path) -> dict[str, str] | None:
    """Path -> SHA-256 of the files the manifest lists; None if there is none or it cannot be read."""
    try:
        return known_files((folder / MANIFEST).read_bytes())
    except (OSError, ValueError):
        return None


def generated_sources(folder: Path) -> list[Path]:
    """The text sources that belong to plcgen: those of the manifest, else those of its three folders.

    A copy in a subfolder or a source of the user beside them is not looked at.
    """
    known = manifest_of(folder)
    if known is None:
        found = [p for name in ("udt", "db", "scl") for p in (folder / name).glob("*")]
    else:
        root = folder.resolve()
        found = [folder / name for name in known]
        found = [path for path in found if path.resolve().is_relative_to(root)]
    return sorted(path for path in found if path.suffix.lower() in SOURCES and path.is_file())


def generated_documents(folder: Path) -> list[Path]:
    """The SimaticML documents that belong to plcgen, chosen as :func:`generated_sources` does."""
    known = manifest_of(folder)
    found = folder.glob("xml/*.xml") if known is None else (folder / name for name in known if name.startswith("xml/"))
    return sorted(path for path in found if path.suffix.lower() == ".xml" and path.is_file())


def read_folder(path: Path, where: Target, progress: Callable[[str, int, int], None] | None = None) -> Folder:
    """Read every generated source and every generated SimaticML block document of a folder."""
    folder = Folder(path)
    sources, documents = generated_sources(path), generated_documents(path)
    total = len(sources) + len(documents)
    for number, source in enumerate(sources):
        blocks, found = read_source(source, DIALECTS[where.dialect], encoding="cp1252" if where.v5 else None)
        folder.problems += found
        for block in blocks:
            earlier = folder.files.get(block.name.upper())
            if earlier is not None:
                message = f'block "{block.name}" is declared a second time, first in {earlier.name}'
                folder.problems.append(Diagnostic("PG610", message, block.span or Span(str(source))))
                continue
            folder.text[block.name.upper()] = block
            folder.files[block.name.upper()] = source
        if progress is not None and number % 50 == 0:
            progress("read", number, total)
    for number, document in enumerate(documents, len(sources)):
        blocks, found = read_simaticml(document, classic=where.classic)
        folder.problems += found
        folder.xml.update((block.name.upper(), block) for block in blocks)
        if progress is not None and number % 50 == 0:
            progress("read", number, total)
    return folder
