"""What a write can do: the table, what it says of numbers that documents name, and that nothing gets around it."""

from __future__ import annotations

import csv
import os
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from plcgen import api
from plcgen.ds47 import effects, guards
from plcgen.ds47.devices import device_names, find_device
from plcgen.ds47.registry import kinds
from tests.evidence.effects import FAMILIES, Row, classify, ranges, read_list, report, rules, table
from tests.yaml_files import read_yaml

HERE = Path(__file__).parent
DOCUMENTS: list[dict[str, Any]] = read_yaml((HERE / "effects.yaml").read_text("utf-8"))
ACME = "title: Acme\nsource: manual\nrecord_index: {profibus: 47, default: profibus}\ndrive_object: {default: 1}\n"


def check(folder: Path, device: str, job: str) -> api.CheckResult:
    """A spec with one job of drive d."""
    path = folder / "job.yaml"
    recipe = (
        "recipes: {few: {parameters: [{parameter: P1113, type: Unsigned32}], records: 2}}\n" if "few" in job else ""
    )
    path.write_text(
        "plc: {name: a, family: s7-300, toolchain: tia-v16}\n"
        f"drives: {{d: {{device: {device}, address: 256}}}}\n"
        f"{recipe if 'few' in job else ''}jobs: {{j: {{drive: d, {job}}}}}\n",
        "utf-8",
    )
    return api.check(path)


def codes(result: api.CheckResult) -> list[str]:
    """What was found, notes left out."""
    return [d.code for d in result.diagnostics if d.severity.label != "note"]


# --- What documents say --------------------------------------------------------------------------------------


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda one: one["document"][:40])
def test_what_documents_name(document: dict[str, Any]) -> None:
    """What a reader of a manual calls dangerous asks; what is daily work costs nothing, not even a warning."""
    device = find_device(document["device"])
    assert [pnu for pnu in document["asks"] if not device.danger(pnu)] == []
    assert [pnu for pnu in document["free"] if device.danger(pnu) or not device.classified(pnu)] == []


def test_what_was_drawn_blind() -> None:
    """Of 260 dangerous writes each asks, of 224 harmless ones none."""
    lines = (HERE / "effects_draw.tsv").read_text("utf-8").splitlines()
    rows = list(csv.DictReader((line for line in lines if line[0] != "#"), delimiter="\t", quoting=csv.QUOTE_NONE))
    assert Counter(row["expected"] for row in rows) == {"ask": 260, "free": 224}
    wrong = []
    for row in rows:
        signal = row["value"].startswith("r")
        value = row["value"] if signal else float(int(row["value"][3:], 16) if "#" in row["value"] else row["value"])
        reason = find_device(row["device"]).danger(int(row["number"]), (value,), row["object"])
        if bool(reason) != (row["expected"] == "ask"):
            wrong.append((row["device"], row["number"], row["value"], reason))
    assert wrong == []


@pytest.mark.parametrize(
    ("device", "pnu", "kind"),
    [
        ("sinamics-s120", 431, "encoder"), ("sinamics-s120", 855, "brake"), ("sinamics-s120", 1113, "direction"),
        ("sinamics-s120", 2589, "moves"), ("sinamics-s210", 5300, "identification"), ("sinamics-v90", 29300, "moves"),
        ("sinamics-dcm", 50086, "moves"), ("sinamics-dcm", 1210, "moves"), ("sinamics-s120", 2040, "protection"),
        ("sinamics-g120", 340, "reset"), ("micromaster-4", 1240, "protection"), ("sinamics-g120", 290, "protection"),
        ("sinamics-g120", 700, "reset"), ("micromaster-4", 1000, "commands"), ("sinamics-g120", 840, "commands"),
        ("sinamics-s120", 1082, "limits"), ("sinamics-s120", 505, "scaling"), ("sinamics-s120", 8921, "network"),
        ("sinamics-g120", 971, "rom"), ("sinamics-s120", 105, "parts"), ("sinamics-s120", 9501, "safety"),
        ("sinamics-s120", 7761, "access"), ("sinamics-dcp", 311, "motor"), ("sinamics-s120", 4641, ""),
        ("sinamics-v90", 2162, "protection"), ("sinamics-g120", 2162, "protection"), ("sinamics-v90", 29108, "motor"),
        ("sinamics-v90", 29241, "moves"), ("sinamics-dcm", 50370, "brake"), ("sinamics-dcm", 50396, "protection"),
        ("sinamics-dcm", 50436, "commands"), ("sinamics-dcm", 50485, "commands"), ("sinamics-dcm", 50513, "limits"),
        ("sinamics-dcm", 50304, ""), ("sinamics-dcm", 50225, ""), ("micromaster-4", 2251, "commands"),
        ("micromaster-4", 2481, "scaling"), ("micromaster-4", 2488, ""),
    ],
)  # fmt: skip
def test_the_class_of_a_number(device: str, pnu: int, kind: str) -> None:
    """The reason ends with its class."""
    assert (f"(effect: {kind}" if kind else "") in find_device(device).danger(pnu)
    assert bool(find_device(device).danger(pnu)) == bool(kind)


# --- Nothing gets around it ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "device",
    [
        "profidrive",
        "./acme.yaml",
        "./like.yaml",
        "sinamics-s210, parameters: {P1113: {type: Unsigned32, title: Ramp-up time}, P29300: {type: Unsigned32}}",
    ],
)
@pytest.mark.parametrize("pnu", [1113, 29300])
def test_no_definition_lifts_it(tmp_path: Path, device: str, pnu: int) -> None:
    """A drive that nobody knows asks for what any family asks for, and so does every profile and definition."""
    own = f"  P{pnu}: {{type: Unsigned32, title: Ramp, harmless: a ramp}}\n"
    (tmp_path / "acme.yaml").write_text(f"{ACME}parameters:\n{own}", "utf-8")
    (tmp_path / "like.yaml").write_text(f"{ACME}like: profidrive\nparameters:\n{own}", "utf-8")
    result = check(tmp_path, device, f"write: [{{parameter: P{pnu}, type: Unsigned32, value: 0}}]")
    (told,) = [d for d in result.diagnostics if d.code == "PG219"]
    if pnu == 29300:
        assert told.message.endswith("(effect: moves, of V90)")
    unknown = "what it does in this drive is not known; in drives of Siemens it "
    assert (unknown in told.message) == ("s210" not in device)


def test_numbers_of_the_profile_mean_the_same_everywhere() -> None:
    """P971 saves and P972 restarts in every drive with the profile; P101 is known of an S120 only."""
    foreign = find_device("profidrive")
    assert not any("not known" in foreign.danger(pnu) for pnu in (971, 972, 976))
    assert "not known" in foreign.danger(101)
    assert "not known" not in find_device("sinamics-s120").danger(101)


FORMS = {
    "write": "write: [{parameter: P1113, type: Unsigned32, value: 0}]",
    "write_recipe": "write_recipe: few",
    "sequence": "sequence: [{write: [{parameter: P1113, type: Unsigned32, value: 0}]}]",
}
"""One job of every kind that writes what the spec says; test_any_drive.py has their variants."""
OWN = {"save", "activate", "acknowledge", "clock"}
"""Kinds that write what they are there for."""


def test_every_kind_of_job_goes_through_one_door(tmp_path: Path) -> None:
    """A kind that writes is refused with a number that asks, or writes its own, which it permits or which are free."""
    writing = {kind.key: kind for kind in kinds() if kind.writes}
    assert set(writing) == {*FORMS, *OWN}
    for job in FORMS.values():
        assert "PG219" in codes(check(tmp_path, "sinamics-g120", job)), job
    permitted = {971, 977, 105}
    fixed = {3981, 3100, 3103, 3101}
    assert [pnu for pnu in fixed if find_device("sinamics-s120").danger(pnu)] == []
    assert all(find_device("sinamics-s120").danger(pnu) for pnu in permitted)


@pytest.mark.parametrize(
    ("write", "asks"),
    [
        ("value: 1", True),
        ("value: 16#00010000", True),
        ("value: 16#0001FC00", True),
        ("value: 0", False),
        ("value: 16#02D20402", False),
        ("value: r722.2@1", False),
        ("start: 0", True),
        ("start: r722.2@1", True),
    ],
)
@pytest.mark.parametrize("pnu", [2810, 20030])
def test_the_value_decides_at_the_input_of_a_free_block(tmp_path: Path, pnu: int, write: str, *, asks: bool) -> None:
    """A constant 1 asks; a signal and 0 do not; an input may become 1."""
    result = check(tmp_path, "sinamics-s120", f"write: [{{parameter: 'P{pnu}[0]', type: Unsigned32, {write}}}]")
    assert ("PG219" in codes(result)) == asks


@pytest.mark.parametrize(
    ("write", "asks"), [("P2161: 0.0", True), ("P2161: 5.0", False), ("P2161: null", True), ("P2155: 0.0", False)]
)
def test_a_threshold_of_0_switches_the_fault_off(tmp_path: Path, write: str, *, asks: bool) -> None:
    """F07822 rests on p2161, of which the list says that 0 deactivates it; on p2155 there is an alarm alone."""
    drive = "sinamics-s120, parameters: {P2161: {type: FloatingPoint}, P2155: {type: FloatingPoint}}"
    assert ("PG219" in codes(check(tmp_path, drive, f"write: {{{write}}}"))) == asks


def test_old_values_that_are_restored_may_be_any(tmp_path: Path) -> None:
    """A job that writes 0 and restores what was there may write 1."""
    write = "write: [{parameter: 'P2810[0]', type: Unsigned32, value: 0}], verify: readback"
    assert "PG219" not in codes(check(tmp_path, "sinamics-s120", write))
    assert "PG219" in codes(check(tmp_path, "sinamics-s120", f"{write}, on_error: {{restore: running, reason: tried}}"))


@pytest.mark.slow
def test_what_nobody_has_classified(tmp_path: Path) -> None:
    """A warning, an error with --strict, a line in IMPORT.md and on the review page; a reason answers it there, too."""
    write = "write: [{parameter: P6100, type: Unsigned16, value: 1}]"
    assert check(tmp_path, "sinamics-v90", write).ok
    assert codes(check(tmp_path, "sinamics-v90", write)) == ["PG261"]
    assert not api.check(tmp_path / "job.yaml", strict=True).ok
    for job, signed in ((write, "no"), (f"{write}, allow: {{P6100: list manual p. 812}}", "list manual p. 812")):
        assert check(tmp_path, "sinamics-v90", job).ok
        assert api.generate(tmp_path / "job.yaml", tmp_path / "out", force=True).ok
        line = f"nobody has classified what a write does; signed off: {signed} |"
        assert line in (tmp_path / "out" / "IMPORT.md").read_text("utf-8")
        review = api.review(tmp_path / "job.yaml", tmp_path / "out")
        (entry,) = review.sheet.writes
        assert (entry.danger, entry.signed or "no") == ("nobody has classified what a write does", signed)
    assert codes(check(tmp_path, "sinamics-v90", f"{write}, allow: {{P6100: list manual p. 812}}")) == []


# --- The table -----------------------------------------------------------------------------------------------


def test_every_row_of_every_shipped_device_has_a_class() -> None:
    """What can be written and is in a catalogue is in the table."""
    missing = [
        (name, one.pnu)
        for name in device_names()
        for one in find_device(name).parameters.values()
        if one.access != "r" and not find_device(name).classified(one.pnu)
    ]
    assert missing == []


def test_safety_and_what_starts_something_ask() -> None:
    """In every family; acknowledging faults does not."""
    for name in device_names():
        device = find_device(name)
        assert all("(effect: safety" in device.danger(pnu) for pnu in guards.SAFETY)
        assert {pnu for pnu in guards.TRIGGERS if not device.danger(pnu)} == {3981}


def test_reasons_are_used_and_speak() -> None:
    """Every reason stands in the table; one that asks says why, and its class is a class."""
    used = {effect.reason.key for _, said in effects.every() for effect in said}
    assert used == set(effects.reasons())
    assert all(bool(one.why) == one.asks for one in effects.reasons().values())
    assert {effect.source for _, said in effects.every() for effect in said} == set(effects.origins())


LISTED = [
    # letter, number, title, type, notes; what it must be, by its meaning
    (("p", 855, "BI: Unconditionally release holding brake", "Unsigned32 / Binary", ""), "brake"),
    (("p", 1113, "BI: Setpoint inversion", "Unsigned32 / Binary", ""), "direction"),
    (("p", 1120, "Ramp-function generator ramp-up time", "FloatingPoint32", ""), "ramps"),
    (("p", 1800, "Pulse frequency", "FloatingPoint32", "D"), "protection"),
    (("c", 2253, "Technology controller setpoint 1", "FloatingPoint32", ""), "commands"),
    (("p", 1243, "Vdc_max controller dynamic factor", "FloatingPoint32", ""), "tuning"),
    (("p", 1254, "Vdc_max controller automatic ON level detection", "Integer16", ""), "protection"),
    (("p", 218, "Braking resistor maximum power duration", "FloatingPoint32", ""), "protection"),
    (("p", 224, "Infeed resistance between filter and power unit", "FloatingPoint32", ""), "motor"),
]


@pytest.mark.parametrize(("row", "kind"), LISTED, ids=lambda one: str(one)[:30])
def test_a_rule_decides_by_meaning(row: tuple[str, int, str, str, str], kind: str) -> None:
    """Numbers, words of the title, signal sinks and notes."""
    letter, number, title, type_, notes = row
    rule = classify(Row("vector", letter, number, title, type_, "VECTOR", notes), rules())
    assert effects.reasons()[rule.reason].kind == kind


@pytest.mark.parametrize(
    ("number", "title", "type_", "notes", "wrong"),
    [
        (4711, "Trace trigger signal", "Unsigned32", "W", "signals"),
        (1430, "Speed precontrol", "Unsigned32 / FloatingPoint32", "", ""),
        (1570, "CI: Flux", "Unsigned32 / FloatingPoint32", "", "no rule"),
        (6100, "What is it", "Unsigned16", "", "no rule"),
    ],
)
def test_what_no_rule_may_say(number: int, title: str, type_: str, notes: str, wrong: str) -> None:
    """A number with a note on danger is not harmless, a signal sink is not tuning, and no number is without a rule."""
    row = Row("vector", "p", number, title, type_, "VECTOR", notes)
    if wrong:
        with pytest.raises(ValueError, match=wrong):
            classify(row, rules())
    else:
        assert effects.reasons()[classify(row, rules()).reason].asks


def test_a_number_of_a_list_with_another_effect_asks_in_its_family(tmp_path: Path) -> None:
    """Of small lists a table is made: it says the same every time, and differs by family where lists do."""
    head = "# list\nletter\tnumber\ttitle\ttype\tobjects\tnotes\n"
    for name in FAMILIES:
        (tmp_path / f"{name}.tsv").write_text(head + "r\t2\tDisplay\tInteger16\t\t\n", "utf-8")
    (tmp_path / "vector.tsv").write_text(
        head + "p\t1800\tPulse frequency\tFloatingPoint32\tVECTOR, DC_CTRL\t\np\t1801\tx\tInteger16\t\t\n", "utf-8"
    )
    with pytest.raises(ValueError, match="no rule for 1801"):
        table(tmp_path)
    (tmp_path / "vector.tsv").write_text(head + "p\t1800\tPulse frequency\tFloatingPoint32\tDC_CTRL\t\n", "utf-8")
    (tmp_path / "a_inf.tsv").write_text(head + "p\t1800\tPulse frequency\tFloatingPoint32\tA_INF\tD\n", "utf-8")
    made = [line for line in table(tmp_path).splitlines() if "\tlists\t" in line]
    assert made == ["tuning\t\tdcm,s120\tread\tlists\t1800", "warned\t\tinfeed\tread\tlists\t1800"]
    assert table(tmp_path) == table(tmp_path)
    assert [row.number for row in read_list(tmp_path / "vector.tsv")] == [1800]
    assert next(report(tmp_path / "nowhere", save=False)).startswith("effects: not here: vector")


def test_the_table_is_what_the_tool_makes_of_the_lists() -> None:
    """The same lists and rules give the same bytes; every range of every rule decides something."""
    folder = os.environ.get("PLCGEN_LISTS", "")
    if not folder:
        pytest.skip("PLCGEN_LISTS names no folder with the lists of parameters, which are no part of plcgen")
    assert table(Path(folder)) == effects.TABLE.read_text("utf-8")
    decided: dict[int, set[int]] = {}
    for row in (row for name in FAMILIES for row in read_list(Path(folder) / f"{name}.tsv")):
        decided.setdefault(classify(row, rules()).line, set()).add(row.number)
    idle = [
        (rule.line, first, last)
        for rule in rules()
        for first, last in rule.ranges
        if not any(first <= number <= last for number in decided.get(rule.line, ()))
    ]
    assert idle == []


def test_the_table_is_small() -> None:
    """Ascending numbers without overlaps in every line, nothing said in two lines, less than 40 kB."""
    lines = effects.TABLE.read_text("utf-8").splitlines()[3:]
    assert len({tuple(line.split("\t")[:5]) for line in lines}) == len(lines)
    for line in lines:
        flat = [number for pair in ranges(line.split("\t")[5]) for number in sorted(set(pair))]
        assert flat == sorted(set(flat))
    assert effects.TABLE.stat().st_size < 40_000
