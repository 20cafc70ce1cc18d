"""The verbs of ``plcgen live`` over PROFINET, on a UDP port of this machine; writes are counted at the device."""

from __future__ import annotations

import json
import signal
import struct
import subprocess
import sys
import time
from pathlib import Path

import pytest

from plcgen.ds47.device import Parameter
from plcgen.ds47.live import backup
from plcgen.ds47.live.draft import Draft
from plcgen.ds47.live.messages import title
from plcgen.ds47.live.parameters import element_value
from plcgen.ds47.sim.behaviour import Behaviour
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.sim.listed import listed_drive
from plcgen.ds47.sim.parameters import DriveObject, SimulatedParameter
from plcgen.ds47.sim.pn_device import PnDevice
from plcgen.ds47.wire import formats
from plcgen.ds47.wire.formats import pack_values, unpack_values
from tests.ds47.live.pn_bench import S120, Wire, changes, channel, drive, served
from tests.ds47.live.test_live import plcgen

S120_2 = ("--device", "sinamics-s120", "--do", "2")


def test_read():
    """Several parameters, one of them unknown to the drive, one without a type anywhere."""
    one = drive()
    with served(one) as where:
        code, out, err = plcgen("live", "read", "P1120[0..1]", "r52", "P9999", "--port", where, *S120_2, "--json")
    found = json.loads(out)
    assert [row["value"] for row in found["parameters"]] == ["10", "5.5", "1000", None]
    assert [row["type"].split()[0] for row in found["parameters"]][:3] == ["FloatingPoint"] * 2 + ["Unsigned16"]
    assert (code, "PG706" in err or "PG706" in out, changes(one)) == (1, True, 0)


SPEC = """\
plc: {name: A, family: s7-1500, toolchain: tia-v19}
drives:
  fan: {device: sinamics-s120, hardware_id: 270}
jobs:
  ramps: {drive: fan, write: {P1120: 10.0, P1121: 20.5}}
"""


def test_compare_with_a_spec(tmp_path: Path):
    """One constant is there, the other one is not: title, found, wanted, unit and job. Nothing is written."""
    path = tmp_path / "job.yaml"
    path.write_text(SPEC, "utf-8")
    one = drive()
    with served(one) as where:
        code, out, err = plcgen("live", "compare", str(path), "--port", where, "--api", "3A00")
    assert [line.split()[-1] for line in out.splitlines()[1:]] == ["equal", "deviates"]
    assert "Ramp-function generator ramp-down time: 20 s, not 20.5 s (ramps)" in err
    assert (code, err.count("PG707"), changes(one)) == (1, 1, 0)


def _listed() -> Drive:
    """A drive that knows its own list: r980 has 52, 840, 945 and 981, where it goes on."""
    found = drive()
    word = formats.by_name("Unsigned16")
    for number, values in ((980, [52, 840, 945, 981, 0]), (981, [1120, 1121, 7777, 59900, 59901, 0, 0])):
        found.objects[2].parameters[number] = SimulatedParameter(number, word, [*values], array=True, read_only=True)
    found.objects[2].parameters[945] = SimulatedParameter(945, word, [7901, 0], array=True, read_only=True)
    return found


def test_backup(tmp_path: Path):
    """Of what the drive says it has: one value a line, the type the drive says; 7777 is refused. Nothing is written."""
    path = tmp_path / "pump.csv"
    one = _listed()
    with served(one) as where:
        code, out, err = plcgen("live", "backup", str(path), "--port", where, *S120_2)
    rows = path.read_text("utf-8").splitlines()
    assert (code, changes(one)) == (0, 0), err
    assert rows[0].startswith("# SINAMICS S120 (CU320-2 DP/PN), sinamics-s120, drive object 2, pn://127.0.0.1")
    assert rows[1] == "Parameter;Parameter text;Online value;Unit;Data type"
    assert [row.split(";")[0::2] for row in rows[2:7]] == [
        ["p52", "1000", "Unsigned16"],
        ["p840[0]", "r722.2", "Unsigned32"],
        ["r945[0]", "7901", "Unsigned16"],
        ["r945[1]", "0", "Unsigned16"],
        ["p1120[0]", "10", "FloatingPoint"],
    ]
    assert rows[7] == "p1120[1];Ramp-function generator ramp-up time;5.5;s;FloatingPoint"
    assert rows[10:12] == ["p59900[0];;0;;Unsigned16", "p59900[1];;1;;Unsigned16"]
    assert rows[-1] == "p59901;;pump 7;;VisibleString[8]"
    assert "7 parameters of 8 read" in out
    assert "not read: 1 parameter, error 00h" in out
    assert not path.with_name("pump.csv.part").exists()


def test_data_sets_are_counted_once():
    """That there are two drive data sets is found out with the first parameter; the next one is a single request."""
    made = drive()
    dds = [Parameter(number, "FloatingPoint", indexes="DDS") for number in (1120, 1121)]
    wire, sets = Wire(PnDevice(made)), {}
    with channel(wire) as reader:
        found = [backup.gather(reader, [one], 2, sets)[0] for one in dds]
    assert sets == {"DDS": 2}
    assert [[element.text for element in one.elements] for one in found] == [["10", "5.5"], ["20", "6.5"]]
    asked = [int.from_bytes(call.data[6:8]) for call in made.journal if call.direction == "write"]
    assert (asked.count(1120) > 1, asked.count(1121)) == (True, 1)


def test_what_takes_a_backup(tmp_path: Path):
    """A comparison finds what has changed since; catalogue import reads it, too."""
    path = tmp_path / "pump.csv"
    one = _listed()
    with served(one) as where:
        plcgen("live", "backup", str(path), "--port", where, *S120_2)
        assert plcgen("live", "compare", str(path), "--port", where, *S120_2)[0] == 0
        one.objects[2].parameters[1121].values = [20.0, 7.0]
        one.objects[2].parameters[840].values = [722 << 16 | 0xFC00 | 3]
        one.objects[2].parameters[945].values = [0, 0]
        code, out, err = plcgen("live", "compare", str(path), "--port", where, *S120_2)
    assert (code, changes(one)) == (1, 0)
    assert "Ramp-function generator ramp-down time: 7 s, not 6.5 s (pump.csv)" in err
    assert "r722.3, not r722.2 (pump.csv)" in err
    assert err.count("PG707") == 2
    assert "r945" not in out  # a display is no difference
    imported = json.loads(plcgen("catalogue", "import", str(path), "--device", "sinamics-s120", "--json")[1])
    assert {row["parameter"]: row["fact"] for row in imported["changes"]}["P59900"] == "new"
    assert imported["skipped"] == []


def test_a_backup_goes_on(tmp_path: Path, monkeypatch):
    """Broken off after a chunk of two: the file is not there, and --resume reads the rest alone."""
    monkeypatch.setattr(backup, "CHUNK", 2)
    path = tmp_path / "pump.csv"
    one = _listed()
    told: list[str] = []
    with served(one) as where:
        words = ("live", "backup", str(path), "--port", where, *S120_2)
        first = Draft.add

        def breaks(self, chunk):
            if told:
                raise KeyboardInterrupt
            told.append("once")
            first(self, chunk)

        monkeypatch.setattr(Draft, "add", breaks)
        code, _, err = plcgen(*words)
        assert (code, "pump.csv.part: --resume goes on" in err) == (130, True)
        monkeypatch.setattr(Draft, "add", first)
        assert not path.exists()
        part = path.with_name("pump.csv.part")
        part.write_text(part.read_text("utf-8") + "p1120[0];;9", "utf-8")  # half a line: the power failed
        code, _, err = plcgen(*words)
        assert (code, "PG501" in err, "--resume" in err) == (1, True, True)
        one.journal.clear()
        assert plcgen(*words, "--resume")[0] == 0
    asked = {int.from_bytes(call.data[6:8]) for call in one.journal if call.direction == "write"}
    assert not asked & {52, 840}
    assert path.read_text("utf-8").count("\np1120[0];Ramp-function generator ramp-up time;10;") == 1
    assert path.read_text("utf-8").count("p52;") == 1
    assert "p1120[0];;9" not in path.read_text("utf-8")


def test_a_backup_of_another_drive_is_not_gone_on_with(tmp_path: Path):
    """The first line of the draft says of which drive it is."""
    path = tmp_path / "pump.csv"
    path.with_name("pump.csv.part").write_text("# another drive\n", "utf-8")
    with served(_listed()) as where:
        code, _, err = plcgen("live", "backup", str(path), "--port", where, *S120_2, "--resume")
    assert (code, "it is of another drive" in err) == (1, True)
    assert path.with_name("pump.csv.part").read_text("utf-8") == "# another drive\n"


def test_a_backup_replaces_nothing(tmp_path: Path):
    """A file of the user is in the way: nothing is asked of the drive."""
    path = tmp_path / "pump.csv"
    path.write_text("mine\n", "utf-8")
    one = _listed()
    with served(one) as where:
        for more in ((), ("--resume",)):
            code, _, err = plcgen("live", "backup", str(path), "--port", where, *S120_2, *more)
            assert (code, "PG501" in err, path.read_text("utf-8"), one.journal) == (1, True, "mine\n", [])
        code, _, err = plcgen("live", "backup", str(path / "below"), "--port", where, *S120_2)
    assert (code, "cannot write" in err, "Traceback" in err) == (1, True, False), err


@pytest.mark.skipif(sys.platform != "linux", reason="what a system says to a broadcast differs")
def test_a_network_is_no_device():
    """The broadcast address of a network looks like any other; the socket has no right to use it."""
    code, _, err = plcgen("live", "read", "r21", "--port", "pn://127.255.255.255")
    assert (code, "it is the broadcast address of a network" in err) == (1, True), err


@pytest.mark.slow
def test_a_backup_of_everything():
    """All of an S120's drive object, as its list has it: each value is that of the drive, in a minute of CPU time."""
    began = time.process_time()
    made = listed_drive(S120, 2, "vector")
    parameters = made.objects[2].parameters
    wire = Wire(PnDevice(made))
    saved: list[backup.SavedParameter] = []
    with channel(wire) as reader:
        numbers = backup.numbers(reader, S120, 2)
        for chunk in backup.backup(reader, S120, 2, numbers, lambda _count: None):
            saved += chunk
    assert len(numbers) > 2500
    assert {one.parameter.pnu for one in saved} == set(numbers) == {pnu for pnu in parameters if not 980 <= pnu < 990}
    for one in saved:
        there = parameters[one.parameter.pnu]
        assert not one.refusal
        assert b"".join(element.data for element in one.elements) == pack_values(there.format, there.values)
    assert changes(made) == 0
    assert time.process_time() - began < 60


@pytest.mark.parametrize(
    ("type_", "data", "text"),
    [
        ("FloatingPoint", "41 20 00 00", "10"),
        ("FloatingPoint", "3F 90 00 00", "1.1250"),  # 1.125 alone might be one thousand one hundred and twenty-five
        ("FloatingPoint", "C2 F6 F9 DB", "-123.4880"),
        ("FloatingPoint", "33 D6 BF 95", "1e-07"),
        ("FloatingPoint", "4B 18 96 80", "1e+07"),
        ("FloatingPoint", "7F C0 00 00", "16#7FC00000"),
        ("Unsigned32", "FF FF FF FF", "4294967295"),
        ("Integer16", "FF FF", "-1"),
        ("Boolean", "01", "1"),
        ("OctetString[2]", "00 15", "16#0015"),
        ("VisibleString[4]", "61 62 20 20", "ab"),
        ("TimeOfDay", "00 00 00 01 00 02", "16#000000010002"),
    ],
)
def test_values_of_a_list(type_, data, text):
    """By hand: 1.125 = 3F900000h; 1e-7 = 33D6BF95h; 1e7 = 4B189680h; what is no number is hexadecimal."""
    element = element_value(Parameter(1, type_), 0, bytes.fromhex(data), typed=True)
    assert backup.value_text(element) == text


def test_every_real_comes_back():
    """Written into a list and read again, a REAL has the same bytes."""
    for number in (1, 0x00800000, 0x3DCCCCCD, 0x3F800001, 0x42F6E979, 0x449A5225, 0x7F7FFFFF, 0xC2F6E979, 0x4640E47E):
        data = number.to_bytes(4)
        text = backup.value_text(element_value(Parameter(1, "FloatingPoint"), 0, data, typed=True))
        assert struct.pack(">f", float(text)) == data
        assert unpack_values(formats.by_name("FloatingPoint"), 1, data) == pytest.approx([float(text)])


def test_faults():
    """In the list of VECTOR, 7901 is F07901, motor overspeed; an alarm is there, too. Nothing is written."""
    word, long = formats.by_name("Unsigned16"), formats.by_name("Integer32")
    columns = {945: [7901, 0, 0, 0, 0, 0, 0, 0, 30003, *[0] * 7], 949: [5, *[0] * 15]}
    columns |= {2122: [7012, *[0] * 15], 2124: [1, *[0] * 15]}
    made = [SimulatedParameter(pnu, word if pnu in (945, 2122) else long, [*values], array=True, read_only=True)
            for pnu, values in columns.items()]  # fmt: skip
    one = Drive(Behaviour(), [DriveObject(2, {each.pnu: each for each in made})])
    with served(one) as where:
        now = json.loads(plcgen("live", "faults", "--port", where, *S120_2, "--json")[1])
        every = json.loads(plcgen("live", "faults", "--port", where, *S120_2, "--history", "1", "--json")[1])
    assert [(row["code"], row["value"], row["case"]) for row in now["messages"]] == [
        ("F07901", "5", 0),
        ("A07012", "1", 0),
    ]
    assert now["messages"][0]["title"] == "Drive: Motor overspeed"
    assert [row["code"] for row in every["messages"]] == ["F07901", "F30003", "A07012"]
    assert changes(one) == 0


def test_faults_of_a_drive_without_those_parameters():
    """MICROMASTER: r947 has the numbers, there is no r945, and nobody knows a parameter of alarms."""
    word = formats.by_name("Unsigned16")
    made = {pnu: SimulatedParameter(pnu, word, [*values], array=True, read_only=True)
            for pnu, values in {947: [11, *[0] * 7], 949: [0] * 8}.items()}  # fmt: skip
    one = Drive(Behaviour(record_indexes=(0xB02F,)), [DriveObject(0, made)])
    with served(one) as where:
        code, out, err = plcgen("live", "faults", "--port", where, "--device", "micromaster-4")
    assert (code, err) == (0, "")
    assert "F00011" in out
    assert "not asked: alarms, no parameter of micromaster-4 is known to have them" in out


def test_titles_of_a_family():
    """A number of no list has no title; without a device, all titles of a number; an alarm is no fault."""
    assert title("F", 7901, S120) == "Drive: Motor overspeed"
    assert title("F", 65535, S120) == ""
    assert "Drive: Motor overspeed" in title("F", 7901, None)
    assert title("C", 7901, S120) == ""


def test_faults_that_cannot_be_read():
    """A drive without alarms (r2122): what it has is shown, what is missing is an error."""
    one = drive()
    with served(one) as where:
        code, out, err = plcgen("live", "faults", "--port", where, *S120_2)
    assert (code, "no messages in what could be read" in out, "error 00h" in err) == (1, True, True)


WRITE = ("live", "write", "P1120=12.5")


def test_write():
    """Before, wanted, now; in one request; it is in RAM."""
    one = drive()
    with served(one) as where:
        code, out, err = plcgen(*WRITE, "P1121[0..1]=1.0,2.0", "--port", where, *S120_2, "--yes-write", "--json")
    assert (code, err, changes(one)) == (0, "", 1)
    rows = json.loads(out)["parameters"]
    assert [(row["parameter"], row["before"], row["wanted"], row["now"]) for row in rows] == [
        ("P1120[0]", "10", "12.5", "12.5"),
        ("P1121[0]", "20", "1", "1"),
        ("P1121[1]", "6.5", "2", "2"),
    ]
    assert one.objects[2].parameters[1120].values == [12.5, 5.5]


@pytest.mark.parametrize(
    ("words", "code", "told"),
    [
        ((*WRITE,), 2, "writing needs --yes-write"),
        ((*WRITE, "P971=1", "--yes-write"), 1, "PG219"),
        ((*WRITE, "P971=1", "--allow", "P977=no", "--yes-write"), 2, "p977 is allowed, but not written"),
        ((*WRITE, "P971=1", "--allow", "P971", "--yes-write"), 2, "why it may be written"),
        ((*WRITE, "P971=1", "--allow", "P971=", "--yes-write"), 2, "why it may be written"),
        ((*WRITE, "P9500=1:Unsigned32", "--allow", "P9500=x", "--yes-write"), 1, "--allow-safety"),
        ((*WRITE, "r21=1.0", "--yes-write"), 1, "PG207"),
        ((*WRITE, "P945=1:Unsigned16", "--yes-write"), 1, "PG207"),
        ((*WRITE, "P1121=abc", "--yes-write"), 1, "PG703"),
        ((*WRITE, *["P1121=1.0"] * 20, "--yes-write"), 1, "PG709"),
    ],
)
def test_nothing_is_written_that_was_not_asked_for(words, code, told):
    """Without the flag or a sign-off, to what can only be read, or more than a request holds: no change arrives."""
    one = drive()
    with served(one) as where:
        got, _, err = plcgen(*words, "--port", where, *S120_2)
    assert (got, told in err, changes(one)) == (code, True, 0), err


def test_a_dangerous_parameter_with_a_reason():
    """p0971 saves: with its sign-off it is written, and not complained about."""
    one = drive()
    one.objects[2].parameters[971] = SimulatedParameter(971, formats.by_name("Unsigned16"), [0])
    with served(one) as where:
        words = ("P971=1", "--allow", "P971=keep the ramps", "--yes-write")
        code, out, err = plcgen("live", "write", *words, "--port", where, *S120_2)
    assert (code, changes(one), "nothing was saved" in out) == (0, 1, False), err
    assert one.objects[2].parameters[971].values == [1]


def test_a_number_that_nobody_has_classified():
    """In no list: a warning, as in a spec, which a reason takes away; it is written all the same."""
    one = drive()
    with served(one) as where:
        words = ("live", "write", "P59900[0]=5:Unsigned16", "--port", where, *S120_2, "--yes-write")
        code, _, err = plcgen(*words)
        assert (code, "warning[PG261]" in err) == (0, True), err
        assert "PG261" not in plcgen(*words, "--allow", "P59900=looked up")[2]
    assert one.objects[2].parameters[59900].values[0] == 5


def test_a_write_that_is_refused():
    """1000 is beyond the limit: the message, and the value that is there now; the other one was written."""
    one = drive()
    with served(one) as where:
        words = ("P1120=1000", "P1121=2.0", "--port", where, *S120_2, "--yes-write")
        code, out, err = plcgen("live", "write", *words)
    assert (code, "error 02h" in err) == (1, True)
    assert [line.split()[-3:] for line in out.splitlines()[1:3]] == [["10", "1000", "10"], ["20", "2", "2"]]


def test_a_value_that_the_drive_makes_another_one():
    """A drive that rounds to whole numbers: what is read afterwards is not what was written."""
    one = drive()
    one.objects[2].parameters[1120].keeps = lambda _index, value: float(int(value))
    with served(one) as where:
        code, _, err = plcgen("live", "write", "P1120=12.5", "--port", where, *S120_2, "--yes-write")
    assert (code, "12 was read afterwards, 12.5 was written" in err) == (1, True)


@pytest.mark.parametrize(
    "address",
    ["pn://224.0.0.1", "pn://255.255.255.255", "pn://0.0.0.0", "pn://drive", "pn://127.0.0.1/1", "pn://127.0.0.1/1.x",
     "pn://127.0.0.1:0", "pn://127.0.0.1:99999", "pn://127.0.0.1/70000.1", "pn://"],
)  # fmt: skip
@pytest.mark.parametrize("verb", [("read", "r21"), ("faults",)])
def test_addresses_that_are_none(verb, address):
    """Groups, everybody, names, half a place: refused before anything is sent."""
    code, _, err = plcgen("live", *verb, "--port", address)
    assert (code, "write pn://192.168.0.5" in err) == (2, True), err


def test_options_of_the_other_way():
    """--record and --api belong to pn://; a backup needs types, which S7 does not tell."""
    assert plcgen("live", "read", "r21", "--drive", "127.0.0.1", "--record", "B02E")[0] == 2
    assert plcgen("live", "backup", "x.csv", "--port", "127.0.0.1", "--device", "sinamics-s120")[0] == 2


def test_what_a_drive_sets_back_is_not_compared(tmp_path: Path):
    """The list was made while p0971 saved: it is 0 in every drive, and says nothing."""
    path = tmp_path / "a.csv"
    path.write_text("Parameter;Value\np971;1\np1120[0];10.0\n", "utf-8")
    one = drive()
    one.objects[2].parameters[971] = SimulatedParameter(971, formats.by_name("Unsigned16"), [0])
    with served(one) as where:
        code, out, _ = plcgen("live", "compare", str(path), "--port", where, *S120_2)
    assert (code, "p971" in out, "p1120" in out) == (0, False, True)


def test_a_list_needs_one_drive_and_its_device(tmp_path: Path):
    """It does not say of which device it is, and belongs to one."""
    path = tmp_path / "a.csv"
    path.write_text("Parameter;Value\np1120;10.0\n", "utf-8")
    words = ("live", "compare", str(path), "--port", "pn://127.0.0.1")
    assert plcgen(*words)[0] == 2
    assert plcgen(*words, "--port", "pn://127.0.0.2", "--device", "sinamics-s120")[0] == 2


DRIVE = """\
objects:
  - number: 2
    parameters: [{pnu: 1120, type: FloatingPoint, value: 10.0}]
"""


@pytest.mark.slow
def test_the_device_as_a_program(tmp_path: Path):
    """It says where it is, serves until it is interrupted, and how many calls there were."""
    path = tmp_path / "drive.yaml"
    path.write_text(DRIVE, "utf-8")
    command = [sys.executable, "-m", "plcgen", "live", "device", str(path), "--pn", "127.0.0.1:0", "--slot", "3.1"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        where = process.stdout.readline().strip()
        try:
            code, out, err = plcgen("live", "read", "P1120", "--port", where, *S120_2)
        finally:
            process.send_signal(signal.SIGINT)
        rest = process.communicate(timeout=30)
    assert (code, where.endswith("/3.1"), out.splitlines()[2].split()[1]) == (0, True, "10"), err
    assert (process.returncode, "ended after 4 calls" in rest[1]) == (0, True), rest


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--pn", "127.0.0.1"), "a drive file or --device"),
        (("x.yaml", "--device", "sinamics-s120", "--pn", "127.0.0.1"), "a drive file or --device"),
        (("--device", "sinamics-s120", "--pn", "224.0.0.1"), "multicast"),
        (("--device", "sinamics-g120", "--pn", "192.0.2.1"), "cannot listen"),
    ],
)
def test_a_device_that_cannot_be(words, told):
    """Nothing to simulate, or an address that is not this machine's."""
    code, _, err = plcgen("live", "device", *words)
    assert (code, told in err) == (2, True), err
