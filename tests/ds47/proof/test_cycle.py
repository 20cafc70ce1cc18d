"""Jobs with a cycle on the wire: when they ask, who goes first, how old their values are; scan by scan, by hand."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.proof.plant import Plant
from tests.ds47.proof.playing import noticed

SPEC = """
units: {cu: {device: sinamics-s120, drives: {a: {ID: 281, drive_object: 3}, b: {ID: 284, drive_object: 4}}}}
jobs:
  watch: {drive: [a, b], read: [r21], cycle: 1s}
  set_ramps: {drive: a, write: {P1120: 5.0}}
"""
READ_A, READ_B = "01 03 01 10 01 00 15 00 00", "01 04 01 10 01 00 15 00 00"
"""r0021 = 0015h of drive objects 3 and 4."""
WRITE = "02 03 01 10 01 04 60 00 00 08 01 40 a0 00 00"
"""p1120 = 0460h as FloatingPoint, 5.0 = 40A00000h."""
SCAN = 10
VALID_MS = 3000


@pytest.fixture
def journal(plant: Plant) -> Iterator[list[tuple[int, str]]]:
    """Requests that the unit has taken, with the time of the CPU."""
    found: list[tuple[int, str]] = []
    unit = plant.units["cu"]
    take = unit.write_record

    def write_record(index: int, data: bytes) -> int:
        found.append((plant.cpu.clock, data[1:].hex(" ")))
        return take(index, data)

    unit.write_record = write_record  # type: ignore[method-assign]
    yield found
    assert not plant.cpu.misuses


def scans(plant: Plant, milliseconds: int) -> None:
    """OB1, again and again."""
    for _ in range(milliseconds // SCAN):
        plant.cpu.scan(SCAN)


def of(journal: list[tuple[int, str]], request: str) -> list[int]:
    """When a request was sent."""
    return [at for at, data in journal if data == request]


def shown(plant: Plant, name: str, drive: str = "A") -> object:
    """A member of the structure of one instance."""
    return plant.cpu[f'"DriveJobs".watch{drive}.{name}']


def test_every_instance_asks_every_second_without_being_told(plant: Plant, journal: list[tuple[int, str]]) -> None:
    """In 5.5 s both ask six times, the first time at once; from start to start pass 1000 ms and one or two scans."""
    assert shown(plant, "execute") is True
    scans(plant, 5500)
    for request in (READ_A, READ_B):
        times = of(journal, request)
        assert len(times) == 6
        assert {later - earlier for earlier, later in pairwise(times)} <= {1010, 1020}
    assert len(journal) == 12


def test_age_and_valid_say_how_old_the_values_are(plant: Plant, journal: list[tuple[int, str]]) -> None:
    """24 days before the first answer; at most a cycle and a run later; not valid after three cycles without one."""
    unit = plant.units["cu"]
    plant.cpu.scan(SCAN)
    assert (shown(plant, "age"), shown(plant, "valid")) == (24 * 86_400_000, False)
    unit.objects[3].parameters[21].values[:] = [1234.5]
    scans(plant, 500)
    assert (shown(plant, "actualSpeed"), shown(plant, "valid")) == (1234.5, True)
    for _ in range(400):
        plant.cpu.scan(SCAN)
        assert 0 < int(str(shown(plant, "age"))) < 1300
    begun = max(of(journal, READ_A))
    unit.objects[3].parameters[21].values[:] = [0.0]
    there = dict(plant.cpu.bus.drives)
    plant.cpu.bus.drives.clear()
    while shown(plant, "valid"):
        plant.cpu.scan(SCAN)
    assert VALID_MS - 100 < plant.cpu.clock - begun < VALID_MS + 100
    assert shown(plant, "actualSpeed") == 1234.5
    plant.cpu.bus.drives.update(there)
    scans(plant, 2500)
    assert (shown(plant, "actualSpeed"), shown(plant, "valid")) == (0.0, True)


def test_a_command_goes_first(plant: Plant, journal: list[tuple[int, str]]) -> None:
    """Both reads have started in the first scan, at 10 ms, and are due at 1010 ms; a write starts at 1000 ms."""
    scans(plant, 990)
    before = len(journal)
    plant.cpu['"DriveJobs".setRamps.execute'] = True
    scans(plant, 700)
    assert [data for _, data in journal[before:]] == [WRITE, READ_A, READ_B]


def test_without_execute_nothing_is_asked(plant: Plant, journal: list[tuple[int, str]]) -> None:
    """FALSE stops it behind the run that goes on, TRUE starts it at once."""
    scans(plant, 1500)
    plant.cpu['"DriveJobs".watchA.execute'] = False
    scans(plant, 300)
    asked = len(of(journal, READ_A))
    scans(plant, 5000)
    assert len(of(journal, READ_A)) == asked
    assert (shown(plant, "valid"), shown(plant, "status")) == (False, 0x7000)
    plant.cpu['"DriveJobs".watchA.execute'] = True
    now = plant.cpu.clock
    scans(plant, 500)
    assert of(journal, READ_A)[-1] - now <= 200


DAMAGE = {
    "another cycle": ("CYCLE : DInt := L#1000", "CYCLE : DInt := L#1200"),
    "others do not go first": ("THEN #tempFree := FALSE; END_IF;", "THEN #tempFree := TRUE; END_IF;"),
    "who only asks does not go first": ("THEN #tempFree := FALSE; END_IF;", "THEN ; END_IF;"),
    "it waits for whoever has given up": ("want <> #unit.ended[#tempIndex] THEN #temp", "want > 0 THEN #temp"),
    "it lets others go first for ever": ("IF #tempFree OR #statSince >= #CYCLE_WAITS THEN", "IF #tempFree THEN"),
    "values are valid for longer": ("VALID_LIMIT : DInt := L#3000", "VALID_LIMIT : DInt := L#3500"),
    "the age of a run that failed": ("IF #tempRan AND #done THEN", "IF #tempRan AND NOT #busy THEN"),
    "the age counts from the end": ("#statAge := #statSince;", "#statAge := L#0;"),
    "values are valid at start": ("statAge : DInt := L#2073600000", "statAge : DInt"),
    "no job starts": ("execute : Bool := TRUE;", "execute : Bool;"),
}


@pytest.mark.slow
@pytest.mark.parametrize("damage", DAMAGE)
def test_damage_is_noticed(damage: str, tmp_path: Path) -> None:
    """One change of a source, and verify is red for another reason than that the file was changed."""
    found = noticed(
        tmp_path,
        """plc: {name: Plant, family: s7-1500, toolchain: tia-v19}
drives: {a: {device: sinamics-g120, hardware_id: 270}}
jobs: {watch: {drive: a, read: [r21], cycle: 1s}}
""",
        *DAMAGE[damage],
    )
    assert {one.code for one in found} & {"PG614", "PG621", "PG641"}


PUMP = """
plc: {name: P, family: s7-1200, toolchain: tia-v18}
drives: {pump: {device: sinamics-g120, hardware_id: 270}}
jobs: {watch: {drive: pump, read: [r21], cycle: 1s}}
"""


@pytest.mark.slow
@pytest.mark.parametrize("times", ["1h", "2min, timeout: 1500ms", "200ms, timeout: 900ms"])
def test_long_cycles_and_short_timeouts(times: str, tmp_path: Path) -> None:
    """In an hour the clock of a block on the S7-1200/1500 starts over; long calls of the proof use no timeout up."""
    spec = tmp_path / "s.yaml"
    spec.write_text(PUMP.replace("1s", times), "utf-8")
    assert api.generate(spec, tmp_path / "out").ok
    assert not api.verify(spec, tmp_path / "out").problems


@pytest.mark.parametrize(
    ("cycle", "bound"), [("50ms", "greater than or equal to 100 ms"), ("30h", "less than or equal to 3600000 ms")]
)
def test_bounds_of_a_time_have_its_unit(cycle: str, bound: str, tmp_path: Path) -> None:
    """They are in ms, whatever unit the spec has."""
    spec = tmp_path / "s.yaml"
    spec.write_text(PUMP.replace("1s", cycle), "utf-8")
    (found,) = api.check(spec).diagnostics
    assert (found.code, found.message) == ("PG107", f'"cycle": must be {bound}, not "{cycle}"')
