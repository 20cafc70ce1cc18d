"""Telegrams for people: every byte in one field, wrong ones marked."""

import pytest

from plcgen.ds47.wire.dissect import dissect_request, dissect_response, looks_like
from tests.ds47.vectors import REQUESTS, RESPONSES, octets


def _rows(fields):
    return [(f.offset, f.length, f.name, f.value) for f in fields]


def test_request_fields():
    """The FAQ's read request has eight fields with their offsets, as its DB3 declares them."""
    assert _rows(dissect_request(octets(REQUESTS["dcm-read-p50303"]))) == [
        (0, 1, "request reference", "03h"),
        (1, 1, "request id", "01h"),
        (2, 1, "drive object", "2"),
        (3, 1, "number of parameters", "1"),
        (4, 1, "parameter 1 attribute", "10h"),
        (5, 1, "parameter 1 number of elements", "1"),
        (6, 2, "parameter 1 parameter number", "50303"),
        (8, 2, "parameter 1 subindex", "0"),
    ]


def test_response_fields():
    """The FAQ's answer has seven fields; the value is read as FloatingPoint."""
    fields = dissect_response(octets(RESPONSES["dcm-read-p50303-answer"]))
    assert _rows(fields)[4:] == [
        (4, 1, "parameter 1 format", "08h"),
        (5, 1, "parameter 1 number of values", "1"),
        (6, 4, "parameter 1 value", "10.0"),
    ]
    assert not any(field.problem for field in fields)


def test_pads_and_strings_are_fields():
    """A pad is a field of its own; a string is one value of its octets."""
    fields = dissect_request(octets(REQUESTS["change-of-a-string"]))
    assert _rows(fields)[-2:] == [(12, 3, "parameter 1 value", "'abc'"), (15, 1, "parameter 1 pad", "00h")]


def test_error_words_are_explained():
    """Error number and information word are two fields, the number with its meaning."""
    fields = dissect_response(octets(RESPONSES["read-failed-two-words"]))
    assert _rows(fields)[-2:] == [
        (6, 2, "parameter 1 error number", "0003h"),
        (8, 2, "parameter 1 information word", "5"),
    ]
    assert "subindex" in fields[-2].note


@pytest.mark.parametrize("row", [*REQUESTS.values(), *RESPONSES.values()], ids=lambda row: row["id"])
def test_valid_telegrams_have_no_problems(row):
    """No field of a valid telegram is marked, and the kind is told from the bytes alone."""
    is_request = row["id"] in REQUESTS
    fields = (dissect_request if is_request else dissect_response)(octets(row))
    marked = [field for field in fields if field.problem]
    assert marked == []
    assert looks_like(octets(row)) == ("request" if is_request else "response")


@pytest.mark.parametrize(
    ("data", "name", "note"),
    [
        ("01 09 01 01 10 01 00 01 00 00", "request id", "reserved"),
        ("01 4F 01 01 10 01 00 01 00 00", "request id", "manufacturer-specific"),
        ("01 01 01 28 10 01 00 01 00 00", "number of parameters", "outside 1 to 39"),
        ("01 01 01 01 40 01 00 01 00 00", "parameter 1 attribute", "reserved"),
        ("01 01 01 01 10 EB 00 01 00 00", "parameter 1 number of elements", "over 234"),
        ("01 01 01 01 10 01 00 00 00 00", "parameter 1 parameter number", "reserved"),
        ("01 01 01 01 10 01 00 01 FF FF", "parameter 1 subindex", "reserved"),
        ("01 01 01 01 10 01 00 01 00", "parameter 1 subindex", "cut short: 1 of 2 bytes"),
        ("01 01 01 02 10 01 00 01 00 00", "missing", "the address of parameter 2"),
        ("01 02 01 01 10 01 00 01 00 00", "missing", "the value of parameter 1"),
        ("01 01 01 01 10 01 00 01 00 00 AA", "undecoded bytes", "beyond the end"),
        ("01 02 01 01 10 01 00 01 00 00 0E 01 AA BB", "parameter 1 format", "unknown format"),
        ("01 02 01 01 10 01 00 01 00 00 44 01 AA BB", "parameter 1 format", "in responses only"),
        ("01 02 01 01 10 01 00 01 00 00 05 01 AA BB", "parameter 1 pad", "a pad is 00h"),
        ("01 02 01 01 10 01 00 01 00 00 08 01 AA BB", "parameter 1 value", "cut short: 2 of 4 bytes"),
    ],
)
def test_wrong_request_fields_are_marked(data, name, note):
    """The wrong field is marked and says why."""
    marked = [field for field in dissect_request(bytes.fromhex(data)) if field.problem]
    assert name in [field.name for field in marked]
    assert any(note in field.note for field in marked)


@pytest.mark.parametrize(
    ("data", "name"),
    [
        ("01 03 01 01 08 01 00 00 00 00", "response id"),
        ("01 01 01 02 08 01 00 00 00 00", "missing"),
        ("01 81 01 01 44 03 00 01 00 02 00 03", "parameter 1 error word 3"),
        ("01 02 01 01 40 00", "undecoded bytes"),
    ],
)
def test_wrong_response_fields_are_marked(data, name):
    """The wrong field of a response is marked."""
    assert name in [field.name for field in dissect_response(bytes.fromhex(data)) if field.problem]


def test_error_table_is_the_callers_choice():
    """6Bh is explained by the SINAMICS table only."""
    data = bytes.fromhex("01 81 01 01 44 01 00 6B")
    assert "controller" in dissect_response(data)[-1].note
    assert dissect_response(data, "profidrive")[-1].note == "manufacturer-specific"


@pytest.mark.parametrize(
    ("data", "kind"),
    [
        ("", "unknown"),
        ("01 01 01", "unknown"),
        ("02 02 00 02", "response"),
        ("02 01 00 02", "unknown"),
        ("02 82 00 02", "response"),
        ("01 45 01 01 10 01 00 01 00 00", "request"),
        ("01 40 00 01 10 00 20 6C 00 00", "request"),
        ("01 40 00 01 43 01 31 1C 72 89", "response"),
        ("01 C0 00 01 44 01 08 10", "response"),
        ("01 01 01 01 99 01 00 01 00 00", "unknown"),
        ("01 02 01 01 08 01 00 01 00 00", "unknown"),
    ],
)
def test_request_or_response(data, kind):
    """Byte 1 and byte 4 tell the kinds apart; four bytes with 02h are a positive change response."""
    assert looks_like(bytes.fromhex(data)) == kind


def test_a_reserved_reference_is_told_but_no_mistake():
    """PROFIdrive reserves 00h; ifm prints it in RM30 p. 26."""
    field = dissect_request(bytes.fromhex("00 01 01 01 10 01 00 01 00 00"))[0]
    assert (field.name, field.value, field.problem) == ("request reference", "00h", False)
    assert "reserved in PROFIdrive" in field.note


def test_services_of_sew_have_names():
    """SEW DFE32B manual, pp. 73, 77 and 78: MOVILINK index 8300 is read; a write has its value after it."""
    read = dissect_request(bytes.fromhex("01 40 00 01 10 00 20 6C 00 00"))
    assert [(field.note, field.problem) for field in read if field.note] == [
        ("SEW MOVILINK service", False),
        ("read parameter", False),
    ]
    answer = dissect_response(bytes.fromhex("01 40 00 01 43 01 31 1C 72 89"))
    assert (answer[1].note, answer[-1].value) == ("SEW MOVILINK service (+)", "823947913")
    write = dissect_request(bytes.fromhex("01 40 00 01 30 00 20 6C 00 00 43 01 00 00 00 05"))
    assert not [field for field in write if field.problem]
    assert (write[4].note, write[-1].value) == ("write parameter, volatile", "5")


@pytest.mark.parametrize("attribute", [0x80, 0x81, 0x82, 0xF0])
def test_attributes_of_makers_are_told_but_no_mistake(attribute):
    """PROFIdrive leaves 80h and above to makers."""
    field = dissect_request(bytes((1, 1, 1, 1, attribute, 1, 0, 1, 0, 0)))[4]
    assert (field.note, field.problem) == ("manufacturer-specific", False)


def test_older_numbers_of_formats_are_known():
    """21h is N2, as Danfoss MCA 120 answers (p. 42): 4000h is 16384."""
    fields = dissect_response(bytes.fromhex("01 01 01 01 21 01 40 00"))
    assert [(f.value, f.note) for f in fields[4:]] == [("21h", "N2 (21h)"), ("1", ""), ("16384", "N2 (21h)")]
