"""What all tests have in common: nothing depends on how busy the machine is (work.py counts calls instead)."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

settings.register_profile("plcgen", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("plcgen")

PROOF = Path(__file__).parent / "proof"


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Whatever runs fault matrices is slow."""
    for item in items:
        if PROOF in item.path.parents:
            item.add_marker(pytest.mark.slow)
