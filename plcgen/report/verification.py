"""Verification as text: one line per check, three aligned columns: subject, figures, verdict."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from plcgen.base.diagnostics.counting import quantity
from plcgen.base.display.cells import clean, pad, wrap
from plcgen.base.display.cells import width as cells
from plcgen.base.display.excerpts import count_text, diagnostics_text
from plcgen.base.display.view import View

if TYPE_CHECKING:
    from plcgen.proof.checks import Check, CheckGroup, Verification
    from plcgen.proof.ledger import Assumption

_GAP = 2
_INDENT = 6
_NAMED = 3
"""Checks that were not run, in the last line."""
_SHORT = 10
"""Lines of the ledger unless all of it is asked for."""


def verification_text(verification: Verification, view: View) -> str:
    """The whole report: checks by group, what is wrong in detail, the summary."""
    what = ", ".join(clean(text) for text in (verification.project, verification.target) if text)
    out = [f"{what or clean(verification.spec)}: {clean(verification.folder)}"]
    told = verification.told
    follow = len(verification.problems) - len(told)
    if follow:
        text = f"{out[0]}\n\n{diagnostics_text(told, view)}\n"
        text += f"{quantity(follow, 'problem')} more may only follow from that: --format json lists all\n"
        return text + _summary(verification, view) + "\n"
    for group in verification.groups:
        out += ["", *_group(group, view)]
    out += _ledger(verification, view)
    text = "\n".join(out) + "\n\n"
    found = verification.problems
    if found:
        text += diagnostics_text(found, view) + "\n"
    return text + _summary(verification, view) + "\n"


def verifications_text(found: Sequence[Verification], view: View) -> str:
    """The reports of several specs, one after the other, and how many of them are good."""
    good = sum(each.ok for each in found)
    count = view.paint(
        f"{good} of {len(found)} specs verified without an error", "ok" if good == len(found) else "error"
    )
    return "\n".join(verification_text(each, view) for each in found) + f"\n{count}\n"


def _group(group: CheckGroup, view: View) -> list[str]:
    """Lines of a group: one line a check, or subject and verdict above the figures if these are long."""
    out = [view.paint(clean(group.title), "bold")]
    subject = max((cells(clean(check.subject)) for check in group.checks), default=0)
    figures = max((cells(clean(check.text)) for check in group.checks), default=0)
    verdict = max((cells(_verdict(check)) for check in group.checks), default=0)
    fits = 3 * _GAP + subject + figures + verdict <= view.columns
    for check in group.checks:
        if fits:
            left = f"{pad(clean(check.subject), subject)}{' ' * _GAP}{pad(clean(check.text), figures)}"
            out += _row(left if figures else left[: -_GAP or None], check, view)
        else:
            out += _row(pad(clean(check.subject), subject), check, view)
            lines = wrap(clean(check.text), view.columns - _INDENT)
            out += [f"{' ' * _INDENT}{line}" for line in lines if line]
    return out


def _ledger(verification: Verification, view: View) -> list[str]:
    """What the result rests on, the worst known first: all of it with its sources, or the shortest that is honest.

    In short, what nobody looked up has a line each, and the rest a line for each source; ten lines at most.
    """
    from plcgen.proof.ledger import Grade

    if not verification.ledger:
        return []
    worst = [one for grade in reversed(Grade) for one in verification.ledger if one.grade is grade]
    column = max(cells(one.value) for one in Grade)
    out = ["", view.paint("Rests on", "bold")]
    if view.ledger:
        for one in worst:
            out.append(f"{' ' * _GAP}{pad(one.grade.value, column)}{' ' * _GAP}{clean(f'{one.subject}: {one.text}')}")
            out += [f"{' ' * _INDENT}{line}" for line in wrap(clean(one.source), view.columns - _INDENT)]
        return out
    rows: dict[tuple[str, str], list[Assumption]] = {}
    for one in worst:
        own = f"{one.subject}: {one.text}" if one.grade is Grade.GENERAL else one.source
        rows.setdefault((one.grade.value, own), []).append(one)
    room = view.columns - 2 * _GAP - column
    for (grade, text), meant in list(rows.items())[: _SHORT - (len(rows) > _SHORT)]:
        shown = text if grade == Grade.GENERAL else f"{quantity(len(meant), 'assumption')}: {text}"
        out.append(f"{' ' * _GAP}{pad(grade, column)}{' ' * _GAP}{_cut(clean(shown), room)}")
    left = sum(len(meant) for meant in list(rows.values())[_SHORT - 1 :])
    if len(rows) > _SHORT:
        out.append(f"{' ' * _GAP}and {quantity(left, 'assumption')} more: --ledger lists all, with their sources")
    return out


def _cut(text: str, room: int) -> str:
    """A text in one line."""
    if cells(text) <= room:
        return text
    return f"{wrap(text, room - 3)[0]} .."


def _verdict(check: Check) -> str:
    word, verdict = check.outcome.value, clean(check.verdict)
    if not verdict or verdict.lower() == word:
        return word
    return verdict if verdict.lower().startswith(word) else f"{word}: {verdict}"


def _row(left: str, check: Check, view: View) -> list[str]:
    """What was looked at and the verdict behind it, or below it where it does not fit."""
    verdict, style = _verdict(check), check.outcome.value
    room = view.columns - 2 * _GAP - cells(left)
    head = f"{' ' * _GAP}{left}"
    if cells(verdict) <= room:
        return [f"{head}{' ' * _GAP}{view.paint(verdict, style)}"]
    if room > view.columns // 3:
        first, *more = wrap(verdict, room)
        margin = " " * (cells(head) + _GAP)
        return [
            f"{head}{' ' * _GAP}{view.paint(first, style)}",
            *(f"{margin}{view.paint(line, style)}" for line in more),
        ]
    below = wrap(verdict, view.columns - _INDENT)
    return [head.rstrip(), *(f"{' ' * _INDENT}{view.paint(line, style)}" for line in below)]


def _summary(verification: Verification, view: View) -> str:
    """``34 checks: 31 ok, 2 errors, 1 not run (Wireshark)``."""
    from plcgen.proof.checks import Outcome

    checks = list(verification.checks())
    parts: list[str] = []
    for outcome in Outcome:
        count = sum(check.outcome is outcome for check in checks)
        if count:
            plural = "s" if count > 1 and outcome in {Outcome.ERROR, Outcome.WARNING} else ""
            parts.append(view.paint(f"{count} {outcome.value}{plural}", outcome.value))
    total = quantity(len(checks), "check")
    result = f"{total}: {', '.join(parts)}" if parts else total
    left = [clean(check.subject) for check in checks if check.outcome is Outcome.NOT_RUN]
    result += f" ({', '.join(left[:_NAMED])}{', ..' if left[_NAMED:] else ''})" if left else ""
    extra = [diagnostic for diagnostic in verification.outside if diagnostic.severity.label != "note"]
    return f"{result}; {count_text(extra)} outside the checks" if extra else result


def troubles(verification: Verification) -> Verification:
    """The same result with nothing but the checks that found something: no ledger of what was proved."""
    from plcgen.proof.checks import Outcome

    groups = []
    for group in verification.groups:
        checks = tuple(c for c in group.checks if c.outcome in {Outcome.ERROR, Outcome.WARNING})
        if checks:
            groups.append(replace(group, checks=checks))
    return replace(verification, groups=tuple(groups), ledger=())
