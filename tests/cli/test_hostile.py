"""What somebody with bad intent, or bad luck, hands to the command line."""

from __future__ import annotations

import os
import sys

import pytest

SPEC = """\
plc: {name: a, family: s7-300, toolchain: tia-v16}
drives: {d: {device: sinamics-dcm, address: 256}}
jobs: {j: {drive: d, read: [P50303]}}
"""
posix = pytest.mark.skipif(sys.platform == "win32", reason="there are no such files")


@posix
@pytest.mark.parametrize("end", ["scl", "xml", "sdf", "yaml", "csv"])
@pytest.mark.parametrize("what", ["fifo", "zero"])
@pytest.mark.parametrize("verb", ["check", "layout", "verify", "diff", "audit", "lock", "ppi decode --file"])
def test_every_verb_refuses_what_has_no_end(plcgen, tmp_path, verb, what, end):
    """A FIFO that nobody writes and /dev/zero: a message, at once."""
    path = tmp_path / f"x.{end}"
    os.mkfifo(path) if what == "fifo" else path.symlink_to("/dev/zero")
    args = [*verb.split(), path.name, *([path.name] if verb == "diff" else [])]
    result = plcgen(*args)
    assert result.code != 0
    assert "bug in plcgen" not in result.err


@posix
def test_a_folder_with_a_manifest_that_has_no_end(plcgen, tmp_path):
    """Verify and generate read the manifest of the output folder."""
    (tmp_path / "job.yaml").write_text(SPEC)
    (tmp_path / "job_generated").mkdir()
    os.mkfifo(tmp_path / "job_generated/manifest.json")
    for verb in ("verify", "generate", "check"):
        assert "bug in plcgen" not in plcgen(verb, "job.yaml").err
