"""SimaticML of types, global DBs, tag table and watch tables for TIA Portal V14 SP1..V21.

Source of the structure: genuine exports as described by Siemens' Openness manual; the interface island follows
``SW.InterfaceSections``. IDs are upper-case hexadecimal in document order; attribute lists are alphabetical.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from plcgen.documents.code import VERSION_NOTE
from plcgen.documents.document import Document
from plcgen.documents.spelling import culture, one_line, type_words
from plcgen.project.nouns import BlockRef, Frame
from plcgen.protocols.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.protocols.ds47.views.blocks import DIAGNOSTICS, TOKEN, control_fields
from plcgen.protocols.ds47.views.jobs import title
from plcgen.protocols.ds47.views.rows import Row, telegram_rows
from plcgen.protocols.ds47.views.tables import tags
from plcgen.simaticml.versions import VERSIONS

TAG_TABLE = "DriveJobTags"

WATCH_NOTE = "watch tables follow the Openness manual; no genuine export was at hand to compare with"


class _Ids:
    """Counter of a document's IDs."""

    def __init__(self) -> None:
        self.next = 0

    def __call__(self) -> str:
        self.next += 1
        return f"{self.next - 1:X}"


def shared_xml(project: DrivePlan) -> Iterator[Document]:
    """Types and tokens that every job uses."""
    yield type_document(project, project.diagnostics_type, fixed_members(project, DIAGNOSTICS), {})
    yield type_document(project, project.token_type, fixed_members(project, TOKEN), {})
    for token, drives in project.tokens:
        yield db_document(project, token, fixed_members(project, TOKEN), drives[0].comment)


def job_xml(project: DrivePlan, job: DriveJob, watch: list[dict[str, str]]) -> Iterator[Document]:
    """Types, buffers and watch table of one job."""
    for telegram in job.telegrams:
        request, response = telegram_rows(project, telegram)
        yield type_document(project, telegram.request.type, request, job.comment)
        yield db_document(project, telegram.request.db, request, job.comment)
        yield type_document(project, telegram.response.type, response, job.comment)
        yield db_document(project, telegram.response.db, response, job.comment)
    yield watch_xml(project, job.block.name, watch)


def watch_xml(project: Frame, block: str, watch: list[dict[str, str]]) -> Document:
    """The watch table of a function block."""
    ids = _Ids()
    table_id = ids()
    view = {
        **_base(project),
        "name": f"Watch_{block}",
        "id": table_id,
        "rows": [{**row, "id": ids()} for row in watch],
    }
    return _document(f"xml/Watch_{block}.xml", "simaticml/watch.xml.j2", view, WATCH_NOTE)


def closing_xml(project: DrivePlan) -> Iterator[Document]:
    """The control DB and the tag table."""
    yield db_document(project, project.control_db, _control(project), {})
    rows = tags(project)
    if rows:
        yield tag_document(project, TAG_TABLE, rows)


def fixed_members(project: Frame, rows: tuple[tuple[str, str, str], ...]) -> list[dict[str, Any]]:
    """Members of a type that every project has."""
    words = type_words(tia=True)
    return [plain_member(project, name, words[type_], text) for name, type_, text in rows]


def plain_member(project: Frame, name: str, type_: str, text: str, start: str = "") -> dict[str, Any]:
    """A member whose comment is not translated: the English text stands in every language of the project."""
    comments = [(culture(language), one_line(text)) for language in project.languages] if text else []
    return {"name": name, "type": type_, "start": start, "subs": (), "comments": comments, "members": ()}


def _control(project: DrivePlan) -> list[dict[str, Any]]:
    found = []
    for job in project.jobs:
        members = [
            plain_member(project, row["name"], row["type"], row["text"], row["start"].removeprefix(" := "))
            for row in control_fields(project, job)
        ]
        found.append({**plain_member(project, job.member, "Struct", title(project, job)), "members": members})
    return found


def _texts(project: Frame, comment: dict[str, str], ids: _Ids) -> list[dict[str, Any]]:
    """Comment and Title objects of a block, one item a language."""
    objects = []
    for name in ("Comment", "Title"):
        text_id = ids()
        items = [
            {
                "id": ids(),
                "culture": culture(language),
                "text": one_line(comment.get(language, "")) if name == "Comment" else "",
            }
            for language in project.languages
        ]
        objects.append({"id": text_id, "name": name, "entries": items})
    return objects


def _base(project: Frame) -> dict[str, Any]:
    version = VERSIONS[project.target.xml_version or ""]
    return {
        "version": version.name,
        "namespace": version.interface_namespace,
        "layout": "Standard" if project.target.t15 else "",
        "with_namespace": version.has_type_namespace,
        "note": VERSION_NOTE if version.early else "",
    }


def _document(path: str, template: str, view: dict[str, Any], experimental: str = "") -> Document:
    return Document(path, template, view, "utf-8-sig", "\n", experimental)


def type_document(
    project: Frame, block: BlockRef, members: Sequence[Row | dict[str, Any]], comment: dict[str, str]
) -> Document:
    """A user type."""
    ids = _Ids()
    view = {
        **_base(project),
        "name": block.name,
        "members": members,
        "id": ids(),
        "texts": _texts(project, comment, ids),
    }
    return _document(f"xml/{block.name}.xml", "simaticml/type.xml.j2", view, view["note"])


def db_document(
    project: Frame, block: BlockRef, members: Sequence[Row | dict[str, Any]], comment: dict[str, str]
) -> Document:
    """A global data block."""
    ids = _Ids()
    view = {
        **_base(project),
        "name": block.name,
        "number": block.number,
        "members": members,
        "id": ids(),
        "texts": _texts(project, comment, ids),
    }
    return _document(f"xml/{block.name}.xml", "simaticml/db.xml.j2", view, view["note"])


def tag_document(project: Frame, name: str, rows: list[dict[str, Any]]) -> Document:
    """A tag table."""
    ids = _Ids()
    table_id = ids()
    entries = []
    for row in rows:
        tag = {**row, "id": ids(), "text_id": ids()}
        tag["entries"] = [{"id": ids(), "culture": culture(language)} for language in project.languages]
        entries.append(tag)
    view = {**_base(project), "name": name, "id": table_id, "tags": entries}
    return _document(f"xml/{name}.xml", "simaticml/tags.xml.j2", view, view["note"])
