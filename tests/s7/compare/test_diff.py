"""Semantic differences: every kind of change by example, renames, moves, policies, broken and hostile input."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

import plcgen
from plcgen.base.diagnostics import DiagnosticError
from plcgen.base.display.view import View
from plcgen.report.registry import output_format
from plcgen.s7.compare.model import Comparison
from plcgen.s7.compare.policy import KINDS, Level, fails, load_policy
from tests.projects import FAQ, ROOT, per_block_spec
from tests.yaml_files import read_yaml

CASES = read_yaml((ROOT / "tests" / "vectors" / "diff.yaml").read_text("utf-8"))
GOLDEN = ROOT / "examples" / FAQ.stem / "expected"
BLOCKS = per_block_spec(FAQ.stem).with_name("out")


def show(format_: str, result: Comparison, **looks: object) -> str:
    """A comparison in a format."""
    return output_format(format_).render("comparison", result, View(**looks))


def sources(case: dict[str, object], side: str) -> str:
    text = str(case[side])
    if "suffix" in case:
        return text
    end = " END_DATA_BLOCK" if case.get("ended") and side == "new" else "\nEND_STRUCT; BEGIN END_DATA_BLOCK"
    return f'DATA_BLOCK "Buffer" STRUCT\n{text}{end}\n'


def diff(tmp_path: Path, old: str, new: str, suffix: str = "db", **more):
    paths = []
    for side, text in (("old", old), ("new", new)):
        folder = tmp_path / side
        folder.mkdir()
        (folder / f"source.{suffix}").write_text(text, encoding="utf-8")
        paths.append(folder)
    return plcgen.diff(*paths, **more)


def test_constants_stand_in_the_order_of_the_source(tmp_path):
    """A report is the same in every run, whatever order a set has there."""
    names = [f"LIMIT_{number}" for number in range(12)]
    text = 'FUNCTION "F" : Void VAR CONSTANT {} END_VAR BEGIN ; END_FUNCTION'
    old, new = (text.format(" ".join(f"{n} : Int := {value};" for n in names)) for value in (1, 2))
    result = diff(tmp_path, old, new, "scl")
    assert [change.path for change in result.changes if change.kind == "constant-changed"] == names


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_changes(case, tmp_path):
    """Exactly the expected changes, each with its id, its member and its figures."""
    result = diff(tmp_path, sources(case, "old"), sources(case, "new"), case.get("suffix", "db"))
    assert [d for d in result.diagnostics if d.severity.label == "error"] == []
    found = [(c.kind, c.path, c.message) for c in result.changes]
    for kind, path, words in case["changes"]:
        hit = next((f for f in found if f[0] == kind and f[1] == path and words in f[2]), None)
        assert hit is not None, f"{kind} {path} {words!r} not in {found}"
        found.remove(hit)
    assert not found or case.get("only") is False, f"unexpected: {found}"


SPEC = FAQ.read_text(encoding="utf-8")
SPEC_EDITS = {
    "value": ("P50304: 100.0", "P50304: 50.0", {"telegram-value": "byte 12: parameter 1 value 100.0"}),
    "parameter": ("read: [P50303]", "read: [P50304]", {"telegram-field": "parameter number 50303 -> 50304"}),
    "reference": ("reference: 3", "reference: 9", {"telegram-reference": "byte 0: request reference 03h -> 09h"}),
    "lengths": (
        "read: [P50303]", "read: [P50303, P50304]",
        {"request-length": "10 -> 16 bytes", "response-length": "positive answer 10 -> 16 bytes"},
    ),
    "address": ("address: 256", "address: 300", {"drive-address": "256 (16#0100) -> 300 (16#012C)"}),
    "drive object": (
        "drive_object: 2", "drive_object: 1",
        {"drive-device": "drive object 2 -> 1", "telegram-field": "byte 2: drive object 2 -> 1"},
    ),
    "timing": ("reference: 3", "reference: 3\n    timeout: 20s", {"job-timing": "timeout 10000 ms -> 20000 ms"}),
    "trigger": ("execute: M50.0", "execute: M60.0", {"job-trigger": "execute"}),
    "job": ("write_ramp_down:", "write_ramp:", {"job-added": "04 02 02 01", "job-removed": "04 02 02 01"}),
    "drive": (
        "dcm: {device: sinamics-dcm, address: 256, drive_object: 2}",
        "dcm: {device: sinamics-dcm, address: 256, drive_object: 2}\n  second: {device: sinamics-dcm, address: 300}",
        {"drive-added": "address 300 (16#012C), device sinamics-dcm"},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SPEC_EDITS)
def test_spec_changes(name, tmp_path):
    """Two specs: what is sent to whom, byte by byte with the name of the field; figures of FAQ 109750712."""
    old, new, expected = SPEC_EDITS[name]
    assert old in SPEC
    path = tmp_path / "job.yaml"
    path.write_text(SPEC.replace(old, new), encoding="utf-8")
    result = plcgen.diff(FAQ, path)
    assert not [d for d in result.diagnostics if d.severity.label == "error"]
    for kind, words in expected.items():
        assert any(c.kind == kind and words in c.message for c in result.changes), result.changes
        assert all(c.new_span is None or c.new_span.file == path.as_posix() for c in result.changes)


def test_other_spec_changes(tmp_path):
    """A drive that is gone, a job that moved to another drive, a job in more telegrams."""
    base = "plc: {name: a, family: s7-1500, toolchain: tia-v19}\ndrives:\n"
    one = "  a: {device: sinamics-g120, hardware_id: 270}\n"
    two = "  b: {device: sinamics-g120, hardware_id: 271}\n"
    items = ", ".join(f'"r945[{n}]"' for n in range(39))
    job = "jobs:\n  j: {drive: %s, read: [%s]}\n"
    old, new = tmp_path / "old.yaml", tmp_path / "new.yaml"
    old.write_text(base + one + two + job % ("a", items))
    new.write_text(base + two + job % ("b", f"{items}, r947"))
    kinds = {c.kind: c.message for c in plcgen.diff(old, new).changes}
    assert kinds["drive-removed"].startswith("removed: address 270 (16#010E), device sinamics-g120")
    assert kinds["job-drive"] == "drive a -> b"
    assert kinds["telegram-count"] == "1 -> 2 telegrams"


def test_every_kind_has_an_example():
    """The table of changes holds nothing that no example triggers, and nothing is missing in it."""
    shown = {change[0] for case in CASES for change in case["changes"]}
    shown |= {kind for _, _, expected in SPEC_EDITS.values() for kind in expected}
    shown |= {"drive-removed", "job-drive", "telegram-count"}
    assert shown == set(KINDS)


def test_docs_list_every_kind():
    """docs/diff.md has the ids of each class, in the order of the table that ``--list-changes`` prints."""
    text = (ROOT / "docs" / "diff.md").read_text("utf-8")
    for level in ("breaking", "compatible", "documentation"):
        ids = ", ".join(f"`{kind.id}`" for kind in KINDS.values() if str(kind.level) == level)
        assert f"| {level} | {ids} |\n" in text


def test_the_same_folder_has_no_differences():
    """A spec, its folder, and the SimaticML of that folder say the same."""
    assert plcgen.diff(GOLDEN, GOLDEN).changes == ()
    assert plcgen.diff(FAQ, GOLDEN).changes == ()
    result = plcgen.diff(BLOCKS / "db", GOLDEN / "xml", classic=True)
    names = {"RD_DataBuffer", "RD_DataBuffer_1", "WR_DataBuffer", "WR_DataBuffer_1"}
    buffers = [c for c in result.changes if any(f'"{name}"' in c.subject for name in names)]
    assert {c.kind for c in buffers} <= {"block-text", "block-renumbered"}, buffers


def test_a_member_moved_in_simaticml(tmp_path):
    """SimaticML against SimaticML: a member that lost its neighbour moves."""
    new = tmp_path / "xml"
    shutil.copytree(GOLDEN / "xml", new)
    path = new / "WR_DataBuffer.xml"
    text = path.read_text("utf-8-sig")
    start = text.index('<Member Name="Request_ID"')
    end = text.index("</Member>", start) + len("</Member>")
    path.write_text(text[:start] + text[end:], encoding="utf-8-sig")
    kinds = {(c.kind, c.path) for c in plcgen.diff(GOLDEN / "xml", new, classic=True).changes}
    assert ("member-removed", "Request_ID") in kinds
    assert ("member-moved", "Axis") in kinds


def test_retentivity_and_access_in_simaticml(tmp_path):
    """Remanence and the External attributes are compared as in text sources."""
    new = tmp_path / "xml"
    shutil.copytree(GOLDEN / "xml", new)
    path = new / "WR_DataBuffer.xml"
    text = path.read_text("utf-8-sig")
    hidden = '<AttributeList><BooleanAttribute Name="ExternalVisible">false</BooleanAttribute></AttributeList>'
    member = text.index('<Member Name="Axis"')
    end = text.index(">", member)
    text = f'{text[:end]} Remanence="Retain">{hidden}{text[end + 1 :]}'
    path.write_text(text, encoding="utf-8-sig")
    changes = {c.kind: c.message for c in plcgen.diff(GOLDEN / "xml", new, classic=True).changes if c.path == "Axis"}
    assert changes == {
        "hmi-access-removed": "no longer visible from HMI and OPC UA",
        "retain-changed": "nonretain -> retain",
    }


def test_types_of_the_other_side_are_used(tmp_path):
    """A single old file beside a project: its types are those of the project, as for git's external diff."""
    (tmp_path / "a").mkdir()
    old = tmp_path / "a" / "ReadRampUp.scl"
    shutil.copy(BLOCKS / "scl" / "ReadRampUp.scl", old)
    result = plcgen.diff(old, BLOCKS / "scl" / "ReadRampUp.scl")
    assert (result.changes, result.diagnostics) == ((), ())


def test_an_unknown_type_costs_the_offsets_only(tmp_path):
    """Declarations, attributes and start values are compared all the same, in any spelling."""
    text = 'DATA_BLOCK "B" STRUCT a {{S7_X := \'1\'}} : Word := {}; t : "Nowhere"; {} END_STRUCT; BEGIN END_DATA_BLOCK'
    result = diff(tmp_path, text.format("16#10", ""), text.format("W#16#0010", "z : Int;"))
    assert [(c.kind, c.path) for c in result.changes] == [("member-added", "z")]
    assert {d.code for d in result.diagnostics} == {"PG630"}
    assert result.readable


def test_policy(tmp_path):
    """Settings override the table in order; files and settings mix."""
    file = tmp_path / "policy.yaml"
    file.write_text("member-renamed: compatible\nstart-value: breaking\n")
    policy = load_policy([str(file), "start-value=documentation"])
    assert policy["member-renamed"] is Level.COMPATIBLE
    assert policy["start-value"] is Level.DOCUMENTATION
    assert policy["member-moved"] is Level.BREAKING
    result = diff(tmp_path, *(f'DATA_BLOCK "B" STRUCT {n} : Int; END_STRUCT; BEGIN END_DATA_BLOCK' for n in "ab"))
    assert result.failing("breaking") == 1
    file.write_text("member-rename: compatible\nmember-moved: harmless\n")
    with pytest.raises(DiagnosticError) as caught:
        load_policy([str(file), "x=breaking"])
    assert [(d.code, d.span.line) for d in caught.value.diagnostics] == [("PG631", 0), ("PG631", 1), ("PG631", 2)]
    assert 'did you mean "member-renamed"' in caught.value.diagnostics[1].help


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("- a", [("PG106", 1, 1, "a policy is a mapping of change ids to classes")]),
        ("", [("PG101", 1, 1, "the file is empty")]),
        ("code-changed: [breaking]", [("PG631", 1, 15, "this is not a class of change")]),
        (
            "code-changd: breaking\ncode-changed: severe\nstart-value: 5\njob-added: BREAKING\njob-timing:\n",
            [
                ("PG631", 1, 1, 'there is no kind of change "code-changd"'),
                ("PG631", 2, 15, '"severe" is not a class of change'),
                ("PG631", 3, 14, '"5" is not a class of change'),
                ("PG631", 5, 12, "this is not a class of change"),
            ],
        ),
        ("job-added: breaking\njob-added: compatible\nx: y", [
            ("PG103", 2, 1, 'key "job-added" appears twice'), ("PG631", 3, 1, 'there is no kind of change "x"'),
            ("PG631", 3, 4, '"y" is not a class of change'),
        ]),
    ],
)  # fmt: skip
def test_mistakes_of_a_policy_are_told_with_their_place(tmp_path, text, expected):
    """All of a file in one run."""
    file = tmp_path / "policy.yaml"
    file.write_text(text, "utf-8")
    with pytest.raises(DiagnosticError) as caught:
        load_policy([str(file)])
    assert [(d.code, d.span.line, d.span.column, d.message) for d in caught.value.diagnostics] == expected


def test_fail_on():
    """Each threshold includes what is worse."""
    table = {on: [level.value for level in Level if fails(level, on)] for on in ("breaking", "compatible", "any")}
    assert table == {
        "breaking": ["breaking"],
        "compatible": ["breaking", "compatible"],
        "any": ["breaking", "compatible", "documentation"],
    }
    assert not any(fails(level, "never") for level in Level)


BROKEN = {
    "missing": None,
    "syntax": b'DATA_BLOCK "B" STRUCT a : ; END_STRUCT END_DATA_BLOCK',
    "binary": bytes(range(256)),
    "recursive": b'TYPE "A" STRUCT b : "A"; END_STRUCT; END_TYPE DATA_BLOCK "B" "A" BEGIN END_DATA_BLOCK',
    "xml": b"<Document>",
    "entities": b'<!DOCTYPE d [<!ENTITY x "y">]><Document/>',
    "spec": b"plc: [",
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_input(name, tmp_path, capsys):
    """Whatever cannot be read is a diagnostic; nothing is printed, nothing raised."""
    suffix = {"xml": "xml", "entities": "xml", "spec": "yaml"}.get(name, "db")
    path = tmp_path / f"x.{suffix}"
    if BROKEN[name] is not None:
        path.write_bytes(BROKEN[name])
    result = plcgen.diff(path, BLOCKS / "db")
    assert not result.readable
    assert capsys.readouterr() == ("", "")


def test_many_members_are_one_line(tmp_path):
    """2,000 members that move are one change; its details name every one."""
    members = "".join(f"m{n} : Int; " for n in range(2000))
    block = 'DATA_BLOCK "B" STRUCT {}{} END_STRUCT; BEGIN END_DATA_BLOCK'
    result = diff(tmp_path, block.format("", members), block.format("x : Int; ", members))
    moved = [c for c in result.changes if c.kind == "member-moved"]
    assert [len(c.details) for c in moved] == [2000]
    assert show("text", result).count("\n") < 10
    assert "m1999 3998.0 -> 4000.0" in show("text", result, verbose=True)
    assert ".. and 1988 more" in show("markdown", result)


def test_markdown_cannot_be_broken_by_names(tmp_path):
    """Names with the characters of Markdown and HTML stay text."""
    block = 'DATA_BLOCK "a|b<i>`*" STRUCT "x|y" : Int{}; END_STRUCT; BEGIN END_DATA_BLOCK'
    result = diff(tmp_path, block.format(""), block.format(" := 3"))
    text = show("markdown", result)
    assert "a\\|b&lt;i&gt;\\`\\*" in text
    assert all(line.replace("\\|", "").count("|") == 5 for line in text.splitlines() if line.startswith("|"))


def test_sarif(tmp_path):
    """One rule per kind, levels by class, places on both sides, diagnostics beside them."""
    result = diff(
        tmp_path, *(f'DATA_BLOCK "B" STRUCT a : {t}; END_STRUCT; BEGIN END_DATA_BLOCK' for t in ("Int", "Word"))
    )
    run = json.loads(show("sarif", result))["runs"][0]
    assert [rule["id"] for rule in run["tool"]["driver"]["rules"]] == ["type-changed"]
    (found,) = run["results"]
    assert (found["level"], found["ruleIndex"]) == ("error", 0)
    assert found["locations"][0]["physicalLocation"]["region"]["startColumn"] == 23
    assert found["partialFingerprints"] == {"plcgenChange/v1": 'type-changed:DB "B":a'}


def test_a_block_with_the_same_number_is_the_same_block(tmp_path):
    """Renamed and changed at once: the number says that it is the same one."""
    new = tmp_path / "xml"
    shutil.copytree(GOLDEN / "xml", new)
    path = new / "WR_DataBuffer.xml"
    text = path.read_text("utf-8-sig").replace("<Name>WR_DataBuffer</Name>", "<Name>Question</Name>")
    path.write_text(text.replace('Name="Subindex" Datatype="Word"', 'Name="Subindex" Datatype="Int"'), "utf-8-sig")
    found = plcgen.diff(GOLDEN / "xml" / "WR_DataBuffer.xml", path, classic=True)
    assert {c.kind for c in found.changes} == {"block-renamed", "type-changed"}


def test_what_an_export_writes_by_default_is_no_change(tmp_path):
    """The same block, exported with and without defaults; another value than the default is a change."""
    old, new = tmp_path / "old", tmp_path / "new"
    old.mkdir()
    text = 'DATA_BLOCK "D"\nNON_RETAIN\nSTRUCT\n  a : Int;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'
    (old / "D.db").write_text(text, encoding="utf-8")
    assert plcgen.convert(old / "D.db", to="xml", out=new).ok
    (document,) = new.glob("*.xml")
    plain = document.read_text("utf-8-sig")
    names = ("ExternalAccessible", "ExternalVisible", "ExternalWritable")
    flags = "".join(f'<BooleanAttribute Name="{name}" SystemDefined="true">true</BooleanAttribute>' for name in names)
    flags += '<BooleanAttribute Name="SetPoint" SystemDefined="true">false</BooleanAttribute>'
    full = plain.replace(
        '<Member Name="a" Datatype="Int" />',
        f'<Member Name="a" Datatype="Int" Remanence="NonRetain"><AttributeList>{flags}</AttributeList></Member>',
    )
    assert full != plain
    block = "<DBAccessibleFromOPCUA>true</DBAccessibleFromOPCUA><HeaderVersion>0.1</HeaderVersion>"
    block += "<IsOnlyStoredInLoadMemory>false</IsOnlyStoredInLoadMemory>"
    full = full.replace("<Interface>", f"{block}<Interface>")
    (tmp_path / "full.xml").write_text(full, encoding="utf-8-sig")
    assert plcgen.diff(new, tmp_path / "full.xml").changes == ()
    assert plcgen.diff(tmp_path / "full.xml", new).changes == ()
    other = full.replace(">true</DBA", ">false</DBA").replace("false</BooleanAttribute>", "true</BooleanAttribute>")
    (tmp_path / "full.xml").write_text(other, encoding="utf-8-sig")
    assert [(c.kind, c.path) for c in plcgen.diff(new, tmp_path / "full.xml").changes] == [
        ("block-attribute", ""),
        ("member-attribute", "a"),
    ]
    informative = full.replace('Name="SetPoint" System', 'Informative="true" Name="SetPoint" System')
    informative = informative.replace("false</BooleanAttribute>", "true</BooleanAttribute>")
    (tmp_path / "full.xml").write_text(informative, encoding="utf-8-sig")
    assert plcgen.diff(new, tmp_path / "full.xml").changes == ()


def test_one_token_in_a_long_body(tmp_path):
    """Equal beginnings and ends are left out before anything is compared token by token."""
    body = "".join(f'"a{n}" := #a + {n};\n' for n in range(3000))
    head = 'FUNCTION "G" : Void VAR_INPUT a : Int; END_VAR BEGIN\n'
    old = f"{head}{body}END_FUNCTION"
    result = diff(tmp_path, old, old.replace("#a + 2900", "#a + 1"), "scl")
    (change,) = result.changes
    assert change.message == 'code: line 2902: ""a2900" := #a + 2900;" -> ""a2900" := #a + 1;"'
    assert change.new_span is not None
    assert change.new_span.line == 2902


def test_what_follows_from_a_spec_is_not_repeated(tmp_path):
    """Comments, titles and the start values of request DBs say nothing that the jobs do not say."""
    path = tmp_path / "job.yaml"
    path.write_text(SPEC.replace("P50304: 100.0", "P50304: 50.0"), encoding="utf-8")
    assert {(c.kind, c.subject) for c in plcgen.diff(FAQ, path).changes} == {("telegram-value", "job write_ramp_down")}
    path.write_text(SPEC.replace("read: [P50303]", "read: [P50304]"), encoding="utf-8")
    kinds = {c.kind for c in plcgen.diff(FAQ, path).changes}
    assert "telegram-field" in kinds
    assert not kinds & {"start-value", "member-comment", "block-text"}
    assert not any(c.subject.startswith("UDT") for c in plcgen.diff(FAQ, path).changes)


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("s7-1500_s120_bico", "P1030.2: {", "P1030.3: {"),
        ("s7-1500_s210_sequence", "r722.0: 1, r722.1: 0", "r722.0: 0, r722.1: 0"),
        ("s7-1500_s210_sequence", "P10: 1, timeout", "P10: 2, timeout"),
        ("s7-1500_s120_save", "distance: 60min", "distance: 50min"),
        ("s7-1200_s120_recipe", "currentLimit: 18.0", "currentLimit: 28.0"),
        ("s7-1500_g120_compare", "P1082: 1500.0", "P1082: 1600.0"),
    ],
)
def test_what_no_telegram_says(tmp_path, name, old, new):
    """Which bit an input writes, what a sequence waits for, records and limits are in code and data only."""
    spec, path = ROOT / "specs" / f"{name}.yaml", tmp_path / f"{name}.yaml"
    text = spec.read_text("utf-8")
    assert old in text
    path.write_text(text.replace(old, new), "utf-8")
    assert plcgen.diff(spec, path).changes
    plcgen.lock(spec, out=tmp_path / "x.lock.json")
    assert plcgen.check_lock(path, lock=tmp_path / "x.lock.json").changes


def test_symbols_of_a_station_that_change_places(tmp_path):
    """One item holds both values: its telegram stays, but level and pressure are exchanged."""
    head = "plc: {name: a, family: s7-1200, toolchain: tia-v19}\nppi: {m: {module: cm1241, port: 270, stations: "
    jobs = "}}, jobs: {j: {station: p, read: [level, pressure]}}}}\n"
    for side, symbols in (("old", "level: VW10, pressure: VW12"), ("new", "level: VW12, pressure: VW10")):
        (tmp_path / f"{side}.yaml").write_text(f'{head}{{p: {{address: 2, cpu: "224", symbols: {{{symbols}}}{jobs}')
    result = plcgen.diff(tmp_path / "old.yaml", tmp_path / "new.yaml")
    assert result.diagnostics == ()
    assert [(c.kind, c.subject) for c in result.changes] == [("code-changed", 'FB "MPpiMaster"')]


def test_code_in_simaticml_is_the_scl_it_says(tmp_path):
    """A text against its document: nothing differs; one changed statement is one change, at the block."""
    old, new = tmp_path / "old", tmp_path / "new"
    text = 'FUNCTION "G" : Void\nVAR_INPUT\n  a : Int;\nEND_VAR\nBEGIN\n  "x" := #a + 1; // one\nEND_FUNCTION\n'
    old.mkdir()
    (old / "G.scl").write_text(text, encoding="utf-8")
    assert plcgen.convert(old / "G.scl", to="xml", out=new).ok
    (document,) = new.glob("*.xml")
    assert [c.kind for c in plcgen.diff(old, new).changes if c.level is not Level.DOCUMENTATION] == []
    xml = document.read_text("utf-8-sig")
    assert ">1<" in xml
    document.write_text(xml.replace(">1<", ">2<"), encoding="utf-8-sig")
    (change,) = [c for c in plcgen.diff(old, new).changes if c.level is not Level.DOCUMENTATION]
    assert (change.kind, change.message) == ("code-changed", 'code: ""x" := #a + 1; // one" -> ""x" := #a + 2; // one"')
    assert change.new_span is not None
    assert (Path(change.new_span.file).name, change.new_span.column) == (document.name, 1)


LADDER = """\
<?xml version="1.0" encoding="utf-8"?>
<Document>
  <Engineering version="V18" />
  <SW.Blocks.FC ID="0">
    <AttributeList>
      <Interface><Sections xmlns="http://www.siemens.com/automation/Openness/SW/Interface/v5">
        <Section Name="Input"><Member Name="a" Datatype="Bool" /></Section>
      </Sections></Interface>
      <MemoryLayout>Optimized</MemoryLayout>
      <Name>Ladder</Name>
      <Number>1</Number>
      <ProgrammingLanguage>LAD</ProgrammingLanguage>
    </AttributeList>
    <ObjectList>
      <SW.Blocks.CompileUnit ID="1" CompositionName="CompileUnits">
        <AttributeList>
          <NetworkSource><FlgNet xmlns="http://www.siemens.com/automation/Openness/SW/NetworkSource/FlgNet/v4">
            <Parts><Part Name="Contact" UId="21" /></Parts>
          </FlgNet></NetworkSource>
          <ProgrammingLanguage>LAD</ProgrammingLanguage>
        </AttributeList>
      </SW.Blocks.CompileUnit>
    </ObjectList>
  </SW.Blocks.FC>
</Document>
"""


@pytest.mark.parametrize(
    ("old", "new", "messages"),
    [
        ('UId="21"', 'UId="99"', []),
        ("Contact", "Coil", ['code: line 18: "Part Name=Contact" -> "Part Name=Coil"']),
        ('<Part Name="Contact" UId="21" />', "", ['code: line 18: removed "Part Name=Contact"']),
    ],
)
def test_drawn_networks(tmp_path, old, new, messages):
    """LAD has no text: its elements are compared, without the numbers that every export gives anew."""
    first, second = tmp_path / "a.xml", tmp_path / "b.xml"
    first.write_text(LADDER, encoding="utf-8")
    second.write_text(LADDER.replace(old, new), encoding="utf-8")
    assert [c.message for c in plcgen.diff(first, second).changes] == messages


PPI = """\
plc: {name: a, family: s7-1200, toolchain: tia-v19}
ppi:
  m:
    module: cm1241
    port: 270
    stations: {p: {address: 2, cpu: "224"}}
    jobs:
      w: {station: p, write: {VW100: 7}}
"""


def test_ppi_jobs_in_specs(tmp_path):
    """Requests to an S7-200 are compared field by field, too; figures by hand from the S7 PDU: VW100 is bit 320h."""
    old, new, lock = tmp_path / "old.yaml", tmp_path / "new.yaml", tmp_path / "x.lock.json"
    old.write_text(PPI, encoding="utf-8")
    new.write_text(PPI.replace("VW100: 7", "VW104: 8").replace("address: 2", "address: 3"), encoding="utf-8")
    assert plcgen.lock(old, out=lock).ok
    for result in (plcgen.diff(old, new), plcgen.check_lock(new, lock=lock)):
        found = [(c.kind, c.subject, c.message) for c in result.changes if c.subject.startswith(("job", "station"))]
        assert ("drive-address", "station m.p", "address 2 (16#0002) -> 3 (16#0003)") in found
        assert ("telegram-value", "job m.w", "byte 35: value 1 data 7 -> 8") in found
        assert ("telegram-field", "job m.w", "byte 28: item 1 address 000320h (100.0) -> 000340h (104.0)") in found
        assert not any("checksum" in message for _, _, message in found)
    assert plcgen.check_lock(old, lock=lock).changes == ()


def test_long_rows_are_shortened(tmp_path):
    """Four of a kind and how many more; everything with --verbose."""
    block = 'DATA_BLOCK "B" STRUCT a : Int; {} END_STRUCT; BEGIN END_DATA_BLOCK'
    result = diff(tmp_path, block.format(""), block.format("".join(f"n{n} : Int; " for n in range(9))))
    text = show("text", result)
    assert (text.count("added: n"), ".. and 5 more member-added" in text) == (4, True)
    assert show("text", result, verbose=True).count("added: n") == 9


def test_both_places_are_in_sarif(tmp_path):
    """Where it was, and where it is."""
    result = diff(
        tmp_path, *(f'DATA_BLOCK "B" STRUCT a : {t}; END_STRUCT; BEGIN END_DATA_BLOCK' for t in ("Int", "Word"))
    )
    (found,) = json.loads(show("sarif", result))["runs"][0]["results"]
    assert found["relatedLocations"][0]["physicalLocation"]["artifactLocation"]["uri"].endswith("old/source.db")


def test_what_an_instance_lacks_is_said_once(tmp_path):
    """The function block lacks the type; its instance follows."""
    block = 'FUNCTION_BLOCK "F" VAR a : "No"; b : "Never"; END_VAR BEGIN END_FUNCTION_BLOCK'
    text = f'{block}\nDATA_BLOCK "I" "F" BEGIN END_DATA_BLOCK'
    result = diff(tmp_path, text, text, "scl")
    assert {d.message.partition(":")[0] for d in result.diagnostics} == {'FB "F" is compared without offsets'}


def test_the_size_of_a_written_item_is_a_field(tmp_path):
    """The value is the number; its size code and length say how it is written."""
    old, new = tmp_path / "old.yaml", tmp_path / "new.yaml"
    old.write_text(PPI, encoding="utf-8")
    new.write_text(PPI.replace("VW100: 7", "VD100: 7"), encoding="utf-8")
    kinds = {
        c.message.split(": ")[1].rpartition(" ->")[0]: c.kind
        for c in plcgen.diff(old, new).changes
        if ": " in c.message
    }
    assert kinds["value 1 length 16 (2 bytes)"] == "telegram-field"


def test_attributes_are_named_as_the_source_spells_them(tmp_path):
    """Letter case makes no attribute another one; the message has the spelling of the new source."""
    old = "DATA_BLOCK d STRUCT a {A.id := '1.0'} : Int; END_STRUCT BEGIN END_DATA_BLOCK"
    new = old.replace("A.id", "A.Id")
    assert diff(tmp_path, old, new).changes == ()
    for side in ("old", "new"):
        shutil.rmtree(tmp_path / side)
    (change,) = diff(tmp_path, old, new.replace("1.0", "1.1")).changes
    assert (change.kind, change.message) == ("member-attribute", "A.Id 1.0 -> 1.1")


OPTIMIZED = """DATA_BLOCK "D"
{{ S7_Optimized_Access := 'TRUE' }}
VERSION : 0.1
  STRUCT
    {members}
  END_STRUCT;
BEGIN
END_DATA_BLOCK
"""


@pytest.mark.parametrize(
    ("members", "kinds"),
    [
        ("time : Real; speed : Int;", ["member-reordered"]),
        ("speed : Int; more : Int; time : Real;", ["member-added"]),
        ("time : Real;", ["member-removed"]),
        ("speed : Int; Time : Real;", ["member-spelling"]),
    ],
)
def test_order_in_an_optimized_db_is_a_change(members: str, kinds: list[str], tmp_path: Path) -> None:
    """Symbols reach the members all the same; the CPU gets the block anew, with its start values."""
    paths = []
    for name, inner in (("old", "speed : Int; time : Real;"), ("new", members)):
        paths.append(tmp_path / f"{name}.db")
        paths[-1].write_text(OPTIMIZED.format(members=inner), "utf-8")
    result = plcgen.diff(*paths)
    assert [change.kind for change in result.changes if change.kind.startswith("member")] == kinds
    as_opc = plcgen.diff(*paths, policy=["member-spelling=breaking"])
    assert bool(as_opc.failing("breaking")) is (kinds[0] in {"member-spelling", "member-removed"})


def test_a_block_declared_twice(tmp_path):
    """The second declaration is never compared: an error, whatever changed in the first."""
    block = 'DATA_BLOCK "Buffer" STRUCT a : {}; END_STRUCT BEGIN END_DATA_BLOCK\n'
    twice = block.format("INT") + block.format("{}")
    result = diff(tmp_path, twice.format("INT"), twice.format("REAL"))
    assert {(d.code, d.severity.label) for d in result.diagnostics} == {("PG805", "error")}
    assert not result.readable


@pytest.mark.parametrize("text", ["// nothing left\n", ""])
def test_files_without_a_block(tmp_path, text):
    """Nothing was compared: no differences would be a lie. Tag tables are no blocks either."""
    result = diff(tmp_path, text, text, "scl")
    assert {(d.code, d.severity.label) for d in result.diagnostics} == {("PG804", "error")}
    assert not result.readable
    assert not plcgen.lock(tmp_path / "old", out=tmp_path / "x.lock.json").ok


def test_a_spec_says_nothing_of_tag_tables():
    """A generated folder has a tag table, the spec itself none: that is no difference."""
    result = plcgen.diff([FAQ], [GOLDEN])
    assert not [change for change in result.changes if change.subject.startswith("tag table")]
    assert plcgen.diff([GOLDEN], [GOLDEN]).changes == ()


def test_a_table_that_came_or_went_is_told(tmp_path):
    """Tags that the HMI uses may be gone with it."""
    table = GOLDEN / "xml" / "DriveJobTags.xml"
    other = tmp_path / "other"
    other.mkdir()
    (other / "block.db").write_text('DATA_BLOCK "D" STRUCT a : INT; END_STRUCT; BEGIN END_DATA_BLOCK', "utf-8")
    both = tmp_path / "both"
    both.mkdir()
    shutil.copy(other / "block.db", both)
    shutil.copy(table, both)
    came, gone = plcgen.diff([other], [both]), plcgen.diff([both], [other])
    assert [(c.kind, c.subject) for c in came.changes] == [("block-added", 'tag table "DriveJobTags"')]
    assert [c.kind for c in gone.changes] == ["block-removed"]
