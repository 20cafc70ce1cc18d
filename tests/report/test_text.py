"""Diagnostics and verifications as text: every expected screen is written by hand."""

import importlib.util
from pathlib import Path

import pytest

from plcgen.base.diagnostics import Diagnostic, Severity, Span
from plcgen.base.display import cells
from plcgen.base.display.cells import clean, cut, expand, width, window, wrap
from plcgen.base.display.excerpts import diagnostic_text, diagnostics_text, summary_text
from plcgen.base.display.view import PLAIN, View
from plcgen.proof.checks import Check, CheckGroup, Outcome
from plcgen.report.verification import verification_text

_spec = importlib.util.spec_from_file_location("results", Path(__file__).with_name("results.py"))
results = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(results)


def test_excerpt_help_and_note():
    """An error shows place, source line, caret, help and the other place."""
    assert diagnostic_text(results.LIMIT, View(lines=results.line)) == (
        "error[PG209]: P50303 = 700 is outside its limits 0..650 s\n"
        " --> specs/x.yaml:3:9\n"
        "  |\n"
        "3 |   ramp: 700.0\n"
        "  |         ^^^^^\n"
        "  = help: the drive would answer error 02h\n"
        "  = note: first use\n"
        " --> specs/x.yaml:1:1\n"
        "  |\n"
        "1 | plc:\n"
        "  | ---\n"
    )


def test_tab_and_wide_characters_keep_the_caret_in_place():
    """A tab is four columns to the next stop, a Chinese character two."""
    span = Span("x", 2, 11, 2, 12)
    text = diagnostic_text(Diagnostic("PG101", "m", span), View(lines=results.line))
    assert text == "error[PG101]: m\n --> x:2:11\n  |\n2 |     name: 加工站 x\n  |                 ^\n"


@pytest.mark.parametrize(
    ("span", "caret"),
    [
        (Span("x", 1, 1, 3, 2), "  | ^^^^\n"),
        (Span("x", 1, 5, 1, 5), "  |     ^\n"),
        (Span("x", 1, 90, 1, 95), "  |     ^\n"),
        (Span("x", 1, 0, 0, 0), "  | ^^^^\n"),
    ],
    ids=["several lines: first line to its end", "empty", "behind the end", "no columns"],
)
def test_unusual_spans(span, caret):
    """Spans over lines, without width or behind the end still give one caret line."""
    assert diagnostic_text(Diagnostic("PG101", "m", span), View(lines=results.line)).endswith(f"1 | plc:\n{caret}")


def test_without_source_only_the_place():
    """A file as a whole, or one that cannot be read, has no excerpt."""
    assert diagnostic_text(results.WARNING, PLAIN) == ("warning[PG310]: a timeout of 1 ms\n --> specs/x.yaml\n")


def test_long_line_is_cut_to_a_window_around_the_caret():
    """The caret stays below what it marks, both ends are marked as cut, the width is kept."""
    source = "a" * 300 + "BAD" + "z" * 300
    text = diagnostic_text(Diagnostic("PG101", "m", Span("x", 1, 301, 1, 304)), View(lines=lambda *_: source, width=60))
    line, caret = text.split("\n")[3:5]
    assert len(line) <= 60
    assert line.startswith("1 | ...aaa")
    assert line.endswith("zzz...")
    assert line[caret.index("^") : caret.rindex("^") + 1] == "BAD"


def test_of_a_line_of_megabytes_only_the_part_around_the_place_is_looked_at(monkeypatch):
    """An export in one line of 50 MB kept the terminal busy for a minute; what is shown is the same."""
    looked_at = []
    category = cells.unicodedata.category
    monkeypatch.setattr(cells.unicodedata, "category", lambda c: looked_at.append(c) or category(c))
    shown = []
    for head in (20_000, 2_000_000):
        line = "x" * head + "é WRONG é" + "y" * head
        error = Diagnostic("PG812", "no", Span("a.xml", 1, head + 3, end_column=head + 8))
        text = diagnostic_text(error, View(lines=lambda _file, _line, line=line: line))
        shown.append(text.splitlines()[2:])
    assert shown[0] == shown[1]
    assert "WRONG" in shown[0][1]
    assert shown[0][1].index("WRONG") == shown[0][2].index("^^^^^")
    assert len(looked_at) < 100_000


def test_terminal_escapes_in_files_and_messages_are_harmless():
    """A file cannot move the cursor, colour the screen or turn the reading direction."""
    hostile = "a\x1b[31mb\u202ec\x07"
    text = diagnostic_text(Diagnostic("PG101", hostile, Span("x", 1, 1, 1, 2)), View(lines=lambda *_: hostile))
    assert "\x1b" not in text
    assert "\u202e" not in text
    assert "\x07" not in text
    assert "a\ufffd[31mb\ufffdc\ufffd" in text


def test_colours_only_when_asked():
    """The flag adds codes around the same text."""
    plain, coloured = (diagnostic_text(results.LIMIT, View(c, lines=results.line)) for c in (False, True))
    assert "\x1b[1;31merror[PG209]\x1b[0m" in coloured
    import re

    assert re.sub(r"\x1b\[[0-9;]*m", "", coloured) == plain


def test_help_is_wrapped_below_itself():
    """Long help keeps the screen's width."""
    text = diagnostic_text(Diagnostic("PG101", "m", Span("x"), help="word " * 20), View(width=50))
    lines = text.splitlines()
    assert all(len(line) <= 50 for line in lines)
    assert lines[2].startswith("  = help: word")
    assert lines[3].startswith("          word")


def test_summary():
    """Errors and warnings are counted, notes are no problems."""
    note = Diagnostic("PG101", "m", Span("x"), Severity.NOTE)
    found = [results.LIMIT, results.LIMIT, results.WARNING, note]
    assert summary_text(found, "specs/x.yaml") == "2 errors, 1 warning in specs/x.yaml"
    assert summary_text([note], "specs/x.yaml") == "no problems in specs/x.yaml"
    assert diagnostics_text([], PLAIN) == ""


def test_verification_in_columns():
    """Subject, figures and verdict are aligned; the failing check is shown with its diagnostic below."""
    assert verification_text(results.VERIFICATION, View(width=80)) == (
        "Demo, s7-300 / tia-v16: out\n"
        "\n"
        "Layout\n"
        '  DB3 "WR"    10 B ref@0  ok: 3 sources agree\n'
        '  DB6 "RD_1"  4 B         error: 6 bytes too small\n'
        "\n"
        "Execution\n"
        "  run  not run: no soft CPU\n"
        "\n"
        "error[PG209]: P50303 = 700 is outside its limits 0..650 s\n"
        " --> specs/x.yaml:3:9\n"
        "  = help: the drive would answer error 02h\n"
        "  = note: first use\n"
        " --> specs/x.yaml:1:1\n"
        "\n"
        "3 checks: 1 ok, 1 error, 1 not run (run)\n"
    )


def test_a_diagnostic_that_only_a_check_carries_is_shown():
    """What a check found is explained even if the verification does not list it again."""
    import dataclasses

    alone = dataclasses.replace(results.VERIFICATION, diagnostics=())
    assert verification_text(alone, PLAIN) == verification_text(results.VERIFICATION, PLAIN)


def test_the_ledger_has_ten_lines_unless_all_is_asked_for():
    """What nobody looked up comes first, one line each; of the rest a line for each source says how many rest on it."""
    import dataclasses

    from plcgen.proof.ledger import Assumption, Grade

    ledger = (
        *(Assumption("axis", f"max {n}", f"list, page {n}", Grade.MANUAL) for n in range(9)),
        *(Assumption("axis", f"type {n}", "the same list", Grade.SECOND) for n in range(5)),
        *(Assumption("axis", f"min {n}", "from memory", Grade.GENERAL) for n in range(3)),
    )
    verification = dataclasses.replace(results.VERIFICATION, ledger=ledger, diagnostics=())
    short = verification_text(verification, PLAIN).partition("\nRests on\n")[2].partition("\n\n")[0].splitlines()
    assert short == [
        "  general knowledge  axis: min 0",
        "  general knowledge  axis: min 1",
        "  general knowledge  axis: min 2",
        "  second source      5 assumptions: the same list",
        *(f"  manual             1 assumption: list, page {n}" for n in range(5)),
        "  and 4 assumptions more: --ledger lists all, with their sources",
    ]
    whole = verification_text(verification, View(ledger=True)).partition("\nRests on\n")[2]
    assert [whole.count(text) for text in ("from memory", "the same list", "list, page 8")] == [3, 5, 1]


def test_verification_of_an_unusable_spec():
    """Without a project the spec's name stands in the first line; the errors are counted."""
    from plcgen.proof.checks import Verification

    empty = Verification("x.yaml", "out", "", "", (), (results.LIMIT,))
    text = verification_text(empty, PLAIN)
    assert text.startswith("x.yaml: out\n\nerror[PG209]")
    assert text.endswith("\n0 checks; 1 error outside the checks\n")


def test_verification_with_long_figures_stacks_them():
    """On a narrow screen the verdict stays beside its subject and the figures go below."""
    text = verification_text(results.VERIFICATION, View(width=44))
    assert (
        "Layout\n"
        '  DB3 "WR"    ok: 3 sources agree\n'
        "      10 B ref@0\n"
        '  DB6 "RD_1"  error: 6 bytes too small\n'
        "      4 B\n"
    ) in text
    assert all(width(line) <= 44 for line in text.splitlines() if "PG209" not in line)


def test_cells():
    """Columns, not characters, are what alignment counts."""
    assert [width(t) for t in ("abc", "加工站", "e\u0301", "")] == [3, 6, 1, 0]
    assert cut("加工站abc", 7) == "加工..."
    assert wrap("aa bb cc", 5) == ["aa bb", "cc"]
    assert wrap("", 5) == [""]
    assert wrap("abcdefgh ij", 4) == ["abcdefgh", "ij"]
    assert clean("a\r\nb\tc\x00") == "a  b c\ufffd"
    assert expand("\ta", 1, 2) == ("    a", 4, 5)
    assert window("abcdefghij", 0, 1, 20) == ("abcdefghij", 0, 1)


def test_files_of_another_state_of_the_spec_are_told_alone():
    """What fails because of that is counted only; if nothing fails, all checks are shown, the warning among them."""
    import dataclasses

    place = Span("out")
    stale = Diagnostic("PG504", "made from another state", place, Severity.WARNING, help="run plcgen generate")
    check = Check("files.manifest", "files", "38 files", Outcome.WARNING, stale.message, stale)
    groups = (CheckGroup("files", "Files", (check,)), *results.VERIFICATION.groups)
    text = verification_text(dataclasses.replace(results.VERIFICATION, groups=groups), PLAIN)
    assert text == (
        "Demo, s7-300 / tia-v16: out\n"
        "\n"
        "warning[PG504]: made from another state\n"
        " --> out\n"
        "  = help: run plcgen generate\n"
        "\n"
        "1 problem more may only follow from that: --format json lists all\n"
        "4 checks: 1 ok, 1 error, 1 warning, 1 not run (run)\n"
    )
    good = dataclasses.replace(results.VERIFICATION, groups=groups[:1], diagnostics=())
    assert "38 files" in verification_text(good, PLAIN)
