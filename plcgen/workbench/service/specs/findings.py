"""Everything that ``check`` says of a spec, with the reason of its code and what an editor can do about it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import islice

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Severity, Span
from plcgen.base.diagnostics.codes import code as code_info
from plcgen.base.files.files import YAML_SUFFIXES, walk
from plcgen.workbench.service.documents import Document
from plcgen.workbench.service.results import Edit, Finding, Fix
from plcgen.workbench.service.specs.drives import drives_at
from plcgen.workbench.service.specs.form import define
from plcgen.workbench.service.specs.names import named
from plcgen.workbench.service.specs.others import problems
from plcgen.workbench.service.specs.sketch import sketch
from plcgen.workbench.service.specs.state import Specs, matches

MOST = 1_000
"""Findings of one text; nobody reads more at once."""
_SEARCHED = 200
"""So many files are looked at for those that include a part of a spec."""
_WHOLES = 8
"""So many of them are checked."""


def findings(specs: Specs, document: Document) -> tuple[Finding, ...]:
    """The findings of a document; of a part that other specs include, those that these specs have there."""
    state = specs.state(document)
    if not state.is_spec:
        return tuple(finding(specs, one) for one in problems(state)[:MOST])
    found: Iterable[Diagnostic] = state.checked.diagnostics
    if state.is_part:
        wholes = _wholes(specs, document)
        if wholes:
            there = (one for whole in wholes for one in specs.state(whole).checked.diagnostics)
            found = dict.fromkeys(one for one in there if one.span.file == document.file)
        else:
            found = [one for one in found if not (one.code == "PG105" and one.message.startswith("the spec lacks"))]
    return tuple(finding(specs, one) for one in list(found)[:MOST])


def finding(specs: Specs, diagnostic: Diagnostic) -> Finding:
    """A diagnostic with what its code says and its fixes."""
    info = code_info(diagnostic.code)
    document = specs.documents.get(diagnostic.span.file)
    fixes = () if document is None else (*fixes_of(diagnostic, document), *_typed(specs, diagnostic, document))
    return Finding(diagnostic, info.why, diagnostic.help or info.fix, fixes)


_UNTYPED = re.compile(r"(?:\A|\Anobody knows the type of )[PpRr]([0-9]+)\b")


def _typed(specs: Specs, diagnostic: Diagnostic, document: Document) -> Iterator[Fix]:
    """A parameter that nobody knows, defined in its drive: its type is for the user to choose."""
    number = _UNTYPED.match(diagnostic.message) if diagnostic.code in {"PG204", "PG267"} else None
    if number is None or not document.is_yaml:
        return
    state, place = specs.state(document), diagnostic.span
    at = next((one.path for one in state.sketch.entries if place in {one.key, one.place}), ())
    drives = drives_at(state, at)
    for type_ in _TYPES if len(drives) == 1 else ():
        try:
            edits = define(state, drives[0].key, int(number[1]), type_)
        except DiagnosticError:  # the drive stands in another file
            return
        yield Fix(f"define P{number[1]} in the drive as {type_}", edits)


def _wholes(specs: Specs, part: Document) -> Sequence[Document]:
    """The specs that include a part: those that are open, else those on disk."""
    known = specs.including(part)
    if known or not specs.documents.writable(part.path):
        return known
    names = (folder / name for folder, _, names in walk(specs.documents.folder) for name in names)
    candidates = (path for path in names if path.suffix.lower() in YAML_SUFFIXES and path != part.path)
    documents = filter(None, map(specs.documents.get, islice(candidates, _SEARCHED)))
    wholes = (one for one in documents if "include" in one.text and specs.state(one).includes(part.file))
    return tuple(islice(wholes, _WHOLES))


_MEANT = re.compile(r'\Adid you mean "([^"]+)"\?')
_QUOTED = re.compile(r'"([^"]+)"|\b(\S+) is not')
_WRITE = re.compile(r"\Awrite (\[[^\]]*\]|[a-z_0-9]+(?=: keys)|[A-Za-z]+[0-9]+(?:\[[0-9.]+\])?(?=\Z|,|: the ))")


def fixes_of(diagnostic: Diagnostic, document: Document) -> Iterator[Fix]:
    """What an editor can do about a problem: what its help says, where that is one edit."""
    place, help_ = diagnostic.span, diagnostic.help
    text = document.part(place)
    meant = _MEANT.match(help_)
    if meant is not None and text:
        edit = _replaced(diagnostic, text, meant[1])
        if edit is not None:
            yield Fix(f'replace it with "{meant[1]}"', (edit,))
    written = _WRITE.match(help_)
    if written is not None and text not in {"", written[1]}:
        yield Fix(f"write {written[1]}", (Edit(place, written[1]),))
    if help_ == "remove the quotes" and text[:1] in {'"', "'"} and text[-1:] == text[:1]:
        yield Fix("remove the quotes", (Edit(place, text[1:-1]),))
    quoted = re.search(r'put it in quotes: ("[^"]*")|, or ("[^"]*") in quotes', help_)
    if quoted is not None and text:
        yield Fix("put it in quotes", (Edit(place, quoted[1] or quoted[2]),))
    if diagnostic.code in {"PG103", "PG104"} and text and not meant:
        removed = _removed(document, place)
        if removed is not None:
            yield Fix(f"remove {text}", (removed,))
    yield from _additions(diagnostic, document)
    if diagnostic.severity is Severity.WARNING and place.line and diagnostic.code != "PG111":
        yield _allowed(diagnostic, document)


_TYPES = ("FloatingPoint", "Unsigned16", "Integer16", "Unsigned32", "Integer32")
"""Those of nearly all parameters."""
_ADD = re.compile(
    r"add (?:(allow(?:_safety)?: \{P[0-9]+: )why(\}) to the job|(verify: readback)(?=\Z|,)"
    r"|([a-z_]+: )to this (drive|master))"
)
_LACKS = re.compile(r'lacks the key "(\w+)"\Z')


def _additions(diagnostic: Diagnostic, document: Document) -> Iterator[Fix]:
    """A key that is missing; its value, and the reason of a sign-off, are for the user to give."""
    added, lacking = _ADD.search(diagnostic.help), _LACKS.search(diagnostic.message)
    if added is not None:
        text = added[3] or added[4] or f"{added[1]}{added[2]}"
        first = _first_key_of(document, diagnostic.span, added[5] or "job")
        if first is not None:
            yield Fix(f"add {text.strip()}", (_before(document, first, text),))
    elif lacking is not None and diagnostic.span.line:
        top = diagnostic.message.startswith("the spec lacks")
        edit = _behind(document, f"{lacking[1]}:\n  ") if top else _before(document, diagnostic.span, f"{lacking[1]}: ")
        yield Fix(f"add {lacking[1]}:", (edit,))


def _first_key_of(document: Document, place: Span, word: str) -> Span | None:
    """The first key of the job, drive or master in which a place is."""
    homes = next(kind.homes for kind in named() if kind.word == word)
    found = sketch(document.text, document.file)
    around = [
        one
        for one in found.entries
        if (one.key.line, one.key.column) <= (place.line, place.column)
        and any(matches(one.path[:-1], home) for home in homes)
    ]
    return next((one.key for one in found.below(around[-1].path)), None) if around else None


def _behind(document: Document, text: str) -> Edit:
    """A section behind all others."""
    last = len(document.lines)
    column = len(document.lines[-1]) + 1
    return Edit(Span(document.file, last, column, last, column), f"{'' if column == 1 else chr(10)}{text}")


def _before(document: Document, place: Span, text: str) -> Edit:
    """A key in front of another one, or behind the bracket of a mapping."""
    line, column = document.lines[place.line - 1], place.column
    if line[column - 1 : column] == "{":
        column, text = column + 1, f"{text}, "
    elif line[: column - 1].strip(" -"):
        text = f"{text}, "
    else:
        text = f"{text}\n{' ' * (column - 1)}"
    return Edit(Span(place.file, place.line, column, place.line, column), text)


def _replaced(diagnostic: Diagnostic, text: str, meant: str) -> Edit | None:
    """The word of the place that is wrong, replaced: the whole text, or the part that the message quotes."""
    place = diagnostic.span
    words = [one for pair in _QUOTED.findall(diagnostic.message) for one in pair if one]
    bare = text.strip("\"'")
    if bare in words or not any(word in text for word in words):
        quote = text[0] if text[:1] in {'"', "'"} else ""
        return Edit(place, f"{quote}{meant}{quote}") if bare in words else None
    word = next(word for word in words if word in text)
    start = place.column + text.index(word)
    return Edit(Span(place.file, place.line, start, place.line, start + len(word)), meant)


def _removed(document: Document, place: Span) -> Edit | None:
    """The key at a place and all below it, where it has lines of its own."""
    found = sketch(document.text, document.file)
    at = next((n for n, one in enumerate(found.entries) if one.key == place), None)
    if at is None or document.lines[place.line - 1][: place.column - 1].strip():
        return None
    entry, end = found.entries[at], place.line
    for below in found.entries[at:]:
        if below.path[: len(entry.path)] != entry.path:
            break
        end = max(end, below.place.end_line)
    after = document.lines[end : end + 1]
    if after and after[0].strip()[:1] in {"]", "}"}:
        return None
    last = len(document.lines)
    return Edit(
        Span(place.file, place.line, 1, min(end + 1, last), 1 if end < last else len(document.lines[-1]) + 1), ""
    )


def _allowed(diagnostic: Diagnostic, document: Document) -> Fix:
    """A comment above the line; the reason is for the user to give, and ``check`` asks for it."""
    line = document.lines[diagnostic.span.line - 1] if diagnostic.span.line <= len(document.lines) else ""
    indent = line[: len(line) - len(line.lstrip())]
    above = Span(diagnostic.span.file, diagnostic.span.line, 1, diagnostic.span.line, 1)
    comment = Edit(above, f"{indent}# plcgen: allow {diagnostic.code} \n")
    return Fix("accept this warning; write the reason into the comment", (comment,))
