"""What people read, held against spec, telegrams and blocks on disk: comments, titles, tables, guides, manifest.

Each protocol states what its texts must say (:class:`~plcgen.proof.wording.model.Wording`); nothing of it comes
from what writes the documents. A text that nobody states is an error.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import chain

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.base.files.files import read_bounded
from plcgen.project.nouns import Project
from plcgen.project.ownership import is_owned
from plcgen.proof.checks import Check, Outcome, file_check
from plcgen.proof.folder import Folder
from plcgen.proof.wording.comments import check_block
from plcgen.proof.wording.envelopes import check_envelope, said_in_spec
from plcgen.proof.wording.guides import (
    DOCUMENTS,
    GUIDE,
    broken_tables,
    check_documents_guide,
    check_guide,
    check_line_ends,
)
from plcgen.proof.wording.languages import read_back
from plcgen.proof.wording.listing import FILE as MANIFEST
from plcgen.proof.wording.listing import check_manifest
from plcgen.proof.wording.main import check_main
from plcgen.proof.wording.model import Wording
from plcgen.proof.wording.sheet import FILE as SHEET
from plcgen.proof.wording.sheet import Said, check_sheet
from plcgen.proof.wording.tags import check_symbols, check_tags
from plcgen.proof.wording.watches import Watches
from plcgen.s7.read.generated import ATTRIBUTES
from plcgen.s7.types.blocks import BlockKind

MAX_BYTES = 16 * 1024 * 1024


def wording_of(project: Project) -> list[Wording]:
    """What the protocols of a project state, in the order of its plans; one that states nothing is left out."""
    proofs = [plan.protocol.proof(plan) for plan in project.plans if plan.jobs]
    made = [getattr(proof, "wording", None) for proof in proofs]
    return [make() for make in made if make is not None]


def check_wording(project: Project, folder: Folder) -> Iterator[Check]:
    """One check over the blocks of the text sources, one over their documents, one over what lies beside them."""
    stated = wording_of(project)
    if len(stated) < sum(bool(plan.jobs) for plan in project.plans):
        text = "not run: a protocol of this project states nothing of its documents"
        yield Check("files.wording", "wording", "", Outcome.NOT_RUN, text)
        return
    problems = list(_blocks(project, folder, stated))
    figures = f"{len(folder.text)} blocks"
    yield file_check("files.comments", "comments", figures, problems, "titles, comments and start values as stated")
    if project.target.xml_version is not None:
        comments = said_in_spec(project)
        paths = sorted(folder.path.glob("xml/*.xml"))
        owned = project.loaded.spec.plc.user_owned
        problems = [
            one
            for path in paths
            if not is_owned(path.stem, owned) and not is_owned(f"xml/{path.name}", owned)
            for one in check_envelope(project, folder, stated, path, comments)
        ]
        text = f"{len(paths)} documents"
        yield file_check("files.languages", "languages", text, problems, "version, languages and attributes as stated")
    problems = [*(one for wording in stated for one in wording.groundless()), *_files(project, folder, stated)]
    yield file_check("files.wording", "wording", "tables, guides, manifest", problems, "say what the spec says")


def _blocks(project: Project, folder: Folder, stated: Sequence[Wording]) -> Iterator[Diagnostic]:
    english = project.languages[0].startswith("en")
    for block in folder.text.values():
        if is_owned(block.name, project.loaded.spec.plc.user_owned):
            continue
        if block.kind is BlockKind.OB:
            place = block.span or folder.place(block.name)
            said = check_main(project, folder, stated, block)
            yield from (Diagnostic("PG614", f'{block.kind} "{block.name}": {one}', place) for one in said)
        for one in stated:
            yield from check_block(block, folder, one, english=english)


def _files(project: Project, folder: Folder, stated: Sequence[Wording]) -> Iterator[Diagnostic]:
    """Every file beside the blocks that the user has not made his own; one that cannot be read is told elsewhere."""
    watches = Watches(project, folder, stated)
    looks: dict[str, Callable[[str], Iterator[Said]]] = {
        GUIDE: partial(check_guide, project, folder.path, stated),
        SHEET: partial(check_sheet, project, folder, stated),
        ATTRIBUTES: check_line_ends,
        MANIFEST: partial(check_manifest, project, folder, stated),
        DOCUMENTS: partial(check_documents_guide, project, folder, stated),
        "symbols.sdf": partial(check_symbols, project, stated),
        "tags.csv": partial(check_tags, project, stated),
        **{f"watch/{path.name}": watches.table for path in sorted(folder.path.glob("watch/*.csv"))},
    }
    for name, look in looks.items():
        path = folder.path / name
        if path.is_file() and not is_owned(name, project.loaded.spec.plc.user_owned):
            encoding = "cp1252" if name.endswith(".sdf") else "utf-8-sig"
            text = read_bounded(path, MAX_BYTES).decode(encoding, "replace").replace("\r\n", "\n")
            told = read_back(text, project.languages[0]) if name in {GUIDE, SHEET, DOCUMENTS} else text
            said = chain(look(told), broken_tables(text) if name.endswith(".md") else ())
            yield from (Diagnostic("PG614", what, Span(str(path), line, 1)) for line, what in said)
