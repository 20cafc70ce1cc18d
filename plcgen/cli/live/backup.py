"""``plcgen live backup``: all parameters of a drive object, as a list."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.base.diagnostics.counting import quantity
from plcgen.cli.live.places import object_number, object_options, open_channel, read_station, timeout_option
from plcgen.cli.options import PATH, console, device_option, force_option, format_option, verb
from plcgen.cli.output import OutputError
from plcgen.cli.ppi.connection import ask

if TYPE_CHECKING:
    from collections.abc import Sequence

    from plcgen.base.display.results import Answer
    from plcgen.ds47.device import Device
    from plcgen.ds47.live.channel import PnParameters
    from plcgen.ds47.live.draft import Draft
    from plcgen.report.registry import OutputFormat


@verb(
    "backup",
    "plcgen live backup pump.csv --port pn://192.168.0.5 --device sinamics-g120",
    "plcgen live backup axis.csv --port pn://192.168.0.5/2.1 --device sinamics-s120 --do 2 --resume",
)
@click.argument("path", type=PATH, metavar="FILE")
@click.option("--port", "host", required=True, metavar="pn://IP", help="The drive: pn://IP[:PORT][/SLOT.SUBSLOT].")
@device_option("Device profile: drive object, titles, units, limits of a request.", required=True)
@object_options
@click.option("--resume", is_flag=True, help="Go on with a backup that was broken off.")
@force_option("Overwrite FILE.")
@timeout_option
@format_option("answer")
def command(
    *,
    path: Path,
    host: str,
    device: str,
    number: int | None,
    resume: bool,
    timeout: float,
    format_: OutputFormat,
) -> int:
    """Read all parameters of a drive object that can be read, several in a request, and write them as a list (CSV).

    Which there are the drive says (r0980), or else the lists of the device. FILE.part grows while it is read; FILE is
    written when all is there. live compare and catalogue import take it. Nothing of the drive is changed.
    """
    where, out = read_station(host), console()
    out.replaceable(path, fresh=True)

    def question() -> Answer:
        from plcgen.ds47.devices import find_device
        from plcgen.ds47.live.draft import Draft

        known = find_device(device)
        object_ = object_number(number, known)
        try:
            draft = Draft(path, f"{known.title}, {known.key}, drive object {object_}, {where}", resume=resume)
            with open_channel(where, timeout, known) as channel:
                count = _gather(channel, known, object_, draft)
        except OSError as problem:
            raise OutputError(f"cannot write {path}.part: {problem.strerror or problem}") from problem
        text, refused = draft.finished()
        out.result(text, path, fresh=True)
        draft.path.unlink()
        return _answer(path, (str(where), object_, count), refused)

    return ask(format_, "live backup", (host,), question)


def _gather(channel: PnParameters, device: Device, object_: int, draft: Draft) -> int:
    """Fill a draft; how many parameters the drive object has. Whatever ends it before, what was read stays there."""
    from plcgen.ds47.live import backup

    out = console()
    try:
        with out.progress() as progress:
            every = backup.numbers(channel, device, object_)
            left = [one for one in every if one > draft.last]
            done = len(every) - len(left)

            def told(count: int) -> None:
                if progress is not None:
                    progress(f"of {quantity(len(every), 'parameter')}", done + count, len(every))

            for chunk in backup.backup(channel, device, object_, left, told):
                draft.add(chunk)
    except BaseException:
        out.say(f"what was read is in {draft.path}: --resume goes on")
        raise
    return len(every)


def _answer(path: Path, what: tuple[str, int, int], refused: Sequence[str]) -> Answer:
    from plcgen.base.display.data import head
    from plcgen.base.display.results import Answer

    where, object_, count = what
    told = [f"{quantity(count - len(refused), 'parameter')} of {count} read, in {path}"]
    why = Counter(one.partition(" ")[2] for one in refused)
    told += [f"not read: {quantity(number, 'parameter')}, {reason}" for reason, number in sorted(why.items())]
    data = {"address": where, "drive_object": object_, "file": str(path), "parameters": count - len(refused)}
    shown = {**head("live backup", ok=True), "diagnostics": [], **data, "refused": list(refused)}
    return Answer(shown, lambda _view: "\n".join(told) + "\n")
