"""What a spec becomes, as it is typed: telegrams with their bytes, the write list, the files against those on disk."""

from __future__ import annotations

import csv
import io
import re
import threading
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from plcgen.api import GenerateResult, default_folder
from plcgen.base.diagnostics import Severity
from plcgen.base.files.files import read_bounded
from plcgen.base.files.hashes import has_digest, same_text
from plcgen.build.environment import RenderedFile
from plcgen.build.rendering import render_project
from plcgen.build.writing import file_diff
from plcgen.ds47.hmi.lists import list_of
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.project.nouns import Project
from plcgen.report.review.collect import sheet_of
from plcgen.report.review.data import sheet_data
from plcgen.report.review.excerpts import excerpts
from plcgen.s7.read.generated import MANIFEST, known_files
from plcgen.s7.read.text import decode_source
from plcgen.s7.tables.tables import PanelTag
from plcgen.workbench.serve.room import digest
from plcgen.workbench.service.panel import tags_of

SOURCES = (".scl", ".udt", ".db")
MAX_COMPARED = 64 * 1024 * 1024
FIRST_TIME = (1980, 1, 1, 0, 0, 0)
"""The time of every file in an archive: the same spec gives the same bytes."""


@dataclass(frozen=True)
class Made:
    """The files of one text of a spec."""

    project: Project
    files: Mapping[str, RenderedFile]


class Maker:
    """Makes the files of a spec in memory; those of the last text are kept."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._last: tuple[str, str, Made] | None = None

    def make(self, path: Path, text: str, project: Project) -> Made:
        """All files of a project. Raises DiagnosticError."""
        key = path.as_posix(), text
        with self._lock:
            if self._last is None or self._last[:2] != key:
                self._last = *key, Made(project, {file.path: file for file in render_project(project)})
            return self._last[2]


def sources(made: Made) -> Iterator[tuple[str, str]]:
    """Names and texts of the sources."""
    texts = ((name, decode_source(file.data, name)) for name, file in made.files.items() if name.endswith(SOURCES))
    return ((name, text) for name, text in texts if isinstance(text, str))


def sheet(made: Made) -> dict[str, Any]:
    """Telegrams, write list and partners, with the lines of the sources that declare or set each member."""
    found = sheet_of(made.project)
    return {
        "project": made.project.name,
        "target": f"{made.project.target.family} / {made.project.target.toolchain}",
        **_placed(sheet_data(found), made.project, tags_of(made.project, sources(made))),
        "excerpts": [
            {
                "block": one.block,
                "file": one.file,
                "lines": [{"number": line.number, "text": line.text, "member": line.member} for line in one.lines],
            }
            for one in excerpts(sources(made), found.exchanges)
        ],
    }


def _placed(sheet: dict[str, Any], project: Project, blocks: Mapping[str, Sequence[PanelTag]]) -> dict[str, Any]:
    """The telegrams with the places of their values where a panel reaches these: a buffer in an instance has none."""
    tags = {tag.symbolic.partition(".")[2]: tag for found in blocks.values() for tag in found}
    members: dict[str, list[str]] = {}
    for job in project.jobs:
        members.setdefault(str(job.path[-1]), []).append(job.member)
    for telegram in sheet["telegrams"]:
        own = members.get(telegram["job"], [])
        for field in (field for part in (telegram["request"], *telegram["answers"]) for field in part["fields"]):
            tag = tags.get(f"{own[0]}.{field['name']}") if len(own) == 1 else None
            if tag is not None and not field["address"]:
                field["address"] = f"{tag.symbolic} {tag.absolute}".strip()
    return sheet


def panel(made: Made) -> dict[str, Any]:
    """What a panel needs: members of the data blocks by name and address, and the flags of jobs."""
    plan = made.project.plan(DrivePlan)
    drives = {job.member: job for job in plan.jobs} if plan else {}
    blocks = [
        {"name": name, "tags": [{**tag._asdict(), "list": _text_list(tag, drives)} for tag in tags]}
        for name, tags in tags_of(made.project, sources(made)).items()
    ]
    return {"blocks": blocks, "flags": list(_flags(made)), "jobs": [job.member for job in made.project.jobs]}


def listed(made: Made, spec: Path) -> list[dict[str, Any]]:
    """Every file and how it stands to the one on disk; ``foreign`` is one that is not as plcgen wrote it."""
    folder, found = default_folder(spec), []
    try:
        known = known_files(_on_disk(folder, MANIFEST) or b"{}")
    except ValueError:
        known = {}
    for name, file in made.files.items():
        old = _on_disk(folder, name)
        state = _state(file, old)
        foreign = state == "changed" and old is not None and not has_digest(old, known.get(name, ""))
        found.append({"path": name, "bytes": len(file.data), "state": state, "foreign": foreign})
    return found


def shown(made: Made, spec: Path, name: str) -> dict[str, Any] | None:
    """Text of a file, and its difference from the one on disk; None if there is no such file."""
    file = made.files.get(name)
    if file is None:
        return None
    old = _on_disk(default_folder(spec), name)
    state = _state(file, old)
    return {
        "path": name,
        "text": _text(file.data, name),
        "state": state,
        "disk": _text(old, name) if state == "changed" and old is not None else "",
        "diff": "".join(file_diff(file, old)) if state == "changed" else "",
    }


def _text_list(tag: PanelTag, drives: Mapping[str, DriveJob]) -> str:
    """The text list that a field with this tag shows; "" for none."""
    _, member, *path = *re.sub(r"\[[^]]*\]", "", tag.symbolic).split("."), ""
    return list_of(drives[member], path[:-1]) if member in drives and path[:-1] else ""


def _flags(made: Made) -> Iterator[dict[str, str]]:
    """Signals of jobs that have a flag or a symbol of their own, by the names of the tags."""
    file = made.files.get("tags.csv")
    lines = file.data.decode("utf-8-sig").splitlines()[1:] if file is not None else []
    names = {row[2]: row[0] for row in csv.reader(lines, delimiter=";")}
    for job in made.project.jobs:
        for signal in ("execute", "busy", "done", "error", "status"):
            found = getattr(job.trigger, signal)
            if found is None:
                continue
            absolute = "" if (signal, found) in set(job.trigger.symbols()) else f"%{found}"
            type_ = "WORD" if signal == "status" else "BOOL"
            tag = PanelTag(names.get(absolute, str(found)), absolute, type_, f"{signal}: {job.key}")
            yield tag._asdict()


def guide(folder: Path) -> str:
    """The steps of an import, as they lie in a folder."""
    data = _on_disk(folder, "IMPORT.md")
    return "" if data is None else data.decode("utf-8", "replace")


def in_the_way(done: GenerateResult) -> list[dict[str, str]]:
    """Files that writing would overwrite if it were told to, with why it did not and a hash; none if that is not all.

    A manifest of another project stands for all files of that one: it is never offered.
    """
    errors = [one for one in done.diagnostics if one.severity is Severity.ERROR]
    paths = [Path(one.span.file) for one in errors]
    own = [path for path in paths if path.is_relative_to(done.folder) and path.is_file() and path.name != MANIFEST]
    if any(one.code not in {"PG501", "PG502"} for one in errors) or len(own) < len(errors):
        return []
    return [
        {"path": path.relative_to(done.folder).as_posix(), "why": one.message, "held": digest(path.read_bytes())}
        for path, one in zip(paths, errors, strict=True)
    ]


def zipped(made: Made, spec: Path) -> bytes:
    """All files in one archive, below the name of their folder."""
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, file in made.files.items():
            info = zipfile.ZipInfo(f"{default_folder(spec).name}/{name}", FIRST_TIME)
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, file.data)
    return target.getvalue()


def _text(data: bytes, name: str) -> str:
    found = decode_source(data, name)
    return found if isinstance(found, str) else data.decode("utf-8", "replace")


def _on_disk(folder: Path, name: str) -> bytes | None:
    try:
        return read_bounded(folder / name, MAX_COMPARED)
    except OSError:
        return None


def _state(file: RenderedFile, old: bytes | None) -> str:
    if old is None:
        return "new"
    return "same" if same_text(old, file.data) else "changed" if file.path != MANIFEST else "manifest"
