"""``plcgen docs``: the pages of the documentation, from what is installed."""

from __future__ import annotations

import click

from plcgen.base.display.cells import clean
from plcgen.base.page_search import best_pages, title
from plcgen.base.resources import documented
from plcgen.cli.completed import pages as completed
from plcgen.cli.options import console, verb
from plcgen.cli.output import OK


@verb(
    "docs",
    "plcgen docs                     all pages with their titles",
    "plcgen docs spec                every key of a spec",
    "plcgen docs PG209               the page of a diagnostic",
    "plcgen docs save to ROM         the pages that say most about some words",
)
@click.argument("words", nargs=-1, metavar="[PAGE|WORD...]", shell_complete=completed)
def command(*, words: tuple[str, ...]) -> int:
    """Show a page of the documentation, or find pages by words, without a network.

    Without PAGE all pages are listed. A page is Markdown.
    """
    known = documented()
    if not words:
        listed = {name: path for name, path in known.items() if not name.startswith(("codes/", "adr/"))}
        width = max(map(len, listed))
        lines = (f"{name.ljust(width)}  {title(path.read_text('utf-8'))}" for name, path in listed.items())
        console().result("\n".join(lines) + "\n")
        return OK
    page = " ".join(words)
    path = known.get(page.removesuffix(".md")) or known.get(f"codes/{page.upper()}") or known.get(f"tasks/{page}")
    if path is None:
        from plcgen.base.diagnostics.suggest import did_you_mean

        found = [f"  plcgen docs {name}  {called}" for name, called in best_pages(page)]
        if found:
            console().result("\n".join([f'pages that say most about "{clean(page)[:60]}":', *found]) + "\n")
            return OK
        hint = did_you_mean(page, [*known, *(name.partition("/")[2] for name in known)])
        raise click.UsageError(f'there is no page "{page}"{f", {hint}" if hint else "; plcgen docs lists them"}')
    console().result(path.read_text("utf-8"))
    return OK
