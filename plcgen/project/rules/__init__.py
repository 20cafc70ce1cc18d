"""Rules: what is wrong with a planned project, one function per code and subject.

A rule takes the project and yields diagnostics; it changes nothing and needs no other rule. Problems of the
text itself (PG1xx) and of resolving it (unknown parameters, values out of range) are found before there is a
project.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from plcgen.diagnostics import Diagnostic, Report
from plcgen.project.model import Project
from plcgen.project.rules import flags, members, names, numbers, target
from plcgen.protocols.ds47.rules import parameters, telegrams

Rule = Callable[[Project], Iterator[Diagnostic]]

RULES: tuple[Rule, ...] = (
    target.languages,
    target.comment_languages,
    target.drive_object,
    target.unused_address,
    target.shared_address,
    parameters.definitions,
    parameters.access,
    parameters.repeated,
    parameters.dangerous,
    parameters.only_bytes,
    telegrams.response_buffer,
    telegrams.request_buffer,
    telegrams.reference,
    telegrams.timing,
    numbers.used_twice,
    numbers.out_of_range,
    flags.overlap,
    flags.out_of_range,
    names.names,
    names.encoding_of_names,
    names.encoding_of_comments,
    members.block_names,
    members.control_members,
    members.parameter_names,
    members.interface_members,
    members.buffer_members,
    members.overrides,
)
"""Every rule, in the order of the spec's subjects; reports are sorted by place anyway."""


def apply_rules(project: Project, report: Report) -> None:
    """Apply every rule; the functions are independent of each other."""
    for rule in RULES:
        report.extend(rule(project))
    if project.ppi is not None:
        from plcgen.protocols.ppi.rules import line as ppi

        report.extend(ppi.rules(project))
