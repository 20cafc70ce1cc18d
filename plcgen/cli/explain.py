"""``plcgen explain``: what a code or number means."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from plcgen.cli.completed import codes as completed
from plcgen.cli.options import console, device_option, format_option, verb
from plcgen.cli.output import OK, PROBLEMS, error_line, help_line

if TYPE_CHECKING:
    from plcgen.base.display.results import Answer
    from plcgen.report.registry import OutputFormat


@verb(
    "explain",
    "plcgen explain PG209            a diagnostic of plcgen",
    "plcgen explain 0x11             an error number in a drive's answer",
    "plcgen explain 16#8401          the status word of a generated block",
    "plcgen explain DF80B500         a STATUS double word of WRREC or RDREC",
    "plcgen explain F30001           a message of a drive: title, class, reaction, where it lies",
    "plcgen explain r2=42 r899.2 --device sinamics-s120    a value or bit of a parameter",
    "plcgen explain hardware-id      which identifier or address leads to a drive",
    "plcgen explain --list",
)
@click.argument("codes", nargs=-1, metavar="CODE...", shell_complete=completed)
@click.option("--list", "list_all", is_flag=True, help="List every diagnostic code.")
@device_option()
@format_option("answer")
def command(*, codes: tuple[str, ...], list_all: bool, device: str | None, format_: OutputFormat) -> int:
    """Explain diagnostic codes, error numbers of a drive, status words, messages and parameters.

    Numbers without a letter are hexadecimal, in any usual spelling; their length says what they are. Messages and
    parameters are those of all devices, or of the one of --device.
    """
    out = console()
    if list_all:
        return out.answer(format_, _list())
    if not codes:
        raise click.UsageError("give a code, for example PG209, or --list")
    from plcgen import api
    from plcgen.base.display.page import page_answer

    pages = [api.explain(key, device or "") for key in codes]
    known = [page_answer(page) for page in pages if page is not None]
    if known:
        out.result("\n".join(format_.render("answer", page, out.view()) for page in known))
    for key, page in zip(codes, pages, strict=True):
        if page is None:
            _unknown(key)
    return OK if len(known) == len(codes) else PROBLEMS


def _unknown(key: str) -> None:
    from plcgen.api.explanation import known_keys
    from plcgen.base.diagnostics.suggest import did_you_mean
    from plcgen.base.display.cells import clean
    from plcgen.base.page_search import best_pages

    error_line(
        f'"{clean(key)[:60]}" is not a plcgen code, an error number, a status word, a message or a parameter', "PG703"
    )
    pages = ", ".join(f"plcgen docs {name}" for name, _ in best_pages(key))
    help_line(did_you_mean(key, known_keys()) or pages or "plcgen explain --list")


def _list() -> Answer:
    from plcgen.api.explanation import list_codes
    from plcgen.base.display.data import head
    from plcgen.base.display.results import Answer
    from plcgen.base.display.table import text_table

    rows = list_codes()
    codes = [{"code": code, "severity": severity, "title": title} for code, severity, title in rows]
    text = "\n".join(text_table(("code", "severity", "title"), rows, indent=0)) + "\n"
    return Answer({**head("codes", ok=True), "codes": codes}, lambda _view: text)
