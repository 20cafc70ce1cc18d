"""What a help says works when it is followed to the letter: each case of ``tests/cases`` whose help names an edit."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from plcgen import api
from tests.test_cases import FILES, _unmarked
from tests.yaml_files import read_yaml

_DEFINITION = re.compile(r"in the drive: (parameters: \{\w+: \{.*\}\})")
_VALUE = re.compile(r"\Awrite (r[0-9.]+): the letter")
_MARKED = re.compile("«[^»]*»")
_TYPES = ("FloatingPoint", "Unsigned16", "Unsigned32", "OctetString[4]")
"""What the user may have looked up where a help leaves the type open."""


def _specs() -> list[Any]:
    cases = [(path.stem, case) for path in FILES for case in read_yaml(path.read_text("utf-8"))["fail"]]
    return [
        pytest.param(code, case["spec"], id=f"{code}: {case['name']}")
        for code, case in cases
        if "spec" in case and "files" not in case and "parameters:" not in case["spec"]
        if code in {"PG204", "PG206", "PG209", "PG211", "PG228"}
    ]


def _edits(spec: str, help_: str) -> list[str]:
    """The spec after each edit that a help names; none if it names none that a program could make."""
    definition, value = _DEFINITION.search(help_), _VALUE.match(help_)
    if definition is not None:
        kinds = _TYPES if "type: .." in definition[1] else ("",)
        texts = [definition[1].replace("..", kind) for kind in kinds]
        return [_unmarked(re.sub(r"(device: [\w-]+)", rf"\1, {text}", spec))[0] for text in texts]
    return [] if value is None else [_MARKED.sub(value[1], spec)]


def _found(spec: str, folder: Path) -> dict[str, str]:
    path = folder / "spec.yaml"
    path.write_text(spec, encoding="utf-8")
    return {one.code: one.help for one in api.check(path).diagnostics if one.severity.label != "note"}


@pytest.mark.parametrize(("code", "spec"), _specs())
def test_the_edit_that_a_help_names_removes_its_message(code: str, spec: str, tmp_path: Path) -> None:
    """The definition for the drive, or the value, is taken as it stands in the help; then the message is gone."""
    help_ = _found(_unmarked(spec)[0], tmp_path)[code]
    edited = _edits(spec, help_)
    if not edited:
        assert "in the drive: parameters" not in help_
        return
    left = [_found(one, tmp_path) for one in edited]
    assert any(code not in found for found in left), left


def test_what_can_only_be_read_is_one_message(tmp_path: Path) -> None:
    """Who cannot write a number at all need not sign its write off."""
    spec = (
        "plc: {name: a, family: s7-1500, toolchain: tia-v19}\n"
        "drives: {d: {device: sinamics-g120, hardware_id: 270}}\n"
        "jobs: {j: {drive: d, write: {r21: 5}}}\n"
    )
    assert list(_found(spec, tmp_path)) == ["PG207"]
