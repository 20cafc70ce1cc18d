"""Symbol tables as Micro/WIN and spreadsheets write them."""

import pytest

from plcgen.base.diagnostics import DiagnosticError
from plcgen.ppi.symbols import load_symbols, parse_symbols
from plcgen.ppi.wire.address import parse_item

TABLE = (("Pump", "Q0.1", "main pump"), ("Level", "VD200", "tank, upper"), ("Füllstand", "VW10", ""))


def rows(separator, *, header=True, quote='"'):
    """Return the table as text."""
    lines = [["Symbol", "Address", "Comment"]] if header else []
    lines += [list(row) for row in TABLE]
    return "\r\n".join(
        separator.join(f"{quote}{cell}{quote}" if separator in cell else cell for cell in line) for line in lines
    )


@pytest.mark.parametrize("header", [True, False])
@pytest.mark.parametrize("separator", ["\t", ";", ","])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "cp1252"])
def test_every_export(tmp_path, separator, header, encoding):
    """Any separator, with or without header row, in any of the usual encodings."""
    path = tmp_path / "symbols.csv"
    path.write_bytes(rows(separator, header=header).encode(encoding))
    table = load_symbols(path)
    assert [(s.name, s.item, s.comment) for s in table.symbols] == [(n, parse_item(a), c) for n, a, c in TABLE]
    assert table.find("PUMP").line == (2 if header else 1)
    assert table.find("füllstand").item == parse_item("VW10")
    assert table.find("nothing") is None
    assert [*table.names] == ["Pump", "Level", "Füllstand"]


@pytest.mark.parametrize(
    "text",
    [
        "Address;Symbol;Comment\nQ0.1;Pump;x\n",
        "\t\tSymbol\tAddress\tComment\n\t\tPump\tQ0.1\tx\n",
        "1,,Pump,Q0.1,x\n2,,Level,VD200,\n",
        "Name,Adresse,Kommentar\nPump,A0.1,x\n",
        "符号\t地址\t注释\nPump\tQ0.1\tx\n",
        "Pump,%Q0.1\n",
        "\n\nPump , Q0.1 , x\n\n",
        '"Pump","Q0.1","x"\n',
        "Pump,Q0.1,x\nPump,Q0.1,the same again\n",
    ],
)
def test_other_shapes(text):
    """Columns in another order, marker columns, other languages, blanks, quotes, repetitions."""
    assert parse_symbols(text).find("pump").item == parse_item("Q0.1")


def problems(text):
    """Return (code, line, column, message) of everything wrong with a table."""
    with pytest.raises(DiagnosticError) as caught:
        parse_symbols(text, "s.csv")
    return [(d.code, d.span.line, d.span.column, d.message) for d in caught.value.diagnostics]


def test_every_problem_at_its_place():
    """A wrong address, a missing one, a missing symbol and a double symbol, all at once, with line and column."""
    text = "Symbol,Address,Comment\nA,Q0.9,x\nB,,x\n,VB3,x\nC,VB1,\nc,VB2,\nOK,VB9,\n"
    assert problems(text) == [
        ("PG717", 2, 3, '"Q0.9": bit 9 is outside 0..7'),
        ("PG717", 3, 1, "the address is missing"),
        ("PG717", 4, 2, "the symbol is missing"),
        ("PG717", 6, 1, 'the symbol "c" appears twice'),
    ]


def test_names_that_only_letters_of_another_script_tell_apart():
    """Cyrillic CO beside Latin CO; a Cyrillic P within a Latin word; a name in one script is one."""
    text = (
        "Symbol,Address,Comment\nCO,Q0.1,\n\u0421\u041e,Q0.2,\n\u0420ump,Q0.3,\n\u041d\u0430\u0441\u043e\u0441,Q0.4,\n"
    )
    assert [(code, line, column) for code, line, column, _ in problems(text)] == [("PG414", 3, 1), ("PG414", 4, 1)]


@pytest.mark.parametrize("text", ["", "hello\n", "a;b;c\n1;2;3\n", "\x00\x01\x02"])
def test_no_symbol_table(text):
    """A file without a column of addresses is refused as a whole."""
    assert [problem[0] for problem in problems(text)] == ["PG717"]


def test_too_large(tmp_path, monkeypatch):
    """Sizes are bounded."""
    monkeypatch.setattr("plcgen.ppi.symbols.MAX_BYTES", 100)
    path = tmp_path / "s.csv"
    path.write_bytes(b"Pump,Q0.1,x\n" * 20)
    with pytest.raises(DiagnosticError):
        load_symbols(path)
