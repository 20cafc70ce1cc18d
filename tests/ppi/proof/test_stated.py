"""Generated PPI masters against the statement of their spec: what is damaged on disk, and what was wrong once."""

from __future__ import annotations

import atexit
import re
import shutil
import tempfile
from functools import cache
from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.diagnostics import Diagnostic
from plcgen.ppi.plan.nouns import PpiPlan
from plcgen.ppi.proof.stated.times import stated_checks
from plcgen.project.opening import open_spec
from plcgen.proof.rig import ProgramBench

TANKS = """
plc: {name: Tanks, sources: per_block, family: s7-1200, toolchain: tia-v19}
ppi:
  line:
    module: cm1241
    port: 270
    stations: {first: {address: 5}, second: {address: 6}}
    jobs:
      look:
        station: first
        read: [VB10, VW20, M0.3, M0.4, T37]
        cycle: 700ms
      put:
        station: second
        write:
          VW12: null
          VD20: {type: Real, start: 12.5}
          M1.2: null
          VW30: {type: Int, value: -2}
          M1.3: null
      go: {station: first, run: true, timeout: 3s}
"""
WELLS = """
plc: {name: Wells, sources: per_block, family: s7-300, toolchain: tia-v16}
ppi:
  line:
    module: cp341
    address: 256
    stations: {well: {address: 2}}
    jobs:
      look: {station: well, read: [VW20, M0.7]}
      put: {station: well, write: {VD100: null}, trigger: {execute: M50.0, error: M50.2}}
"""


def problems(spec: Path, folder: Path) -> list[Diagnostic]:
    """What a folder does that its spec does not demand."""
    project = open_spec(spec).sound()
    program = ProgramBench(project, folder).program
    (plan,) = project.plans
    assert isinstance(plan, PpiPlan)
    return [check.diagnostic for check in stated_checks(plan, program) if check.diagnostic is not None]


@cache
def made(text: str) -> Path:
    """A folder with a spec and what is generated from it, made once."""
    folder = Path(tempfile.mkdtemp(prefix="plcgen-stated-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    (folder / "spec.yaml").write_text(text, "utf-8")
    assert api.generate(folder / "spec.yaml", folder / "out").ok
    return folder


def generated(text: str, folder: Path) -> tuple[Path, Path]:
    """Spec and folder of a text, to be damaged."""
    shutil.copytree(made(text), folder, dirs_exist_ok=True)
    return folder / "spec.yaml", folder / "out"


FB = "scl/LinePpiMaster.scl"
TANK_DAMAGE = [
    # file, what stands there, what instead; line of the spec, what is said
    (FB, "statAddress := B#16#06", "statAddress := B#16#07", 13, "station of put: the spec says 6, found 7"),
    ("db/LinePut_Request.db", "destination := 16#06", "destination := 16#05", 13, "station of put: .* 6, found 5"),
    ("db/LineLook_Request.db", "area1 := 16#84", "area1 := 16#83", 9, "data block is 1, not 0"),
    ("db/LineLook_Request.db", "bitAddress1 := 16#0050", "bitAddress1 := 16#0058", 11, r"VB10 in one item, found VB11"),
    ("db/LineGo_Request.db", "service := 16#28", "service := 16#29", 21, "neither RUN nor STOP"),
    ("db/LinePut_Request.db", "vw30 := -2", "vw30 := -3", 19, "VW30 of station 6: the spec says ff fe, found ff fd"),
    ("db/PpiJobs.db", "vd20 : Real := 12.5", "vd20 : Real := 12.0", 17, "the spec says 12.5, found 12.0"),
    (
        "db/PpiJobs.db",
        "execute : Bool := TRUE",
        "execute : Bool",
        9,
        "execute of look: the spec says True, found False",
    ),
    ("db/PpiJobs.db", "vb10 : Byte", "vb10 : Word", 11, "type of look.vb10: the spec says BYTE"),
    ("scl/Main.scl", "lookM0_4 => .*m0_4", 'lookM0_4 => "PpiJobs".look.m0_3', 11, "m0_[34] shows M0.[34]"),
    ("scl/Main.scl", "putM1_2 := .*m1_2", 'putM1_2 := "PpiJobs".put.m1_3', 18, "to M1.2 of station 6"),
    (FB, "tempTimeout := L#3000", "tempTimeout := L#2000", 21, "timeout of go: the spec says 3000 ms, found 2"),
    (FB, ">= L#700;", ">= L#800;", 9, "cycle of look: the spec says 700 ms, found 800"),
    (FB, "ACK_TIMEOUT : DInt := L#250", "ACK_TIMEOUT : DInt := L#225", 4, "the spec says 300 ms, found 27"),
    (FB, "REPLY_TIMEOUT : DInt := L#600", "REPLY_TIMEOUT : DInt := L#900", 4, "the spec says 650 ms, found 9"),
    (FB, "POLL_PAUSE : DInt := L#20", "POLL_PAUSE : DInt := L#30", 4, "from E5 to the next poll: the spec says 20 ms"),
    (FB, "MAX_POLLS : Int := 10", "MAX_POLLS : Int := 9", 4, "polls .*10, found 9"),
    (FB, "MAX_RETRIES : Int := 3", "MAX_RETRIES : Int := 2", 4, "4 times as it is, found 3 times"),
    (FB, "BAUD_CODE : UInt := 6", "BAUD_CODE : UInt := 7", 9, "16#0000, found 16#8203"),
    (FB, "CHARGAP := 35", "CHARGAP := 36", 4, "a gap of 35 bit times .* of 36"),
    (FB, "STARTCOND := 16#0002", "STARTCOND := 16#0008", 4, "says any character begins .* found not any character"),
]
WELL_DAMAGE = [
    (FB, "SF := 'S'", "SF := 'R'", 9, "SF of P_SND_RK is not 'S'"),
    (FB, "moduleAddress : Int := 256", "moduleAddress : Int := 272", 9, "found 16#82"),
    ("scl/Main.scl", "lookM0_7 => .*m0_7", 'lookM0_7 => "PpiJobs".look.busy', 9, "m0_7 shows M0.7"),
    ("scl/Main.scl", 'putExecute := "putExecute"', "putExecute := FALSE", 10, "ends, found never ends"),
]
DAMAGE = [(TANKS, *damage) for damage in TANK_DAMAGE] + [(WELLS, *damage) for damage in WELL_DAMAGE]


@pytest.mark.parametrize("damage", DAMAGE, ids=lambda damage: damage[3])
def test_damage_contradicts_the_spec(tmp_path: Path, damage: tuple[str, str, str, str, int, str]) -> None:
    """Each names the line of the spec, what it says and what was found; without it nothing is said."""
    text, file, old, new, line, said = damage
    spec, out = generated(text, tmp_path)
    before = (out / file).read_bytes().decode("utf-8")
    after, count = re.subn(old, lambda _: new, before)
    assert count == 1, f"{old} is {count} times in {file}"
    (out / file).write_bytes(after.encode("utf-8"))
    (found,) = problems(spec, out)
    assert re.search(said, found.message), found.message
    assert (found.code, found.span.file, found.span.line) == ("PG641", str(spec), line)


@pytest.mark.parametrize("text", [TANKS, WELLS], ids=["CM 1241", "CP 341"])
def test_as_generated_nothing_contradicts(tmp_path: Path, text: str) -> None:
    """The specs of the damage, as they are."""
    assert problems(*generated(text, tmp_path)) == []


def test_verify_says_it_with_a_code(tmp_path: Path) -> None:
    """PG641 at the line of the spec, in a check of its own."""
    spec, out = generated(TANKS, tmp_path)
    main = out / "scl" / "Main.scl"
    main.write_bytes(main.read_bytes().replace(b".look.m0_4", b".look.m0_3"))
    result = api.verify(spec, out, faults="none")
    (check,) = (check for check in result.checks() if check.id == "spec.ppi.line")
    assert check.diagnostic is not None
    assert (check.diagnostic.code, check.diagnostic.span.line) == ("PG641", 11)


ODD = {
    "ack_timeout longer than reply_timeout": TANKS.replace("port: 270", "port: 270\n    ack_timeout: 2s"),
    "characters without a start value": TANKS.replace("M1.2: null", '"VB50[3]": {type: Char}'),
    "a character without a start value": TANKS.replace("M1.2: null", "VB60: {type: Char}"),
    "every signal a flag": WELLS.replace(
        "read: [VW20, M0.7]",
        "run: true, trigger: {execute: M60.0, busy: M60.1, done: M60.2, error: M60.3, status: MW62}",
    ),
    "nothing in the control DB": re.sub(
        "    jobs:.*",
        "    jobs: {go: {station: well, run: true, trigger: "
        "{execute: M60.0, busy: M60.1, done: M60.2, error: M60.3, status: MW62}}}",
        WELLS,
        flags=re.DOTALL,
    ),
    "without documents": WELLS.replace("tia-v16", "tia-v13sp1"),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", ODD)
def test_what_was_red_or_wrong(tmp_path: Path, name: str) -> None:
    """Specs whose files were wrong, or right and called wrong; the CP's buffer has its number from IMPORT.md."""
    spec, out = generated(ODD[name], tmp_path)
    assert problems(spec, out) == []
    result = api.verify(spec, out, faults="none")
    assert [str(problem) for problem in result.problems if problem.severity.label == "error"] == []
