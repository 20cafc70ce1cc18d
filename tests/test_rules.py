"""What the rules promise beyond single examples: all names of the block are guarded, notes, time."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.diagnostics import Diagnostic, Report
from plcgen.base.resources import templates_dir
from plcgen.project.loading import parse_spec
from plcgen.project.nouns import Project
from plcgen.project.resolve import resolve
from plcgen.project.rules import apply_rules
from tests.projects import ROOT
from tests.work import calls_of

PLC = "plc: {name: a, family: s7-300, toolchain: tia-v16}\n"
DRIVE = "drives: {d: {device: sinamics-dcm, address: 256}}\n"
_DECLARED = re.compile(r"^\s*([A-Za-z]\w*)(?: \{InstructionName[^}]*\})?(?: AT \w+)?\s*:(?!=)", re.MULTILINE)


def _block_names() -> list[str]:
    """Every name that the templates of a job declare."""
    folder = templates_dir() / "ds47"
    kinds = sorted((ROOT / "plcgen" / "ds47" / "kinds").glob("*/*.scl.j2"))
    frame = [folder / f"{name}.scl.j2" for name in ("telegrams", "elapsed")]
    texts = [path.read_text("utf-8") for path in (*frame, *kinds)]
    text = "\n".join([(folder / "job.scl.j2").read_text("utf-8").split("BEGIN")[0], *texts])
    declared = _DECLARED.findall("\n".join(line.split("//")[0] for line in text.splitlines()))
    blocks = "".join(path.read_text("utf-8") for path in (ROOT / "plcgen" / "ds47" / "kinds").glob("*/block.py"))
    names = {*declared, *re.findall(r'\("([A-Z]+_[A-Z]+)", ', blocks)} - {"AUTHOR", "FAMILY", "NAME", "VERSION"}
    return sorted(name for name in names if not name.startswith("ACKNOWLEDGE_"))  # beside values that have fixed names


def _check(jobs: str, tmp_path: Path, head: str = PLC + DRIVE) -> tuple[Diagnostic, ...]:
    path = tmp_path / "spec.yaml"
    path.write_text(head + jobs, encoding="utf-8")
    return api.check(path).diagnostics


def test_the_template_was_understood() -> None:
    """The list of names below is not empty by accident."""
    names = _block_names()
    assert {
        "execute",
        "diagnosis",
        "driveObject",
        "unit",
        "statOrder",
        "tempIndex",
        "statSaving",
        "SAVE_LIMIT",
    } <= set(names)
    assert len(names) > 60


@pytest.mark.parametrize("name", _block_names())
def test_a_value_cannot_take_a_name_of_the_block(name: str, tmp_path: Path) -> None:
    """Each name the job template declares is refused for a value."""
    found = _check(f"jobs: {{j: {{drive: d, read: [{{parameter: P50303, as: {name}}}]}}}}\n", tmp_path)
    assert [d.code for d in found] == ["PG406"]


def test_several_mistakes_are_all_reported_in_reading_order(tmp_path: Path) -> None:
    """One run shows everything: order is that of the text."""
    jobs = (
        "jobs:\n"
        "  j: {drive: d, write: {P2000: 1.0}, reference: 0}\n"
        "  k: {drive: d, read: [P50303], timeout: 1ms, trigger: M9000.0}\n"
    )
    found = _check(jobs, tmp_path)
    assert [(d.code, d.span.line) for d in found] == [
        ("PG219", 4),
        ("PG228", 4),
        ("PG305", 4),
        ("PG306", 5),
        ("PG404", 5),
    ]


def test_every_later_use_of_a_number_points_to_the_first(tmp_path: Path) -> None:
    """Three blocks of one number are two findings, both with the first use."""
    jobs = (
        "jobs:\n"
        "  j: {drive: d, read: [P50303], request: {db: 9}}\n"
        "  k: {drive: d, read: [P50303], request: {db: 9}}\n"
        "  l: {drive: d, read: [P50303], response: {db: 9}}\n"
    )
    found = [d for d in _check(jobs, tmp_path) if d.code == "PG401"]
    assert [d.span.line for d in found] == [5, 6]
    assert [d.notes[0].span.line for d in found] == [4, 4]


def test_a_wide_flag_meets_every_bit_inside_it(tmp_path: Path) -> None:
    """A word that covers two bits overlaps both, also when another flag lies between them."""
    jobs = (
        "jobs:\n"
        "  j: {drive: d, read: [P50303], trigger: {status: MW10}}\n"
        "  k: {drive: d, read: [P50303], trigger: {execute: M10.1, done: M11.7, error: M12.0}}\n"
    )
    found = [d for d in _check(jobs, tmp_path) if d.code == "PG403"]
    assert [d.message.split(" ")[0] for d in found] == ["M10.1", "M11.7"]


def test_one_bad_key_is_reported_once(tmp_path: Path) -> None:
    """Blocks, members and files made from a bad key do not repeat the finding."""
    found = _check('jobs: {"a.b": {drive: d, read: [P50303]}}\n', tmp_path)
    assert [d.code for d in found] == ["PG405"]


def test_a_name_is_checked_for_the_tool(tmp_path: Path) -> None:
    """TIA Portal takes a member of 25 characters, STEP 7 V5 24."""
    jobs = "jobs: {j: {drive: d, read: [{parameter: P50303, as: abcdefghijklmnopqrstuvwxy}]}}\n"
    assert _check(jobs, tmp_path) == ()
    found = _check(jobs, tmp_path, PLC.replace("tia-v16", "step7-v5") + DRIVE)
    assert [d.code for d in found] == ["PG405"]


@pytest.mark.parametrize("toolchain", ["tia-v16", "step7-v5"])
def test_the_names_made_from_the_catalogue_fit(toolchain: str, tmp_path: Path) -> None:
    """Every parameter of the DCM catalogue can be read without naming anything."""
    numbers = ["P50284", "P50285", "P50286", "P50287", "P50288", "P50296", "P50297", "P50298", "P50300", "P50301"]
    jobs = f"jobs: {{read_many_parameters_of_the_drive: {{drive: d, trigger: M1.0, read: [{', '.join(numbers)}]}}}}\n"
    found = _check(jobs, tmp_path, PLC.replace("tia-v16", toolchain) + DRIVE)
    assert {d.code for d in found} <= {"PG228"}


@pytest.mark.slow
def test_rules_are_linear() -> None:
    """Four times the jobs, full of findings, take four times the work: 4,000 of them seconds, not minutes."""
    works = []
    for count in (100, 400):
        project = _project_of_findings(count)
        report = Report()
        _, work = calls_of(lambda planned=project, found=report: apply_rules(planned, found))
        assert len(list(report)) > 3 * count
        works.append(work)
    assert works[1] < 5 * works[0]


def _project_of_findings(count: int) -> Project:
    lines = [
        f"  job_{i}: {{drive: d, write: {{P50303: 1.0, P50304: 2.0}}, trigger: {{execute: M{i}.0, status: MW{2 * i}}},"
        f" request: {{db: {i + 1}, size: 2}}, response: {{members: {{nothing: x}}}}, reference: 0}}"
        for i in range(count)
    ]
    report = Report()
    loaded = parse_spec(PLC + DRIVE + "jobs:\n" + "\n".join(lines) + "\n", "big.yaml", report)
    assert loaded is not None
    return resolve(loaded, report)
