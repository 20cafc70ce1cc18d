"""What the page asks and gets: the text as it is typed, what it becomes, runs, verification, tools."""

from __future__ import annotations

import base64
import io
import shutil
import time
import zipfile
from pathlib import Path
from typing import Any

import pytest

from plcgen import api
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


def test_every_kind_of_job_that_the_form_offers_can_be_had(server: Server) -> None:
    """Of a control unit, which has a clock; each alone is a spec without errors."""
    text = (
        "plc: {name: Press, family: s7-1500, toolchain: tia-v19}\n"
        "drives:\n  axis: {device: sinamics-s120, hardware_id: 270, drive_object: 3}\n"
        "  unit: {device: sinamics-s120, hardware_id: 271, drive_object: 1}\n"
    )
    for kind in server.told("folder")["kinds"]:
        given = {"key": "one", "kind": kind, "drive": "unit" if kind == "clock" else "axis"}
        made = changed(server, {"name": "a.yaml", "text": text}, "job", given)
        found = server.told("check", {"name": "a.yaml", "text": made})["findings"]
        assert [one["message"] for one in found if one["severity"] == "error"] == [], kind


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
    assert {one["state"] for one in server.told("becomes", asked)["files"]} == {"new"}
    known = server.told("read", {"name": FAQ})["known"]
    written = server.told("write", {**asked, "known": known})
    assert (written["ok"], written["folder"]) == (True, "s7-300_6ra80_dp_tia_generated")
    assert {one["state"] for one in server.told("becomes", asked)["files"]} == {"same"}
    edited = now(folder, FAQ, "P50304: 100.0", "P50304: 50.0")
    states = {one["path"]: one["state"] for one in server.told("becomes", edited)["files"]}
    (changed,) = [path for path, state in states.items() if state == "changed" and path.endswith(".scl")]
    diff = server.told("part", {**edited, "path": changed})["diff"]
    assert any(line.startswith("+") and "50.0" in line for line in diff.splitlines())


def test_the_archive_holds_what_generate_writes(folder: Path, server: Server, tmp_path: Path) -> None:
    """Byte for byte, and nothing is on disk afterwards."""
    import json

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
    done = server.told("write", {**asked, "text": asked["text"].replace("100.0", "50.0")})
    assert (done["ok"], [one["code"] for one in done["problems"] if one["severity"] == "error"]) == (False, ["PG502"])
    assert file.read_text("utf-8") == "mine"


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
    for fault in ("", "error:number=0x11"):
        if fault:
            server.told("strike", {"text": fault})
        server.told("put", {"text": '"DriveJobs".setRamps.execute := TRUE'})
        found = server.told("step", {"scans": 200})["results"][0]
        ended.append((found["ending"], found["status"]))
        server.told("put", {"text": "DriveJobs.setRamps.execute=FALSE"})
        server.told("step", {"scans": 5})
    assert ended == [("done", "0000"), ("error", "8401")]


def test_a_fault_by_hand_delays_the_job(folder: Path, server: Server) -> None:
    """The drive is busy five times more: the job needs more scans than without, and ends well. A wrong word is told."""
    took = []
    for fault in ("", "busy:times=5"):
        server.told("load", now(folder, PUMP))
        if fault:
            server.told("strike", {"text": fault})
        server.told("put", {"text": "DriveJobs.setRamps.execute=TRUE"})
        found = server.told("step", {"scans": 200})["results"][0]
        assert found["ending"] == "done"
        took.append(found["scan"])
    assert took[1] > took[0]
    answer = server.ask("strike", {"text": "no_such_fault"})
    assert (answer.status, "no_such_fault" in answer.text) == (422, True)


def test_partners_can_be_changed_by_hand(folder: Path, server: Server) -> None:
    """A parameter of a drive, a byte of an S7-200: what the job reads then is what was set."""
    server.told("load", now(folder, PUMP))
    found = server.told("put", {"text": "pump.r21=123.5"})
    assert {name: value for name, _, value in found["partners"]}["pump.r21"] == "123.5"
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


def test_a_run_needs_a_saved_spec(folder: Path, server: Server) -> None:
    """What runs reads the file: an unsaved text would be passed over."""
    answer = server.ask("load", now(folder, PUMP, "P1121: null", "P1121: 5.0"))
    assert (answer.status, "not saved" in answer.text) == (422, True)


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
    assert replayed["failure"]["scan"] == replayed["calls"][-1][0]
    assert replayed["failure"]["line"] > 0


@pytest.mark.slow
def test_a_review_is_a_page_of_its_own(folder: Path, server: Server) -> None:
    """With the policy of a frame; no folder of the server is named on it."""
    server.told("review", now(folder, FAQ))
    number = done(server)["result"]["page"]
    answer = server.get(f"/{TOKEN}/made/{number}")
    assert (answer.status, "Review of" in answer.text) == (200, True)
    assert answer.headers["content-security-policy"].startswith("sandbox ")
    assert "bench/" not in answer.text
    assert server.get(f"/{TOKEN}/made/{number + 1}").status == 404


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
    assert "Para_Number" in found["text"]


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
