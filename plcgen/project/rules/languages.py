"""Rules about the languages of a project."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Severity
from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.project.rules.places import node_at

if TYPE_CHECKING:
    from collections.abc import Iterator

    from plcgen.project.nouns import Project

_LANGUAGE = re.compile(r"[a-z]{2,3}(?:-[A-Z][a-z]{3})?-[A-Z]{2}\Z")
_COMMON = (
    "en-US", "en-GB", "de-DE", "de-AT", "de-CH", "zh-CN", "zh-TW", "fr-FR", "it-IT", "es-ES", "pt-BR",
    "pt-PT", "nl-NL", "pl-PL", "cs-CZ", "sv-SE", "da-DK", "fi-FI", "nb-NO", "hu-HU", "tr-TR", "ru-RU", "ja-JP",
    "ko-KR",
)  # fmt: skip


def languages(project: Project) -> Iterator[Diagnostic]:
    """PG107: something is not a language tag, or a language is named twice."""
    seen: set[str] = set()
    for position, tag in enumerate(project.languages):
        span = project.loaded.span(("plc", "languages", position))
        if not _LANGUAGE.match(tag):
            yield Diagnostic("PG107", f'"{tag}" is not a language tag', span, help=_tag_help(tag))
        elif tag in seen:
            yield Diagnostic("PG107", f'language "{tag}" is named twice', span, help="remove one of them")
        seen.add(tag)


def comment_languages(project: Project) -> Iterator[Diagnostic]:
    """PG107: a comment in a language that the project does not have."""
    for path, texts in (found for plan in project.plans for found in plan.protocol.rules().texts(plan)):
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
                f'"{tag}" is not a language of the project: its comment is used only where those have none',
                node.key_span(tag),
                Severity.WARNING,
                help=f"{hint} languages of this project: {known}".strip(),
            )


def _tag_help(tag: str) -> str:
    hint = next((f'write "{one}":' for one in _COMMON if one.startswith(f"{tag}-")), did_you_mean(tag, _COMMON))
    return f"{hint} a tag is a language and a country, for example en-US, de-DE or zh-CN".strip()
