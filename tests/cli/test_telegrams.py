"""encode, decode, explain: telegrams and numbers, expected bytes from the cited documents."""

import json

import pytest

from plcgen.base.telegrams.hexbytes import HexError, parse_hex
from plcgen.cli import hexbytes

READ = "03 01 02 01 10 01 C4 7F 00 00"
"""FAQ 109750712, figure 5-1."""


@pytest.mark.parametrize(
    "text",
    [
        "03 01 C4 7F",
        "0301C47F",
        "0301 c47f",
        "16#03 16#01 16#C4 16#7F",
        "0x03, 0x01, 0xC4, 0x7F",
        "0x0301C47F",
        "03h 01h C4h 7Fh",
        "W#16#0301 W#16#C47F",
        "DW#16#0301_C47F",
        "B#16#3;B#16#1;W#16#C47F",
        "03-01-C4-7F",
        "03:01:C4:7F",
        r"b'\x03\x01\xC4\x7F'",
        "[03, 01, c4, 7f]",
    ],
)
def test_every_usual_spelling(text):
    """Watch tables, traces, manuals, C and Python mean the same four bytes."""
    assert parse_hex(text).data == bytes.fromhex("0301C47F")


@pytest.mark.parametrize(
    ("text", "column", "length"),
    [("03 1 02", 3, 1), ("03 xyz 01", 3, 3), ("B#16#123", 0, 8), ("03 +1", 3, 2), ("030", 0, 3)],
)
def test_what_is_no_byte_is_refused_at_its_place(text, column, length):
    """An odd digit would shift all bytes after it."""
    with pytest.raises(HexError) as caught:
        parse_hex(text)
    assert (caught.value.column, caught.value.length) == (column, length)


def test_places_of_bytes():
    """Each byte knows where it stands, so that a caret can point at it."""
    assert parse_hex("0301 16#C47F W#16#5").places == ((0, 2), (2, 2), (8, 2), (10, 2), (13, 6), (13, 6))


def test_decode_a_request(plcgen):
    """Every field with offset, bytes, value and meaning."""
    result = plcgen("decode", *READ.split())
    assert (result.code, result.err) == (0, "")
    assert result.out == (
        "request, 10 bytes\n"
        "  offset  bytes  field                 value  meaning\n"
        "       0  03     request reference     03h\n"
        "       1  01     request id            01h    request parameter\n"
        "       2  02     drive object          2\n"
        "       3  01     number of parameters  1\n"
        "                 parameter 1\n"
        "       4  10       attribute           10h    value\n"
        "       5  01       number of elements  1\n"
        "       6  C4 7F    parameter number    50303\n"
        "       8  00 00    subindex            0\n"
    )


def test_decode_with_its_request(plcgen):
    """The request names the parameters of the response (FAQ 109750712, figure 5-1: 10.0)."""
    result = plcgen("decode", "0301020108014120 0000", "--request", READ)
    assert result.code == 0
    assert "parameter 1 (P50303)" in result.out
    assert "41 20 00 00    value                          10.0   FloatingPoint" in result.out


def test_decode_notices_a_wrong_mirror(plcgen):
    """A response to another request is malformed in this context."""
    result = plcgen("decode", "0401020108014120 0000", "--request", READ)
    assert result.code == 1
    assert "error[PG702]: byte 0: the request reference 4 does not mirror the request's 3" in result.err


def test_double_words_are_shown_as_real(plcgen):
    """MM4 guide part 3, figure 3-5: REAL answered as 43h, 30.0 = 41F00000h."""
    result = plcgen("decode", "01 01 00 01 43 01 41 F0 00 00")
    assert "1106247680  DoubleWord, as REAL 30.0" in result.out


def test_error_numbers_are_explained(plcgen):
    """A negative response says why in words."""
    result = plcgen("decode", "04 82 02 01 44 02 00 02 00 00")
    assert result.code == 0
    assert "0002h  low or high value limit exceeded" in result.out


def test_malformed_telegram(plcgen):
    """Fields as far as they go, then every violation with a caret at its byte; exit code 1."""
    result = plcgen("decode", "00 01 02 02 10 01 C4 7F 00 00")
    assert result.code == 1
    assert "! 10         missing" in result.out
    assert result.err.startswith(
        "error[PG702]: byte 10: the address of parameter 2 needs 6 bytes, the telegram has 0 left\n"
        " --> <arguments>:1:30\n"
        "  |\n"
        "1 | 00 01 02 02 10 01 C4 7F 00 00\n"
        "  |                              ^\n"
    )


def test_what_a_maker_prints_is_no_error(plcgen):
    """ifm, RM30 p. 26: a change of P65000 with the reference 00h, which the profile reserves."""
    result = plcgen("decode", "00 02 00 01 10 00 FD E8 00 00 43 01 00 00 00 64")
    assert (result.code, result.err) == (0, "")
    assert "reserved in PROFIdrive; some makers print it" in result.out


@pytest.mark.parametrize(
    ("telegram", "named"),
    [
        ("01 40 00 01 10 00 20 6C 00 00", "SEW MOVILINK service"),
        ("01 40 00 01 43 01 31 1C 72 89", "SEW MOVILINK service (+)"),
        ("01 40 00 01 30 00 20 6C 00 00 43 01 00 00 00 05", "write parameter, volatile"),
        ("01 C0 00 01 44 01 00 10", "SEW MOVILINK service (-)"),
        ("01 41 00 01 10 00 20 6C 00 00", "SEW data transport"),
        ("01 01 01 01 20 01 04 60 00 01", "description"),
        *((f"01 01 01 01 {attribute} 01 04 60 00 00", "manufacturer-specific") for attribute in ("80", "81", "82")),
    ],
)
def test_forms_of_makers_have_names_and_no_error(plcgen, telegram, named):
    """SEW DFE32B manual, pp. 73, 77 and 78; attributes from 80h on are the makers' (PROFIdrive)."""
    result = plcgen("decode", telegram)
    assert (result.code, result.err) == (0, "")
    assert named in result.out


@pytest.mark.parametrize(
    "telegram", ["01 42 00 01 10 00 20 6C 00 00", "01 40 00 01 10 00 20 6C 00", "01 01 01 01 70 01 04 60 00 00"]
)
def test_what_no_maker_prints_is_wrong(plcgen, telegram):
    """42h is nobody's, a byte is missing, 70h is a reserved attribute."""
    result = plcgen("decode", telegram)
    assert (result.code, "error[PG702]" in result.err) == (1, True)


def test_decode_from_stdin(plcgen):
    """One telegram a line, comments and empty lines skipped, a bad line does not hide the others."""
    stdin = f"# trace\n{READ}  // read\n\n04020201\r\n03 zz\n"
    result = plcgen("decode", stdin=stdin)
    assert result.code == 1
    assert result.out.count("request, 10 bytes") == 1
    assert result.out.count("response, 4 bytes") == 1
    assert 'error[PG701]: "zz" is not a hexadecimal number\n --> <stdin>:5:4\n' in result.err


def test_decode_json(plcgen):
    """JSON has offsets as numbers and the problems as diagnostics; stdout holds nothing else."""
    result = plcgen("decode", "--json", "03 02 02 01 FF")
    data = json.loads(result.out)
    assert result.code == 1
    assert data["ok"] is False
    assert data["telegrams"][0]["problems"]
    assert data["diagnostics"][0]["code"] == "PG702"
    assert [f["offset"] for f in data["telegrams"][0]["fields"]] == [0, 1, 2, 3, 4, 5]


def test_forced_kind(plcgen):
    """--as overrides the guess."""
    assert plcgen("decode", "--as", "request", "04020201").out.startswith("request, 4 bytes")
    assert plcgen("decode", "04020201").out.startswith("response, 4 bytes")


@pytest.mark.parametrize("stdin", ["", "\n\n", "# only a comment\n"])
def test_nothing_to_decode(plcgen, stdin):
    """Empty input is a problem, not a success."""
    result = plcgen("decode", stdin=stdin)
    assert (result.code, result.out) == (1, "")
    assert "error[PG701]: there are no bytes to decode" in result.err


def test_huge_and_binary_input(plcgen):
    """Too much of anything is refused in bounded time; bytes that are no text are no crash."""
    assert "more than 65536 bytes" in plcgen("decode", "03" * 70_000).err
    assert plcgen("decode", stdin=b"\xff\xfe\x00\x01" * 100).code == 1
    long = plcgen("decode", "03 01 02 01" + " 00" * 5000)
    assert long.code == 1
    assert "exceed the record limit of 240" in long.err


def test_endless_stdin_is_refused(plcgen, monkeypatch):
    """Reading stops at a bound instead of filling the memory."""
    monkeypatch.setattr(hexbytes, "MAX_INPUT", 10)
    result = plcgen("decode", stdin="03 01 02 01 10 01")
    assert (result.code, result.out) == (2, "")


def test_status(plcgen):
    """A STATUS double word, byte by byte, and what to do next."""
    result = plcgen("decode", "--status", "DF80B500")
    assert result.code == 0
    assert result.out.startswith("STATUS DF80B500h  write record: state conflict")
    assert "Error_Code_1  B5h" in result.out
    assert "temporary: repeat the same call after a pause" in result.out
    assert json.loads(plcgen("decode", "--status", "--json", "16#DF80_B500").out)["retry"] == "temporary"
    wrong = plcgen("decode", "--status", "DF80")
    assert wrong.code == 1
    assert "a STATUS has 4 bytes, not 2" in wrong.err


@pytest.mark.parametrize(
    ("args", "expected"),
    [
        (["read", "P50303", "--do", "2", "--ref", "3"], READ),
        (
            ["write", "P50304=100.0:FloatingPoint", "--do", "2", "--ref", "4"],
            "04 02 02 01 10 01 C4 80 00 00 08 01 42 C8 00 00",
        ),
        (
            ["write", "ramp_down_time_1=100.0", "--device", "sinamics-dcm", "--ref", "4"],
            "04 02 02 01 10 01 C4 80 00 00 08 01 42 C8 00 00",
        ),
        (
            ["read", "P1120", "P2155[1..2]", "--device", "micromaster-4"],
            "01 01 00 02 10 00 04 60 00 00 10 02 08 6B 00 01",
        ),
        (["write", "P10=16#FF:Byte", "--do", "1"], "01 02 01 01 10 01 00 0A 00 00 41 01 FF 00"),
        (["write", "p840=r722.2:Unsigned32"], "01 02 01 01 10 01 03 48 00 00 07 01 02 D2 FC 02"),
        (["write", "p840=r722.2@self:Unsigned32"], "01 02 01 01 10 01 03 48 00 00 07 01 02 D2 FC 02"),
        (["write", "p840=r53010@1:Unsigned32"], "01 02 01 01 10 01 03 48 00 00 07 01 CF 12 04 00"),
        (["write", "P20=abc:VisibleString"], "01 02 01 01 10 03 00 14 00 00 09 03 61 62 63 00"),
        (["write", "P9[3]=-2:Integer16"], "01 02 01 01 10 01 00 09 00 03 03 01 FF FE"),
        (["write", "P9[0..1]=1,2:Unsigned8"], "01 02 01 01 10 02 00 09 00 00 05 02 01 02"),
    ],
)
def test_encode_parameters(plcgen, args, expected):
    """FAQ 109750712 figures 5-1 and 4-9, MM4 guide table 3-1, G110M OI p. 198, DCM OI p. 453, the rest by hand."""
    result = plcgen("encode", *args)
    said = "only printed: whoever sends these bytes acts on the machine\n" if args[0] == "write" else ""
    assert (result.code, result.out, result.err) == (0, f"{expected}\n", said)
    assert plcgen("encode", *args, "-q").err == ""


@pytest.mark.parametrize(
    ("args", "message"),
    [
        (["read", "P0"], "parameter number 0 is outside 1..65535"),
        (["read", "P1[2..1]"], "the index range is empty or over 65534"),
        (["read", "nothing"], 'unknown parameter "nothing"'),
        (["read", "P 1 2"], '"P 1 2" is not a parameter'),
        (["write", "P1"], '"P1" has no value'),
        (["write", "P1=1"], 'the data type of "P1" is missing'),
        (["write", "P840=r722.2"], "help: P840=r722.2:Unsigned32"),
        (["write", "P1=1:Unsigned9"], '"Unsigned9" is not a DS47 data type'),
        (["write", "P1=300:Unsigned8"], "Unsigned8 takes an integer from 0 to 255, not 300"),
        (["write", "P1=x:Unsigned8"], '"x" is not a value of type Unsigned8'),
        (["write", "P1[0..1]=1:Unsigned8"], "1 values for 2 elements"),
        (["read", *[f"P{n}" for n in range(1, 41)]], "40 parameters"),
        (["read", "P1", "--device", "sinamics-x"], 'unknown device "sinamics-x"'),
    ],
)
def test_encode_refuses(plcgen, args, message):
    """What makes no telegram is a diagnostic, exit code 1, nothing on stdout."""
    result = plcgen("encode", *args)
    assert (result.code, result.out) == (1, "")
    assert message in result.err
    assert plcgen("encode", *args, "--json").code == 1


def test_encode_a_spec_and_decode_it_again(plcgen, good):
    """The output of encode is input of decode."""
    encoded = plcgen("encode", good)
    assert encoded.out.startswith(f"{READ}  // read_it, DB3 ")
    assert plcgen("encode", good, "read_it").out == encoded.out
    assert plcgen("decode", stdin=encoded.out).code == 0
    data = json.loads(plcgen("encode", good, "--json").out)
    assert data["telegrams"][0]["hex"] == READ.replace(" ", "")
    missing = plcgen("encode", good, "read_them")
    assert missing.code == 1
    assert 'the spec has no job "read_them"' in missing.err
    assert 'did you mean "read_it"?' in missing.err


@pytest.mark.parametrize(
    ("key", "title"),
    [
        ("PG209", "PG209  error or warning: "),
        ("pg209", "PG209  error or warning: "),
        ("0x11", "11h  DS47 error number: request cannot be executed because of the operating state"),
        ("11h", "11h  DS47 error number: "),
        ("16#0011", "11h  DS47 error number: "),
        ("16#8101", "16#8101  block status: not finished within TIMEOUT"),
        ("W#16#7002", "16#7002  block status: job running"),
        ("DF80B500", "DF80B500h  STATUS: write record: state conflict"),
    ],
)
def test_explain(plcgen, key, title):
    """Codes and numbers in any spelling; the number of digits says what it is."""
    result = plcgen("explain", key)
    assert (result.code, result.err) == (0, "")
    assert result.out.startswith(title)
    data = json.loads(plcgen("explain", key, "--json").out)
    assert data["sections"]


def test_explain_a_save_that_was_refused(plcgen):
    """docs/generated-code.md, a job that restores: 8501 if the drive refused to save, too; cause is 8401 then."""
    out = " ".join(plcgen("explain", "8501").out.split())
    assert "has not finished saving within the limit" in out
    assert "on_error: restore and save: the values are right" in out
    assert "8401 if the drive refused to save" in out
    assert "Note" not in plcgen("explain", "8502").out


def test_explain_unknown(plcgen):
    """An unknown code suggests one; the known ones are still explained."""
    result = plcgen("explain", "PG2099", "0x11")
    assert result.code == 1
    assert result.out.startswith("11h  ")
    assert result.err.startswith('error[PG703]: "PG2099" is not a plcgen code')
    assert 'did you mean "PG209"?' in result.err


def test_explain_list(plcgen):
    """Every code of the table with its title."""
    lines = plcgen("explain", "--list").out.splitlines()
    assert lines[0].split() == ["code", "severity", "title"]
    assert lines[1].startswith("PG101")
    assert len(json.loads(plcgen("explain", "--list", "--json").out)["codes"]) == len(lines) - 1
