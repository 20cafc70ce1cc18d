"""Conversions: every name that the help lists, and the value of those that copy bits or round."""

from pathlib import Path

import pytest

from plcgen.s7.cpu.testing import load_scl
from plcgen.s7.cpu.type_rules import conversions
from plcgen.s7.types.data_types import ALIASES

ROWS = [
    line.split("\t")
    for line in (Path(__file__).parent / "facts" / "conversions.tsv").read_text(encoding="utf-8").splitlines()[2:]
]
DIALECTS = {"S7-1500": "tia-1500", "S7-300/400": "tia-300"}
WIDTHS = {"BYTE": 8, "WORD": 16, "DWORD": 32, "LWORD": 64, "USINT": 8, "UINT": 16, "UDINT": 32, "ULINT": 64}
SIGNED = {"SINT": 8, "INT": 16, "DINT": 32, "LINT": 64}


@pytest.mark.parametrize("family", DIALECTS)
def test_every_name_of_the_help_is_known(family):
    """Each ``A_TO_B`` of the help is a function of its family."""
    named = {(ALIASES.get(source, source), ALIASES.get(target, target)) for source, target, of in ROWS if of == family}
    missing = {pair for pair in named - conversions(classic=family != "S7-1500") if "BCD" not in f"{pair}"}
    assert missing == set()
    digits = [f"{source}_TO_{target}" for source, target, of in ROWS if of == family and "BCD" in source + target]
    lines = "".join(
        f"#n := {name}({'#w' if 'BCD' in name.partition('_TO_')[0] else '#n'});\n"
        for name in digits
        if name.endswith(("_INT", "_DINT"))
    )
    text = f'FUNCTION_BLOCK "T"\nVAR\nn : DInt;\nw : Word;\nEND_VAR\nBEGIN\n{lines}END_FUNCTION_BLOCK\n'
    assert load_scl(text, dialect=DIALECTS[family], iec_check="off").cpu.misuses == []


def pattern_of(value, target):
    """The bits of a value, as many as the target has, read with the sign of the target."""
    bits = SIGNED.get(target) or WIDTHS[target]
    pattern = value & (1 << bits) - 1
    return pattern - (1 << bits) if target in SIGNED and pattern >> bits - 1 else pattern


@pytest.mark.parametrize("family", DIALECTS)
def test_bits_are_copied_with_the_sign_of_the_source(family):
    """Integers and bit strings: extended to the width with the sign of the source, then the bits are copied.

    Source: help of the TIA Portal V19, footnote 1 of the tables of explicit conversions of the S7-1500. So
    INT_TO_DWORD of -2 is 16#FFFFFFFE.
    """
    both = {*WIDTHS, *SIGNED}
    pairs = [(source, target) for source, target, of in ROWS if of == family and {source, target} <= both]
    assert family != "S7-1500" or len(pairs) == 132  # twelve types into eleven others
    declared, code = "", ""
    for number, (source, target) in enumerate(pairs):
        value = -2 if source in SIGNED else (1 << WIDTHS[source]) - 2
        start = value if source in SIGNED or "INT" in source else f"16#{value:X}"
        declared += f"x{number} : {source} := {start};\ny{number} : {target};\n"
        code += f"#y{number} := {source}_TO_{target}(#x{number});\n"
    text = f'FUNCTION_BLOCK "T"\nVAR\n{declared}END_VAR\nBEGIN\n{code}END_FUNCTION_BLOCK\nDATA_BLOCK "D"\n"T"\nBEGIN\n'
    bench = load_scl(text + "END_DATA_BLOCK\n", dialect=DIALECTS[family])
    bench.call("D")
    for number, (source, target) in enumerate(pairs):
        value = -2 if source in SIGNED else (1 << WIDTHS[source]) - 2
        assert (source, target, bench.cpu[f"D.y{number}"]) == (source, target, pattern_of(value, target))


def test_s5time_as_a_word():
    """Time base and digits are copied: S5T#1s230ms is 16#0123 in both directions, on both families."""
    for dialect in DIALECTS.values():
        text = (
            'FUNCTION_BLOCK "T"\nVAR\nw : Word;\nt : S5Time := S5T#1s_230ms;\nv : Word := 16#0123;\nu : S5Time;\n'
            "END_VAR\nBEGIN\n#w := S5TIME_TO_WORD(#t);\n#u := WORD_TO_S5TIME(#v);\nEND_FUNCTION_BLOCK\n"
            'DATA_BLOCK "D"\n"T"\nBEGIN\nEND_DATA_BLOCK\n'
        )
        bench = load_scl(text, dialect=dialect)
        bench.call("D")
        assert (bench.cpu["D.w"], bench.cpu["D.u"]) == (0x0123, 1230)
