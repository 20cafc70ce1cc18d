"""Search of the catalogue: parameters and messages of the drives of a spec, and why nothing was found."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING

from plcgen.ds47 import lists, messages
from plcgen.ds47.lookup import message_lines
from plcgen.ds47.references import parse_reference, split_bit
from plcgen.ppi.wire.address import PpiAddressError, address_text, parse_item
from plcgen.workbench.service.specs.drives import KnownDrive, drives_at, in_full, in_short, known_drive, spelled
from plcgen.workbench.service.specs.state import matches
from plcgen.workbench.service.specs.stations import symbols_at

if TYPE_CHECKING:
    from plcgen.ds47.device import Parameter
    from plcgen.ds47.messages import Message
    from plcgen.workbench.service.specs.state import SpecState

MOST = 60
"""Parameters, and messages, that a search shows."""
GERMAN = {
    "antriebsobjekt": "drive object", "bremse": "brake", "drehmoment": "torque", "drehzahl": "speed",
    "frequenz": "frequency", "geber": "encoder", "grenze": "limit", "hochlaufzeit": "ramp-up time",
    "istwert": "actual value", "leistung": "power", "motortemperatur": "motor temperature", "rampe": "ramp",
    "rücklaufzeit": "ramp-down time", "sollwert": "setpoint", "spannung": "voltage", "strom": "current",
    "störung": "fault", "temperatur": "temperature", "warnung": "alarm", "zwischenkreisspannung": "DC link voltage",
}  # fmt: skip
"""German words for what the English titles of the lists name most often (terms of the trade)."""
_MESSAGE = re.compile(r"([FANC])0*([0-9]{1,5})\Z", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class FoundParameter:
    """A parameter of a device: how a spec writes it, title with unit and limits, whether a job may write it.

    ``danger`` says why that needs a sign-off; ``facts`` are headings with texts.
    """

    parameter: str
    text: str
    device: str
    writable: bool
    danger: str
    facts: list[tuple[str, str]]


@dataclass(frozen=True, slots=True)
class FoundMessage:
    """A message of a device: its name as the lists print it, title, and class, reaction and acknowledgement."""

    key: str
    title: str
    device: str
    text: str


@dataclass(frozen=True, slots=True)
class NotFound:
    """Why nothing of a device was found, and what can be done all the same."""

    device: str
    why: str
    help: str


@dataclass(frozen=True, slots=True)
class Search:
    """What was found, each part in the order of numbers; ``more``: there is more of it than is shown."""

    parameters: tuple[FoundParameter, ...]
    messages: tuple[FoundMessage, ...]
    nothing: tuple[NotFound, ...]
    more: bool


def search(state: SpecState, place: Sequence[str], words: str) -> Search:
    """Parameters and messages by number, name or words of their titles: of the drives of a job or recipe, or of all.

    ``place`` are the keys to the job or recipe; empty for all drives. Of a job of a station: addresses, symbols.
    """
    if matches(place, ("ppi", "*", "jobs", "*")):
        return Search(tuple(_items(state, tuple(place), words.strip())), (), (), more=False)
    words = " ".join(GERMAN.get(word.casefold(), word) for word in words.split())
    keys = [key for pattern in (("drives",), ("units", "*", "drives")) for _, key in state.names(*pattern)]
    known = drives_at(state, tuple(place)) if place else [one for key in keys if (one := known_drive(state, key))]
    by_device = {(drive.device.key, drive.object_type): drive for drive in reversed(known)}
    drives = list(by_device.values())[::-1]
    parameters: dict[int, FoundParameter] = {}
    told: dict[tuple[str, str], FoundMessage] = {}
    nothing: dict[str, NotFound] = {}
    for drive in drives if words else ():
        here = list(islice(_parameters(drive, words), MOST + 1))
        for parameter in here:
            parameters.setdefault(parameter.pnu, _shown(drive, parameter))
        those = list(islice(_messages(drive, words), MOST + 1))
        for message in those:
            key = drive.device.key
            told.setdefault((message.name, key), FoundMessage(message.name, message.title, key, _lines(message)))
        if not here and not those:
            nothing.setdefault(drive.device.key, _nothing(drive, words))
    more = len(parameters) > MOST or len(told) > MOST
    return Search(tuple(parameters.values())[:MOST], tuple(told.values())[:MOST], tuple(nothing.values()), more)


def _items(state: SpecState, place: tuple[str, ...], words: str) -> Iterator[FoundParameter]:
    """The address that was typed, then symbols of the station with the words in their names or comments."""
    line, station = place[1], state.sketch.value(*place, "station")
    try:
        item = address_text(parse_item(words))
    except PpiAddressError:
        item = ""
    if item:
        yield FoundParameter(item, f"{line} / {station}", station, writable=True, danger="", facts=[])
    for one in symbols_at(state, (*place, "read")) if words else ():
        if words.casefold() in f"{one.name} {one.address} {one.comment}".casefold():
            text = f"{one.address} {one.comment}".strip()
            yield FoundParameter(one.name, text, station, writable=True, danger="", facts=[])


def _parameters(drive: KnownDrive, words: str) -> Iterator[Parameter]:
    """The one that is meant by number or name, then those that begin so, or have the words in their titles."""
    exact = drive.find(words)
    if exact is not None:
        yield exact
    yield from (one for one in drive.matching(words) if exact is None or one.pnu != exact.pnu)


def _shown(drive: KnownDrive, one: Parameter) -> FoundParameter:
    writable = "w" in one.access
    danger = drive.device.danger(one.pnu, object_type=drive.object_type) if writable else ""
    facts = [("Sign-off", danger), *in_full(one)]
    known = [(name, text) for name, text in facts if text]
    return FoundParameter(spelled(one), in_short(one), drive.device.key, writable, danger, known)


def _messages(drive: KnownDrive, words: str) -> Iterator[Message]:
    """Messages by their number, by its beginning (``F300``), or by words of the title."""
    name, begun, families = messages.named(words), _MESSAGE.match(words), drive.device.messages
    if name is not None:
        yield from messages.find(name[1], families, name[0])
    wanted = words.casefold().split()
    for one in messages.all_messages(families) if begun is not None or len(words) > 2 else ():
        if begun is not None:
            fits = begun[1].upper() in {one.kind, *one.also} and str(one.number).startswith(begun[2])
        else:
            fits = all(word in one.title.casefold() for word in wanted)
        if fits:
            yield one


def _lines(message: Message) -> str:
    return "\n".join(message_lines(message))


_NO_LIST = (
    "type the number and the type that its manual has; what comes up often belongs into a profile of your own "
    "(device: ./acme.yaml, plcgen catalogue import)"
)
_OTHER_WORDS = "search by other words (titles are in English), or by the number that its manual has"


def _nothing(drive: KnownDrive, words: str) -> NotFound:
    """What was searched, and what the device has not got: a message, a number, words."""
    device = drive.device
    if messages.named(words) is not None or _MESSAGE.match(words) is not None:
        why = "its lists of messages have no such number" if device.messages else "no list of its messages is known"
        return NotFound(device.key, f"{device.title}: {why}", "look it up in the manual of the drive")
    sources = ", ".join(dict.fromkeys(lists.source(one.name) for one in device.lists))
    count = len(device.parameters)
    searched = f"the {count} parameters of its profile" + (f" and {sources}" if sources else "; no list of it is known")
    bit = split_bit(words)
    reference = parse_reference(bit[0] if bit else words)
    if reference is None or reference.pnu is None:
        why = f'{device.title}: no title has "{words}" (searched: {searched})'
        return NotFound(device.key, why, _OTHER_WORDS if sources else _NO_LIST)
    number = f"P{reference.pnu}"
    said = device.absent(reference.pnu, drive.object_type)
    if said:
        return NotFound(device.key, f"{device.title} has no {number}: {said[0]}", "the drive would answer error 00h")
    why = f"{device.title}: {number} is unknown (searched: {searched})"
    help_ = (
        f"look it up in its manual: a single value can be read without a type, read: [{number}]; to write it, "
        f"define it in the drive: parameters: {{{number}: {{type: ..}}}}"
    )
    return NotFound(device.key, why, help_)
