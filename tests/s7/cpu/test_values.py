"""Statements and expressions against values worked out by hand."""

import pytest

from tests.s7.cpu.support import cases, run

CASES = cases("values") + cases("memory")


@pytest.mark.parametrize("case", CASES, ids=[case["name"] for case in CASES])
def test_values(case):
    """After the calls, memory holds what the case says, and nothing else was wrong."""
    cpu = run(case)
    expected = case.get("expect", {})
    assert expected == {path: cpu[f'"Test_DB".{path}'] for path in expected}
    elsewhere = case.get("elsewhere", {})
    assert elsewhere == {path: cpu[path] for path in elsewhere}
    assert case.get("misuses", []) == [misuse.code for misuse in cpu.misuses]
