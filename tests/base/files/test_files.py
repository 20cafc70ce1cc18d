"""Files that have no end, or are none."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen.base.files.files import read_bounded


def test_a_file_is_read_as_far_as_its_bound(tmp_path: Path) -> None:
    """One byte more than the bound says that the file is too large."""
    (tmp_path / "x").write_bytes(b"123456")
    assert read_bounded(tmp_path / "x", 6) == b"123456"
    assert read_bounded(tmp_path / "x", 3) == b"1234"


@pytest.mark.parametrize("name", [".", "missing", "a\0b"])
def test_what_is_no_file_is_an_error_of_the_system(name: str, tmp_path: Path) -> None:
    """A folder, a missing file and a name that none can have."""
    with pytest.raises(OSError, match=r"directory|No such file|null"):
        read_bounded(tmp_path / name, 3)
