"""Whole lists of parameters: how they are made, what they say, and where a row made by hand says something else."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47 import lists
from plcgen.ds47.device import Parameter, device_hint
from plcgen.ds47.devices import device_names, find_device
from plcgen.ds47.types import read_type
from tests.evidence import parameters as tool

_OLD = """### {head}

|  |  |  |
| --- | --- | --- |
| **Can be changed:**{changed} | **Calculated:**- | **Access level:**3 |
| **Data type:**{type} | **Dynamic index:**{index} | **Func. diagram:** - |
| **Object:**{objects} | **P-Group:**- | **Version:**5207320 |
| **Not for motor type:**- | **Scaling:**- | **Expert list:**1 |
| **Min** | **Max** | **Factory setting** |
| {low} | {high} | {default} |

**Description:**

Toy.
"""
_NEW = """#### {head}

| **Variant:**{variant} |  |  |
| **Data type:**{type} | **Visible in:**Standard display |  |
| **Can be changed in the operating state:**Operation |  |  |
| **Dyn. index [0…n]:** - |  | **Calculated:** - |
| **Unit:** {unit} | **Unit group:** - | **Unit selection:** - |
| **Min:** | **Max:** | **Factory setting:** |
| {low} [{unit}] | {high} [{unit}] | [0] {default} [{unit}] |

**Value:**

0:
none &lt; 1
{value}

"""


def _made(*texts: str) -> list[dict[str, str]]:
    """Lines of a list that are made from help as text."""
    first, heading, *lines = tool.text("# Toy 5, list of parameters", "\n".join(texts)).splitlines()
    assert (first, heading) == ("# Toy 5, list of parameters", "\t".join(lists.COLUMNS))
    padded = (line.split("\t") + [""] * len(lists.COLUMNS) for line in lines)
    return [dict(zip(lists.COLUMNS, line, strict=False)) for line in padded]


def _old(head: str, type_: str, index: str, objects: str, *limits: str, changed: str = "T") -> str:
    low, high, default = limits
    return _OLD.format(
        head=head, type=type_, index=index, objects=objects, low=low, high=high, default=default, changed=changed
    )


def test_a_list_becomes_facts_by_number() -> None:
    """Types are those of the wire, limits decimal, a signal source is marked, function modules are left out."""
    rows = _made(
        _old(
            "p1300[0...n] Control mode",
            "Integer16",
            "DDS, p0180",
            "VECTOR, SERVO_AC",
            "0000 hex",
            "0013 hex",
            "[ 0 ] 0",
        ),
        _old("p0840[0...n] BI: ON", "Unsigned32 / Binary", "CDS, p0170", "CU_S120_PN, SERVO (EPOS)", "-", "-", "722.0"),
        _old("r0948[0...63] Fault time", "Unsigned32", "-", "All objects (FBLOCKS)", "- [ms]", "- [ms]", "[ ] - [ms]"),
        _old("p0007 Gain", "FloatingPoint32", "-", "-", "0.5 [1000 rpm]", "3.4E99 [1000 rpm]", "[ 0 ] 1.5 [ 1 ] 2"),
    )
    assert [row["number"] for row in rows] == ["7", "840", "948", "1300"]
    gain, signal, fault, mode = rows
    assert [gain[key] for key in ("type", "min", "max", "default", "unit")] == [
        "FloatingPoint",
        "0.5",
        "",
        "",
        "1000 rpm",
    ]
    assert (signal["type"], signal["bico"], signal["array"]) == ("Unsigned32", "bico", "CDS")
    assert signal["objects"] == "CU_S120 SERVO"
    assert (fault["type"], fault["array"], fault["objects"]) == ("TimeDifference", "64", "ALL")
    assert (fault["unit"], fault["letter"], fault["title"]) == ("ms", "r", "Fault time")
    assert (mode["min"], mode["max"], mode["default"], mode["objects"]) == ("0", "19", "0", "VECTOR")


def test_what_differs_between_variants_is_no_fact() -> None:
    """Limits are the widest, names those of both; a unit and a factory setting that differ are left out."""
    head = "p2573 Greatest deceleration"
    linear = _NEW.format(
        head=head, variant="Toy", type="Unsigned16", unit="mm/s²", low=1, high=20, default=4, value="1:\nm"
    )
    rotating = _NEW.format(
        head=head, variant="Toy (rotating)", type="Unsigned16", unit="°/s²", low=0, high=9, default=5, value="2:\n°"
    )
    (row,) = _made(f"### {head}\n\n{linear}{rotating}## Page 2\n\nPage 2\n")
    assert [row[key] for key in ("type", "min", "max", "unit", "default")] == ["Unsigned16", "0", "20", "", ""]
    assert (row["title"], row["values"]) == ("Greatest deceleration", "0=none < 1; 1=m; 2=°")


def test_variants_of_different_objects_are_lines_of_their_own() -> None:
    """An object for which both speak gets what both say; one for which one speaks, what this one says."""
    both = _old("", "Integer16", "-", "VECTOR, VECTOR_G", "0", "19", "[ 0 ] 0").replace("### ", "#### p1300 Mode")
    module = _old("", "Integer16", "-", "VECTOR (n/M)", "0", "23", "[ 0 ] 20").replace("### ", "#### p1300 Mode")
    rows = _made(f"### p1300 Mode\n\n{both}\n{module}")
    assert [(row["objects"], row["max"], row["default"]) for row in rows] == [
        ("VECTOR_G", "19", "0"),
        ("VECTOR", "23", ""),
    ]


def test_no_cell_has_more_than_its_fact() -> None:
    """No heading, no part of a table and no link of a page has become part of a name."""
    lines = [line for path in lists.FOLDER.glob("*.tsv") for line in path.read_text("utf-8").splitlines()[2:]]
    assert len(lines) > 14_000
    assert [line for line in lines if re.search(r"##|\| |\*\*|\]\(|SINAMICS Parameter", line)] == []


@pytest.mark.parametrize(
    ("name", "number", "low", "high"),
    [
        ("s200_pn", 2573, "0.001", "2000000.0"),  # 0.001 to 2e6 mm/s²; 0.001 to 2e6 °/s² of a rotating axis
        ("s210_fw6", 2573, "0.001", "2000000.0"),
        ("vector", 1300, "0", "23"),  # 0 to 19, 0 to 23 with the function module for speed control
        ("g220", 9530, "0.0", "100.0"),  # mm, or °
    ],
)
def test_facts_hold_for_every_variant(name: str, number: int, low: str, high: str) -> None:
    """As printed in the lists of the TIA Portal information system (V19)."""
    said = next(one for one in lists.find(name, number) if not one.objects or "VECTOR" in one.objects).texts
    assert [said[key] for key in ("min", "max", "unit")] == [low, high, ""]


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("Output value = -300 °C", "output_value_minus_300_deg_c"),
        ("m/s²", "m_s2"),
        ("µm", "um"),
        ("Mode as for version < 4.5", "mode_as_for_version_below_4_5"),
        ("SIEMENS telegram 370, PZD-1/1", "siemens_telegram_370_pzd_1_1"),
        ("Operation --> r0021", "operation_r0021"),
    ],
)
def test_a_name_keeps_what_decides(text: str, name: str) -> None:
    """A sign that changes the meaning becomes a word."""
    assert lists.value_name(text) == name


@pytest.mark.parametrize(
    ("name", "number", "letter", "type_", "array", "low", "high", "unit"),
    [
        ("vector", 1120, "p", "FloatingPoint", "DDS", "0.0", "999999.0", "s"),
        ("vector", 2507, "p", "Integer16", "EDS", "0", "4", ""),
        ("g220", 840, "c", "Unsigned8", "CDS", "", "", ""),
        ("g220", 1300, "p", "Integer16", "DDS", "0", "23", ""),
        ("g220", 948, "r", "TimeDifference", "64", "", "", "ms"),
    ],
)
def test_the_lists_say_what_is_printed(
    name: str, number: int, letter: str, type_: str, array: str, low: str, high: str, unit: str
) -> None:
    """Facts as they are in the lists of the TIA Portal information system (V19)."""
    said = lists.find(name, number)[0].texts
    facts = [said[key] for key in ("letter", "type", "array", "min", "max", "unit")]
    assert facts == [letter, type_, array, low, high, unit]


def test_names_of_values_bits_and_objects() -> None:
    """The operating display of a G220, its status word, and a number with one line for each kind of infeed."""
    assert lists.find("g220", 2)[0].names("values")[31] == 'Ready for switching on - Set "ON/OFF1" = "0/1" (c0840)'
    assert lists.find("g220", 899)[0].names("bits")[0] == "Ready for switching on (No/Yes)"
    assert [one.objects for one in lists.find("a_inf", 2)] == [{"A_INF", "S_INF"}, {"B_INF"}]
    assert lists.find("g220", 971) == []


def test_firmware_6_of_an_s210_is_the_list_with_the_letter_c() -> None:
    """Package sdrpa401, whose parameters exist since 6.1; sdrpa400 begins with 5.1 and has no c."""
    assert lists.find("s210_fw6", 2530)[0].texts["letter"] == "c"
    assert "sdrpa401" in lists.source("s210_fw6")
    assert "sdrpa400" in lists.source("s210_fw5")


@pytest.mark.parametrize("name", lists.names())
def test_every_line_of_a_list_can_be_used(name: str) -> None:
    """Numbers ascend, types are types of the wire, limits are in order, no line has a column too many."""
    lines = (lists.FOLDER / f"{name}.tsv").read_text("utf-8").splitlines()
    assert lines[0].startswith("# ")
    assert lines[1].split("\t") == list(lists.COLUMNS)
    before = 0
    for line in lines[2:]:
        row = dict(zip(lists.COLUMNS, line.split("\t"), strict=False))
        assert line.count("\t") < len(lists.COLUMNS)
        assert before <= int(row["number"]) <= 65535
        before = int(row["number"])
        read_type(row["type"])
        if row.get("min") and row.get("max"):
            assert float(row["min"]) <= float(row["max"]), line


_LISTS = {
    "sinamics-s120": ("vector", "cu", "a_inf", "tb30", "tm15", "tm31", "tm41", "tm120", "tm150"),
    "sinamics-s150": ("vector", "cu"), "sinamics-g130": ("vector", "cu"), "sinamics-g150": ("vector", "cu"),
    "sinamics-s210": ("s210_fw5",), "sinamics-s210-fw6": ("s210_fw6",), "sinamics-g220": ("g220",),
    "sinamics-g220-clean-power": ("g220_clean_power",), "sinamics-s200": ("s200_pn",),
    "sinamics-s200-basic": ("s200_basic_pn",),
}  # fmt: skip
_WHY = {("sinamics-s210", 980): "r0980 is printed for firmware 6.3, but in none of these lists"}
"""Rows that say something else than the lists, and why."""


def _says(row: Parameter, listed: lists.Listed) -> bool:
    texts = listed.texts
    limits = {"min": row.minimum, "max": row.maximum}
    same = all(
        (float(texts[key]) if texts[key] else None) == value for key, value in limits.items() if value is not None
    )
    return texts["type"] == row.type and same


@pytest.mark.parametrize("device", _LISTS)
def test_rows_by_hand_and_lists_agree(device: str) -> None:
    """Type and limits that were read by hand are those of the list, but for the pairs that are named here."""
    wrong = set()
    for number, row in find_device(device).parameters.items():
        said = [one for name in _LISTS[device] for one in lists.find(name, number)]
        if row.read("type") and not any(_says(row, one) for one in said):
            wrong.add((device, number))
    assert wrong == {pair for pair in _WHY if pair[0] == device}


def _checked(tmp_path: Path, device: str, job: str, drive: str = "") -> list[tuple[str, str, str]]:
    spec = tmp_path / "job.yaml"
    head = "plc: {name: a, family: s7-1500, toolchain: tia-v19}\n"
    drives = f"drives: {{d: {{device: {device}, hardware_id: 270{drive}}}}}\n"
    spec.write_text(f"{head}{drives}jobs: {{j: {{drive: d, {job}}}}}\n", "utf-8")
    return [(one.severity.name, one.code, one.message) for one in api.check(spec).diagnostics]


@pytest.mark.parametrize(
    ("device", "drive", "job"),
    [
        ("sinamics-s120", ", object_type: vector", "read: [r32, p1520, r63]"),
        ("sinamics-g220", "", "read: [c840, r722, r63]"),
        ("sinamics-g120", "", "read: [P2507]"),
        ("sinamics-s200", "", "read: [P2507]"),
        ("sinamics-dcm", "", "read: [p116, p147]"),
    ],
)
def test_a_number_of_a_list_needs_no_type(tmp_path: Path, device: str, drive: str, job: str) -> None:
    """Its list knows it, or that of the device that it is held for."""
    assert [one for one in _checked(tmp_path, device, job, drive) if one[0] == "ERROR"] == []


@pytest.mark.parametrize(
    ("device", "drive", "job"),
    [
        ("sinamics-g220", "", "read: [r20, P971]"),
        ("sinamics-g220", "", "read: [{parameter: P971, type: Unsigned16}]"),
        ("sinamics-s210", "", "read: [P1120]"),
        ("sinamics-s150", "", "read: [P1118]"),
        ("sinamics-s120", ", object_type: vector", "read: [P1118]"),
    ],
)
def test_what_a_whole_list_lacks_is_known_to_be_absent(tmp_path: Path, device: str, drive: str, job: str) -> None:
    """An error that names the list, also if a type is given."""
    ((severity, code, message),) = _checked(tmp_path, device, job, drive)
    assert (severity, code) == ("ERROR", "PG262")
    assert "TIA Portal information system" in message


def test_where_no_list_is_whole_a_number_stays_unknown(tmp_path: Path) -> None:
    """An axis of an S120 may be a SERVO; a definition in the spec says that a drive has a number all the same."""
    assert [one[1] for one in _checked(tmp_path, "sinamics-s120", "compare: {P4999: 1}")] == ["PG204"]
    own = ", parameters: {P971: {type: Unsigned16}}"
    assert [one for one in _checked(tmp_path, "sinamics-g220", "read: [P971]", own) if one[0] == "ERROR"] == []


@pytest.mark.parametrize("device", ["sinamics-g120", "sinamics-s120", "sinamics-v90"])
def test_limits_that_nobody_read_warn(tmp_path: Path, device: str) -> None:
    """Ramps and speeds below zero: no device takes them, and none is silent about it."""
    for number in (1120, 1121, 1082):
        job = f"write: {{P{number}: -5.0}}, allow: {{P{number}: test}}"
        found = [one for one in _checked(tmp_path, device, job) if one[1] == "PG209"]
        assert [one[0] for one in found] == ["WARNING"], number


def test_limits_that_were_read_are_errors(tmp_path: Path) -> None:
    """The list of VECTOR: p1520 of an S150 is up to 20000000 Nm; p1120 of a G220 begins at 0."""
    assert ("ERROR", "PG209") in [one[:2] for one in _checked(tmp_path, "sinamics-g220", "write: {P1121: -1.0}")]


def test_a_missing_type_is_not_invented(tmp_path: Path) -> None:
    """p4999 is in no list: what helps is to look it up."""
    spec = tmp_path / "job.yaml"
    _checked(tmp_path, "sinamics-s120", "read: [P4999]")
    (found,) = api.check(spec).diagnostics
    assert "type: .." in found.help
    assert "FloatingPoint" not in found.help


@pytest.mark.parametrize(
    ("name", "meant"),
    [("sinamics-g221", ""), ("sinamics-g120p", ""), ("sinamics-v120", ""), ("g120", "g120"), ("sinmics-s210", "s210")],
)
def test_no_device_is_taken_for_another(name: str, meant: str) -> None:
    """A slip of the pen gets a name; another letter or number of a product does not."""
    assert device_hint(name, device_names()) == (f'did you mean "sinamics-{meant}"?' if meant else "")


def test_an_encoder_gets_the_preset_that_its_manual_prints(tmp_path: Path) -> None:
    """HEIDENHAIN, PROFINET user manual p. 53, table 25: a change of P65000, format 04h (Integer32), one value; the
    drive object is 00h (Baumer AMG11 p. 32), one parameter for each request (r974[1] = 1).
    """
    spec = tmp_path / "job.yaml"
    spec.write_text(
        "plc: {name: Roll, family: s7-1500, toolchain: tia-v19}\n"
        "drives: {enc: {device: profidrive-encoder, hardware_id: 270}}\n"
        "jobs:\n  preset: {drive: enc, write: {preset_value: 1000}}\n  look: {drive: enc, read: ['r65001[1]', P971]}\n",
        "utf-8",
    )
    result = api.encode(spec)
    assert not result.diagnostics
    assert [one.data.hex(" ") for one in result.telegrams] == [
        "01 02 00 01 10 01 fd e8 00 00 04 01 00 00 03 e8",
        "01 01 00 01 10 01 fd e9 00 01",
        "02 01 00 01 10 01 03 cb 00 00",
    ]


_ASKED = [
    int(word)
    for line in (Path(__file__).parent / "asked.txt").read_text("utf-8").splitlines()
    if not line.startswith("#")
    for word in line.split()
]


@pytest.mark.parametrize(
    ("device", "least", "whole"),
    [
        *((f"sinamics-{name}", 100, True) for name in ("s150", "g130", "g150")),
        ("sinamics-s120", 100, False),
        ("sinamics-g120", 95, False),
        *((f"sinamics-{name}", 0, True) for name in ("g220", "s210", "s210-fw6", "s200", "s200-basic")),
    ],
)
def test_what_engineers_ask_for_is_known(device: str, least: int, whole: bool) -> None:
    """Of 102 parameters; where lists were read whole the others are known to be absent."""
    found = find_device(device)
    types = [found.object_types.others, "control_unit"] if found.object_types else [""]
    unknown = [number for number in _ASKED if not any(found.find(number, one) for one in ("", *types))]
    assert len(_ASKED) == 102
    assert len(_ASKED) - len(unknown) >= least
    assert not whole or all(found.absent(number, one) for number in unknown for one in types), unknown


@pytest.mark.parametrize(
    "device", ["sinamics-s120", "sinamics-g130", "sinamics-g220", "sinamics-s200", "sinamics-s210"]
)
def test_a_job_waits_for_a_value_by_its_name(tmp_path: Path, device: str) -> None:
    """r0002 = 0 is "Operation - everything enabled" in every list; what only another device's list says is no name."""
    assert find_device(device).find(2).values["operation"] == 0
    assert "values" in find_device("sinamics-g120").find(2).doubted
    drive = ", drive_object: 3" if device == "sinamics-s120" else ""
    assert [
        one for one in _checked(tmp_path, device, "sequence: [{until: {r2: operation}}]", drive) if one[0] == "ERROR"
    ] == []
