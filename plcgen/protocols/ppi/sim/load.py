"""Read an S7-200 bus from YAML: stations with their values, faults.

The file is described in docs/s7-200.md. Every problem is collected with its position: PG104 unknown key, PG105 missing
key, PG106 wrong kind of value, PG107 value out of range, PG71x what is no address, PG724 what is beyond the CPU.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from plcgen.diagnostics import Diagnostic, DiagnosticError, Report, Span
from plcgen.diagnostics.suggest import did_you_mean
from plcgen.input.keys import Reader
from plcgen.input.yaml import Node, load_yaml, resolve_plain
from plcgen.protocols.ppi.sim.bus import Bus
from plcgen.protocols.ppi.sim.cpu import BY_LEVEL, Mode, Service, Switch
from plcgen.protocols.ppi.sim.fault_text import read_fault
from plcgen.protocols.ppi.sim.memory import Memory
from plcgen.protocols.ppi.sim.profiles import Profile, profiles
from plcgen.protocols.ppi.sim.station import FrameCountRule, Station
from plcgen.protocols.ppi.sim.values import encode_value
from plcgen.protocols.ppi.wire.address import AddressError, parse_address
from plcgen.protocols.ppi.wire.areas import PDU_LIMIT, ReturnCode

USAGE, BEYOND = "PG901", "PG724"
STATION_KEYS = (
    "cpu", "address", "mode", "switch", "type", "pdu", "not_ready", "frame_count", "password", "write_inputs",
    "experimental", "symbols", "values",
)  # fmt: skip
_FRAME_COUNT: Mapping[Any, FrameCountRule] = {"standard": "standard", "strict": "strict", "ignore": "ignore"}
_MOST = 1_000_000


@dataclass(frozen=True, slots=True)
class _Given:
    """What stands outside the file: CPU and address of a single station, symbols of all."""

    cpu: str | None
    address: int | None
    symbols: Mapping[str, str]


def load_bus(
    text: str,
    file: str = "<bus>",
    cpu: str | None = None,
    address: int | None = None,
    symbols: Mapping[str, str] | None = None,
) -> Bus:
    """Build a bus from YAML text. DiagnosticError with every problem and its position.

    ``cpu`` and ``address`` replace those of a file that describes a single station; ``symbols`` are names of addresses
    for every station, beside those of the file.
    """
    root = load_yaml(text, file)
    report = Report()
    bus = _bus(Reader(root, report, "the bus"), _Given(cpu, address, symbols or {}))
    report.raise_on_errors()
    return bus


def assign(bus: Bus, text: str) -> None:
    """Give an address or symbol a value: ``VW100=1234``, or ``3:VW100=1234`` for station 3. Raises DiagnosticError.

    Without a station the first one is meant. Several elements take numbers with commas: ``VB300[3]=1,2,3``.
    """
    option = Span(f"--set {text}")
    name, equals, value = (part.strip() for part in text.partition("="))
    number, colon, rest = (part.strip() for part in name.partition(":"))
    address = int(number) if colon and number.isascii() and number.isdecimal() and len(number) < 4 else None
    station = next(iter(bus.stations.values())) if not colon else bus.stations.get(-1 if address is None else address)
    if not equals or not name or not value or station is None:
        known = ", ".join(str(number) for number in bus.stations)
        what = "an address and its value are needed" if station is not None else f"there is no station {number}"
        help_ = "for example VW100=1234" if station is not None else f"stations: {known}"
        raise DiagnosticError([Diagnostic(USAGE, what, option, help=help_)])
    node = Node("map", option)
    node.pairs[rest if colon else name] = (Node("scalar", option), _typed(value, option))
    report = Report()
    _values(Reader(node, report, "the values"), station)
    if report.has_errors:
        raise DiagnosticError([Diagnostic(USAGE, found.message, option, help=found.help) for found in report])


def _typed(value: str, option: Span) -> Node:
    """The node of a value typed behind --set: numbers with commas are a list, as for ``ppi write``."""
    pieces = [piece.strip() for piece in value.split(",")]
    plain = [resolve_plain(piece) for piece in pieces]
    if len(pieces) == 1 or any(isinstance(piece, str) or piece is None for piece in plain):
        return Node("scalar", option, resolve_plain(value), value)
    node = Node("seq", option)
    node.items.extend(Node("scalar", option, *pair) for pair in zip(plain, pieces, strict=True))
    return node


def _bus(reader: Reader, given: _Given) -> Bus:
    if reader.node.get("stations") is not None:
        reader.only("stations", "faults")
        if given.cpu is not None or given.address is not None:
            where = reader.node.key_span("stations")
            reader.error(USAGE, "--cpu and --station are for a single station, the file has several", where)
        stations = [_station(child, given) for child in reader.children("stations", "a station")]
        if not stations:
            reader.error("PG105", "a bus needs at least one station", reader.node.key_span("stations"))
    else:
        reader.what = "the station"
        reader.only(*STATION_KEYS, "faults")
        stations = [_station(reader, given)]
    addresses = [station.address for station in stations]
    faults = [read_fault(child, addresses) for child in reader.children("faults", "a fault")]
    bus = Bus((), faults)
    for station in stations:
        if station.address in bus.stations:
            reader.error("PG107", f"two stations have the address {station.address}", reader.node.key_span("stations"))
        else:
            bus.add(station)
    return bus


def _station(reader: Reader, given: _Given) -> Station:
    if reader.node.get("faults") is None:
        reader.only(*STATION_KEYS)
    chosen = _profile(reader, given.cpu)
    station = Station(
        chosen.key,
        reader.number("address", 2, 0, 126) if given.address is None else given.address,
        mode=reader.choice("mode", Mode.RUN, {mode.value: mode for mode in Mode}),
        switch=reader.choice("switch", Switch.TERM, {switch.value: switch for switch in Switch}),
        type_=_type(reader),
        pdu_limit=reader.number("pdu", PDU_LIMIT, 32, PDU_LIMIT),
        not_ready=reader.number("not_ready", 0, 0, _MOST),
        frame_count=reader.choice("frame_count", "standard", _FRAME_COUNT),
        protected=_protected(reader.child("password", "the password")),
        write_inputs=reader.flag("write_inputs", default=True),
        experimental=reader.flag("experimental"),
    )
    station.symbols.update(given.symbols)
    station.symbols.update(_symbols(reader.child("symbols", "the key symbols"), station.cpu.memory))
    _values(reader.child("values", "the key values"), station)
    return station


def _profile(reader: Reader, cpu: str | None) -> Profile:
    known = profiles()
    node = reader.node.get("cpu")
    name = cpu if cpu is not None else "224" if node is None else str(node.raw or node.value)
    found = known.get(name.upper().removeprefix("CPU").strip())
    if found is None:
        span = reader.node.span if node is None else node.span
        hint = did_you_mean(name.upper(), list(known))
        reader.error("PG107", f'there is no CPU "{name}"', span, hint or f"CPUs: {', '.join(known)}")
        return known["224"]
    return found


def _type(reader: Reader) -> str | None:
    node = reader.node.get("type")
    text = reader.text("type")
    if node is not None and (len(text) > 20 or not text.isascii()):
        reader.error("PG107", f'"type" of {reader.what} is at most 20 ASCII characters', node.span)
    return text if node is not None else None


def _protected(reader: Reader) -> frozenset[Service]:
    reader.only("level", "protects")
    level = reader.number("level", 1, 1, 4)
    if reader.node.get("protects") is None:
        return BY_LEVEL[level]
    known = {service.value: service for service in Service}
    found = set()
    for node in reader.items("protects"):
        if node.value in known:
            found.add(known[str(node.value)])
        else:
            reader.error("PG107", f'"{node.raw}" cannot be protected', node.span, f"services: {', '.join(known)}")
    return frozenset(found)


def _symbols(reader: Reader, memory: Memory) -> dict[str, str]:
    if reader.node.kind != "map":
        reader.only()
        return {}
    found = {}
    for name, (_, node) in reader.node.pairs.items():
        if _known(reader, str(node.raw), node.span, memory):
            found[name] = str(node.raw)
    return found


def _known(reader: Reader, text: str, span: Span, memory: Memory) -> bool:
    """Whether an address makes sense and the CPU has it; problems go to the report."""
    try:
        code = memory.check(parse_address(text))
    except AddressError as problem:
        reader.error(problem.code, problem.message, span, problem.help)
        return False
    if code != ReturnCode.OK:
        reader.error(BEYOND, f"{text} is beyond the memory of a {memory.profile.title}", span, _sizes(memory.profile))
    return code == ReturnCode.OK


def _sizes(profile: Profile) -> str:
    return ", ".join(f"{area.name} 0..{size - 1}" for area, size in profile.sizes.items())


def _values(reader: Reader, station: Station) -> None:
    if reader.node.kind != "map":
        reader.only()
        return
    for name, (key, node) in reader.node.pairs.items():
        address = station.symbols.get(name, name)
        if not _known(reader, address, key.span, station.cpu.memory):
            continue
        item = station.item(name)
        try:
            station.cpu.memory.put(item, encode_value(item, _plain(node)))
        except ValueError as problem:
            reader.error("PG107", f"{name}: {problem}", node.span)


def _plain(node: Node) -> Any:
    data = node.data()
    return list(data) if isinstance(data, tuple) else data
