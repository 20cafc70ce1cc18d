"""verify and PPI masters: the shipped ones pass with full coverage, and damage is noticed at its place."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest

from plcgen import api
from plcgen.base.diagnostics import Report
from plcgen.ppi.plan.nouns import PpiPlan
from plcgen.ppi.proof.scenarios import spread
from plcgen.ppi.review import buffers
from plcgen.project.loading import load_spec
from plcgen.project.nouns import Project
from plcgen.project.resolve import resolve
from plcgen.proof.checks import Verification
from plcgen.proof.execution import Work, attempt
from plcgen.proof.rig import ProgramBench
from tests.mutation.run import executed
from tests.projects import ROOT, generated_example

HEADS = {
    "t12": ("s7-1200", "tia-v19", "cm1241", "port: 270"),
    "t15": ("s7-1500", "tia-v19", "cm-ptp", "port: 270"),
    "t3": ("s7-300", "tia-v16", "cp341", "address: 256"),
    "v5": ("s7-300", "step7-v5", "cp341", "address: 256"),
}
BODY = """
    stations: {p: {address: 2, cpu: "224"}, q: {address: 3}}
    jobs:
      all:
        station: p
        read: [VB100, {item: VW102, type: Int}, {item: VD104, type: Real}, M0.0, Q0.3, T37, C5, "VB200[5]", "VW210[3]"]
      some: {station: p, read: [VB100, VB101, M0.0], merge: false, cycle: 1s}
      write:
        station: p
        write: {VW200: null, VB202: null, VD203: {type: Real, start: 1.5}, M0.1: null, "VB300[3]": null}
      long: {station: q, read: ["VB0[300]"]}
      go: {station: q, run: true}
"""

SMALL = """
    stations: {p: {address: 2, cpu: "224"}, q: {address: 3}}
    jobs:
      all: {station: p, read: [VB100, VW110, M0.0, C5], merge: false}
      write: {station: q, write: {VW200: null, VB202: null}}
"""
"""What the damage below needs, and no more: each case runs the whole matrix."""


def spec_of(target: str, body: str = BODY) -> str:
    family, toolchain, module, port = HEADS[target]
    head = f"plc: {{name: t, sources: per_block, family: {family}, toolchain: {toolchain}}}"
    return f"{head}\nppi:\n  m:\n    module: {module}\n    {port}{body}"


def made(target: str, folder: Path, body: str = BODY) -> Path:
    spec = folder / "spec.yaml"
    spec.write_text(spec_of(target, body), encoding="utf-8")
    result = api.generate(spec, folder / "out")
    assert result.ok, [f"{d.span} {d.code} {d.message}" for d in result.diagnostics]
    return spec


def project_of(spec: Path) -> Project:
    loaded = load_spec(spec, Report())
    assert loaded is not None
    return resolve(loaded, Report())


def troubles(result: Verification) -> list[str]:
    found = [f"{c.subject}: {c.verdict}" for c in result.checks() if c.outcome.value in {"error", "warning"}]
    return found + [d.message for d in result.diagnostics if d.severity.label == "error"]


@pytest.mark.parametrize("target", ["t15", "v5"])
def test_a_master_passes_every_scenario_with_full_coverage(target: str, tmp_path: Path) -> None:
    """Joined items, split jobs, arrays, types, bits inside bytes, inputs: on either module, in either spelling.

    The code for TIA S7-300 is that for STEP 7 V5 in the spelling of the S7-1500; it runs with other specs below.
    """
    result = api.verify(made(target, tmp_path), tmp_path / "out")
    assert troubles(result) == []
    assert {c.id for c in result.checks()} >= {"coverage.m", "together.m", "faults.m.all", "run.m.go"}


@pytest.mark.parametrize("name", ["s7-1200_s7-200_ppi", "s7-300_s7-200_ppi_cp341"])
def test_the_shipped_masters_run(name: str) -> None:
    """Nominal runs of the shipped specs."""
    result = api.verify(ROOT / "specs" / f"{name}.yaml", generated_example(name), faults="none")
    assert troubles(result) == []
    runs = [c for c in result.checks() if c.id.startswith("run.")]
    assert all("1 request, 1 poll" in c.text for c in runs)


DAMAGE: dict[str, tuple[str, str]] = {
    "the frame count bit stands still": (
        "#statFunctionCode[#statStation] := B#16#7C;",
        "#statFunctionCode[#statStation] := B#16#5C;",
    ),
    "a repetition takes another function code": (
        "#statCall := #CALL_SEND;",
        "#statCall := #CALL_SEND;\n      #statSend[6] := B#16#7C;",
    ),
    "the reference stays": ("#statReference := #statReference + 1;", "#statReference := #statReference;"),
    "the reference is half compared": (" AND #statReceive[#tempFirst + 7] = #statReferenceHigh", ""),
    "FCS forgets the last byte": (
        "FOR #tempIndex := 5 TO #statSendLength - 2 DO",
        "FOR #tempIndex := 5 TO #statSendLength - 3 DO",
    ),
    "polls are not bounded": ("#statPolls >= #MAX_POLLS", "#statPolls >= 30000"),
    "retries are not bounded": ("#statRetries < #MAX_RETRIES", "#statRetries < 30000"),
    "the first write is not preceded by a read": ("#statCurrent := #statSync;", ";"),
    "the reference of the reply is not looked at": ("= #statReferenceLow THEN", "<> B#16#00 THEN"),
    "the checksum is not looked at": ("IF #tempSum = WORD_TO_INT(", "IF #tempSum <> -1 OR #tempSum = WORD_TO_INT("),
    "the sender is not looked at": ("AND #statReceive[#tempFirst + 1] = #statAddress THEN", "THEN"),
    "pads are forgotten": ("#tempAt := #tempAt + #tempSize MOD 2;", "#tempAt := #tempAt;"),
    "a failed item keeps its place": ("#tempAt := #tempAt + 4;", "#tempAt := #tempAt + 4 + #tempSize;"),
    "item errors are swallowed": ("#tempResult := #STATUS_ITEM_ERROR;", "#tempResult := #STATUS_DONE;"),
    "the end is not looked at": ("IF #tempAt <> #tempEnd THEN", "IF FALSE THEN"),
    "the last job wins": ("#tempJob := #statJob + #tempIndex;", "#tempJob := #tempIndex;"),
    "no timeout": ("IF #tempElapsed >= #tempTimeout THEN", "IF FALSE THEN"),
    "errors of the job before stay": ("          #allErrors[#tempIndex] := W#16#0000;", "          ;"),
    "an input goes to the wrong byte": (
        "WORD_TO_BYTE(SHR(IN := #statWriteVw200, N := 8))",
        "WORD_TO_BYTE(#statWriteVw200)",
    ),
    "an old E5 counts behind garbage": ("#tempByte = B#16#E5 AND #tempClean", "#tempByte = B#16#E5"),
    "the destination is not looked at": ("IF #statReceive[#tempFirst] = #OWN_ADDRESS AND ", "IF "),
    "the end byte is not looked at": (" AND #statReceive[#tempFirst + #tempCount + 1] = B#16#16 THEN", " THEN"),
    "the repeated length is not looked at": (
        "IF #statReceive[#tempPosition + 2] <> #statReceive[#tempPosition + 1] OR ",
        "IF ",
    ),
    "the wires are those of RS232": ("MODE := 4", "MODE := 0"),
    "the port is set for every job": ("#statConfigured := TRUE;", "#statConfigured := FALSE;"),
    "the port keeps its settings behind a failure": ("#statConfigured := FALSE;", ";"),
    "a retentive instance does not see a restart": (
        "telegram.pduReference = W#16#0000;",
        "telegram.pduReference = W#16#FFFF;",
    ),
    "a retentive instance keeps the settings over a restart": ("#statConfigured := FALSE;  // the", ";  // the"),
    "a retentive instance goes on with a job": ("    #statPhase[#tempIndex] := #PHASE_IDLE;", "    ;"),
    "a block of the module begins in the call after a restart": ("#statReq := FALSE;\n  #statEnded", "#statEnded"),
    "a restart in a read that tells the frame count bit": (
        '#tempRestart := "MQSync_Request".telegram.pduReference = W#16#0000;',
        ";",
    ),
    "REQ stays over a restart": ("#statEnded := TRUE;  // no", ";  // no"),
    "an input is read when the telegram is built": (
        "WORD_TO_BYTE(SHR(IN := #statWriteVw200, N := 8))",
        "WORD_TO_BYTE(SHR(IN := #writeVw200, N := 8))",
    ),
    "nothing ends a message": ("#statConditions.END.ENDCOND := 16#000C;", "#statConditions.END.ENDCOND := 16#0001;"),
    "a reply that broke off is not joined": ("#statKept := #statKept + 1;", "#statKept := 0;"),
    "a damaged E5 is not followed by a poll": ("#statHeard := #statHeard OR NOT #tempClean;", ";"),
    "no pause before the next poll": ("#statPause := #POLL_PAUSE;", "#statPause := L#60000;"),
    "a pause ends a call late": ("#tempElapsed >= #statPause", "#tempElapsed > #statPause"),
    "a token alone is damage": ("#tempPosition + 3 <= #tempLength", "#tempPosition + 3 < #tempLength"),
    "half a token is one": ("#tempPosition + 3 <= #tempLength", "#tempPosition - 3 <= #tempLength"),
    "short answers count as those of others": ("#tempMine := TRUE;", "#tempMine := FALSE;"),
    "errors of the receiving block are those of sending": ("#tempFault := FALSE;  // of", ";  // of"),
    "counts overflow": ("#statDamaged < 32767", "#statDamaged <= 32767"),
    "replies of high priority are passed over": ("#tempByte = B#16#0A", "#tempByte = B#16#0B"),
    "acknowledgements refuse nothing": (" OR #statReceive[#tempFirst + 4] = B#16#02", ""),
    "another protocol is taken": ("#statReceive[#tempFirst + 3] = B#16#32", "#statReceive[#tempFirst + 3] <> B#16#FF"),
    "a reply in three parts is not joined": ("      #statKept := 0;\n      IF", "      IF"),
    "errors stay when the reply turns out to be malformed": ("          #statErrors[#tempIndex] := W#16#0000;", ";"),
    "nobody sees the state": ("#diagnostics.state := #statState;", ";"),
    "polls are those of the job before": ("      #statPolls := 0;\n      #statFailed", "      #statFailed"),
}
CLASSIC: dict[str, tuple[str, str]] = {
    "the number of the buffer is tried once": ("#statProbe[0] <> B#16#AA", "#statProbe[0] = B#16#00"),
    "the clock loses 1 ms when it starts again": ("#CLOCK_END + 1;", "#CLOCK_END;"),
}
"""The same of a master with a CP 341."""


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> tuple[Project, Path]:
    """The small spec for S7-1500, resolved, and its files."""
    folder = tmp_path_factory.mktemp("small")
    return project_of(made("t15", folder, SMALL)), folder / "out"


@pytest.mark.parametrize("what", DAMAGE)
def test_damage_of_the_block_is_noticed(what: str, small: tuple[Project, Path], tmp_path: Path) -> None:
    """One change in the generated SCL: a run goes wrong, or a line never runs."""
    project, folder = small
    shutil.copytree(folder, tmp_path / "out")
    damage(tmp_path / "out", *DAMAGE[what])
    assert executed(Work(ProgramBench(project, tmp_path / "out"), "quick"), "m").text


def test_data_blocks_run_with_their_start_values(small: tuple[Project, Path], tmp_path: Path) -> None:
    """A command that is TRUE as it is delivered starts its job."""
    project, folder = small
    shutil.copytree(folder, tmp_path / "out")
    (control,) = (tmp_path / "out/db").glob("*Jobs.db")
    text = control.read_text("utf-8-sig")
    said = []
    for held in (text, text.replace("execute : Bool;", "execute : Bool := TRUE;", 1)):
        control.write_text(held, encoding="utf-8-sig")
        work = Work(ProgramBench(project, tmp_path / "out"), "quick")
        (procedure,) = (each for each in work.procedures[0] if each.name == "every job with the values as delivered")
        failure, _ = attempt(procedure)
        said.append("" if failure is None else failure.message)
    assert said == ["", "all starts on its own"]


@pytest.mark.parametrize("what", CLASSIC)
def test_damage_of_a_block_for_a_cp_341_is_noticed(what: str, tmp_path: Path) -> None:
    """The same for what only a CP 341 has."""
    spec = made("t3", tmp_path, SMALL)
    damage(tmp_path / "out", *CLASSIC[what])
    assert executed(Work(ProgramBench(project_of(spec), tmp_path / "out"), "quick"), "m").text


def damage(folder: Path, old: str, new: str) -> None:
    path = folder / "scl" / "MPpiMaster.scl"
    text = path.read_text("utf-8-sig")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8-sig")


def test_verify_reports_damage_at_its_job_and_line(tmp_path: Path) -> None:
    """What the executions above find is an error of verify, with a place in the source."""
    spec = made("t15", tmp_path, SMALL)
    damage(tmp_path / "out", *DAMAGE["the frame count bit stands still"])
    result = api.verify(spec, tmp_path / "out")
    failed = {c.diagnostic.code: c.diagnostic.span for c in result.checks() if c.diagnostic is not None}
    assert failed["PG620"].file.endswith("MPpiMaster.scl")
    assert failed["PG620"].line > 1


@pytest.mark.parametrize(
    ("file", "old", "new", "code"),
    [
        ("db/MAll_Request.db", "telegram.syntaxId1 := 16#10", "telegram.syntaxId1 := 16#11", "PG604"),
        ("db/MGo_Request.db", "telegram.service := 16#28", "telegram.service := 16#29", "PG604"),
        ("db/MSome_Request.db", "telegram.destination := 16#02", "telegram.destination := 16#03", "PG604"),
        ("db/MSome_Response.db", "vb100 : Byte", "vb100 : Word", "PG603"),
        ("udt/typeMSome_Request.udt", "pduReference : Word", "pduReference : Byte", "PG603"),
    ],
)
def test_damage_of_the_tables_is_noticed(file: str, old: str, new: str, code: str, tmp_path: Path) -> None:
    """Start values, types: each by its check."""
    spec = made("t15", tmp_path)
    path = tmp_path / "out" / file
    text = path.read_text("utf-8-sig")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8-sig")
    result = api.verify(spec, tmp_path / "out", faults="none")
    assert code in {c.diagnostic.code for c in result.checks() if c.diagnostic is not None}


COMPLETE = "stations: {p: {address: 2}}"
PLAUSIBLE = {
    "all jobs have a cycle": (
        "jobs: {a: {station: p, read: [VW100], cycle: 1s}, b: {station: p, read: [VW9], cycle: 1s}}"
    ),
    "one job with a cycle": "jobs: {a: {station: p, read: [VW100], cycle: 500ms}}",
    "a request of 241 bytes": "jobs: {a: {station: p, write: {'VB0[200]': null}}}",
    "one item to read, several to write": (
        "jobs: {a: {station: p, read: [VW100]}, b: {station: p, write: {VW200: null, VW300: null}}}"
    ),
    "RUN and STOP only": "jobs: {a: {station: p, run: true}, b: {station: p, stop: true}}",
    "no retries, one poll": (
        "retries: 0\n    polls: 1\n    jobs: {a: {station: p, read: [VB0, VW10]}, b: {station: p, write: {VB0: 5}}}"
    ),
    "a short timeout": "jobs: {a: {station: p, read: [VW0], timeout: 1200ms}}",
    "a short timeout and a cycle": "jobs: {a: {station: p, read: [VW0], timeout: 2s, cycle: 200ms}}",
}
"""Specs that somebody would write, and in which nothing is wrong."""


@pytest.mark.parametrize(("what", "target"), list(zip(PLAUSIBLE, ["t3", "t12"] * len(PLAUSIBLE), strict=False)))
def test_a_good_spec_passes(what: str, target: str, tmp_path: Path) -> None:
    """Nothing is reported where nothing is wrong: no failure, no statement that never runs, no traceback.

    Half of them with each of the two modules: what they ask for has little to do with it.
    """
    body = f"\n    {COMPLETE}\n    {PLAUSIBLE[what]}\n"
    assert troubles(api.verify(made(target, tmp_path, body), tmp_path / "out")) == []


def test_an_ob1_with_a_cycle_of_200_ms(tmp_path: Path) -> None:
    """The computed timeouts hold in scans of any length up to that, also with a CP 341 that takes 32 bytes a scan."""
    body = (
        f"\n    ob1_cycle: 200ms\n    {COMPLETE}\n    jobs: {{a: {{station: p, read: ['VB0[222]'], timeout: 30s}}}}\n"
    )
    assert troubles(api.verify(made("t3", tmp_path, body), tmp_path / "out")) == []


def sixty(folder: Path) -> tuple[Any, Any]:
    """Suite and runner of a job that writes 60 words far from each other."""
    words = ", ".join(f"VW{10 * number}: null" for number in range(60))
    spec = made("t12", folder, f"\n    {COMPLETE}\n    jobs: {{a: {{station: p, write: {{{words}}}}}}}\n")
    work = Work(ProgramBench(project_of(spec), folder / "out"), "quick")
    (suite,) = work.suites
    return suite, suite.runner(work.bench.program, suite.jobs[0])


def test_a_job_of_60_addresses_has_time_enough_or_may_say_that_it_has_not(tmp_path: Path) -> None:
    """60 words lie in five telegrams: when every E5 is garbage each takes four requests and a poll.

    4 x (ack timeout 250 ms + pause 50 ms) + request, poll and reply of 300 ms is 2 s: not all of it fits 10 s.
    """
    suite, runner = sixty(tmp_path)
    assert runner.try_run(suite.first()) is None
    endless = [each for each in suite.matrix(runner, 100, "quick") if "forever" in each.name]
    assert {"garbage at the request, forever", "clipped at the request, forever"} <= {each.name for each in endless}
    assert [runner.try_run(scenario) for scenario in endless] == [None] * len(endless)


def test_what_grows_with_the_square_of_a_job_is_thinned_out(tmp_path: Path) -> None:
    """Return codes and moments: all of them for a small job and on request, a bounded number for a large one.

    60 words in 5 telegrams: 10 outer items with 7 codes, 50 inner ones with one, 5 pairs. All: 60 x 7 + 5.
    """
    suite, runner = sixty(tmp_path)
    counts = {}
    for level in ("quick", "full"):
        names = [scenario.name for scenario in suite.matrix(runner, 250, level)]
        assert len(set(names)) == len(names)
        counts[level] = (
            sum(n.startswith(("item ", "first and last ")) for n in names),
            sum("dropped in scan" in n for n in names),
        )
    assert counts == {"quick": (10 * 7 + 50 + 5, 60), "full": (60 * 7 + 5, 249)}
    assert spread(2, 5, 60) == [2, 3, 4, 5]
    assert spread(2, 10, 3) == [2, 6, 10]


def test_a_line_of_the_report(tmp_path: Path) -> None:
    """What verify prints for a job."""
    result: Any = api.verify(made("t15", tmp_path), tmp_path / "out", faults="none")
    check = next(c for c in result.checks() if c.id == "telegram.MGo_Request")
    assert check.subject == "go"
    assert check.text.startswith("68 21 21 68 03 00 6C 32 01 00 00 00 00 00 14 00 00 28")
    assert check.text.endswith("(39 bytes)")


def test_no_two_lines_of_a_report_are_alike(tmp_path: Path) -> None:
    """Two masters whose station and job have one name: the report and the purposes of the tables tell them apart."""
    line = "{module: cm1241, port: %d, stations: {p: {address: 2}}, jobs: {level: {station: p, write: {VB100: null}}}}"
    spec = tmp_path / "spec.yaml"
    head = "plc: {name: t, family: s7-1200, toolchain: tia-v19}\nppi:\n"
    spec.write_text(f"{head}  north: {line % 270}\n  south: {line % 271}\n", "utf-8")
    assert api.generate(spec, tmp_path / "out").ok
    result = api.verify(spec, tmp_path / "out", faults="none")
    for group in result.groups:
        named = [check.subject for check in group.checks if check.subject != "sources"]
        assert len(named) == len(set(named)), named
    assert {"run north.level", "run south.level"} <= {check.subject for check in result.checks()}
    purposes = [text for _, text in buffers(project_of(spec).plan(PpiPlan))]
    assert len(purposes) == len(set(purposes)), purposes


ORDINARY = {
    "languages": (
        "plc: {name: a, family: s7-1200, toolchain: tia-v19, languages: [de-DE, en-US]}\n"
        "ppi: {line: {module: cm1241, port: 270, stations: {pump: {address: 2, comment: plain}}, "
        "jobs: {level: {station: pump, read: [VW100], comment: {de-DE: F (m), en-US: level}}}}}\n"
    ),
    "a cycle with a flag": (
        "plc: {name: a, family: s7-300, toolchain: step7-v5}\n"
        "ppi: {line: {module: cp341, address: 256, stations: {pump: {address: 2}}, "
        "jobs: {r: {station: pump, read: [VW100], cycle: 1s, trigger: M10.0}, "
        "s: {station: pump, read: [VW102], cycle: 1s}}}}\n"
    ),
    "two masters of two speeds, with jobs that are called alike and have flags": (
        "plc: {name: t, family: s7-300, toolchain: step7-v5}\n"
        "ppi:\n"
        "  a: {module: cp341, address: 256, stations: {s: {address: 2}}, "
        "jobs: {r: {station: s, read: [VW100], trigger: M10.0}}}\n"
        "  b: {module: cp341, address: 272, baud: 19200, stations: {s: {address: 2}}, "
        "jobs: {r: {station: s, read: [VW100], trigger: M20.0}}}\n"
    ),
    "one poll, pauses that end in the next scan, timeouts that wait in turn, a title with marks": (
        "plc: {name: t, family: s7-300, toolchain: step7-v5}\n"
        "ppi: {a: {module: cp341, address: 256, polls: 1, poll_pause: 1ms, retry_pause: 1ms, ob1_cycle: 5ms, "
        "stations: {s: {address: 2}}, jobs: {r: {station: s, read: [VW100], timeout: 1s, comment: 'level \"left\"'}, "
        "w: {station: s, write: {VW10: null}, timeout: 2s}}}}\n"
    ),
    "no repetition, and hardly more time than an answer takes": (
        "plc: {name: t, family: s7-1200, toolchain: tia-v14}\n"
        "ppi: {a: {module: cm1241, port: 270, retries: 0, poll_pause: 1ms, ob1_cycle: 10ms, ack_timeout: 40ms, "
        "reply_timeout: 80ms, own_address: 5, stations: {s: {address: 3}}, "
        "jobs: {r: {station: s, read: [VW100, {item: VW100, as: again}], merge: false, timeout: 700ms}, "
        "w: {station: s, write: {VW10: null}, timeout: 700ms}}}}\n"
    ),
    "no repetition, and calls so short that no reply fits into a pause": (
        "plc: {name: t, family: s7-1500, toolchain: tia-v18}\n"
        "ppi: {a: {module: cm-ptp, port: 280, retries: 0, ob1_cycle: 1ms, stations: {s: {address: 2}}, "
        "jobs: {r: {station: s, read: [VW100]}}}}\n"
    ),
    "comments in letters that the sources of STEP 7 V5 do not have": (
        "plc: {name: t, family: s7-300, toolchain: step7-v5}\n"
        "drives: {d: {device: sinamics-dcm, address: 512, comment: 水位}}\n"
        "jobs: {q: {drive: d, read: [P50303], comment: 水位}}\n"
        "ppi: {a: {module: cp341, address: 256, comment: 水位, stations: {s: {address: 2}}, "
        "jobs: {r: {station: s, read: [{item: VW100, comment: 水位}], comment: 水位}}}}\n"
    ),
    "names that STEP 7 V5 shortens": (
        "plc: {name: t, family: s7-300, toolchain: step7-v5}\n"
        "ppi: {rechen_und_sandfang: {module: cp341, address: 256, stations: {rechengutwaschpresse: {address: 2}}, "
        "jobs: {fernquittierung_der_stoerungen: {station: rechengutwaschpresse, write: {M4.0: null}}}}}\n"
    ),
    "a timeout of minutes at a module that hangs": (
        "plc: {name: t, family: s7-300, toolchain: step7-v5, cpu: 312}\n"
        "ppi: {line: {module: cp341, address: 256, ob1_cycle: 150ms, stations: {s: {address: 2}}, "
        "jobs: {a: {station: s, read: [VB0], timeout: 2min}}}}\n"
    ),
    "a comment of an item that says other numbers in another language": (
        "plc: {name: t, family: s7-300, toolchain: tia-v19, languages: [fr-FR, en-US]}\n"
        "ppi: {line: {module: cp341, address: 256, stations: {s: {address: 2}}, jobs: {state: {station: s, "
        'read: [{item: C153, comment: {fr-FR: plein, en-US: "100 % of $1 & <2>"}}]}}}}\n'
    ),
    "one constant for all elements of an array": (
        "plc: {name: t, family: s7-1200, toolchain: tia-v19}\n"
        "ppi: {line: {module: cm1241, port: 270, stations: {s: {address: 2}}, "
        'jobs: {w: {station: s, write: {"VB236[20]": 0x5E}}}}}\n'
    ),
    "two jobs of several telegrams, with keys that end in digits": (
        "plc: {name: t, family: s7-1500, toolchain: tia-v18}\n"
        "ppi: {big: {module: cm-ptp, port: 280, stations: {s: {address: 2}}, "
        'jobs: {r: {station: s, read: ["VB0[300]"]}, r2: {station: s, read: ["VB1000[300]"]}}}}\n'
    ),
}


@pytest.mark.parametrize("spec", ORDINARY.values(), ids=ORDINARY)
def test_nothing_is_wrong_with_an_ordinary_spec(spec: str, tmp_path: Path) -> None:
    """Comments in another language first; a job with a cycle that waits for its flag; names that could be alike."""
    path = tmp_path / "spec.yaml"
    path.write_text(spec, "utf-8")
    assert api.generate(path).ok
    assert [str(problem) for problem in api.verify(path).problems if problem.code[:3] == "PG6"] == []
