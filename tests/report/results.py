"""Hand-made results for the report tests."""

from plcgen.base.diagnostics import Diagnostic, Note, Severity, Span
from plcgen.proof.checks import Check, CheckGroup, Outcome, Verification

SOURCE = "plc:\n\tname: 加工站 x\n  ramp: 700.0\nend\n"
LINES = SOURCE.split("\n")


def line(_file, number):
    """Lines of SOURCE, whatever the file is called."""
    return LINES[number - 1] if 1 <= number <= len(LINES) else None


LIMIT = Diagnostic(
    "PG209",
    "P50303 = 700 is outside its limits 0..650 s",
    Span("specs/x.yaml", 3, 9, 3, 14),
    help="the drive would answer error 02h",
    notes=(Note("first use", Span("specs/x.yaml", 1, 1, 1, 4)),),
)
WARNING = Diagnostic("PG310", "a timeout of 1 ms", Span("specs/x.yaml"), Severity.WARNING)

VERIFICATION = Verification(
    spec="specs/x.yaml",
    folder="out",
    project="Demo",
    target="s7-300 / tia-v16",
    groups=(
        CheckGroup(
            "layout",
            "Layout",
            (
                Check("layout.DB3", 'DB3 "WR"', "10 B ref@0", Outcome.OK, "3 sources agree"),
                Check("layout.DB6", 'DB6 "RD_1"', "4 B", Outcome.ERROR, "6 bytes too small", LIMIT),
            ),
        ),
        CheckGroup("execution", "Execution", (Check("run", "run", "", Outcome.NOT_RUN, "no soft CPU"),)),
    ),
    diagnostics=(LIMIT,),
)
