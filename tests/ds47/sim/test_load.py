"""Drive files: the documented example, every fault kind, and problems with their positions."""

import re
from pathlib import Path

import pytest

from plcgen.diagnostics import DiagnosticError
from plcgen.protocols.ds47.sim.faults import Fault, FaultKind
from plcgen.protocols.ds47.sim.habits import Habits
from plcgen.protocols.ds47.sim.load import load_drive
from plcgen.protocols.ds47.sim.parameters import Condition, Limits

DOCUMENT = Path(__file__).parents[3] / "docs" / "drive-yaml.md"
MINIMAL = "objects: [{number: 1, parameters: [{pnu: 1, type: Unsigned16, value: 5}]}]\n"


def example():
    """Return the drive of the documented example."""
    text = re.search(r"```yaml\n(.*?)```", DOCUMENT.read_text(encoding="utf-8"), re.DOTALL)[1]
    return load_drive(text, "drive.yaml")


def test_documented_example():
    """The example in docs/drive-yaml.md loads and says what its comments say."""
    drive = example()
    ramp = drive.objects[0].parameters[1120]
    assert (ramp.values, ramp.limits, ramp.array) == ([10.0], Limits(0.0, 650.0), False)
    assert ramp.state_limits == {"running": Limits(0.5, 100.0)}
    assert ramp.conditions == (Condition(0x6B, while_in=frozenset({"enabled"})),)
    assert drive.objects[0].parameters[2155].array
    assert drive.habits.record_indexes == (47, 0xB02F)
    assert (drive.habits.aliases, drive.habits.processing) == ({1: 0}, 20)
    assert [fault.kind for fault in drive.faults] == [FaultKind.BUSY, FaultKind.ERROR]


def test_documented_example_answers():
    """The example drive is busy twice, then answers P1120 = 10.0 to drive object 1 as well."""
    drive = example()
    assert drive.write_record(47, bytes.fromhex("03 01 01 01 10 00 04 60 00 00")) == 0
    drive.advance(20)
    assert [drive.read_record(47, 240)[0] for _ in range(2)] == [0xDE80B500] * 2
    assert drive.read_record(47, 240) == (0, bytes.fromhex("03 01 01 01 08 01 41 20 00 00"))


@pytest.mark.parametrize("kind", FaultKind)
def test_every_kind_is_documented(kind):
    """The page names every fault kind."""
    assert f"`{kind.value}`" in DOCUMENT.read_text(encoding="utf-8")


def test_defaults():
    """The smallest file makes a drive with the documented defaults."""
    drive = load_drive(MINIMAL)
    assert drive.habits == Habits()
    assert drive.objects[1].parameters[1].values == [5]
    assert (drive.habits.error_words, drive.habits.strict_length, drive.habits.error_table) == (
        2,
        True,
        "sinamics",
    )


def test_faults():
    """Fault keys arrive in the fault: for ever, hexadecimal data, wrong values, one word."""
    text = """\
faults:
  - {kind: junk, data: "01 FF", times: forever}
  - {kind: status, call: write, status: 16#DF80A100, times: 3, after: 1}
  - {kind: count, value: 9}
  - {kind: error, number: 16#6B, position: 2, words: 1}
"""
    assert load_drive(MINIMAL + text).faults == [
        Fault(FaultKind.JUNK, times=None, data=b"\x01\xff"),
        Fault(FaultKind.STATUS, times=3, after=1, call="write", status=0xDF80A100),
        Fault(FaultKind.COUNT, value=9),
        Fault(FaultKind.ERROR, number=0x6B, position=2, words=1),
    ]


def test_octets():
    """Octets are hexadecimal text."""
    text = 'objects: [{number: 1, parameters: [{pnu: 965, type: OctetString, value: "03 2A"}]}]'
    assert load_drive(text).objects[1].parameters[965].values == [b"\x03\x2a"]


def problems(text):
    """Return code, line, column and message of every problem."""
    with pytest.raises(DiagnosticError) as caught:
        load_drive(text, "drive.yaml")
    return [(d.code, d.span.line, d.span.column, d.message) for d in caught.value.diagnostics]


HEAD = "objects:\n  - number: 1\n    parameters:\n"


@pytest.mark.parametrize(
    ("text", "code", "line", "message"),
    [
        ("habit: 1\n" + HEAD, "PG104", 1, 'unknown key "habit"'),
        ("habits: {}\n", "PG105", 1, 'the drive lacks the key "objects"'),
        ("objects: []\n", "PG107", 1, '"objects": must have at least 1 item'),
        ("- 1\n", "PG106", 1, "a drive is a mapping"),
        ("objects: 5\n", "PG106", 1, 'expected a list instead of "5"'),
        ("objects:\n  - state: ready\n", "PG105", 2, 'lacks the key "number"'),
        ("objects:\n  - number: 256\n", "PG107", 2, '"number": must be less than or equal to 255, not "256"'),
        ("objects:\n  - number: 1\n  - number: 1\n", "PG107", 3, "drive object 1 appears twice"),
        (HEAD + "      - {type: Unsigned16, value: 1}\n", "PG105", 4, 'lacks the key "pnu"'),
        (HEAD + "      - {pnu: 1, value: 1}\n", "PG105", 4, 'lacks the key "type"'),
        (HEAD + "      - {pnu: 1, type: Unsigned16}\n", "PG105", 4, 'needs "value" or "values"'),
        (HEAD + "      - {pnu: 1, type: Real, value: 1}\n", "PG107", 4, '"Real" is no data type'),
        (HEAD + "      - {pnu: 1, type: Unsigned8, value: 256}\n", "PG107", 4, "from 0 to 255, not 256"),
        (HEAD + "      - {pnu: 1, type: Unsigned8, value: 1, high: 256}\n", "PG107", 4, "from 0 to 255"),
        (
            HEAD + "      - {pnu: 1, type: Unsigned8, value: 1, low: x}\n",
            "PG106",
            4,
            'expected a number instead of "x"',
        ),
        (HEAD + "      - {pnu: 1, type: OctetString, value: xyz}\n", "PG107", 4, "no hexadecimal text"),
        (
            HEAD + "      - {pnu: 1, type: Unsigned8, values: [1, 2], array: false}\n",
            "PG107",
            4,
            "is no array",
        ),
        (HEAD + "      - {pnu: 1, type: Unsigned8, value: 1, read_only: 1}\n", "PG106", 4, "true or false"),
        (HEAD + "      - {pnu: 1, type: Unsigned8, value: 1, name: 1}\n", "PG106", 4, "expected text"),
        (HEAD + "      - {pnu: 1, type: Unsigned8, value: 1, texts: [1]}\n", "PG106", 4, "expected text"),
        (
            HEAD + "      - {pnu: 1, type: Unsigned8, value: 1, refuse: [{error: 17}]}\n",
            "PG105",
            4,
            '"while" or "unless"',
        ),
        (
            HEAD + "      - {pnu: 1, type: Unsigned8, value: 1, saves: x}\n",
            "PG107",
            4,
            '"x" is not a value of "saves"',
        ),
        (HEAD + "      - {pnu: 1, type: Unsigned8, value: 1, state_limits: 5}\n", "PG106", 4, "expected a mapping"),
        (HEAD + "      - {pnu: 1.5, type: Unsigned8, value: 1}\n", "PG106", 4, "expected a whole number"),
        (
            HEAD + "      - &p {pnu: 1, type: Unsigned8, value: 1}\n      - *p\n",
            "PG107",
            4,
            "parameter 1 appears twice",
        ),
        (HEAD + "habits: {error_words: 3}\n", "PG107", 4, '"3" is not a value of "error_words"'),
        (HEAD + "habits: {aliases: {x: 1}}\n", "PG107", 4, "no drive object number"),
        (HEAD + "habits: {aliases: 5}\n", "PG106", 4, "expected a mapping"),
        (HEAD + "faults: [{kind: lazy}]\n", "PG107", 4, '"lazy" is not a value of "kind"'),
        (HEAD + "faults: [{times: 1}]\n", "PG105", 4, 'lacks the key "kind"'),
        (HEAD + "faults: [{kind: status}]\n", "PG105", 4, 'lacks the key "status"'),
        (HEAD + "faults: [{kind: junk, data: xx}]\n", "PG107", 4, "hexadecimal text"),
    ],
)
def test_problem(text, code, line, message):
    """A wrong drive file is refused with code, line and what is wrong."""
    found = [(c, at) for c, at, _, said in problems(text) if message in said]
    assert found == [(code, line)]


def test_all_problems_at_once():
    """Three mistakes are three diagnostics, each at its column."""
    text = HEAD + "      - {pnu: 0, type: Unsigned8, value: 300, colour: red}\n"
    assert [(code, line, column) for code, line, column, _ in problems(text)] == [
        ("PG107", 4, 15),
        ("PG107", 4, 42),
        ("PG104", 4, 47),
    ]
