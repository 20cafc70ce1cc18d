"""Read an S7-200 bus from YAML: stations with their values, faults.

The file is described in docs/s7-200.md. The checks of one key see the keys before it, so that one run finds every
problem, each at its place.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field, ValidationInfo, WithJsonSchema, field_validator
from pydantic_core import PydanticCustomError

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.base.files.options import USAGE, usage
from plcgen.base.files.printed import Name, Printed
from plcgen.base.files.validation import FileShape, Problems, StrictModel, load_document, problem, unique
from plcgen.base.files.yaml import YamlNode, resolve_plain
from plcgen.ppi.sim.bus import Bus
from plcgen.ppi.sim.faults import MOST, FaultKeys
from plcgen.ppi.sim.memory import StationMemory, encode_value
from plcgen.ppi.sim.station import BY_LEVEL, LEAST_PDU, FrameCountRule, Mode, Service, Station, Switch
from plcgen.ppi.wire.address import PpiAddressError, parse_item
from plcgen.ppi.wire.areas import PDU_LIMIT, ReturnCode
from plcgen.ppi.wire.model import Item
from plcgen.ppi.wire.profiles import profile, profiles

BEYOND = "PG724"
FIRST_CPU, FIRST_ADDRESS = "224", 2
"""CPU and address of a station that says nothing."""


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
    given = {"cpu": cpu, "address": address}
    document: FileShape[SingleKeys | BusKeys] = FileShape(
        lambda root: BusKeys if "stations" in root.pairs else SingleKeys,
        "the file",
        "a bus is a mapping with stations, or the keys of a single station",
        "docs/s7-200.md describes it",
        prepare=lambda root: _with_options(root, {key: value for key, value in given.items() if value is not None}),
    )
    return load_document(text, file, document, {"symbols": symbols or {}}).model.bus(symbols or {})


def _with_options(root: YamlNode, given: Mapping[str, Any]) -> YamlNode:
    """Put what the command line says about a single station into its file."""
    if given and "stations" in root.pairs:
        message = "--cpu and --station are for a single station, the file has several"
        raise DiagnosticError([Diagnostic(USAGE, message, root.key_span("stations"))])
    for key, value in given.items():
        place = Span("--station" if key == "address" else f"--{key}")
        root.pairs[key] = (YamlNode("scalar", place, key, key), YamlNode("scalar", place, value, str(value)))
    return root


def set_address(bus: Bus, text: str) -> None:
    """Give an address or symbol a value: ``VW100=1234``, or ``3:VW100=1234`` for station 3. Raises DiagnosticError.

    Without a station the first one is meant. Several elements take numbers with commas: ``VB300[3]=1,2,3``.
    """
    name, equals, value = (part.strip() for part in text.partition("="))
    number, colon, rest = (part.strip() for part in name.partition(":"))
    address = int(number) if colon and number.isascii() and number.isdecimal() and len(number) < 4 else None
    station = next(iter(bus.stations.values())) if not colon else bus.stations.get(-1 if address is None else address)
    if not equals or not name or not value or station is None:
        known = ", ".join(str(number) for number in bus.stations)
        what = "an address and its value are needed" if station is not None else f"there is no station {number}"
        help_ = "for example VW100=1234" if station is not None else f"stations: {known}"
        raise usage(f"--set {text}", what, help_)
    try:
        target = rest if colon else name
        _check_value(station.cpu.memory, target, station.symbols.get(target, target), _typed(value))
        station[target] = _typed(value)
    except PydanticCustomError as wrong:
        words = wrong.context or {}
        raise usage(f"--set {text}", words["message"], words["help"]) from None


def _typed(value: str) -> Any:
    """A value typed behind --set: numbers with commas are a list, as for ``ppi write``."""
    plain = [resolve_plain(piece.strip()) for piece in value.split(",")]
    if len(plain) == 1 or any(isinstance(piece, str) or piece is None for piece in plain):
        return resolve_plain(value)
    return plain


def _cpu(name: object) -> str:
    text = str(name).upper().removeprefix("CPU").strip()
    if not isinstance(name, str | int) or text not in profiles():
        hint = did_you_mean(text, list(profiles())) or f"CPUs: {', '.join(profiles())}"
        raise problem(f'there is no CPU "{name}"', help_=hint)
    return text


_CPUS: dict[str, Any] = {"anyOf": [{"enum": list(profiles())}, {"type": ["string", "integer"]}]}


def _type(text: str) -> str:
    if len(text) > 20 or not text.isascii():
        raise problem("a type is at most 20 ASCII characters")
    return text


def _item(memory: StationMemory, text: str, *, at_key: bool) -> Item:
    try:
        item = parse_item(text)
        code = memory.check(item)
    except PpiAddressError as wrong:
        raise problem(wrong.message, code=wrong.code, help_=wrong.help, at_key=at_key) from None
    if code != ReturnCode.OK:
        sizes = ", ".join(f"{area.name} 0..{size - 1}" for area, size in memory.profile.sizes.items())
        message = f"{text} is beyond the memory of a {memory.profile.title}"
        raise problem(message, code=BEYOND, help_=sizes, at_key=at_key)
    return item


def _check_value(memory: StationMemory, name: str, address: str, value: Any) -> None:
    item = _item(memory, address, at_key=True)
    try:
        encode_value(item, value)
    except ValueError as wrong:
        raise problem(f"{name}: {wrong}") from None


class Password(StrictModel):
    """Key ``password``: what needs one."""

    level: int = Field(1, ge=1, le=4, description="2 to 4 refuse forcing, and writing outputs in STOP, with D602h")
    protects: tuple[Annotated[Service, Field(strict=False)], ...] | None = Field(
        None, description="the services that are refused"
    )

    def services(self) -> frozenset[Service]:
        """Services that are refused."""
        return BY_LEVEL[self.level] if self.protects is None else frozenset(self.protects)


class StationKeys(StrictModel):
    """One station."""

    cpu: Annotated[Name, BeforeValidator(_cpu), WithJsonSchema(_CPUS)] = Field(
        FIRST_CPU, description="decides the sizes of the areas and the text of SYS"
    )
    address: int = Field(FIRST_ADDRESS, ge=0, le=126, description="address on the line")
    mode: Annotated[Mode, Field(strict=False)] = Field(Mode.RUN, description="operating mode")
    switch: Annotated[Switch, Field(strict=False)] = Field(
        Switch.TERM, description="RUN from outside is refused with 8001h while the switch is in STOP"
    )
    type: Annotated[Printed, AfterValidator(_type)] | None = Field(None, description="the first 20 bytes of SYS, ASCII")
    pdu: int = Field(
        PDU_LIMIT, ge=LEAST_PDU, le=PDU_LIMIT, description="longest PDU; a master may negotiate a shorter one"
    )
    not_ready: int = Field(0, ge=0, le=MOST, description="polls of every request that get E5 before the answer")
    frame_count: FrameCountRule = Field("standard", description="what a repeated frame count bit means")
    password: Password = Field(Password(), description="what needs a password")
    write_inputs: bool = Field(default=True, description="false refuses writes to I with 03")
    symbols: dict[Name, Any] = Field(default_factory=dict, description="names of addresses")
    values: dict[Name, Any] = Field(default_factory=dict, description="values by address or symbol")

    @field_validator("symbols")
    @classmethod
    def _have_addresses(cls, symbols: dict[str, Any], info: ValidationInfo) -> dict[str, Any]:
        problems, memory = Problems(), _memory(info)
        for name, address in symbols.items():
            with problems.at(name):
                if not isinstance(address, str):
                    raise problem("an address is a text such as VW100", code="PG106")
                _item(memory, address, at_key=False)
        problems.raise_any()
        return symbols

    @field_validator("values")
    @classmethod
    def _fit(cls, values: dict[str, Any], info: ValidationInfo) -> dict[str, Any]:
        if "symbols" not in info.data:
            return values  # a name might be one of them
        problems, memory = Problems(), _memory(info)
        symbols = {**(info.context or {}).get("symbols", {}), **info.data["symbols"]}
        for name, value in values.items():
            with problems.at(name):
                _check_value(memory, name, symbols.get(name, name), value)
        problems.raise_any()
        return values

    def station(self, symbols: Mapping[str, str]) -> Station:
        """Build the station; ``symbols`` are those of every station."""
        return Station(
            self.cpu,
            self.address,
            values=self.values,
            symbols={**symbols, **self.symbols},
            mode=self.mode,
            switch=self.switch,
            type_=self.type,
            pdu_limit=self.pdu,
            not_ready=self.not_ready,
            frame_count=self.frame_count,
            protected=self.password.services(),
            write_inputs=self.write_inputs,
        )


def _memory(info: ValidationInfo) -> StationMemory:
    """Memory of the station's CPU, of the usual one if the file names none that exists."""
    return StationMemory(profile(info.data.get("cpu", FIRST_CPU)))


def _name_stations(faults: tuple[FaultKeys, ...], known: Iterable[int]) -> tuple[FaultKeys, ...]:
    problems, known = Problems(), list(known)
    for index, fault in enumerate(faults):
        if fault.station is not None and fault.station not in known:
            help_ = f"stations: {', '.join(map(str, known))}"
            problems.add(problem(f"there is no station {fault.station}", help_=help_), index, "station")
    problems.raise_any()
    return faults


class SingleKeys(StationKeys):
    """A file with one station."""

    faults: tuple[FaultKeys, ...] = Field((), description="faults of the line")

    @field_validator("faults")
    @classmethod
    def _strike_it(cls, faults: tuple[FaultKeys, ...], info: ValidationInfo) -> tuple[FaultKeys, ...]:
        return _name_stations(faults, [info.data["address"]]) if "address" in info.data else faults

    def bus(self, symbols: Mapping[str, str]) -> Bus:
        """Build the bus."""
        return Bus([self.station(symbols)], [keys.fault() for keys in self.faults])


class BusKeys(StrictModel):
    """A file with several stations."""

    stations: Annotated[
        tuple[StationKeys, ...], unique("address", "two stations have the address {}", FIRST_ADDRESS)
    ] = Field(min_length=1)
    faults: tuple[FaultKeys, ...] = Field((), description="faults of the line")

    @field_validator("faults")
    @classmethod
    def _strike_one(cls, faults: tuple[FaultKeys, ...], info: ValidationInfo) -> tuple[FaultKeys, ...]:
        stations = info.data.get("stations")
        return faults if stations is None else _name_stations(faults, (keys.address for keys in stations))

    def bus(self, symbols: Mapping[str, str]) -> Bus:
        """Build the bus."""
        return Bus([keys.station(symbols) for keys in self.stations], [keys.fault() for keys in self.faults])
