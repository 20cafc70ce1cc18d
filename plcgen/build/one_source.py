"""All sources of a project in one file: types, data blocks, function blocks, their instances, in this order.

So are the sources that the TIA Portal makes of blocks with all that they need, and STEP 7 wants them ("Programming with
STEP 7", 05/2010, 13.2.3: types before what uses them, shared data blocks before the blocks that access them, called
blocks before calling ones, instance data blocks behind their function block).
"""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterable, Iterator

from plcgen.base.diagnostics import Diagnostic, DiagnosticError
from plcgen.base.paths import is_device
from plcgen.build.environment import RenderedFile
from plcgen.project.nouns import Project
from plcgen.s7.scl.parser import MAX_CHARACTERS

MAX_NAME = 24
"""Characters of the name of a file: as many as STEP 7 V5 has for a name."""


def source_path(project: Project) -> str:
    """Name of the one source, made of the PLC's: what no folder and no STEP 7 takes becomes ``_``."""
    name = re.sub(r"[^\w-]+", "_", project.name, flags=re.ASCII if project.target.v5 else re.NOFLAG)
    name = name.strip("_")[:MAX_NAME] or "PLC"
    return f"{name}_.scl" if is_device(name) else f"{name}.scl"


def joined(project: Project, files: Iterable[RenderedFile]) -> Iterator[RenderedFile]:
    """The files of a project with its sources as one, behind the others.

    Raises:
        DiagnosticError: PG512 if they are more than a reader of sources takes.
    """
    groups: dict[int, list[bytes]] = {}
    for file in files:
        if not file.group:
            yield file
        else:
            groups.setdefault(file.group, []).append(file.data.removeprefix(codecs.BOM_UTF8))
    mark, between = (b"", b"\r\n") if project.target.v5 else (codecs.BOM_UTF8, b"\n")
    data = mark + between.join(part for group in sorted(groups) for part in groups[group])
    if len(data) > MAX_CHARACTERS:
        message = f"all blocks in one source are {len(data):,} bytes; plcgen reads sources of {MAX_CHARACTERS:,}"
        span = project.loaded.key_span(("plc",))
        raise DiagnosticError([Diagnostic("PG512", message, span, help="write plc: {sources: per_block}")])
    yield RenderedFile(source_path(project), data)
