"""The example of the main program: what it says of itself, its start information, the title of each call."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from plcgen.project.nouns import Project
from plcgen.proof.folder import Folder, plain
from plcgen.proof.wording.model import Wording, agrees, stated_facts
from plcgen.s7.types.blocks import Block, SectionKind
from plcgen.s7.types.data_types import ArrayType, Elementary

VERSION = "0.1"
START_INFORMATION = 20
"""Bytes that an OB of an S7-300/400 finds at the start of its local data (STEP 7 manual, organization blocks)."""
_CALL = re.compile(r'^(?:REGION |// ---- )(?P<title>.*?)(?: ----)?\n\s*(?P<call>"[^(\n]+)\(', re.MULTILINE)
_REMARK = re.compile(r"//\s*(.*)$", re.MULTILINE)
_COPY = "An example: if the project has a main program already, copy the calls into it."


def check_main(project: Project, folder: Folder, stated: Sequence[Wording], block: Block) -> Iterator[str]:
    """Everything that the block says."""
    english = project.languages[0].startswith("en")
    jobs = stated[0].jobs_called if len(stated) == 1 else "jobs"
    title = f"Example: calls of all {jobs}"
    if not agrees(block.title, frozenset({title}), english=english):
        yield f'its title is "{block.title}", not "{title}"'
    version, family = block.attributes.get("VERSION", VERSION).strip("'"), block.attributes.get("FAMILY", "")
    if version != VERSION or family != stated[0].family:
        yield f"its family and version are {family} {version}, not {stated[0].family} {VERSION}"
    if block.comment:
        yield f'no source for "{block.comment}"'
    yield from _local_data(project, block, english=english)
    code = block.code or ""
    titles = dict.fromkeys(found["title"] for found in _CALL.finditer(code))
    for found in _CALL.finditer(code):
        called = folder.text.get(_called(folder, found["call"]))
        if called is None or not agrees(found["title"], frozenset({called.title}), english=english):
            yield f'the calls under "{found["title"]}" are of {called.title if called is not None else "nothing known"}'
    for text in map(plain, _REMARK.findall(code)):
        known = text == _COPY or text.removeprefix("---- ").removesuffix(" ----") in titles
        if not known and (english or stated_facts(text)):
            yield f'no source for the comment "{text}"'


def _called(folder: Folder, call: str) -> str:
    """The function block of a call by the name of its instance; in STEP 7 V5 the block stands in front of it."""
    names = re.findall(r'"([^"]+)"', call)
    instance = folder.text.get(names[-1].upper()) if names else None
    return (instance.instance_of or "").upper() if instance is not None else ""


def _local_data(project: Project, block: Block, *, english: bool) -> Iterator[str]:
    members = [(section, member) for section in block.sections for member in section.members]
    if project.target.t15:
        yield from (f"it declares {member.name}" for _, member in members)
        return
    place = [
        member
        for section, member in members
        if section.kind is SectionKind.TEMP
        and isinstance(member.type, ArrayType)
        and member.type.element == Elementary("BYTE", 8)
        and member.type.bounds == ((0, START_INFORMATION - 1),)
        and agrees(member.comment, frozenset({"start information of the OB"}), english=english)
    ]
    if len(place) != 1 or len(members) != 1:
        yield f"its local data begin with {START_INFORMATION} bytes of start information, and have nothing else"
