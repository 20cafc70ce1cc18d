"""Policies of users: which class every kind of change has for them."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, RootModel

from plcgen.base.diagnostics import Report, Span
from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.base.files.text import read_text
from plcgen.base.files.validation import FileShape, problem, read_document, validate
from plcgen.base.files.yaml import plain_node
from plcgen.s7.compare.policy import KINDS, Level


def _kind(key: str) -> str:
    if key not in KINDS:
        hint = did_you_mean(key, KINDS) or "plcgen diff --list-changes shows all of them"
        raise problem(f'there is no kind of change "{key}"', code="PG631", help_=hint)
    return key


def _level(word: object) -> Level:
    try:
        return Level(str(word).strip().lower())
    except ValueError:
        shown = f'"{word}"' if isinstance(word, str | int | float) else "this"
        help_ = "one of breaking, compatible, documentation"
        raise problem(f"{shown} is not a class of change", code="PG631", help_=help_) from None


class Policy(RootModel[dict[Annotated[str, AfterValidator(_kind)], Annotated[Level, BeforeValidator(_level)]]]):
    """A policy file."""


POLICY = FileShape(
    Policy, "the policy", "a policy is a mapping of change ids to classes", "for example: member-renamed: compatible"
)


def load_policy(settings: Iterable[str]) -> dict[str, Level]:
    """Levels by change id: the defaults, then every setting in order, ``id=level`` or the path of a YAML file.

    Raises:
        DiagnosticError: PG631 for an unknown id or level, and the codes of reading YAML.
    """
    policy = {kind.id: kind.level for kind in KINDS.values()}
    report = Report()
    for setting in settings:
        policy |= _read(setting, report)
    report.raise_on_errors()
    return policy


def _read(setting: str, report: Report) -> dict[str, Level]:
    key, separator, value = setting.partition("=")
    if separator:
        typed = validate(plain_node({key.strip(): value.strip()}, Span(f"--policy {setting}")), POLICY, report)
        return typed.root if typed else {}
    path = Path(setting)
    with report.catch():
        loaded = read_document(read_text(path), path.as_posix(), POLICY, report)
        if loaded:
            return loaded.model.root
    return {}
