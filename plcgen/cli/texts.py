"""``plcgen texts``: text lists for an HMI."""

from __future__ import annotations

from pathlib import Path

import click

from plcgen.cli.convert import is_culture
from plcgen.cli.options import PATH, console, device_option, toolchain_option, verb
from plcgen.cli.output import OK
from plcgen.ds47.wire.errors import TABLES, Table

FORMATS = ("xlsx", "xml", "csv")
DEFAULT = ("en-US", "de-DE", "zh-CN")


@verb(
    "texts",
    "plcgen texts",
    "plcgen texts --language de-DE --language zh-CN --format xlsx --format csv",
    "plcgen texts --format xml --toolchain tia-v19 --errors profidrive -o hmi",
    "plcgen texts --device sinamics-g120c",
)
@click.option(
    "--language", "languages", multiple=True, metavar="TAG", help="A language.  [default: en-US, de-DE, zh-CN]"
)
@click.option(
    "--format", "formats", multiple=True, type=click.Choice(FORMATS), help="Format to write.  [default: xlsx]"
)
@toolchain_option("TIA Portal version that xml names")
@click.option(
    "--errors",
    type=click.Choice(TABLES),
    default="sinamics",
    show_default=True,
    help="Error numbers: with those of SINAMICS, or only what PROFIdrive says.",
)
@device_option("Device whose faults and alarms become text lists, too; their titles are in English.")
@click.option("-o", "--out", "folder", type=PATH, default=Path("texts"), show_default=True, metavar="DIR")
@click.option("--force", is_flag=True, help="Overwrite files that exist.")
def command(
    *,
    languages: tuple[str, ...],
    formats: tuple[str, ...],
    version: str,
    errors: Table,
    device: str | None,
    folder: Path,
    force: bool,
) -> int:
    """Write text lists for an HMI: status words and error numbers of drive jobs, fault classes of PROFIdrive.

    xlsx is what the text list editor of the TIA Portal exports and imports, xml is for TIA Openness, csv for
    everything else. The texts are available in English, German and Chinese.
    """
    from plcgen.build.text_lists import WRITERS
    from plcgen.build.writing import add_files
    from plcgen.ds47.devices import find_device
    from plcgen.ds47.hmi.lists import LANGUAGES, text_lists

    cultures = tuple(dict.fromkeys(languages)) or DEFAULT
    for tag in cultures:
        if not is_culture(tag) or tag[:2].lower() not in LANGUAGES:
            raise click.BadParameter(
                f'"{tag}" is not available: use en-US, de-DE, zh-CN or the like', param_hint="--language"
            )
    families = find_device(device).messages if device else ()
    if device and not families:
        raise click.BadParameter(f"no list of the messages of {device} is known", param_hint="--device")
    lists = text_lists(cultures, errors, families)
    files = [file for name in dict.fromkeys(formats or ("xlsx",)) for file in WRITERS[name](lists, cultures, version)]
    done = add_files(files, folder, force=force)
    console().say(f"{folder}: {len(done.written)} written, {len(done.unchanged)} unchanged")
    return OK
