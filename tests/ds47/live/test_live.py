"""plcgen live against python-snap7's server. It proves our side of the mapping: which bytes are asked for, what is
made of those that come, that nothing is written, and that nobody can keep us waiting.
"""

from __future__ import annotations

import ast
import contextlib
import json
import socket
import threading
from pathlib import Path

import pytest
from click.testing import CliRunner

from plcgen.cli.main import run
from plcgen.ds47 import live
from plcgen.ds47.device import Parameter
from plcgen.ds47.live.connection import S7Connection, S7Partner
from plcgen.ds47.live.parameters import element_address, element_value
from tests.ds47.live.servers import DriveServer, cpu, running

TEN = bytes.fromhex("41 20 00 00")  # 10.0 = 1.25 * 2 ** 3: exponent 130, fraction .25


def plcgen(*words: str) -> tuple[int, str, str]:
    """Exit code, stdout, stderr."""
    with CliRunner().isolation() as streams:
        code = run([*words])
        return code, streams[0].getvalue().decode(), streams[1].getvalue().decode()


def test_addresses():
    """node-red-contrib-s7 issue 28: r2114[0] and r2114[1] of the control unit are DB2114 DWORD1024 and DWORD1025."""
    assert [element_address(1, index) for index in (0, 1)] == [1024, 1025]
    assert element_address(3, 7) == 3 * 1024 + 7
    with pytest.raises(ValueError, match="1023"):
        element_address(1, 1024)


def test_read():
    """One request an element, at 1024 x drive object + index, with the size of the type."""
    drive = DriveServer({(1120, 1024): TEN, (947, 1024): b"\x1e\xdd", (947, 1025): b"\0\0", (52, 1024): b"\x03\xe8"})
    with running(drive) as where:
        words = ("P1120", "r947[0..1]", "r0052:Unsigned16", "--drive", where, "--device", "sinamics-g120")
        code, out, err = plcgen("live", "read", *words)
    assert (code, err) == (0, "")
    assert drive.asked == [(1120, 1024, 4), (947, 1024, 2), (947, 1025, 2), (52, 1024, 2)]
    lines = [line.split() for line in out.splitlines()]
    assert lines[2][:4] == ["P1120[0]", "10", "s", "41"]
    assert lines[3][:4] == ["r947[0]", "7901", "1E", "DD"]
    assert lines[5][:2] == ["r52[0]", "1000"]
    assert "FloatingPoint (inferred)" in out.splitlines()[2]  # nobody has read the type of P1120 in a G120
    assert "Unsigned16" in lines[5]


def test_what_a_drive_says_of_itself_can_be_imported(tmp_path: Path):
    """21 = 0015h and 2941 = 0B7Dh, then the 0 with which the list ends."""
    numbers = {(980, 1024 + at): bytes.fromhex(data) for at, data in enumerate(("00 15", "0B 7D", "00 00"))}
    with running(DriveServer(numbers)) as where:
        words = ("r980[0..2]", "--drive", where, "--device", "sinamics-g120")
        (tmp_path / "list.txt").write_text(plcgen("live", "read", *words)[1], "utf-8")
    code, out, err = plcgen("catalogue", "import", str(tmp_path / "list.txt"), "--device", "sinamics-g120", "--json")
    assert (code, err) == (0, "")
    found = json.loads(out)
    assert (found["known"], found["unknown"], found["ended"]) == (["r21"], ["2941"], True)


def test_the_drive_object_is_part_of_the_address():
    """--do 2; the type of r0021 is the same in every device that knows it, so none has to be named."""
    drive = DriveServer({(21, 2048): bytes.fromhex("44 7A 00 00")})  # 1000.0 = 1.953125 * 2 ** 9
    with running(drive) as where:
        code, out, _ = plcgen("live", "read", "r0021", "--drive", where, "--do", "2", "--json")
    assert code == 0
    assert json.loads(out)["parameters"][0]["value"] == "1000"


def test_a_source_is_shown_as_one():
    """gilgab/python-sinamics: P0840 of a G120 connected to r2090.0 was read as 082A FC00."""
    drive = DriveServer({(840, 1024): bytes.fromhex("08 2A FC 00")})
    with running(drive) as where:
        _, out, _ = plcgen("live", "read", "P840[0]", "--drive", where, "--device", "sinamics-g120")
    assert "r2090.0" in out


@pytest.mark.parametrize(
    ("type_", "data", "doubt"),
    [
        ("FloatingPoint", "7F 80 00 00", "not a finite number"),
        ("FloatingPoint", "7F C0 00 00", "not a finite number"),
        ("FloatingPoint", "00 00 03 E8", "the type is probably another one"),
        ("FloatingPoint", "C1 20 00 00", "outside the limits 0..100"),
        ("Unsigned16", "00 65", "outside the limits"),
        ("Unsigned32", "00 01", "2 bytes were received"),
        ("Boolean", "07", "neither 0 nor 1"),
        ("VisibleString[2]", "41 07", "cannot be printed"),
    ],
)
def test_what_cannot_be_a_value_is_none(type_, data, doubt):
    """Infinity, NaN, 1000 taken for a REAL (1.4e-42), -10 below 0, 101 above 100, a wrong length, odd characters."""
    found = element_value(Parameter(1, type_, minimum=0, maximum=100), 0, bytes.fromhex(data))
    assert (found.value, found.text) == (None, "")
    assert doubt in found.doubt


def test_a_doubtful_answer_is_an_error_and_shown_as_bytes():
    """The reader sees what came, and no value."""
    drive = DriveServer({(21, 1024): b"\xff\xff\xff\xff"})
    with running(drive) as where:
        code, out, err = plcgen("live", "read", "r21", "r945[0]", "--drive", where, "--device", "sinamics-g120")
    assert code == 1
    assert "?" in out
    assert "FF FF FF FF" in out
    assert err.count("PG706") == 2  # the other one was refused
    assert "refused" in err


SPEC = """\
plc: {name: A, family: s7-300, toolchain: tia-v16, names: faq}
drives:
  fan: {device: sinamics-g120, address: 256}
jobs:
  ramps: {drive: fan, write: {P1120: 10.0, P1121: null}, request: {db: 5}, response: {db: 6}}
"""


@pytest.fixture
def spec(tmp_path: Path) -> str:
    """A job with a constant and an input, in data blocks with numbers."""
    path = tmp_path / "job.yaml"
    path.write_text(SPEC, "utf-8")
    return str(path)


@pytest.mark.parametrize(("found", "code"), [("41 20 00 00", 0), ("41 20 00 01", 0), ("41 40 00 00", 1)])
def test_compare(spec, found, code):
    """10.0 is there, in the next REAL, or 12.0 is; an input is told and never wrong."""
    drive = DriveServer({(1120, 1024): bytes.fromhex(found), (1121, 1024): bytes.fromhex("42 C8 00 00")})
    with running(drive) as where:
        result, out, err = plcgen("live", "compare", spec, "--drive", where)
    assert result == code
    assert ("PG707" in err) == bool(code)
    rows = [line.split() for line in out.splitlines()]
    assert rows[2][-1] == "input"
    assert rows[1][-1] == ("deviates" if code else "equal")


def test_compare_needs_to_know_which_drive(spec):
    """A name that the spec has not; nothing is asked."""
    assert plcgen("live", "compare", spec, "--drive", "pump=127.0.0.1")[0] == 2


NO_DRIVE_JOBS = """\
plc: {name: A, family: s7-1200, toolchain: tia-v19}
ppi: {p: {module: cm1241, port: 270, stations: {s: {address: 2}}, jobs: {j: {station: s, read: [VB1]}}}}
drives: """


@pytest.mark.parametrize("drives", ["{}", "{fan: {device: sinamics-g120, hardware_id: 270}}"])
@pytest.mark.parametrize(
    "words",
    [
        ("live", "compare", "job.yaml", "--drive", "127.0.0.1"),
        ("live", "db", "job.yaml", "--cpu", "127.0.0.1", "--all"),
    ],
)
def test_a_spec_without_drive_jobs(tmp_path, monkeypatch, drives, words):
    """Its section of drives is empty, or nothing is done with them: it is said before anybody is asked."""
    monkeypatch.chdir(tmp_path)
    Path("job.yaml").write_text(NO_DRIVE_JOBS + drives + "\n", "utf-8")
    code, out, err = plcgen(*words)
    assert (code, out) == (2, "")
    assert err.startswith("error[PG901]: job.yaml has no drive jobs\n")


REQUEST = bytes.fromhex("01 02 01 02 10 01 04 60 00 00 10 01 04 61 00 00 08 01 41 20 00 00 08 01 00 00 00 00")
"""By hand: change, object 1, two parameters; 1120 = 0460h, 1121 = 0461h; FloatingPoint 10.0, FloatingPoint 0.0."""


@pytest.mark.parametrize(
    ("request_", "response", "code", "told"),
    [
        (REQUEST, bytes(16), 0, ""),
        (b"\x2a" + REQUEST[1:24] + TEN, bytes(16), 0, ""),  # another reference, another value of the input
        (REQUEST[:7] + b"\x61" + REQUEST[8:], bytes(16), 1, "04 61, not 04 60"),
        (REQUEST + bytes(4), bytes(16), 1, "more than 28 bytes"),
        (REQUEST, bytes(10), 1, "missing, shorter"),
    ],
)
def test_data_blocks(spec, request_, response, code, told):
    """Constants and lengths count; 4 + 6 * 2 = 16 bytes hold the longest answer to two parameters."""
    with running(cpu({5: request_, 6: response})) as where:
        result, _, err = plcgen("live", "db", spec, "--cpu", where)
    assert (result, told in err) == (code, True), err


STORED = """\
plc: {name: A, family: s7-300, toolchain: step7-v5}
drives:
  fan: {device: sinamics-g120, address: 256}
recipes: {winding: {parameters: [P1120, P1121], records: {slow: {P1120: 5.0, P1121: 2.0}, fast: {P1120: 1.0}}}}
jobs:
  down: {drive: fan, read_recipe: winding}
"""
RECORDS = bytes.fromhex("40 A0 00 00 40 00 00 00 3F 80 00 00 41 20 00 00")
"""By hand: 5.0 and 2.0, 1.0 and the factory setting 10.0 as REAL."""


@pytest.mark.parametrize(
    ("records", "control", "told"),
    [
        (RECORDS, bytes(18), ["equal", "equal", "equal"]),
        (RECORDS[:15] + b"\x01", bytes(18), ["equal", "as it is now", "equal"]),
        (RECORDS + bytes(4), bytes(18), ["deviates", "equal", "equal"]),
        (RECORDS, bytes(16), ["equal", "equal", "deviates"]),
    ],
)
def test_commands_and_recipes(tmp_path, records, control, told):
    """DB474 has two records of two REAL; DB472 18 bytes: four BOOL, a pad, a WORD, an INT, six words of diagnosis."""
    (tmp_path / "job.yaml").write_text(STORED, "utf-8")
    with running(cpu({472: control, 474: records})) as where:
        _, out, _ = plcgen("live", "db", str(tmp_path / "job.yaml"), "--cpu", where, "--json")
    rows = [row for row in json.loads(out)["rows"] if row["subject"].startswith(("DB472", "DB474"))]
    assert [row["verdict"] for row in rows] == told


def test_nothing_to_compare_is_no_success(tmp_path):
    """Blocks compiled in the TIA Portal have numbers of its own: nobody is asked, unless --all says so."""
    path = tmp_path / "job.yaml"
    path.write_text(STORED.replace("step7-v5", "tia-v16"), "utf-8")
    with running(cpu({})) as where:
        code, out, err = plcgen("live", "db", str(path), "--cpu", where)
        assert (code, out) == (2, "")
        assert "--all" in err
        code, out, _ = plcgen("live", "db", str(path), "--cpu", where, "--all", "--json")
    assert (code, {row["verdict"] for row in json.loads(out)["rows"]}) == (1, {"deviates"})


def test_what_is_not_asked_is_named(spec):
    """The others have a number that the spec does not give."""
    with running(cpu({5: REQUEST, 6: bytes(16)})) as where:
        _, out, _ = plcgen("live", "db", spec, "--cpu", where, "--json")
    assert '"DriveJobs" (--all asks)' in json.loads(out)["skipped"]


def test_nobody_there():
    """A closed port is one line, no traceback."""
    code, _, err = plcgen("live", "read", "r21", "--drive", "127.0.0.1:1")
    assert code == 1
    assert "PG705" in err
    assert "Traceback" not in err


@pytest.mark.parametrize("drip", [b"", b"\x03\x00\x00\x16" * 3, b"GET / HTTP/1.1\r\n" * 4])
def test_nobody_keeps_us_waiting(drip):
    """A server that says nothing, or something else: the clock of the connection ends it."""
    with socket.create_server(("127.0.0.1", 0)) as server:

        def talk() -> None:
            other, _ = server.accept()
            with other, contextlib.suppress(OSError):
                other.sendall(drip)
                while other.recv(100):
                    pass

        thread = threading.Thread(target=talk, daemon=True)
        thread.start()
        where = f"127.0.0.1:{server.getsockname()[1]}"
        code, _, err = plcgen("live", "read", "r21", "--drive", where, "--timeout", "0.3")
        thread.join(5)
    assert not thread.is_alive()
    assert (code, "PG705" in err) == (1, True), err


def test_nothing_can_write():
    """The code of this package and its verbs names four methods of python-snap7's client, none of which writes."""
    used: set[str] = set()
    folder = Path(live.__path__[0])
    for path in (*folder.glob("*.py"), *(folder.parents[2] / "cli" / "live").glob("*.py")):
        tree = ast.parse(path.read_text("utf-8"))
        if path.name != "connection.py":
            assert "snap7" not in path.read_text("utf-8").replace("python-snap7", ""), path
        used |= {
            node.attr
            for node in ast.walk(tree)
            if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "self._client"
        }
    assert used == {"connect", "disconnect", "read_area", "get_connected", "connection"}


def test_the_server_sees_no_write(spec):
    """Events of a run of all three verbs: reads alone."""
    drive = DriveServer({(1120, 1024): TEN, (1121, 1024): TEN})
    controller = cpu({5: REQUEST, 6: bytes(16)})
    seen: list[int] = []
    for server in (drive, controller):
        server.set_events_callback(lambda event: seen.append(event.EvtCode))
    with running(drive) as where, running(controller) as plc:
        plcgen("live", "read", "P1120", "--drive", where, "--device", "sinamics-g120")
        plcgen("live", "compare", spec, "--drive", where)
        plcgen("live", "db", spec, "--cpu", plc)
    assert 0x00020000 in seen
    assert 0x00040000 not in seen


def test_without_python_snap7(monkeypatch):
    """The core does not need it; the verb says what to install."""
    monkeypatch.setitem(__import__("sys").modules, "snap7.client", None)
    code, _, err = plcgen("live", "read", "r21", "--drive", "127.0.0.1")
    assert (code, "plcgen[live]" in err) == (1, True)


def test_rack_and_slot_of_a_drive():
    """0 and 0, as sinamics-monitoring and python-sinamics have it."""
    with running(DriveServer({})) as where:
        host, _, port = where.partition(":")
        with S7Connection(S7Partner(host, int(port))) as connection:
            assert connection._client.remote_tsap & 0xFF == 0


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("r64999",), "there is no type of any device for r64999"),
        (("r21[1024]",), "from 0 to 1023"),
        (("P1120:Real99",), "Real99"),
        (("actual_speed",), "names belong to a device"),
        (("P1120..3",), "not a parameter"),
    ],
)
def test_words_that_are_no_parameter(words, told):
    """Said before anybody is asked."""
    code, _, err = plcgen("live", "read", *words, "--drive", "127.0.0.1:1")
    assert code == 1
    assert told in err
