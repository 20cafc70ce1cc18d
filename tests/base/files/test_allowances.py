"""A comment accepts a warning for a reason; it hides no error, and does not stay behind unnoticed."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.diagnostics import Diagnostic, Severity, Span
from plcgen.project.allowances import allowances, settled

SPEC = """\
plc: {name: a, family: s7-300, toolchain: tia-v16}
drives: {d: {device: sinamics-dcm, address: 256}}
jobs:
  j: {drive: d, read: [P952]}   # plcgen: allow PG228 looked up
  # plcgen: allow PG227 always connected
  w: {drive: d, write: {P50303: {start: 5.0}}}
"""


def test_where_a_comment_counts() -> None:
    """On its line, or for the next line that is more than a comment; in the comments of SCL, too; not inside a text."""
    first, second = "a # plcgen: allow PG228 why\n\n", "# plcgen: allow PG228: why\n\n// x\nb\n"
    text = f"{first}{second}x // plcgen: allow PG805 - why\n#plcgen:allow PG1"
    found = [(each.code, each.reason, each.span.line, each.span.column, each.line) for each in allowances(text, "f")]
    assert found == [("PG228", "why", 1, 3, 1), ("PG228", "why", 3, 1, 6), ("PG805", "why", 7, 3, 7)]
    assert allowances('t: "x# plcgen: allow PG228 why"', "f") == ()


@pytest.mark.parametrize(
    ("severity", "expected"),
    [(Severity.ERROR, [Severity.ERROR]), (Severity.WARNING, [Severity.NOTE]), (Severity.NOTE, [])],
)
def test_what_becomes_of_it(severity: Severity, expected: list[Severity]) -> None:
    """An error stays one, a warning becomes a note with the reason and where it stands, a note goes."""
    allowed = allowances("x # plcgen: allow PG228 why\n", "f")
    found = list(settled([Diagnostic("PG228", "m", Span("f", 1, 1), severity)], allowed))
    assert [each.severity for each in found] == expected
    if severity is Severity.WARNING:
        assert [(note.message, note.span.column) for note in found[0].notes] == [("allowed: why", 3)]
    other = Diagnostic("PG228", "m", Span("f", 2, 1), Severity.WARNING)
    assert list(settled([other], allowed)) == [other]


def test_a_source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """What check reports of a PLC source is allowed in its comments."""
    from plcgen.cli.main import run

    monkeypatch.chdir(tmp_path)
    block = 'DATA_BLOCK "B"\nSTRUCT\n  a : Word;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'
    Path("a.db").write_text(block, "utf-8")
    Path("b.db").write_text(block, "utf-8")
    assert run(["check", "a.db", "b.db"]) == 0
    assert "warning[PG805]" in capsys.readouterr().out
    Path("b.db").write_text(f"// plcgen: allow PG805 the old version, for comparison\n{block}", "utf-8")
    assert run(["check", "a.db", "b.db"]) == 0
    found = capsys.readouterr().out
    assert "note[PG805]" in found
    assert "allowed: the old version, for comparison" in found


def test_a_spec(tmp_path: Path) -> None:
    """Also where warnings are errors, and in what generate and verify report; without the comments both are back."""
    path = tmp_path / "job.yaml"
    path.write_text(SPEC, "utf-8")
    for found in (api.check(path), api.check(path, strict=True)):
        assert [(each.code, each.severity.label) for each in found.diagnostics] == [("PG228", "note")]
    made = api.generate(path)
    assert {each.severity for each in made.diagnostics} == {Severity.NOTE}
    verified = api.verify(path, faults="none", strict=True)
    assert verified.ok
    path.write_text("".join(line.partition("#")[0].rstrip() + "\n" for line in SPEC.splitlines()), "utf-8")
    assert [(each.code, each.severity.label) for each in api.check(path).diagnostics] == [
        ("PG228", "warning"),
        ("PG227", "note"),
    ]


@pytest.mark.parametrize("reason", ["", ".", "- .", "!!!", "x", "\u200b"])
def test_what_is_no_reason(reason: str, tmp_path: Path) -> None:
    """A mark or a letter allows nothing: the warning stays, and the comment is told."""
    path = tmp_path / "job.yaml"
    line = next(line for line in SPEC.splitlines() if "plcgen: allow" in line)
    said = line[line.index("PG228") + 5 :]
    path.write_text(SPEC.replace(f"PG228{said}", f"PG228 {reason}"), "utf-8")
    found = [(each.code, each.severity.label) for each in api.check(path).diagnostics]
    assert ("PG228", "warning") in found or any(severity == "error" for _, severity in found)
    assert not [each for each in found if each == ("PG228", "note")]
    assert ("PG111", "warning") in found or any(severity == "error" for _, severity in found)
