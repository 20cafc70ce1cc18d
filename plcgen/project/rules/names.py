"""Rules about single names: what the target, its source encoding and the file system take."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from plcgen.diagnostics import Diagnostic, Severity, Span
from plcgen.project.rules.places import by_importance, key_or_value, member_span, name_span, node_at
from plcgen.s7.names import ROLES, check_name

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from plcgen.project.loading import SpecPath
    from plcgen.project.model import Project

_KEY = re.compile(r"[^\W\d_][\w-]*\Z")
_PARAMETER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*\Z")
_NUMBER = re.compile(r"[PpRr][0-9]+\Z")
_IDENTIFIER = re.compile(r"[^\W\d]\w*\Z")
_ADDRESS = re.compile(r"(?i)(?:P?[IQEA][BWDX]?|[ML][BWDX]?|[TCZ]|D[BI][BWDX]?|[FO][BC]|SF[BC]|UDT)[0-9]+\Z")
_ENCODINGS = {"cp1252": "Windows-1252", "utf-8-sig": "UTF-8"}


@dataclass(frozen=True, slots=True)
class Named:
    """A name of the project: what it names, its role as in ``s7.names.check_name``, how to find its place."""

    what: str
    name: str
    role: str
    place: Callable[[], Span]


def names(project: Project) -> Iterator[Diagnostic]:
    """PG405: a name the target, SCL or a file system does not take."""
    tool = "STEP 7 V5" if project.target.v5 else "TIA Portal"
    reported: set[Span] = set()
    for named in _names(project):
        reason = _reason(named, v5=project.target.v5)
        if reason is None or not _encodable(named.name, project.target.encoding):
            continue
        span = named.place()
        if span in reported:
            continue
        reported.add(span)
        on = f" for {tool}" if named.role in ROLES else ""
        message = f'{named.what} "{_shown(named.name)}" is not a name{on}: {reason}'
        yield Diagnostic("PG405", message, span, help=_help(named))


def encoding_of_names(project: Project) -> Iterator[Diagnostic]:
    """PG407: a name has a character that the source files cannot hold."""
    reported: set[Span] = set()
    for named in _names(project):
        char = _first_bad(named.name, project.target.encoding)
        if char is None or (span := named.place()) in reported:
            continue
        reported.add(span)
        yield Diagnostic(
            "PG407",
            f'{named.what} "{_shown(named.name)}": {_missing(project, char)}',
            span,
            help="use letters of western European languages, or a tia-v.. toolchain",
        )


def encoding_of_comments(project: Project) -> Iterator[Diagnostic]:
    """PG407: a comment, title or unit has a character that the source files cannot hold."""
    for path, text in _comments(project):
        char = _first_bad(text, project.target.encoding)
        if char is not None:
            yield Diagnostic(
                "PG407",
                f"this text does not reach the sources as written: {_missing(project, char)}",
                key_or_value(project, path),
                Severity.WARNING,
                help="give it in a language that uses western European letters, or use a tia-v.. toolchain",
            )


def _names(project: Project) -> Iterator[Named]:
    """Every name that reaches a source or a file, with keys of the spec first."""
    loaded = project.loaded
    value, key_of = loaded.span, loaded.key_span
    yield Named("project name", project.name, "text", partial(value, ("plc", "name")))
    for key, drive in loaded.spec.drives.items():
        yield Named("drive key", key, "key", partial(key_of, ("drives", key)))
        for text, parameter in drive.parameters.items():
            if parameter.name is not None:
                place = partial(value, ("drives", key, "parameters", text, "name"))
                yield Named("parameter name", parameter.name, "parameter", place)
    for key in loaded.spec.jobs:
        yield Named("job key", key, "key", partial(key_of, ("jobs", key)))
    for block in by_importance(project):
        yield Named("block", block.name, "symbol", partial(name_span, project, block))
    if project.ppi is not None:
        from plcgen.protocols.ppi.rules.names import ppi_names

        yield from (Named(*row) for row in ppi_names(project))
    for job in project.jobs:
        yield Named("member", job.member, "identifier", partial(key_of, job.path))
        for use in job.uses:
            yield Named("member", use.member, "identifier", partial(member_span, project, use))
        spec = loaded.spec.jobs[job.key]
        for which, buffer in (("request", spec.request), ("response", spec.response)):
            for old, new in buffer.members.items():
                yield Named("member", new, "identifier", partial(value, (*job.path, which, "members", old)))


def _reason(named: Named, *, v5: bool) -> str | None:
    """Why a name is not fit for its role, or None."""
    if named.role == "text":
        odd = next((char for char in named.name if not char.isprintable()), None)
        return None if odd is None else f"the character U+{ord(odd):04X} is not allowed"
    if named.role == "key":
        fits = _KEY.match(named.name) is not None
        return None if fits else "a key is a letter, then letters, digits, _ and -: blocks and files are named after it"
    if named.role == "parameter":
        if _PARAMETER.match(named.name) is None:
            return "a parameter name is a letter A-Z or a-z, then letters, digits and _"
        return "it looks like a parameter number" if _NUMBER.match(named.name) else None
    reason = check_name(named.name, v5, named.role)
    if reason is None and named.role == "identifier":
        if _IDENTIFIER.match(named.name) is None:
            return "a member is a letter or _, then letters, digits and _"
        if _ADDRESS.match(named.name):
            return "compilers read it as an address"
    return reason


def _help(named: Named) -> str:
    if named.role == "text":
        return "write the name in one line"
    if named.role == "key":
        return "rename the key, for example read_speed"
    return "choose another name, for example ReadSpeed" if named.role == "symbol" else "choose another name"


def _comments(project: Project) -> Iterator[tuple[SpecPath, str]]:
    """Texts that become comments: of drives, jobs, uses and the drives' own parameters."""
    for drive in project.drives:
        yield from _texts(project, (*drive.path, "comment"), drive.comment)
        for text, parameter in project.loaded.spec.drives[drive.key].parameters.items():
            for key, value in (("title", parameter.title), ("unit", parameter.unit)):
                yield (*drive.path, "parameters", text, key), value or ""
    if project.ppi is not None:
        from plcgen.protocols.ppi.rules.names import ppi_comments

        for path, texts in ppi_comments(project):
            yield from _texts(project, path, texts)
    for job in project.jobs:
        yield from _texts(project, (*job.path, "comment"), job.comment)
        for use in job.uses:
            yield from _texts(project, (*use.path, "comment"), use.comment)


def _texts(project: Project, path: SpecPath, texts: dict[str, str]) -> Iterator[tuple[SpecPath, str]]:
    node = node_at(project, path)
    for language, text in texts.items():
        yield ((*path, language) if node is not None and node.kind == "map" else path), text


def _first_bad(text: str, encoding: str) -> str | None:
    """Find the first character an encoding does not have."""
    if _encodable(text, encoding):
        return None
    return next((char for char in text if not _encodable(char, encoding)), None)


def _encodable(text: str, encoding: str) -> bool:
    try:
        text.encode(encoding)
    except UnicodeEncodeError:
        return False
    return True


def _missing(project: Project, char: str) -> str:
    code_page = _ENCODINGS.get(project.target.encoding, project.target.encoding)
    shown = char if char.isprintable() else ""
    return f"the sources are {code_page}, which has no {shown} (U+{ord(char):04X})".replace("  ", " ")


def _shown(name: str) -> str:
    """Spell a name as a message can print it: control characters escaped, long ones cut."""
    text = "".join(char if char.isprintable() else f"\\u{ord(char):04X}" for char in name)
    return text if len(text) <= 60 else f"{text[:57]}..."
