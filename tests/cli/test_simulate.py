"""plcgen simulate: exit codes, streams, formats."""

import json

import pytest

from tests.projects import FAQ, ROOT

OUT = ROOT / "examples" / FAQ.stem / "expected"
BASE = ("simulate", FAQ, "--out", OUT, "--job", "read_ramp_up")


def test_a_good_run(plcgen):
    """The trace is the result: on stdout, exit code 0, nothing on stderr."""
    result = plcgen(*BASE)
    assert (result.code, result.err) == (0, "")
    assert result.out.endswith("1 job: 1 done; 8 scans, 80 ms\n")


def test_the_default_folder(plcgen, good):
    """Without --out the folder beside the spec is taken; a missing one says what to do."""
    missing = plcgen("simulate", good)
    assert (missing.code, missing.out) == (1, "")
    assert missing.err.startswith("error[PG507]: there is no such folder\n --> job_generated\n")
    assert plcgen("generate", good).code == 0
    assert plcgen("simulate", good).code == 0


def test_a_job_in_error(plcgen):
    """Exit code 1; a run that was limited is none."""
    assert plcgen(*BASE, "--fault", "error:number=17").code == 1
    assert plcgen(*BASE, "--fault", "error:number=17", "--scans", "5").code == 0


def test_b5_twice_on_the_command_line(plcgen):
    """Two retries, then the value."""
    data = json.loads(plcgen(*BASE, "--fault", "busy:times=2", "--json").out)
    (job,) = data["jobs"]
    assert (job["retries"], job["ending"], job["values"][0]["value"]) == (2, "done", 10.0)


def test_vcd_to_a_file(plcgen, tmp_path):
    """The file holds the dump, stderr the summary; --quiet drops it."""
    result = plcgen(*BASE, "--format", "vcd", "-o", "run.vcd")
    assert (result.code, result.out) == (0, "")
    assert result.err == "wrote run.vcd\n1 job: 1 done; 8 scans, 80 ms\n"
    assert (tmp_path / "run.vcd").read_bytes().startswith(b"$version plcgen ")
    assert plcgen(*BASE, "--format", "vcd", "-q").err == ""


@pytest.mark.parametrize(
    ("arguments", "start"),
    [
        (
            ["--fault", "bussy"],
            'error[PG901]: there is no fault "bussy"\n --> --fault bussy\n  = help: did you mean "busy"?',
        ),
        (["--scans", "0"], "error[PG901]: invalid value for '--scans'"),
        (["--scan-time", "fast"], "error[PG901]: a scan takes whole milliseconds"),
        (["--set", "readRampUp.bussy=1"], "error[PG901]: there is no member, tag or address readRampUp.bussy"),
        (["--job", "nothing"], 'error[PG901]: the spec has no job "nothing"'),
        (["--format", "svg"], "error[PG901]: invalid value for '-f' / '--format'"),
    ],
)
def test_wrong_arguments(plcgen, arguments, start):
    """Exit code 2, one error, no result."""
    result = plcgen(*BASE, *arguments)
    assert (result.code, result.out) == (2, "")
    assert result.err.startswith(start)


def test_a_job_on_several_drives_is_named_with_each(plcgen, tmp_path):
    """The key of the spec names no job then: the help names those there are, and not all of the others."""
    spec = tmp_path / "two.yaml"
    drives = "fan1: {device: sinamics-g120, hardware_id: 270}, fan2: {device: sinamics-g120, hardware_id: 271}"
    jobs = "keep_ramps: {drive: [fan1, fan2], write: {P1120: 5.0}}, other: {drive: fan1, read: [r21]}"
    head = "plc: {name: a, family: s7-1500, toolchain: tia-v19}"
    spec.write_text(f"{head}\ndrives: {{{drives}}}\njobs: {{{jobs}}}\n", "utf-8")
    told = plcgen("simulate", spec, "--job", "keep_ramps")
    assert (told.code, told.out) == (2, "")
    assert told.err.endswith("= help: it is on several drives: keep_ramps.fan1, keep_ramps.fan2\n")
    assert plcgen("generate", spec).code == 0
    assert plcgen("simulate", spec, "--job", "keep_ramps.fan1", "--job", "keep_ramps.fan2").code == 0


def test_own_source_that_does_not_compile(plcgen, tmp_path):
    """Every error of the user's file at its place, exit code 1, no traceback."""
    path = tmp_path / "own.scl"
    path.write_text('FUNCTION "F" : Void\nBEGIN\n#x := 1;\nEND_FUNCTION\n', "utf-8")
    result = plcgen(*BASE, "--with", path)
    assert (result.code, result.out) == (1, "")
    assert "own.scl:3:1" in result.err
    missing = plcgen(*BASE, "--with", "no.scl")
    assert (missing.code, missing.err[:12]) == (1, "error[PG804]")
