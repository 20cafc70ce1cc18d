"""What the page asks and gets: the text as it is typed, what it becomes, runs, verification, tools."""

from __future__ import annotations

import base64
import hashlib
import io
import json
import re
import shutil
import subprocess
import time
import zipfile
from pathlib import Path
from typing import Any

import pytest

from plcgen import api
from plcgen.base.files.yaml import load_yaml
from plcgen.ds47.devices import find_device
from tests.projects import ROOT
from tests.workbench.serve.asking import TOKEN, Server

FAQ = "s7-300_6ra80_dp_tia.yaml"
PUMP = "s7-1500_g120_pn.yaml"
PPI = "s7-1200_s7-200_ppi.yaml"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with shipped specs."""
    made = tmp_path / "specs"
    made.mkdir()
    for name in (FAQ, PUMP, PPI):
        shutil.copy(ROOT / "specs" / name, made)
    return made


@pytest.fixture
def server(folder: Path) -> Server:
    """Its server."""
    return Server(folder)


def now(folder: Path, name: str, *edit: str) -> dict[str, Any]:
    """A spec as the editor has it; ``edit`` are an old and a new text."""
    text = (folder / name).read_text("utf-8")
    assert not edit or edit[0] in text
    return {"name": name, "text": text.replace(*edit) if edit else text}


def changed(server: Server, asked: dict[str, Any], what: str, given: dict[str, str]) -> str:
    """The text after the edits of the form; lines of these texts are plain ASCII."""
    text: str = asked["text"]
    lines = text.splitlines(keepends=True)
    for edit in server.told("change", {**asked, "what": what, "given": given})["edits"]:
        first, start, last, end = edit["place"]
        behind = [lines[last][end:], *lines[last + 1 :]] if last < len(lines) else []
        text = "".join([*lines[:first], lines[first][:start] if first < len(lines) else "", edit["text"], *behind])
    return text


def held(found: dict[str, Any]) -> dict[str, str]:
    """The values of the partners by name."""
    return {one["name"]: one["value"] for one in found["partners"]}


def done(server: Server) -> dict[str, Any]:
    """The result of the work that runs."""
    end = time.monotonic() + 120
    while not (found := server.told("state"))["ended"]:
        assert time.monotonic() < end, found
        time.sleep(0.05)
    return dict(found)


def test_a_problem_has_its_place_reason_and_fix(folder: Path, server: Server) -> None:
    """``famly`` for ``family``: at its line, with the word it should be."""
    asked = now(folder, FAQ, "family:", "famly:")
    (one,) = [each for each in server.told("check", asked)["findings"] if "famly" in each["message"]]
    line = next(number for number, text in enumerate(asked["text"].splitlines()) if "famly" in text)
    assert (one["severity"], one["here"], one["place"][0]) == ("error", True, line)
    assert one["reason"]
    (fix,) = one["fixes"]
    assert [edit["text"] for edit in fix["edits"]] == ["family"]


def test_places_count_as_editors_do(server: Server) -> None:
    """Behind a character outside the basic plane a place is one further in UTF-16 than in characters."""
    text = "plc: {name: A, family: s7-1500, toolchain: tia-v19}\ndrives:\n  a: {comment: \U0001f600, devce: x}\n"
    found = server.told("check", {"name": "a.yaml", "text": text})["findings"]
    line = text.splitlines()[2]
    wanted = len(line[: line.index("devce")].encode("utf-16-le")) // 2
    assert [2, wanted] in [one["place"][:2] for one in found]


def test_completion_and_hover_speak_of_the_parameter(folder: Path, server: Server) -> None:
    """P1120 of a G120: what may stand there, and what it is."""
    asked = now(folder, PUMP)
    line = next(n for n, one in enumerate(asked["text"].splitlines()) if "P1120" in one)
    character = asked["text"].splitlines()[line].index("P1120")
    page = server.told("hover", {**asked, "line": line, "character": character + 2})["page"]
    assert "amp" in str(page)
    offers = server.told("complete", {**asked, "line": line, "character": character + 3})["offers"]
    assert any(one["label"].startswith("P1") for one in offers)


def test_search_finds_by_words_number_and_message(folder: Path, server: Server) -> None:
    """The list manual of the G120: p1120 is the ramp-up time; F30001 a message, whatever its title."""
    asked = {**now(folder, PUMP), "job": "set_ramps"}
    for words in ("ramp-up", "1120", "P1120"):
        found = server.told("search", {**asked, "words": words})["parameters"]
        (one,) = [each for each in found if each["parameter"] == "P1120"]
        assert one["writable"]
    assert server.told("search", {**asked, "words": "F30001"})["messages"][0]["key"] == "F30001"


def test_a_form_edit_keeps_everything_else(folder: Path, server: Server) -> None:
    """One parameter more in one line; the text is checked like one that was typed."""
    asked = now(folder, PUMP)
    given = {"job": "jobs/read_speed", "parameter": "r27", "access": "read"}
    text = changed(server, asked, "parameter", given)
    assert text == asked["text"].replace("read: [actual_speed]", "read: [actual_speed, r27]")
    given = {"key": "fan", "device": "sinamics-g120", "address": "271"}
    text = changed(server, {**asked, "text": text}, "drive", given)
    assert "  fan: {device: sinamics-g120, hardware_id: 271, drive_object: 1}\n" in text
    given = {"key": "watch_fan", "drive": "fan", "kind": "read"}
    text = changed(server, {"name": PUMP, "text": text}, "job", given)
    assert not [
        one for one in server.told("check", {"name": PUMP, "text": text})["findings"] if one["severity"] == "error"
    ]


def drives_of(device: str) -> str:
    """A spec with a drive of a device, and with a control unit."""
    number = find_device(device).drive_object
    return (
        "plc: {name: Press, family: s7-1500, toolchain: tia-v19}\n"
        f"drives:\n  axis: {{device: {device}, hardware_id: 270, drive_object: {number}}}\n"
        "  unit: {device: sinamics-s120, hardware_id: 271, drive_object: 1}\n"
    )


def test_a_recipe_a_cycle_and_a_station_are_had_from_the_form(server: Server) -> None:
    """From nothing but a PLC: two drives' jobs and an S7-200 that is read every second; a spec without errors."""
    asked = {"name": "a.yaml", "text": "plc: {name: Press, family: s7-1200, toolchain: tia-v19}\n"}
    steps: list[tuple[str, dict[str, str]]] = [
        ("drive", {"key": "axis", "device": "sinamics-s120", "address": "280", "drive_object": "3"}),
        ("job", {"key": "load", "drive": "axis", "kind": "write_recipe", "recipe": "sorts"}),
        ("job", {"key": "store", "drive": "axis", "kind": "read_recipe", "recipe": "sorts"}),
        ("job", {"key": "speed", "drive": "axis", "kind": "read", "cycle": "1s"}),
        ("station", {"line": "pumps", "key": "pump1", "address": "3", "cpu": "224", "port": "271"}),
        ("station", {"line": "pumps", "key": "pump2", "address": "4"}),
        ("job", {"key": "level", "station": "pumps/pump2", "kind": "read", "cycle": "1s"}),
        ("job", {"key": "halt", "station": "pumps/pump1", "kind": "stop", "trigger": "M50.0"}),
    ]
    for what, given in steps:
        asked["text"] = changed(server, asked, what, given)
        found = server.told("check", asked)
    assert [one["message"] for one in found["findings"] if one["severity"] == "error"] == []
    data = load_yaml(asked["text"], "a.yaml").data()
    assert data["drives"]["axis"]["hardware_id"] == 280
    assert [data["jobs"][key].get("cycle") for key in ("load", "speed")] == [None, "1s"]
    assert data["jobs"]["store"]["read_recipe"] == "sorts"
    assert sorted(data["recipes"]) == ["sorts"]
    line = data["ppi"]["pumps"]
    assert (line["port"], line["stations"]["pump1"], line["stations"]["pump2"]) == (
        271, {"address": 3, "cpu": "224"}, {"address": 4},
    )  # fmt: skip
    assert (line["jobs"]["level"]["cycle"], line["jobs"]["halt"]["trigger"]) == ("1s", "M50.0")


@pytest.mark.parametrize(
    ("what", "given"),
    [
        ("job", {"key": "a", "drive": "axis", "kind": "read", "cycle": "1s}, evil: {x: 1"}),
        ("job", {"key": "a", "drive": "axis", "kind": "read", "trigger": "M50.0, read: [r1]"}),
        ("job", {"key": "a b", "drive": "axis", "kind": "read"}),
        ("job", {"key": "a", "drive": "axis", "kind": "write_recipe", "recipe": "x: {"}),
        ("station", {"line": "l}", "key": "a", "address": "2"}),
        ("station", {"line": "l", "key": "a", "address": "2, cpu: 9"}),
        ("station", {"line": "l", "key": "a", "address": "2", "cpu": '"}'}),
        ("drive", {"key": "b", "device": "sinamics-s120", "drive_object": "1}"}),
    ],
)
def test_what_is_typed_into_the_form_stays_one_value(what: str, given: dict[str, str], server: Server) -> None:
    """Nothing of it becomes YAML of its own: it is refused with what may stand there."""
    answer = server.ask("change", {"name": "a.yaml", "text": drives_of("sinamics-s120"), "what": what, "given": given})
    assert (answer.status, answer.json()["problems"][0]["code"]) == (422, "PG901")
    assert answer.json()["problems"][0]["help"]


def test_telegrams_are_those_of_the_faq(folder: Path, server: Server) -> None:
    """FAQ 109750712 fig. 5-1: 03 01 02 01 10 01 C4 7F 00 00 in DB3; a member, its address and its line agree."""
    found = server.told("becomes", now(folder, FAQ))
    request = found["telegrams"][0]["request"]
    assert bytes(byte for one in request["fields"] for byte in one["bytes"]).hex(" ") == "03 01 02 01 10 01 c4 7f 00 00"
    (number,) = [one for one in request["fields"] if one["name"] == "Para_No"]
    assert (number["offset"], number["address"]) == (6, "DB3.DBW6")
    lines = [line for each in found["excerpts"] if each["block"] == request["block"] for line in each["lines"]]
    assert any("Para_No" in line["text"] for line in lines if line["member"] == 6)


def test_files_tell_how_they_differ_from_the_disk(folder: Path, server: Server) -> None:
    """New before they are written, as on disk after it; one edit makes a difference in the files it concerns."""
    asked = now(folder, FAQ)
    assert {one["state"] for one in server.told("becomes", now(folder, FAQ))["files"]} == {"new"}
    known = server.told("read", {"name": FAQ})["known"]
    written = server.told("write", {**asked, "known": known})
    assert (written["ok"], written["folder"]) == (True, "s7-300_6ra80_dp_tia_generated")
    assert {one["state"] for one in server.told("becomes", now(folder, FAQ))["files"]} == {"same"}
    edited = now(folder, FAQ, "P50304: 100.0", "P50304: 50.0")
    states = {one["path"]: one["state"] for one in server.told("becomes", edited)["files"]}
    (changed,) = [path for path, state in states.items() if state == "changed" and path.endswith(".scl")]
    diff = server.told("part", {**edited, "path": changed})["diff"]
    assert any(line.startswith("+") and "50.0" in line for line in diff.splitlines())


def test_the_archive_holds_what_generate_writes(folder: Path, server: Server, tmp_path: Path) -> None:
    """Byte for byte, and nothing is on disk afterwards."""
    answer = server.request("POST", f"/{TOKEN}/zip", [json.dumps(now(folder, FAQ)).encode()])
    assert answer.headers["content-type"] == "application/zip"
    with zipfile.ZipFile(io.BytesIO(answer.data)) as archive:
        held = {name.partition("/")[2]: archive.read(name) for name in archive.namelist()}
    assert not (folder / "s7-300_6ra80_dp_tia_generated").exists()
    made = api.generate(folder / FAQ, tmp_path / "out")
    assert held == {name: (made.folder / name).read_bytes() for name in made.written}


def test_a_file_that_was_edited_is_not_overwritten(folder: Path, server: Server) -> None:
    """PG502 as ``generate`` says it; the spec is saved, the file stays."""
    asked = {**now(folder, FAQ), "known": server.told("read", {"name": FAQ})["known"]}
    asked["known"] = server.told("write", asked)["known"]
    (file,) = (folder / "s7-300_6ra80_dp_tia_generated").glob("*.scl")
    file.write_text("mine", "utf-8")
    shown = {one["path"]: (one["state"], one["foreign"]) for one in server.told("becomes", now(folder, FAQ))["files"]}
    assert [name for name, (_, foreign) in shown.items() if foreign] == [file.name]
    assert shown["IMPORT.md"] == ("same", False)
    done = server.told("write", {**asked, "text": asked["text"].replace("100.0", "50.0")})
    assert (done["ok"], [one["code"] for one in done["problems"] if one["severity"] == "error"]) == (False, ["PG502"])
    assert file.read_text("utf-8") == "mine"


def test_an_edited_file_is_overwritten_only_as_it_was_agreed(folder: Path, server: Server) -> None:
    """Agreeing to another file, to one of two, or to what was there before overwrites nothing; to all of it, all."""
    asked = {**now(folder, FAQ), "known": server.told("read", {"name": FAQ})["known"]}
    server.told("write", asked)
    out = folder / "s7-300_6ra80_dp_tia_generated"
    (source,) = out.glob("*.scl")
    guide = out / "IMPORT.md"
    for file in (source, guide):
        file.write_text("mine", "utf-8")
    both = sorted([source.name, guide.name])
    held = {name: hashlib.sha256(b"mine").hexdigest() for name in both}
    before = held | {guide.name: hashlib.sha256(b"mine, too").hexdigest()}
    for agreed in ({}, {"other.scl": held[guide.name]}, {source.name: held[source.name]}, before):
        done = server.told("write", {**asked, "overwrite": agreed})
        assert (done["ok"], sorted(one["path"] for one in done["in_the_way"])) == (False, both)
        assert all("changed" in one["why"] for one in done["in_the_way"])
        assert [file.read_text("utf-8") for file in (source, guide)] == ["mine", "mine"]
    done = server.told("write", {**asked, "overwrite": held})
    assert (done["ok"], sorted(done["written"]), done["in_the_way"]) == (True, both, [])
    assert {one["state"] for one in server.told("becomes", now(folder, FAQ))["files"]} == {"same"}


@pytest.mark.parametrize("what", ["a folder in the way", "another project"])
def test_what_a_name_does_not_cover_is_never_overwritten(what: str, folder: Path, server: Server) -> None:
    """A folder with the name of a file cannot be; a manifest stands for all files of another project."""
    asked = {**now(folder, FAQ), "known": server.told("read", {"name": FAQ})["known"]}
    out = folder / "s7-300_6ra80_dp_tia_generated"
    if what == "another project":
        api.generate(folder / PUMP, out)
    else:
        (out / "IMPORT.md").mkdir(parents=True)
    before = {file: file.read_bytes() for file in out.rglob("*") if file.is_file()}
    done = server.told("write", {**asked, "overwrite": {"IMPORT.md": "", "manifest.json": ""}})
    assert (done["ok"], done["in_the_way"]) == (False, [])
    assert {file: file.read_bytes() for file in out.rglob("*") if file.is_file()} == before


def test_a_spec_that_somebody_else_has_changed_is_not_overwritten(folder: Path, server: Server) -> None:
    """Nor is a new one saved over a file that is there."""
    read = server.told("read", {"name": FAQ})
    (folder / FAQ).write_text("theirs", "utf-8")
    for known in (read["known"], ""):
        answer = server.ask("save", {"name": FAQ, "text": "mine", "known": known})
        assert (answer.status, answer.json()["problems"][0]["code"]) == (422, "PG501")
    assert (folder / FAQ).read_text("utf-8") == "theirs"


def test_a_run_goes_on_scan_by_scan(folder: Path, server: Server) -> None:
    """Nothing happens until execute is set; the drive gets the value that was set by hand, and says so."""
    server.told("load", now(folder, PUMP))
    assert server.told("step", {"scans": 5})["results"][0]["ending"] == "not_started"
    server.told("put", {"text": "DriveJobs.setRamps.execute=TRUE"})
    seen, scans = [], 0
    while not seen or seen[-1]["ending"] == "running":
        found = server.told("step", {"scans": 10})
        seen, scans = [found["results"][0]], scans + 10
        assert scans < 500
    assert (seen[0]["ending"], seen[0]["status"]) == ("done", "0000")


def test_a_job_that_is_started_again_is_told_of_anew(folder: Path, server: Server) -> None:
    """First accepted, then refused (status 8401 of docs/generated-code.md); values also as SCL writes them."""
    server.told("load", now(folder, PUMP))
    ended = []
    for fault in ({}, {"kind": "error", "keys": {"number": "16#11"}}):
        if fault:
            server.told("strike", fault)
        server.told("put", {"text": '"DriveJobs".setRamps.execute := TRUE'})
        found = server.told("step", {"scans": 200})["results"][0]
        ended.append((found["ending"], found["status"]))
        server.told("put", {"text": "DriveJobs.setRamps.execute=FALSE"})
        server.told("step", {"scans": 5})
    assert ended == [("done", "0000"), ("error", "8401")]


def test_a_job_that_is_refused_at_once_is_told_of(folder: Path, server: Server) -> None:
    """A second save within 600 s is refused before it is busy (status 8502 of docs/generated-code.md), and why."""
    keep = "jobs:\n  keep: {drive: pump, write: {P1121: 10.0}, verify: readback, save: drive_object}\n"
    server.told("load", now(folder, PUMP, "jobs:\n", keep))
    ended = []
    for _ in range(2):
        server.told("put", {"text": "DriveJobs.keep.execute=TRUE"})
        for _ in range(20):
            found = next(one for one in server.told("step", {"scans": 100})["results"] if one["job"] == "keep")
            if found["ending"] != "running":
                break
        ended.append((found["ending"], found["status"]))
        server.told("put", {"text": "DriveJobs.keep.execute=FALSE"})
        server.told("step", {"scans": 3})
    assert ended == [("done", "0000"), ("error", "8502")]
    assert "save" in found["text"]


def test_faults_that_still_strike_are_listed_and_removed(folder: Path, server: Server) -> None:
    """With what was typed and how often they strike; one that is removed no longer does: the job ends well."""
    server.told("load", now(folder, PUMP))
    fault = {"kind": "error", "keys": {"number": "16#11", "times": "3"}}
    (one,) = server.told("strike", fault)["struck"]
    assert (one["text"].startswith("error: "), "number=16#11" in one["text"], one["left"]) == (True, True, 3)
    for expected, left in (("error", [2]), ("done", [])):
        server.told("put", {"text": "DriveJobs.setRamps.execute=TRUE"})
        found = server.told("step", {"scans": 200})
        assert (found["results"][0]["ending"], [each["left"] for each in found["struck"]]) == (expected, left)
        server.told("put", {"text": "DriveJobs.setRamps.execute=FALSE"})
        server.told("step", {"scans": 5})
        server.told("withdraw", {"number": one["number"]})


def test_a_value_may_have_a_decimal_comma(folder: Path, server: Server) -> None:
    """As it is typed in German; what is no value is refused without an option of the command line."""
    server.told("load", now(folder, PUMP))
    found = server.told("put", {"text": "DriveJobs.setRamps.rampUpTime=20,5"})
    assert next(value for path, value in found["inputs"].items() if path.endswith("rampUpTime")) == "20.5"
    assert held(found)["pump.P1120"] == "10.0"
    assert "--set" not in server.ask("put", {"text": "DriveJobs.setRamps.rampUpTime=2,0,5"}).text
    assert "--fault" not in server.ask("strike", {"kind": "status", "keys": {}}).text


def test_a_new_spec_names_no_commands_of_a_shell(server: Server) -> None:
    """Its page has buttons for them."""
    given = {"family": "s7-1500", "toolchain": "tia-v19", "device": "sinamics-g120"}
    for device in ("sinamics-g120", "ppi"):
        text = server.told("new", {"name": f"{device}.yaml", "given": {**given, "device": device}})["text"]
        assert "plc:" in text
        assert not [line for line in text.splitlines() if line.startswith("#") and "plcgen " in line]


def test_verification_of_an_edited_file_names_buttons_not_commands(folder: Path, server: Server) -> None:
    """The edit of the file on disk is an error there; how to go on is told for the page."""
    asked = now(folder, FAQ)
    server.told("write", {**asked, "known": server.told("read", {"name": FAQ})["known"]})
    (source,) = (folder / "s7-300_6ra80_dp_tia_generated").glob("*.scl")
    source.write_bytes(source.read_bytes().replace(b"B#16#", b"B#16#0", 1) + b"// mine\r\n")
    server.told("verify", {**asked, "origin": "disk", "faults": "none"})
    found = done(server)["result"]
    said = json.dumps(found["groups"]) + json.dumps(found["diagnostics"])
    assert not found["ok"]
    assert "Write files" in said
    assert not [command for command in ("--force", "run plcgen", "--oracle") if command in said]


def test_verification_of_an_older_folder_says_so_first(folder: Path, server: Server) -> None:
    """Files on disk of another state of the spec: PG504 leads; as they are made now they are of this one.

    Their difference is the spec's, not that of somebody who edited them.
    """
    asked = now(folder, FAQ)
    server.told("write", {**asked, "known": server.told("read", {"name": FAQ})["known"]})
    later = {**asked, "text": asked["text"].replace("100.0", "50.0")}
    assert later != asked
    files = server.told("becomes", later)["files"]
    assert [one["path"] for one in files if one["state"] == "changed"]
    assert [one["path"] for one in files if one["foreign"]] == []
    for given, stale in (
        ({**asked, "origin": "disk"}, False), ({**later, "origin": "disk"}, True), ({**later, "origin": "made"}, False),
    ):  # fmt: skip
        server.told("verify", {**given, "faults": "none"})
        assert done(server)["result"]["stale"] == stale


def test_what_the_page_says_names_no_commands(folder: Path, server: Server) -> None:
    """The guide after writing; the remedy of a parameter that a drive lacks, and of a folder that is no one's to write:
    buttons and views of the page, no options of a shell.
    """
    asked = now(folder, PUMP)
    known = server.told("read", {"name": PUMP})["known"]
    guide = server.told("write", {**asked, "known": known})["guide"]
    assert "addresses that **Panel** prints" in " ".join(guide.split())
    lacking = (
        "plc: {name: a, family: s7-1500, toolchain: tia-v19}\n"
        "drives: {d: {device: sinamics-s210, hardware_id: 270}}\njobs: {j: {drive: d, write: {P3981: 1}}}\n"
    )
    found = [
        one for one in server.told("check", {"name": "a.yaml", "text": lacking})["findings"] if one["code"] == "PG262"
    ]
    assert "the form beside the text searches" in found[0]["remedy"]
    (source,) = (folder / "s7-1500_g120_pn_generated").glob("*.scl")
    source.unlink()
    source.mkdir()
    problems = server.told("write", {**asked, "known": known})["problems"]
    assert [one["code"] for one in problems if one["severity"] == "error"] == ["PG501"]
    said = json.dumps([guide, found, problems])
    assert not re.findall(r"--(?:out|force|device)|plcgen (?:layout|generate|catalogue)", said)


def test_a_panel_begins_with_the_jobs(folder: Path, server: Server) -> None:
    """Their names as the data block has them, and the text lists of docs/hmi.md at the members they are for."""
    found = server.told("tags", now(folder, PUMP))
    assert found["jobs"] == ["setRamps", "readSpeed", "readFaults"]
    lists = {tag["symbolic"]: tag["list"] for block in found["blocks"] for tag in block["tags"]}
    assert lists['"DriveJobs".setRamps.status'] == "DriveJobStatus"
    assert lists['"DriveJobs".setRamps.diagnosis.recordStatus'] == "DriveRecordStatus"
    assert lists['"DriveJobs".setRamps.diagnosis.errors[2]'] == "DriveJobErrors"
    numbers = {name: one for name, one in lists.items() if one and ".status" not in name and ".diagnosis." not in name}
    assert numbers == {f'"DriveJobs".readFaults.faultCode[{at}]': "DriveFaults" for at in range(8)}
    for device, jobs, named in (
        ("sinamics-s120", "now: {drive: axis, faults: current}", "DriveFaults"),
        ("sinamics-s120", "now: {drive: axis, alarms: current}", "DriveAlarms"),
        ("profidrive", "now: {drive: axis, read: [r945]}", ""),
    ):
        found = server.told("tags", {"name": "b.yaml", "text": f"{drives_of(device)}jobs: {{{jobs}}}\n"})
        told = [(tag["symbolic"], tag["list"]) for block in found["blocks"] for tag in block["tags"]]
        shown = {
            one for name, one in told if one in {"DriveFaults", "DriveAlarms"} and name.startswith('"DriveJobs".now')
        }
        assert shown == ({named} if named else set())


def test_a_fault_by_hand_delays_the_job(folder: Path, server: Server) -> None:
    """The drive is busy five times more: the job needs more scans than without, and ends well. A wrong word is told."""
    took = []
    for fault in ({}, {"kind": "busy", "keys": {"times": "5"}}):
        server.told("load", now(folder, PUMP))
        if fault:
            server.told("strike", fault)
        server.told("put", {"text": "DriveJobs.setRamps.execute=TRUE"})
        found = server.told("step", {"scans": 200})["results"][0]
        assert found["ending"] == "done"
        took.append(found["scan"])
    assert took[1] > took[0]
    answer = server.ask("strike", {"kind": "no_such_fault", "keys": {}})
    assert (answer.status, "no_such_fault" in answer.text) == (422, True)


@pytest.mark.parametrize("name", [PUMP, PPI])
def test_a_fault_is_chosen_with_the_keys_that_count_for_it(name: str, folder: Path, server: Server) -> None:
    """Every kind with every value that is offered for a key is taken; others are refused, and why is told."""
    kinds = server.told("load", now(folder, name))["faults"]
    every = {key["key"]: key for kind in kinds for key in kind["keys"]}
    for kind in kinds:
        assert kind["text"]
        own = {key["key"] for key in kind["keys"]}
        given = {"status": "16#DE80B500"} if kind["kind"] == "status" else {}
        for key in kind["keys"]:
            values = [*key["choices"], *(value for value, _ in key["known"][:3]), key["default"]]
            for value in filter(None, values):
                server.told("strike", {"kind": kind["kind"], "keys": {**given, key["key"]: value}})
        for key in sorted(every.keys() - own):
            value = (every[key]["choices"] or [every[key]["default"] or "10"])[0]
            answer = server.ask("strike", {"kind": kind["kind"], "keys": {**given, key: value}})
            (problem,) = answer.json()["problems"]
            assert problem["message"] == f'"{key}" does nothing for the fault {kind["kind"]}'
    for keys in ({"times": "often"}, {"times": "2,after=1"}, {"no_such": "1"}):
        answer = server.ask("strike", {"kind": kinds[1]["kind"], "keys": keys})
        assert (answer.status, answer.json()["problems"][0]["code"]) == (422, "PG901"), keys


def test_inputs_of_a_job_have_type_unit_and_limits(folder: Path, server: Server) -> None:
    """List manuals: G220 p1135 is 0 to 5400 s, S120 p0003 = 3 is expert; what is set is what the drive gets."""
    jobs = "jobs: {stop: {drive: axis, write: {P1135: }}, level: {drive: unit, write: {P3: }}}\n"
    loaded = server.told("load", {"name": "a.yaml", "text": drives_of("sinamics-g220") + jobs})
    (stop,), (level,) = (job["inputs"] for job in loaded["jobs"])
    assert (stop["unit"], stop["low"], stop["high"]) == ("s", 0.0, 5400.0)
    assert ["expert", 3] in level["names"]
    loaded = server.told("load", now(folder, PUMP))
    (job,) = [one for one in loaded["jobs"] if one["key"] == "set_ramps"]
    (ramp, _) = job["inputs"]
    assert (ramp["name"], ramp["type"], ramp["unit"]) == ("rampUpTime", "REAL", "s")
    assert ramp["title"].startswith("P1120 ")
    assert loaded["inputs"][ramp["path"]] == "10.0"
    server.told("put", {"text": f"{ramp['path']}=2.5"})
    server.told("put", {"text": "DriveJobs.setRamps.execute=TRUE"})
    found = server.told("step", {"scans": 200})
    assert held(found)["pump.P1120"] == "2.5"
    assert found["inputs"][ramp["path"]] == "2.5"
    assert server.ask("put", {"text": f"{ramp['path']}=fast"}).status == 422
    loaded = server.told("load", now(folder, PPI))
    (job,) = [one for one in loaded["jobs"] if one["key"] == "setpoints"]
    assert [(one["name"], one["type"]) for one in job["inputs"]] == [("levelSetpoint", "REAL"), ("vw200", "WORD")]


def test_a_panel_gets_names_and_addresses(folder: Path, server: Server) -> None:
    """Members of DriveJobs and flags of the FAQ; a value of a telegram in an instance has the place that a panel has.

    DriveJobs begins with a structure of four bits, a word and the ramp times: they are at bytes 0, 2, 4 and 8.
    """
    tags = {tag["symbolic"]: tag for one in server.told("tags", now(folder, PUMP))["blocks"] for tag in one["tags"]}
    assert tags['"DriveJobs".setRamps.error']["absolute"] == "%DB472.DBX0.3"
    fields = server.told("becomes", now(folder, PUMP))["telegrams"][0]["request"]["fields"]
    assert [one["address"] for one in fields if one["name"] in {"rampUpTime", "rampDownTime"}] == [
        '"DriveJobs".setRamps.rampUpTime %DB472.DBD4',
        '"DriveJobs".setRamps.rampDownTime %DB472.DBD8',
    ]
    flags = [(one["absolute"], one["comment"]) for one in server.told("tags", now(folder, FAQ))["flags"]]
    assert [one for one in flags if "execute" in one[1]] == [
        ("%M50.0", "execute: read_ramp_up"),
        ("%M150.0", "execute: write_ramp_down"),
    ]


def test_text_lists_are_those_of_the_command(folder: Path, server: Server) -> None:
    """With the messages of the drives of the spec; of a spec without drives there are none."""
    given = {**now(folder, PUMP), "languages": ["de-DE"], "formats": ["csv", "xml"]}
    answer = server.request("POST", f"/{TOKEN}/ask/texts", [json.dumps(given).encode()])
    with zipfile.ZipFile(io.BytesIO(answer.data)) as archive:
        table = archive.read("text_lists.csv").decode("utf-8-sig")
    assert {line.partition(";")[0] for line in table.splitlines()[1:]} >= {"DriveJobStatus", "DriveFaults"}
    for more in ({"languages": ["fr-FR"]}, {"languages": []}, now(folder, PPI)):
        assert server.ask("texts", {**given, **more}).status == 422


def test_a_lock_tells_what_an_edit_moves(folder: Path, server: Server) -> None:
    """None, written, the same, moved; that of another spec of the folder is left alone."""
    asked = now(folder, PUMP)
    assert not server.told("lock", asked)["there"]
    known = server.told("read", {"name": PUMP})["known"]
    assert server.told("relock", {**asked, "known": known})["ok"]
    same = server.told("lock", asked)
    assert (same["there"], same["changes"]["rows"], same["problems"]) == (True, [], [])
    edited = now(folder, PUMP, "write: {P1120: null, P1121: null}", "write: {P1121: null}")
    moved = server.told("lock", edited)
    assert moved["changes"]["sentences"][0][1] == "set_ramps"
    rows = json.dumps(moved["changes"]["rows"])
    assert "rampDownTime" in rows
    assert not [word for word in ("--verbose", "--fail-on", str(folder)) if word in rows]
    other = server.told("lock", now(folder, FAQ))
    assert (other["there"], other["lock"]) == (False, "s7-300_6ra80_dp_tia.lock.json")


def test_dropped_files_say_what_they_are(folder: Path, server: Server) -> None:
    """Telegrams as text or bytes, a STATUS, codes; blocks and specs are none of these."""
    request = "03 01 02 01 10 01 C4 7F 00 00"
    files = {
        "a.txt": f"{request}\n".encode(),
        "b.bin": bytes.fromhex(request.replace(" ", "")),
        "c.log": b"DF80B500\r\n0301020110 01C47F0000 > 03010201\r\n",
        "d.txt": b"F30001\nPG209\nr945\n",
        "e.scl": b"DATA_BLOCK DB1\nSTRUCT a : INT; END_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n",
        "f.yaml": (folder / PUMP).read_bytes(),
        "g.txt": b"",
    }
    given = {name: base64.b64encode(data).decode() for name, data in files.items()}
    found = server.told("look", {"files": given})
    assert found["files"] == dict(zip(files, ["lines"] * 4 + ["blocks"] * 3, strict=True))
    assert found["lines"][:2] == [request, request]
    for line in found["lines"]:
        server.told("explain", {"text": line})


def test_hand_written_blocks_are_held_against_the_text(folder: Path, server: Server, tmp_path: Path) -> None:
    """Those of the FAQ fit; with another parameter in the editor they do not."""
    (source,) = api.generate(folder / FAQ, tmp_path / "out").folder.glob("*.scl")
    good = server.told("audit", {**now(folder, FAQ), "files": packed(source)})
    assert good["ok"], good["text"]
    bad = server.told("audit", {**now(folder, FAQ, "P50303", "P50305"), "files": packed(source)})
    assert not bad["ok"]


def test_partners_can_be_changed_by_hand(folder: Path, server: Server) -> None:
    """A parameter of a drive, a byte of an S7-200: what the job reads then is what was set."""
    server.told("load", now(folder, PUMP))
    found = server.told("put", {"text": "pump.r21=123.5"})
    assert held(found)["pump.r21"] == "123.5"
    server.told("put", {"text": "DriveJobs.readSpeed.execute=TRUE"})
    (speed,) = [one for one in server.told("step", {"scans": 200})["results"] if one["job"] == "read_speed"]
    assert [one["value"] for one in speed["values"]] == [123.5]
    for text in ("pump.P1120=many", "pump.P1120[9]=1", "Nothing.here=1", "nonsense"):
        assert server.ask("put", {"text": text}).status == 422, text
    loaded = server.told("load", now(folder, PPI))
    server.told("put", {"text": "pumps/3:VB100=77"})
    (job,) = [one for one in loaded["jobs"] if one["key"] == "read_vb100"]
    server.told("put", {"text": f"{job['execute']}=TRUE".replace('"', "")})
    (read,) = [one for one in server.told("step", {"scans": 200})["results"] if one["job"] == "read_vb100"]
    assert (read["ending"], [one["value"] for one in read["values"]]) == ("done", [77])


def test_values_of_partners_have_a_title_a_unit_and_a_place(folder: Path, server: Server) -> None:
    """List manual of the G120: r21 in rpm, p1120 in s; of an array the element that is set, of bits the whole word."""
    text = now(folder, PUMP)["text"].replace("read: [actual_speed]", "read: [actual_speed, r52.3]")
    found = {one["name"]: one for one in server.told("load", {"name": PUMP, "text": text})["partners"]}
    assert (found["pump.r21"]["unit"], found["pump.P1120"]["unit"]) == ("rpm", "s")
    assert found["pump.P1120"]["title"] == "Ramp-function generator ramp-up time"
    assert {"pump.r945[0]", "pump.r52"} <= found.keys()
    for name, one in found.items():
        assert held(server.told("put", {"text": f"{name}={one['value']}"}))[name] == one["value"]


def test_a_review_may_be_compared_with_what_is_there(folder: Path, server: Server) -> None:
    """Folders with a spec of the name, generated ones, other specs, then commits and branches if there is git."""
    (folder / "old").mkdir()
    shutil.copy(folder / FAQ, folder / "old" / FAQ)
    api.generate(folder / FAQ)
    names = ["old", "s7-300_6ra80_dp_tia_generated", f"old/{FAQ}", PPI, PUMP]
    assert sorted(name for name, _ in server.told("bases", {"name": FAQ})["bases"]) == sorted(names)
    for command in (["init", "-qb", "line2"], ["add", "."], ["commit", "-qm", "as delivered"]):
        subprocess.run(["git", "-c", "user.name=A", "-c", "user.email=a@example.org", *command], cwd=folder, check=True)
    told = server.told("bases", {"name": FAQ})["bases"][len(names) :]
    assert [(name, text.partition(" ")[2]) for name, text in told][1:] == [("line2", "as delivered")]
    assert server.ask("bases", {"name": "../x.yaml"}).status == 422


def test_a_folder_that_is_compared_is_not_called_by_the_same_name_twice(folder: Path, server: Server) -> None:
    """What is made now against what lies on disk: both sides say which they are, and no option is named."""
    api.generate(folder / FAQ)
    server.told(
        "review", {**now(folder, FAQ, "P50304: 100.0", "P50304: 50.0"), "base": "s7-300_6ra80_dp_tia_generated"}
    )
    text = server.get(f"/{TOKEN}/made/{done(server)['result']['page']}").text
    assert "s7-300_6ra80_dp_tia_generated &rarr; made now" in text
    assert "as they are made now" in text
    assert "--against" not in text


def test_verification_has_progress_and_an_end(folder: Path, server: Server) -> None:
    """All checks of the files as they are made, nothing written; only one at a time."""
    server.told("verify", {**now(folder, FAQ), "faults": "none"})
    found = done(server)["result"]
    assert (found["ok"], found["summary"].get("error", 0)) == (True, 0)
    assert not (folder / "s7-300_6ra80_dp_tia_generated").exists()


@pytest.mark.slow
def test_verification_can_be_cancelled(folder: Path, server: Server) -> None:
    """It ends at its next part, and another one may begin."""
    server.told("verify", {**now(folder, PUMP), "faults": "full"})
    assert server.ask("verify", now(folder, PUMP)).status == 422
    server.told("cancel")
    assert done(server) | {"number": 0} == done(server) | {"number": 0, "cancelled": True, "result": None}
    server.told("verify", {**now(folder, FAQ), "faults": "none"})
    assert done(server)["result"]["ok"]


def test_what_runs_is_the_text_of_the_editor(folder: Path, server: Server) -> None:
    """P1121 is 5.0 in the editor alone: the run writes it, verification finds it right, nothing is on disk."""
    edited = now(folder, PUMP, "P1121: null", "P1121: 5.0")
    server.told("load", edited)
    server.told("put", {"text": "DriveJobs.setRamps.execute=TRUE"})
    found = server.told("step", {"scans": 200})
    assert held(found)["pump.P1121"] == "5.0"
    server.told("verify", {**edited, "faults": "none"})
    assert done(server)["result"]["ok"]
    new = {"name": "new.yaml", "text": edited["text"]}
    server.told("load", new)
    assert sorted(one.name for one in folder.iterdir()) == sorted([FAQ, PUMP, PPI])


@pytest.mark.slow
def test_a_failed_check_opens_its_run(folder: Path, server: Server) -> None:
    """A channel that never tells an error: the check names the run, the run ends in the scan that is told."""
    asked = {**now(folder, FAQ), "known": server.told("read", {"name": FAQ})["known"]}
    server.told("write", asked)
    (file,) = (folder / "s7-300_6ra80_dp_tia_generated").glob("*.scl")
    text = file.read_text("utf-8")
    broken = text.replace("#error := NOT #done;", "#error := FALSE;")
    assert broken != text
    file.write_text(broken, "utf-8")
    given = {"name": FAQ, "text": asked["text"], "origin": "disk"}
    server.told("verify", {**given, "faults": "quick"})
    found = done(server)["result"]
    failed = [one for group in found["groups"] for one in group["checks"] if one["runs"]]
    assert failed
    replayed = server.told(
        "replay", {**given, "check": failed[0]["id"], "scenario": next(iter(failed[0]["failed"]), "")}
    )
    assert replayed["failure"]["scan"] == replayed["scans"]
    assert replayed["failure"]["line"] > 0


def test_another_telegram_is_shown_beside_the_one_that_is_stated(folder: Path, server: Server) -> None:
    """FAQ 109750712 fig. 5-1 with P50304 (C480h) for P50303 (C47Fh): byte 7 of both differs, whatever the reference."""
    asked = {**now(folder, FAQ), "known": server.told("read", {"name": FAQ})["known"]}
    server.told("write", asked)
    (file,) = (folder / "s7-300_6ra80_dp_tia_generated").glob("*.scl")
    text = file.read_text("utf-8")
    assert text.count("16#C47F") == 1
    file.write_text(text.replace("16#C47F", "16#C480"), "utf-8")
    given = {"name": FAQ, "text": asked["text"], "origin": "disk"}
    server.told("verify", {**given, "faults": "none"})
    groups = done(server)["result"]["groups"]
    failed = next(check for group in groups for check in group["checks"] if check["runs"])
    found = server.told("replay", {**given, "check": failed["id"], "scenario": ""})
    sent, stated = (one.split() for one in found["telegrams"])
    assert (" ".join(sent[1:8]), " ".join(stated[1:8])) == ("01 02 01 10 01 C4 80", "01 02 01 10 01 C4 7F")
    assert [at for at, pair in enumerate(zip(sent, stated, strict=True)) if pair[0] != pair[1]] == [7]
    assert not [one for one in (failed["diagnostic"]["help"], str(groups)) if "docs/" in one]


@pytest.mark.slow
def test_what_all_jobs_do_to_each_other_opens_its_run(folder: Path, server: Server) -> None:
    """A unit whose first job always comes first: each job alone is right, and together not every one gets its turn.

    The run has signals of every job, telegrams of the drives, and ends in the scan that is told.
    """
    asked = {**now(folder, PUMP), "known": server.told("read", {"name": PUMP})["known"]}
    server.told("write", asked)
    (file,) = (folder / "s7-1500_g120_pn_generated").glob("*.scl")
    text = file.read_text("utf-8")
    broken = text.replace("#statSlot := #statSlot MOD #tempSlots + 1;", "#statSlot := #tempSlot;")
    assert broken != text
    file.write_text(broken, "utf-8")
    given = {"name": PUMP, "text": asked["text"], "origin": "disk"}
    server.told("verify", {**given, "faults": "quick"})
    checks = [one for group in done(server)["result"]["groups"] for one in group["checks"]]
    (together,) = [one for one in checks if one["runs"]]
    assert (together["id"], len(together["failed"]) > 0) == ("together", True)
    replayed = server.told("replay", {**given, "check": "together", "scenario": together["failed"][0]})
    assert replayed["scenario"] == together["failed"][0]
    assert sorted(replayed["jobs"]) == ["read_faults", "read_speed", "set_ramps"]
    assert any(True in row[1:2] for rows in replayed["jobs"].values() for row in rows)
    assert replayed["exchanges"]
    assert replayed["failure"]["scan"] <= replayed["scans"]


@pytest.mark.slow
def test_a_review_is_a_page_of_its_own(folder: Path, server: Server) -> None:
    """With the policy of a frame; no folder of the server is named on it."""
    server.told("review", now(folder, FAQ))
    number = done(server)["result"]["page"]
    answer = server.get(f"/{TOKEN}/made/{number}")
    assert (answer.status, "Review of" in answer.text) == (200, True)
    assert answer.headers["content-security-policy"].startswith("sandbox ")
    assert "bench/" not in answer.text
    looked = "the folder on disk was not looked at"
    assert looked in answer.text.partition("</h1>")[0]
    assert not [command for command in ("--against", "--oracle") if command in answer.text]
    assert server.get(f"/{TOKEN}/made/{number + 1}").status == 404
    asked = now(folder, FAQ)
    server.told("write", {**asked, "known": server.told("read", {"name": FAQ})["known"]})
    server.told("review", {**asked, "origin": "disk"})
    assert looked not in server.get(f"/{TOKEN}/made/{done(server)['result']['page']}").text


def packed(*paths: Path) -> dict[str, str]:
    """Files as they are dropped."""
    return {path.name: base64.b64encode(path.read_bytes()).decode() for path in paths}


def test_tools_take_what_is_dropped(folder: Path, server: Server, tmp_path: Path) -> None:
    """Layout, SimaticML of both families, a comparison: sources of the FAQ project."""
    made = api.generate(folder / FAQ, tmp_path / "out").folder
    (source,) = made.glob("*.scl")
    page = server.told("layout", {"files": packed(source)})["page"]
    assert "WR_DataBuffer" in server.get(f"/{TOKEN}/made/{page}").text
    xml = server.told("convert", {"files": packed(source), "to": "xml", "version": "V16", "classic": True})
    assert any(one["path"].endswith(".xml") for one in xml["files"]), xml["problems"]
    assert zipfile.ZipFile(io.BytesIO(base64.b64decode(xml["archive"]))).namelist() == [
        one["path"] for one in xml["files"]
    ]
    old = packed(source)
    source.write_text(source.read_text("utf-8").replace("Para_No", "Para_Number"), "utf-8")
    found = server.told("diff", {"old": old, "files": packed(source)})
    assert "Para_Number" in str(found["changes"]["rows"])


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("03 01 02 01 10 01 C4 7F 00 00", "50303"),
        ("0301020110 01C47F0000 > 0301020108014120 0000", "10.0"),
        ("DF80B500", "state conflict"),
        ("16#DF80B500", "state conflict"),
        ("PG209", "PG209"),
        ("F30001", "overcurrent"),
        ("0x11", "11"),
    ],
)
def test_explain_knows_what_a_line_is(server: Server, text: str, wanted: str) -> None:
    """A telegram, a request with its answer, a STATUS, codes, messages, errors."""
    assert wanted in str(server.told("explain", {"text": text}))


def test_what_nobody_knows_is_said(server: Server) -> None:
    """With what could have been meant."""
    answer = server.ask("explain", {"text": "hello"})
    assert (answer.status, "hexadecimal" in answer.text) == (422, True)


def test_a_new_spec_is_text_until_it_is_saved(folder: Path, server: Server) -> None:
    """Of a drive and of a PPI line: without errors, and not on disk."""
    for device, family in (("sinamics-g120", "s7-1500"), ("ppi", "s7-1200"), ("sinamics-dcm", "s7-300")):
        found = server.told(
            "new", {"name": "job.yaml", "given": {"device": device, "family": family, "toolchain": "tia-v17"}}
        )
        problems = server.told("check", {"name": "job.yaml", "text": found["text"]})["findings"]
        assert [one["message"] for one in problems if one["severity"] == "error"] == []
        assert not (folder / "job.yaml").exists()
    assert server.ask("new", {"name": PUMP, "given": {}}).status == 422


@pytest.mark.parametrize("device", ["sinamics-g120", "sinamics-dcm", "ppi"])
@pytest.mark.parametrize("family", ["s7-300", "s7-1500"])
def test_a_new_spec_has_the_names_and_numbers_that_were_asked_for(device: str, family: str, server: Server) -> None:
    """Name of the station and of the partner, its address, the drive object; nothing else changes."""
    given = {"device": device, "family": family, "toolchain": "tia-v17", "title": "Mill 2", "key": "roller"}
    text = server.told("new", {"name": "a.yaml", "given": {**given, "address": "301", "drive_object": "4"}})["text"]
    data = load_yaml(text, "a.yaml").data()
    assert data["plc"]["name"] == "Mill 2"
    if device == "ppi":
        assert data["ppi"]["line"]["stations"] == {"roller": {"address": 301}}
        assert {job["station"] for job in data["ppi"]["line"]["jobs"].values()} == {"roller"}
        return
    where = "address" if family == "s7-300" else "hardware_id"
    assert data["drives"] == {"roller": {"device": device, where: 301, "drive_object": 4}}
    assert {job["drive"] for job in data["jobs"].values()} == {"roller"}
    assert server.ask("new", {"name": "a.yaml", "given": {**given, "title": "a: b"}}).status == 422
    assert server.ask("new", {"name": "a.yaml", "given": {**given, "key": "a b"}}).status == 422


def test_what_was_typed_and_given_up_counts_for_no_other_spec(folder: Path, server: Server) -> None:
    """A part that was edited and left unsaved is as on disk when the spec that includes it is opened."""
    (folder / "part.yaml").write_text("drives: {axis: {device: sinamics-s120, hardware_id: 270, drive_object: 3}}\n")
    (folder / "main.yaml").write_text(
        "plc: {name: A, family: s7-1500, toolchain: tia-v19}\ninclude: [part.yaml]\n"
        "jobs: {a: {drive: axis, read: [r21]}}\n"
    )
    server.told("check", {"name": "part.yaml", "text": "drives: {other: {device: sinamics-s120, hardware_id: 270}}\n"})
    read = server.told("read", {"name": "main.yaml"})
    found = server.told("check", {"name": "main.yaml", "text": read["text"]})["findings"]
    assert [one["message"] for one in found if one["severity"] == "error"] == []
