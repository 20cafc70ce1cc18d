"""What somebody with bad intent, or bad luck, hands to the command line."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

SPEC = """\
plc: {name: a, family: s7-300, toolchain: tia-v16}
drives: {d: {device: sinamics-dcm, address: 256}}
jobs: {j: {drive: d, read: [P50303]}}
"""
posix = pytest.mark.skipif(sys.platform == "win32", reason="there are no such files")


@posix
@pytest.mark.parametrize("end", ["scl", "xml", "sdf", "yaml", "csv"])
@pytest.mark.parametrize("what", ["fifo", "zero"])
@pytest.mark.parametrize("verb", ["check", "layout", "verify", "diff", "audit", "lock", "ppi decode --file"])
def test_every_verb_refuses_what_has_no_end(plcgen, tmp_path, verb, what, end):
    """A FIFO that nobody writes and /dev/zero: a message, at once."""
    path = tmp_path / f"x.{end}"
    os.mkfifo(path) if what == "fifo" else path.symlink_to("/dev/zero")
    args = [*verb.split(), path.name, *([path.name] if verb == "diff" else [])]
    result = plcgen(*args)
    assert result.code != 0
    assert "bug in plcgen" not in result.err


@pytest.mark.slow
@posix
def test_a_folder_with_a_manifest_that_has_no_end(plcgen, tmp_path):
    """Verify and generate read the manifest of the output folder."""
    (tmp_path / "job.yaml").write_text(SPEC)
    (tmp_path / "job_generated").mkdir()
    os.mkfifo(tmp_path / "job_generated/manifest.json")
    for verb in ("verify", "generate", "check"):
        assert "bug in plcgen" not in plcgen(verb, "job.yaml").err


@pytest.mark.parametrize(
    "target", ["job.yaml", "other.yaml", "motor.scl", "job_generated/LAYOUT.md", "job_generated/manifest.json"]
)
def test_output_is_never_a_source(plcgen, tmp_path, target):
    """A report overwrites reports, but neither a spec nor a source nor what was generated."""
    (tmp_path / "job.yaml").write_text(SPEC)
    (tmp_path / "other.yaml").write_text(SPEC)
    (tmp_path / "motor.scl").write_text("// mine")
    assert plcgen("generate", "job.yaml").code == 0
    before = (tmp_path / target).read_bytes()
    result = plcgen("check", "job.yaml", "--json", "-o", target)
    assert result.code == 2
    assert "write the result elsewhere" in result.err
    assert (tmp_path / target).read_bytes() == before


@pytest.mark.parametrize(
    "args",
    [
        ["check", "{}.yaml"],
        ["layout", "{}.db"],
        ["{}"],
        ["check", "job.yaml", "-o", "no/{}"],
        ["ppi", "decode", "--file", "{}"],
        ["explain", "{}"],
    ],
)
def test_no_escape_sequence_reaches_the_terminal(plcgen, tmp_path, args):
    """What somebody else wrote, such as the name of a file, never colours or moves anything."""
    (tmp_path / "job.yaml").write_text(SPEC)
    result = plcgen(*(arg.format("x\x1b[31m") for arg in args))
    assert result.code != 0
    assert "\x1b" not in result.out + result.err


@pytest.mark.parametrize("value", ["{a: 1}", "[1, {a: 1}]", "{}"])
def test_a_station_with_a_mapping_as_value(plcgen, tmp_path, value):
    """A diagnostic at its place, no traceback."""
    (tmp_path / "x.yaml").write_text(f"cpu: '224'\nvalues: {{VW0: {value}}}\n")
    result = plcgen("ppi", "serve", "--values", "x.yaml")
    assert result.code == 1
    assert "error[PG107]: VW0: " in result.err
    assert "bug in plcgen" not in result.err


@pytest.mark.parametrize(
    ("name", "heading"),
    [
        ("'# a'", r"# \# a: layout"),
        ("<b>x</b>", "# &lt;b&gt;x&lt;/b&gt;: layout"),
        ("'a](http://x)'", r"# a\](http://x): layout"),
        ("'`a` *b* _c_ d_e'", r"# \`a\` \*b\* \_c\_ d_e: layout"),
    ],
)
def test_names_are_no_markdown(plcgen, tmp_path, name, heading):
    """A project may be called anything; a viewer shows just that."""
    (tmp_path / "job.yaml").write_text(SPEC.replace("name: a", f"name: {name}"))
    assert plcgen("generate", "job.yaml").code == 0
    assert (tmp_path / "job_generated/LAYOUT.md").read_text("utf-8").startswith(heading)


def test_the_import_script_has_no_word_of_the_project(plcgen, tmp_path):
    """PowerShell ends strings at ‘ ’ ‚ ‛ too: what is the same text for every project cannot be told what to run."""
    scripts = []
    for name in ("fan", "‘; calc; ‘", "a’b‚c‛d", "$$(calc)", "`n"):
        text = SPEC.replace("name: a, family: s7-300", f"name: {json.dumps(name)}, family: s7-1500")
        (tmp_path / "job.yaml").write_text(text.replace("address: 256", "hardware_id: 270"), "utf-8")
        assert plcgen("generate", "job.yaml", "--out", f"out{len(scripts)}").code == 0
        scripts.append((tmp_path / f"out{len(scripts)}/xml/import.ps1").read_bytes())
    assert len(set(scripts)) == 1
    assert scripts[0].isascii()


def test_a_lock_names_no_path_of_this_machine(plcgen, tmp_path):
    """What is not below the lock's folder is not named, so that the lock is the same everywhere."""
    (tmp_path / "sub").mkdir()
    (tmp_path / "a.db").write_text('DATA_BLOCK "B"\nSTRUCT\n  a : Int;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n')
    assert plcgen("lock", "a.db", "--out", "sub/x.lock.json").code == 0
    assert "a.db" not in (tmp_path / "sub/x.lock.json").read_text()
    assert "names no sources" in plcgen("lock", "--check", "--out", "sub/x.lock.json").err
    assert plcgen("lock", "--check", "a.db", "--out", "sub/x.lock.json").code == 0


def test_a_small_spec_is_refused_before_it_becomes_large(plcgen, tmp_path, monkeypatch):
    """Telegrams per job and per project are bounded before buffers are made of them."""
    from plcgen.ds47.plan import room

    jobs = "".join(f' j{n}: {{drive: d, read: [{{parameter: "r9[0..9999]", type: Unsigned32}}]}}\n' for n in range(9))
    text = "plc: {name: a, family: s7-300, toolchain: tia-v16}\ndrives: {d: {device: sinamics-g120, address: 256}}\n"
    (tmp_path / "job.yaml").write_text(f"{text}jobs:\n{jobs}")
    monkeypatch.setattr(room, "MAX_TELEGRAMS", 500)
    result = plcgen("check", "job.yaml")
    assert result.code == 1
    assert result.err.count("PG307") + result.out.count("PG307") == 1
    assert "have more than 500 telegrams" in result.err + result.out
    assert "job.yaml:6:2" in result.err + result.out


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no such device")
def test_a_full_disk_is_no_bug(tmp_path):
    """Help that cannot be written: what is full is told, and nobody is asked for a report."""
    with Path("/dev/full").open("w") as full:
        args = [sys.executable, "-m", "plcgen", "--help"]
        run = subprocess.run(args, stdout=full, stderr=subprocess.PIPE, text=True, cwd=tmp_path, check=False)
    assert (run.returncode, "cannot write: No space left on device" in run.stderr) == (1, True)
    assert "PG902" not in run.stderr


def test_memory_that_ran_out_is_no_bug(plcgen, tmp_path, monkeypatch):
    """What ran out is said, without exit code 70."""

    def exhausted(*_args, **_options):
        raise MemoryError

    (tmp_path / "job.yaml").write_text(SPEC)
    monkeypatch.setattr("plcgen.api.project.problems_of", exhausted)
    result = plcgen("check", "job.yaml")
    assert (result.code, "memory" in result.err, "PG902" in result.err) == (1, True, False)


@pytest.mark.parametrize("value", ["{}", "{a: 1}", "[{}]", "[[]]", "x", "null", ".5"])
def test_a_bit_of_a_station_with_a_wrong_value(plcgen, tmp_path, value):
    """A diagnostic, no TypeError."""
    (tmp_path / "x.yaml").write_text(f"cpu: 224\nvalues: {{M0.0: {value}}}\n")
    result = plcgen("ppi", "serve", "--values", "x.yaml")
    assert (result.code, "error[PG1" in result.err, "PG902" in result.err) == (1, True, False)
