"""What a job that writes reads besides: what it has written, and the old values in front of it, to restore them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from plcgen.ds47.kind import Items, ReadItem
from plcgen.ds47.plan.access import Remember, Running, Use, Verify
from plcgen.ds47.plan.uses import UseResolver
from plcgen.ds47.schema import ErrorSettings
from plcgen.ds47.wire.formats import FormatKind
from plcgen.project.spec import SpecPath
from plcgen.s7.types.names import shorten

STATE = 899
"""Status word of the sequence control: its bits 2 and 11 say that the drive runs."""


def read_back(uses: tuple[Use, ...], items: Items, resolver: UseResolver) -> Iterator[Use]:
    """A read of everything that is written, in the same order."""
    for position, (use, found) in enumerate(_read(uses, items, resolver, "Back"), len(uses) + 1):
        yield replace(found, position=position, role=Verify(use))


def _read(uses: tuple[Use, ...], items: Items, resolver: UseResolver, what: str) -> Iterator[tuple[Use, Use]]:
    """What is written, and a read of it whose name ends with ``what``."""
    for use, item in zip(uses, items, strict=True):
        if not use.writes:
            continue
        name = shorten(f"{use.member}{what}", resolver.longest_name)
        again = ReadItem.model_validate({"parameter": item.parameter, "type": item.type, "as": name})
        found = resolver.resolve(again, use.position, use.path, write=False)
        if found is not None:
            yield use, found


def transaction(
    uses: tuple[Use, ...], items: Items, settings: ErrorSettings, path: SpecPath, resolver: UseResolver
) -> tuple[Use, ...]:
    """Old values, what is written, what is read back: ``uses`` are the written ones; none after PG257.

    The state of the drive is read with the old values and with those that are read back.
    """
    stopped = settings.restore == "stopped"
    asked = _state("stateBefore", path, resolver) if stopped else None
    again = _state("stateBack", path, resolver) if asked is not None else None
    if stopped and again is None:
        return ()
    states = [one for one in (asked, again) if one is not None]
    front = len(uses) + len(states[:1])
    written = tuple(replace(use, position=front + n) for n, use in enumerate(uses, 1))
    olds = [replace(found, role=Remember(use)) for use, found in _read(written, items, resolver, "Before")]
    found = (*olds, *states[:1], *written, *read_back(written, items, resolver), *states[1:])
    return tuple(replace(use, position=n) if not use.writes else use for n, use in enumerate(found, 1))


def _state(name: str, path: SpecPath, resolver: UseResolver) -> Use | None:
    """A read of the word that says whether the drive runs; None after PG257 if nobody has looked up what it is."""
    known = resolver.known.get(STATE)
    place = (*path, "on_error")
    if known is not None and known.type and known.grades.get("type", "read") != "recalled":
        item = ReadItem.model_validate({"parameter": f"r{STATE}", "as": name})
        found = resolver.resolve(item, 0, place, write=False)
        if found is None or (found.format.kind is FormatKind.UNSIGNED and found.format.size > 1):
            return None if found is None else replace(found, role=Running())
        problem = f"is {known.type}{known.doubt('type')}: the bits that say whether the drive runs are in a word"
    else:
        problem = "has not been looked up: it is not known whether it shows that the drive runs"
    help_ = f"look it up in the list manual and define it in the drive: parameters: {{r{STATE}: {{type: Unsigned16}}}}"
    message = f"r{STATE} of {resolver.device.key} {problem}"
    resolver.problem("PG257", message, place, f"{help_}; or sign off restoring while the drive runs")
    return None
