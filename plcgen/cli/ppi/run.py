"""``plcgen ppi run``: put an S7-200 into RUN."""

from __future__ import annotations

from plcgen.cli.ppi.mode import mode_command

command = mode_command(
    "run",
    """Put the CPU into RUN; only with --yes-run.

    The program starts, outputs become active. The mode selector must be at RUN or TERM. Exit code 1 if the CPU refuses,
    2 without --yes-run.
    """,
)
