"""What documents of masters are held against is held against the spec: what the plan alone has is noticed."""

from __future__ import annotations

from dataclasses import replace

import pytest

from plcgen.ppi.plan.nouns import PpiPlan
from plcgen.ppi.proof.wording import groundless
from plcgen.project.opening import open_spec
from tests.projects import ROOT

SPEC = ROOT / "specs/s7-1200_s7-200_ppi.yaml"


@pytest.fixture(scope="module")
def plan() -> PpiPlan:
    """One master, ``pumps``, with a station and jobs; ``setpoints`` writes to symbols, ``overview`` has a cycle."""
    (found,) = open_spec(SPEC).sound().plans
    assert isinstance(found, PpiPlan)
    return found


def test_the_plan_of_the_example_says_nothing_else_than_the_spec(plan) -> None:
    """Without damage there is nothing to say."""
    assert not list(groundless(plan))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"baud": 19200}, '"bit/s: 19200"'),
        ({"module": "cb1241"}, '"module: cb1241"'),
        ({"own_address": 5}, '"own address: 5"'),
        ({"port": 999}, "identifier or address: 999"),
        ({"jobs": ()}, "job overview: no document has it"),
    ],
)
def test_another_master_is_noticed(change, message, plan) -> None:
    """Settings of the port, and a job that is missing."""
    (master,) = plan.masters
    found = [one.message for one in groundless(replace(plan, masters=(replace(master, **change),)))]
    assert any(message in one for one in found), found


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"kind": "read"}, "service"),
        ({"cycle": 70}, '"cycle: 70"'),
        ({"values": ()}, '"addresses: 0"'),
        ({"comment": {}}, "comment"),
    ],
)
def test_another_job_is_noticed(change, message, plan) -> None:
    """Service, cycle, addresses and comment of the job that writes setpoints."""
    assert message in damaged(plan, change)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"label": "levels (VD108)"}, "called: levels"),
        ({"count": 2}, '"elements: 2"'),
        ({"constant": True}, "a constant: True"),
        ({"data": b"\x41\x20\x00\x00"}, "value: 41 20 00 00"),
        ({"comment": {"en-US": "another"}}, "another"),
    ],
)
def test_another_address_is_noticed(change, message, plan) -> None:
    """Name, elements, constant, value and comment of the first setpoint."""
    job = next(job for job in plan.jobs if job.key == "setpoints")
    assert message in damaged(plan, {"values": (replace(job.values[0], **change), *job.values[1:])})


def damaged(plan: PpiPlan, change: dict[str, object]) -> str:
    """What is said if the job ``setpoints`` is another one."""
    (master,) = plan.masters
    jobs = tuple(replace(job, **change) if job.key == "setpoints" else job for job in master.jobs)
    return "\n".join(one.message for one in groundless(replace(plan, masters=(replace(master, jobs=jobs),))))
