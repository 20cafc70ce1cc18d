"""The documents of generated code blocks: what names mean, marked and in order."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from plcgen import api
from plcgen.s7.read.text import parse_source
from plcgen.s7.xml.spelling import VERSIONS
from plcgen.s7.xml.writing import structured_text
from plcgen.s7.xml.writing.documents import Setting
from tests.projects import every_type, generated_example

SETTING = Setting(VERSIONS["V19"], classic=False)


def test_a_line_means_what_its_names_mean_in_its_block() -> None:
    """The same line with the same names: a constant in one block, a variable in the other, an instance in a third."""
    code = "#a := #b;\n#c();\n"
    kinds = {
        "VAR CONSTANT\n  b : Int := 1;\nEND_VAR": '<Constant Name="b"',
        "VAR\n  b : Int;\nEND_VAR": '<Component Name="b"',
        'VAR\n  c : "Motor";\nEND_VAR': '<CallInfo Name="Motor"',
        'VAR\n  c : "Pump";\nEND_VAR': '<CallInfo Name="Pump"',
        "VAR\n  c : TON_TIME;\nEND_VAR": "<Instruction UId",
    }
    for section, expected in kinds.items():
        text = f'FUNCTION_BLOCK "X"\n{section}\nBEGIN\n{code}\nEND_FUNCTION_BLOCK\n'
        assert expected in structured_text.code_document(parse_source(text, "x.scl")[0][0], SETTING)


@pytest.mark.parametrize(
    "toolchain", ["tia-v13sp1", "tia-v14", "tia-v14sp1", "tia-v15", "tia-v15.1", "tia-v16", "tia-v20"]
)
def test_what_each_version_gets(toolchain: str, tmp_path: Path) -> None:
    """V13 SP1 and V14 know no StructuredText; later ones get every block in their own namespaces."""
    spec = tmp_path / "job.yaml"
    spec.write_text(every_type("t15").replace("tia-v21", toolchain), "utf-8")
    assert api.generate(spec, tmp_path / "out").ok
    found = {path.stem for path in (tmp_path / "out/xml").glob("*.xml")}
    if toolchain in {"tia-v13sp1", "tia-v14"}:
        assert not (tmp_path / "out/xml").exists()
        return
    assert {"Main", "ReadAll", "DriveCalls_DB", "WriteAll", "typeDriveUnit"} <= found
    version = {"tia-v14sp1": "V14 SP1", "tia-v15.1": "V15.1"}.get(toolchain, toolchain[4:].upper())
    namespaces = {
        "V14 SP1": ("v2", "v1"), "V15": ("v3", "v2"), "V15.1": ("v3", "v2"), "V16": ("v4", "v3"), "V20": ("v5", "v4"),
    }[version]  # fmt: skip
    text = (tmp_path / "out/xml/ReadAll.xml").read_text("utf-8-sig")
    assert f'<Engineering version="{version}" />' in text
    assert re.findall(r"/(?:Interface|StructuredText)/(v\d)\"", text) == list(namespaces)
    notes = {
        f["path"]: f.get("experimental", "")
        for f in json.loads((tmp_path / "out/manifest.json").read_text("utf-8"))["files"]
    }
    assert "WRREC" in notes["xml/ReadAll.xml"]
    assert "watch tables" in notes["xml/Watch_ReadAll.xml"]
    assert bool(notes["xml/Main.xml"]) == (toolchain != "tia-v16")
    assert bool(notes["xml/typeDriveUnit.xml"]) == (toolchain in {"tia-v14sp1", "tia-v15", "tia-v15.1"})


def test_import_script_loads_what_each_version_has() -> None:
    """Up to V20 one assembly, from V21 on Base and Step7 in net48, as Siemens' tia-portal-ai-extensions state it."""
    script = (generated_example("s7-1500_g120_pn") / "xml/import.ps1").read_text("utf-8-sig")
    assert "PublicAPI\\$version\\$name" in script
    places = re.findall(r"\(\$name in ([^)]*)\)", script)
    assert places[1] == r"'net48\Siemens.Engineering.Base.dll', 'Siemens.Engineering.dll'"
    assert "Join-Path (Split-Path $first) 'Siemens.Engineering.Step7.dll'" in script
    assert r"_InstalledSW\TIAP" in script


def test_import_script_names_every_document_once_in_order() -> None:
    """Types, data blocks, function blocks, instance DBs, OB; the S7-300 gets no script."""
    folder = generated_example("s7-1500_g120_pn") / "xml"
    assert b"\r\n" in (folder / "import.ps1").read_bytes()
    names = [name for step in json.loads((folder / "import.json").read_bytes())["steps"] for name in step["files"]]
    assert sorted(names) == sorted(path.name for path in folder.glob("*.xml"))
    order = [
        names.index(n)
        for n in (
            "typeDriveUnit.xml",
            "PumpUnit.xml",
            "DriveChannel.xml",
            "SetRamps.xml",
            "DriveCalls.xml",
            "DriveCalls_DB.xml",
            "Main.xml",
        )
    ]
    assert order == sorted(order)
    assert not (generated_example("s7-300_6ra80_dp_tia") / "xml/import.ps1").exists()
    assert "no script" in (generated_example("s7-300_6ra80_dp_tia") / "xml/IMPORT.md").read_text("utf-8")


def test_the_page_says_of_each_block_why_it_is_experimental() -> None:
    """A PPI master calls no WRREC: its note is that of the blocks for serial modules."""
    masters, drives = (
        (generated_example(name) / "xml/IMPORT.md").read_text("utf-8")
        for name in ("s7-1200_s7-200_ppi", "s7-1500_g120_pn")
    )
    assert "`PumpsPpiMaster.xml`: the call form of the blocks for serial modules is inferred" in masters
    assert "WRREC" not in masters
    assert "the call form of WRREC and RDREC is inferred" in drives


@pytest.mark.parametrize(
    ("toolchain", "said"),
    [
        ("tia-v15.1", "all other documents"),
        ("tia-v19", None),
        ("tia-v20", "DriveCalls_DB.xml`, `Main.xml"),
        ("tia-v21", None),
    ],
)
def test_the_page_names_every_document_that_no_export_of_its_version_stands_behind(
    toolchain: str, said: str | None, tmp_path: Path
) -> None:
    """Of V20 no code block was at hand: OB and instance DB are named; before V16 nothing was, later everything."""
    (tmp_path / "job.yaml").write_text(
        f"plc: {{name: a, family: s7-1500, toolchain: {toolchain}}}\n"
        "drives: {d: {device: sinamics-g120, hardware_id: 264}}\n"
        "jobs: {j: {drive: d, read: [r0945], trigger: M5.0}}\n",
        "utf-8",
    )
    assert api.generate(tmp_path / "job.yaml", tmp_path / "out").ok
    lines = (tmp_path / "out/xml/IMPORT.md").read_text("utf-8").splitlines()
    note = "no genuine export of this TIA Portal version was available to compare with"
    assert [one for one in lines if one.endswith(f": {note}")] == ([f"- `{said}`: {note}"] if said else [])


@pytest.mark.parametrize("quote", ["'", "\u2018", "\u2019", "\u201a", "\u201b", "\u201c", "`", "$"])
def test_no_name_reaches_the_import_script(quote: str, tmp_path: Path) -> None:
    """PowerShell ends a string at typographic quotes too: the script is the same bytes whatever blocks are called."""
    scripts = []
    for number, name in enumerate(["Plain", f"A{quote}; Start-Process calc #"]):
        (tmp_path / "job.yaml").write_text(
            "plc: {name: a, family: s7-1500, toolchain: tia-v16}\n"
            "drives: {d: {device: sinamics-g120, hardware_id: 264}}\n"
            f'jobs: {{j: {{drive: d, read: [r0945], block: {{name: "{name}"}}}}}}\n',
            "utf-8",
        )
        result = api.generate(tmp_path / "job.yaml", tmp_path / str(number))
        assert result.ok, result.diagnostics
        scripts.append((tmp_path / str(number) / "xml/import.ps1").read_bytes())
        steps = json.loads((tmp_path / str(number) / "xml/import.json").read_bytes())["steps"]
        assert f"{name}.xml" in [file for step in steps for file in step["files"]]
    assert scripts[0] == scripts[1]
    assert scripts[0].isascii()


def test_classic_documents_have_none_of_the_new_attributes() -> None:
    """S7-300/400: no MemoryLayout, no SetENOAutomatically, an OB with Temp and Constant only."""
    folder = generated_example("s7-300_6ra80_dp_tia") / "xml"
    for path in folder.glob("*.xml"):
        text = path.read_text("utf-8-sig")
        assert "MemoryLayout" not in text
        assert "SetENOAutomatically" not in text
    main = (folder / "Main.xml").read_text("utf-8-sig")
    assert re.findall(r'<Section Name="(\w+)"', main) == ["Temp", "Constant"]
