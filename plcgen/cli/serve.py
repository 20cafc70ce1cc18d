"""``plcgen serve``: the workbench as a page in the browser."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

import click

from plcgen.cli.options import PATH, console, verb
from plcgen.cli.output import OK

INSTALL = "pip install starlette uvicorn (with pipx: pipx inject plcgen starlette uvicorn)"


@verb("serve", "plcgen serve", "plcgen serve machines/", "plcgen serve --port 8400 --no-browser")
@click.argument("folder", type=PATH, default=".", metavar="[FOLDER]")
@click.option(
    "--port", type=click.IntRange(0, 65535), default=0, metavar="N", help="Port on this machine.  [default: a free one]"
)
@click.option("--browser/--no-browser", default=True, help="Open the page.  [default: browser]")
def command(*, folder: Path, port: int, browser: bool) -> int:
    """Write specs, see what they become, run and verify them on a page in the browser, until Ctrl-C.

    The page is served to this machine alone, at an address with a secret part. It reads and saves specs of the folder
    and below, and writes generated files only when you ask it to, with the rules of generate.
    """
    if not folder.is_dir():
        raise click.UsageError(f"there is no folder {folder}")
    if any(find_spec(name) is None for name in ("starlette", "uvicorn")):
        raise click.UsageError(f"serve needs Starlette and uvicorn: {INSTALL}")
    from plcgen.workbench.serve.app import serve

    out = console()

    def told(address: str) -> None:
        out.result(f"{address}\n")
        out.say(f"the workbench of {folder}; Ctrl-C ends")
        if browser:
            import webbrowser

            webbrowser.open(address)

    try:
        serve(folder, port, told)
    except KeyboardInterrupt:  # the usual end
        out.say("")
    except OSError as problem:
        raise click.ClickException(f"port {port} cannot be used: {problem.strerror or problem}") from problem
    return OK
