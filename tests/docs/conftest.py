"""What the tests of pages and of CI files share."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.docs.forks import forking


@pytest.fixture(scope="session")
def forks(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A folder with a ``plcgen`` that need not be started for each call."""
    folder = tmp_path_factory.mktemp("forks")
    with forking(folder):
        yield folder
