"""The catalogue: what its grades decide, how it is shown and counted, and that what it says is what its page says."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
import yaml
from click.testing import CliRunner

from plcgen import api
from plcgen.base.diagnostics import DiagnosticError
from plcgen.base.resources import specs_dir
from plcgen.cli.main import cli
from plcgen.ds47.catalogue import pages
from plcgen.ds47.device import Parameter
from plcgen.ds47.devices import device_names, find_device
from plcgen.ds47.plan.nouns import DrivePlan

PAGE, PAGE_OF_SOURCES = (
    (Path(__file__).parents[2] / "docs" / f"{name}.md").read_text("utf-8") for name in ("devices", "evidence")
)
ACME = """\
title: Acme
source: Acme manual
record_index: {profibus: 47, default: profibus}
drive_object: {default: 1}
sources: {list: Acme list of parameters p. 7}
parameters:
  P1: {title: Read, type: Integer16, array: 4, min: 0, max: 9, default: 5, source: list, harmless: a colour}
  P2: {title: Recalled, type: Integer16, array: 4, min: 0, max: 9, default: 5, grade: recalled}
  P3: {title: Mixed, type: Integer16, max: 9, default: 5, facts: {max: inferred}, observed: 7}
  P4: {title: By data set, type: Integer16, array: DDS}
  P5: {title: Nobody knows, type: unknown}
"""


@pytest.fixture
def acme(tmp_path: Path) -> Path:
    path = tmp_path / "acme.yaml"
    path.write_text(ACME, "utf-8")
    return path


def check(folder: Path, job: str) -> api.CheckResult:
    """A spec with one job of a drive of that profile."""
    path = folder / "job.yaml"
    path.write_text(
        "plc: {name: a, family: s7-300, toolchain: tia-v16}\n"
        "drives: {d: {device: ./acme.yaml, address: 256}}\n"
        f"jobs: {{j: {{drive: d, {job}}}}}\n",
        "utf-8",
    )
    return api.check(path)


def test_only_what_was_read_decides(acme: Path) -> None:
    """Limits, start value and indexes from memory stand there and decide nothing; so does a value of a drive."""
    known = find_device(str(acme)).parameters
    assert (known[1].minimum, known[1].maximum, known[1].default, known[1].array) == (0, 9, 5, 4)
    assert known[1].source == "Acme list of parameters p. 7"
    assert (known[2].minimum, known[2].maximum, known[2].default, known[2].array) == (None, None, None, None)
    assert (known[3].maximum, known[3].default, known[3].observed) == (None, 5, 7)
    assert check(acme.parent, "write: {P2: 100}").ok
    assert check(acme.parent, 'read: ["P2[7]", "P4[7]"]').ok
    assert [d.code for d in check(acme.parent, "write: {P1: 10}").diagnostics] == ["PG209"]


@pytest.mark.parametrize(("parameter", "start"), [("P1", 5), ("P2", 0), ("P3", 5)])
def test_start_values_of_inputs(acme: Path, parameter: str, start: int) -> None:
    """A factory setting that was read, else zero."""
    plan = check(acme.parent, f"write: {{{parameter}: null}}").project.plan(DrivePlan)
    assert plan.jobs[0].uses[0].data == start.to_bytes(2)


def test_a_type_that_nobody_knows_comes_from_the_job(acme: Path) -> None:
    """Without one it is an error that names the source."""
    (told,) = check(acme.parent, "compare: {P5: 1}").diagnostics
    assert (told.code, told.message) == (
        "PG204",
        "P5 (Nobody knows) is in the catalogue without its data type: Acme manual",
    )
    assert check(acme.parent, "read: [{parameter: P5, type: Unsigned16}]").ok


def test_the_page_counts_what_there_is() -> None:
    """docs/devices.md, facts by grade: their sums, and what rests on a published list."""
    found = tuple(map(sum, zip(*(_count(name) for name in device_names() if not find_device(name).like), strict=True)))
    rows, some, read, inferred, recalled, unknown = found
    text = " ".join((PAGE + PAGE_OF_SOURCES).split())
    assert f"have {rows} rows: {read} facts read, {inferred} inferred, {recalled} recalled" in text
    assert f"{unknown} types are unknown" in text
    assert rows >= 350
    assert some >= 250
    published = sum("RV1989" in one.source for one in find_device("sinamics-g120").parameters.values())
    assert f"{published} rows of sinamics-g120 rest on a list that somebody published on GitHub" in text


def _count(name: str) -> tuple[int, ...]:
    device = find_device(name)
    known = device.parameters.values()
    some = sum(any(one.read(fact) for fact in pages.facts(one) if fact != "access") for one in known)
    return (len(known), some, *(pages.counts(known)[grade] for grade in pages.GRADES), sum(not p.type for p in known))


def test_what_another_device_lends_decides_nothing() -> None:
    """A G120C has the types of a G120, as conclusions: no limits, no factory settings, no number of indexes."""
    base = find_device("sinamics-g120")
    lent = find_device("sinamics-g120c")
    assert lent.like == "sinamics-g120"
    assert lent.parameters.keys() == base.parameters.keys()
    own = {899, 970, 971, 1210, 1300}
    for pnu, one in lent.parameters.items():
        if pnu in own:
            assert one.source.startswith(
                ("SINAMICS G120C operating", "TIA Portal information system, parameterizing G120C")
            )
            continue
        assert "read" not in one.grades.values(), pnu
        assert (one.type, one.access) == (base.parameters[pnu].type, base.parameters[pnu].access)
        assert (one.minimum, one.maximum, one.default, one.array) == (None, None, None, None)
        assert one.source.startswith("as of the same number in sinamics-g120: ")
    assert lent.parameters[1120].doubted["default"] == 10.0
    assert find_device("sinamics-g120x").parameters[1121].read("type")


POSITIONER = {2640, 2641, 2649}
"""They name VECTOR, but not VECTOR_G, among their objects."""


def test_one_list_has_three_devices() -> None:
    """G130, G150, S150: the same but for r0964, objects of p0925 and the positioner."""
    lists = [find_device(f"sinamics-{name}").parameters for name in ("g150", "g130", "s150")]
    rows = [{pnu: replace(one, source="") for pnu, one in known.items()} for known in lists]
    for other, different in ((rows[1], {964}), (rows[2], {925, 964})):
        assert {pnu for pnu, one in rows[0].items() if other[pnu] != one} == different
    assert rows[0].keys() == rows[1].keys() == rows[2].keys() - POSITIONER
    assert rows[2].keys() >= POSITIONER


def test_like_names_a_shipped_device(tmp_path: Path) -> None:
    """And not another file, which could lead anywhere."""
    (tmp_path / "own.yaml").write_text(ACME.replace("sources:", "like: sinamics-g12\nsources:"), "utf-8")
    with pytest.raises(DiagnosticError, match='there is no shipped device "sinamics-g12"') as wrong:
        find_device(str(tmp_path / "own.yaml"))
    (told,) = wrong.value.diagnostics
    assert told.help.startswith('did you mean "sinamics-g120"?')
    assert (told.code, told.span.line, told.span.column) == ("PG201", 5, 7)
    (tmp_path / "own.yaml").write_text(ACME.replace("sources:", "like: sinamics-g120\nsources:"), "utf-8")
    found = find_device(str(tmp_path / "own.yaml"))
    assert (found.parameters[1].title, found.parameters[1120].name) == ("Read", "ramp_up_time")


def test_a_wrong_like_hides_no_other_mistake(tmp_path: Path) -> None:
    """It is told in the same run as they are, and so is a display that is made writable against the device."""
    wrong = ACME.replace("sources:", "like: sinamics-g200\nsources:").replace("type: Integer16, max: 9", "type: Real")
    (tmp_path / "own.yaml").write_text(wrong, "utf-8")
    with pytest.raises(DiagnosticError) as found:
        find_device(str(tmp_path / "own.yaml"))
    assert [(d.code, d.span.line) for d in found.value.diagnostics] == [("PG201", 5), ("PG205", 10)]
    for like, code in (("sinamics-s120", "PG207"), ("12", "PG106")):
        text = ACME.replace("sources:", f"like: {like}\nsources:") + "  P21: {type: FloatingPoint, access: rw}\n"
        (tmp_path / "own.yaml").write_text(text, "utf-8")
        with pytest.raises(DiagnosticError) as found:
            find_device(str(tmp_path / "own.yaml"))
        assert [d.code for d in found.value.diagnostics] == [code]


def test_no_row_is_without_a_source_of_its_own() -> None:
    """In the shipped profiles, every parameter names what it was read in, or that it comes from memory."""
    for path in sorted((specs_dir() / "devices").glob("*.yaml")):
        profile = yaml.safe_load(path.read_text("utf-8"))
        rows = profile.get("parameters", {}).items()
        assert [key for key, row in rows if not row.get("source")] == []
        assert [key for key, row in rows if row["source"] == "memory" and row.get("grade") != "recalled"] == []


def test_values_of_the_faq_are_observed() -> None:
    """Figure 5-2 of FAQ 109750712 shows STARTER online: 110.0 is what that drive had, not a factory setting."""
    known = find_device("sinamics-dcm").parameters[50286]
    assert (known.default, known.observed) == (None, 110.0)


def test_show_tells_grades_and_source() -> None:
    """P1120 of a G120: the factory setting was read, its limits were not."""
    text = CliRunner().invoke(cli, ["catalogue", "show", "P1120", "--device", "sinamics-g120"]).output
    assert re.search(r"^  default +10  \(read\)$", text, re.MULTILINE)
    assert re.search(r"^  max +999999  \(recalled, decides nothing\)$", text, re.MULTILINE)
    assert "Startdrive" in text


def test_show_for_programs_and_what_is_not_there() -> None:
    """Known ones are shown, unknown ones reported; a neighbouring number is not offered."""
    words = ["catalogue", "show", "r945", "P1118", "fault_cod", "--device", "sinamics-s120", "--json"]
    result = CliRunner().invoke(cli, words, standalone_mode=False)
    data = json.loads(result.output)
    assert data["parameters"][0]["facts"]["array"] == {"value": 64, "grade": "read"}
    assert [found["help"] for found in data["diagnostics"]] == [
        "plcgen catalogue show --device sinamics-s120",
        'did you mean "fault_code"?',
    ]


def test_the_list_of_a_device() -> None:
    """One line for each parameter, and the sum of the facts."""
    lines = CliRunner().invoke(cli, ["catalogue", "show", "--device", "sinamics-s210"]).output.splitlines()
    assert len(lines) == 74 + 3
    assert lines[-1].startswith("74 parameters; facts: ")


def test_draws_depend_on_the_seed_alone() -> None:
    """A spot check can be repeated by somebody else."""
    device = find_device("sinamics-s120")
    first = [one.pnu for one in pages.draw(device, 10, 7)]
    assert first == [one.pnu for one in pages.draw(device, 10, 7)]
    assert first != [one.pnu for one in pages.draw(device, 10, 8)]
    assert len(set(first)) == 10
    assert len(pages.draw(device, 1000, 7)) == len(device.parameters)


def test_a_draw_tells_no_facts() -> None:
    """Numbers and titles: r0021 of an S210 has a type and a unit that the checker has to find in the manual."""
    draw = ["catalogue", "show", "--device", "sinamics-s210", "--draw", "74"]
    lines = CliRunner().invoke(cli, draw).output.splitlines()
    assert len(lines) == 1 + 74
    assert next(line.split() for line in lines if line.startswith("r21 ")) == ["r21", "Actual", "speed", "smoothed"]
    rows = json.loads(CliRunner().invoke(cli, [*draw, "--json"], standalone_mode=False).output)["parameters"]
    assert {"parameter": "r21", "title": "Actual speed smoothed"} in rows
    assert {key for row in rows for key in row} == {"parameter", "title"}


def test_a_parameter_that_was_not_read_is_marked_in_the_guide(acme: Path) -> None:
    """IMPORT.md says which types nobody read."""
    check(acme.parent, "write: {P1: 1, P2: 2}")
    assert api.generate(acme.parent / "job.yaml", acme.parent / "out").ok
    rows = [line for line in (acme.parent / "out" / "IMPORT.md").read_text("utf-8").splitlines() if "| Re" in line]
    assert [("not read in a manual" in row) for row in rows] == [False, True]


def test_a_definition_in_the_spec_is_looked_up(acme: Path) -> None:
    """Its type is no longer marked, its limits decide, and what it does not speak of stays."""
    spec = acme.parent / "job.yaml"
    spec.write_text(
        "plc: {name: a, family: s7-300, toolchain: tia-v16}\n"
        "drives: {d: {device: ./acme.yaml, address: 256, parameters: {P1: {type: Integer16, max: 7}, "
        "P2: {type: Unsigned16}}}}\n"
        "jobs: {j: {drive: d, write: {P1: 8, P2: 1}}}\n",
        "utf-8",
    )
    (told,) = [d for d in api.check(spec).diagnostics if d.severity.name == "ERROR"]
    assert told.message == "P1 = 8 is outside its limits 0..7"
    spec.write_text(spec.read_text("utf-8").replace("P1: 8", "P1: 7"), "utf-8")
    assert api.generate(spec, acme.parent / "out").ok
    assert "not read in a manual" not in (acme.parent / "out" / "IMPORT.md").read_text("utf-8")


def test_pages_know_danger_and_what_a_drive_had() -> None:
    """What a reader must know before writing."""
    page = pages.parameter_page(find_device("sinamics-s210"), find_device("sinamics-s210").parameters[1532])
    assert dict(page.sections)["Dangerous"].startswith(
        "moves a torque limit: one of the wrong sign accelerates the motor"
    )
    assert isinstance(find_device("sinamics-dcm").parameters[50303], Parameter)


def test_parameters_are_found_by_words_of_their_titles() -> None:
    """As the list of G220 prints them: r0035 is the motor temperature, whose title has both words in any case."""
    device = find_device("sinamics-g220")
    found = {one.pnu: one.title for one in device.search("TEMPERATURE motor")}
    assert found[35] == "Motor temperature"
    assert all("motor" in title.lower() and "temperature" in title.lower() for title in found.values())
    assert device.search("no such words") == []
    assert 1120 in {one.pnu for one in find_device("sinamics-g120").search("ramp")}
    page = pages.parameter_page(device, device.find(899))
    assert ".2   Operation enabled (No/Yes)" in dict(page.sections)["Bits (0/1)"]
