"""Single faults in generated PPI masters of every target: verify runs into them.

Only what is executed counts: neither hashes nor the second copy of the code in the SimaticML documents gives them away.
``PLCGEN_FAULTS=150`` tries so many of all targets together; ``make test`` a few.
"""

from __future__ import annotations

import itertools
import os
import re
import shutil
from pathlib import Path

import pytest

from plcgen.base.diagnostics import DiagnosticError
from plcgen.ppi.plan.nouns import PpiPlan
from plcgen.proof.checks import Outcome
from plcgen.proof.execution import Work
from plcgen.proof.folder import read_folder
from plcgen.proof.rig import ProgramBench
from tests.mutation.run import executed
from tests.proof.ppi_faults import Fault, faults
from tests.proof.test_ppi import made, project_of

BODY = """
    stations: {p: {address: 2, cpu: "224"}, q: {address: 3}}
    jobs:
      all: {station: p, read: [VD104, M0.0, C5, VB100], merge: false, cycle: 1s}
      write: {station: p, write: {VW200: null, VB210: null}, timeout: 8s}
      long: {station: q, read: ["VB0[230]"], timeout: 9s}
      go: {station: q, run: true, timeout: 7s}
"""
COUNT = int(os.environ.get("PLCGEN_FAULTS", "8"))
TARGETS = ("t12", "t15", "t3", "v5")
HARMLESS: dict[str, str] = {
    r"(EVENT|CALL|PHASE)_\w+ : .*": "nobody outside sees the number, and it is still another one than those beside it",
    r"#tempCount := .*#tempPosition \+ 1 \+ 1\]\)\);": "LEr instead of LE: the next line wants both to be equal",
    r"FOR #tempIndex := 0 \+ 1 TO #tempLength - 1 DO": "only differences of sums count, from the second byte on",
    r"statStation : .* := 2;.*": "the index of a station that exists, until the first job names one",
}
"""Faults that nothing can notice, and why, by the line that they make."""


def noticed(fault: Fault, spec: Path, folder: Path) -> str | None:
    """What a run says of a fault, empty if nothing; None if it is none, because it does not compile."""
    copy = folder / "copy"
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(spec.parent / "out", copy)
    fault.put(copy)
    project = project_of(spec)
    bench = ProgramBench(project, copy)
    try:
        program = bench.program
    except DiagnosticError:
        return None
    proof = project.plan(PpiPlan).protocol.proof(project.plan(PpiPlan))
    checks = itertools.chain(proof.telegrams(read_folder(copy, project.target)), proof.stated(program))
    wrong = next((check.verdict for check in checks if check.outcome is Outcome.ERROR), "")
    return wrong or executed(Work(bench, "quick"), "m").text


@pytest.mark.parametrize("target", TARGETS)
def test_single_faults_are_noticed(target: str, tmp_path: Path) -> None:
    """All that are tried, but those of which is said why nothing can notice them."""
    spec = made(target, tmp_path, BODY)
    wanted = -(-COUNT // len(TARGETS))
    tried, missed = 0, []
    for fault in faults(tmp_path / "out", sum(target.encode()), 3 * wanted):
        said = noticed(fault, spec, tmp_path)
        if said is None:
            continue
        tried += 1
        if not said and not any(re.fullmatch(line, fault.new.strip()) for line in HARMLESS):
            missed.append(f"{fault.kind}: {fault.file}:{fault.line}: {fault.old.strip()} -> {fault.new.strip()}")
        if tried == wanted:
            break
    assert tried == wanted
    assert missed == []
