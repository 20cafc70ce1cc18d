"""Every result that the help of the TIA Portal prints for an instruction, as the soft CPU has it."""

import math
from pathlib import Path

import pytest

from plcgen.s7.cpu.testing import load_scl

FACTS = Path(__file__).parent / "facts"
ROWS = [line.split("\t") for line in (FACTS / "results.tsv").read_text(encoding="utf-8").splitlines()[2:]]


def wanted_of(text):
    """Value, and whether a few digits of it count: ``16#1F``, ``2#101``, ``'a b'``, ``True``, ``1.5``."""
    if text.startswith("'"):
        return text.strip("'")
    if "#" in text:
        base, _, digits = text.partition("#")
        return int(digits, int(base))
    if text in {"True", "False"}:
        return text == "True"
    return float(text)


def results_of(text):
    """Names with ``=`` or ``~`` and what they are; a text in quotes may have blanks."""
    rest = text
    while rest:
        name, sign = (rest.partition("=")[0], "=") if "~" not in rest.split(" ")[0] else (rest.partition("~")[0], "~")
        value = rest[len(name) + 1 :]
        end = value.index("'", 1) + 1 if value.startswith("'") else (value + " ").index(" ")
        yield name, sign, wanted_of(value[:end])
        rest = value[end:].lstrip()


@pytest.mark.parametrize("row", ROWS, ids=[f"{number}-{row[0]}-{row[1]}" for number, row in enumerate(ROWS)])
def test_the_result_is_that_of_the_help(row):
    """Values in, values out; what the help rounds counts with its digits."""
    _, target, variables, statements, results, _ = row
    access = "{ S7_Optimized_Access := 'FALSE' }\n"
    text = (
        f'FUNCTION_BLOCK "T"\n{access}VAR\n{variables}\nEND_VAR\nBEGIN\n{statements}\nEND_FUNCTION_BLOCK\n'
        f'DATA_BLOCK "D"\n{access}"T"\nBEGIN\nEND_DATA_BLOCK\n'
    )
    bench = load_scl(text, dialect=target)
    bench.call("D")
    assert bench.cpu.misuses == []
    for name, sign, wanted in results_of(results):
        found = bench.cpu[f"D.{name}"]
        if sign == "~":
            assert math.isclose(found, wanted, rel_tol=5e-4)
        else:
            assert found == wanted
