"""Rules about single names: what the target, its source encoding and the file system take."""

from __future__ import annotations

import re
from functools import partial
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Note, Severity
from plcgen.base.files.lookalikes import skeleton
from plcgen.project.nouns import flag_name
from plcgen.project.part import Named
from plcgen.project.rules.places import by_importance, key_or_value, name_span, node_at
from plcgen.s7.types.names import ROLES, check_name, is_identifier

if TYPE_CHECKING:
    from collections.abc import Iterator

    from plcgen.base.diagnostics import Span
    from plcgen.project.nouns import Project
    from plcgen.project.spec import SpecPath

_KEY = re.compile(r"[^\W\d_][\w-]*\Z")
_PARAMETER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*\Z")
_NUMBER = re.compile(r"[PpRr][0-9]+\Z")
_ADDRESS = re.compile(r"(?i)(?:P?[IQEA][BWDX]?|[ML][BWDX]?|[TCZ]|D[BI][BWDX]?|[FO][BC]|SF[BC]|UDT)[0-9]+\Z")
_FIXED = ("plc",)
"""Where the spec speaks of what every project has."""
_ENCODINGS = {"cp1252": "Windows-1252", "utf-8-sig": "UTF-8"}


def check_names(project: Project) -> Iterator[Diagnostic]:
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


def block_names(project: Project) -> Iterator[Diagnostic]:
    """PG406: a block has the name of another block, table or tag; letter case does not matter."""
    first = {name.lower(): (f'"{name}"', what, span) for name, what, span in _taken(project)}
    reported: set[tuple[Span, Span | None]] = set()
    for block in by_importance(project.blocks):
        if block.path == _FIXED:
            continue
        span = name_span(project, block)
        mine = (f'"{block.name}"', "", span)
        earlier = first.setdefault(block.name.lower(), mine)
        name, what, place = earlier
        if earlier is mine or (span, place) in reported:
            continue
        reported.add((span, place))
        yield Diagnostic(
            "PG406",
            f'block name "{block.name}" is {f"also the name of {what}" if what else "used twice"}',
            span,
            help="rename one of them: letter case makes no difference",
            notes=(Note(f"first use: {name}", place),) if place else (),
        )


def owned_sources(project: Project) -> Iterator[Diagnostic]:
    """PG512: a block is the user's own, and a part of the one source that plcgen writes."""
    plc = project.loaded.spec.plc
    names = {block.name for block in project.blocks} if plc.sources == "one" else ()
    for number, owned in enumerate(plc.user_owned):
        folder, _, name = owned.rpartition("/")
        if folder in {"", "udt", "db", "scl"} and PurePosixPath(name).stem in names:
            message = f'"{owned}" is yours, and a part of the one source that generate writes'
            span = key_or_value(project, ("plc", "user_owned", number))
            yield Diagnostic("PG512", message, span, help="write plc: {sources: per_block}: one file for each block")


def _taken(project: Project) -> Iterator[tuple[str, str, Span | None]]:
    """Names that blocks of a spec must not have: of what every project gets, and of tables and tags."""
    yield "Main", "the example OB1", None
    if project.target.v5:
        from plcgen.s7.types.system import standard_library

        yield from ((name, "a block of the standard library", None) for name in sorted(standard_library()))
    for block in project.blocks:
        if block.path == _FIXED:
            yield block.name, "a block of every project", None
    for plan in project.plans:
        yield from plan.protocol.rules().taken(plan)
    for job in project.jobs:
        for signal in dict(job.trigger.flags()):
            span = key_or_value(project, (*job.path, "trigger", signal))
            yield flag_name(project.prefix, job.member, signal), f'the {signal} flag of job "{job.key}"', span


def lookalikes(project: Project) -> Iterator[Diagnostic]:
    """PG414: a name looks like another one of the project, and is written in other letters."""
    first: dict[str, Named] = {}
    for named in _names(project):
        earlier = first.setdefault(skeleton(named.name), named)
        if earlier.name.lower() != named.name.lower():
            message = f'{named.what} "{named.name}" looks like {earlier.what} "{earlier.name}" in other letters'
            notes = (Note("the other one", earlier.place()),)
            help_ = "write both in the letters of one script"
            yield Diagnostic("PG414", message, named.place(), help=help_, notes=notes)


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
    """Every name that reaches a source or a file."""
    yield Named("project name", project.name, "text", partial(project.loaded.span, ("plc", "name")))
    for plan in project.plans:
        yield from plan.protocol.rules().names(plan)
    for block in by_importance(project.blocks):
        yield Named("block", block.name, "symbol", partial(name_span, project, block))
    for job in project.jobs:
        yield Named("member", job.member, "identifier", partial(project.loaded.key_span, job.path))


def _reason(named: Named, *, v5: bool) -> str | None:
    """Why a name is not fit for its role, or None."""
    if named.role == "text":  # its characters were looked at when it was read
        return None
    if named.role == "key":
        fits = _KEY.match(named.name) is not None
        return None if fits else "a key is a letter, then letters, digits, _ and -: blocks and files are named after it"
    if named.role == "parameter":
        if _PARAMETER.match(named.name) is None:
            return "a parameter name is a letter A-Z or a-z, then letters, digits and _"
        return "it looks like a parameter number" if _NUMBER.match(named.name) else None
    reason = check_name(named.name, v5, named.role)
    if reason is None and named.role == "identifier":
        if not is_identifier(named.name):
            return "a member is a letter or _, then letters, digits and _"
        if _ADDRESS.match(named.name):
            return "compilers read it as an address"
    return reason


def _help(named: Named) -> str:
    if named.role == "key":
        return "rename the key, for example read_speed"
    return "choose another name, for example ReadSpeed" if named.role == "symbol" else "choose another name"


def _comments(project: Project) -> Iterator[tuple[SpecPath, str]]:
    """Texts that become comments, with their places."""
    for plan in project.plans:
        rules = plan.protocol.rules()
        yield from rules.untranslated(plan)
        for path, texts in rules.texts(plan):
            yield from _texts(project, path, texts)


def _texts(project: Project, path: SpecPath, texts: dict[str, str]) -> Iterator[tuple[SpecPath, str]]:
    """A text of the spec with its places; what it leaves out is plcgen's own, which has a language that fits."""
    node = node_at(project, path)
    if node is None:
        return
    for language, text in texts.items():
        yield ((*path, language) if node.kind == "map" else path), text


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
