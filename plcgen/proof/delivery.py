"""Every file of a delivered folder: the checks of the group ``files``."""

from __future__ import annotations

from plcgen.project.nouns import Project
from plcgen.proof.checks import Check
from plcgen.proof.files import check_files
from plcgen.proof.folder import Folder
from plcgen.proof.headers import check_headers
from plcgen.proof.tables import check_tables
from plcgen.proof.twins import check_twins


def delivered(project: Project, folder: Folder) -> tuple[Check, ...]:
    """Manifest, encodings, syntax, the two spellings of every block, headers, tables."""
    looks = (check_files, check_twins, check_headers, check_tables)
    return tuple(check for look in looks for check in look(project, folder))
