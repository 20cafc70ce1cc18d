"""Rules: what is wrong with a planned project, one function per code and subject.

A rule takes the project, or one of its plans, and yields diagnostics; it changes nothing and needs no other rule.
Problems of the text itself (PG1xx) and of resolving it (unknown parameters, values out of range) are found before
there is a project.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from plcgen.base.diagnostics import Diagnostic, Report
from plcgen.project.nouns import Project
from plcgen.project.rules import flags, languages, names, numbers

RULES: tuple[Callable[[Project], Iterator[Diagnostic]], ...] = (
    languages.languages,
    languages.comment_languages,
    numbers.used_twice,
    numbers.numbers_out_of_range,
    numbers.too_many,
    flags.overlap,
    flags.flags_out_of_range,
    flags.symbols,
    flags.tags,
    names.check_names,
    names.lookalikes,
    names.block_names,
    names.owned_sources,
    names.encoding_of_names,
    names.encoding_of_comments,
)
"""The rules that every project has to keep; each protocol adds its own."""


def apply_rules(project: Project, report: Report) -> None:
    """Apply every rule; the functions are independent of each other, and reports are sorted by place."""
    for rule in RULES:
        report.extend(rule(project))
    for plan in project.plans:
        for check in plan.protocol.rules().checks:
            report.extend(check(plan))


def remarks(project: Project) -> Iterator[Diagnostic]:
    """What is worth knowing of a project in which nothing is wrong: notes, in the order of the plans."""
    for plan in project.plans:
        for remark in plan.protocol.rules().remarks:
            yield from remark(plan)
