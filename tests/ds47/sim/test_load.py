"""Drive files: the documented example, every fault kind, and problems with their positions."""

import re
from pathlib import Path

import pytest

from plcgen.base.diagnostics import DiagnosticError
from plcgen.ds47.sim.behaviour import Behaviour
from plcgen.ds47.sim.faults import Fault, FaultKind
from plcgen.ds47.sim.load import (
    BehaviourKeys,
    DriveKeys,
    FaultKeys,
    LimitsKeys,
    ObjectKeys,
    ParameterKeys,
    Refusal,
    load_drive,
)
from plcgen.ds47.sim.parameters import Condition, ValueLimits

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
    assert (ramp.values, ramp.limits, ramp.array) == ([10.0], ValueLimits(0.0, 650.0), False)
    assert ramp.state_limits == {"running": ValueLimits(0.5, 100.0)}
    assert ramp.conditions == (Condition(0x6B, while_in=frozenset({"enabled"})),)
    assert drive.objects[0].parameters[2155].array
    assert drive.behaviour.record_indexes == (47, 0xB02F)
    assert (drive.behaviour.aliases, drive.behaviour.processing) == ({1: 0}, 20)
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
    assert drive.behaviour == Behaviour()
    assert drive.objects[1].parameters[1].values == [5]
    assert (drive.behaviour.error_words, drive.behaviour.strict_length, drive.behaviour.error_table) == (
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
        ("behavior: 1\n" + HEAD, "PG104", 1, 'unknown key "behavior"'),
        ("behaviour: {}\n", "PG105", 1, 'the drive lacks the key "objects"'),
        ("objects: []\n", "PG107", 1, '"objects": must have at least 1 item'),
        ("- 1\n", "PG106", 1, "a drive is a mapping"),
        ("objects: 5\n", "PG106", 1, 'expected a list instead of "5"'),
        ("objects:\n  - state: ready\n", "PG105", 2, 'lacks the key "number"'),
        ("objects:\n  - number: 256\n", "PG107", 2, '"number": must be less than or equal to 255, not "256"'),
        ("objects:\n  - number: 1\n  - number: 1\n", "PG107", 3, "drive object 1 appears twice"),
        (HEAD + "      - {type: Unsigned16, value: 1}\n", "PG105", 4, 'lacks the key "pnu"'),
        (HEAD + "      - {pnu: 1, value: 1}\n", "PG105", 4, 'lacks the key "type"'),
        (HEAD + "      - {pnu: 1, type: Unsigned16}\n", "PG105", 4, 'needs "value" or "values"'),
        (HEAD + "      - {pnu: 1, type: Real, value: 1}\n", "PG107", 4, '"Real" is not a data type'),
        (HEAD + "      - {pnu: 1, type: Unsigned8, value: 256}\n", "PG107", 4, "from 0 to 255, not 256"),
        (HEAD + "      - {pnu: 1, type: Unsigned8, value: 1, high: 256}\n", "PG107", 4, "from 0 to 255"),
        (
            HEAD + "      - {pnu: 1, type: Unsigned8, value: 1, low: 5, high: 2}\n",
            "PG107",
            4,
            "limit 2 is below the lower limit 5",
        ),
        (
            HEAD + "      - {pnu: 1, type: Unsigned8, value: 1, low: x}\n",
            "PG106",
            4,
            'expected a number instead of "x"',
        ),
        (HEAD + "      - {pnu: 1, type: OctetString, value: xyz}\n", "PG107", 4, "is not hexadecimal text"),
        (
            HEAD + "      - {pnu: 1, type: Unsigned8, values: [1, 2], array: false}\n",
            "PG107",
            4,
            "is not an array",
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
        (HEAD + "behaviour: {error_words: 3}\n", "PG107", 4, '"3" is not a value of "error_words"'),
        (HEAD + "behaviour: {aliases: {x: 1}}\n", "PG107", 4, "is not a drive object number"),
        (HEAD + "behaviour: {aliases: 5}\n", "PG106", 4, "expected a mapping"),
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


WRONG = """\
behavior: {}
behaviour: {error_words: 3, answer_format: sizes, record_indexes: [65536,x], aliases: {x: 1, 2: 300}, local_object: 256,
  max_parameters: 0, record_limit: 9, multi_supported: 1, attributes: 16, error_table: siemens,
  processing: -1, fast: true}
objects:
  - {number: 256, state: 5}
  - number: 1
    parameters:
      - {type: Unsigned16, value: 1}
      - {pnu: 1, type: Real, value: 1}
      - {pnu: 2, type: Unsigned8, value: 256, low: -1, high: 300}
      - {pnu: 3, type: Unsigned8}
      - {pnu: 4, type: Unsigned8, value: 1, values: [1]}
      - {pnu: 5, type: Unsigned8, values: [1, 256, x]}
      - {pnu: 6, type: OctetString, value: xyz}
      - {pnu: 7, type: Unsigned8, values: [1, 2], array: false}
      - {pnu: 8, type: Unsigned8, value: 1, state_limits: {run: {low: 300, lo: 1}}}
      - {pnu: 9, type: Unsigned8, value: 1, allowed: [1, 300]}
      - {pnu: 10, type: Unsigned8, value: 1, refuse: [{error: 17}, {while: [a]}]}
      - {pnu: 2, type: Unsigned8, value: 1, maximum: 5}
      - {pnu: 11, type: Unsigned8, value: 1, saves: all, clears_after: 1.5}
  - {number: 1}
faults:
  - {kind: bussy}
  - {kind: status}
  - {kind: junk, data: xx}
  - {kind: busy, times: never, after: -1}
"""

MISTAKES = [
    ("PG104", 1, 1, 'unknown key "behavior" in the drive'),
    ("PG107", 2, 26, '"3" is not a value of "error_words"'),
    ("PG107", 2, 44, '"sizes" is not a value of "answer_format"'),
    ("PG107", 2, 68, '"record_indexes": must be less than or equal to 65535, not "65536"'),
    ("PG106", 2, 74, 'expected a whole number instead of "x"'),
    ("PG107", 2, 88, '"x" is not a drive object number'),
    ("PG107", 2, 97, '"2": must be less than or equal to 255, not "300"'),
    ("PG107", 2, 117, '"local_object": must be less than or equal to 255, not "256"'),
    ("PG107", 3, 19, '"max_parameters": must be greater than or equal to 1, not "0"'),
    ("PG107", 3, 36, '"record_limit": must be greater than or equal to 10, not "9"'),
    ("PG106", 3, 56, 'expected true or false instead of "1"'),
    ("PG106", 3, 71, 'expected a list instead of "16"'),
    ("PG107", 3, 88, '"siemens" is not a value of "error_table"'),
    ("PG107", 4, 15, '"processing": must be greater than or equal to 0, not "-1"'),
    ("PG104", 4, 19, 'unknown key "fast" in behaviour'),
    ("PG107", 6, 14, '"number": must be less than or equal to 255, not "256"'),
    ("PG106", 6, 26, 'expected text instead of "5"'),
    ("PG105", 9, 9, 'objects.1.parameters.0 lacks the key "pnu"'),
    ("PG107", 10, 24, '"Real" is not a data type'),
    ("PG107", 11, 42, "Unsigned8 takes an integer from 0 to 255, not 256"),
    ("PG107", 11, 52, "Unsigned8 takes an integer from 0 to 255, not -1"),
    ("PG107", 11, 62, "Unsigned8 takes an integer from 0 to 255, not 300"),
    ("PG105", 12, 9, 'a parameter needs "value" or "values"'),
    ("PG107", 13, 53, 'a parameter has "value" or "values", not both'),
    ("PG107", 14, 47, "Unsigned8 takes an integer from 0 to 255, not 256"),
    ("PG107", 14, 52, "Unsigned8 takes an integer from 0 to 255, not 'x'"),
    ("PG107", 15, 44, '"xyz" is not hexadecimal text'),
    ("PG107", 16, 58, "the parameter is not an array but has 2 values"),
    ("PG104", 17, 76, 'unknown key "lo" in objects.1.parameters.8.state_limits.run'),
    ("PG107", 18, 58, "Unsigned8 takes an integer from 0 to 255, not 300"),
    ("PG105", 19, 55, 'a refusal needs "while" or "unless" with states'),
    ("PG105", 19, 68, 'objects.1.parameters.10.refuse.1 lacks the key "error"'),
    ("PG107", 20, 15, "parameter 2 appears twice"),
    ("PG104", 20, 45, 'unknown key "maximum" in objects.1.parameters.11'),
    ("PG107", 21, 53, '"all" is not a value of "saves"'),
    ("PG106", 21, 72, 'expected a whole number instead of "1.5"'),
    ("PG107", 22, 14, "drive object 1 appears twice"),
    ("PG107", 24, 12, '"bussy" is not a value of "kind"'),
    ("PG105", 25, 5, 'a fault of the kind status lacks the key "status"'),
    ("PG107", 26, 24, "bytes are hexadecimal text"),
    ("PG107", 27, 25, '"never" is not a value of "times"'),  # a whole number or forever
    ("PG107", 27, 39, '"after": must be greater than or equal to 0, not "-1"'),
]
"""Written by hand, next to the text: code, line, column, how the message begins."""


def test_every_mistake_is_told_in_one_run():
    """More than 30 kinds of mistakes: each is one diagnostic at its line and column."""
    found = problems(WRONG)
    assert [entry[:3] for entry in found] == [entry[:3] for entry in MISTAKES]
    assert [said[: len(start)] for (*_, said), (*_, start) in zip(found, MISTAKES, strict=True)] == [
        start for *_, start in MISTAKES
    ]


def test_every_key_is_described():
    """docs/drive-yaml.md names every key that a file may have."""
    page = DOCUMENT.read_text(encoding="utf-8")
    keys = set()
    for model in (DriveKeys, BehaviourKeys, ObjectKeys, ParameterKeys, LimitsKeys, Refusal, FaultKeys):
        keys |= {info.alias or name for name, info in model.model_fields.items()}
    assert {key for key in keys if not re.search(rf"\b{key}\b", page)} == set()
