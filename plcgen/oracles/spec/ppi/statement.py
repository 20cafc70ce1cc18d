"""What the ``ppi`` section of a spec demands of every job, read from plain mappings.

Written from docs/ppi-master.md, docs/ppi.md and docs/spec.md by somebody who had not seen how plcgen plans a job.
``path`` of a statement is where it stands in the spec: keys and positions from the top.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from math import ceil
from typing import Any

from plcgen.oracles.spec.place import Keys, NotStatedError, texts
from plcgen.oracles.spec.ppi.stations import AREAS, ELEMENTS, READ, RUN, STOP, WRITE, Extent, Number, to_bytes

Texts = Mapping[str, bytes]

_UNITS = {"ms": 1, "s": 1000, "min": 60_000, "h": 3_600_000}
_GERMAN = {"E": "I", "A": "Q", "AE": "AI", "AA": "AQ", "Z": "C"}
_ADDRESS = re.compile(
    r"(?:(?:(?P<block>DB1\.DB)|(?P<area>AE|AI|AA|AQ|SM|[VMIEQAS]))(?P<size>[XBWD])?(?P<at>\d+)(?:\.(?P<bit>[0-7]))?"
    r"|(?P<counted>HC|T|C|Z)(?P<number>\d+)|(?P<system>SYS))(?:\[(?P<count>\d+)\])?"
)
_SIZES = {"B": 1, "W": 2, "D": 4}
_TYPES = {"B": "BYTE", "W": "WORD", "D": "DWORD"}
_COUNTED = {"T": "DINT", "C": "INT", "HC": "DINT"}
SYSTEM_TEXT = 20
"""Characters of the CPU type in SYS."""
# Settings of docs/ppi-master.md that a spec need not name.
RETRIES, RETRY_PAUSE, POLLS, POLL_PAUSE, TIMEOUT, OB1_CYCLE, BAUD = 3, 50, 10, 20, 10_000, 50, 9600
SHORTEST_ACK, ACK_MARGIN, SHORTEST_REPLY, REPLY_MARGIN = 250, 50, 600, 150
CHARACTER_BITS, GAP_BITS, LONGEST_MESSAGE = 11, 35, 512
SERVICES = {"read": READ, "write": WRITE, "run": RUN, "stop": STOP}


@dataclass(frozen=True)
class StatedAddress:
    """One address of a job.

    ``name`` is what the spec calls it: ``given`` as the member itself (``as``), else ``label``, a symbol or an address.
    ``kind`` is the S7 type of each of ``count`` elements (0: no array), at ``places``. ``constant`` and ``start`` are
    numbers, None where the spec has none.
    """

    text: str
    name: str
    given: bool
    kind: str
    count: int
    places: tuple[Extent, ...]
    constant: Number | None
    start: Number
    path: Keys
    label: str = ""
    comments: frozenset[str] = frozenset()

    @property
    def whole(self) -> Extent:
        """All of its elements."""
        first, last = self.places[0], self.places[-1]
        return Extent(first.area, first.first, last.cells.stop - first.first)

    def octets(self, numbers: Sequence[Number]) -> bytes:
        """The bytes of numbers for its elements."""
        return b"".join(to_bytes(number, self.kind) for number in numbers)


@dataclass(frozen=True)
class PpiStatement:
    """What a job does: one service on one station. ``cycle`` in ms, None without one; ``flags`` by signal."""

    key: str
    station: int
    service: int
    values: tuple[StatedAddress, ...]
    cycle: int | None
    timeout: int
    merged: bool
    flags: Mapping[str, str]
    path: Keys
    comments: frozenset[str] = frozenset()

    @property
    def inputs(self) -> tuple[StatedAddress, ...]:
        """What the user of the job supplies."""
        return tuple(v for v in self.values if self.service == WRITE and v.constant is None)

    @property
    def outputs(self) -> tuple[StatedAddress, ...]:
        """What the user of the job gets."""
        return self.values if self.service == READ else ()


@dataclass(frozen=True)
class StatedPort:
    """A port with its jobs; times in ms, ``ack_timeout`` and ``reply_timeout`` None where they are computed."""

    key: str
    module: str
    port: int
    own_address: int
    baud: int
    stations: Mapping[str, int]
    jobs: tuple[PpiStatement, ...]
    ob1_cycle: int
    ack_timeout: int | None
    reply_timeout: int | None
    retries: int
    retry_pause: int
    polls: int
    poll_pause: int
    path: Keys
    comments: frozenset[str] = frozenset()

    @property
    def classic(self) -> bool:
        """Whether the module is a CP 341, which is set up in the hardware configuration."""
        return self.module == "cp341"

    def ack_wait(self) -> int:
        """How long E5 is waited for."""
        return self.ack_timeout or max(SHORTEST_ACK, _in_tens(self._heard(1) + ACK_MARGIN))

    def reply_wait(self, longest: int) -> int:
        """How long a reply is waited for if the longest one has so many bytes."""
        return self.reply_timeout or max(SHORTEST_REPLY, _in_tens(self._heard(longest) + REPLY_MARGIN))

    def _heard(self, octets: int) -> int:
        """Characters, gap, and as many cycles of OB1 as the blocks take calls, plus one.

        Two calls on a CM (TIA information system, "Overview of Freeport communication"); on a CP 341 three for up to
        32 bytes and one for every 32 more (A5E02191071-01, table 6-15).
        """
        calls = 2 + ceil(octets / 32) if self.classic else 2
        characters = ceil(octets * CHARACTER_BITS * 1000 / self.baud)
        return characters + ceil(GAP_BITS * 1000 / self.baud) + (calls + 1) * self.ob1_cycle


def stated_ports(spec: Mapping[str, Any], files: Texts) -> Iterator[StatedPort]:
    """Every master of a spec; ``files`` are the symbol tables that it names. Raises NotStatedError."""
    for key, said in spec["ppi"].items():
        path: Keys = ("ppi", key)
        symbols = {name: _symbols(one.get("symbols"), files) for name, one in said["stations"].items()}
        stations = {name: int(one["address"]) for name, one in said["stations"].items()}
        jobs = tuple(
            _job(name, one, stations[one["station"]], symbols[one["station"]], (*path, "jobs", name))
            for name, one in said["jobs"].items()
        )
        yield StatedPort(
            key=key,
            module=said["module"],
            port=int(said.get("port") or said["address"]),
            own_address=int(said.get("own_address", 0)),
            baud=int(said.get("baud", BAUD)),
            stations=stations,
            jobs=jobs,
            ob1_cycle=_ms(said.get("ob1_cycle"), OB1_CYCLE),
            ack_timeout=_ms(said.get("ack_timeout"), 0) or None,
            reply_timeout=_ms(said.get("reply_timeout"), 0) or None,
            retries=int(said.get("retries", RETRIES)),
            retry_pause=_ms(said.get("retry_pause"), RETRY_PAUSE),
            polls=int(said.get("polls", POLLS)),
            poll_pause=_ms(said.get("poll_pause"), POLL_PAUSE),
            path=path,
            comments=texts(said.get("comment")),
        )


def _in_tens(time: int) -> int:
    """The next full ten milliseconds."""
    return 10 * ceil(time / 10)


def _ms(text: str | None, default: int) -> int:
    """A time such as ``500ms``, ``10s``, ``2min``."""
    if text is None:
        return default
    found = re.fullmatch(r"(\d+)(ms|s|min|h)", str(text).replace(" ", ""))
    if found is None:
        raise NotStatedError(f"{text} is no time")
    return int(found[1]) * _UNITS[found[2]]


def _job(key: str, said: Mapping[str, Any], station: int, symbols: Mapping[str, str], path: Keys) -> PpiStatement:
    verb = next(verb for verb in SERVICES if said.get(verb) is not None)
    values = tuple(_values(said[verb], symbols, (*path, verb))) if verb in ("read", "write") else ()
    trigger = said.get("trigger") or {}
    return PpiStatement(
        key=key,
        station=station,
        service=SERVICES[verb],
        values=values,
        cycle=_ms(said["cycle"], 0) if said.get("cycle") is not None else None,
        timeout=_ms(said.get("timeout"), TIMEOUT),
        merged=bool(said.get("merge", True)),
        flags={"execute": trigger} if isinstance(trigger, str) else {k: v for k, v in trigger.items() if v},
        path=path,
        comments=texts(said.get("comment")),
    )


def _values(said: Any, symbols: Mapping[str, str], path: Keys) -> Iterator[StatedAddress]:
    """Addresses in any of their forms: a text, a list of texts and long forms, address and value."""
    if isinstance(said, str):
        said = [said]
    if isinstance(said, Mapping):
        listed: list[Any] = [{"item": k, **(v if isinstance(v, Mapping) else {"value": v})} for k, v in said.items()]
    else:
        listed = [{"item": one} if isinstance(one, str) else one for one in said]
    for number, one in enumerate(listed):
        yield _value(one, symbols, (*path, number))


def _value(said: Mapping[str, Any], symbols: Mapping[str, str], path: Keys) -> StatedAddress:
    text = str(said["item"])
    symbol = symbols.get(text.casefold())
    places, default, count = _places(symbol or text)
    kind = str(said.get("type") or default).upper()
    constant, start = (_number(said.get(key), kind) for key in ("value", "start"))
    label = text if symbol else _standard_name(text)
    begins = start if start is not None else ord(" ") if kind == "CHAR" else 0
    name = said.get("as")
    said_of = texts(said.get("comment"))
    own = str(name or label), bool(name)
    return StatedAddress(text, *own, kind, count, places, constant, begins, path, label, said_of)


def _number(said: Any, kind: str) -> Number | None:
    """A constant as a number; a character is the number of its octet in Windows-1252."""
    if said is None:
        return None
    if isinstance(said, str):
        if kind != "CHAR" or len(said) != 1:
            raise NotStatedError(f"{said!r} is no {kind}")
        return said.encode("cp1252")[0]
    return float(said) if kind == "REAL" else int(said)


def _standard_name(text: str) -> str:
    """What an address is called: international mnemonics, V instead of DB1, without a count."""
    found = _parsed(text)
    if found["system"]:
        return "SYS0"
    if found["counted"]:
        return _GERMAN.get(found["counted"], found["counted"]) + found["number"]
    bit = f"_{found['bit']}" if found["bit"] else ""
    size = "" if bit or found["size"] in (None, "X") else found["size"]
    return f"{_area(found)}{size}{found['at']}{bit}"


def _parsed(text: str) -> Mapping[str, str]:
    found = _ADDRESS.fullmatch(text.strip().lstrip("%").replace(" ", "").upper())
    if found is None:
        raise NotStatedError(f"{text} is neither a symbol nor an address")
    return found.groupdict()


def _area(found: Mapping[str, str]) -> str:
    return "V" if found["block"] else _GERMAN.get(found["area"], found["area"])


def _places(text: str) -> tuple[tuple[Extent, ...], str, int]:
    """Place of every element, the type if none is given, and the number of elements (0: no array)."""
    found = _parsed(text)
    count = int(found["count"] or 0)
    count = 0 if count == 1 else count
    if found["system"]:
        count = count or SYSTEM_TEXT
        return tuple(Extent(AREAS["SYS"], 8 * n, 8) for n in range(count)), "CHAR", count
    if found["counted"]:
        name = _GERMAN.get(found["counted"], found["counted"])
        first = int(found["number"])
        return tuple(Extent(AREAS[name], n, 1) for n in range(first, first + max(1, count))), _COUNTED[name], count
    area, at = AREAS[_area(found)], int(found["at"])
    if found["bit"]:
        return (Extent(area, 8 * at + int(found["bit"]), 1),), "BOOL", 0
    size = _SIZES[found["size"]]
    places = tuple(Extent(area, 8 * (at + size * n), 8 * size) for n in range(max(1, count)))
    return places, _TYPES[found["size"]], count


def element_octets(place: Extent) -> int:
    """Bytes of the value at a place."""
    return ELEMENTS[place.area] if place.counted else max(1, place.length // 8)


def _symbols(said: str | Mapping[str, str] | None, files: Texts) -> Mapping[str, str]:
    """Addresses by symbols, which are the same in capitals."""
    if said is None:
        return {}
    rows = _table(files[said]) if isinstance(said, str) else said.items()
    return {name.strip().casefold(): address for name, address in rows}


def _table(data: bytes) -> Iterator[tuple[str, str]]:
    """Rows of a symbol table of STEP 7-Micro/WIN whose second column is an address."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        text = data.decode("utf-16")
    else:
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = data.decode("cp1252")
    lines = text.splitlines()
    sample = "\n".join(islice(lines, 5))
    separator = max("\t;,", key=sample.count)
    for row in csv.reader(lines, delimiter=separator):
        cells = [cell.strip() for cell in row]
        if len(cells) > 1 and _ADDRESS.fullmatch(cells[1].lstrip("%").upper()):
            yield cells[0], cells[1]
