"""Every place in the sources of a folder at which a block or a member is named."""

from __future__ import annotations

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.s7.read.text import load_text
from plcgen.s7.types.blocks import SectionKind
from plcgen.workbench.service.documents import Document
from plcgen.workbench.service.sources.names import definition, meant_at, uses
from plcgen.workbench.service.sources.state import Sources
from plcgen.workbench.service.sources.version import SourceState

MOST = 2_000
"""Places that are listed."""


def source_references(sources: Sources, document: Document, line: int, column: int) -> tuple[Span, ...]:
    """The places, the definition first; of files that are not open, those whose text has the name are looked at."""
    state, line = sources.at(document, line)
    found = meant_at(state, state.offset(line, column))
    if found is None:
        return ()
    key = found[0].key
    home = definition(state, line, column)
    inside = found[0].section in {SectionKind.TEMP, SectionKind.CONSTANT}
    own = [state] if inside else [part for _, part in sources.file(document).parts]
    places = dict.fromkeys(place for part in own for place in uses(part, key))
    for path in () if inside else sources.files():
        other = sources.documents.find(path)
        if other is not None:
            parts = () if other is document else sources.file(other).parts
            places |= dict.fromkeys(place for _, part in parts for place in uses(part, key))
        else:
            text = load_text(path)
            if not isinstance(text, Diagnostic) and key[-1] in text[0].upper():
                passing = SourceState(Document(path, text[0]), state.types, path.as_posix())
                places |= dict.fromkeys(uses(passing, key))
        if len(places) > MOST:
            break
    first = [] if home is None else [one for one in places if (one.file, one.line) == (home.file, home.line)] or [home]
    return tuple(map(sources.real, dict.fromkeys([*first[:1], *places])))[:MOST]
