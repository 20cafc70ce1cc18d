"""Error numbers, STATUS codes and the parameter description."""

import subprocess
import sys

import pytest

from plcgen.ds47.explanation import error_page
from plcgen.ds47.wire.description import ARRAY, ELEMENTS, READ_ONLY, Description
from plcgen.ds47.wire.errors import error_text, known_numbers
from plcgen.ds47.wire.formats import FormatValueError
from plcgen.ds47.wire.status import Retry, explain_status, explain_word, status_of


def test_error_numbers_are_complete():
    """The table holds the 67 numbers of the profile, SINAMICS and PKW lists."""
    numbers = known_numbers()
    assert len(numbers) == 67
    assert set(range(0x1A)) | {0x20, 0x21, 0x22, 0x23, 0x65, 0x87, 0xC8, 0xC9, 0xCC} <= set(numbers)


@pytest.mark.parametrize(
    ("number", "word", "info"),
    [
        (0x00, "does not exist", "none"),
        (0x02, "limit exceeded", "subindex"),
        (0x11, "operating state", "none"),
        (0x64, "reserved", "unknown"),
        (0x65, "presently deactivated", "none"),
        (0x6B, "controller is enabled", "none"),
        (0xC9, "upper limit", "none"),
    ],
)
def test_error_meaning(number, word, info):
    """The meaning is the one of the FAQ's and guide's error tables."""
    found = error_text(number)
    assert word in found.meaning
    assert (found.info, found.manufacturer) == (info, number >= 0x65)


def test_manufacturer_numbers_belong_to_a_table():
    """65h..FFh means something in the SINAMICS table only; the gaps are reserved or manufacturer-specific."""
    assert error_text(0x6B, "profidrive").meaning == "manufacturer-specific"
    assert error_text(0x10, "profidrive").meaning == "reserved"
    assert error_text(0x10).meaning.startswith("read job")
    assert error_text(0x02, "profidrive") == error_text(0x02)
    assert error_text(0x80).meaning == "manufacturer-specific"
    assert error_text(0x24).meaning == "reserved"
    assert error_text(0x0100).manufacturer


def test_an_error_number_without_a_meaning_has_none_of_sinamics():
    """Only a number of the SINAMICS table is said to be one: 6Bh, not 8Bh."""
    notes = [[text for heading, text in error_page(number).sections if heading == "Note"] for number in (0x6B, 0x8B)]
    assert ["SINAMICS" in " ".join(found) for found in notes] == [True, False]


def test_error_explained_with_its_information_word():
    """The second word is named a subindex where the table says so."""
    assert error_text(0x03).explain(5).endswith("(subindex 5)")
    assert "(" not in error_text(0x05).explain(0)
    assert error_text(0x05).explain(7).endswith("(information word 7)")


@pytest.mark.parametrize(
    ("value", "direction", "text", "retry", "error"),
    [
        (0x00700000, None, "no job active", Retry.NONE, False),
        (0x00700100, None, "job started", Retry.WAIT, False),
        (0x00700200, None, "job running", Retry.WAIT, False),
        (0x00000000, None, "no error", Retry.NONE, False),
        (
            0xDE80B500,
            None,
            "read record: state conflict: module",
            Retry.TEMPORARY,
            True,
        ),
        (0xDF80B500, None, "previous parameter request", Retry.TEMPORARY, True),
        (0xDE80A000, None, "negative acknowledgement on read", Retry.RESTART, True),
        (0xDF80A000, None, "negative acknowledgement", Retry.PERMANENT, True),
        (0xDF80A100, None, "negative acknowledgement on write", Retry.TEMPORARY, True),
        (0xDE80A100, None, "negative acknowledgement on write", Retry.PERMANENT, True),
        (0xDF80A200, None, "module failure", Retry.TEMPORARY, True),
        (0xDF80A300, None, "DP error", Retry.TEMPORARY, True),
        (0xDF80A400, None, "K bus", Retry.TEMPORARY, True),
        (0xDF80A500, None, "reserved", Retry.PERMANENT, True),
        (0xDF80A700, None, "busy", Retry.TEMPORARY, True),
        (0xDF80AC00, None, "manufacturer", Retry.PERMANENT, True),
        (0xDE80B000, None, "data record unknown", Retry.PERMANENT, True),
        (0xDF80B100, None, "write length error", Retry.PERMANENT, True),
        (0xDF80B700, None, "header", Retry.PERMANENT, True),
        (0xDE80C000, None, "no read data", Retry.TEMPORARY, True),
        (0xC080C300, "write", "local error of the CPU", Retry.TEMPORARY, True),
        (0xDE80C600, None, "aborted", Retry.TEMPORARY, True),
        (0xC0809000, "read", "logical address", Retry.PERMANENT, True),
        (0xC0843A00, "read", "call parameter 4: the data block does not exist", Retry.PERMANENT, True),
        (0xC0FE0100, None, "profile-specific", Retry.PERMANENT, True),
        (0xDE809F00, None, "unknown error code 9Fh", Retry.PERMANENT, True),
        (0xDE900100, None, "unknown error class 90h", Retry.PERMANENT, True),
    ],
)
def test_status(value, direction, text, retry, error):
    """A STATUS is explained and classed: A2-A4, A7, B5, C0-C6 temporary, A1 of WRREC too, A0 of RDREC restarts."""
    found = explain_status(value, direction)
    assert text in found.text
    assert (found.retry, found.error, found.value) == (retry, error, value)


def test_status_taken_apart():
    """DF80B512h is function DFh, decode 80h, codes B5h and 12h."""
    found = explain_status(0xDF80B512)
    assert (found.function_num, found.error_decode, found.code1, found.code2) == (0xDF, 0x80, 0xB5, 0x12)
    assert status_of("write", 0xB5, 0x12) == 0xDF80B512
    assert status_of("read", 0xB5) == 0xDE80B500


def test_status_word():
    """The middle word alone is explained with the direction given: 80A0 of RDREC starts again."""
    assert explain_word(0x80A0, "read").retry is Retry.RESTART
    assert explain_word(0x7002).retry is Retry.WAIT
    assert "logical address" in explain_word(0x8090).text


def test_description_bytes():
    """46 bytes, worked out by hand: identifier 4208h is an array, read-only, of FloatingPoint."""
    description = Description(
        ARRAY | READ_ONLY | 0x08,
        3,
        1000.0,
        b"\x09\xfd",
        "Speed",
        bytes(4),
        bytes.fromhex("447A0000"),
        1,
        2,
        3,
    )
    expected = "4208 0003 447A0000 09FD 00000000 5370656564202020202020202020202000000000 447A0000 0000 0001 0002 0003"
    assert description.pack() == bytes.fromhex(expected)
    assert Description.unpack(description.pack()) == description
    assert description.format == 0x08
    assert sum(size for _, _, size in ELEMENTS) == 46
    with pytest.raises(FormatValueError, match="46 bytes, not 45"):
        Description.unpack(bytes(45))


def test_description_elements():
    """Subindex 0 answers everything, 2 the number of elements, 6 the name; 13 does not exist."""
    description = Description(0x4003, 5, name="Ramp-up time of axis 1")
    assert (description.block(0).format, description.block(0).count) == (0x0A, 46)
    assert description.block(2).values() == [5]
    assert description.block(3).values() == [1.0]
    assert description.block(6).values() == ["Ramp-up time of "]
    assert description.block(12).values() == [0]
    with pytest.raises(IndexError):
        description.block(13)


def test_import_is_lazy():
    """Importing every module reads no table and does not import tomllib's parser results."""
    code = (
        "import sys;"
        "from plcgen.ds47.wire import codec, dissect, errors as e, status as s;"
        "assert e._sinamics.cache_info().currsize == 0 == s._tables.cache_info().currsize;"
        "assert not {'yaml', 'pydantic', 'jinja2', 'lxml', 'click'} & set(sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize(
    ("word", "means"),
    [
        (0x8322, "call parameter 3: outside the area when it was read"),
        (0x8428, "call parameter 4: wrong alignment when it was read"),
        (0x8429, "wrong alignment when it was written"),
        (0x8430, "write-protected global data block"),
        (0x8431, "write-protected instance data block"),
        (0x8142, "call parameter 1: access error when it was read from the peripheral inputs"),
        (0x8243, "peripheral outputs"),
        (0x80C7, "restart of the DP master"),
        (0x80E1, "user specific"),
        (0x8094, "not in the table of RDREC and WRREC"),
    ],
)
def test_codes_of_the_manual_besides_those_of_the_channel(word: int, means: str) -> None:
    """General error codes 8xyy and code 1 from C7h on, Siemens' System and Standard Functions for S7-300/400."""
    found = explain_word(word)
    assert means in found.text
    assert found.retry is Retry.PERMANENT
