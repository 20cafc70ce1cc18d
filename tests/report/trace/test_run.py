"""What a recorded run says, against expectations worked out by hand from the block's states and from DS47."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from plcgen import api
from plcgen.report.trace.model import Trace
from tests.projects import FAQ, ROOT

Run = Callable[..., Trace]

REQUEST = bytes.fromhex("01 01 02 01 10 01 C47F 0000")  # reference 1, read, object 2, one value of P50303
ANSWER = bytes.fromhex("01 01 02 01 08 01 41200000")  # FloatingPoint, one value, 10.0


def history(trace: Trace, signal: str) -> list[tuple[int, object]]:
    """(scan, value) of every change of a signal."""
    position = [found.id for found in trace.signals].index(signal)
    return [(step.scan, value) for step in trace.steps for n, value in step.changes if n == position]


@pytest.mark.parametrize("target", ["faq", "v5", "t3", "t15"])
def test_the_read_job_goes_through_its_states(run: Run, target: str) -> None:
    """Ask, hand over, WRREC busy for two calls, RDREC too, its answer checked at once, hear of it: 8 scans."""
    trace = run(target, jobs=["read_ramp_up"])
    states = [(1, 1), (2, 4), (4, 5), (7, 1), (8, 0)]
    assert history(trace, "read_ramp_up.state") == states
    assert history(trace, "read_ramp_up.WRREC.REQ") == [(2, True), (3, False)]
    assert history(trace, "read_ramp_up.WRREC.BUSY") == [(2, True), (4, False)]
    assert history(trace, "read_ramp_up.WRREC.DONE") == [(4, True), (5, False)]
    assert history(trace, "read_ramp_up.WRREC.STATUS") == [(2, 0x00700100), (3, 0x00700200), (4, 0)]
    assert history(trace, "read_ramp_up.RDREC.VALID") == [(7, True), (8, False)]
    assert history(trace, "read_ramp_up.RDREC.LEN") == [(7, 10)]
    assert history(trace, "read_ramp_up.status") == [(1, 0x7001), (2, 0x7002), (8, 0)]
    assert history(trace, "DcmUnit.owner") == [(1, 1), (8, 0)]
    assert (trace.ended, trace.scans, trace.time, trace.ok) == ("jobs", 8, 80, True)
    assert "read_ramp_up.WRREC.LEN" not in [signal.id for signal in trace.signals]


@pytest.mark.parametrize("target", ["v5", "t3", "t15"])
def test_telegrams_and_value(run: Run, target: str) -> None:
    """The drive gets the FAQ's telegram, the block gets the drive's 10.0 seconds."""
    trace = run(target, jobs=["read_ramp_up"])
    contacts = [(step.scan, c.direction, c.status, c.data) for step in trace.steps for c in step.contacts]
    sent, got = (contacts[0][3][0], contacts[1][3][0])  # the reference begins anywhere after a start
    request, answer = bytes((sent,)) + REQUEST[1:], bytes((sent,)) + ANSWER[1:]
    assert contacts == [(4, "write", 0, request), (7, "read", 0, answer)]
    assert 1 <= sent == got <= 255
    assert history(trace, "read_ramp_up.rampUpTime1") == [(8, 10.0)]
    (job,) = trace.jobs
    assert (job.ending, job.status, job.scan, job.time, job.telegrams, job.retries) == ("done", 0, 8, 80, 1, 0)
    (value,) = job.values
    assert (value.label, value.value, value.unit, value.error) == ("P50303", 10.0, "s", None)


@pytest.mark.parametrize("target", ["faq", "v5", "t3", "t15"])
def test_the_value_of_a_job_is_the_one_that_was_sent(run: Run, target: str) -> None:
    """A request in a data block of the user's sends what is there: 50.0 (42480000), not the 100.0 of the spec."""
    trace = run(target, jobs=["write_ramp_down"], sets=['"WR_DataBuffer_1".Value=50.0'])
    request = next(c.data for step in trace.steps for c in step.contacts if c.direction == "write")
    assert request[-4:] == bytes.fromhex("42480000")
    assert [value.value for value in trace.jobs[0].values] == [50.0]


@pytest.mark.parametrize(("at", "value"), [(1, 7.5), (6, 5.0)])
def test_an_input_that_changes_after_the_request_was_sent(tmp_path: Path, at: int, value: float) -> None:
    """Sent in scan 4: what the input becomes in scan 6 belongs to the next start; the spec starts with 5.0."""
    spec = tmp_path / "job.yaml"
    spec.write_text(FAQ.read_text("utf-8").replace("write: {P50304: 100.0}", "write: {P50304: {start: 5.0}}"), "utf-8")
    text = spec.read_text("utf-8")
    assert "start: 5.0" in text
    assert api.generate(spec, tmp_path / "out").ok
    sets = [f"writeRampDown.rampDownTime1=7.5@{at}"]
    trace = api.simulate(spec, tmp_path / "out", jobs=["write_ramp_down"], sets=sets)
    assert [one.value for one in trace.jobs[0].values] == [value]


def test_a_parameter_that_a_sequence_writes_twice(tmp_path: Path) -> None:
    """Each step tells of its own value, not of the last one that was sent."""
    spec = tmp_path / "job.yaml"
    text = FAQ.read_text("utf-8").partition("jobs:")[0]
    spec.write_text(
        f"{text}jobs: {{twice: {{drive: dcm, sequence: [write: {{P50304: 5.0}}, write: {{P50304: 7.0}}]}}}}"
    )
    assert api.generate(spec, tmp_path / "out").ok
    trace = api.simulate(spec, tmp_path / "out")
    assert [one.value for one in trace.jobs[0].values] == [5.0, 7.0]


def test_two_jobs_take_turns(run: Run) -> None:
    """The channel sees in scan 8 that the first job has gone, and gives the unit to the second one in the same scan."""
    trace = run()
    assert history(trace, "DcmUnit.owner") == [(1, 1), (8, 2), (15, 0)]
    assert [(job.key, job.ending, job.scan) for job in trace.jobs] == [
        ("read_ramp_up", "done", 8),
        ("write_ramp_down", "done", 15),
    ]
    written = next(c for step in trace.steps for c in step.contacts if c.group == "write_ramp_down")
    assert written.data == bytes.fromhex("02 02 02 01 10 01 C480 0000 08 01 42C80000")  # P50304 := 100.0


def test_b5_twice_is_two_retries(run: Run) -> None:
    """RDREC fails in scans 7 and 11, and succeeds in scan 16.

    Between the first two lie a scan without a call and three of RDREC, then 20 ms, the place and two calls.
    """
    trace = run(jobs=["read_ramp_up"], faults=["busy:times=2"])
    assert history(trace, "read_ramp_up.RDREC.ERROR") == [(7, True), (8, False), (11, True), (12, False)]
    assert [(s.scan, c.status) for s in trace.steps for c in s.contacts if c.direction == "read"] == [
        (7, 0xDE80B500),
        (11, 0xDE80B500),
        (16, 0),
    ]
    (job,) = trace.jobs
    assert (job.ending, job.retries, job.telegrams, job.scan) == ("done", 2, 1, 17)


def test_a_refused_write_is_no_telegram(run: Run) -> None:
    """WRREC ends in error in scan 4; the telegram that the drive took is the only one that counts."""
    (job,) = run(jobs=["read_ramp_up"], faults=["busy:call=write"]).jobs
    assert (job.ending, job.retries, job.telegrams) == ("done", 1, 1)


def test_a_job_that_is_never_called(run: Run, own: Path) -> None:
    """The run ends when its time-out and draining are over, and that is no success."""
    text = own.read_text("utf-8")
    own.write_text(text.replace('"Sender_DB"();', ";"), "utf-8")
    trace = run(own=[own], scan_time="100ms")
    assert (trace.ended, trace.ok, trace.diagnostics) == ("scans", False, ())
    assert trace.time >= 15_000
    assert [job.ending for job in trace.jobs] == ["not started", "not started"]


def test_a_refused_parameter(run: Run) -> None:
    """Error 02h of the drive: the job ends in error 8401, names the parameter, returns no value."""
    trace = run(jobs=["read_ramp_up"], faults=["error:number=2,info=0"])
    (job,) = trace.jobs
    assert (job.ending, job.status, trace.ok) == ("error", 0x8401, False)
    assert (job.values[0].error, job.values[0].value) == (2, None)
    assert history(trace, "read_ramp_up.rampUpTime1") == []


def test_a_lost_request_is_sent_again(run: Run) -> None:
    """B5 for a third of the timeout of 10 s: the request is lost, and a new one does.

    WRREC is done at 40 ms. RDREC ends in B5 at 70, 110, 160, 240 and 370 ms (a scan, 20, 50 or 100 ms, one call for the
    place, two more of RDREC) and then every 230 ms; at 370 + 14 x 230 = 3,590 ms, the 19th time, more than 3,333 ms
    have passed. A pause, a call for the place, six of WRREC and RDREC, and one in which the job hears of it: 3,860 ms.
    """
    (job,) = run(jobs=["read_ramp_up"], faults=["silence"]).jobs
    assert (job.ending, job.time, job.telegrams, job.retries) == ("done", 3_860, 2, 19)


def test_a_silent_drive(run: Run) -> None:
    """Retries run out; with long scans the timeout of 10 s does.

    Two requests are lost, at 3,590 and 7,300 ms, the next is written at 7,530 ms; pauses of 8,170 ms are 40 retries.
    With 50 ms a retry takes 350 ms. The job gets the unit in the first call; the one after the timeout reports it.
    """
    (job,) = run(jobs=["read_ramp_up"], faults=["silence:times=forever"]).jobs
    assert (job.ending, job.status, job.telegrams) == ("error", 0x8203, 3)
    assert 9_500 < job.time < 10_000
    (job,) = run(jobs=["read_ramp_up"], faults=["silence:times=forever"], scan_time="50ms").jobs
    assert (job.status, job.time) == (0x8101, 10_100)


def test_a_limited_run_is_no_failure(run: Run) -> None:
    """Looking at five scans only is what was asked for; without a limit a job that goes on would be an error."""
    trace = run(scans=5)
    assert (trace.ended, trace.scans, trace.ok) == ("scans", 5, True)
    assert [job.ending for job in trace.jobs] == ["running", "running"]


def test_execute_dropped_in_mid_job(run: Run) -> None:
    """A job goes on when execute falls and shows done for one call."""
    trace = run(jobs=["read_ramp_up"], sets=["M50.0=FALSE@5", "M60.0=TRUE@9"])
    assert history(trace, "read_ramp_up.execute") == [(1, True), (5, False)]
    assert history(trace, "read_ramp_up.done") == [(8, True), (9, False)]
    assert history(trace, "memory.M60.0") == [(9, True)]
    assert trace.jobs[0].ending == "done"


def test_faults_from_a_file_and_for_one_drive(run: Run, tmp_path: Path) -> None:
    """A YAML list or the key ``faults``; ``drive`` chooses the drive."""
    path = tmp_path / "faults.yaml"
    path.write_text("faults:\n- {kind: busy, call: write, drive: dcm, times: 1}\n", "utf-8")
    assert run(jobs=["read_ramp_up"], fault_file=path).jobs[0].retries == 1
    path.write_text("- {kind: busy, tims: 1}\n- {kind: late, milliseconds: x}\n", "utf-8")
    found = run(fault_file=path).diagnostics
    assert [(d.code, d.span.line) for d in found] == [("PG104", 1), ("PG106", 2)]


def test_a_drive_file(run: Run, tmp_path: Path) -> None:
    """The user's own drive has its own value."""
    path = tmp_path / "drive.yaml"
    parameter = "{pnu: 50303, type: FloatingPoint, value: 7.5}"
    path.write_text(f"objects:\n- number: 2\n  parameters:\n  - {parameter}\n", "utf-8")
    for option in (str(path), f"dcm={path}"):
        (job,) = run(jobs=["read_ramp_up"], drives=[option]).jobs
        assert job.values[0].value == 7.5
    assert run(drives=[str(path), str(path)]).diagnostics[0].code == "PG901"


def test_every_member_and_inputs_from_a_file(run: Run, tmp_path: Path) -> None:
    """The file sets execute in scan 3; of all data blocks every member is recorded, the bytes of the request too."""
    path = tmp_path / "inputs.txt"
    path.write_text("# starts late\n\nM50.0=FALSE@1\n  M50.0=TRUE@3\n", "utf-8")
    trace = run(jobs=["read_ramp_up"], inputs=path, watches=["*"])
    assert history(trace, "read_ramp_up.state")[:2] == [(3, 1), (4, 4)]
    paths = {signal.path for signal in trace.signals}
    assert {'"WR_DataBuffer".Request_Ref', '"RD_DataBuffer".ParameterValue', '"DcmUnit".unit.state'} <= paths
    assert history(trace, 'memory."RD_DataBuffer".ParameterValue') == [(9, 10.0)]  # VALID comes in scan 7 of a job
    assert run(jobs=["read_ramp_up"], inputs=path, scans=2).jobs[0].ending == "not started"


def test_every_line_of_inputs_that_is_none_is_reported(run: Run, tmp_path: Path) -> None:
    """File, line and column of each; nothing runs."""
    path = tmp_path / "inputs.txt"
    path.write_text("M50.0=TRUE\nM50.0\n\n=5@2\n", "utf-8")
    trace = run(inputs=path)
    places = [(d.code, d.span.file, d.span.line, d.span.column) for d in trace.diagnostics]
    assert places == [("PG901", str(path), 2, 1), ("PG901", str(path), 4, 1)]
    assert trace.scans == 0
    assert [d.code for d in run(inputs=tmp_path / "none.txt").diagnostics] == ["PG110"]


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("M50.0=TRUE@0", "scans count from 1 to 10,000,000"),
        ("M50.0=TRUE@10000001", "scans count from 1 to 10,000,000"),
        (f"M50.0=TRUE@{'9' * 5000}", "scans count from 1 to 10,000,000"),
        ("readRampUp.excute=TRUE@2", "there is no member, tag or address readRampUp.excute"),
        ("DB3.DBW6=65536@900", "outside -32768..65535"),
        ("M50.0=5@900", "not a valid BOOL constant"),
        ("=" * 70_000, "a member and its value are needed"),
        ("a\x85b=1", "there is no member, tag or address"),
        ("RD_DataBuffer=1", "there is no member, tag or address"),
        ("DcmUnit.unit=1", "is an array or structure"),
    ],
)
def test_a_line_of_inputs_is_held_against_the_program_before_anything_runs(
    run: Run, tmp_path: Path, line: str, said: str
) -> None:
    """At its line, whatever the scan in which it would count; a value at the end of its range is none."""
    path = tmp_path / "inputs.txt"
    path.write_text(f"DB3.DBW6=65535@900\n{line}\n", "utf-8")
    trace = run(jobs=["read_ramp_up"], inputs=path)
    (wrong,) = trace.diagnostics
    assert (wrong.code, wrong.span.file, wrong.span.line, trace.scans) == ("PG901", str(path), 2, 0)
    assert said in wrong.message


def test_many_lines_of_inputs_take_no_longer_each(run: Run, tmp_path: Path) -> None:
    """200,000 values before the same scan, the last one counts; of 200,000 mistakes 20 are shown."""
    path = tmp_path / "inputs.txt"
    path.write_text("DB3.DBW6=7@2\n" * 200_000 + "DB3.DBW6=8@2\nM50.0=TRUE@3\n", "utf-8")
    trace = run(jobs=["read_ramp_up"], inputs=path, scans=3)
    assert history(trace, "memory.DB3.DBW6")[0] == (2, 8)
    path.write_text("M50.0=2\n" * 200_000, "utf-8")
    assert len(run(jobs=["read_ramp_up"], inputs=path).diagnostics) == 20


def test_own_blocks_instead_of_the_example(run: Run, own: Path) -> None:
    """The user's OB runs, his WRREC is recorded under its instance, and the changed LEN is reported at its line."""
    trace = run(own=[own], watches=["Sender_DB.step"], scans=4)
    assert trace.main == "MyCycle"
    assert history(trace, "memory.Sender_DB.step") == [(1, 1), (2, 2), (3, 3), (4, 4)]
    assert history(trace, "Sender_DB.wr.WRREC.REQ") == [(1, True), (3, False)]
    assert history(trace, "Sender_DB.wr.WRREC.DONE") == [(3, True), (4, False)]
    sent = [(s.scan, c.group, c.data) for s in trace.steps for c in s.contacts]
    assert sent == [(3, "Sender_DB.wr", bytes.fromhex("05 01 02 01 10 01 C47F 0000"))]
    assert [(d.code, d.span.line, d.span.column) for d in trace.diagnostics] == [("PG830", 18, 1)]
    assert not trace.ok
    assert [job.ending for job in trace.jobs] == ["not started", "not started"]


def test_own_blocks_beside_the_example(run: Run, own: Path) -> None:
    """Without an OB of his own the user's blocks are loaded and the generated example runs."""
    text = own.read_text("utf-8")
    own.write_text(text[: text.index("ORGANIZATION_BLOCK")], "utf-8")
    trace = run(own=[own])
    assert (trace.main, trace.ok) == ("Main", True)
    assert [job.scan for job in trace.jobs] == [8, 15]


def test_a_fault_of_the_program_stops_the_cpu(run: Run, own: Path) -> None:
    """An endless loop ends the run with a diagnostic, as a CPU would go to STOP."""
    text = own.read_text("utf-8").replace('"Sender_DB"();', "WHILE TRUE DO ; END_WHILE;")
    own.write_text(text, "utf-8")
    trace = run(own=[own])
    assert (trace.ended, trace.scans, trace.ok) == ("stop", 1, False)
    assert [d.code for d in trace.diagnostics] == ["PG835"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"jobs": ["read_ramp"]}, 'the spec has no job "read_ramp"'),
        ({"sets": ["readRampUp.rampTime=1"]}, "there is no member, tag or address readRampUp.rampTime"),
        ({"sets": ["M50.0"]}, "a member and its value are needed"),
        ({"sets": ["M50.0=17"]}, "17 is not a valid BOOL constant: TRUE, FALSE, 1 or 0"),
        ({"watches": ["DriveJobs"]}, "there is no member, tag or address DriveJobs"),
        ({"faults": ["bussy"]}, 'there is no fault "bussy"'),
        ({"faults": ["busy:times"]}, '"times" has no value'),
        ({"faults": ["busy:drive=x"]}, 'there is no drive "x"'),
        ({"faults": ["busy:code=256"]}, '"code": must be less than or equal to 255, not "256"'),
        ({"scan_time": "0"}, "a scan takes whole milliseconds, from 1ms to 60s"),
        ({"scan_time": "10 min"}, "a scan takes whole milliseconds, from 1ms to 60s"),
    ],
)
def test_arguments_that_make_no_sense(run: Run, arguments: dict[str, object], message: str) -> None:
    """Every mistake is one diagnostic that quotes the argument; nothing runs."""
    trace = run(**arguments)
    assert [(d.code, d.message) for d in trace.diagnostics] == [("PG901", message)]
    assert trace.diagnostics[0].span.file.startswith("--")
    assert (trace.scans, trace.ok) == (0, False)


@pytest.mark.parametrize(
    ("text", "field", "value"),
    [
        ("busy:code=C3", "code", 0xC3),
        ("busy:code=c3h", "code", 0xC3),
        ("busy:code=16#C3", "code", 0xC3),
        ("busy:code=12", "code", 12),
        ("status:status=DF80A100", "status", 0xDF80A100),
        ("status:status=80000000", "status", 0x80000000),
        ("busy:times=forever", "times", None),
        ("junk:data=0102", "data", b"\x01\x02"),
    ],
)
def test_spellings_of_a_fault(text: str, field: str, value: object) -> None:
    """Codes are hexadecimal where their spelling says so."""
    from plcgen.ds47.recording.faults import plan_faults

    (fault,) = plan_faults([text], None, ["dcm"]).of("dcm")
    assert getattr(fault, field) == value


def test_missing_folder_and_spec(tmp_path: Path) -> None:
    """Both are diagnostics."""
    assert api.simulate(tmp_path / "no.yaml", tmp_path).diagnostics[0].code == "PG110"
    spec = tmp_path / "job.yaml"
    spec.write_text(FAQ.read_text("utf-8"), "utf-8")
    assert [d.code for d in api.simulate(spec, tmp_path / "no").diagnostics] == ["PG507"]
    assert [d.code for d in api.simulate(spec, tmp_path).diagnostics] == ["PG608"]


def test_a_folder_of_another_spec() -> None:
    """Blocks that the spec needs are missing: a diagnostic, not a traceback."""
    other = ROOT / "specs" / "s7-1200_s120_recipe.yaml"
    found = api.simulate(other, ROOT / "examples" / "s7-1500_g120_pn" / "expected").diagnostics
    assert [d.code for d in found] == ["PG608"]
    assert "Cu1Unit" in found[0].message
