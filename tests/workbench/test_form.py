"""What the form puts into a spec, and which jobs it offers: ``check`` of the text that comes of it is the judge."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.diagnostics import DiagnosticError
from plcgen.ds47.devices import device_names, find_device
from plcgen.ds47.registry import kinds
from plcgen.workbench.serve.spec import outline
from plcgen.workbench.serve.starting import new_spec
from plcgen.workbench.service.specs.form import put_in
from plcgen.workbench.service.specs.jobs import JobOffer, job_offers
from tests.workbench.desk import Desk, edited

PLANT = """\
plc: {name: Press, family: s7-1200, toolchain: tia-v19}  # the press

# all drives
drives:
  axis: {device: sinamics-s120, hardware_id: 270, drive_object: 3}   # the big one
  maker: {device: profidrive, hardware_id: 271}
jobs:
  # ramps
  ramps:
    drive: axis
    write: {P1120: 5.0}  # s
  speed: {drive: axis, read: [r21], cycle: 1s}
# the end
"""

GLUE = "{parameters: [P1120], records: 2}"
STATIONS, READS = '{well: {address: 3, cpu: "224"}}', "{read_well: {station: well, read: [VW100]}}"
LINE = f"{{module: cm1241, port: 270, stations: {STATIONS}, jobs: {READS}}}"


@pytest.fixture
def desk(tmp_path: Path) -> Desk:
    """An empty folder."""
    return Desk(tmp_path)


def made(desk: Desk, text: str, what: str, **given: str) -> str:
    """The text after the form has put something in; all lines that were there are still there, in order."""
    document, _, _ = desk.open(text)
    return edited(text, put_in(desk.workspace.specs.state(document), what, given))


def errors(text: str, folder: Path) -> list[str]:
    """Errors of a spec."""
    checked = api.check(folder / "plant.yaml", read=lambda *_: text)
    return [f"{one.code} {one.message}" for one in checked.diagnostics if one.severity.label == "error"]


def offers(desk: Desk, text: str, partner: str) -> dict[str, JobOffer]:
    """What a partner is offered, by kind."""
    document, _, _ = desk.open(text)
    return {one.kind: one for one in job_offers(desk.workspace.specs.state(document), partner)}


@pytest.mark.parametrize("name", device_names())
@pytest.mark.parametrize("family", ["s7-1500", "s7-300"])
def test_what_a_device_can_do_is_what_check_lets_it(name: str, family: str, desk: Desk) -> None:
    """Every kind that is offered makes a spec without errors, in a cycle where that is offered; every other one is
    refused with the reason that ``check`` gives if it is written all the same.
    """
    tool = "tia-v19" if family == "s7-1500" else "tia-v16"
    where = "hardware_id: 270" if family == "s7-1500" else "address: 256"
    number = find_device(name).drive_object
    text = (
        f"plc: {{name: A, family: {family}, toolchain: {tool}}}\n"
        f"drives:\n  axis: {{device: {name}, {where}, drive_object: {number}}}\n"
    )
    document, _, _ = desk.open(text)
    for one in job_offers(desk.workspace.specs.state(document), "axis"):
        typed = {"parameter": "P1030", "type": "Unsigned16"} if "W" in one.text else {}
        typed = typed or ({"parameter": "P1120", "type": "FloatingPoint"} if one.asks else {})
        given = {"key": "it", "drive": "axis", "kind": one.kind, **typed}
        if one.lacks:
            with pytest.raises(DiagnosticError) as refused:
                made(desk, text, "job", **given)
            assert refused.value.diagnostics[0].message == one.lacks
            if not one.asks:
                by_hand = f"{text}jobs: {{it: {{drive: axis, {one.text}}}}}\n"
                assert f"{one.code} {one.lacks}" in errors(by_hand, desk.folder)
            continue
        assert errors(made(desk, text, "job", **given), desk.folder) == [], one
        if one.cycle:
            assert errors(made(desk, text, "job", **given, cycle="2s"), desk.folder) == [], one
        else:
            assert errors(made(desk, text, "job", **given, cycle="2s"), desk.folder) != [], one


def test_every_kind_is_offered(desk: Desk) -> None:
    """An S120 can have a job of each kind that there is, whoever brought it; its clock is in the control unit."""
    found = offers(desk, PLANT, "axis")
    keys = {one.text.partition(":")[0] for one in found.values()}
    assert keys == {kind.key for kind in kinds()}
    assert [kind for kind, one in found.items() if one.lacks] == ["clock"]
    assert "control unit" in found["clock"].lacks


def test_what_is_wrong_with_a_drive_is_no_reason(desk: Desk) -> None:
    """A drive that is wrong itself lacks no kind for it: hardware identifier 0 is never valid."""
    text = PLANT.replace("hardware_id: 270", "hardware_id: 0")
    assert not offers(desk, text, "axis")["read"].lacks


def test_a_drive_of_a_unit(desk: Desk) -> None:
    """It is tried with its unit; a parameter that it is not known to have is defined where the drive stands."""
    text = (
        "plc: {name: A, family: s7-1500, toolchain: tia-v19}\n"
        "units:\n  cabinet:\n    device: profidrive\n    drives:\n      one: {drive_object: 1, hardware_id: 270}\n"
    )
    assert not offers(desk, text, "one")["read"].lacks
    document, _, _ = desk.open(text)
    shown = outline(desk.workspace.specs.state(document))["drives"]
    assert [(one["key"], one["device"], one["place"]) for one in shown] == [("one", "profidrive", [5, 6])]
    given = {"key": "it", "drive": "one", "kind": "write", "parameter": "P1120", "type": "FloatingPoint"}
    found = made(desk, text, "job", **given)
    assert "one: {drive_object: 1, hardware_id: 270, parameters: {P1120: {type: FloatingPoint}}}" in found
    assert errors(found, desk.folder) == []


def test_a_number_is_asked_for(desk: Desk) -> None:
    """A drive of another maker whose profile has nothing to write: the reason says what to type."""
    with pytest.raises(DiagnosticError, match="no parameter for such a job") as refused:
        made(desk, PLANT, "job", key="it", drive="maker", kind="write")
    assert "number and its type" in refused.value.diagnostics[0].help


@pytest.mark.parametrize(
    ("what", "given", "old", "new"),
    [
        ("cycle", {"job": "jobs/ramps", "cycle": "500ms"}, "    write: {P1120: 5.0}  # s\n",
         "    write: {P1120: 5.0}  # s\n    cycle: 500ms\n"),
        ("cycle", {"job": "jobs/speed", "cycle": "10s"}, "cycle: 1s", "cycle: 10s"),
        ("cycle", {"job": "jobs/speed", "cycle": ""}, ", cycle: 1s}", "}"),
        ("drive", {"key": "fan", "device": "sinamics-g120", "address": "16#110"},
         "hardware_id: 271}\n",
         "hardware_id: 271}\n  fan: {device: sinamics-g120, hardware_id: 16#110, drive_object: 1}\n"),
        ("recipe", {"key": "glue", "drive": "axis"}, "# the end\n",
         f"# the end\n\nrecipes:\n  glue: {GLUE}\n"),
        ("station", {"key": "well", "address": "3", "cpu": "224"}, "# the end\n",
         f"# the end\n\nppi:\n  line: {LINE}\n"),
        ("station", {"line": "bus", "key": "well", "port": "16#10F"}, "# the end\n",
         f"# the end\n\nppi:\n  bus: {LINE.replace('270', '16#10F').replace(STATIONS, '{well: {address: 2}}')}\n"),
        ("job", {"key": "it", "drive": "axis", "kind": "acknowledge", "trigger": "M50.0"}, "cycle: 1s}\n",
         "cycle: 1s}\n  it: {drive: axis, acknowledge: true, trigger: M50.0}\n"),
        ("job", {"key": "it", "drive": "axis", "kind": "sequence"}, "cycle: 1s}\n",
         "cycle: 1s}\n  it: {drive: axis, sequence: [{write: {P1120: }}, {read: [P1120]}]}\n"),
        ("job", {"key": "it", "drive": "axis", "kind": "compare", "parameter": "P1121"}, "cycle: 1s}\n",
         "cycle: 1s}\n  it: {drive: axis, compare: {P1121: }}\n"),
        ("job", {"key": "it", "drive": "axis", "kind": "read", "parameter": "r945[0..7]"}, "cycle: 1s}\n",
         'cycle: 1s}\n  it: {drive: axis, read: ["r945[0..7]"]}\n'),
        ("station", {"key": "well", "address": "3", "cpu": "224", "parameter": "VD100"}, "# the end\n",
         f"# the end\n\nppi:\n  line: {LINE.replace('VW100', 'VD100')}\n"),
        ("job", {"key": "it", "drive": "axis", "kind": "save"}, "cycle: 1s}\n",
         "cycle: 1s}\n  it: {drive: axis, save: drive_object}\n"),
    ],
)  # fmt: skip
def test_what_is_put_in(what: str, given: dict[str, str], old: str, new: str, desk: Desk) -> None:
    """The new text stands in its section, without errors; everything else, comments among it, is as it was.

    A cycle is put in as it is said, also where the rules then refuse it.
    """
    assert PLANT.count(old) == 1
    found = made(desk, PLANT, what, **given)
    assert found == PLANT.replace(old, new)
    assert what == "cycle" or errors(found, desk.folder) == []


def test_recipes_and_stations_are_specs(desk: Desk) -> None:
    """A recipe with a job of each kind that takes one, a parameter more in it; a second station with its jobs."""
    text = made(desk, PLANT, "job", key="set_it", drive="axis", kind="write_recipe")
    for kind in ("read_recipe", "compare_recipe"):
        text = made(desk, text, "job", key=kind, drive="axis", kind=kind)
    text = made(desk, text, "parameter", job="recipes/material", parameter="P1121")
    assert "material: {parameters: [P1120, P1121], records: 2}" in text
    assert text.count("recipes:") == 1
    text = made(desk, text, "station", key="well")
    text = made(desk, text, "station", key="tank", line="line", address="3")
    for kind, one in offers(desk, text, "line/tank").items():
        assert not one.lacks
        text = made(desk, text, "job", key=f"tank_{kind}", station="line/tank", kind=kind)
    text = made(desk, text, "job", key="volume", station="line/tank", kind="read", parameter="VD100")
    text = made(desk, text, "parameter", job="ppi/line/jobs/volume", parameter="M0.0", access="read")
    assert "volume: {station: tank, read: [VD100, M0.0]}" in text
    assert errors(text, desk.folder) == []


def test_an_added_column_has_its_value_in_every_record(desk: Desk) -> None:
    """It is asked for where records are listed: no record is left to a value that nobody has said."""
    recipe = "recipes:\n  glue:\n    parameters: [P1120]\n    records: {thin: {P1120: 1.0}, thick: {P1120: 2.0}}\n"
    text = f"{PLANT}{recipe}"
    with pytest.raises(DiagnosticError, match="every record needs a value"):
        made(desk, text, "parameter", job="recipes/glue", parameter="P1121")
    found = made(desk, text, "parameter", job="recipes/glue", parameter="P1121", value="4.0")
    assert found == text.replace("[P1120]\n", "[P1120, P1121]\n").replace(
        "{thin: {P1120: 1.0}, thick: {P1120: 2.0}}",
        "{thin: {P1120: 1.0, P1121: 4.0}, thick: {P1120: 2.0, P1121: 4.0}}",
    )


def test_a_column_of_counted_records_begins_with_its_value(desk: Desk) -> None:
    """Records that are counted have no values of their own: the one that was typed is the start value of the column."""
    text = f"{PLANT}recipes:\n  glue: {GLUE}\n"
    found = made(desk, text, "parameter", job="recipes/glue", parameter="P1121", value="4.0")
    assert found == text.replace("[P1120]", "[P1120, {parameter: P1121, start: 4.0}]")
    load = found.replace("write: {P1120: 5.0}", "write_recipe: glue")
    assert errors(load, desk.folder) == []
    block = made(
        desk, text.replace("[P1120]", "P1120"), "parameter", job="recipes/glue", parameter="p2900[0]", value="1"
    )
    assert '[P1120, {parameter: "p2900[0]", start: 1}]' in block


@pytest.mark.parametrize("kind", ["read", "compare", "save", "write", "alarms", "write_recipe"])
def test_a_cycle_is_offered_where_check_takes_it(kind: str, desk: Desk) -> None:
    """The form shows the cycle that a job has, and whether its kind may have one, as PG264 has it."""
    text = made(desk, PLANT, "job", key="it", drive="axis", kind=kind, cycle="500ms")
    document, _, _ = desk.open(text)
    (job,) = [one for one in outline(desk.workspace.specs.state(document))["jobs"] if one["key"] == "it"]
    assert job["cycle"] == "500ms"
    assert job["repeats"] == (not any(one.startswith("PG264") for one in errors(text, desk.folder)))
    without = made(desk, PLANT, "job", key="it", drive="axis", kind=kind)
    assert made(desk, text, "cycle", job="jobs/it", cycle="") == without
    assert made(desk, without, "cycle", job="jobs/it", cycle="") == without


def test_a_job_of_several_drives(desk: Desk) -> None:
    """A recipe for two axes; a kind that one of them lacks is refused, and the reason names the drive."""
    same = PLANT.replace("  maker", "  twin: {device: sinamics-s120, hardware_id: 272, drive_object: 3}\n  maker")
    found = made(desk, same, "job", key="it", drive="axis,twin", kind="write_recipe", recipe="glue")
    assert "it: {drive: [axis, twin], write_recipe: glue}" in found
    assert errors(found, desk.folder) == []
    text = PLANT.replace("  maker", "  far: {device: sinamics-g120, hardware_id: 272}\n  maker")
    lacking = offers(desk, text, "axis,far")["activate"]
    assert lacking.lacks == f"far: {offers(desk, text, 'far')['activate'].lacks}"
    with pytest.raises(DiagnosticError, match="far: "):
        made(desk, text, "job", key="it", drive="axis,far", kind="activate")
    typed = {"parameter": "P101", "type": "Unsigned16", "unit": "%"}
    both = text.replace("  maker", "  other: {device: profidrive, hardware_id: 273}\n  maker")
    found = made(desk, both, "job", key="it", drive="other,maker", kind="write", **typed)
    assert found.count('parameters: {P101: {type: Unsigned16, unit: "%"}}') == 2
    assert "it: {drive: [other, maker], write: {P101: }}" in found


@pytest.mark.parametrize("device", ["ppi", *device_names()])
@pytest.mark.parametrize("family", ["s7-1500", "s7-300"])
def test_a_new_spec_names_no_command(device: str, family: str, desk: Desk) -> None:
    """On the page there are buttons: nothing in it sends its reader to a shell; it has no errors."""
    given = {"device": device, "family": family, "toolchain": "tia-v19" if family == "s7-1500" else "tia-v16"}
    text = new_spec("job.yaml", given, desk.folder)
    assert "plcgen" not in text
    assert text.startswith("plc:")
    assert errors(text, desk.folder) == []


@pytest.mark.parametrize(
    ("path", "old", "new"),
    [
        ("jobs/speed", "  speed: {drive: axis, read: [r21], cycle: 1s}\n", ""),
        ("jobs/ramps", "  ramps:\n    drive: axis\n    write: {P1120: 5.0}  # s\n", ""),
        ("drives/maker", "  maker: {device: profidrive, hardware_id: 271}\n", ""),
        ("jobs/speed/cycle", ", cycle: 1s}", "}"),
        ("jobs/speed/drive", "{drive: axis, read", "{read"),
    ],
)
def test_what_is_removed(path: str, old: str, new: str, desk: Desk) -> None:
    """An entry goes with its lines or its comma; everything else, comments among it, is as it was."""
    assert PLANT.count(old) == 1
    assert made(desk, PLANT, "remove", path=path) == PLANT.replace(old, new)


def test_a_parameter_is_removed_but_not_the_only_one(desk: Desk) -> None:
    """Of a list by its number, of a mapping by its key; comments below a job go with it, a blank line, too."""
    text = PLANT.replace("[r21]", "[r21, r26, r27]").replace("{P1120: 5.0}", "{P1120: 5.0, P1121: }")
    assert "read: [r21, r27]" in made(desk, text, "remove", path="jobs/speed/read/1")
    assert "read: [r21, r26]" in made(desk, text, "remove", path="jobs/speed/read/2")
    assert "write: {P1120: 5.0}  # s" in made(desk, text, "remove", path="jobs/ramps/write/P1121")
    assert "write: {P1121: }  # s" in made(desk, text, "remove", path="jobs/ramps/write/P1120")
    for path in ("jobs/speed/read/0", "jobs/ramps/write/P1120"):
        with pytest.raises(DiagnosticError, match="no other parameter"):
            made(desk, PLANT, "remove", path=path)
    apart = PLANT.replace("  speed:", "    # more of it\n\n  speed:")
    assert made(desk, apart, "remove", path="jobs/ramps") == apart.replace(
        "  ramps:\n    drive: axis\n    write: {P1120: 5.0}  # s\n    # more of it\n", ""
    )
    assert made(desk, apart, "job", key="it", drive="axis", kind="acknowledge").endswith(
        "cycle: 1s}\n\n  it: {drive: axis, acknowledge: true}\n# the end\n"
    )


def test_what_is_used_stays(desk: Desk) -> None:
    """A drive that jobs name is not removed: the reason names them; nor is what stands nowhere."""
    with pytest.raises(DiagnosticError, match='"axis" is used by "ramps, speed"'):
        made(desk, PLANT, "remove", path="drives/axis")
    with pytest.raises(DiagnosticError, match="there is no"):
        made(desk, PLANT, "remove", path="jobs/nobody")
    text = made(desk, PLANT, "station", key="well")
    with pytest.raises(DiagnosticError, match='"well" is used by "read_well"'):
        made(desk, text, "remove", path="ppi/line/stations/well")


def test_what_the_form_shows(desk: Desk) -> None:
    """What each job does, its parameters, and a free address for the next drive."""
    document, _, _ = desk.open(PLANT)
    shown = outline(desk.workspace.specs.state(document))
    assert shown["next_address"] == "272"
    assert [(one["key"], one["does"]) for one in shown["jobs"]] == [("ramps", ["write"]), ("speed", ["read"])]
    assert [one["label"] for job in shown["jobs"] for one in job["parameters"]] == ["P1120", "r21"]
    assert shown["jobs"][0]["place"] == [8, 2]


def test_a_new_spec_has_the_jobs_that_were_chosen(desk: Desk) -> None:
    """Those and no others; none at all is refused; a line of stations has the identifier of its port."""
    given = {"device": "sinamics-s120", "family": "s7-1500", "toolchain": "tia-v19"}
    text = new_spec("job.yaml", {**given, "jobs": "ramps"}, desk.folder)
    assert errors(text, desk.folder) == []
    assert "set_ramps:" in text
    assert "read_faults:" not in text
    for jobs in ("", "nothing"):
        with pytest.raises(DiagnosticError, match="one job at least"):
            new_spec("job.yaml", {**given, "jobs": jobs}, desk.folder)
    assert "port: 283" in new_spec("job.yaml", {**given, "device": "ppi", "port": "283"}, desk.folder)
    assert "read: [VD100]" in new_spec("job.yaml", {**given, "device": "ppi", "read": "VD100"}, desk.folder)
    with pytest.raises(DiagnosticError, match="no address of an S7-200"):
        new_spec("job.yaml", {**given, "device": "ppi", "read": "100"}, desk.folder)


def test_one_step_back(desk: Desk) -> None:
    """One edit for what is put in, and its place is that of the new text alone: undo takes back nothing else."""
    document, _, _ = desk.open(PLANT)
    (edit,) = put_in(desk.workspace.specs.state(document), "cycle", {"job": "jobs/ramps", "cycle": "2s"})
    assert (edit.span.line, edit.span.end_line, edit.text) == (12, 12, "    cycle: 2s\n")


@pytest.mark.parametrize(
    ("what", "given", "said"),
    [
        ("drive", {"key": "1a"}, "no name"),
        ("drive", {"key": "a", "device": "sinamics-s120", "address": "here"}, "no address"),
        ("drive", {"key": "a", "device": "none"}, "none"),
        ("drive", {"key": "axis", "device": "sinamics-s120"}, "already"),
        ("job", {"key": "a", "drive": "nobody", "kind": "read"}, "no drive or station"),
        ("job", {"key": "a", "drive": "axis", "kind": "read", "cycle": "soon"}, "no time"),
        ("parameter", {"job": "recipes/none", "parameter": "P1"}, "no list"),
        ("cycle", {"job": "jobs/ramps", "cycle": "1"}, "no time"),
        ("job", {"key": "a", "drive": "axis", "kind": "read", "trigger": "M1.0}\n"}, "cannot be put in"),
        ("parameter", {"job": "jobs/speed", "parameter": "r1, r2"}, "cannot be put in"),
    ],
)
def test_what_is_refused(what: str, given: dict[str, str], said: str, desk: Desk) -> None:
    """With a reason, and nothing is changed."""
    with pytest.raises(DiagnosticError, match=said):
        made(desk, PLANT, what, **given)


SECTIONS = {
    "drives": "",
    "jobs": "drives: {axis: {device: sinamics-g120, hardware_id: 270}, far: {device: profidrive, hardware_id: 271}}\n",
    "recipes": "drives:\n  axis: {device: sinamics-s120, hardware_id: 270}\njobs:\n  a: {drive: axis, read: [r21]}\n",
    "ppi": "",
}


@pytest.mark.parametrize("family", ["s7-1200", "s7-1500", "s7-300"])
@pytest.mark.parametrize("section", SECTIONS)
def test_an_editor_offers_whole_entries(section: str, family: str, desk: Desk) -> None:
    """Where an entry would begin: each that is offered, put in as it is, makes a spec without errors."""
    tool = "tia-v16" if family == "s7-300" else "tia-v19"
    head = f"plc: {{name: A, family: {family}, toolchain: {tool}}}\n{SECTIONS[section]}"
    head = head.replace("hardware_id: 27", "address: 27") if family == "s7-300" else head
    more = "jobs:\n  a: {drive: drive1, read: [P922]}\n" if section == "drives" else ""
    found = desk.offers(f"{head}{section}:\n  |\n{more}")
    assert len(found) >= {"drives": 20, "jobs": 12, "recipes": 1, "ppi": 1}[section]
    for label, (text, _) in found.items():
        spec = f"{head}{section}:\n  {text}\n{more}"
        if section == "drives":
            spec = spec.replace("P922", find_device(label).example())
        assert errors(spec, desk.folder) == [], label


def test_jobs_that_a_drive_lacks_come_last(desk: Desk) -> None:
    """With the reason beside them: a G120 is one drive object and cannot be left out."""
    text = PLANT.replace("sinamics-s120", "sinamics-g120").replace("drive_object: 3", "drive_object: 1")
    found = desk.offers(text.replace("    write: {P1120: 5.0}  # s\n", "    |\n"))
    assert "not for axis" in found["activate"][1]
    assert "not for axis" not in found["save"][1]
    assert list(found).index("save") < list(found).index("activate")


def test_what_needs_a_sign_off_comes_last(desk: Desk) -> None:
    """p0971 saves, p1120 is a ramp: the ramp is offered first, the other says what it needs."""
    found = desk.offers(PLANT.replace("P1120: 5.0", "|"))
    assert "sign-off" in found["P971"][1]
    assert "sign-off" not in found["P1120"][1]
    assert list(found).index("P1120") < list(found).index("P971")
    reads = list(desk.offers(PLANT.replace("[r21]", "[|]")))
    assert reads.index("r21") < reads.index("parameter")


@pytest.mark.parametrize(
    "job", ["write: {P64000: 1.0}", "compare: {P64000: 1.0}", "read: [P64000]", "read: [P64000[0..3]]"]
)
def test_a_parameter_that_nobody_knows_is_defined(job: str, desk: Desk) -> None:
    """The fix writes it into its drive with a type, and nothing is said of it any more."""
    text = PLANT.replace("drive: axis, read: [r21], cycle: 1s", f"drive: maker, {job}")
    document, _, _ = desk.open(text)
    (found,) = [one for one in desk.workspace.diagnostics(document) if "type of P64000" in one.diagnostic.message
                or "P64000 is not in the catalogue" in one.diagnostic.message]  # fmt: skip
    fix = next(one for one in found.fixes if "FloatingPoint" in one.title)
    made_ = edited(text, fix.edits)
    assert made_ == text.replace("hardware_id: 271}", "hardware_id: 271, parameters: {P64000: {type: FloatingPoint}}}")
    assert errors(made_, desk.folder) == []


def test_a_missing_section_comes_last(desk: Desk) -> None:
    """Jobs are written behind the drives."""
    text = PLANT[: PLANT.index("jobs:")]
    document, _, _ = desk.open(text)
    (found,) = [one for one in desk.workspace.diagnostics(document) if one.diagnostic.code == "PG105"]
    assert edited(text, found.fixes[0].edits) == f"{text}jobs:\n  "
