"""Headers of delivered blocks against the plan: which blocks there are, their kinds, numbers and attributes."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.project.nouns import BlockRef, Project
from plcgen.project.ownership import is_owned
from plcgen.proof.checks import Check, file_check
from plcgen.proof.folder import Folder
from plcgen.s7.read.generated import generated_documents
from plcgen.s7.types.blocks import Block, BlockKind
from plcgen.s7.types.data_types import Member, inner_members
from plcgen.s7.xml.reading.xml import child, children, load, local, parse_xml, text

MAIN, AUTHOR = "Main", "plcgen"
HEADER = frozenset({"AUTHOR", "FAMILY", "NAME", "VERSION"})
"""All that the header of a block may say; anything else (READ_ONLY, UNLINKED, ..) changes what it does."""
_CODE = frozenset({BlockKind.FB, BlockKind.FC, BlockKind.OB})
_WORDS = re.compile(r"^\s*(READ_ONLY|UNLINKED|KNOW_HOW_PROTECT|STANDARD|CODE_VERSION1|RETAIN)\b", re.MULTILINE)
_ENTRY = re.compile(r"^\s*(AUTHOR|FAMILY|NAME|VERSION|TITLE|NON_RETAIN|\{ *S7_Optimized_Access)\b", re.MULTILINE)
_ACCESS, _BOTH = re.compile(r"S7_Optimized_Access\s*:=\s*([^\s}]*)"), frozenset({"'TRUE'", "'FALSE'"})
_BODY = re.compile(r"^\s*(?:VAR|STRUCT|BEGIN|\"|//)", re.MULTILINE)
_STATED = {"AutoNumber": "false", "SecondaryType": "ProgramCycle"}


def check_headers(project: Project, folder: Folder) -> Iterator[Check]:
    """One check over all sources, one over all documents."""
    owned = project.loaded.spec.plc.user_owned
    wanted = {ref.name.upper(): ref for ref in project.blocks}
    main = "OB1" if project.target.v5 else MAIN
    wanted[main.upper()] = BlockRef("OB", main, 1, pinned=False, path=())
    for id_, subject, blocks in (("headers.text", "blocks", folder.text), ("headers.xml", "documents", folder.xml)):
        if not blocks and project.target.xml_version is None:
            continue
        problems = list(_missing(wanted, blocks, folder, subject))
        for name, block in blocks.items():
            if is_owned(block.name, owned):
                continue
            said = [*_block(project, folder, wanted.get(name), block, document=blocks is folder.xml)]
            place = block.span or folder.place(name)
            problems += [Diagnostic("PG614", f'{block.kind} "{block.name}": {one}', place) for one in said]
        if blocks is folder.text:
            problems += [
                one for name in sorted(folder.files) if not is_owned(name, owned) for one in _protected(folder, name)
            ]
        if blocks is folder.xml:
            problems += [one for path in generated_documents(folder.path) for one in _stated(path)]
        yield file_check(id_, subject, f"{len(blocks)} blocks", problems, "kinds, numbers and attributes of the plan")


def _missing(
    wanted: dict[str, BlockRef], blocks: dict[str, Block], folder: Folder, subject: str
) -> Iterator[Diagnostic]:
    for name, ref in wanted.items():
        library = folder.text.get(name)
        if name not in blocks and not (library is not None and _of_library(library, folder)):
            message = f'{ref.kind} "{ref.name}" is missing among the {subject}'
            yield Diagnostic("PG608", message, Span(str(folder.path)), help="run plcgen generate")


def _of_library(block: Block, folder: Folder) -> bool:
    return bool(block.instance_of) and (block.instance_of or "").upper() not in folder.text


def _block(project: Project, folder: Folder, ref: BlockRef | None, block: Block, *, document: bool) -> Iterator[str]:
    if ref is None:
        yield "the plan has no such block"
        return
    if block.kind != ref.kind:
        yield f"the plan has {ref.kind}"
    if block.number is not None and block.kind is not BlockKind.UDT and block.number != ref.number:
        yield f"has the number {block.number}, the plan {ref.number}"
    strange = set(block.attributes) - HEADER
    if strange:
        yield f"has the attribute {min(strange)}"
    if not document and block.attributes.get("AUTHOR", AUTHOR) != AUTHOR:
        yield f"its author is {block.attributes['AUTHOR']}"
    twin = folder.text.get(block.name.upper())
    both = set(block.attributes) & set(twin.attributes) if twin is not None else set()
    if document and twin is not None and any(block.attributes[name] != twin.attributes[name] for name in both):
        yield "author, family, name or version differ from the source"
    if block.kind is BlockKind.DB and not (block.instance_of or project.target.v5) and block.non_retain == ref.retain:
        yield "does not keep its values (NON_RETAIN)" if ref.retain else "keeps its values (RETAIN)"
    optimized = _access(project, folder, block)
    stated = block.optimized is not None and (not document or twin is None or twin.optimized is not None)
    if block.kind is not BlockKind.UDT and stated and block.optimized != optimized:
        yield f"has {'optimized' if block.optimized else 'standard'} access"
    for member in _members(member for section in block.sections for member in section.members):
        if block.kind not in _CODE and not block.instance_of and member.attributes:
            yield f"{member.name} has attributes"


def _access(project: Project, folder: Folder, block: Block) -> bool:
    """Whether a block has optimized access: the example OB of S7-1200/1500, instances of the library as they say."""
    if block.name.upper() == MAIN.upper():
        return project.target.t15
    return bool(block.optimized) if _of_library(block, folder) else False


def _members(members: Iterator[Member]) -> Iterator[Member]:
    for member in members:
        yield member
        yield from _members(iter(inner_members(member.type)))


def _protected(folder: Folder, name: str) -> Iterator[Diagnostic]:
    """Words of a header that change what a block does and that the model of a block has no place for."""
    head = _BODY.split(folder.text_of(name), maxsplit=1)[0]
    said = [f"the header says {word}" for word in dict.fromkeys(_WORDS.findall(head))]
    counts = Counter(_ENTRY.findall(head))
    said += [f"the header has {word} {count} times" for word, count in counts.items() if count > 1]
    said += [f"the header has S7_Optimized_Access := {value}" for value in _ACCESS.findall(head) if value not in _BOTH]
    yield from (Diagnostic("PG614", text, folder.place(name)) for text in said)


def _stated(path: Path) -> Iterator[Diagnostic]:
    """What the model of a block has no place for: who gives the number, language, event class."""
    try:
        root = parse_xml(*load(path))
    except DiagnosticError:
        return  # told where the document is read
    for element in children(root):
        if not local(element).startswith("SW.Blocks."):
            continue
        found = {local(one): text(one).strip() for one in children(child(element, "AttributeList"))}
        code = local(element) in {"SW.Blocks.FB", "SW.Blocks.FC", "SW.Blocks.OB"}
        for name, value in {**_STATED, "ProgrammingLanguage": "SCL" if code else "DB"}.items():
            if name in found and found[name] != value:
                message = f"{name} is {found[name]}, not {value}"
                yield Diagnostic("PG614", message, Span(str(path)))
