"""Generated files: the committed examples byte for byte or by hash, every target, reproducible."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import pytest

from plcgen import api
from plcgen.s7.layout.layout import layout_block
from plcgen.s7.read.text import read_source
from plcgen.s7.types.data_types import StructType
from plcgen.s7.xml.spelling import declared_name
from tests.projects import FAQ, MM4, ROOT, SPECS, TARGETS, every_type, generated_example, retargeted
from tests.xsd_support import validate_islands


def tree(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def generated(text: str, folder: Path) -> Path:
    spec = folder / "job.yaml"
    spec.write_text(text, encoding="utf-8")
    result = api.generate(spec, folder / "out")
    assert result.ok, [f"{d.span} {d.code} {d.message}" for d in result.diagnostics]
    return folder / "out"


@pytest.mark.parametrize("spec", SPECS, ids=lambda p: p.stem)
def test_examples_are_what_the_shipped_specs_generate(spec: Path, tmp_path: Path) -> None:
    """The bytes are those of examples/<name>/expected, or have the hashes of examples/<name>/manifest.json."""
    assert api.generate(spec, tmp_path / "out").ok
    found, committed = tree(tmp_path / "out"), ROOT / "examples" / spec.stem
    if (committed / "expected").exists():
        assert found == tree(committed / "expected")
    else:
        manifest = (committed / "manifest.json").read_bytes()
        wanted = {entry["path"]: entry["sha256"] for entry in json.loads(manifest)["files"]}
        hashes = {name: hashlib.sha256(data).hexdigest() for name, data in found.items() if name != "manifest.json"}
        changed = sorted(name for name in {*wanted, *hashes} if wanted.get(name) != hashes.get(name))
        assert changed == [], "make example-diff shows every line that differs from the last commit"
        assert found["manifest.json"] == manifest


@pytest.mark.slow
def test_no_generated_member_needs_quotes() -> None:
    """The TIA Portal has names of members in quotes that are words of SCL or of its own: DB is one of them."""
    sources = [path for spec in SPECS for path in generated_example(spec.stem).rglob("*.scl")]
    declared = {
        member.name
        for path in sources
        for block in read_source(path)[0]
        for section in block.sections
        for outer in section.members
        for member in (outer, *(outer.type.members if isinstance(outer.type, StructType) else ()))
    }
    assert len(declared) > 300
    assert [name for name in sorted(declared) if declared_name(name) != name] == []


def test_two_examples_are_complete() -> None:
    """One for each family of tools: what a reader can see without running anything."""
    complete = {path.parent.name for path in (ROOT / "examples").glob("*/expected")}
    assert complete == {"s7-300_6ra80_dp_tia", "s7-1500_g120_pn"}


@pytest.mark.parametrize("target", TARGETS)
def test_two_runs_give_identical_bytes(target: str, tmp_path: Path) -> None:
    """No clock, path, user or hash order gets into the output."""
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    first, second = generated(every_type(target), tmp_path / "a"), generated(every_type(target), tmp_path / "b")
    assert tree(first) == tree(second)
    assert not any(str(tmp_path).encode() in data for data in tree(first).values())


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("spec", [FAQ, MM4], ids=lambda p: p.stem)
def test_the_same_job_generates_for_every_toolchain(spec: Path, target: str, tmp_path: Path) -> None:
    """The seeds' jobs for STEP 7 V5, S7-400, S7-1200 and S7-1500: the sources parse in the target's dialect and run.

    Runs with faults are the matter of tests/proof.
    """
    out = generated(retargeted(spec, target), tmp_path)
    result = api.verify(tmp_path / "job.yaml", out, faults="none")
    assert [c.verdict for c in result.checks() if c.outcome.value in {"error", "warning"}] == []
    assert result.ok


@pytest.mark.slow
@pytest.mark.parametrize("target", [target for target in TARGETS if target not in {"v5", "t15"}])
def test_every_data_type_verifies_on_other_targets(target: str, tmp_path: Path) -> None:
    """Every DS47 type as single value and array, constant and input, in split and unsplit jobs.

    Those three run with faults, too: tests/proof/test_execution.py.
    """
    out = generated(every_type(target), tmp_path)
    result = api.verify(tmp_path / "job.yaml", out, faults="none")
    assert [f"{c.subject}: {c.verdict}" for c in result.checks() if c.outcome.value in {"error", "warning"}] == []


GERMAN = """
plc: {name: Halle, family: s7-1500, toolchain: tia-v18, languages: [de-DE, zh-CN]}
drives:
  pump: {device: sinamics-g120, hardware_id: 270, parameters: {P2907: {type: "VisibleString[6]"}}}
jobs:
  set_label: {drive: pump, write: {P1120: null, P2907: "ab|c_d"}}
"""


def test_texts_that_nobody_translated_and_bars_in_values(tmp_path: Path) -> None:
    """Documents without English leave English comments out; a bar in a value divides no cells of IMPORT.md."""
    (tmp_path / "job.yaml").write_text(GERMAN, encoding="utf-8")
    assert api.generate(tmp_path / "job.yaml").ok
    result = api.verify(tmp_path / "job.yaml", faults="none")
    assert [f"{c.subject}: {c.verdict}" for c in result.checks() if c.outcome.value in {"error", "warning"}] == []


REQUEST = "Request_Ref@0 Request_ID@1 Axis@2 Num_of_Para@3 Para_Attribute@4 Num_of_Element@5 Para_No@6 Subindex@8"
MIRROR = "Request_Ref_Mirror@0 Request_ID@1 Axis_Mirror@2"
FIGURES = {
    "WR_DataBuffer": REQUEST,
    "RD_DataBuffer": f"{MIRROR} Num_of_para@3 Para_Format@4 Num_of_Element@5 ParameterValue@6",
    "WR_DataBuffer_1": f"{REQUEST} Value_Format@10 No_of_Element@11 Value@12",
    "RD_DataBuffer_1": f"{MIRROR} Num_of_Para@3",
}
LENGTHS = {"WR_DataBuffer": 10, "RD_DataBuffer": 10, "WR_DataBuffer_1": 16, "RD_DataBuffer_1": 10}


@pytest.mark.parametrize("name", FIGURES)
def test_data_blocks_equal_the_figures_of_the_faq(name: str) -> None:
    """Figures 4-5, 4-6, 4-9, 4-10 of FAQ 109750712, member by member; DB6 has error words after the figure's four."""
    blocks, problems = read_source(ROOT / "examples" / FAQ.stem / "expected" / f"{FAQ.stem.upper()}.scl")
    assert problems == []
    (found,) = (block for block in blocks if block.name == name)
    layout = layout_block(found, {})
    shown = [f"{entry.path}@{entry.byte}" for entry in layout.entries]
    wanted = FIGURES[name].split()
    assert shown[: len(wanted)] == wanted
    assert len(shown) == len(wanted) or name == "RD_DataBuffer_1"
    assert layout.size == LENGTHS[name]


@pytest.mark.parametrize("version", ["tia-v16", "tia-v17", "tia-v18", "tia-v19", "tia-v20", "tia-v21"])
def test_simaticml_islands_are_valid(version: str, tmp_path: Path) -> None:
    """Every interface island validates against the schema of its TIA Portal version (skipped without schemas)."""
    text = every_type("t15").replace("tia-v21", version)
    out = generated(text, tmp_path)
    problems = [p for path in sorted((out / "xml").glob("*.xml")) for p in validate_islands(path, version[4:].upper())]
    assert problems == []


def test_sources_have_the_encoding_of_their_tool(tmp_path: Path) -> None:
    """TIA Portal: UTF-8 with byte order mark and LF; STEP 7 V5: Windows-1252 and CR LF."""
    (tmp_path / "a").mkdir()
    tia = generated(every_type("t15").replace("Every type", "Förderband"), tmp_path / "a")
    text = (tia / "Förderband.scl").read_bytes()
    assert text.startswith(b"\xef\xbb\xbfTYPE")
    assert b"\r" not in text
    v5 = tree(generated_example(MM4.stem))["S7-300_MM440_DP.scl"]
    assert v5.startswith(b"TYPE")
    assert v5.count(b"\r\n") == v5.count(b"\n") > 50
    v5.decode("cp1252")
