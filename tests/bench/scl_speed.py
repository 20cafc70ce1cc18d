"""The SCL front end and the soft CPU beside two peers: lark parses the same text, awlsim runs the same loop in STL.

Both are optional: without ``lark`` or ``awlsim`` (PyPI) their columns say "not installed". lark builds a plain
parse tree from a small grammar without types or dialects, our parser the tree that the compiler works on.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from plcgen import api
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.parser import parse
from tests.bench import cpu_speed
from tests.projects import per_block

ROOT = Path(__file__).resolve().parents[2]
COPIES = 4
PASSES, STATEMENTS_PER_PASS = 10_000, 9
ROUNDS = 5
CYCLE_LIMIT = 60.0
"""Seconds a cycle of awlsim may take: its own limit of one second is too short on a busy machine."""
BUDGETS = {"parse": 80_000, "statements": 3e6, "idle": 0.5e6, "compile": 5.0}

GRAMMAR = r"""
start: block+
block: "FUNCTION_BLOCK" QUOTED header* section* "BEGIN" statement* "END_FUNCTION_BLOCK"
header: TITLE | attributes | NAME ":" (NAME | NUMBER)
attributes: "{" NAME ":=" STRING (";" NAME ":=" STRING)* "}"
section: SECTION declaration* "END_VAR"
declaration: NAME attributes? ["AT" NAME] ":" type [":=" expression] ";"
type: NAME | QUOTED | "Array" "[" expression ".." expression "]" "of" type
?statement: ";" | place ":=" expression ";" -> assign | place call ";" -> invoke | "EXIT" ";" | if | case | for
    | REGION | END_REGION
if: "IF" expression "THEN" statement* elsif* ["ELSE" statement*] "END_IF" ";"
elsif: "ELSIF" expression "THEN" statement*
case: "CASE" expression "OF" (label | statement)+ ["ELSE" statement*] "END_CASE" ";"
label: value ("," value)* ":"
value: place | NUMBER | NUMBER ".." NUMBER
for: "FOR" place ":=" expression "TO" expression ["BY" expression] "DO" statement* "END_FOR" ";"
call: "(" [argument ("," argument)*] ")"
argument: NAME ":=" expression | NAME ARROW place | expression
?expression: conjunction | expression ("OR" | "XOR") conjunction -> either
?conjunction: comparison | conjunction "AND" comparison -> both
?comparison: sum | comparison COMPARE sum -> compare
?sum: product | sum SIGN product -> add
?product: unary | product ("*" | "/" | "MOD" | "DIV") unary -> multiply
?unary: primary | "NOT" unary -> negation | SIGN unary -> sign
?primary: NUMBER | TYPED | STRING | place | place call -> result | "(" expression ")"
    | "[" expression ("," expression)* "]" -> list
place: (LOCAL | QUOTED | NAME) ("." (NAME | QUOTED) | "[" expression ("," expression)* "]")*
TITLE.2: /TITLE = [^\n]*/
REGION.2: /REGION [^\n]*/
END_REGION: "END_REGION"
SECTION.2: /VAR(_INPUT|_OUTPUT|_IN_OUT|_TEMP)?( CONSTANT)?(?=\s)/
COMPARE: "<=" | ">=" | "<>" | "<" | ">" | "="
ARROW.2: "=>"
SIGN: "+" | "-"
TYPED.2: /[A-Za-z]+#[0-9A-Za-z_#.]+|16#[0-9A-Fa-f_]+/
NUMBER: /[0-9]+(\.[0-9]+([eE][+-]?[0-9]+)?)?/
STRING: /'[^']*'/
QUOTED: /"[^"]*"/
LOCAL: /#[A-Za-z_]\w*/
NAME: /[A-Za-z_]\w*/
%ignore /\s+/
%ignore /\/\/[^\n]*/
"""
"""Enough SCL for the job FBs of the S7-1200/1500."""

LOOP = """ORGANIZATION_BLOCK OB 1
BEGIN
\tL 0
\tT MW 30
next:\tL MW 0
\tL 3
\t+I
\tT MW 0
\tL MW 30
\t-I
\tT MW 2
\tL W#16#0FFF
\tAW
\tT MW 4
\tL MW 2
\tL 100
\t>I
\t= M 6.0
\tA M 6.0
\tAN M 6.1
\t= M 6.1
\tL MW 2
\tT MW 16
\tL MD 20
\tL L#7
\t+D
\tT MD 20
\tL L#1
\t-D
\tT MD 24
\tL MW 30
\t+ 1
\tT MW 30
\tL 9999
\t<=I
\tJC next
END_ORGANIZATION_BLOCK
"""
"""The loop of ``cpu_speed.STATEMENTS`` in STL, with what stands in the accumulator used again."""

IDLE_SCL = """FUNCTION_BLOCK "Idle"
{ S7_Optimized_Access := 'FALSE' }
VAR
  execute : Bool; old : Bool; trigger : Bool; busy : Bool; done : Bool; error : Bool; state : Int; status : Word;
END_VAR
BEGIN
#trigger := #execute AND NOT #old;
#old := #execute;
IF #state <> 0 THEN
  #status := W#16#7002;
ELSIF #trigger THEN
  #state := 1;
ELSIF NOT #execute THEN
  #done := FALSE;
  #error := FALSE;
  #status := W#16#7000;
END_IF;
#busy := #state <> 0;
END_FUNCTION_BLOCK
DATA_BLOCK "Idle_DB"
{ S7_Optimized_Access := 'FALSE' }
"Idle"
BEGIN
END_DATA_BLOCK
ORGANIZATION_BLOCK "Main"
{ S7_Optimized_Access := 'FALSE' }
BEGIN
"Idle_DB"();
END_ORGANIZATION_BLOCK
"""
IDLE_STL = """ORGANIZATION_BLOCK OB 1
BEGIN
\tA M 0.0
\tAN M 0.1
\t= M 0.2
\tA M 0.0
\t= M 0.1
\tL MW 2
\tL 0
\t<>I
\tJC run
\tA M 0.2
\tJC strt
\tA M 0.0
\tJC out
\tR M 0.4
\tR M 0.5
\tL W#16#7000
\tT MW 4
\tJU out
strt:\tL 1
\tT MW 2
\tJU out
run:\tL W#16#7002
\tT MW 4
out:\tL MW 2
\tL 0
\t<>I
\t= M 0.3
END_ORGANIZATION_BLOCK
"""
"""The waiting half of a job's handshake, called by OB1 in SCL, written into OB1 in STL."""


def installed(name: str) -> bool:
    """Whether a peer is importable."""
    return find_spec(name) is not None


def alternate(*runs: Callable[[], object] | None) -> list[float]:
    """Shortest processor time of each run in seconds, in turns A B A B; infinite for None."""
    times = [float("inf")] * len(runs)
    for _ in range(ROUNDS):
        for position, run in enumerate(runs):
            if run is not None:
                began = time.process_time()
                run()
                times[position] = min(times[position], time.process_time() - began)
    return times


def source() -> str:
    """Generated job FBs of an S7-1500, several times over."""
    with tempfile.TemporaryDirectory() as scratch:
        spec = Path(scratch) / "bench.yaml"
        spec.write_text(per_block((ROOT / "specs/s7-1500_g120_pn.yaml").read_text("utf-8")), "utf-8")
        api.generate(spec, Path(scratch) / "out")
        files = sorted((Path(scratch) / "out/scl").glob("*.scl"))
        texts = [path.read_text("utf-8-sig") for path in files if path.stem != "Main"]
    return "".join(texts) * COPIES


def parsing() -> tuple[int, float, float]:
    """Lines of the text, lines per second of ours and of lark (LALR, contextual lexer; 0 without it)."""
    text = source()
    lines = text.count("\n")
    assert not parse(text, "bench.scl").diagnostics
    theirs: Callable[[], object] | None = None
    if installed("lark"):
        import lark

        parser = lark.Lark(GRAMMAR, parser="lalr")
        theirs = lambda: parser.parse(text)  # noqa: E731 - one expression for the stop-watch
    seconds = alternate(lambda: parse(text, "bench.scl"), theirs)
    return lines, lines / seconds[0], lines / seconds[1]


def stl(text: str) -> Any:
    """A CPU of awlsim that is ready to run; the caller knows that it is installed."""
    machine = import_module("awlsim.core.main").AwlSim()  # first: its modules import each other in a circle
    machine.getCPU().setCycleTimeLimit(CYCLE_LIMIT)
    parser = import_module("awlsim.awlcompiler").AwlParser()
    source_of = import_module("awlsim.common.sources").AwlSource
    parser.parseSource(source_of(name="bench", sourceBytes=text.encode()))
    machine.load(parser.getParseTree())
    machine.startup()
    machine.runCycle()
    return machine


def loop() -> tuple[float, float]:
    """Statements per second of ours and of awlsim, in statements of the SCL text."""
    cpu = Cpu(Program.load([("load.scl", cpu_speed.STATEMENTS)], Dialect.TIA_1200_1500))
    machine = stl(LOOP) if installed("awlsim") else None
    if machine:
        cpu.call("Load_DB")
        both = bytes(machine.getCPU().flags.getDataBytes())[0:2], cpu["Load_DB.a"]
        assert int.from_bytes(both[0]) == both[1], both
    seconds = alternate(lambda: cpu.call("Load_DB"), machine.runCycle if machine else None)
    count = PASSES * STATEMENTS_PER_PASS
    return count / seconds[0], count / seconds[1]


def idle(scans: int = 5000) -> tuple[float, float]:
    """Whole idle scans per second, OB1 and all: of ours and of awlsim."""
    cpu = Cpu(Program.load([("idle.scl", IDLE_SCL)], Dialect.TIA_1200_1500))
    cycle: Any = stl(IDLE_STL).runCycle if installed("awlsim") else None

    def cycles() -> None:
        for _ in range(scans if cycle else 0):
            cycle()

    seconds = alternate(lambda: cpu.scan(10, scans), cycles if cycle else None)
    return scans / seconds[0], scans / seconds[1]


def job() -> tuple[float, float]:
    """Idle scans per second of a generated job FB, and milliseconds to compile it."""
    with tempfile.TemporaryDirectory() as scratch:
        spec = Path(scratch) / "bench.yaml"
        spec.write_text(cpu_speed.SPEC_1500, "utf-8")
        api.generate(spec, Path(scratch) / "out")
        scans, milliseconds, _ = cpu_speed.job(Path(scratch) / "out", Dialect.TIA_1200_1500, "ReadRampUp")
    return scans, milliseconds


def _row(what: str, ours: float, peer: str, theirs: float, budget: float | None = None) -> None:
    """One line: our rate, the peer's, the ratio, the budget."""
    beside = f"{peer} {theirs:>9,.0f}/s   ratio {ours / theirs:5.1f}" if theirs else f"{peer} not installed"
    print(f"  {what:<26} {ours:>10,.0f}/s   {beside}" + (f"   budget {budget:,.0f}/s" if budget else ""))


def main() -> None:
    """Print the figures."""
    lines, ours, theirs = parsing()
    print("SCL: front end and soft CPU beside lark (same text) and awlsim (same loop in STL)")
    _row(f"parsed lines ({lines:,})", ours, "lark  ", theirs, BUDGETS["parse"])
    _row("statements in a loop", *_beside(loop(), "awlsim"), BUDGETS["statements"])
    _row("idle scans, OB1 and all", *_beside(idle(), "awlsim"))
    scans, milliseconds = job()
    print(f"  {'idle scans of a job FB':<26} {scans:>10,.0f}/s   budget {BUDGETS['idle']:,.0f}/s")
    print(f"  {'compile a job FB':<26} {milliseconds:>10.2f} ms   budget {BUDGETS['compile']:.0f} ms")


def _beside(rates: tuple[float, float], peer: str) -> tuple[float, str, float]:
    return rates[0], peer, rates[1]


if __name__ == "__main__":
    main()
