"""``plcgen explain``: what a code or number means."""

from __future__ import annotations

import click

from plcgen.cli.options import CONTEXT, Verb, common_options, console, json_option
from plcgen.cli.output import OK, PROBLEMS, error_line, help_line


@click.command(
    "explain",
    cls=Verb,
    context_settings=CONTEXT,
    examples=(
        "plcgen explain PG209            a diagnostic of plcgen",
        "plcgen explain 0x11             an error number in a drive's answer",
        "plcgen explain 16#8401          the status word of a generated block",
        "plcgen explain DF80B500         a STATUS double word of WRREC or RDREC",
        "plcgen explain --list",
    ),
)
@click.argument("codes", nargs=-1, metavar="CODE...")
@click.option("--list", "list_all", is_flag=True, help="List every diagnostic code.")
@json_option
@common_options
@click.pass_context
def command(
    ctx: click.Context,
    codes: tuple[str, ...],
    list_all: bool,  # noqa: FBT001 - click's signature
    as_json: bool,  # noqa: FBT001
) -> int:
    """Explain diagnostic codes, error numbers of a drive, and status words.

    Numbers are hexadecimal, in any usual spelling; their length says what they are.
    """
    out = console(ctx)
    if list_all:
        _list(ctx, as_json=as_json)
        return OK
    if not codes:
        raise click.UsageError("give a code, for example PG209, or --list", ctx)
    from plcgen import api
    from plcgen.output.page import page_json, page_text

    pages = [api.explain(key) for key in codes]
    known = [page for page in pages if page is not None]
    if as_json:
        texts = [page_json(page) for page in known]
    else:
        texts = [page_text(page, color=out.out_color, width=out.out_width) for page in known]
    if texts:
        out.result("\n".join(texts))
    for key, page in zip(codes, pages, strict=True):
        if page is None:
            _unknown(key)
    return OK if len(known) == len(codes) else PROBLEMS


def _unknown(key: str) -> None:
    from plcgen.diagnostics.suggest import did_you_mean
    from plcgen.output.cells import clean
    from plcgen.output.explain import known_keys

    error_line(f'"{clean(key)[:60]}" is no code of plcgen, error number or status word', "PG703")
    help_line(did_you_mean(key, known_keys()) or "plcgen explain --list")


def _list(ctx: click.Context, *, as_json: bool) -> None:
    from plcgen.output.explain import list_codes
    from plcgen.output.json import dump, head
    from plcgen.output.table import text_table

    rows = list_codes()
    if as_json:
        codes = [{"code": code, "severity": severity, "title": title} for code, severity, title in rows]
        console(ctx).result(dump({**head("codes", ok=True), "codes": codes}))
        return
    lines = text_table(("code", "severity", "title"), rows, indent=0)
    console(ctx).result("\n".join(lines) + "\n")
