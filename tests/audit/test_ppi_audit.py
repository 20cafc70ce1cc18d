"""PPI masters written by hand: two programs that are right, and every damage to them with its code and its place.

Their telegrams are those of an article, as its checksums confirm them; the cases say where their figures come from.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import plcgen
from plcgen.base.diagnostics.codes import all_codes
from plcgen.proof.checks import Outcome
from tests.projects import SPECS, generated_example
from tests.yaml_files import read_yaml

HERE = Path(__file__).parent / "ppi"
CODES = [code for code in all_codes() if code.startswith("PG67")]
CASES = [(code, case) for code in CODES for case in read_yaml((HERE / "cases" / f"{code}.yaml").read_text("utf-8"))]
RIGHT = ["cp341", "cm1241"]
OWN = [path for path in SPECS if "ppi" in path.stem]


def damaged(folder: Path, program: str, file: str, edits: list[list[str]]) -> Path:
    """A copy of a program with a few texts replaced, each once."""
    copy = folder / program
    shutil.copytree(HERE / program, copy)
    text = (copy / file).read_text("utf-8")
    for old, new in edits:
        assert old in text, old
        text = text.replace(old, new, 1)
    (copy / file).write_text(text, "utf-8")
    return copy


def audited(program: str, path: Path):
    return plcgen.audit(path, spec=HERE / f"{program}.yaml")


@pytest.mark.parametrize("program", RIGHT)
def test_a_right_program_passes(program: str) -> None:
    """Nothing is found; the telegrams are known by their jobs, the calls by what they send."""
    result = audited(program, HERE / program)
    assert result.diagnostics == ()
    assert {check.outcome for check in result.checks()} == {Outcome.OK}
    verdicts = [check.verdict for check in result.checks()]
    for wanted, count in (("telegram of read_vb100", 1), ("telegram of write_vb100", 1), ("sends ", 3)):
        assert sum(wanted in verdict for verdict in verdicts) == count


@pytest.mark.parametrize(("code", "case"), CASES, ids=lambda value: value if isinstance(value, str) else value["name"])
def test_damage(tmp_path: Path, code: str, case: dict) -> None:
    """One mistake, one finding, where it is."""
    path = damaged(tmp_path, case["program"], case["file"], case["edits"])
    found = audited(case["program"], path).diagnostics
    assert [d.code for d in found] == [code], [d.message for d in found]
    assert case["says"] in found[0].message
    assert found[0].help
    assert Path(found[0].span.file).name == case["file"]
    if "place" in case:
        assert [found[0].span.line, found[0].span.column] == case["place"]


@pytest.mark.parametrize("spec", OWN, ids=lambda path: path.stem)
@pytest.mark.parametrize("form", ["text", "documents"])
def test_what_plcgen_generates_is_right(spec: Path, form: str) -> None:
    """Every job has its telegram, nothing is found."""
    folder = generated_example(spec.stem)
    paths = [folder / "xml"] if form == "documents" else [folder / name for name in ("db", "udt", "scl")]
    result = plcgen.audit(*paths, spec=spec)
    assert result.diagnostics == ()
    telegrams = [check for check in result.checks() if check.id.startswith("ppi.")]
    assert {check.outcome for check in telegrams} == {Outcome.OK}


def test_another_protocol_with_the_same_start_bytes(tmp_path: Path) -> None:
    """68 LE LE 68 begins a frame of M-Bus (EN 13757-2), too: 68 03 03 68 53 01 51 A5 16 is none of PPI."""
    (tmp_path / "mbus.db").write_text(
        """DATA_BLOCK "MBus"
{ S7_Optimized_Access := 'FALSE' }
VERSION : 0.1
  STRUCT
    frame : Array[0..8] of Byte := [16#68, 16#03, 16#03, 16#68, 16#53, 16#01, 16#51, 16#A5, 16#16];
  END_STRUCT;
BEGIN
END_DATA_BLOCK
""",
        "utf-8",
    )
    result = audited("cm1241", tmp_path)
    assert result.diagnostics == ()
    assert {check.outcome for check in result.checks()} == {Outcome.NOT_RUN}


def test_another_module_is_left_alone(tmp_path: Path) -> None:
    """A port that is not that of the master serves another protocol: its buffer may be as short as it likes."""
    path = damaged(
        tmp_path, "cm1241", "PpiPort.scl", [[":= 270;", ":= 271;"], ['BUFFER := "Line".answer', "BUFFER := #step"]]
    )
    result = audited("cm1241", path)
    assert result.diagnostics == ()
    assert [c.verdict for c in result.checks() if c.subject.startswith("Receive")] == [
        "fits; module #CM_PORT is not that of a master"
    ]


def test_a_frame_count_bit_that_does_not_change_is_noted(tmp_path: Path) -> None:
    """7Ch in a table: right as it stands, once: a station answers the same bit with the same answer (EN 50170)."""
    path = damaged(tmp_path, "cp341", "PPI.AWL", [["B#16#00, B#16#6C,", "B#16#00, B#16#7C,"], ["B#16#8B", "B#16#9B"]])
    result = audited("cp341", path)
    assert result.diagnostics == ()
    assert "the program must change the frame count bit" in next(iter(result.checks())).verdict


def test_every_finding_at_once(tmp_path: Path) -> None:
    """Several mistakes in several blocks are one report."""
    edits = [["B#16#8B", "B#16#8A"], [":= 34,", ":= 94,"], ["[0 .. 254]", "[0 .. 15]"]]
    found = audited("cp341", damaged(tmp_path, "cp341", "PPI.AWL", edits)).diagnostics
    assert sorted(d.code for d in found) == ["PG671", "PG674", "PG675"]


def test_a_checksum_that_the_program_adds_up_is_no_finding(tmp_path: Path) -> None:
    """A table with a member for each field: ``fc`` has a start value, ``fcs`` has none, which is not one of 0."""
    pdu = bytes.fromhex("32 01 00 00 00 00 00 0E 00 00 04 01 12 0A 10 02 00 01 00 01 84 00 03 20")
    start = ", ".join(f"16#{byte:02X}" for byte in pdu)
    begin = {"sd": "68", "le": "1B", "ler": "1B", "sdr": "68", "da": "02", "sa": "00", "fc": "6C", "ed": "16"}
    lines = "\n".join(f"  {name} := 16#{value};" for name, value in begin.items())
    (tmp_path / "table.db").write_text(
        f"""DATA_BLOCK "Table"
{{ S7_Optimized_Access := 'FALSE' }}
VERSION : 0.1
  STRUCT
    reserve, sd, le, ler, sdr, da, sa, fc : Byte;
    pdu : Array[0..23] of Byte := [{start}];
    fcs, ed : Byte;
  END_STRUCT;
BEGIN
{lines}
END_DATA_BLOCK
""",
        "utf-8",
    )
    result = audited("cm1241", tmp_path)
    assert result.diagnostics == ()
    assert next(iter(result.checks())).verdict == "a right telegram of read_vb100; 1 of its bytes come at run time"
