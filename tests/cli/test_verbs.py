"""new, check, generate, layout, verify, schema, demo: what a person and a pipeline get from each."""

import json
import os
import re
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
import yaml

from plcgen import api as plcgen_api
from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.resources import specs_dir
from plcgen.ds47.devices import device_names
from plcgen.proof.checks import Check, CheckGroup, Outcome, Verification
from tests.projects import per_block


def test_check_good(plcgen, good):
    """Nothing on stdout, one line of summary on stderr, exit code 0."""
    result = plcgen("check", good)
    assert (result.code, result.out, result.err) == (0, "", "no problems in job.yaml\n")
    assert plcgen("check", good, "-q").err == ""


def test_check_bad(plcgen, bad):
    """Findings are the result: on stdout, exit code 1; the summary is chatter."""
    result = plcgen("check", bad)
    assert result.code == 1
    assert result.out == (
        'error[PG201]: unknown device "sinamics-dcmm"\n'
        " --> bad.yaml:3:17\n"
        "  |\n"
        "3 |   dcm: {device: sinamics-dcmm, address: 256, drive_object: 2}\n"
        "  |                 ^^^^^^^^^^^^^\n"
        '  = help: did you mean "sinamics-dcm"? plcgen devices lists them\n'
    )
    assert result.err == "\n1 error in bad.yaml\n"


def test_check_several(plcgen, good, bad):
    """All specs are checked, whatever the first one gives; the same file counts once."""
    result = plcgen("check", good, bad, good)
    assert result.code == 1
    assert result.err == "\n2 errors in 2 specs\n"  # PG511 beside the mistake: both are for one PLC


@pytest.mark.parametrize("format_", ["json", "sarif", "junit", "github"])
def test_check_formats(plcgen, bad, format_, tmp_path):
    """Machine formats own stdout; --output writes the same to a file, and a remark below it where there are some."""
    result = plcgen("check", bad, "--format", format_)
    assert (result.code, result.err) == (1, "")
    if format_ == "junit":
        assert ET.fromstring(result.out).get("failures") == "1"  # our own output
    elif format_ == "github":
        assert result.out.startswith("::error file=bad.yaml,line=3,col=17,endColumn=30,title=PG201::")
    else:
        assert json.loads(result.out)
    filed = plcgen("check", bad, "--format", format_, "-o", "out.txt")
    assert (filed.out, filed.err) == ("", "wrote out.txt\n")
    data = (tmp_path / "out.txt").read_bytes().decode()
    assert data.startswith(result.out)
    assert data.removeprefix(result.out).count("\n") == (format_ in {"junit", "github"})
    if format_ == "junit":
        assert ET.fromstring(data).get("failures") == "1"  # as above


def test_json_is_short_for_format_json(plcgen, bad):
    """--json means --format json."""
    assert plcgen("check", bad, "--json").out == plcgen("check", bad, "--format", "json").out


def test_output_that_cannot_be_written(plcgen, bad):
    """A missing folder is told, exit code 1."""
    result = plcgen("check", bad, "--json", "-o", "no/such/folder.json")
    assert (result.code, result.out) == (1, "")
    assert result.err.startswith("error: cannot write no")


@pytest.mark.parametrize("verb", ["check", "generate", "encode", "layout"])
@pytest.mark.parametrize("kind", ["missing", "folder", "binary", "empty", "huge line"])
def test_hostile_specs(plcgen, tmp_path, verb, kind):
    """Whatever lies where a spec should be is a diagnostic with exit code 1, never a crash."""
    path = tmp_path / "x.yaml"
    if kind == "folder":
        path.mkdir()
    elif kind == "binary":
        path.write_bytes(bytes(range(256)) * 10)
    elif kind == "empty":
        path.write_bytes(b"")
    elif kind == "huge line":
        path.write_text("plc: " + "[" * 100_000, encoding="utf-8")
    result = plcgen(verb, path.name)
    assert result.code == 1
    assert "error[PG1" in result.out + result.err
    assert "PG902" not in result.err
    assert not list(tmp_path.glob("*_generated"))


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="needs a user without all rights")
def test_unreadable_spec(plcgen, good, tmp_path):
    """No permission is a diagnostic."""
    (tmp_path / good).chmod(0)
    result = plcgen("check", good)
    assert result.code == 1
    assert "PG110" in result.out


def test_generate_check_diff_and_force(plcgen, good, tmp_path):
    """The life of an output folder, verb by verb."""
    made = plcgen("generate", good)
    folder = tmp_path / "job_generated"
    assert (made.code, made.out) == (0, "")
    assert made.err.startswith("job_generated: ")
    assert re.search(r"\n5 FBs, [0-9]+ DBs of [0-9,]+ lines, about [0-9.]+ KB of work memory\n\Z", made.err)
    assert (folder / "manifest.json").is_file()
    assert plcgen("generate", good, "--check") == type(made)(0, "", "job_generated is up to date\n")
    assert plcgen("generate", good, "-q") == type(made)(0, "", "")

    spec = tmp_path / good
    spec.write_text(spec.read_text().replace("reference: 3", "reference: 9"), encoding="utf-8")
    stale = plcgen("generate", good, "--check")
    assert stale.code == 1
    assert stale.out.startswith("--- a/")
    assert "\n+++ b/" in stale.out
    assert stale.err.startswith("error[PG504]: ")
    assert stale.err.endswith("help: plcgen generate job.yaml\n")
    looked = plcgen("generate", good, "--diff")
    assert (looked.code, looked.out) == (0, stale.out)
    assert looked.err == "job_generated is not up to date\n"
    assert plcgen("generate", good, "--diff", "--check").code == 1

    assert plcgen("generate", good).code == 0
    victim = next(folder.rglob("*.scl"))
    victim.write_text("mine", encoding="utf-8")
    refused = plcgen("generate", good)
    assert refused.code == 1
    assert "error[PG502]" in refused.err
    assert refused.err.endswith("1 error; nothing was written\n")
    assert victim.read_text(encoding="utf-8") == "mine"
    assert plcgen("generate", good, "--force").code == 0
    assert victim.read_text(encoding="utf-8-sig") != "mine"


def test_generate_json(plcgen, good):
    """JSON says what happened to which file."""
    data = json.loads(plcgen("generate", good, "--out", "plc", "--json").out)
    assert data["kind"] == "generate"
    assert data["folder"] == "plc"
    assert "manifest.json" in data["written"]
    assert data["size"]["fbs"] == 5  # ticket, gate, channel, the job, the caller
    assert data["size"]["total"] == data["size"]["code"] + data["size"]["data"]
    assert data["size"]["cpu"] is None
    again = json.loads(plcgen("generate", good, "--out", "plc", "--json").out)
    assert again["written"] == []
    assert sorted(again["unchanged"]) == sorted(data["written"])


def test_generate_says_how_much_of_a_named_cpu_it_takes(plcgen, good, tmp_path):
    """With a CPU type the line ends with its share, and JSON has name and percent."""
    spec = tmp_path / good
    spec.write_text(spec.read_text().replace("family: s7-300", "family: s7-300, cpu: 315-2DP"), encoding="utf-8")
    assert re.search(r" of work memory, [0-9] % of a CPU 315-2DP\n\Z", plcgen("generate", good).err)
    data = json.loads(plcgen("generate", good, "--json").out)
    assert data["size"]["cpu"] == {"name": "315-2DP", "percent": 100 * data["size"]["total"] // (256 * 1024)}
    assert plcgen("generate", good, "-q").err == ""


def test_generate_into_a_file(plcgen, good, tmp_path):
    """An output folder that is a file is a diagnostic."""
    (tmp_path / "plc").write_text("x", encoding="utf-8")
    result = plcgen("generate", good, "--out", "plc")
    assert result.code == 1
    assert "error[PG50" in result.err


def test_layout_of_a_spec(plcgen, good):
    """Table with addresses (FAQ 109750712, figure 4-5) and the picture of the request."""
    result = plcgen("layout", good)
    assert (result.code, result.err) == (0, "")
    assert result.out.startswith(
        'DB3 "ReadIt_Request"  10 bytes, request of read_it, LEN 10\n'
        "  offset  address   name            type  size  start value  comment\n"
        "     0.0  DB3.DBB0  Request_Ref     BYTE   1 B  16#03        request reference 1..255\n"
        "     1.0  DB3.DBB1  Request_ID      BYTE   1 B  16#01        01h = read, 02h = write\n"
        "     2.0  DB3.DBB2  Axis            BYTE   1 B  16#02        drive object (axis)\n"
        "     3.0  DB3.DBB3  Num_of_Para     BYTE   1 B  16#01        number of parameters\n"
        "     4.0  DB3.DBB4  Para_Attribute  BYTE   1 B  16#10        P50303 10h = value\n"
        "     5.0  DB3.DBB5  Num_of_Element  BYTE   1 B  16#01        P50303 number of elements\n"
        "     6.0  DB3.DBW6  Para_No         WORD   2 B  16#C47F      P50303 parameter number\n"
        "     8.0  DB3.DBW8  Subindex        WORD   2 B  16#0000      P50303 subindex\n"
        "\n"
        "  byte  +0                              +1\n"
        "       +-------------------------------+-------------------------------+\n"
        "     0 | 03  Request_Ref               | 01  Request_ID                |\n"
        "     2 | 02  Axis                      | 01  Num_of_Para               |\n"
        "       +-------------------------------+-------------------------------+\n"
        "     4 | 10  Para_Attribute            | 01  Num_of_Element            |\n"
        "     6 | C4 7F  Para_No                                                |\n"
        "     8 | 00 00  Subindex                                               |\n"
        "       +-------------------------------+-------------------------------+\n"
    )
    assert "+---" not in plcgen("layout", good, "--no-grid").out


def test_layout_formats(plcgen, good):
    """Markdown, CSV and JSON of the same table."""
    assert (
        "| 6.0 | DB3.DBW6 | Para_No | WORD | 2 B | 16#C47F | P50303 parameter number |"
        in plcgen("layout", good, "-f", "markdown").out
    )
    assert (
        '"DB3 ""ReadIt_Request""";6;;DB3.DBW6;0;Para_No;WORD;16;16#C47F;P50303 parameter number;member;\n'
        in plcgen("layout", good, "-f", "csv").out
    )
    data = json.loads(plcgen("layout", good, "--json").out)
    assert data["blocks"][0]["data"] == "030102011001C47F0000"
    assert data["blocks"][0]["members"][6] == {
        "name": "Para_No",
        "path": "Para_No",
        "byte": 6,
        "bit": None,
        "bits": 16,
        "address": "DB3.DBW6",
        "type": "WORD",
        "start": "16#C47F",
        "depth": 0,
        "comment": "P50303 parameter number",
        "role": "address",
        "kind": "member",
        "unconfirmed": [],
    }


AWL = """\
DATA_BLOCK DB 7
STRUCT
  flag : BOOL := TRUE;
  text : STRING [3];
  s : STRUCT
    a : INT := 5;
    b : ARRAY [1..3] OF BYTE;
  END_STRUCT;
END_STRUCT
BEGIN
  s.a := 6;
END_DATA_BLOCK
"""


def test_layout_of_a_source(plcgen, tmp_path):
    """Offsets by the rules of S7: strings and structures start even, an array fills its last word; gaps are rows.

    7 bits behind flag and byte 1; byte 7 behind the text of 5 bytes; byte 13 behind the array of 3: 31 bits.
    """
    (tmp_path / "old.awl").write_text(AWL, encoding="utf-8")
    result = plcgen("layout", "old.awl")
    assert (result.code, result.err) == (0, "")
    rows = [line.split() for line in result.out.splitlines()[2:]]
    assert rows == [
        ["0.0", "DB7.DBX0.0", "flag", "BOOL", "1", "bit", "TRUE"],
        ["0.1", "(unused)", "1", "B", "7", "bit"],
        ["2.0", "DB7.DBB2", "text", "STRING[3]", "5", "B"],
        ["7.0", "(unused)", "1", "B"],
        ["8.0", "DB7.DBB8", "s", "STRUCT", "6", "B"],
        ["8.0", "DB7.DBW8", "a", "INT", "2", "B", "6"],
        ["10.0", "DB7.DBB10", "b", "ARRAY[1..3]", "OF", "BYTE", "3", "B"],
        ["13.0", "(unused)", "1", "B"],
    ]
    assert result.out.startswith("DB7  14 bytes, 3 B 7 bit unused\n")


def test_layout_of_record_blocks(plcgen, tmp_path):
    """WRREC in a multi-instance: INDEX is INT on S7-300/400 and DINT on S7-1200/1500."""
    source = "FUNCTION_BLOCK F\nVAR\n  w : WRREC;\nEND_VAR\nBEGIN\n;\nEND_FUNCTION_BLOCK\n"
    (tmp_path / "f.scl").write_text(source, encoding="utf-8")

    def index(*options):
        data = json.loads(plcgen("layout", "f.scl", "--json", *options).out)
        return next(m["type"] for m in data["blocks"][0]["members"] if m["name"] == "INDEX")

    assert (index(), index("--family", "s7-1500")) == ("INT", "DINT")


def test_layout_finds_types_beside_the_source(plcgen, good, tmp_path):
    """Generated data blocks are laid out although their types stand in other folders."""
    Path(good).write_text(per_block(Path(good).read_text("utf-8")), "utf-8")
    assert plcgen("generate", good, "-q").code == 0
    result = plcgen("layout", *sorted((tmp_path / "job_generated").rglob("*.db")))
    assert (result.code, result.err) == (0, "")
    assert "Request_Ref" in result.out


def test_layout_of_what_is_no_source(plcgen, tmp_path):
    """Missing and broken sources are diagnostics; a source without blocks says so."""
    assert "error[PG804]" in plcgen("layout", "no.db").err
    (tmp_path / "x.scl").write_text("FUNCTION_BLOCK", encoding="utf-8")
    assert plcgen("layout", "x.scl").code == 1
    (tmp_path / "y.scl").write_text("// nothing\n", encoding="utf-8")
    result = plcgen("layout", "y.scl")
    assert result.code == 0
    assert result.err.startswith("no data block, type or function block in ")
    assert result.err.endswith(": no layout\n")


def verification(outcome):
    """A verification with one check."""
    check = Check("run", "run", "12 scans", outcome, "")
    return Verification("job.yaml", "out", "Demo", "s7-300", (CheckGroup("e", "Execution", (check,)),), ())


@pytest.mark.parametrize(
    ("outcome", "code"), [(Outcome.OK, 0), (Outcome.WARNING, 0), (Outcome.NOT_RUN, 0), (Outcome.ERROR, 1)]
)
def test_verify_exit_codes(plcgen, monkeypatch, outcome, code):
    """Only a failed check fails the verb; folder and drive file are handed on."""
    seen = []
    monkeypatch.setattr(plcgen_api, "verify", lambda *a, **k: seen.append((a, k["drive"])) or verification(outcome))
    result = plcgen("verify", "job.yaml", "--drive", "d.yaml")
    assert result.code == code
    assert result.out.startswith(f"Demo, s7-300: out\n\nExecution\n  run  12 scans  {outcome.value}\n")
    assert seen == [((Path("job.yaml"), Path("job_generated")), Path("d.yaml"))]
    for format_ in ("json", "junit", "sarif", "github"):
        assert plcgen("verify", "job.yaml", "--format", format_).code == code


@pytest.mark.slow
def test_verify_for_real(plcgen, good):
    """What generate wrote is verified; without it verify fails with a diagnostic."""
    before = plcgen("verify", good)
    assert before.code == 1
    assert "error[PG" in before.out
    assert plcgen("generate", good, "-q").code == 0
    after = plcgen("verify", good)
    assert after.code == 0
    assert 'DB3 "ReadIt_Request"' in after.out
    assert json.loads(plcgen("verify", good, "--format", "json").out)["ok"] is True
    (source,) = Path(good).parent.glob("*_generated/*.scl")
    source.write_text(f"x{source.read_text('utf-8')}", "utf-8")
    whole, short = plcgen("verify", good), plcgen("verify", good, "-q")
    assert ("\nRests on\n" in whole.out, "\nRests on\n" in short.out) == (True, False)
    assert (whole.code, short.code) == (1, 1)


def test_general_knowledge_is_a_warning_and_strict_makes_it_an_error(plcgen, tmp_path):
    """The type of P2000 of a SINAMICS DCM is recalled: check and verify say so."""
    (tmp_path / "x.yaml").write_text(
        "plc: {name: a, family: s7-1500, toolchain: tia-v19}\n"
        "drives: {d: {device: sinamics-dcm, hardware_id: 270}}\n"
        "jobs: {j: {drive: d, write: {P2000: 1.0}, allow: {P2000: after commissioning}}}\n",
        "utf-8",
    )
    assert plcgen("generate", "x.yaml", "-q").code == 0
    for verb in (["check", "x.yaml"], ["verify", "x.yaml", "--faults", "none"]):
        for more, code, severity in (([], 0, "warning"), (["--strict"], 1, "error")):
            said = plcgen(*verb, *more)
            assert (said.code, f"{severity}[PG228]" in said.out + said.err) == (code, True), verb


@pytest.mark.parametrize("family", ["s7-300", "s7-400", "s7-1200", "s7-1500"])
@pytest.mark.parametrize("device", device_names())
def test_new_passes_check(plcgen, device, family):
    """A starter spec has no problem but types that nobody has looked up (and a note), and fits 120 columns."""
    made = plcgen("new", "x.yaml", "--device", device, "--family", family)
    assert (made.code, made.err) == (0, "wrote x.yaml\nnext: plcgen check x.yaml\n")
    checked = plcgen("check", "x.yaml")
    assert checked.code == 0
    assert set(re.findall(r"PG\d{3}", checked.out + checked.err)) <= {"PG227", "PG228", "PG263"}


def test_new_starts_with_what_most_need(plcgen, tmp_path):
    """Actual values, ramps and the fault buffer, as far as the catalogue is sure; what identifies a drive."""

    def jobs(*args):
        assert plcgen("new", "--force", *args).code == 0
        text = (tmp_path / "job.yaml").read_text("utf-8")
        assert "plcgen explain hardware-id" in text
        return {key: job.get("read") or job.get("write") for key, job in yaml.safe_load(text)["jobs"].items()}

    assert jobs("--device", "sinamics-g120") == {
        "read_actual_values": ["r21", "r26", "r27", "r31"],
        "set_ramps": {"P1120": {"start": 10.0}, "P1121": {"start": 10.0}},
        "read_faults": ["r945[0..7]", "r949[0..7]"],
    }
    assert list(jobs("--device", "sinamics-g120", "--job", "faults", "--job", "ramps")) == ["set_ramps", "read_faults"]
    assert jobs("--device", "micromaster-4")["set_ramps"] == {"P1120": {"start": 10.0}, "P1121": {"start": 10.0}}
    refused = plcgen("new", "--device", "micromaster-4", "--job", "faults", "--force")
    assert refused.code == 2  # it has no r945
    assert "does not confirm what --job faults needs; available: " in refused.err


def test_new_never_overwrites(plcgen, tmp_path):
    """An existing file stays unless --force says otherwise."""
    (tmp_path / "job.yaml").write_text("mine", encoding="utf-8")
    refused = plcgen("new")
    assert (refused.code, (tmp_path / "job.yaml").read_text(encoding="utf-8")) == (1, "mine")
    assert "error[PG501]: the file exists\n --> job.yaml\n" in refused.err
    assert plcgen("schema", "-o", "schema.json").code == 0
    assert "error[PG501]: the file exists" in plcgen("new", "schema.json").err
    assert plcgen("new", "--force").code == 0
    assert plcgen("new", "-").out == (tmp_path / "job.yaml").read_text(encoding="utf-8")
    assert plcgen("new", "no/such/x.yaml").code == 1
    assert plcgen("new", str(tmp_path), "--force").err == f"error: {tmp_path} is a folder: name a file\n"


@pytest.mark.parametrize(
    ("args", "message"),
    [
        (["--device", "sinamics-s12"], 'unknown device "sinamics-s12", did you mean "sinamics-s120"?'),
        (["--toolchain", "tia-v77"], 'unknown toolchain "tia-v77"'),
        (["--toolchain", "step7-v5"], "STEP 7 V5 does not support the S7-1500"),
        (["--family", "s7-200"], "'s7-200' is not one of"),
    ],
)
def test_new_usage(plcgen, tmp_path, args, message):
    """A wrong choice is a usage error and writes nothing."""
    result = plcgen("new", *args)
    assert result.code == 2
    assert message.lower() in result.err.lower()
    assert not (tmp_path / "job.yaml").exists()


def test_devices(plcgen):
    """The list of devices as table and as JSON."""
    result = plcgen("schema", "--devices")
    assert result.code == 0
    assert [line.split()[0] for line in result.out.splitlines()] == ["device", *device_names()]
    data = json.loads(plcgen("schema", "--devices", "--json").out)
    assert [d["key"] for d in data["devices"]] == list(device_names())


def test_schema(plcgen, monkeypatch):
    """The schema goes to stdout as it is."""
    monkeypatch.setattr(
        plcgen_api, "schema", lambda kind, profiles: {"title": f"plcgen job {kind}", **dict.fromkeys(profiles)}
    )
    assert json.loads(plcgen("schema").out) == {"title": "plcgen job spec"}
    wrong = plcgen("schema", "drive", "--profile", "acme.yaml")
    assert wrong.code == 2
    assert "--profile belongs to the schemas spec and shared, not to drive" in wrong.err


def test_schema_for_real(plcgen):
    """The schema is draft 2020-12 and accepts the short form of a read list."""
    result = plcgen("schema")
    assert result.code == 0
    assert json.loads(result.out)["$schema"] == "https://json-schema.org/draft/2020-12/schema"


@pytest.mark.slow
def test_demo(plcgen, tmp_path, monkeypatch):
    """Shipped specs are copied, generated and verified; changed copies are kept."""
    seen = []
    monkeypatch.setattr(
        plcgen_api, "verify", lambda spec, _folder, **_: seen.append(Path(spec).name) or verification(Outcome.OK)
    )
    result = plcgen("demo", "d")
    shipped = sorted(path.name for path in specs_dir().glob("*.yaml"))
    assert (result.code, seen) == (0, shipped)
    lines = result.out.splitlines()
    assert [line.split()[0] for line in lines[: len(shipped)]] == [name.removesuffix(".yaml") for name in shipped]
    assert all(line.endswith(("1 checks ok", "1 checks ok; without faults")) for line in lines[: len(shipped)])
    assert lines[-1] == f"{len(shipped)} of {len(shipped)} specs generated and verified without an error"
    copy = tmp_path / "d" / shipped[0]
    copy.write_text("broken: [", encoding="utf-8")
    again = plcgen("demo", "d")
    assert again.code == 1
    assert again.out.split()[:2] == [shipped[0].removesuffix(".yaml"), "error:"]
    assert f"kept {Path('d') / shipped[0]}" in again.err
    assert copy.read_text(encoding="utf-8") == "broken: ["


def test_a_bug_in_a_verb_is_reported_as_one(plcgen, good, monkeypatch):
    """Exit code 70 and how to report it."""

    def fail(_, **_more):
        raise ZeroDivisionError("x")

    monkeypatch.setattr(plcgen_api, "check", fail)
    result = plcgen("check", good)
    assert result.code == 70
    assert result.err.startswith("error[PG902]: internal error: ZeroDivisionError: x\nhelp: please report this")


def test_diagnostics_of_a_step_reach_the_screen(plcgen, good, monkeypatch):
    """A DiagnosticError that a step lets out is still the user's problem, not a bug."""
    problem = DiagnosticError([Diagnostic("PG503", "disk full", Span("x"))])

    def fail(*_, **__):
        raise problem

    monkeypatch.setattr(plcgen_api, "verify", fail)
    result = plcgen("verify", good)
    assert (result.code, result.out) == (1, "")
    assert "error[PG503]: disk full" in result.err
