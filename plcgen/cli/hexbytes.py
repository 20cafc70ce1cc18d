"""Bytes on stdin."""

from __future__ import annotations

import sys

import click

from plcgen.cli.output import is_terminal

STDIN = "<stdin>"
"""What diagnostics name as the file of what comes on stdin."""
MAX_INPUT = 16 * 1024 * 1024


def read_stdin(ways: str) -> bytes:
    """Everything on stdin; ``ways`` are further ways to give bytes. Raises UsageError for a terminal and too much."""
    if sys.stdin is None or is_terminal(sys.stdin):
        raise click.UsageError(f"give the bytes as arguments{ways} or on stdin")
    stream = getattr(sys.stdin, "buffer", None)
    data: bytes = stream.read(MAX_INPUT + 1) if stream is not None else sys.stdin.read(MAX_INPUT + 1).encode()
    require_size(data, "stdin")
    return data


def require_size(data: bytes, name: str) -> None:
    """Raise UsageError for more bytes than anybody records."""
    if len(data) > MAX_INPUT:
        raise click.UsageError(f"more than {MAX_INPUT // 1024 // 1024} MiB {'on' if name == 'stdin' else 'in'} {name}")
