"""Parameters and values on the command line: ``P50303``, ``P2155[1..2]``, ``P50304=100.0:FloatingPoint``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.cli.arguments import Argument
from plcgen.ds47.references import Reference, parse_reference, parse_type
from plcgen.ds47.wire import formats
from plcgen.ds47.wire.bico import Layout, parse_bico
from plcgen.ds47.wire.formats import Format, FormatKind, FormatValueError, Value
from plcgen.ds47.wire.model import ParameterAddress, ValueBlock

if TYPE_CHECKING:
    from plcgen.ds47.device import Device


def device_named(key: str | None) -> Device | None:
    """Return the profile of ``--device``, a name or a file. Raises DiagnosticError if there is none."""
    from plcgen.ds47 import devices

    return None if key is None else devices.find_device(key)


def parameter_address(
    argument: Argument, text: str, device: Device | None, count: int | None = None
) -> ParameterAddress:
    """Read one parameter reference; ``count`` values are written to it, None means it is read."""
    reference = parse_reference(text)
    if reference is None:
        raise argument.problem(
            "PG703", f'"{text}" is not a parameter', "write a number, such as P1120, P2155[1..2] or 1120"
        )
    pnu = _number(argument, reference, device)
    if not 1 <= pnu <= 65535:
        raise argument.problem("PG703", f"parameter number {pnu} is outside 1..65535")
    if reference.first is None or reference.last is None:
        scalar = _elements(pnu, device, write=count is not None)
        return ParameterAddress(pnu, 0, scalar if count in {None, 1} else count or 1)
    values = reference.last - reference.first + 1
    if values < 1 or reference.last > 0xFFFE:
        raise argument.problem("PG703", f'"{text}": the index range is empty or over 65534')
    return ParameterAddress(pnu, reference.first, values)


def _elements(pnu: int, device: Device | None, *, write: bool) -> int:
    """Number of elements of a parameter without an index: the octets of a string, else what the device has."""
    if device is None:
        return 1
    known = device.find(pnu)
    split = parse_type(known.type) if known is not None and known.type else None
    return split[1] if split and split[1] and not write else device.scalar_elements[1 if write else 0]


def _number(argument: Argument, reference: Reference, device: Device | None) -> int:
    if reference.pnu is not None:
        return reference.pnu
    found = device.by_name(reference.name) if device is not None else None
    if found is None:
        known = [p.name for p in device.parameters.values() if p.name] if device else []
        hint = did_you_mean(reference.name, known) or "use its number, or --device for names"
        raise argument.problem("PG703", f'unknown parameter "{reference.name}"', hint)
    return found.pnu


def change(argument: Argument, device: Device | None) -> tuple[ParameterAddress, ValueBlock]:
    """Read ``P50304=100.0:FloatingPoint``; with a device from the catalogue the type may be left out."""
    name, equals, rest = argument.text.partition("=")
    if not equals or not rest:
        raise argument.problem("PG703", f'"{argument.text}" has no value', "P50304=100.0:FloatingPoint")
    text, type_ = _split(rest)
    place = parameter_address(argument, name, device)
    if type_ is None:
        known = device.find(place.pnu) if device is not None else None
        if known is None or not known.type:
            example = f"{argument.text}:{'Unsigned32' if parse_bico(text) else 'FloatingPoint'}"
            raise argument.problem("PG703", f'the data type of "{name}" is missing', example)
        type_ = known.type.partition("[")[0]
    fmt = _format(argument, type_)
    block = _block(argument, text, fmt, "drive-object" if device is None else device.bico)
    indexed = "[" in name
    asked = place.elements
    if indexed and block.count != asked and not fmt.is_string:
        raise argument.problem("PG703", f"{block.count} values for {asked} elements")
    return parameter_address(argument, name, device, None if indexed else block.count), block


def _split(rest: str) -> tuple[str, str | None]:
    """Separate value and type at the last colon, if what follows looks like a type."""
    value, colon, type_ = rest.rpartition(":")
    if colon and type_[:1].isalpha() and type_.isalnum():
        return value, type_
    return rest, None


def _format(argument: Argument, name: str) -> Format:
    names = [f.name for f in formats.FORMATS if f.writable]
    try:
        fmt = formats.by_name(name)
    except KeyError:
        fmt = None
    if fmt is None or not fmt.writable:
        hint = f"{did_you_mean(name, names)} data types: {', '.join(names)}".strip()
        raise argument.problem("PG703", f'"{name}" is not a DS47 data type', hint)
    return fmt


def _block(argument: Argument, text: str, fmt: Format, layout: Layout) -> ValueBlock:
    try:
        pieces = [text] if fmt.is_string else text.split(",")
        return ValueBlock.of(fmt, [_value(piece.strip(), fmt, layout) for piece in pieces])
    except (FormatValueError, ValueError) as problem:
        raise argument.problem("PG703", str(problem)) from problem


def _value(text: str, fmt: Format, layout: Layout) -> Value:
    """Read one value: S7 and YAML numbers, ``true``, BICO sources for Unsigned32, hex for octets."""
    from plcgen.base.files.yaml import resolve_plain

    if fmt.kind is FormatKind.TEXT:
        return text
    if fmt.kind in {FormatKind.OCTETS, FormatKind.OPAQUE}:
        return bytes.fromhex(text)
    value = resolve_plain(text)
    if isinstance(value, str) and fmt.name in {"Unsigned32", "DoubleWord"}:
        source = parse_bico(value)
        value = (source and source.within(layout)) or value
    if value is None or isinstance(value, str):
        raise FormatValueError(f'"{text}" is not a value of type {fmt.name}')
    return value
