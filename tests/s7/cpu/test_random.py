"""Random programs: the compiled code against a tree walk that knows nothing of caches, wraps or addresses.

The walk keeps every variable as bytes of its own layout, so that views, branches and loops are compared too.
"""

import random
import re

import pytest

from plcgen.s7.cpu.cpu import Cpu
from tests.s7.cpu.support import load

SIZES = {"Int": 16, "DInt": 32, "UInt": 16, "SInt": 8}
NAMES = {
    "a": ("Int", 0), "b": ("Int", 2), "w": ("Word", 4), "d": ("DInt", 6), "u": ("UInt", 10), "f": ("Bool", 12),
    "g": ("Bool", 12.1), "x": ("Array", 14), "hi": ("Byte", 4), "lo": ("Byte", 5), "low": ("Int", 8), "s": ("SInt", 22),
}  # fmt: skip
VARS = """a : Int; b : Int; w : Word; wb AT w : Struct hi : Byte; lo : Byte; END_STRUCT; d : DInt;
dv AT d : Struct high : Int; low : Int; END_STRUCT; u : UInt; f : Bool; g : Bool; x : Array[0..3] of Int; s : SInt;"""
SPELLED = {"hi": "#wb.hi", "lo": "#wb.lo", "low": "#dv.low"}


def wrap(value, type_):
    """Value in the range of its type."""
    bits = {"Word": 16, "Byte": 8, **SIZES}[type_]
    value &= (1 << bits) - 1
    return value - (1 << bits) if type_ in {"Int", "DInt", "SInt"} and value >> bits - 1 else value


class Walk:
    """Source text and the meaning of it, made together."""

    def __init__(self, seed):
        self.rnd = random.Random(seed)  # reproducible programs, no secrets
        self.memory = bytearray(24)
        self.depth = 0
        self.passed = []
        """How often each statement ran; its number stands in a comment in front of it."""

    def counted(self, text, run):
        """A statement with its number."""
        number = len(self.passed)
        self.passed.append(0)

        def passing():
            self.passed[number] += 1
            return run()

        return f"(*{number}*){text}", passing

    def read(self, name, index=0):
        """Value of a variable."""
        type_, at = NAMES[name]
        if type_ == "Bool":
            return bool(self.memory[12] >> round((at - 12) * 10) & 1)
        if type_ == "Array":
            return int.from_bytes(self.memory[at + 2 * index : at + 2 * index + 2], signed=True)
        size = {"Word": 2, "Byte": 1}.get(type_) or SIZES[type_] // 8
        return int.from_bytes(self.memory[at : at + size], signed=type_ in {"Int", "DInt", "SInt"})

    def write(self, name, value, index=0):
        """Store a value of the right type."""
        type_, at = NAMES[name]
        if type_ == "Bool":
            mask = 1 << round((at - 12) * 10)
            self.memory[12] = self.memory[12] | mask if value else self.memory[12] & ~mask
        else:
            size = 2 if type_ == "Array" else {"Word": 2, "Byte": 1}.get(type_) or SIZES[type_] // 8
            self.memory[at + 2 * index : at + 2 * index + size] = (value & (1 << 8 * size) - 1).to_bytes(size)

    def number(self, type_, depth=0, *, constant=True):
        """Text and function of an expression of an integer type."""
        rnd = self.rnd
        pick = rnd.randrange(9) if depth < 4 else rnd.randrange(3)
        pick = pick if constant else max(pick, 1)
        own = [name for name, (kind, _) in NAMES.items() if kind == type_]
        if pick == 0:
            low, high = {"Int": (-300, 300), "DInt": (-70000, 70000), "UInt": (0, 300), "SInt": (-100, 100)}[type_]
            value = rnd.randint(low, high)
            return (str(value) if value >= 0 else f"({value})"), lambda: value
        if pick <= 2:
            name = rnd.choice(own)
            return SPELLED.get(name, f"#{name}"), lambda: self.read(name)
        if pick == 3 and type_ == "Int":
            index, at = self.index(depth)
            return f"#x[{index}]", lambda: self.read("x", at())
        if pick == 4 and type_ == "DInt":
            text, value = self.number("Int", depth + 1)
            return f"INT_TO_DINT({text})", value
        if pick == 5 and type_ == "Int":
            text, value = self.number("DInt", depth + 1)
            return f"DINT_TO_INT({text})", lambda: wrap(value(), "Int")
        left, a = self.number(type_, depth + 1, constant=False)
        right, b = self.number(type_, depth + 1)
        operator = rnd.choice("+-*+-*/M")
        if operator in {"M", "/"}:
            divisor = rnd.choice([3, 7, 10])
            sign = {
                "/": lambda x: abs(x) // divisor * (1 if x >= 0 else -1),
                "M": lambda x: abs(x) % divisor * (1 if x >= 0 else -1),
            }
            return f"({left} {'MOD' if operator == 'M' else '/'} {divisor})", lambda: wrap(sign[operator](a()), type_)
        work = {"+": lambda x, y: x + y, "-": lambda x, y: x - y, "*": lambda x, y: x * y}[operator]
        return f"({left} {operator} {right})", lambda: wrap(work(a(), b()), type_)

    def index(self, depth):
        """Index 0 to 3."""
        text, value = self.number("UInt", depth + 2, constant=False)
        return f"UINT_TO_INT(({text}) MOD 4)", lambda: value() % 4

    def truth(self, depth=0):
        """Text and function of a condition."""
        rnd = self.rnd
        pick = rnd.randrange(6) if depth < 3 else rnd.randrange(3)
        if pick == 0:
            name = rnd.choice("fg")
            return f"#{name}", lambda: self.read(name)
        if pick <= 2:
            type_ = rnd.choice(["Int", "DInt", "UInt", "SInt"])
            left, a = self.number(type_, depth + 2, constant=False)
            right, b = self.number(type_, depth + 2)
            operator = rnd.choice(["=", "<>", "<", ">="])
            work = {
                "=": lambda x, y: x == y,
                "<>": lambda x, y: x != y,
                "<": lambda x, y: x < y,
                ">=": lambda x, y: x >= y,
            }
            return f"({left} {operator} {right})", lambda: work[operator](a(), b())
        if pick == 3:
            text, value = self.truth(depth + 1)
            return f"(NOT {text})", lambda: not value()
        left, p = self.truth(depth + 1)
        right, q = self.truth(depth + 1)
        operator = rnd.choice(["AND", "OR", "XOR", "="])
        work = {
            "AND": lambda x, y: x and y,
            "OR": lambda x, y: x or y,
            "XOR": lambda x, y: x != y,
            "=": lambda x, y: x == y,
        }
        return f"({left} {operator} {right})", lambda: work[operator](bool(p()), bool(q()))

    def body(self, count, depth):
        """Some statements."""
        made = [self.statement(depth) for _ in range(count)]
        return "\n".join(text for text, _ in made), lambda: [run() for _, run in made]

    def statement(self, depth=0):
        """Text and function of a statement, counted."""
        return self.counted(*self.uncounted(depth))

    def uncounted(self, depth):
        """Text and function of a statement."""
        rnd = self.rnd
        pick = rnd.randrange(12) if depth < 3 else rnd.randrange(8)
        if pick < 4:
            name = rnd.choice(["a", "b", "d", "u", "low", "s"])
            text, value = self.number(NAMES[name][0])
            return f"{SPELLED.get(name, f'#{name}')} := {text};", lambda: self.write(name, value())
        if pick == 4:
            name = rnd.choice("fg")
            text, value = self.truth()
            return f"#{name} := {text};", lambda: self.write(name, value())
        if pick == 5:
            index, at = self.index(0)
            text, value = self.number("Int")
            return f"#x[{index}] := {text};", lambda: self.write("x", value(), at())
        if pick == 6:
            text, value = self.number("Int")
            return f"#w := INT_TO_WORD({text});", lambda: self.write("w", value())
        if pick == 7:
            name = rnd.choice(["hi", "lo"])
            text, value = self.number("Int")
            return f"{SPELLED[name]} := INT_TO_BYTE({text});", lambda: self.write(name, value())
        if pick in {8, 9}:
            return self.branches(depth)
        if pick == 10:
            return self.selection(depth)
        return self.loop(depth)

    def branches(self, depth):
        """IF with ELSIF and perhaps ELSE."""
        parts = [(self.truth(), self.body(2, depth + 1)) for _ in range(self.rnd.randint(1, 3))]
        other = self.body(2, depth + 1) if self.rnd.random() < 0.5 else None
        text = "\n".join(
            f"{'ELSIF' if n else 'IF'} {condition[0]} THEN\n{body[0]}" for n, (condition, body) in enumerate(parts)
        )

        def run():
            for condition, body in parts:
                if condition[1]():
                    return body[1]()
            return other[1]() if other else None

        return text + (f"\nELSE\n{other[0]}" if other else "") + "\nEND_IF;", run

    def selection(self, depth):
        """CASE with single labels and ranges."""
        selector, value = self.number("Int", constant=False)
        bodies = [self.body(1, depth + 1) for _ in range(3)]
        text = f"CASE {selector} MOD 5 OF\n0: {bodies[0][0]}\n1..2: {bodies[1][0]}\nELSE {bodies[2][0]}\nEND_CASE;"

        def run():
            found = value()
            rest = abs(found) % 5 * (1 if found >= 0 else -1)
            bodies[0 if rest == 0 else 1 if rest in {1, 2} else 2][1]()

        return text, run

    def loop(self, depth):
        """FOR over an own temporary, with CONTINUE and EXIT."""
        self.depth += 1
        name, last = f"i{depth}", self.rnd.randint(0, 4)
        skip, leave = (self.counted(*self.truth()) for _ in range(2))
        again, out = (self.counted(text, lambda: None) for text in ("CONTINUE;", "EXIT;"))
        first, second = self.body(1, depth + 1), self.body(1, depth + 1)
        text = f"FOR #{name} := 0 TO {last} DO\n{first[0]}\n"
        for (condition, _), (jump, _) in ((skip, again), (leave, out)):
            text += condition.replace("*)", "*)IF ", 1) + f" THEN {jump} END_IF;\n"
        text += f"{second[0]}\nEND_FOR;"

        def run():
            for _ in range(last + 1):
                first[1]()
                if skip[1]():
                    again[1]()
                    continue
                if leave[1]():
                    out[1]()
                    break
                second[1]()

        return text, run


def numbered(program):
    """Index of the probe of each statement by its number."""
    source = program.link.blocks["TEST"].result.tokens.source
    probes = {(p.line, p.column): n for n, p in enumerate(program.probes) if p.kind == "statement"}
    found = {}
    for mark in re.finditer(r"\(\*(\d+)\*\)", source):
        before = source[: mark.end()]
        found[int(mark[1])] = probes[before.count("\n") + 1, len(before) - before.rfind("\n")]
    return found


@pytest.mark.parametrize("seed", [*range(30), *(pytest.param(n, marks=pytest.mark.slow) for n in range(30, 150))])
def test_random_programs(seed):
    """After each of five calls memory is the same, byte by byte; every statement is counted as often as it ran."""
    walk = Walk(seed)
    text, run = walk.body(14, 0)
    case = {"vars": VARS, "temp": " ".join(f"i{n} : Int;" for n in range(4)), "code": text}
    program = load(case, coverage=True)
    cpu, plain, numbers = Cpu(program), Cpu(load(case)), numbered(program)
    for _ in range(5):
        cpu.call("Test_DB")
        plain.call("Test_DB")
        run()
        assert cpu.misuses == plain.misuses == []
        assert bytes(walk.memory) == bytes(cpu.db("Test_DB")) == bytes(plain.db("Test_DB")), text
        coverage = cpu.coverage
        assert walk.passed == [coverage[numbers[number]] for number in range(len(walk.passed))], text
