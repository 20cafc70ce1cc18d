"""The table of CPU types: expected values from the documents that it names."""

from __future__ import annotations

from itertools import permutations

import pytest
import yaml

from plcgen.base.resources import specs_dir
from plcgen.project.cpus import cpu, cpu_names, find_cpu
from plcgen.project.target import target

KB = 1024


@pytest.mark.parametrize(
    ("name", "jobs", "together", "newer"),
    [
        ("312", 4, True, None),  # 312 to 316: 4 in total
        ("315-2DP", 4, True, None),
        ("317-2PN/DP", 8, True, None),  # 317 to 319: 8 in total
        ("412-1", 8, False, None),  # 41x: 8 of each
        ("1214C", 4, True, None),  # 121x: 4 for RDREC and WRREC
        ("1516", 10, False, 20),  # 151x: 10 of each up to V1.8, 20 from V2.0 on
    ],
)
def test_record_jobs(name: str, jobs: int, together: bool, newer: int | None) -> None:
    """How many jobs of WRREC and RDREC run at once: Siemens entry 15364459."""
    found = cpu(name).record_jobs
    assert (found.jobs, found.together, found.newer) == (jobs, together, newer)
    assert "15364459" in found.source


def test_work_memory() -> None:
    """S7-300: one memory (hardware catalogue of STEP 7 V5); S7-400 and S7-1500: one for code, one for data."""
    assert cpu("312").work.value == 32 * KB
    assert cpu("315-2DP").work.value == 256 * KB
    assert cpu("315-2DP").work.grade == "r"
    assert cpu("412-1").work is None
    assert cpu("412-1").work_code.value == 144 * KB
    assert cpu("1510SP").work_data.value == 750 * KB  # data sheet 6ES7510-1DJ01-0AB0


@pytest.mark.parametrize("spelling", ["315-2DP", "315-2 DP", "CPU 315-2 DP", "cpu315-2dp", "CPU315-2DP"])
def test_a_name_is_found_in_any_common_spelling(spelling: str) -> None:
    """Names as the catalogue, the module and people write them."""
    assert cpu(spelling).name == "315-2DP"


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("1516-3 PN/DP", "1516"),
        ("CPU 1516F-3 PN/DP", "1516"),
        ("6ES7516-3AN02-0AB0", "1516"),
        ("6ES7 516-3FN01-0AB0", "1516"),
        ("CPU 1512SP F-1 PN", "1512SP"),
        ("6ES7510-1DJ01-0AB0", "1510SP"),  # its data sheet
        ("CPU 1214C AC/DC/Rly", "1214C"),
        ("1214FC DC/DC/DC", "1214C"),
        ("1513R-1 PN", "1513R"),
        ("CPU 1517H-3 PN", "1517H"),
        ("CPU 414-5H PN/DP", "414-5H"),
        ("CPU 1504D TF", "1504D TF"),
    ],
)
def test_names_of_siemens_and_order_numbers(written: str, name: str) -> None:
    """What stands on the module, in the catalogue and in the device view of the TIA Portal."""
    assert cpu(written).name == name


def test_every_order_number_of_the_table_is_found() -> None:
    """Those of the facts lead to the row in which they stand, and no beginning of one belongs to two rows."""
    data = yaml.safe_load((specs_dir() / "cpus" / "s7.yaml").read_text("utf-8"))["cpus"]
    numbers = {row["order_number"]: name for name, row in data.items() if "order_number" in row}
    assert len(numbers) == 12
    assert {number: cpu(number).name for number in numbers} == numbers
    stems = [stem for row in data.values() for stem in row["orders"]]
    assert not [pair for pair in permutations(stems, 2) if pair[0].startswith(pair[1])]
    names = [own for name, row in data.items() for own in (name, *row.get("named", ()))]
    assert len({name.upper() for name in names}) == len(names)


def test_redundant_systems_are_known() -> None:
    """One CPU of a pair: S7-400H, S7-1500R and H."""
    assert {name for name in cpu_names() if cpu(name).redundant} == {
        "410-5H", "412-5H", "414-5H", "416-5H", "417-5H", "1513R", "1515R", "1517H", "1518HF",
    }  # fmt: skip


def test_an_unknown_name_is_none() -> None:
    """Nothing is guessed."""
    assert find_cpu("315") is None
    with pytest.raises(KeyError):
        cpu("315")


def test_every_fact_has_a_grade_and_a_source() -> None:
    """Facts that nobody could look up are k and name no document; the others name one."""
    data = yaml.safe_load((specs_dir() / "cpus" / "s7.yaml").read_text("utf-8"))
    facts = [
        fact
        for row in (*data["groups"].values(), *data["cpus"].values())
        for key, fact in row.items()
        if key not in {"group", "order_number", "firmware", "named", "orders", "redundant"}
    ]
    assert len(facts) > 100
    for _, grade, source in facts:
        assert grade in {"r", "s", "k"}
        assert source in data["sources"]
        assert (grade == "k") == (source == "MEM")


def test_names_by_family() -> None:
    """Every CPU type belongs to one of the four families."""
    families = [cpu_names(family) for family in ("s7-300", "s7-400", "s7-1200", "s7-1500")]
    assert sum(map(len, families)) == len(cpu_names()) == 47


@pytest.mark.parametrize("name", cpu_names())
def test_numbers_of_the_family_are_numbers_of_the_cpu(name: str) -> None:
    """PG402 checks numbers against the family: no CPU of the table has fewer."""
    found = cpu(name)
    highest = target(found.family, "tia-v16").max_numbers
    for kind in ("FB", "DB"):
        assert highest[kind] <= found.numbers[kind].value
        assert found.numbers[kind].low <= 1
