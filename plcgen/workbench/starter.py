"""The text of a commented starter spec: jobs that most projects begin with, for what a device is known to have."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from plcgen.s7.types.system import FAMILIES

if TYPE_CHECKING:
    from plcgen.ds47.device import Device, Parameter


_HEAD = """\
# A job spec of plcgen. Check it with    plcgen check {file}
# and make the PLC sources with          plcgen generate {file}
# All keys, for your editor:             plcgen schema

plc:
  name: My station
  family: {family} | {families}
  toolchain: {toolchain} | step7-v5, tia-v13sp1, tia-v14 .. tia-v21
  # names: faq | member names as in Siemens FAQ 109750712; default: style guide
  # languages: [en-US, de-DE] | languages of comments, the first is the main one

drives:
  drive1:
    device: {device} | {title}; others: plcgen devices
    {address} | {address_hint}: plcgen explain hardware-id
    drive_object: {drive_object} | {rule}

jobs:
"""
_MORE = {
    False: """\
    # - P1234[0..3] | an array: indexes 0 to 3
    # - {parameter: P1234, type: Unsigned16} | a parameter that the catalogue does not know
""",
    True: """\
      # P1234[0..1]: [1.0, 2.0] | an array of constants
""",
}
_TAIL = """\
    # trigger: M50.0 | start by this flag; default: a member of DB DriveJobs
    # timeout: 10s | for the whole job, all retries included
"""
_COMMENT = 36
"""Column of the comments."""


@dataclass(frozen=True, slots=True)
class Recipe:
    """A job to start from: its key, whether it writes, the parameters that it takes of those that a device has.

    ``indexes`` follows each of them, ``start`` is what inputs are that nothing is connected to. A device that has none
    of the ``needed`` ones cannot have the job.
    """

    key: str
    numbers: tuple[int, ...]
    needed: frozenset[int]
    indexes: str = ""
    start: str = ""
    writes: bool = False


RECIPES = {
    "actual-values": Recipe("read_actual_values", (21, 26, 27, 31), frozenset({21})),
    "ramps": Recipe("set_ramps", (1120, 1121, 50303, 50304), frozenset({1121, 50304}), start="10.0", writes=True),
    "faults": Recipe("read_faults", (945, 949), frozenset({945}), "[0..7]"),
}
"""Speed, DC link voltage, current and torque; ramp times; the eight faults of the present fault situation."""


KINDS = {
    "bits": "write: {W.2: 1} | one bit; the word is read first",
    "readback": "write: {P: }\nverify: readback | what is written is read back and compared",
    "restore": "write: {P: }\nverify: readback\non_error: restore | the old value comes back if the job fails",
    "save": "save: drive_object | copies RAM to ROM; not in a cycle",
    "compare": "compare: {P: } | lists what differs from its inputs",
    "sequence": "sequence: [{write: {P: }}, {read: [P]}] | steps; {until: {P: 5.0, timeout: 5s}} waits",
    "messages": "faults: current | faults as an array of structures; alarms: current for alarms",
    "service": "service: read | any parameter: number, index, count and drive object are inputs",
    "acknowledge": "acknowledge: true",
    "activate": "activate: input | takes the drive object out of operation and back",
    "clock": "clock: utc | of a control unit",
    "recipe": "write_recipe: material | the record with the number at its input",
}
"""Every other kind of job, by a word for it; P and W stand for parameters as ``samples`` has them."""
_RECIPES = """
recipes:
  material: {parameters: [P], records: {copper: {P: 5.0}, steel: {P: 10.0}}}
"""
PPI = """\
# A spec of plcgen for a PPI master. Check it with    plcgen check {file}

plc: {{name: My station, family: {family}, toolchain: {toolchain}}}

ppi:
  line:
    {module} | cm1241, cb1241, cm-ptp; cp341 on an S7-300
    {port} | of the module
    stations: {{s7_200: {{address: 2}}}} | cpu: "224" refuses addresses that it does not have
    jobs:
      read_level: {{station: s7_200, read: [VW100, M0.0], cycle: 1s}} | without cycle: on demand
      set_level: {{station: s7_200, write: {{VW200: }}}} | an input of the block
"""


def ppi_module(family: str) -> str:
    """The usual module of a family and where it is, as keys of a master."""
    if family in {"s7-300", "s7-400"}:
        return "module: cp341, address: 256"
    return f"module: {'cm-ptp' if family == 's7-1500' else 'cm1241'}, port: 270"


_FAQ = """\
# In the form of Siemens FAQ 109750712 (09/2017, TIA Portal V13 SP1): its data blocks, their members, its flags.
# Compare toolchain and address with your project; check it with    plcgen check {file}
# and make the PLC sources with                                     plcgen generate {file}

plc:
  name: {project}
  family: {family}
  toolchain: {toolchain} | step7-v5, tia-v13sp1, tia-v14 .. tia-v21
  names: faq | member names

drives:
  {key}:
    device: {device} | {title}
    {address} | {address_hint}: plcgen explain hardware-id
    drive_object: {drive_object} | {rule}

jobs:
  {read_key}:
    drive: {key}
    read: [{read}] | {read_title}
    request: {{db: 3, name: WR_DataBuffer}}
    response: {{db: 4, name: RD_DataBuffer}}
    trigger: {{execute: M50.0, done: M50.5}} | a rising edge of M50.0 reads
    reference: 3 | of the telegram in DB3 before the first run

  {write_key}:
    drive: {key}
    write: {{{write}: {value}}} | {write_title}
    request: {{db: 5, name: WR_DataBuffer_1}}
    response: {{db: 6, name: RD_DataBuffer_1}}
    trigger: {{execute: M150.0, done: M150.5}} | a rising edge of M150.0 writes
    reference: 4
"""
FAQ_DEVICE, FAQ_FAMILY = "sinamics-dcm", "s7-300"


def faq_starter(file: str, device: Device, family: str, toolchain: str) -> str:
    """The project of FAQ 109750712: it reads the ramp-up time and sets the ramp-down time to 100 s.

    Another device has the same blocks, with its own ramps or else a parameter to read and one to write.
    """
    known = _known(device)
    ramps = next((pair for pair in ((50303, 50304), (1120, 1121)) if {*pair} <= known.keys()), None)
    two = _any_two(device)
    read, write = (known[number] for number in ramps) if ramps else (device.parameters[one.numbers[0]] for one in two)
    text = _FAQ.format(
        project="S7-300_6RA80_DP_TIA" if device.key == FAQ_DEVICE else "Record_47",
        key="dcm" if device.key == FAQ_DEVICE else "drive1",
        read_key="read_ramp_up" if ramps else two[0].key,
        read=f"P{read.pnu}",
        read_title=_titled(read),
        write_key="write_ramp_down" if ramps else two[1].key,
        write=f"P{write.pnu}",
        value="100.0" if ramps else "",
        write_title=_titled(write),
        **_place(file, device, family, toolchain),
    )
    return "".join(_aligned(line) for line in text.splitlines())


def _place(file: str, device: Device, family: str, toolchain: str) -> dict[str, object]:
    """What every starter spec says of its PLC and its drive."""
    classic = family in {"s7-300", "s7-400"}
    hint = "hardware identifier, or the name of its system constant"
    return {
        "file": file,
        "family": family,
        "toolchain": toolchain,
        "device": device.key,
        "title": device.title,
        "address": "address: 256" if classic else "hardware_id: 270",
        "address_hint": "logical address, see the hardware configuration" if classic else hint,
        "drive_object": device.drive_object,
        "rule": device.drive_object_rule,
    }


def ppi_starter(file: str, family: str, toolchain: str) -> str:
    """A starter spec of a PPI master."""
    module, port = ppi_module(family).split(", ")
    text = PPI.format(file=file, family=family, toolchain=toolchain, module=module, port=port)
    return "".join(_aligned(line) for line in text.splitlines())


def _of_kinds(kinds: Sequence[str], device: Device) -> str:
    """Jobs of some kinds, and the recipe of one that has any."""
    lines = []
    for kind in kinds:
        text = KINDS[kind]
        if kind == "save" and device.absent(971, ""):
            text = text.replace("drive_object", "unit")
        lines += [f"  {kind}:", "    drive: drive1", *(f"    {line}" for line in text.split("\n"))]
    return _with_numbers("\n".join(lines) + "\n" + (_RECIPES if "recipe" in kinds else ""), device)


STAND_INS = {"R": "r21", "P": "P1120", "W": "P1030"}
"""Parameters for devices of which no parameter is known that could be read, be written, or be written bit by bit."""


def samples(device: Device) -> dict[str, str]:
    """Parameters of a device to show jobs with: R to read, P to write, W to write bit by bit; harmless ones only.

    What the device is not known to have is missing.
    """
    known = _known(device)
    harmless = [p for p in known.values() if "w" in p.access and not p.bico and not device.danger(p.pnu)]
    writable = sorted(harmless, key=lambda p: p.type != "FloatingPoint")
    words = [p.pnu for p in harmless if p.type == "Unsigned16"]
    ramp = [number for number in (1120, 1121, 50303, 50304) if number in known]
    fitting = {
        "R": [*(number for number in (21, *ramp) if number in known), *known],
        "P": [*ramp, *(p.pnu for p in writable)],
        "W": [*(number for number in (1030,) if number in words), *words],
    }
    first = {letter: known[numbers[0]] for letter, numbers in fitting.items() if numbers}
    return {letter: one.label for letter, one in first.items()}


def _with_numbers(text: str, device: Device) -> str:
    """R, P and W stand for parameters of the device."""
    return sampled(text, {**STAND_INS, **samples(device)})


def sampled(text: str, parameters: Mapping[str, str]) -> str:
    """R, P and W stand for these parameters; what has none stays."""
    return re.sub(r"\b[RPW]\b", lambda found: parameters.get(found[0], found[0]), text)


def usable(device: Device) -> tuple[str, ...]:
    """Names of the recipes that a device has the parameters for, with types that are more than recalled."""
    return tuple(name for name, recipe in RECIPES.items() if _known(device).keys() & recipe.needed)


def starter(file: str, device: Device, family: str, toolchain: str, jobs: Sequence[str] = ()) -> str:
    """A starter spec that passes every check.

    It has the recipes and kinds ``jobs``, by default all recipes that are usable, else a parameter to read and one to
    write.
    """
    head = _HEAD.format(families=", ".join(FAMILIES), **_place(file, device, family, toolchain))
    kinds = [job for job in jobs if job in KINDS]
    if "clock" in kinds:  # the control unit has it
        head = head.replace(f"drive_object: {device.drive_object} ", "drive_object: 1 ")
    if kinds and len(kinds) == len(jobs):
        return "".join(_aligned(line) for line in (head + _of_kinds(kinds, device)).splitlines())
    known = _known(device)
    recipes = [RECIPES[name] for name in RECIPES if name in (jobs or usable(device))] or _any_two(device)
    if not jobs and all(recipe.writes for recipe in recipes):
        recipes.insert(0, _reading(known[next(number for number in recipes[0].numbers if number in known)]))
    body = "\n".join(_job(recipe, known if recipe.needed else device.parameters) for recipe in recipes)
    body += _of_kinds(kinds, device)
    return "".join(_aligned(line) for line in (head + body + _MORE[recipes[-1].writes] + _TAIL).splitlines())


def _known(device: Device) -> dict[int, Parameter]:
    """What can be read without anything else being said about it."""
    return {p.pnu: p for p in device.parameters.values() if p.type and p.grades.get("type") != "recalled"}


def _job(recipe: Recipe, parameters: dict[int, Parameter]) -> str:
    lines = [_line(parameters[number], recipe) for number in recipe.numbers if number in parameters]
    return "\n".join(
        [f"  {recipe.key}:", "    drive: drive1", f"    {'write' if recipe.writes else 'read'}:", *lines, ""]
    )


def _line(parameter: Parameter, recipe: Recipe) -> str:
    title = _titled(parameter)
    if not recipe.writes:
        return f"      - {parameter.label}{recipe.indexes} | {title}"
    value = f" {{start: {recipe.start}}}" if recipe.start else ""
    return f"      {parameter.label}:{value} | {title}; an input of the block"


def _titled(parameter: Parameter) -> str:
    return f"{parameter.title}{f', {parameter.unit}' if parameter.unit else ''}"


def _any_two(device: Device) -> list[Recipe]:
    """A parameter to read and one to write: harmless, single value, of a known type, preferably one with a name."""
    known = sorted((p for p in device.parameters.values() if p.type), key=lambda p: p.pnu)
    harmless = [p for p in known if not device.danger(p.pnu) and not p.bico and p.pnu not in device.bases]
    writable = [p for p in harmless if "w" in p.access]
    sure = [p for p in writable if p.grades.get("type") != "recalled"]
    best = [p for p in sure if p.name] or writable or known
    write = best[min(1, len(best) - 1)]
    return [_reading(best[0]), Recipe(f"write_{_name(write)}", (write.pnu,), frozenset(), writes=True)]


def _reading(parameter: Parameter) -> Recipe:
    return Recipe(f"read_{_name(parameter)}", (parameter.pnu,), frozenset())


def _name(parameter: Parameter) -> str:
    return parameter.name or f"p{parameter.pnu}"


def _aligned(line: str) -> str:
    body, bar, comment = line.partition(" | ")
    return f"{body:<{_COMMENT - 1}} # {comment}\n" if bar else f"{line}\n"
