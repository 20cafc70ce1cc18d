"""Modules of version 0.1 under their old names."""

from __future__ import annotations

import subprocess
import sys

import pytest

from plcgen._moved import MOVED
from tests.projects import ROOT


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("plcgen.cpu.testing", "plcgen.s7.cpu.testing"),
        ("plcgen.protocols.ds47.wire.codec", "plcgen.ds47.wire.codec"),
        ("plcgen.signoff.revision", "plcgen.report.review.revision"),
    ],
)
def test_an_old_name_is_the_same_module(old: str, new: str) -> None:
    """Whichever is imported first, classes exist once; a warning says the new name."""
    for first, second in ((old, new), (new, old)):
        code = f"import sys, {first}, {second}; assert sys.modules['{old}'] is sys.modules['{new}']"
        done = subprocess.run(
            [sys.executable, "-W", "always", "-c", code], capture_output=True, text=True, cwd=ROOT, check=False
        )
        assert done.returncode == 0, done.stderr
        assert f"{new.rpartition('.')[0]} now" in done.stderr


def test_no_old_name_is_in_use() -> None:
    """A file that lies where an old name points would be hidden by it."""
    for old, new in MOVED.items():
        assert not (ROOT / old.replace(".", "/")).exists(), old
        place = ROOT / new.replace(".", "/")
        assert place.is_dir() or place.with_suffix(".py").is_file(), new
