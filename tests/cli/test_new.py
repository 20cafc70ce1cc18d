"""``plcgen new``: every kind of job, the form of the FAQ, PPI; what it writes passes every check, or it is refused."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from plcgen.workbench.starter import KINDS

DEVICES = ("sinamics-s120", "sinamics-g120", "sinamics-dcm", "micromaster-4")


@pytest.mark.parametrize("job", KINDS)
def test_every_kind_of_job_begins_well(job: str, plcgen: Callable[..., Any]) -> None:
    """On an S120 all of them; on others a spec without an error, or a reason."""
    for device in DEVICES:
        made = plcgen("new", f"{device}.yaml", "--device", device, "--job", job)
        assert made.code in ({0} if device == "sinamics-s120" else {0, 2}), made.err
        if made.code == 0:
            assert "error[" not in plcgen("check", f"{device}.yaml").err
        else:
            assert "cannot have such a job" in made.err


@pytest.mark.parametrize("family", ["s7-300", "s7-400", "s7-1200", "s7-1500"])
def test_ppi(family: str, plcgen: Callable[..., Any]) -> None:
    """A master for each family that has one."""
    assert plcgen("new", "line.yaml", "--ppi", "--family", family).code == 0
    assert plcgen("check", "line.yaml").code == (1 if family == "s7-400" else 0)


def test_the_form_of_the_faq(plcgen: Callable[..., Any]) -> None:
    """Data blocks for the telegrams, and its names of members."""
    assert plcgen("new", "dcm.yaml", "--faq", "--device", "sinamics-dcm", "--family", "s7-300").code == 0
    assert plcgen("check", "dcm.yaml").code == 0
    assert "Request_Ref" in plcgen("layout", "dcm.yaml").out
