"""What documents are held against is held against the spec: whatever the plan alone has is noticed without running."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
import yaml

from plcgen.ds47.plan import units
from plcgen.ds47.plan.access import Read, Use, Write
from plcgen.ds47.plan.nouns import DrivePlan, PlannedDrive
from plcgen.ds47.plan.uses import UseResolver
from plcgen.project.nouns import Project
from plcgen.project.opening import open_spec
from plcgen.proof.wording import wording_of

SPEC = yaml.safe_load("""
plc: {name: Grounds, family: s7-1500, toolchain: tia-v19, languages: [en-US, de-DE]}
units:
  cu:
    device: sinamics-s120
    drives:
      control: {hardware_id: 280, drive_object: 1}
      reel: {hardware_id: 281, drive_object: 3, comment: the reel, parameters: {P2901: {type: Unsigned16, array: 8, title: Own words}}}
jobs:
  set: {drive: reel, comment: Sets it, write: {P1082: 1200.0, P1121: {comment: {en-US: how slow, de-DE: Bremszeit}}, "P2901[4..5]": [8, 9]}, allow: {P1082: the reel may be fast}}
  get: {drive: reel, read: [r21, "P2901[1..3]"]}
  keep: {drive: control, save: {persist: unit, distance: 10min}}
""")  # noqa: E501 - a spec as people write it


@pytest.fixture
def planned(tmp_path) -> Callable[[], Project]:
    """Plan the spec, with whatever is damaged at that time."""
    path = tmp_path / "spec.yaml"
    path.write_text(yaml.safe_dump(SPEC, sort_keys=False), "utf-8")
    return lambda: open_spec(path).sound()


def said(project: Project) -> list[str]:
    """Where the plan has no ground in the spec."""
    return [one.message for wording in wording_of(project) for one in wording.groundless()]


def test_a_plan_as_it_should_be_says_nothing_else_than_the_spec(planned) -> None:
    """Without damage there is nothing to say."""
    assert not said(planned())


CHANGES: dict[str, tuple[Callable[[Use], Use], str]] = {
    "number": (lambda use: replace(use, parameter=replace(use.parameter, pnu=1120)), "do not say that it writes P1121"),
    "value": (lambda use: replace(use, data=b"\x41\x20\x00\x00"), "P1121 gets 41 20 00 00"),
    "constant": (lambda use: replace(use, role=Write(constant=True)), "P1121 is a constant"),
    "unit": (lambda use: replace(use, parameter=replace(use.parameter, unit="ms")), '"unit: ms"'),
    "title": (
        lambda use: replace(use, parameter=replace(use.parameter, title="Ramp-up time")),
        '"title: Ramp-up time"',
    ),
    "letter": (
        lambda use: replace(use, parameter=replace(use.parameter, access="rw")),
        'r21 documents say "can be written: True"',
    ),
    "comment": (lambda use: replace(use, comment={}), "of P1121 documents say []"),
    "index": (lambda use: replace(use, first=0), '"has an index: True"'),
    "service": (lambda use: replace(use, role=Read()), "documents say that it reads P1121"),
}


@pytest.mark.parametrize("what", CHANGES)
def test_an_access_that_the_spec_does_not_have_is_noticed(what, planned, monkeypatch) -> None:
    """Number, value, unit, title, comment, index, service of P1121 [s], which has an input; the letter of r21."""
    change, message = CHANGES[what]
    resolve = UseResolver.resolve

    def damaged(*args, **settings) -> Use | None:
        use = resolve(*args, **settings)
        return change(use) if use is not None and use.parameter.pnu == (21 if what == "letter" else 1121) else use

    monkeypatch.setattr(UseResolver, "resolve", damaged)
    assert any(message in one for one in said(planned()))


def test_a_write_that_the_plan_leaves_out_is_noticed(planned, monkeypatch) -> None:
    """The list of what is written must not be shorter than the spec."""
    resolve = UseResolver.resolve
    monkeypatch.setattr(
        UseResolver,
        "resolve",
        lambda self, item, *args, **how: None if item.parameter == "P1082" else resolve(self, item, *args, **how),
    )
    assert "set: documents do not say that it writes P1082" in said(planned())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"id_value": 282}, "the identifier 282, the spec says 281"),
        ({"drive_object": 4}, "the drive object 4, the spec says 3"),
        ({"comment": {}}, "the comment [], the spec says ['the reel']"),
    ],
)
def test_another_drive_is_noticed(change, message, planned, monkeypatch) -> None:
    """Identifier, drive object and comment of a drive."""
    monkeypatch.setattr(
        units,
        "PlannedDrive",
        lambda *, key, **given: PlannedDrive(key=key, **{**given, **(change if key == "reel" else {})}),
    )
    assert any(message in one for one in said(planned()))


def test_dangers_and_sign_offs_come_from_the_table_and_the_spec(planned, monkeypatch) -> None:
    """The plan forgets all of them: p1082 is a limit and p977 writes the memory (effects.toml, reasons limits and rom);
    the list of what is written must say so.
    """
    monkeypatch.setattr(DrivePlan, "danger", lambda *_: "")
    monkeypatch.setattr(DrivePlan, "sign_off", lambda *_: "whatever")
    (wording,) = wording_of(planned())
    lines = "\n".join(one.text for one in wording.guide()[1])
    assert "(effect: limits); signed off: the reel may be fast |" in lines
    assert "(effect: rom); signed off: the job says save, once in 600 s at most |" in lines
