"""YAML text becomes nodes with positions; what YAML would misread is refused."""

from __future__ import annotations

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from plcgen.base.diagnostics import DiagnosticError, Report
from plcgen.base.files.brackets import hide_indexes, show_indexes
from plcgen.base.files.yaml import MAX_DEPTH, load_yaml, parse_yaml, resolve_plain


def codes(text: str) -> list[tuple[str, int, int]]:
    report = Report()
    parse_yaml(text, "t.yaml", report)
    return [(d.code, d.span.line, d.span.column) for d in report]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1", 1), ("-7", -7), ("0", 0), ("1.5", 1.5), ("1e3", 1000.0), ("-2.5E-1", -0.25), (".5", 0.5),
        ("true", True), ("FALSE", False), ("", None), ("~", None), ("null", None), ("0x1F", 31),
        ("16#0A", 10), ("W#16#C47F", 50303), ("2#1010", 10), ("8#17", 15), ("DW#16#0000_0100", 256),
        ("2#19", "2#19"), ("P50303", "P50303"), ("M50.0", "M50.0"), ("tia-v16", "tia-v16"), ("r0722.0", "r0722.0"),
        ("1.2.3", "1.2.3"), ("1e", "1e"), ("10s", "10s"),
    ],
)  # fmt: skip
def test_plain_scalars_follow_yaml_1_2_and_s7(text: str, value: object) -> None:
    """A number is a number in every YAML version and in S7 spelling; everything else stays text."""
    found = resolve_plain(text)
    assert found == value
    assert type(found) is type(value)


@pytest.mark.parametrize(
    "word", ["NO", "yes", "On", "off", "010", "-007", "0o17", "12:30", "1:02:03", "1_000", ".inf", "-.NaN", "1,5"]
)
def test_traps_are_refused_at_their_place(word: str) -> None:
    """What YAML 1.1 and 1.2 read differently is an error where it stands; in quotes it is text."""
    assert codes(f"a:\n  key: {word}\n") == [("PG108", 2, 8)]
    assert codes(f'a:\n  key: "{word}"\n') == []


@pytest.mark.parametrize(
    ("text", "data"),
    [
        ("[r0947[0..7], r21]", ("r0947[0..7]", "r21")),
        ("{P2155[1..2]: [10.0, 20.0], P2156[0]: 1}", {"P2155[1..2]": (10.0, 20.0), "P2156[0]": 1}),
        ("[{as: code[ 0 .. 7 ], type: OctetString[4]}]", ({"as": "code[ 0 .. 7 ]", "type": "OctetString[4]"},)),
        ("[r0947[0, 7], r0947[0: 7]]", ("r0947[0, 7]", "r0947[0: 7]")),
        ("{execute: Plant.line[i].start}", {"execute": "Plant.line[i].start"}),
        ("['a[0]', \"b[1]\", [1, 2]]", ("a[0]", "b[1]", (1, 2))),
        ("{a: &x [1], b: *x, c: !!str [1]}", None),
        ("a[b, c]", "a[b, c]"),
        ('["\\ue000[0]"]', ("\ue000[0]",)),
    ],
)  # fmt: skip
def test_an_index_belongs_to_its_name(text: str, data: object) -> None:
    """Brackets close behind a name are part of it in YAML's own brackets, too; lists stay lists, quotes quotes."""
    report = Report()
    node = parse_yaml(f"x: {text}\n", "t.yaml", report)
    if data is None:
        assert report.has_errors
    else:
        assert list(report) == []
        assert node is not None
        assert node.data() == {"x": data}


def test_an_index_moves_nothing() -> None:
    """Positions behind an index are those of the file."""
    node = load_yaml("x: [r0947[0..7], zwölf[1], 3]\n", "t.yaml")
    assert [(item.span.column, item.span.end_column) for item in node.find(["x"]).items] == [
        (5, 16),
        (18, 26),
        (28, 29),
    ]


@given(st.text(alphabet='ab1 [].,:{}"\n-&*', max_size=40))
def test_an_index_changes_nothing_that_is_yaml(text: str) -> None:
    """What was YAML before means the same with the hiding of indexes."""
    try:
        plain = yaml.load(text, Loader=yaml.BaseLoader)  # noqa: S506 - texts only
    except yaml.YAMLError:
        return
    hidden = hide_indexes(text)
    assert len(hidden) == len(text)
    assert _shown(yaml.load(hidden, Loader=yaml.BaseLoader)) == plain  # noqa: S506


def _shown(data: object) -> object:
    if isinstance(data, dict):
        return {_shown(key): _shown(value) for key, value in data.items()}
    if isinstance(data, list):
        return [_shown(item) for item in data]
    return show_indexes(data) if isinstance(data, str) else data


def test_keys_are_text() -> None:
    """An axis may be called y and a parameter 010: keys are never read as truth values or numbers."""
    assert codes("y: 1\nNO: 2\n010: 3\n") == []
    assert load_yaml("y: 1\n010: 3\n", "t.yaml").data() == {"y": 1, "010": 3}


def test_positions_count_characters_from_one() -> None:
    """Line and column of keys and values, also after characters of several bytes."""
    node = load_yaml("名字: 泵\nb:\n  - x: [1, zwölf, 3]\n", "t.yaml")
    assert (node.key_span("名字").line, node.key_span("名字").column) == (1, 1)
    assert node.find(["名字"]).span.column == 5
    third = node.find(["b", 0, "x", 2])
    assert (third.span.line, third.span.column, third.span.end_column) == (3, 19, 20)
    assert node.data() == {"名字": "泵", "b": ({"x": (1, "zwölf", 3)},)}


def test_duplicate_key_names_the_first_use() -> None:
    """YAML keeps the last of two equal keys silently; here it is an error that shows both."""
    report = Report()
    parse_yaml("a: 1\nb: 2\na: 3\n", "t.yaml", report)
    (found,) = report
    assert (found.code, found.span.line) == ("PG103", 3)
    assert found.notes[0].span.line == 1


def test_all_problems_come_at_once() -> None:
    """One run reports every trap and every duplicate of the file."""
    assert codes("a: NO\nb: 010\na: 1\nc: !!python/object/apply:os.system [ls]\n") == [
        ("PG108", 1, 4),
        ("PG108", 2, 4),
        ("PG103", 3, 1),
        ("PG109", 4, 4),
    ]


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("a: [1, 2\n", 2),
        ("a:\n\t- b\n", 2),
        ('a: "open\n', 2),
        ("a: b: c\n", 1),
        ("a: *nowhere\n", 1),
        ("a: 1\n---\nb: 2\n", 2),
    ],
)
def test_syntax_errors_have_a_line(text: str, line: int) -> None:
    """Unclosed brackets and quotes, tabs, unknown aliases, a second document."""
    found = codes(text)
    assert [(code, at) for code, at, _ in found] == [("PG101", line)]


def test_anchors_and_merge_keys_work() -> None:
    """An engineer with sixteen equal axes may use anchors; own keys win over merged ones."""
    node = load_yaml("base: &b {device: x, address: 1}\naxis: {<<: *b, address: 2}\nother: *b\n", "t.yaml")
    assert node.data()["axis"] == {"device": "x", "address": 2}
    assert node.data()["other"] == {"device": "x", "address": 1}


def test_hostile_documents_end_quickly() -> None:
    """Depth, alias bombs and self-containing aliases are diagnostics."""
    assert codes("a: " + "[" * 100_000)[0][0] == "PG109"
    assert codes("a: " + "{b: " * (MAX_DEPTH + 1))[0][0] == "PG109"
    bomb = "l0: &l0 [x, x, x, x, x, x, x, x, x, x]\n"
    for level in range(1, 9):
        bomb += f"l{level}: &l{level} [{', '.join([f'*l{level - 1}'] * 10)}]\n"
    assert codes(bomb)[0][0] == "PG109"
    assert codes("a: &a [*a]\n")[0][0] == "PG109"
    assert codes("a: \x07\n")[0][0] == "PG101"


@given(st.text(max_size=200))
def test_any_text_gives_a_node_or_a_diagnostic(text: str) -> None:
    """No text makes the reader fail in another way."""
    report = Report()
    node = parse_yaml(text, "t.yaml", report)
    blank = not text.strip("\ufeff \n\r\t\x85\u2028\u2029") or "#" in text or text[:1] in "-.%"
    assert node is not None or report.has_errors or blank


@pytest.mark.slow
@given(
    st.recursive(
        st.integers(-(2**40), 2**40) | st.booleans() | st.none() | st.text("abcxyz", min_size=2, max_size=8),
        lambda inner: (
            st.lists(inner, max_size=4) | st.dictionaries(st.text("abcdefg", min_size=2, max_size=6), inner, max_size=4)
        ),
        max_leaves=20,
    )
)
def test_agrees_with_another_yaml_implementation(value: object) -> None:
    """Data that another YAML library writes is read back as the same data."""

    def listed(data: object) -> object:
        if isinstance(data, tuple):
            return [listed(item) for item in data]
        return {key: listed(item) for key, item in data.items()} if isinstance(data, dict) else data

    assert listed(load_yaml(yaml.safe_dump({"root": value}), "t.yaml").data()) == {"root": value}


def test_empty_file_is_reported() -> None:
    """An empty file is an error with a place, not None."""
    with pytest.raises(DiagnosticError, match="PG101 the file is empty"):
        load_yaml("", "t.yaml")
