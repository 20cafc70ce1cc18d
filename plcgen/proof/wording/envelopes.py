"""Around the blocks in SimaticML: engineering version, languages and what each of them says, attributes."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.project.nouns import Project
from plcgen.proof.folder import Folder, plain
from plcgen.proof.wording.guides import CULTURES, cultures
from plcgen.proof.wording.model import Wording, states, untitled
from plcgen.proof.wording.shapes import misshapen
from plcgen.s7.xml.reading.xml import child, children, load, local, parse_xml, span, text

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

Comments = Sequence[Mapping[str, str]]
"""What the spec says, by culture."""
_BLOCKS = ("SW.Blocks.", "SW.Types.")
_TABLES = ("SW.Tags.", "SW.WatchAndForceTables.")
_KNOWN = frozenset({"Name", "DataTypeName", "LogicalAddress", "Culture", "Text"})
"""Attributes of tables: rows of a watch table have a name only, the TIA Portal refuses others."""
_PARAMETERS = re.compile(r"\b[rP][0-9]")
_ADDRESS = re.compile(r"(?:.*: )?[A-Z]{1,2}[A-Z]?[0-9]+[0-9.\[\]]* ")
"""``C153``, ``state: VB100[2]``: what stands in front of the comment of an item."""
_FIXED = {"SetENOAutomatically": "false", "Namespace": ""}


def said_in_spec(project: Project) -> list[dict[str, str]]:
    """Everything under a key ``comment`` of the spec, by culture."""
    found: list[dict[str, str]] = []
    pending: list[object] = [project.loaded.spec.model_dump(exclude_none=True)]
    while pending:
        tree = pending.pop()
        if isinstance(tree, dict):
            said = tree.get("comment")
            if isinstance(said, dict):
                found.append({CULTURES.get(str(name), str(name)): plain(line) for name, line in said.items()})
            pending += tree.values()
        elif isinstance(tree, list | tuple):
            pending += tree
    return found


def check_envelope(
    project: Project, folder: Folder, stated: Sequence[Wording], path: Path, comments: Comments
) -> Iterator[Diagnostic]:
    """One document."""
    try:
        root = parse_xml(*load(path))
    except DiagnosticError:
        return  # told where the document is read
    place = Span(str(path))
    engineering = child(root, "Engineering")
    version = "" if engineering is None else engineering.get("version", "")
    if version != project.target.xml_version:
        message = f"the document is of {version}, {project.target.toolchain} writes {project.target.xml_version}"
        yield Diagnostic("PG614", message, place)
    yield from misshapen(path, root)
    wanted = cultures(project)
    for element in root.iter():
        tag = local(element)
        if tag == "MultilingualText":
            yield from _texts(path, element, list(_items(element)), wanted, comments, whole=True)
        elif tag == "Comment" and (said := [*children(element, "MultiLanguageText")]):
            texts = [(one.get("Lang", ""), text(one)) for one in said]
            yield from _texts(path, element, texts, wanted, comments, whole=False)
        elif tag.startswith((*_BLOCKS, *_TABLES)):
            yield from _attributes(path, element, tag)
        elif tag == "Member" and (copied := child(element, "Sections")) is not None:
            yield from _copied(path, element, copied)
        if tag in {"SW.Types.PlcStruct", "SW.Blocks.GlobalDB"}:
            block = folder.text.get(path.stem.upper())
            all_said = [one.spoken(block) for one in stated] if block is not None else []
            comment = {CULTURES.get(name, name): line for one in all_said for name, line in (one or {}).items()}
            yield from _described(path, element, comment)


def _copied(path: Path, member: Element, copied: Element) -> Iterator[Diagnostic]:
    """The members of a type, which a member of that type repeats with their comments."""
    name = member.get("Datatype", "").rpartition(" of ")[2].strip('"')
    own = [_spoken(one) for one in copied.iter("{*}Member")]
    declared = (
        _said_by(path.with_name(f"{name}.xml")) if any(one[1:] for one in own) else []
    )  # of an array none has any
    for one, two in zip(declared, own, strict=False):
        if one != two:
            message = f"{name}.{one[0]} says {_shown(one)}, its copy {two[0]} {_shown(two)}"
            yield Diagnostic("PG614", message, span(member, str(path)))


def _said_by(path: Path) -> list[tuple[str, ...]]:
    """The members of a type with their comments; none of a type without a document."""
    if not path.is_file():
        return []
    try:
        return [_spoken(one) for one in parse_xml(*load(path)).iter("{*}Member")]
    except DiagnosticError:
        return []  # told where the document is read


def _spoken(member: Element) -> tuple[str, ...]:
    """Name, then each comment with its language."""
    said = children(child(member, "Comment"), "MultiLanguageText")
    return member.get("Name", ""), *(f"{one.get('Lang', '')}: {text(one)}" for one in said)


def _shown(said: tuple[str, ...]) -> str:
    return ", ".join(f'"{one}"' for one in said[1:]) or "nothing"


def _described(path: Path, element: Element, wanted: Mapping[str, str]) -> Iterator[Diagnostic]:
    """Comment and title of a type or data block, which its source has no place for."""
    for group in children(child(element, "ObjectList"), "MultilingualText"):
        right = wanted if group.get("CompositionName") == "Comment" else {}
        for name, line in _items(group):
            if plain(line) != plain(right.get(name, "")):
                message = f'{group.get("CompositionName")} in {name} is "{line}", the spec says "{right.get(name, "")}"'
                yield Diagnostic("PG614", message, span(group, str(path)))


def _items(element: Element) -> Iterator[tuple[str, str]]:
    for item in children(child(element, "ObjectList"), "MultilingualTextItem"):
        listed = child(item, "AttributeList")
        yield text(child(listed, "Culture")), text(child(listed, "Text"))


def _texts(
    path: Path,
    element: Element,
    said: Sequence[tuple[str, str]],
    wanted: Sequence[str],
    comments: Comments,
    *,
    whole: bool,
) -> Iterator[Diagnostic]:
    """A text in its languages: those of the spec, once each, and the same numbers, parameters and units in all."""
    place = span(element, str(path))
    names = [name for name, _ in said]
    right = names == list(wanted) if whole else names == [name for name in wanted if name in names]
    if not right:
        yield Diagnostic("PG614", f"texts in {', '.join(names)}, the spec has {', '.join(wanted)}", place)
    spoken_ = [(name, plain(line)) for name, line in said if line.strip()]
    base = next((line for name, line in spoken_ if name.startswith("en")), "")
    for name, line in spoken_ if base else ():
        if not name.startswith("en") and not _alike(base, line) and not _own(base, line, name, comments):
            yield Diagnostic("PG614", f'{name} says "{line}", English "{base}"', place)
    for comment in comments if base else ():
        if not _holds(base, _english(comment)):
            continue
        for name, line in spoken_:
            if name in comment and not _own(base, line, name, comments):
                yield Diagnostic("PG614", f'{name} says "{line}", the spec "{comment[name]}"', place)


def _alike(base: str, line: str) -> bool:
    """Whether a translation states what the English text does.

    One that says less is what the parameter is called, where only the English text says more.
    """
    return states(line, base) or (bool(_PARAMETERS.findall(line)) and states(base, line))


def _holds(whole: str, part: str) -> bool:
    """Whether a comment of the spec is a text, or stands in it after a parameter, an address or a colon."""
    whole, part = untitled(whole), untitled(part)
    if not part or part not in whole:
        return False
    front, _, rest = whole.partition(part)
    leads = not front or front.endswith(": ") or bool(_PARAMETERS.match(front) or _ADDRESS.fullmatch(front))
    return leads and (not rest or rest[:2] in {" [", " ("})


def _english(comment: Mapping[str, str]) -> str:
    return next((line for name, line in comment.items() if name.startswith("en")), "")


def _own(base: str, line: str, name: str, comments: Comments) -> bool:
    """Whether the spec says so in this language: it may say other numbers there."""
    said = untitled(line)
    return any(untitled(own) in said and _holds(base, _english(one)) for one in comments if (own := one.get(name, "")))


def _attributes(path: Path, element: Element, tag: str) -> Iterator[Diagnostic]:
    found = {local(one): text(one).strip() for one in children(child(element, "AttributeList"))}
    place = span(element, str(path))
    for name, value in found.items():
        if name in _FIXED and value != _FIXED[name]:
            yield Diagnostic("PG614", f"{name} is {value}", place)
        elif tag.startswith(_TABLES) and name not in _KNOWN:
            yield Diagnostic("PG614", f"{tag} has the attribute {name}", place)
    own = found.get("Name", path.stem)
    if not tag.endswith(("PlcTag", "Entry")) and own != path.stem:
        yield Diagnostic("PG614", f"{path.name} holds {own}", place)
