"""Small programs from a few lines: declarations, statements, expected contents."""

from pathlib import Path

from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.type_rules import IecCheck
from plcgen.s7.scl.dialect import Dialect
from tests.yaml_files import read_yaml

HERE = Path(__file__).parent
DIALECTS = {"V5": Dialect.STEP7_V5, "T3": Dialect.TIA_300_400, "T15": Dialect.TIA_1200_1500}


def cases(name):
    """Cases of one file below ``cases``."""
    return read_yaml((HERE / "cases" / f"{name}.yaml").read_text(encoding="utf-8"))


def source(case):
    """One FB called Test with its instance Test_DB, and whatever else the case declares."""
    v5 = case.get("dialect") == "V5"
    access = "" if v5 else "{ S7_Optimized_Access := 'FALSE' }\n"
    sections = "".join(
        f"{section}\n{case[key]}\n{'END_CONST' if section == 'CONST' else 'END_VAR'}\n"
        for key, section in (
            ("in", "VAR_INPUT"), ("out", "VAR_OUTPUT"), ("inout", "VAR_IN_OUT"), ("vars", "VAR"),
            ("temp", "VAR_TEMP"), ("const", "CONST" if v5 else "VAR CONSTANT"),
        )
        if key in case
    )  # fmt: skip
    block = f'FUNCTION_BLOCK "Test"\n{access}{sections}BEGIN\n{case["code"]}\nEND_FUNCTION_BLOCK\n'
    instance = f'DATA_BLOCK "Test_DB" {access}"Test"\nBEGIN\nEND_DATA_BLOCK\n'
    return case.get("also", "") + block + instance


def load(case, **options):
    """Program of a case."""
    dialect = DIALECTS[case.get("dialect", "T15")]
    return Program.load(
        [("test.scl", source(case))],
        dialect,
        tags=case.get("tags"),
        numbers=case.get("numbers"),
        iec_check=IecCheck(case.get("iec_check", "as-stated")),
        **options,
    )


def run(case):
    """CPU after ``calls`` calls of Test_DB, 10 ms apart."""
    cpu = Cpu(load(case))
    for _ in range(case.get("calls", 1)):
        cpu.call("Test_DB", 10)
    return cpu


def short(diagnostic, first_line):
    """``line code message`` with lines counted from the first statement."""
    return f"{diagnostic.span.line - first_line} {diagnostic.code} {diagnostic.message}"
