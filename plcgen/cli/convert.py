"""``plcgen convert``: blocks as SCL text, SimaticML or SIMATIC SD."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from plcgen.base.diagnostics.counting import quantity
from plcgen.cli.options import PATH, console, format_option, toolchain_option, verb
from plcgen.cli.output import OK, PROBLEMS

if TYPE_CHECKING:
    from plcgen.api import ConvertResult
    from plcgen.report.registry import OutputFormat


@verb(
    "convert",
    "plcgen convert scl udt db --to xml --toolchain tia-v18 --out xml",
    "plcgen convert export/Motor.xml --to scl --out scl",
    "plcgen convert old.scl --to xml --classic --out xml",
    "plcgen convert udt db --to sd --toolchain tia-v21 --out sd",
)
@click.argument("paths", nargs=-1, required=True, type=PATH, metavar="FILE|FOLDER...")
@click.option(
    "--to", type=click.Choice(["scl", "xml", "sd"]), required=True, help="Text sources, SimaticML or SIMATIC SD."
)
@click.option("--out", "folder", type=PATH, required=True, metavar="DIR", help="Output folder.")
@toolchain_option("Oldest TIA Portal that must be able to import the documents")
@click.option("--classic", is_flag=True, help="The blocks are for S7-300/400.")
@click.option("--culture", default="en-US", show_default=True, metavar="TAG", help="Language of comments in documents.")
@click.option("--encoding", metavar="NAME", help="Code page of ANSI sources, such as cp1252.  [default: guessed]")
@click.option("--keep-going", is_flag=True, help="Leave out what cannot be read or converted, and convert the rest.")
@click.option("--force", is_flag=True, help="Overwrite files that exist.")
@format_option("findings")
def command(*, paths: tuple[Path, ...], folder: Path, culture: str, format_: OutputFormat, **options: Any) -> int:
    """Turn blocks into SimaticML for TIA Openness, documents into SCL, UDT and DB sources, or either into SIMATIC SD.

    One file per block, named after it; comments and layout of the code are kept. Name the sources of all types
    and function blocks together: an instance DB needs its function block. There is no SCL for networks in LAD, FBD
    or STL: their blocks are left out with a warning, as are those of a safety program. A start value that the other
    format cannot hold is an error. Either all files are written or none; with --keep-going, those that can be are
    written, and the exit code is still 1 if there is an error.

    SIMATIC SD is experimental (tia-v20, tia-v21): a block with something that no public document of it shows is left
    out with a warning.
    """
    from plcgen import api

    if not is_culture(culture):
        raise click.BadParameter("write it like en-US", param_hint="--culture")
    if options["to"] == "sd" and options["version"] not in {"V20", "V21"}:
        raise click.BadParameter("SIMATIC SD is of tia-v20 and tia-v21", param_hint="--toolchain")
    out = console()
    result = api.convert(*paths, out=folder, culture=culture, **options)
    if format_.name != "text":
        from plcgen.base.display.results import Findings

        folder_ = result.folder.as_posix()
        more = {"folder": folder_, "written": list(result.written), "unchanged": list(result.unchanged)}
        out.show(format_, "findings", Findings("convert", [(folder_, result.diagnostics)], more))
        return OK if result.ok else PROBLEMS
    out.complain(result.diagnostics)
    out.say(_summary(result))
    return OK if result.ok else PROBLEMS


def is_culture(text: str) -> bool:
    """Whether a language tag is one that the schemas of SimaticML accept."""
    parts = text.split("-")
    sizes = [len(part) for part in parts]
    return text.isascii() and all(part.isalpha() for part in parts) and sizes in ([2, 2], [2, 4, 2])


def _summary(result: ConvertResult) -> str:
    if not result.ok and not result.written and not result.unchanged:
        return "nothing was written"
    text = f"{result.folder}: {quantity(len(result.written), 'file')} written"
    return text + (f", {len(result.unchanged)} unchanged" if result.unchanged else "")
