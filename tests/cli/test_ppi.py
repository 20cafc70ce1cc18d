"""plcgen ppi encode, decode and the verbs that talk to a station: what is printed, where, and with which exit code."""

import json

import pytest
from jsonschema import Draft202012Validator

from plcgen.api import schema
from plcgen.base.line.tcp import TcpServer
from plcgen.cli.ppi import SECTIONS
from plcgen.cli.ppi.capture import Capture, capture_of
from plcgen.ppi.sim import Bus, Station
from plcgen.ppi.sim.faults import parse_fault
from plcgen.ppi.sim.serve import Serving
from tests.ppi.vectors import FRAMES

VB100 = "68 1B 1B 68 02 00 6C 32 01 00 00 00 00 00 0E 00 00 04 01 12 0A 10 02 00 01 00 01 84 00 03 20 8B 16"
ANSWER = "68 16 16 68 00 02 08 32 03 00 00 00 00 00 02 00 05 00 00 04 01 FF 04 00 08 22 78 16"
"""Seed document 004, the VB program: reading VB100 and the answer 22."""

POLL = "10 02 00 5C 5E 16"
VERBS = [verb for _, verbs in SECTIONS for verb, _ in verbs]


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_has_help_with_examples(plcgen, verb):
    """-h works everywhere and shows a command to copy."""
    result = plcgen("ppi", verb, "-h")
    assert result.code == 0
    assert f"plcgen ppi {verb}" in result.out.split("Examples:")[1]


def test_the_group(plcgen):
    """Without a verb the group shows its help; a misspelt verb is guessed."""
    assert plcgen("ppi").out == plcgen("ppi", "-h").out
    result = plcgen("ppi", "raed")
    assert (result.code, result.err) == (
        2, 'error[PG901]: there is no verb "raed", did you mean "read"?\nhelp: plcgen ppi -h\n'
    )  # fmt: skip


# ---- encode ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("args", "vector"),
    [
        ("read VB100", "vb-read-vb100"),
        ("read DB1.DBB100", "vb-read-vb100"),
        ("read M0.0", "t1-read-m0.0"),
        ("read SMB34", "t1-read-smb34"),
        ("read E0.5", "t1-read-i0.5"),
        ("read MB0 VB100 QB0", "multi-read-m-v-q-3-items"),
        ("read VB0[222]", "read-vb0..vb221-222-bytes"),
        ("poll", "poll-vb-code-and-prose-example"),
        ("stop", "stop"),
        ("run", "run"),
        ("write M0.0=1", "t2-write-m0.0=1"),
        ("write M0.0=0", "t2-write-m0.0=0"),
        ("write M0.1=1", "t2-write-m0.1=1"),
        ("write VB100=16#10", "t2-write-vb100=10"),
        ("write VB100=16#FF", "t2-write-vb100=ff"),
        ("write VW100=-1", "t2-write-vw100=ffff"),
        ("write VD100=16#FFFFFFFF", "t2-write-vd100=ffffffff"),
        ("force VW100=16#1234", "force-vw100=1234"),
        ("unforce QB0", "unforce-qb0"),
    ],
)
def test_encode(plcgen, args, vector):
    """The telegrams of the seed document, from what an engineer writes."""
    assert plcgen("ppi", "encode", *args.split()).out == FRAMES[vector]["hex"] + "\n"


@pytest.mark.parametrize(
    ("args", "acts"),
    [
        ("read VB1", False), ("setup", False), ("poll", False), ("write VB1=1", True), ("run", True), ("stop", True),
        ("force VB1=1", True), ("unforce VB1", True),
    ],
)  # fmt: skip
def test_encode_says_that_it_sends_nothing(plcgen, args, acts):
    """Of what would act on the CPU; the bytes alone are on stdout."""
    result = plcgen("ppi", "encode", *args.split())
    assert (result.code, result.err) == (0, "only printed: whoever sends these bytes acts on the machine\n" * acts)


def test_encode_stations(plcgen):
    """--station and --source are the addresses, --fcb the frame count bit: 03 + 01 + 7C = 80."""
    assert plcgen("ppi", "encode", "poll", "--station", "3", "--source", "1", "--fcb", "1").out == "10 03 01 7C 80 16\n"


def test_encode_reference_and_json(plcgen):
    """--ref goes into the PDU; JSON has length and hex."""
    data = json.loads(plcgen("ppi", "encode", "setup", "--ref", "258", "--json").out)
    assert data["ok"]
    (row,) = data["telegrams"]
    assert (row["length"], bytes.fromhex(row["hex"])[11:13]) == (27, b"\x01\x02")


def test_encode_pack(plcgen):
    """--pack distributes, and counts references and frame count bits on: 6C, then 7C (5C is the poll in between)."""
    lines = plcgen("ppi", "encode", "read", "VB0[500]", "--pack").out.splitlines()
    frames = [bytes.fromhex(line) for line in lines]
    assert [frame[6] for frame in frames] == [0x6C, 0x7C, 0x7C]
    assert [frame[12] for frame in frames] == [0, 1, 2]
    assert [frame[24] for frame in frames] == [222, 222, 56]
    lines = plcgen("ppi", "encode", "read", "VB0[300]", "--pack", "--fcb", "0").out.splitlines()
    assert [bytes.fromhex(line)[6] for line in lines] == [0x5C, 0x5C]


@pytest.mark.parametrize(
    ("args", "codes"),
    [
        (["read", "M0.9", "V100", "XB3", "VB1"], ["PG712", "PG711", "PG711"]),
        (["read", "VB0[223]"], ["PG715"]),
        (["write", "VB0[213]=" + ",".join(["0"] * 213)], ["PG715"]),
        (["read", *(f"VB{n}" for n in range(20))], ["PG715"]),
        (["read", "VB0[200]", "VB300[20]"], ["PG715"]),
        (["read", "M0.0[8]"], ["PG714"]),
        (["read", "VW2047", "--cpu", "222"], ["PG713"]),
        (["read", "VB2047", "AIW32", "T256", "--cpu", "222"], ["PG713", "PG713"]),
        (["read", "VB0", "--cpu", "333"], ["PG713"]),
        (["write", "VB0=300", "M0.0=2"], ["PG716", "PG716"]),
        (["write", "VB100=5", "VW99=1"], ["PG716"]),
    ],
)
def test_encode_refuses(plcgen, args, codes):
    """Exit code 1, nothing on stdout, every problem with its code, and the same as JSON."""
    result = plcgen("ppi", "encode", *args)
    assert (result.code, result.out) == (1, "")
    assert [part.split("]")[0] for part in result.err.split("error[")[1:]] == codes
    data = json.loads(plcgen("ppi", "encode", *args, "--json").out)
    assert [diagnostic["code"] for diagnostic in data["diagnostics"]] == codes
    assert not data["telegrams"]


def test_encode_points_at_the_word(plcgen):
    """The caret stands below the address, the help says what to write."""
    assert plcgen("ppi", "encode", "read", "VB1", "M0.9").err == (
        'error[PG712]: "M0.9": bit 9 is outside 0..7\n'
        " --> <arguments>:1:5\n"
        "  |\n"
        "1 | VB1 M0.9\n"
        "  |     ^^^^\n"
        "  = help: the bits of MB0 are M0.0 to M0.7\n"
    )


@pytest.mark.parametrize(
    "args",
    [
        [], ["read"], ["write"], ["run", "VB1"], ["raed", "VB1"], ["poll", "--first", "--fcb", "1"],
        ["read", "VB1", "--station", "0"], ["read", "VB1", "--station", "127"], ["read", "VB1", "--ref", "65536"],
    ],
)  # fmt: skip
def test_encode_usage(plcgen, args):
    """Wrong usage is exit code 2."""
    result = plcgen("ppi", "encode", *args)
    assert (result.code, result.out) == (2, "")
    assert result.err.startswith("error[PG901]: ")


# ---- decode ---------------------------------------------------------------------------------------------------


def test_decode(plcgen):
    """Every field with its offset, bytes, value and meaning."""
    result = plcgen("ppi", "decode", *ANSWER.split())
    assert (result.code, result.err) == (0, "")
    assert result.out == (
        "read reply, station 2 to 0, reference 0, 28 bytes\n"
        "  offset  bytes  field              value  meaning\n"
        "       0  68     start              68h    SD2\n"
        "       1  16     length LE          22     bytes from DA to the end of the PDU\n"
        "       2  16     length LEr         22\n"
        "       3  68     start              68h\n"
        "       4  00     destination DA     0\n"
        "       5  02     source SA          2\n"
        "       6  08     function code FC   08h    answer: data\n"
        "       7  32     protocol           32h\n"
        "       8  03     ROSCTR             03h    answer\n"
        "       9  00 00  reserved           0000h\n"
        "      11  00 00  reference          0000h\n"
        "      13  00 02  parameter length   2\n"
        "      15  00 05  data length        5\n"
        "      17  00 00  error class, code  0000h  no error\n"
        "      19  04     function           04h    read\n"
        "      20  01     number of items    1\n"
        "                 value 1\n"
        "      21  FF       return code      FFh    ok\n"
        "      22  04       size code        04h    bytes, length in bits\n"
        "      23  00 08    length           8      1 byte\n"
        "      25  22       data             34\n"
        "      26  78     checksum FCS       78h\n"
        "      27  16     end                16h\n"
    )


def test_decode_knows_what_was_asked(plcgen):
    """In a capture the answer's values carry the addresses of the request before it."""
    result = plcgen("ppi", "decode", stdin=f"{VB100}\nE5\n{POLL}\n{ANSWER}\n")
    assert result.code == 0
    assert "value 1 (VB100)" in result.out


@pytest.mark.parametrize(
    ("pdu", "text"),
    [
        ("32 02 00 00 00 00 00 00 00 00 81 04", "function not supported"),
        ("32 02 00 00 00 00 00 00 00 00 D6 02", "protected by a password"),
        ("32 03 00 00 00 00 00 02 00 04 00 00 04 01 05 00 00 00", "address out of range"),
        ("32 03 00 00 00 00 00 02 00 01 00 00 05 01 03", "access denied"),
    ],
)
def test_decode_explains_errors(plcgen, pdu, text):
    """Header errors and return codes in words: such answers are valid telegrams."""
    from plcgen.ppi.wire.fdl import encode_frame
    from plcgen.ppi.wire.model import VariableFrame

    result = plcgen("ppi", "decode", encode_frame(VariableFrame(0, 2, 8, bytes.fromhex(pdu))).hex())
    assert result.code == 0
    assert text in result.out


CAPTURE = f"""\
# between Micro/WIN and a CPU 226
12:00:01.100 TX: {VB100}
12:00:01.120 RX: F9
[12:00:01] -> {POLL}
00 FF {ANSWER[:39]}
{ANSWER[39:]}   // the rest of the answer
{POLL}
"""


def test_decode_a_capture(plcgen, tmp_path):
    """Times and directions are skipped, a frame over two lines is one, garbage is named with its place."""
    (tmp_path / "capture.txt").write_text(CAPTURE)
    result = plcgen("ppi", "decode", "--file", "capture.txt", "--short")
    assert result.code == 1
    assert result.out == (
        "       0   read request, station 0 to 2 (6C): VB100\n"
        "      33 ! acknowledgement (received as F9)\n"
        "      34   poll, station 0 to 2 (5C)\n"
        "      40 ! 2 bytes skipped: no frame starts here\n"
        "      42   read reply, station 2 to 0 (08): VB100 = 22\n"
        "      70   poll, station 0 to 2 (5C)\n"
    )
    assert "capture.txt:3:18" in result.err
    assert "capture.txt:5:1" in result.err
    tolerant = plcgen("ppi", "decode", "--file", "capture.txt", "--short", "--tolerant")
    assert "      33 ~ acknowledgement" in tolerant.out
    assert "warning[PG710]: tolerated: byte 0 of the frame at byte 33: F9h is an acknowledgement" in tolerant.err


def test_decode_lines_that_are_wrong_each(plcgen):
    """Two telegrams that are cut short stay two: a line is where a telegram may begin."""
    result = plcgen("ppi", "decode", "--json", stdin="10 02 5C 5E 16\n10 02 5C 5E 16\n")
    assert [telegram["offset"] for telegram in json.loads(result.out)["telegrams"]] == [0, 5]


def test_decode_raw_bytes(plcgen, tmp_path):
    """A file that is no text is taken as the bytes themselves."""
    (tmp_path / "line.bin").write_bytes(bytes.fromhex(VB100) + b"\xe5" + bytes.fromhex(POLL))
    result = plcgen("ppi", "decode", "--file", "line.bin", "-s")
    assert (result.code, len(result.out.splitlines())) == (0, 3)


def test_decode_names_places_in_the_capture(plcgen, tmp_path):
    """Where a file has no lines, the offset is all there is; in a frame the place in the frame stays."""
    bad = ANSWER.replace(" ", "")[:-4] + "0016"  # another FCS
    (tmp_path / "line.bin").write_bytes(bytes.fromhex(f"{VB100}00FF{POLL}{bad}"))  # 33, 2, 6, 28 bytes
    result = plcgen("ppi", "decode", "--file", "line.bin", "-s")
    assert "PG710]: byte 33: 2 bytes skipped" in result.err
    assert "PG710]: byte 26 of the frame at byte 41: " in result.err


def test_decode_json(plcgen):
    """Kinds of the violations, offsets in the telegram, offset of the telegram in the stream."""
    data = json.loads(plcgen("ppi", "decode", "E5", "10", "02", "5C", "5E", "16", "--json").out)
    assert not data["ok"]
    good, bad = data["telegrams"]
    assert (good["text"], good["problems"], bad["offset"]) == ("acknowledgement", [], 1)
    assert bad["problems"] == [
        {"kind": "short", "offset": 5, "message": "an SD1 frame has 6 bytes (10 DA SA FC FCS 16), not 5"}
    ]
    assert sum(field["length"] for field in bad["fields"]) == 5


def test_decode_constant_function_codes(plcgen):
    """Two different polls with the same frame count bit are wrong in a row; tolerant says so and accepts it."""
    other = "68 04 04 68 02 00 5C 32 90 16"
    stream = f"{POLL}\n{POLL}\n{other.replace('04 04', '04 04')}\n"
    result = plcgen("ppi", "decode", "-s", stdin=stream)
    assert "has the frame count bit of the request before" in result.err
    data = json.loads(plcgen("ppi", "decode", "--json", "--tolerant", stdin=stream).out)
    assert [violation["kind"] for violation in data["telegrams"][2]["tolerated"]] == ["frame count"]


def test_decode_a_stale_answer(plcgen):
    """An answer with another reference than the request before it is named."""
    stale = ANSWER.replace("32 03 00 00 00 00", "32 03 00 00 00 05").replace("78 16", "7D 16")
    result = plcgen("ppi", "decode", "-s", stdin=f"{VB100}\n{stale}\n")
    assert result.code == 1
    assert "the reference is 0005h, the request has 0000h" in result.err


@pytest.mark.parametrize("args", [["xyz"], ["1"], ["68 1"], []])
def test_decode_bad_text(plcgen, args):
    """No hexadecimal, or nothing at all: PG701, exit code 1."""
    result = plcgen("ppi", "decode", *args, stdin="")
    assert (result.code, result.err[:12]) == (1, "error[PG701]")


def test_decode_files_that_are_not_there(plcgen):
    """A missing file is told without a traceback; both sources at once are wrong usage."""
    assert plcgen("ppi", "decode", "--file", "no.txt").err == "error: no.txt: No such file or directory\n"
    assert plcgen("ppi", "decode", "E5", "--file", "no.txt").code == 2


@pytest.mark.parametrize(
    "prefix", ["TX: ", "RX ", "-> ", "< ", "12:00:01.123 TX ", "[12:00:01] RX: ", "2026-01-02 12:00:01,5 <- "]
)
def test_prefixes_of_lines(prefix):
    """Times and directions as capture tools write them."""
    capture = Capture("x")
    capture.add_line(prefix + POLL, 3)
    assert (bytes(capture.data), capture.problems) == (bytes.fromhex(POLL), [])
    assert capture.span(1).column == len(prefix) + 4


def test_encodings_of_captures():
    """UTF-16 and UTF-8 with a byte order mark are text; control characters are bytes."""
    for encoding in ("utf-8", "utf-8-sig", "utf-16"):
        assert bytes(capture_of("x", POLL.encode(encoding)).data) == bytes.fromhex(POLL)
    assert bytes(capture_of("x", b"\x10\x02\x00\x5c\x5e\x16").data) == bytes.fromhex(POLL)


# ---- Talking to a station -------------------------------------------------------------------------------------


@pytest.fixture
def plc():
    """A simulated CPU 224."""
    return Station(values={"VW100": 1234, "M0.0": True})


@pytest.fixture
def bus(plc):
    """The bus it is on."""
    return Bus([plc])


@pytest.fixture
def port(bus, monkeypatch):
    """Name of the TCP line to it, which the verbs take from PLCGEN_PORT."""
    with Serving(bus, TcpServer("127.0.0.1:0")) as name:
        monkeypatch.setenv("PLCGEN_PORT", name)
        yield name


@pytest.mark.usefixtures("port")
def test_read(plcgen):
    """A table of values; symbols bring a column of their own."""
    result = plcgen("ppi", "read", "VW100", "M0.0", "VD4:REAL")
    assert (result.code, result.err) == (0, "")
    assert result.out == (
        "  address  type  value  bytes\n"
        "  VW100    WORD  1234   04 D2\n"
        "  M0.0     BOOL  1      01\n"
        "  VD4      REAL  0.0    00 00 00 00\n"
    )


@pytest.mark.usefixtures("port")
def test_read_symbols(plcgen, tmp_path):
    """Names of the symbol table, and what is wrong with a name that is not in it."""
    (tmp_path / "s.csv").write_text("Symbol,Address\nSpeed,VW100\n")
    result = plcgen("ppi", "read", "speed:INT", "--symbols", "s.csv")
    assert result.out == "  name   address  type  value  bytes\n  speed  VW100    INT   1234   04 D2\n"
    result = plcgen("ppi", "read", "sped", "--symbols", "s.csv")
    assert (result.code, "did you mean" in result.err) == (1, True)
    assert '"sped" is neither a symbol of the table nor an address' in result.err


@pytest.mark.usefixtures("port")
def test_read_refused_items(plcgen):
    """The other items are read; exit code 1; every refused one with its code and its meaning."""
    result = plcgen("ppi", "read", "VB9000", "VW100")
    assert result.code == 1
    assert "VB9000   BYTE  error 05h address out of range\n" in result.out
    assert "VW100    WORD  1234" in result.out
    assert result.err.startswith("error[PG719]: VB9000: 05h, address out of range\n --> socket://127.0.0.1:")
    data = json.loads(plcgen("ppi", "read", "VB9000", "VW100", "--json").out)
    assert [(row["ok"], row["value"], row["return_code"]) for row in data["values"]] == [
        (False, None, "05"),
        (True, 1234, "FF"),
    ]


@pytest.mark.usefixtures("port")
def test_read_refuses_what_the_cpu_does_not_have(plcgen, bus):
    """--cpu finds it before anything is sent."""
    result = plcgen("ppi", "read", "VB100", "VW8191", "--cpu", "224")
    assert (result.code, result.out) == (1, "")
    assert "VW8191 reaches VB8192, CPU 224 ends at VB8191" in result.err
    assert not bus.journal


@pytest.mark.usefixtures("port")
def test_write(plcgen, plc, bus):
    """Only with the flag; without it nothing is sent and the exit code is 2."""
    words = ("VW100=16#10", "M0.1=1", "VD200=1.5")
    result = plcgen("ppi", "write", *words)
    assert (result.code, result.out) == (2, "")
    assert "  VD200    REAL  1.5    3F C0 00 00\n" in result.err
    assert "error[PG901]: nothing was written: writing needs --yes-write\n" in result.err
    assert not bus.journal
    result = plcgen("ppi", "write", *words, "--yes-write")
    assert (result.code, result.err) == (0, "")
    assert "  VW100    WORD  16     written\n" in result.out
    assert (plc["VW100"], plc["M0.1"], plc["VB200"]) == (16, True, 0x3F)
    data = json.loads(plcgen("ppi", "write", "VB9000=1", "--yes-write", "--json").out)
    assert (data["ok"], data["values"][0]["return_code"]) == (False, "05")


@pytest.mark.usefixtures("port")
def test_write_is_all_or_nothing_if_a_value_is_wrong(plcgen, bus):
    """A mistake in the last value keeps the first from being written."""
    for words in (["VW100=1", "VB0=300"], ["VW100=1", "VW101=2"], ["VW100=1", "T5=70000000000"]):
        result = plcgen("ppi", "write", *words, "--yes-write")
        assert (result.code, result.out) == (1, "")
        assert "error[PG716]" in result.err
    assert not bus.journal


@pytest.mark.usefixtures("port")
def test_run_and_stop(plcgen, plc, bus):
    """Each needs its own flag, so that an edited command line does not stop a machine."""
    for verb in ("run", "stop"):
        assert plcgen("ppi", verb).code == 2
    assert plcgen("ppi", "stop", "--yes-run").code == 2
    assert not bus.journal
    assert plcgen("ppi", "stop", "--yes-stop").out == "station 2: STOP\n"
    assert plc.mode.name == "STOP"
    assert json.loads(plcgen("ppi", "run", "--yes-run", "--json").out)["mode"] == "RUN"
    assert plc.mode.name == "RUN"


@pytest.mark.usefixtures("port")
def test_info(plcgen):
    """CPU type and firmware from the system area."""
    assert plcgen("ppi", "info").out == "station 2: CPU 224, firmware 02.01\n"
    assert json.loads(plcgen("ppi", "info", "--json").out)["type"] == "CPU 224"


@pytest.mark.usefixtures("port")
def test_monitor_lines(plcgen, monkeypatch):
    """In a pipe every read is one line with its time; --json makes one object of it."""
    monkeypatch.setattr("plcgen.cli.ppi.monitor._clock", lambda: "12:00:00.000")
    result = plcgen("ppi", "monitor", "VW100", "M0.0", "--count", "2", "--interval", "0")
    assert (result.code, result.out) == (0, "12:00:00.000  VW100=1234  M0.0=1\n" * 2)
    result = plcgen("ppi", "monitor", "VW100", "VB9000", "--count", "1", "--json")
    row = json.loads(result.out)
    assert (result.code, row["ok"], [value["value"] for value in row["values"]]) == (1, False, [1234, None])
    line = Draft202012Validator(schema("monitor"))
    assert list(line.iter_errors(row)) == []
    assert not line.is_valid({**row, "time": "noon"})


@pytest.mark.usefixtures("port")
def test_monitor_table(plcgen, plc, monkeypatch):
    """On a terminal the table is drawn over the one before; what changed is bold."""
    monkeypatch.setattr("plcgen.cli.ppi.monitor.is_terminal", lambda _stream: True)
    monkeypatch.setattr("plcgen.cli.ppi.monitor._clock", lambda: "12:00:00.000")

    def change(_seconds):
        plc["VW100"] += 1

    monkeypatch.setattr("plcgen.cli.ppi.monitor.time.sleep", change)
    result = plcgen("ppi", "monitor", "VW100", "M0.0", "--count", "2", "--interval", "0", "--color", "always")
    first, second = result.out.split("\x1b[4F\x1b[J")
    assert "  VW100    WORD  1234   04 D2\n" in first
    assert "\x1b[1m  VW100    WORD  1235   04 D3\x1b[0m\n" in second
    assert second.endswith("12:00:00.000\n")


@pytest.mark.usefixtures("port")
def test_monitor_table_higher_than_the_screen(plcgen, monkeypatch):
    """What does not fit is counted instead of scrolling away under the cursor."""
    monkeypatch.setattr("plcgen.cli.ppi.monitor.is_terminal", lambda _stream: True)
    monkeypatch.setenv("LINES", "8")
    result = plcgen("ppi", "monitor", *(f"VB{number}" for number in range(20)), "--count", "1")
    lines = result.out.splitlines()
    assert len(lines) == 7
    assert lines[-2] == "  ... 16 more"


@pytest.mark.usefixtures("port")
def test_monitor_goes_on_without_an_answer(plcgen, bus):
    """A station that is silent for a while is asked again; the exit code is that of the last read.

    Deaf for two exchanges of three requests: a read is sent once more as a whole.
    """
    bus.faults.append(parse_fault("deaf:times=6"))
    result = plcgen("ppi", "monitor", "VW100", "--count", "2", "--interval", "0", "--timeout", "0.5")
    assert result.code == 0
    assert result.out.endswith("VW100=1234\n")
    assert "error[PG718]: station 2 does not answer" in result.err


def test_a_silent_station(plcgen, port):
    """No answer: PG718 with the line as its place."""
    result = plcgen("ppi", "read", "VB0", "--station", "5", "--timeout", "0.02")
    assert (result.code, result.out) == (1, "")
    assert result.err.startswith(f"error[PG718]: station 5 does not answer (3 times sent)\n --> {port}\n")
    data = json.loads(plcgen("ppi", "read", "VB0", "--station", "5", "--timeout", "0.02", "--json").out)
    assert (data["ok"], data["diagnostics"][0]["code"]) == (False, "PG718")


def test_lines_that_cannot_be_used(plcgen, tmp_path, monkeypatch):
    """A missing port, nothing listening, a file that is no port: their codes, exit code 1, no traceback."""
    pytest.importorskip("serial")
    monkeypatch.delenv("PLCGEN_PORT", raising=False)
    (tmp_path / "file").write_text("x")
    for port in ("/dev/ttyNOPE", "socket://127.0.0.1:1", "file"):
        for verb in (
            ["read", "VB0"],
            ["monitor", "VB0"],
            ["info"],
            ["run", "--yes-run"],
            ["write", "VB0=1", "--yes-write"],
        ):
            result = plcgen("ppi", *verb, "--port", port)
            assert (result.code, result.out) == (1, ""), (port, verb)
            assert result.err.startswith("error[PG72"), result.err
    assert plcgen("ppi", "read", "VB0").code == 2


def test_a_line_that_vanishes(plcgen):
    """The partner closes the connection in the middle of an exchange: PG722."""
    import socket
    import threading

    with socket.create_server(("127.0.0.1", 0)) as server:

        def accept():
            connection, _ = server.accept()
            connection.recv(10)
            connection.close()

        thread = threading.Thread(target=accept)
        thread.start()
        result = plcgen("ppi", "monitor", "VB0", "--port", f"socket://127.0.0.1:{server.getsockname()[1]}")
        thread.join()
    assert (result.code, result.out) == (1, "")
    assert result.err.startswith("error[PG722]")


@pytest.mark.parametrize(
    "args", [["read"], ["write"], ["read", "VB0", "--station", "0"], ["monitor", "VB0", "--count", "0"]]
)
def test_usage(plcgen, args):
    """Wrong usage is exit code 2."""
    assert plcgen("ppi", *args, "--port", "socket://127.0.0.1:1").code == 2


@pytest.mark.usefixtures("port")
def test_a_bad_symbol_table(plcgen, tmp_path):
    """Its problems are shown at their lines; nothing is sent."""
    (tmp_path / "s.csv").write_text("Symbol,Address\nSpeed,VW1x\nPump,Q0.9\nOk,VB1\n")
    result = plcgen("ppi", "read", "Ok", "--symbols", "s.csv")
    assert (result.code, result.out) == (1, "")
    assert "s.csv:2:7" in result.err
    assert "s.csv:3:6" in result.err
