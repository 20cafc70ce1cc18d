"""Writing bits: the word is read, and written with these bits alone changed; by hand on the soft CPU."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.live.comparison import compare_drives
from plcgen.ds47.live.connection import Reader
from plcgen.ds47.live.parameters import S7Parameters
from plcgen.ds47.proof.plant import Plant
from plcgen.ds47.proof.scenario import DriveScenario
from plcgen.ds47.sheet import review_sheet
from plcgen.ds47.sim.faults import Fault, FaultKind
from tests.ds47.proof.playing import job_of, sent, status_of

SPEC = """
drives:
  axis:
    device: sinamics-s210
    ID: 270
    parameters:
      P2900: {type: Unsigned16}
      P2901: {type: Unsigned32, array: 3}
      P2902: {type: Integer8}
      P2903: {type: Integer16}
jobs:
  one: {drive: axis, write: {P2900.3: 1}}
  more:
    drive: axis
    write:
      {P2900.3: false, "P2901[2].31": {as: high, start: 1}, P2900.12: true, "P2901[2].0": null, P2902.7: 1, P2903: 7}
    verify: readback
  restored: {drive: axis, write: {P2900.3: 1}, verify: readback, on_error: {restore: running, reason: a test}}
  kept: {drive: axis, write: {P2900.0: null}, verify: readback, save: unit}
"""
OLD = {2900: 0x8A5F, 2901: 0x12345679, 2902: 0x14, 2903: -1}
"""P2900 and P2902 have bit 3 set and bit 7 clear; 0x8A5F is 1000 1010 0101 1111."""


def run(plant: Plant, key: str, *, faults: tuple[Fault, ...] = (), **inputs: bool) -> int:
    """Run a job against a drive that has ``OLD``; its status."""
    plant.begin(DriveScenario(name="OB1", faults=faults))
    parameters = plant.units["axis"].objects[2].parameters
    for pnu, value in OLD.items():
        parameters[pnu].values[-1] = value
    job = job_of(plant, key)
    for name, value in inputs.items():
        plant.cpu[f'"DriveJobs".{job.member}.{name}'] = value
    return status_of(plant, job)


def held(plant: Plant) -> dict[int, object]:
    """What the drive has."""
    parameters = plant.units["axis"].objects[2].parameters
    return {pnu: parameters[pnu].values[-1] for pnu in OLD}


def test_one_bit(plant: Plant) -> None:
    """P2900 = 0B54h of drive object 2 has 8A57h: bit 3 makes 8A5Fh of it, and nothing else is another one."""
    before = 0x8A57
    plant.begin(DriveScenario(name="OB1"))
    word = plant.units["axis"].objects[2].parameters[2900]
    word.values[0] = before
    assert status_of(plant, job_of(plant, "one")) == 0
    assert sent(plant) == ["01 02 01 10 01 0b 54 00 00", "02 02 01 10 01 0b 54 00 00 06 01 8a 5f"]
    assert word.values[0] == 0x8A5F
    assert plant.cpu['"DriveJobs".one.p2900Before'] == before


def test_several_bits_of_several_words(plant: Plant) -> None:
    """Bits of a word are one access; what is no bit is not read in front; all are read back.

    8A5Fh without bit 3 and with bit 12 is 9A57h; 12345679h with bit 31 and without bit 0 is 92345678h; 14h with
    bit 7 is 94h.
    """
    assert run(plant, "more", high=True, p2901Index2Bit0=False) == 0
    ask = "01 02 03 10 01 0b 54 00 00 10 01 0b 55 00 02 10 01 0b 56 00 00"
    addresses = "10 01 0b 54 00 00 10 01 0b 55 00 02 10 01 0b 56 00 00 10 01 0b 57 00 00"
    values = "06 01 9a 57 07 01 92 34 56 78 02 01 94 00 03 01 00 07"
    assert sent(plant) == [ask, f"02 02 04 {addresses} {values}", f"01 02 04 {addresses}"]
    assert held(plant) == {2900: 0x9A57, 2901: 0x92345678, 2902: 0x94 - 0x100, 2903: 7}
    # and the other way round, in the same block: nothing is left of the bits of the run before
    assert run(plant, "more", high=False, p2901Index2Bit0=True) == 0
    assert held(plant) == {2900: 0x9A57, 2901: 0x12345679, 2902: 0x94 - 0x100, 2903: 7}


def test_a_word_that_cannot_be_read_is_not_written(plant: Plant) -> None:
    """The second word is refused: nothing is written."""
    refused = Fault(FaultKind.ERROR, number=0x11, position=2, words=1)
    assert run(plant, "more", faults=(refused,)) == 0x8401
    assert [one[:5] for one in sent(plant)] == ["01 02"]
    assert held(plant) == OLD


def test_old_words_come_back(plant: Plant) -> None:
    """The drive makes something else of the word: with on_error: restore it gets the old one."""
    plant.begin(DriveScenario(name="OB1", keeps={2900: lambda _, value: 0x8A58 if value == 0x8A5F else value}))
    word = plant.units["axis"].objects[2].parameters[2900]
    word.values[0] = 0x8A57
    assert status_of(plant, job_of(plant, "restored")) == 0x8530
    head = "02 02 01 10 01 0b 54 00 00 06 01"
    assert [one for one in sent(plant) if one.startswith("02")] == [f"{head} 8a 5f", f"{head} 8a 57"]
    assert word.values[0] == 0x8A57


def test_saved_bits(plant: Plant) -> None:
    """Read, written, read back, saved: the whole order in one job."""
    assert run(plant, "kept", p2900Bit0=False) == 0
    assert held(plant)[2900] == 0x8A5E
    assert [one[:2] for one in sent(plant)][:4] == ["01", "02", "01", "02"]


def test_what_papers_say(generate) -> None:
    """IMPORT.md and the review name bits, and that the others are kept."""
    made = generate(SPEC, "v5")
    text = (made.folder / "IMPORT.md").read_text("utf-8")
    assert "| P2900.3 |  | bit 3 = 1 | all other bits as they are read in front of the write |" in text
    wanted = "bit 0 = input p2901Index2Bit0, 0 if nothing is connected; bit 31 = input high, 1 if nothing is connected"
    assert f".0, .31 |  | {wanted} | all other bits" in text
    entries = [entry for entry in review_sheet(made.plan).writes if entry.job == "more"]
    assert [(entry.parameter, entry.value, entry.input) for entry in entries] == [
        ("P2900.3, .12", "bit 3 = 0; bit 12 = 1", False),
        ("P2901[2].0, .31", wanted, True),
        ("P2902.7", "bit 7 = 1", False),
        ("P2903", "7", False),
    ]


HEAD = "plc: {name: a, family: s7-1500, toolchain: tia-v19}\ndrives: {axis: {device: sinamics-s210, hardware_id: 270"


def test_dangerous_numbers_need_a_sign_off(tmp_path: Path) -> None:
    """A bit is a write: of a parameter that saves, and of one that is read-only."""
    for word, code in (("P976.0", "PG219"), ("r899.2", "PG207"), ("P9501.0", "PG219")):
        spec = tmp_path / "spec.yaml"
        own = f", parameters: {{{word.partition('.')[0]}: {{type: Unsigned16}}}}" if word[0] == "P" else ""
        spec.write_text(f"{HEAD}{own}}}}}\njobs: {{j: {{drive: axis, write: {{{word}: 1}}}}}}\n", "utf-8")
        assert code in [one.code for one in api.check(spec).diagnostics], word


@pytest.mark.slow
def test_the_files_say_the_start_values_of_inputs(generate) -> None:
    """Inputs of one bit that share a byte of the control DB are told apart: 0 and 1."""
    made = generate(SPEC, "t15")
    result = api.verify(made.folder.parent / "job.yaml", made.folder, faults="none")
    assert [check.verdict for check in result.checks() if check.outcome.value == "error"] == []


class Answers(Reader):
    """A drive with one value for every parameter."""

    def __init__(self, data: bytes) -> None:
        self.data = data

    def read(self, db: int, start: int, size: int) -> bytes:
        """The value."""
        del db, start
        return self.data[:size]


def test_live_compares_bits_alone(generate) -> None:
    """8A5Fh has bit 3: of the job that sets it nothing deviates, 8A57h does not have it."""
    made = generate(SPEC, "t15")
    for data, verdict in (("8a5f0000", "equal"), ("8a570000", "deviates")):
        rows = list(compare_drives(made.plan, {"axis": S7Parameters(Answers(bytes.fromhex(data)))}))
        one = [row for row in rows if row.place == "one"]
        assert [(row.subject, row.wanted, row.verdict) for row in one] == [("axis P2900.3", "1", verdict)]
        inputs = [row.verdict for row in rows if row.subject == "axis P2901[2].31"]
        assert inputs == ["input"]


SMALL = """
drives:
  axis: {device: sinamics-s210, ID: 270, parameters: {P2901: {type: Unsigned32, array: 4}}}
jobs:
  bits: {drive: axis, write: {"P2901[2].31": {as: enable, start: 1}, "P2901[2].3": 1, "P2901[2].0": null}}
"""


@pytest.mark.slow
def test_every_scenario(generate, target: str) -> None:
    """Whatever a drive had, and whatever goes wrong: no other bit is changed; every statement was executed."""
    made = generate(SMALL, target)
    result = api.verify(made.folder.parent / "job.yaml", made.folder, faults="full")
    assert result.ok
    assert [check.verdict for check in result.checks() if check.outcome.value in {"error", "warning"}] == []
