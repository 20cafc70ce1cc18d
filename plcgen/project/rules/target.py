"""Rules about the controller and the drives as a whole: drive objects, languages."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from plcgen.diagnostics import Diagnostic, Note, Severity
from plcgen.diagnostics.suggest import did_you_mean
from plcgen.project.rules.places import key_or_value, node_at

if TYPE_CHECKING:
    from collections.abc import Iterator

    from plcgen.project.loading import SpecPath
    from plcgen.project.model import PlannedDrive, Project

_LANGUAGE = re.compile(r"[a-z]{2,3}(?:-[A-Z][a-z]{3})?-[A-Z]{2}\Z")
_COMMON = (
    "en-US", "en-GB", "de-DE", "de-AT", "de-CH", "zh-CN", "zh-TW", "fr-FR", "it-IT", "es-ES", "pt-BR",
    "pt-PT", "nl-NL", "pl-PL", "cs-CZ", "sv-SE", "da-DK", "fi-FI", "nb-NO", "hu-HU", "tr-TR", "ru-RU", "ja-JP",
    "ko-KR",
)  # fmt: skip
_SHOWN = 12


def drive_object(project: Project) -> Iterator[Diagnostic]:
    """PG217: the device has no such drive object."""
    for drive in project.drives:
        allowed = drive.device.drive_objects
        if allowed is None or drive.drive_object in allowed:
            continue
        numbers = ", ".join(map(str, allowed[:_SHOWN]))
        yield Diagnostic(
            "PG217",
            f"{drive.device.title} has no drive object {drive.drive_object}",
            key_or_value(project, (*drive.path, "drive_object")),
            help=f"its drive objects: {numbers} ({drive.device.drive_object_rule})",
        )


def unused_address(project: Project) -> Iterator[Diagnostic]:
    """PG215: the kind of address that only the other CPU families use has no effect."""
    classic = project.target.classic
    useless, used = ("hardware_id", "address") if classic else ("address", "hardware_id")
    for drive in project.drives:
        spec = project.loaded.spec.drives[drive.key]
        if getattr(spec, useless) is None or getattr(spec, used) is None:
            continue
        yield Diagnostic(
            "PG215",
            f"{useless} has no effect: an {project.target.family.upper()} uses {used}",
            project.loaded.key_span((*drive.path, useless)),
            Severity.WARNING,
            help=f"remove {useless}",
        )


def shared_address(project: Project) -> Iterator[Diagnostic]:
    """PG221: one drive object has two names."""
    first: dict[tuple[int, int], PlannedDrive] = {}
    key = "address" if project.target.classic else "hardware_id"
    for drive in project.drives:
        earlier = first.setdefault((drive.id_value, drive.drive_object), drive)
        given = node_at(project, (*drive.path, key))
        if earlier is drive or given is None:
            continue
        yield Diagnostic(
            "PG221",
            f'drives "{earlier.key}" and "{drive.key}" are the same: one {key}, one drive object',
            given.span,
            Severity.WARNING,
            help=f'use "{earlier.key}" for both, or correct the {key} or the drive_object',
            notes=(Note("first use", key_or_value(project, (*earlier.path, key))),),
        )


def languages(project: Project) -> Iterator[Diagnostic]:
    """PG107: something is not the tag of a language, or a language is named twice."""
    seen: set[str] = set()
    for position, tag in enumerate(project.languages):
        span = project.loaded.span(("plc", "languages", position))
        if not _LANGUAGE.match(tag):
            yield Diagnostic("PG107", f'"{tag}" is not the tag of a language', span, help=_tag_help(tag))
        elif tag in seen:
            yield Diagnostic("PG107", f'language "{tag}" is named twice', span, help="remove one of them")
        seen.add(tag)


def comment_languages(project: Project) -> Iterator[Diagnostic]:
    """PG107: a comment in a language that the project does not have would be left out."""
    for path, texts in _comments(project):
        node = node_at(project, path)
        if node is None or node.kind != "map":
            continue
        for tag in texts:
            if tag in project.languages:
                continue
            known = ", ".join(project.languages)
            hint = did_you_mean(tag, project.languages)
            yield Diagnostic(
                "PG107",
                f'the comment in "{tag}" is left out: plc.languages does not name it',
                node.key_span(tag),
                Severity.WARNING,
                help=f"{hint} languages of this project: {known}".strip(),
            )


def _comments(project: Project) -> Iterator[tuple[SpecPath, dict[str, str]]]:
    for drive in project.drives:
        yield (*drive.path, "comment"), drive.comment
    for job in project.jobs:
        yield (*job.path, "comment"), job.comment
        for use in job.uses:
            yield (*use.path, "comment"), use.comment


def _tag_help(tag: str) -> str:
    hint = did_you_mean(tag, _COMMON)
    return f"{hint} a tag is a language and a country, for example en-US, de-DE or zh-CN".strip()
