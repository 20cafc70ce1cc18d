"""A spec as a state: its jobs and drives, and the blocks that would be generated from it."""

from __future__ import annotations

from pathlib import Path

from plcgen.project.composing import from_disk
from plcgen.project.includes import Read
from plcgen.project.nouns import Project
from plcgen.project.opening import open_spec
from plcgen.s7.compare.model import Snapshot
from plcgen.s7.compare.states import snapshot_of
from plcgen.s7.read.blocks import read_texts
from plcgen.s7.read.generated import SOURCES


def spec_snapshot(path: Path, read: Read = from_disk) -> Snapshot:
    """State of a spec; its diagnostics are in the snapshot, without blocks if it cannot be planned."""
    opened = open_spec(path, read)
    project = opened.usable
    if project is None:
        return Snapshot(path.as_posix(), diagnostics=list(opened.diagnostics), jobs={})
    snapshot = _rendered(project, path.as_posix())
    snapshot.jobs = {job.key: job for plan in project.plans for job in plan.protocol.job_states(plan)}
    snapshot.drives = {link.key: link for plan in project.plans for link in plan.protocol.link_states(plan)}
    buffers = (buffer for plan in project.plans for buffer, _ in plan.protocol.buffers(plan))
    mirrored = (block for buffer in buffers for block in (buffer.type, buffer.db) if block is not None)
    snapshot.mirrored = frozenset(block.name.upper() for block in mirrored)
    return snapshot


def _rendered(project: Project, label: str) -> Snapshot:
    """Blocks of the sources that would be generated, read as if they lay on disk."""
    from plcgen.build.rendering import render_project

    encoding = "cp1252" if project.target.v5 else "utf-8-sig"
    texts = [
        (file.path, file.data.decode(encoding, "replace"))
        for file in render_project(project)
        if file.path.lower().endswith(SOURCES)
    ]
    snapshot = snapshot_of(read_texts(sorted(texts)), label)
    snapshot.diagnostics = [
        d for d in snapshot.diagnostics if d.code != "PG630"
    ]  # nobody can add the types of a library
    return snapshot
