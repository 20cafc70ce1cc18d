"""Files from outside with mistakes: every verb tells them with line and column, exits with 1 and shows no traceback."""

from __future__ import annotations

import pytest

FAQ = """\
plc: {name: a, family: s7-300, toolchain: tia-v16}
drives: {d: {device: ./acme.yaml, address: 256}}
jobs: {j: {drive: d, read: [P1]}}
"""
ACME = """\
title: Acme
source: Acme manual
record_index: {profibus: 47, default: profibus}
drive_object: {default: 1}
parameters: {P1: {type: Unsigned16}}
"""
SOURCE = 'DATA_BLOCK "B"\nSTRUCT\n  a : Int;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'


@pytest.mark.parametrize("verb", ["check", "generate", "verify", "layout", "encode", "simulate"])
def test_a_profile(plcgen, tmp_path, verb):
    """``maximum`` instead of ``max`` is no missing limit, whatever is done with the spec."""
    (tmp_path / "acme.yaml").write_text(ACME.replace("Unsigned16", "Unsigned16, maximum: 5"))
    (tmp_path / "job.yaml").write_text(FAQ)
    result = plcgen(verb, "job.yaml")
    assert result.code == 1
    assert 'error[PG104]: unknown key "maximum" in parameters.P1' in result.err + result.out
    assert "acme.yaml:5:37" in result.err + result.out
    assert "bug in plcgen" not in result.err


@pytest.mark.parametrize(
    ("text", "place", "args"),
    [
        ("behaviour: {error_words: 3}\nobjects: [{number: 1}]\n", "x.yaml:1:26", ["verify", "job.yaml", "--drive"]),
        ("behaviour: {error_words: 3}\nobjects: [{number: 1}]\n", "x.yaml:1:26", ["simulate", "job.yaml", "--drive"]),
        ("- {kind: busy, tims: 1}\n", "x.yaml:1:16", ["simulate", "job.yaml", "--faults"]),
        ("cpu: 225\n", "x.yaml:1:6", ["ppi", "serve", "--values"]),
        ("code-changed: severe\n", "x.yaml:1:15", ["diff", "a.db", "a.db", "--policy"]),
        ("format: 2\nblocks: 5\n", "x.yaml:2:9", ["lock", "--check", "--out"]),
    ],
)
def test_the_other_files(plcgen, tmp_path, text, place, args):
    """Drive, fault, station, policy and lock files."""
    (tmp_path / "acme.yaml").write_text(ACME)
    (tmp_path / "job.yaml").write_text(FAQ)
    (tmp_path / "a.db").write_text(SOURCE)
    (tmp_path / "x.yaml").write_text(text)
    plcgen("generate", "job.yaml")
    result = plcgen(*args, "x.yaml")
    assert result.code == 1
    assert place in result.err + result.out
    assert "bug in plcgen" not in result.err
