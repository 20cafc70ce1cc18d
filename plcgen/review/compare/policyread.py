"""The shape of a policy: change ids and the class that each one has for a user."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, RootModel

from plcgen.diagnostics.suggest import did_you_mean
from plcgen.input.validation import Document, problem
from plcgen.review.compare.policy import KINDS, Level


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
        raise problem(f"{shown} is no class of change", code="PG631", help_=help_) from None


class Policy(RootModel[dict[Annotated[str, AfterValidator(_kind)], Annotated[Level, BeforeValidator(_level)]]]):
    """A policy file."""


POLICY = Document(
    Policy, "the policy", "a policy is a mapping of change ids to classes", "for example: member-renamed: compatible"
)
