"""Numbers of parameter lists: points, commas, groups of thousands; what cannot be read is told with its line."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen.base.display.workbook import workbook_bytes
from plcgen.base.files.workbook import Numeral
from plcgen.ds47.catalogue.lists import ParameterList, load_list, parse_list
from plcgen.ds47.catalogue.merging import merge_list
from plcgen.ds47.catalogue.numbers import decimal_sign, number
from plcgen.ds47.devices import find_device

HEAD = "Parameter;Parameter text;Online value;Unit;Minimum;Maximum\n"


def parsed(rows: str) -> ParameterList:
    return parse_list(HEAD + rows, Path("list.csv"))


@pytest.mark.parametrize(
    ("text", "decimal", "value"),
    [
        ("1.500,00", "", 1500.0),
        ("210.000,00", "", 210000.0),
        ("1,500.0", "", 1500.0),
        ("1.234.567", "", 1234567.0),
        ("-1,234,567.5", "", -1234567.5),
        ("1 500,25", "", 1500.25),
        ("1\u00a0500,25", "", 1500.25),
        ("1\u202f500.25", "", 1500.25),
        ("1'500.25", "", 1500.25),
        ("1\u2019500", ".", 1500.0),
        ("1 500", "", 1500.0),
        ("0,000", "", 0.0),
        ("1500,000", "", 1500.0),
        ("12,5", "", 12.5),
        ("1.5E3", "", 1500.0),
        ("1400", "", 1400.0),
        ("12,500", ",", 12.5),
        ("12,500", ".", 12500.0),
        ("12,500", "", None),
        ("1.50,00", "", None),
        ("1.500,00,0", "", None),
        ("1,5.0", "", None),
        ("[31] Ready for switching on", "", 31.0),
        ("[-1]", "", -1.0),
        ("r2090.0", ",", None),
        ("Invalid", ",", None),
        ("9H", ",", None),
        ("", ",", None),
        (Numeral("12.500"), ",", 12.5),
        (Numeral("1.2E-05"), "", 1.2e-05),
    ],
)
def test_number(text: str, decimal: str, value: float | None) -> None:
    """By hand; only three digits behind one sign may be either, if no more than three stand in front of it."""
    assert number(text, decimal) == value


@pytest.mark.parametrize(
    ("cells", "sign"),
    [
        (["12,500", "0,000", "999999,000"], ","),
        (["12,500", "1,500.0"], "."),
        (["12,500", "10,000"], ""),
        (["0,5", "0.5"], ""),
        (["1.234.567", "12.500"], ","),
        ([Numeral("0.5"), "0,5"], ","),
        ([], ""),
    ],
)
def test_what_the_cells_of_a_list_show(cells: list[str], sign: str) -> None:
    """One cell that is sure decides for all; two that contradict each other decide nothing."""
    assert decimal_sign(cells) == sign


def test_thousands_are_read() -> None:
    """Value and limits, one convention in the whole list: 1.500 is fifteen hundred where 210.000,00 stands, too."""
    (one,) = parsed("p1082;Maximum speed;1.500,00;rpm;1.500;210.000,00\n").parameters
    assert (one.value, one.minimum, one.maximum) == (1500.0, 1500.0, 210000.0)
    (one,) = parsed("p1082;Maximum speed;1,500.0;rpm;0.0;210,000.0\n").parameters
    assert (one.value, one.maximum) == (1500.0, 210000.0)


def test_values_by_index() -> None:
    """Of every row."""
    (one,) = parsed("p1120[0];;12,5;s;;\np1120[1];;10,0;s;;\np1120[3];;Invalid;s;;\n").parameters
    assert (one.values, one.indexes) == ({0: 12.5, 1: 10.0, 3: "Invalid"}, 4)


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        ("p1120;;12,500;s;;\n", 'line 2: value "12,500" of p1120 cannot be read: no other number shows whether . or ,'),
        ("p1120;;1;s;1.50,00;9\n", 'line 2: minimum "1.50,00" of p1120 cannot be read'),
        ("p1120;;1;s;0;high\n", 'line 2: maximum "high" of p1120 cannot be read'),
        ("p1120;;1;s;;\n10000000;;1;s;;\n", "line 3: 10000000 is no parameter"),
        ("p1120;;1;s;;\np70000[0];;1;s;;\n", "line 3: p70000[0] is no parameter"),
        ("p1120;;1;s;;\np1120;;2;s;;\n", "line 3: p1120 is in the list twice; line 2 counts"),
        ("p1120[1];;1;s;;\nP1120[1];;2;s;;\n", "line 3: p1120[1] is in the list twice; line 2 counts"),
    ],
)
def test_what_is_left_out_is_told(rows: str, told: str) -> None:
    """With its line, and by import as well."""
    listed = parsed(rows)
    (line,) = listed.skipped
    assert line.startswith(told)
    assert merge_list(find_device("sinamics-g120"), listed, "list").skipped == [line]
    assert [one.pnu for one in listed.parameters] == [1120]


def test_what_is_no_row_of_a_parameter_is_not_told() -> None:
    """Headings of groups, bits, dashes for limits, texts and sources as values."""
    rows = "Drive functions;;;;;\np1120;;r2090.0;s;-;-\nr0722.0;;0;;;\nr0722.0;;1;;;\nr2;;Ready;;;\n;;;;;\n"
    assert parsed(rows).skipped == []


def test_texts_of_a_workbook_are_read_like_those_of_a_table(tmp_path: Path) -> None:
    """Its numbers have a point in any language: test_cells_as_other_programs_write_them."""
    path = tmp_path / "list.xlsx"
    rows = [["Parameter", "Value", "Unit", "Maximum"], ["p1120", "12.500", "s", "1.500,00"]]
    book = workbook_bytes({"Sheet": rows})
    path.write_bytes(book)
    (one,) = load_list(path).parameters
    assert (one.value, one.maximum) == (12500.0, 1500.0)  # both are texts
