"""``plcgen lsp``: the language server for editors."""

from __future__ import annotations

import sys
from importlib.util import find_spec

import click

from plcgen.cli.options import verb
from plcgen.cli.output import OK, is_terminal

INSTALL = "pip install pygls (with pipx: pipx inject plcgen pygls)"


@verb("lsp", "plcgen lsp                      what an editor starts; plcgen docs editors says how")
@click.option("--stdio", is_flag=True, help="Accepted because some editors add it: nothing else is spoken.")
def command(*, stdio: bool) -> int:
    """Serve an editor over the language server protocol, on stdin and stdout.

    Specs and PLC sources: problems while you type, completion, hover, definitions, names, layout. It ends when the
    editor closes it. Nothing is written: edits are the editor's.
    """
    del stdio
    if find_spec("pygls") is None:
        raise click.UsageError(f"lsp needs pygls: {INSTALL}")
    if is_terminal(sys.stdin):
        raise click.UsageError("an editor starts lsp and speaks to it: see plcgen docs editors")
    from plcgen.workbench.lsp.server import server

    server.start_io()
    return OK
