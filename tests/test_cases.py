"""Every code a spec can trigger, by example: ``tests/cases/PGxxx.yaml``, one file a code.

In a spec of a case, « » mark the span where the diagnostic must stand and ‹ › the span of its note; the marks
are taken out before the spec is read. ``files`` are further files beside it; ``at`` gives a span as
line:column-line:column where marks cannot stand.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from plcgen import api
from plcgen.base.diagnostics import Diagnostic, Span
from tests.yaml_files import read_yaml

CASES = Path(__file__).parent / "cases"
FILES = sorted(CASES.glob("PG[1-4]??.yaml"))
_MARKS = "«»‹›"


def _cases(kind: str) -> list[Any]:
    return [
        pytest.param(path.stem, case, id=f"{path.stem}: {case['name']}")
        for path in FILES
        for case in read_yaml(path.read_text("utf-8")).get(kind, [])
    ]


def _unmarked(text: str) -> tuple[str, dict[str, tuple[int, int]]]:
    """The text without marks, and line and column of each mark."""
    found: dict[str, tuple[int, int]] = {}
    plain: list[str] = []
    line = column = 1
    for char in text:
        if char in _MARKS:
            found[char] = (line, column)
            continue
        plain.append(char)
        line, column = (line + 1, 1) if char == "\n" else (line, column + 1)
    return "".join(plain), found


def _generated(parameters: int = 1, split: str = "auto", jobs: int = 1, cpu: str = "") -> str:
    """A job that reads ``parameters`` fault codes, or that many different jobs for a CPU."""
    if jobs > 1:  # at most 64 on one drive
        drives = range(-(-jobs // 64))
        shape = f"parameters: {{P2900: {{type: FloatingPoint, array: {jobs}}}}}"
        axes = "".join(f"  d{n}: {{device: sinamics-dcm, address: {256 + 4 * n}, {shape}}}\n" for n in drives)
        rows = "".join(f'  j{n}: {{drive: d{n // 64}, read: ["P2900[{n}]"]}}\n' for n in range(jobs))
        head = f'plc: {{name: a, family: s7-300, toolchain: tia-v16, cpu: "{cpu}"}}\n'
        return f"{head}drives:\n{axes}jobs:\n{rows}"
    items = ", ".join(f'"R945[{index}]"' for index in range(parameters))
    return (
        "plc: {name: a, family: s7-300, toolchain: tia-v16}\n"
        "drives: {d: {device: sinamics-g120, address: 256}}\n"
        f"jobs: {{j: {{drive: d, split: {split},\n"
        f"  read: [{items}]}}}}\n"
    )


def _place(span: Span) -> str:
    return f"{span.line}:{span.column}-{span.end_line}:{span.end_column}"


def _between(marks: dict[str, tuple[int, int]], pair: str) -> str:
    return "-".join(f"{line}:{column}" for line, column in (marks[pair[0]], marks[pair[1]]))


def _check(case: dict[str, Any], folder: Path) -> tuple[tuple[Diagnostic, ...], dict[str, tuple[int, int]]]:
    path = folder / "spec.yaml"
    marks: dict[str, tuple[int, int]] = {}
    for name, text in case.get("files", {}).items():
        (folder / name).write_text(text, encoding="utf-8")
    if "bytes" in case:
        path.write_bytes(bytes.fromhex(case["bytes"]))
    elif "generate" in case:
        path.write_text(_generated(**case["generate"]), encoding="utf-8")
    elif not case.get("missing"):
        text, marks = _unmarked(case["spec"])
        path.write_text(text, encoding="utf-8", newline="")
    return api.check(path).diagnostics, marks


@pytest.mark.parametrize(("code", "case"), _cases("fail"))
def test_a_bad_spec_is_reported_at_its_place(code: str, case: dict[str, Any], tmp_path: Path) -> None:
    """Code, severity, span, message and help are those of the case; nothing else is an error."""
    diagnostics, marks = _check(case, tmp_path)
    found = [d for d in diagnostics if d.code == code]
    assert found, [f"{d.span} {d.code} {d.message}" for d in diagnostics]
    place = case.get("at") or _between(marks, "«»")
    hits = [d for d in found if _place(d.span) == place]
    assert hits, (place, [(_place(d.span), d.message) for d in found])
    diagnostic = next((d for d in hits if case["message"] in d.message), None)
    assert diagnostic is not None, [d.message for d in hits]
    assert case.get("severity", "error") == diagnostic.severity.label
    assert case.get("help", "") in diagnostic.help
    if "‹" in marks:
        assert _between(marks, "‹›") in [_place(note.span) for note in diagnostic.notes]
    others = [f"{d.span} {d.code} {d.message}" for d in diagnostics if d.code != code and d.severity.label == "error"]
    assert others == [], "one mistake is one finding"


@pytest.mark.parametrize(("code", "case"), _cases("pass"))
def test_a_good_spec_is_not_reported(code: str, case: dict[str, Any], tmp_path: Path) -> None:
    """The code does not appear; except for the reading of bytes, neither does any other problem but PG228.

    That one is about the catalogue, not about the spec.
    """
    diagnostics, _ = _check(case, tmp_path)
    shown = [f"{d.span} {d.code} {d.message}" for d in diagnostics if d.severity.label != "note" and d.code != "PG228"]
    assert code not in [d.code for d in diagnostics], shown
    if "bytes" not in case:
        assert shown == []


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_a_case_file_has_both_sides(path: Path) -> None:
    """A rule without an example that passes could report everything."""
    data = read_yaml(path.read_text("utf-8"))
    assert data["fail"]
    assert data["pass"]
    assert set(data) == {"fail", "pass"}
