"""``plcgen docs``: the pages of the documentation, from what is installed."""

from __future__ import annotations

from pathlib import Path

import click

from plcgen.base.resources import documented
from plcgen.cli.completed import pages as completed
from plcgen.cli.options import console, verb
from plcgen.cli.output import OK


@verb(
    "docs",
    "plcgen docs                     all pages with their titles",
    "plcgen docs spec                every key of a spec",
    "plcgen docs PG209               the page of a diagnostic",
)
@click.argument("page", required=False, shell_complete=completed)
def command(*, page: str | None) -> int:
    """Show a page of the documentation, without a network.

    Without PAGE all pages are listed. A page is Markdown.
    """
    known = documented()
    if page is None:
        listed = {name: path for name, path in known.items() if not name.startswith(("codes/", "adr/"))}
        width = max(map(len, listed))
        lines = (f"{name.ljust(width)}  {_title(path)}" for name, path in listed.items())
        console().result("\n".join(lines) + "\n")
        return OK
    path = known.get(page.removesuffix(".md")) or known.get(f"codes/{page.upper()}") or known.get(f"tasks/{page}")
    if path is None:
        from plcgen.base.diagnostics.suggest import did_you_mean

        hint = did_you_mean(page, [*known, *(name.partition("/")[2] for name in known)])
        raise click.UsageError(f'there is no page "{page}"{f", {hint}" if hint else "; plcgen docs lists them"}')
    console().result(path.read_text("utf-8"))
    return OK


def _title(path: Path) -> str:
    """The first heading of a page."""
    lines = path.read_text("utf-8").splitlines()
    return next((line.removeprefix("# ") for line in lines if line.startswith("# ")), "")
