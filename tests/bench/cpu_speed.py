"""Speed of the soft CPU: statements on byte memory, idle scans of a generated job FB, time to compile it.

Run: ``python tests/bench/cpu_speed.py``. Budgets: 3 M statements/s, 0.5 M idle scans/s, 5 ms per job FB.
"""

from __future__ import annotations

import importlib.util
import re
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from plcgen import api
from plcgen.s7.cpu.compiler.block import compile_block
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.sources import load_folder
from plcgen.s7.scl.dialect import Dialect

ROOT = Path(__file__).resolve().parents[2]
SPECS = {
    "TIA S7-300": (ROOT / "specs/s7-300_6ra80_dp_tia.yaml", Dialect.TIA_300_400, "ReadRampUp"),
    "STEP 7 V5": (ROOT / "specs/s7-300_mm440_dp.yaml", Dialect.STEP7_V5, "ReadParams"),
    "TIA S7-1500": (None, Dialect.TIA_1200_1500, "ReadRampUp"),
}
SPEC_1500 = """plc: {name: BENCH, family: s7-1500, toolchain: tia-v16}
drives: {g120: {device: sinamics-g120, hardware_id: 271}}
jobs: {read_ramp_up: {drive: g120, read: [P1120]}}
"""
STATEMENTS = """FUNCTION_BLOCK "Load"
{ S7_Optimized_Access := 'FALSE' }
VAR
  a : Int; b : Int; w : Word; d : DInt; f : Bool; g : Bool; x : Array[0..9] of Int; r : DInt;
END_VAR
VAR_TEMP i : Int; END_VAR
BEGIN
FOR #i := 0 TO 9999 DO
  #a := #a + 3;
  #b := #a - #i;
  #w := INT_TO_WORD(#b) AND W#16#0FFF;
  #f := #b > 100;
  #g := #f AND NOT #g;
  #x[3] := #b;
  #d := #d + 7;
  #r := #d - 1;
END_FOR;
END_FUNCTION_BLOCK
DATA_BLOCK "Load_DB"
{ S7_Optimized_Access := 'FALSE' }
"Load"
BEGIN
END_DATA_BLOCK
"""
STATEMENTS_PER_CALL = 10_000 * 9


def best(run: Callable[[], None], repeat: int = 9) -> float:
    """Shortest of several runs, in seconds of processor time: other jobs on the machine count little."""
    times = []
    for _ in range(repeat):
        began = time.process_time()
        run()
        times.append(time.process_time() - began)
    return min(times)


def statements() -> float:
    """Executed statements per second; every variable but the counter lies in instance memory."""
    cpu = Cpu(Program.load([("load.scl", STATEMENTS)], Dialect.TIA_1200_1500))
    rate = STATEMENTS_PER_CALL / best(lambda: cpu.call("Load_DB"))
    return 0.0 if cpu.misuses else rate


def own_instance(folder: Path, dialect: Dialect, name: str) -> tuple[str, str]:
    """A source with an instance of a job FB alone, and a caller that connects it to its unit once."""
    v5 = dialect is Dialect.STEP7_V5
    (source,) = folder.glob("*.scl")
    text = source.read_bytes().decode("cp1252" if v5 else "utf-8-sig")
    places = re.search(rf"\b{name[0].lower()}{name[1:]}\(.*?(unit := [\w\".]+, diagnosis := [\w\".]+)", text, re.DOTALL)
    assert places is not None
    access = "" if v5 else "{ S7_Optimized_Access := 'FALSE' }\n"
    call = f'"{name}"."Bench_DB"' if v5 else '"Bench_DB"'
    block = f'DATA_BLOCK "Bench_DB"\n{access}"{name}"\nBEGIN\nEND_DATA_BLOCK\n'
    block += f'FUNCTION "Bench" : VOID\n{access}BEGIN\n{call}({places[1]});\nEND_FUNCTION\n'
    return "bench.scl", block


def job(folder: Path, dialect: Dialect, name: str) -> tuple[float, float, int]:
    """Idle scans per second, milliseconds to compile, statements per idle scan."""
    more = [own_instance(folder, dialect, name)]
    program = load_folder(folder, dialect, more=more)
    cpu = Cpu(program)
    cpu.call("Bench")
    entry = program.link.blocks[name.upper()]
    function, memory = cpu.function(name), cpu.db("Bench_DB")

    def idle() -> None:
        for _ in range(10_000):
            function(memory)

    scans = 10_000 / best(idle)

    def compile_it() -> None:
        for _ in range(5):
            compile_block(entry, program.link)

    milliseconds = best(compile_it) / 5 * 1000
    counted = Cpu(load_folder(folder, dialect, coverage=True, more=more))
    counted.call("Bench")
    before = sum(counted.coverage)
    counted.function(name)(counted.db("Bench_DB"))
    return scans, milliseconds, sum(counted.coverage) - before


def plain() -> float:
    """Passes per second of a plain Python loop: how fast this machine is right now."""

    def loop() -> None:
        total = 0
        for number in range(200_000):
            total += number & 7

    return 200_000 / best(loop)


def main() -> None:
    """Print the numbers."""
    print(f"plain Python loop           {plain() / 1e6:6.2f} M/s    for comparison")
    print(f"statements on byte memory   {statements() / 1e6:6.2f} M/s    budget 3.00")
    with tempfile.TemporaryDirectory() as scratch:
        for label, (spec, dialect, name) in SPECS.items():
            folder = Path(scratch) / label
            source = spec or Path(scratch) / "bench.yaml"
            if spec is None:
                source.write_text(SPEC_1500, "utf-8")
            api.generate(source, folder)
            scans, milliseconds, count = job(folder, dialect, name)
            print(f"idle scans, {label:<14}  {scans / 1e6:6.2f} M/s    budget 0.50    ({count} counted per scan)")
            print(f"compile,    {label:<14}  {milliseconds:6.2f} ms     budget 5.00")
    found = importlib.util.find_spec("awlsim")
    print(f"awlsim for comparison       {'installed' if found else 'not installed'}")


if __name__ == "__main__":
    main()
