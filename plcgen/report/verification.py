"""Verification as text: one line per check, three aligned columns: subject, figures, verdict."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from plcgen.diagnostics import Diagnostic
from plcgen.report.cells import clean, pad, wrap
from plcgen.report.cells import width as cells
from plcgen.report.paint import paint
from plcgen.report.text import DEFAULT_WIDTH, MIN_WIDTH, SourceLine, diagnostics_text

if TYPE_CHECKING:
    from plcgen.verify.model import Check, CheckGroup, Verification

_SUBJECT_LIMIT = 30
_MIN_FIGURES = 24
_GAP = 2


def problems(verification: Verification) -> list[Diagnostic]:
    """Every diagnostic of a verification once, those of the checks first."""
    found = [check.diagnostic for check in verification.checks() if check.diagnostic is not None]
    return list(dict.fromkeys([*found, *verification.diagnostics]))


def verification_text(
    verification: Verification, lines: SourceLine, *, color: bool = False, width: int = DEFAULT_WIDTH
) -> str:
    """The whole report: checks by group, what is wrong in detail, the summary."""
    width = max(width, MIN_WIDTH)
    out = [f"{clean(verification.project)}, {clean(verification.target)}: {clean(verification.folder)}"]
    subjects = max((cells(clean(c.subject)) for c in verification.checks()), default=0)
    for group in verification.groups:
        out += ["", *_group(group, min(subjects, _SUBJECT_LIMIT, width // 3), color=color, width=width)]
    text = "\n".join(out) + "\n\n"
    found = problems(verification)
    if found:
        text += diagnostics_text(found, lines, color=color, width=width) + "\n"
    return text + summary(verification, color=color) + "\n"


def _group(group: CheckGroup, subject: int, *, color: bool, width: int) -> list[str]:
    out = [paint(clean(group.title), "bold", color=color)]
    verdict = max((cells(_verdict(check)) for check in group.checks), default=0)
    figures = width - _GAP - subject - _GAP - _GAP - min(verdict, width // 3)
    for check in group.checks:
        out += _check(check, subject, max(figures, _MIN_FIGURES), color=color, width=width)
    return out


def _verdict(check: Check) -> str:
    word, verdict = check.outcome.value, clean(check.verdict)
    if not verdict or verdict.lower() == word:
        return word
    return verdict if verdict.lower().startswith(word) else f"{word}: {verdict}"


def _check(check: Check, subject: int, figures: int, *, color: bool, width: int) -> list[str]:
    """Lines of one check: the verdict ends the last line of figures, or stands alone where it does not fit."""
    margin = " " * (_GAP + subject + _GAP)
    name = clean(check.subject)
    lines = [f"{margin}{line}" for line in wrap(clean(check.text), figures)]
    if cells(name) <= subject:
        lines[0] = f"{' ' * _GAP}{pad(name, subject)}{' ' * _GAP}{lines[0][len(margin) :]}"
    else:
        lines = [f"{' ' * _GAP}{name}", *(line for line in lines if line.strip())]
    verdict = _verdict(check)
    column = len(margin) + figures + _GAP
    style = check.outcome.value
    if column + cells(verdict) <= width and cells(lines[-1]) + _GAP <= column:
        lines[-1] = f"{pad(lines[-1], column)}{paint(verdict, style, color=color)}"
    else:
        pieces = wrap(verdict, width - len(margin))
        lines += [margin + paint(piece, style, color=color) for piece in pieces]
    return [line.rstrip() for line in lines]


def summary(verification: Verification, *, color: bool = False) -> str:
    """``34 checks: 31 ok, 2 errors, 1 not run``."""
    from plcgen.verify.model import Outcome

    checks = list(verification.checks())
    parts: list[str] = []
    for outcome in Outcome:
        count = sum(check.outcome is outcome for check in checks)
        if count:
            plural = "s" if count > 1 and outcome in {Outcome.ERROR, Outcome.WARNING} else ""
            parts.append(paint(f"{count} {outcome.value}{plural}", outcome.value, color=color))
    total = f"{len(checks)} check{'' if len(checks) == 1 else 's'}"
    result = f"{total}: {', '.join(parts)}" if parts else total
    extra = _outside(verification, checks)
    return f"{result}; {extra} outside the checks" if extra else result


def _outside(verification: Verification, checks: Sequence[Check]) -> str:
    from plcgen.report.text import count_text

    own = {check.diagnostic for check in checks}
    rest = [d for d in verification.diagnostics if d not in own and d.severity.label != "note"]
    return count_text(rest) if rest else ""
