"""``plcgen ppi stop``: put an S7-200 into STOP."""

from __future__ import annotations

from plcgen.cli.ppi.mode import mode_command

command = mode_command(
    "stop",
    """Put the CPU into STOP; only with --yes-stop.

    The program ends, outputs take their substitute values. Exit code 1 if the CPU refuses, 2 without --yes-stop.
    """,
)
