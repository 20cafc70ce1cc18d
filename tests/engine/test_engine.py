"""The proof of the drive engine: what it knows, what it notices, how answers are judged."""

from __future__ import annotations

import pickle
import typing
from collections.abc import Collection
from dataclasses import replace
from pathlib import Path

import pytest

import plcgen
from plcgen.base.diagnostics import DiagnosticError
from plcgen.ds47.proof.engine import engine_check, proven, prover_hash
from plcgen.ds47.proof.words import TRANSITIONS
from plcgen.project.schema import Toolchain
from plcgen.proof.checks import Outcome
from plcgen.proof.scenario import ScenarioError
from plcgen.s7.cpu.linkage import Probe
from plcgen.s7.read.generated import generated_sources
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.logic import DECIDES
from tests.engine import folders
from tests.engine.__main__ import dialect_of
from tests.engine.argued import ARGUED, argued
from tests.engine.checks import GROUPS, EngineWork, coverage_checks, run_faults
from tests.engine.errands import MATRIX, READ_ONE, READ_OPEN, READ_SPLIT, WRITE_ONE, WRITE_SPLIT
from tests.engine.field import JobField
from tests.engine.interrupts import interrupts
from tests.engine.sources import DriveEngine
from tests.engine.verdict import FOREIGN, judge

THREE = READ_SPLIT.letters[0]
REQUEST = bytes.fromhex("07 01 02 03") + bytes(18)
"""Reference 7, drive object 2, three parameters."""
REAL, BYTES, INTS = (
    bytes.fromhex("08 01 41 20 00 00"),
    bytes.fromhex("05 03 01 02 03 00"),
    bytes.fromhex("03 02 0001 0002"),
)


@pytest.fixture(scope="module")
def engines(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, str], DriveEngine]:
    """Every engine by target and size."""
    root = tmp_path_factory.mktemp("engines")
    return {
        (target, size): DriveEngine.of(generated_sources(folder), dialect_of(folder))
        for target, size, folder in folders.folders(root)
    }


@pytest.fixture(scope="module")
def works(engines: dict[tuple[str, str], DriveEngine]) -> dict[str, EngineWork]:
    """The smallest engine of each target, compiled once."""
    return {target: EngineWork(engines[target, "S"]) for target in ("t15", "t3", "v5")}


def changed(engine: DriveEngine, old: str, new: str) -> DriveEngine:
    """An engine with one piece of text replaced wherever it stands."""
    assert any(old in text for _, text in engine.sources)
    return DriveEngine(
        engine.dialect, tuple((name, text.replace(old, new)) for name, text in engine.sources), engine.names
    )


@pytest.mark.slow
def test_the_file_knows_exactly_the_engines_there_are(engines: dict[tuple[str, str], DriveEngine]) -> None:
    """Whoever changes a template of the engine runs ``make engine``: everything is proven again and recorded."""
    assert {engine.hash for engine in engines.values()} == set(proven())


@pytest.mark.slow
@pytest.mark.parametrize("family", ["s7-300", "s7-400", "s7-1200", "s7-1500"])
def test_every_tool_has_a_proven_engine(family: str, tmp_path: Path) -> None:
    """Whatever version a spec names: an engine that is not on record is an error of verify."""
    modern = family in {"s7-1200", "s7-1500"}
    for toolchain in typing.get_args(Toolchain):
        if modern and toolchain == "step7-v5":
            continue
        spec, out = tmp_path / f"{toolchain}.yaml", tmp_path / toolchain
        spec.write_text(
            f"plc: {{name: P, family: {family}, toolchain: {toolchain}}}\n"
            f"drives: {{one: {{device: sinamics-g120, {'hardware_id' if modern else 'address'}: 270}}}}\n"
            "jobs: {get: {drive: one, read: [P1121]}}\n"
        )
        assert plcgen.generate(spec, out).ok
        assert DriveEngine.of(generated_sources(out), dialect_of(out)).hash in proven(), toolchain


@pytest.mark.slow
def test_the_sizes_of_an_engine_are_all_that_differs_in_a_target(engines: dict[tuple[str, str], DriveEngine]) -> None:
    for (target, size), engine in engines.items():
        assert engine.differs_in_sizes_only(engines[target, "S"]), (target, size)
    assert not engines["t3", "S"].differs_in_sizes_only(engines["t15", "S"])
    other = changed(engines["t15", "M"], "L#5000", "L#5001")
    assert not other.differs_in_sizes_only(engines["t15", "S"])


@pytest.mark.slow
def test_sizes(engines: dict[tuple[str, str], DriveEngine]) -> None:
    sizes = [engines["v5", size].sizes for size in ("S", "M", "L", "XL")]
    assert [(s.last + 1, s.blocks, s.slots, s.channels) for s in sizes] == [
        (40, 4, 4, 32),
        (96, 15, 8, 32),
        (240, 39, 16, 128),
        (240, 39, 64, 512),
    ]


@pytest.mark.slow
def test_what_counts_for_the_hash(engines: dict[tuple[str, str], DriveEngine]) -> None:
    """Comments, titles and versions of library blocks do not; a constant, a start value and the target do."""
    engine = engines["t15", "S"]
    assert changed(engine, "// the ", "// Das ").hash == engine.hash
    assert changed(engine, "TITLE = ", "TITLE = Antrieb ").hash == engine.hash
    assert changed(engine, "LibVersion := '1.0'", "LibVersion := '2.1'").hash == engine.hash
    names = {role: name.replace("Drive", "Motor") for role, name in engine.names.items()}
    renamed = tuple(
        (name, text.replace('"Drive', '"Motor').replace('"typeDrive', '"typeMotor')) for name, text in engine.sources
    )
    assert DriveEngine(engine.dialect, renamed, names).hash == engine.hash
    assert changed(engine, "L#5000", "L#5001").hash != engine.hash
    assert changed(engine, "L#10000", "L#10001").hash != engine.hash
    assert DriveEngine(Dialect.TIA_300_400, engine.sources, engine.names).hash != engine.hash
    assert len({each.hash for each in engines.values()}) == 12


@pytest.mark.slow
def test_a_known_engine_is_not_run_here(
    engines: dict[tuple[str, str], DriveEngine], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The report says whose checks it were, why others than those of this copy do, and that nothing is to be done."""
    engine, here = engines["t3", "S"], prover_hash()
    earlier = f"earlier checks (ffffffffffff, now {here[:12]}); the text is the same"
    for prover, whose in ((here, "the checks of this copy"), ("f" * 64, earlier)):
        entry = {"release": "9.9.9", "scenarios": 1234, "prover": prover}
        known = {engine.hash: entry}
        monkeypatch.setattr("plcgen.ds47.proof.engine.proven", lambda known=known: known)
        check = engine_check(engine)
        assert check.outcome is Outcome.NOT_RUN
        name = f"engine {engine.hash[:12]}"
        assert check.verdict == f"{name}: proven with release 9.9.9 by {whose}; not repeated here, nothing to do"


@pytest.mark.slow
def test_an_engine_that_nobody_has_proven_is_an_error(engines: dict[tuple[str, str], DriveEngine]) -> None:
    """One number of the text is another one: the report names the file."""
    check = engine_check(changed(engines["t15", "S"], "L#5000", "L#5001"))
    assert (check.outcome, check.diagnostic.code if check.diagnostic else "") == (Outcome.ERROR, "PG621")
    assert check.diagnostic
    assert check.diagnostic.span.file in {name for name, _ in engines["t15", "S"].sources}


def test_the_prover_is_known_by_its_code(tmp_path: Path) -> None:
    """Every line of the soft CPU, the simulated drive and the scenarios counts; line ends and other rooms do not."""
    for name in ("s7/cpu/cpu.py", "ds47/sim/drive.py", "cli/main.py"):
        (tmp_path / name).parent.mkdir(parents=True)
        (tmp_path / name).write_bytes(b"one\ntwo\n")
    first = prover_hash(tmp_path)
    for name, data, same in (
        ("s7/cpu/cpu.py", b"one\r\ntwo\r\n", True),
        ("cli/main.py", b"three\n", True),
        ("ds47/sim/drive.py", b"one\nthree\n", False),
    ):
        (tmp_path / name).write_bytes(data)
        prover_hash.cache_clear()
        assert (prover_hash(tmp_path) == first) is same, name


def test_a_folder_without_an_engine() -> None:
    with pytest.raises(DiagnosticError) as caught:
        DriveEngine.of([], Dialect.STEP7_V5)
    (found,) = caught.value.diagnostics
    assert found.code == "PG825"
    assert "DriveChannel" in found.message


@pytest.mark.slow
def test_an_engine_travels_to_a_worker(engines: dict[tuple[str, str], DriveEngine]) -> None:
    work = EngineWork(engines["v5", "S"])
    again = pickle.loads(pickle.dumps(work))  # noqa: S301 - our own
    assert [piece.name for piece in again.pieces] == [piece.name for piece in work.pieces]


# --- what is noticed ------------------------------------------------------------------------------------------

DEFECTS = {
    "an error block is read beyond the record": (
        "t15",
        "(NOT #tempNegative OR #tempCount < 1 OR #tempCount > 2)",
        "(NOT #tempNegative OR #tempCount > 2)",
        READ_SPLIT,
    ),
    "a call that outlives its job is not called any more": (
        "t3",
        "IF #statState <> #STATE_IDLE OR #tempActive THEN",
        "IF #statState <> #STATE_IDLE THEN",
        READ_ONE,
    ),
    "the first retries come late": (
        "t15",
        "0: #statPause := 0; 1: #statPause := 20;",
        "0: #statPause := 200;",
        READ_ONE,
    ),
    "a short pause is longer than the pause of the job": (
        "t15",
        "MIN(IN1 := #statPause, IN2 := #statOrder.pause)",
        "#statPause",
        READ_ONE,
    ),
    "retries are counted by number": (
        "t15",
        "#statPaused / #statOrder.pause >= INT_TO_DINT(#statOrder.retries)",
        "#statRetries >= #statOrder.retries",
        READ_ONE,
    ),
    "the next job waits for a call that outlives its job": (
        "t15",
        "#unit.turn.status := #STATUS_STILL_DRAINING;",
        "#tempResult := #STATUS_STILL_DRAINING;",
        READ_ONE,
    ),
    "infos of an answer that cannot be trusted stay": (
        "t15",
        "#unit.errors[#tempBlock] := W#16#FFFF; #unit.infos[#tempBlock] := W#16#0000; END_FOR;",
        "#unit.errors[#tempBlock] := W#16#FFFF; END_FOR;",
        READ_SPLIT,
    ),
    "41 00 is taken for a good answer to a change": ("t15", "(#tempSize > 0 AND ", "(", WRITE_SPLIT),
    "a lost request is never sent again": (
        "t15",
        "#tempResume := #STATE_BUILD;",
        "#tempResume := #STATE_READ;",
        READ_ONE,
    ),
    "the reference becomes 0": ("t15", "#statReference MOD 255 + 1", "(#statReference + 1) MOD 256", READ_ONE),
    "the clock counts any step": ("t15", "MX := #STEP_LIMIT", "MX := L#9999", READ_ONE),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", DEFECTS)
def test_a_defect_is_noticed(engines: dict[tuple[str, str], DriveEngine], name: str) -> None:
    target, old, new, errand = DEFECTS[name]
    engine = changed(engines[target, "S"], old, new)
    assert run_faults(engine, errand, most=1).failures, name


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["Write", "Read"])
def test_req_falls_between_two_jobs(engines: dict[tuple[str, str], DriveEngine], kind: str) -> None:
    """Where a level of REQ starts a job nobody notices that it does not; where an edge does, every other job fails."""
    engine = changed(engines["t15", "S"], f" OR #stat{kind}Req THEN", " THEN")
    assert run_faults(engine, READ_ONE, most=1, on_edge=True).failures
    assert not run_faults(engine, READ_ONE, most=1).failures


MISSING = {
    "a job that is gone keeps the unit": (
        "t15",
        "IF #tempGone THEN\n      #tempResult := #STATUS_LOST;",
        "IF #tempGone THEN\n      ;",
        "a job is not called any more, no answer comes",
    ),
    "done of the job before stays": (
        "t15",
        "#done := FALSE; #error := FALSE;\n  #status := #STATUS_STARTED;",
        "#error := FALSE;\n  #status := #STATUS_STARTED;",
        "execute comes again with the end",
    ),
    "an idle gate looks for someone who waits": ("v5", "tempWaiting := FALSE;", ";", "nobody asks for a place"),
    "an ANY without its syntax ID": (
        "v5",
        "tempOtherPointer.id := B#16#10;",
        ";",
        "telegrams in data blocks of their own",
    ),
    "what WRREC says of garbage counts": ("v5", "tempCode := 0;", ";", WRITE_ONE.key),
    "an order whose number is below that of its slot is not ended": (
        "t15",
        "DINT_TO_INT(#tempGrant / 100000)",
        "DINT_TO_INT(#tempGrant / 100001)",
        "channel loaded after scan 4 of the first job of the last slot",
    ),
    "time passes although the clock stands still": ("t3", "LIMIT(MN := L#0,", "LIMIT(MN := L#1,", "scans of 0 ms"),
    "a job that is gone has a millisecond less": (
        "v5",
        "statStill := 0;",
        "statStill := 1;",
        "a job is not called any more, to the millisecond",
    ),
    "the first byte of an ANY is no whole byte": (
        "v5",
        "DW#16#84000000",
        "DW#16#84000001",
        "telegrams in data blocks of their own",
    ),
    "a type of the same size is taken": (
        "v5",
        "tempCame = B#16#36 AND tempFormat = B#16#0D",
        "tempCame = B#16#36 AND tempFormat <> B#16#0D",
        "every type instead of every other of its size",
    ),
    "a place that is taken counts twice": (
        "t15",
        "ELSE\n      #tempUsed := #tempUsed + 1;",
        "ELSE\n      #tempUsed := #tempUsed + 2;",
        "2 places for three channels, called in the order (1, 2, 3, 4, 5, 8, 9)",
    ),
    "more than there is room for is taken": (
        "t15",
        "#tempSize <= #tempWanted)",
        "#tempSize <= 2 * #tempWanted)",
        "types that come from the answer",
    ),
    "no value is taken for one": (
        "t3",
        "#tempSize > 0 AND #tempSize <= #tempWanted",
        "#tempSize <= #tempWanted",
        "types that come from the answer",
    ),
    "an unknown type is taken": (
        "t15",
        "NOT #tempUnknown AND #tempCount = ",
        "#tempCount = ",
        "types that come from the answer",
    ),
    "places count beyond 30,000": ("t3", "#statAsk MOD 30000 + 1", "#statAsk MOD 30001 + 1", "counters wrap"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", MISSING)
def test_what_is_missing_is_noticed(
    engines: dict[tuple[str, str], DriveEngine], works: dict[str, EngineWork], name: str
) -> None:
    """Each by a scenario of its own."""
    target, old, new, scenario = MISSING[name]
    for work, good in ((works[target], True), (EngineWork(changed(engines[target, "S"], old, new)), False)):
        (index,) = (n for n, piece in enumerate(work.pieces) if piece.name == scenario)
        assert (not work(index).failures) is good


@pytest.mark.slow
def test_mixed_access_loses_what_an_interrupt_writes(engines: dict[tuple[str, str], DriveEngine]) -> None:
    """The copy of the unit goes back over it (FAQ 109478253); with one access setting nothing is lost."""
    name, run = next(iter(interrupts()))
    run(JobField(engines["t15", "S"], MATRIX))
    with pytest.raises(ScenarioError):
        run(JobField(replace(engines["t15", "S"], mixed=True), MATRIX))
    assert "OB35" in name


def test_what_no_run_can_show_is_a_list(works: dict[str, EngineWork]) -> None:
    """Of every operand it has decided or is in the list, never both. The page has the list."""
    engine = works["t15"].engine
    files = {file for file, _ in engine.sources}
    probes = engine.program.probes
    reasons = dict(argued(engine, [probe for probe in probes if probe.file in files]))
    assert sorted(reasons.values()) == sorted(one.why for one in ARGUED)  # one place each
    for other_target in (works["t3"].engine, works["v5"].engine):
        assert len(dict(argued(other_target, other_target.program.probes))) == len(ARGUED)

    def troubles(hidden: Collection[Probe]) -> list[str]:
        counts = [int(probe not in hidden) for probe in probes]
        return [check.id for check in coverage_checks(engine, counts, TRANSITIONS) if check.outcome is Outcome.ERROR]

    assert troubles(reasons) == []
    assert troubles([]) == ["engine.argued"] * len(ARGUED)
    other = next(
        probe for probe in probes if probe.kind == DECIDES[True] and probe.file in files and probe not in reasons
    )
    assert len(troubles([*reasons, other])) == 1
    page = Path(__file__).with_name("README.md").read_text("utf-8")
    rows = [line.split(" | ") for line in page.splitlines() if line.startswith("| `")]
    told = {(side, why.removesuffix(" |")) for _, side, why in (row for row in rows if len(row) == 3)}
    assert told >= {(one.kind.removeprefix("decides "), one.why) for one in ARGUED}
    assert [one for one in ARGUED if f"| `{one.condition}`" not in page] == []


def test_a_condition_that_reads_alike_is_not_argued(works: dict[str, EngineWork]) -> None:
    """What is argued is one whole condition of the channel, not the words that it begins with."""
    engine = works["t15"].engine
    more = changed(
        engine, "#statStill >= #LEASE OR #tempGrant = 0;", "#statStill >= #LEASE OR #tempGrant = 0 OR FALSE;"
    )
    assert len(list(argued(engine, engine.program.probes))) == len(list(argued(more, more.program.probes))) + 1


def test_some_of_every_group(works: dict[str, EngineWork]) -> None:
    """Every twelfth procedure; all of them run when an engine is recorded."""
    work = works["t15"]
    chosen = [n for n, piece in enumerate(work.pieces) if piece.errand is None][::12]
    assert {work.pieces[n].group for n in chosen} == {*GROUPS} - {"faults", "edges"}
    assert not [failure for n in chosen for failure in work(n).failures]


@pytest.mark.parametrize(
    "target", ["t15", pytest.param("t3", marks=pytest.mark.slow), pytest.param("v5", marks=pytest.mark.slow)]
)
def test_every_fault_of_a_read_is_survived(engines: dict[tuple[str, str], DriveEngine], target: str) -> None:
    result = run_faults(engines[target, "S"], READ_ONE)
    assert not result.failures
    assert int(result.matrix) > 700


# --- answers --------------------------------------------------------------------------------------------------


def answer(*blocks: bytes, head: str = "07 01 02 03") -> bytes:
    """An answer to REQUEST."""
    return bytes.fromhex(head) + b"".join(blocks)


ERROR = bytes.fromhex("44 02 00 11 00 07")
"""Error 11h with the information word 7."""


@pytest.mark.parametrize(
    ("came", "word", "errors", "infos"),
    [
        (answer(REAL, BYTES, INTS), "DONE", [0, 0, 0], [0, 0, 0]),
        (answer(REAL, b"\x41\x03" + BYTES[2:], INTS), "DONE", [0, 0, 0], [0, 0, 0]),
        (answer(REAL, ERROR, INTS, head="07 81 02 03"), "PARAMETER_ERROR", [0, 0x8011, 0], [0, 7, 0]),
        (answer(ERROR, head="07 81 02 03"), "REFUSED", [0x8011] * 3, [7] * 3),
        (answer(REAL, BYTES, b"\x06\x02" + INTS[2:]), "RESPONSE_FORMAT", [0, 0, 0x8106], [0, 0, 2]),
        (answer(REAL, BYTES, b"\x0e\x02" + INTS[2:]), "RESPONSE_FORMAT", [0, 0, 0x810E], [0, 0, 2]),
        (answer(REAL, b"\x0e\x03" + BYTES[2:], INTS), "RESPONSE_FORMAT", [0, 0x810E, 0xFFFF], [0, 3, 0]),
        (answer(REAL, BYTES, bytes.fromhex("43 02 FFFF8000 00007FFF")), "DONE", [0, 0, 0], [0, 0, 0]),
        (answer(REAL, BYTES, bytes.fromhex("43 02 00000000 00008000")), "RESPONSE_FORMAT", [0, 0, 0x8143], [0, 0, 2]),
        (answer(REAL, bytes.fromhex("42 03 0000 0001 00FF"), INTS), "DONE", [0, 0, 0], [0, 0, 0]),
        (answer(REAL, bytes.fromhex("42 03 0000 0100 0000"), INTS), "RESPONSE_FORMAT", [0, 0x8142, 0], [0, 3, 0]),
        (answer(REAL, BYTES, INTS, b"\0"), "RESPONSE_FORMAT", [0xFFFF] * 3, [0] * 3),
        (answer(REAL, BYTES), "RESPONSE_FORMAT", [0xFFFF] * 3, [0] * 3),
        (answer(REAL, BYTES, b"\x44\x00", head="07 81 02 03"), "RESPONSE_FORMAT", [0xFFFF] * 3, [0] * 3),
        (answer(REAL, BYTES, INTS, head="08 01 02 03"), FOREIGN, [0xFFFF] * 3, [0] * 3),
        (answer(REAL, BYTES, INTS, head="07 01 03 03"), FOREIGN, [0xFFFF] * 3, [0] * 3),
        (answer(REAL, BYTES, INTS, head="07 02 02 03"), "RESPONSE_ID", [0xFFFF] * 3, [0] * 3),
        (answer(REAL, BYTES, INTS, head="07 01 02 04"), "PARAMETER_COUNT", [0xFFFF] * 3, [0] * 3),
        (b"\x07\x01\x02", "RESPONSE_LENGTH", [0xFFFF] * 3, [0] * 3),
        (bytes.fromhex("07 80 02 03 44 01 00 21"), "NOT_SUPPORTED", [0xFFFF] * 3, [0] * 3),
    ],
)
def test_what_an_answer_means(came: bytes, word: str, errors: list[int], infos: list[int]) -> None:
    found = judge(THREE, REQUEST, came)
    assert (found.word, found.errors, found.infos) == (word, errors, infos)


@pytest.mark.parametrize(
    ("first", "word", "error", "info", "taken"),
    [
        ("0801 41200000", "DONE", 0, 0, True),
        ("0601 0007", "DONE", 0, 0, True),  # whatever the type is
        ("2301 8001", "DONE", 0, 0, True),
        ("0F01 3FF0000000000000", "DONE", 0, 0, True),  # 8 bytes: all there is room for
        ("0802 41200000 41200000", "RESPONSE_FORMAT", 0x8108, 2, False),
        ("4001", "RESPONSE_FORMAT", 0x8140, 1, False),
        ("4400", "RESPONSE_FORMAT", 0xFFFF, 0, False),
    ],
)
def test_what_an_answer_without_a_type_means(first: str, word: str, error: int, info: int, *, taken: bool) -> None:
    """It goes on with the second block where the first one ends."""
    block = bytes.fromhex(first)
    found = judge(READ_OPEN.letters[0], REQUEST, answer(block, BYTES, INTS))
    assert (found.word, found.errors[0], found.infos[0]) == (word, error, info)
    assert (found.taken[0] == block) is taken
    assert found.errors[1:] == [0xFFFF if error == 0xFFFF else 0] * 2
    assert [part.expectation for part in READ_OPEN.letters[0].parts] == [0x00010008, 0x00030008, 0x00020008]
    assert READ_OPEN.letters[0].blocks == [(4, 10), (14, 10), (24, 10)]


def test_a_change_has_no_values_in_its_answer() -> None:
    letter = replace(WRITE_SPLIT.letters[0])
    request = bytes.fromhex("09 02 02 03")
    assert judge(letter, request, bytes.fromhex("09 02 02 03")).word == "DONE"
    assert judge(letter, request, bytes.fromhex("09 02 02 03 00")).word == "RESPONSE_FORMAT"
    partly = bytes.fromhex("09 82 02 03 40 00 44 02 00 11 00 07 40 00")
    found = judge(letter, request, partly)
    assert (found.word, found.errors, found.failed) == ("PARAMETER_ERROR", [0, 0x8011, 0], 2)


def test_requests_are_those_of_the_tables() -> None:
    """Request of three parameters: header, 10h, number of elements, PNU, subindex; values behind them in a change."""
    values = [bytes.fromhex("41200000"), b"\1\2\3", bytes.fromhex("00010002")]
    assert THREE.request(2, values).hex(" ", 2) == "0001 0203 1001 0460 0000 1003 0461 0000 1002 0462 0000"
    change = WRITE_SPLIT.letters[0].request(2, values)
    assert change[22:].hex(" ", 2) == "0801 4120 0000 0503 0102 0300 0302 0001 0002"
    assert [part.expectation for part in THREE.parts] == [0x08010004, 0x05030003, 0x03020004]


@pytest.mark.slow
def test_folders_are_told_by_their_manifest(tmp_path: Path) -> None:
    file, out = tmp_path / "x.yaml", tmp_path / "out"
    file.write_text(folders.spec("v5", "S"), encoding="ascii")
    folders.plcgen.generate(file, out)
    assert dialect_of(out) is Dialect.STEP7_V5
