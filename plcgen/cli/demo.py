"""``plcgen demo``: the shipped examples, from spec to verdict."""

from __future__ import annotations

from pathlib import Path

import click

from plcgen.api import default_folder
from plcgen.cli.options import PATH, console, verb
from plcgen.cli.output import OK, PROBLEMS, Console


@verb(
    "demo",
    "plcgen demo",
    "plcgen demo /tmp/plcgen",
)
@click.argument("folder", type=PATH, default="plcgen-demo", metavar="[DIR]")
def command(*, folder: Path) -> int:
    """Copy the shipped specs to DIR (plcgen-demo), generate their blocks and verify them.

    Specs that you changed in DIR are kept and used; nothing outside DIR is touched.
    """
    out = console()
    specs = _copy(out, folder)
    good = [_one(out, spec) for spec in specs]
    out.result(f"\n{sum(good)} of {len(good)} specs generated and verified without an error\n")
    out.say(f"\nlook around in {folder}; change a spec there and run plcgen demo {folder} again")
    return OK if all(good) else PROBLEMS


def _copy(out: Console, folder: Path) -> list[Path]:
    """Copy the specs that are not there yet."""
    from plcgen.resources import specs_dir

    folder.mkdir(parents=True, exist_ok=True)
    copies: list[Path] = []
    for source in sorted(specs_dir().glob("*.yaml")):
        target = folder / source.name
        data = source.read_bytes()
        if not target.exists():
            target.write_bytes(data)
            out.say(f"copied {target}")
        elif target.read_bytes() != data:
            out.say(f"kept {target}: it differs from the shipped one")
        copies.append(target)
    return copies


def _one(out: Console, spec: Path) -> bool:
    """Generate and verify one spec; True if all is well."""
    from plcgen import api
    from plcgen.output.verification import verification_text

    with out.progress() as progress:
        made = api.generate(spec, default_folder(spec), progress=progress)
    out.complain(made.diagnostics)
    if not made.ok:
        return False
    out.say(f"{made.folder}: {len(made.written)} files written, {len(made.unchanged)} unchanged")
    with out.progress() as progress:
        result = api.verify(spec, made.folder, progress=progress)
    out.result(verification_text(result, out.view()) + "\n")
    return result.ok
