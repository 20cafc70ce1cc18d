"""Every file of a delivered folder: the checks of the group ``files``."""

from __future__ import annotations

from functools import partial

from plcgen.base.diagnostics import Span
from plcgen.project.nouns import Project
from plcgen.proof.checks import Check
from plcgen.proof.files import check_files
from plcgen.proof.folder import Folder
from plcgen.proof.headers import check_headers
from plcgen.proof.making import Pending, make_checks
from plcgen.proof.tables import check_tables
from plcgen.proof.twins import check_twins
from plcgen.proof.wording import check_wording


def delivered(project: Project, folder: Folder) -> tuple[Check, ...]:
    """Manifest, encodings, syntax, the two spellings of every block, headers, tables, what texts say."""
    place = Span(str(folder.path))
    looks = {
        "files.twins": ("text and SimaticML", check_twins),
        "headers": ("headers", check_headers),
        "files.tables": ("tables", check_tables),
        "files.wording": ("wording", check_wording),
    }
    found = (
        Pending(id_, subject, lambda: place, partial(look, project, folder)) for id_, (subject, look) in looks.items()
    )
    return tuple(make_checks((*check_files(project, folder), *found), "files", place))
