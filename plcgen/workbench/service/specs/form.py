"""What a form puts into a spec, as edits of its text: drives, jobs, parameters, cycles, recipes, stations.

Comments, order and style of everything else stay, and an editor takes one step back by its own undo.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from itertools import count
from typing import TYPE_CHECKING, NamedTuple

from plcgen.base.diagnostics import Report, Span
from plcgen.ds47.devices import Catalogue, device_names, find_device
from plcgen.ds47.references import parse_reference
from plcgen.workbench.service.specs.drives import drives_at, known_drive
from plcgen.workbench.service.specs.entries import Entries, add_parameter, in_flow, refused
from plcgen.workbench.service.specs.jobs import RECIPE, RECIPE_BODY, job_offers
from plcgen.workbench.service.specs.layout import difference
from plcgen.workbench.starter import STAND_INS, ppi_module, sampled, samples

if TYPE_CHECKING:
    from plcgen.workbench.service.results import Edit
    from plcgen.workbench.service.specs.state import SpecState

Given = Mapping[str, str]
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,23}\Z")
_ADDRESS = re.compile(r"[0-9]{1,5}\Z|16#[0-9A-Fa-f]{1,4}\Z")
_TIME = re.compile(r"[0-9]+(?:ms|s|min|h)\Z")
_UNIT = re.compile(r"[\w%°/*.^() -]{1,20}\Z")
_WORD = re.compile(r"[\w.%\[\]-]{1,60}\Z")
"""What goes into a line of YAML as it was typed."""


def put_in(state: SpecState, what: str, given: Given) -> tuple[Edit, ...]:
    """Edits that put something into a spec.

    ``what`` and what is ``given`` for it, all as text:

    ``drive``: key, device, address, drive_object. ``job``: key, kind, and drive (several with ``,`` between), or
    station as ``line/station``; cycle or trigger; parameter, or address of a station, in place of the one that is
    offered, with its type and unit where it is not known; recipe where the kind names one. ``parameter``: job as the
    keys to it with ``/`` between (``jobs/ramps``, ``recipes/material``, ``ppi/line/jobs/level``), parameter, access
    (read, write), type, unit, and for a recipe the value that its records begin with. ``cycle``: job, cycle; an empty
    one is removed. ``recipe``: key, drive, parameter. ``station``: line, key, address, cpu, and of a line that begins
    with it port and parameter, which is the address that a job reads. ``remove``: path, as the keys to it with ``/``
    between.

    Raises:
        DiagnosticError: why that cannot be done.
    """
    for key in ("parameter", "type", "trigger", "recipe", "line", "cpu", "unit", "value"):
        word = given.get(key, "").strip()
        if word and not (_UNIT if key == "unit" else _WORD).match(word):
            raise refused(state.document.file, f'"{word}" cannot be put in as "{key}"', "write it into the text")
    entries = Entries(state.document.text, state.document.file)
    return difference(state.document, _PUTS[what](state, entries, given))


def _key(state: SpecState, given: Given) -> str:
    key = given.get("key", "").strip()
    if not _NAME.match(key):
        raise refused(
            state.document.file, f'"{key}" is no name', "up to 24 letters (no umlauts), digits and _, a letter first"
        )
    return key


def _address(state: SpecState, given: Given, default: str) -> str:
    address = given.get("address", "").strip() or default
    if not _ADDRESS.match(address):
        help_ = "a number of the hardware configuration, such as 270 or 16#10E"
        raise refused(state.document.file, f'"{address}" is no address', help_)
    return address


def _family(state: SpecState) -> str:
    plc = None if state.composed is None else state.composed.root.get("plc")
    family = None if plc is None else plc.get("family")
    return "" if family is None else family.raw


def _drive(state: SpecState, entries: Entries, given: Given) -> str:
    report, file, key = Report(), state.document.file, _key(state, given)
    device = Catalogue(state.document.path.parent).find(given.get("device", ""), Span(file), report)
    if device is None:
        raise refused(file, next(iter(report)).message if len(report) else "there is no such device")
    number = given.get("drive_object", "").strip() or str(device.drive_object)
    if not number.isdecimal():
        raise refused(file, f'"{number}" is no number of a drive object', device.drive_object_rule)
    return entries.add(["drives"], key, _drive_body(state, given, number))


def _drive_body(state: SpecState, given: Given, number: str) -> str:
    """A drive in one line, addressed as its family does it."""
    where, usual = ("address", "256") if _family(state) in {"s7-300", "s7-400"} else ("hardware_id", "270")
    place = f"{where}: {_address(state, given, usual)}"
    return f"{{device: {given['device']}, {place}, drive_object: {number}}}"


def _job(state: SpecState, entries: Entries, given: Given) -> str:
    """A job of a kind, with the recipe that it names if there is none yet."""
    file, key = state.document.file, _key(state, given)
    partner = given.get("station") or given.get("drive", "")
    offer = next((one for one in job_offers(state, partner) if one.kind == given.get("kind", "read")), None)
    if offer is None:
        raise refused(file, f'there is no drive or station "{partner}"', "add it first")
    if offer.lacks:
        raise refused(file, offer.lacks, offer.help)
    line, slash, station = partner.partition("/")
    keys = partner.split(",")
    body, cycle, trigger = offer.text, _cycle(state, given), given.get("trigger", "").strip()
    other = given.get("parameter", "").strip()
    if f": {RECIPE}" in body:
        name = given.get("recipe", "").strip() or next((name for _, name in state.names("recipes")), RECIPE)
        body = body.replace(RECIPE, name)
        if name not in {known for _, known in state.names("recipes")}:
            entries = entries.then(_recipe(state, entries, {**given, "key": name, "drive": keys[0]}))
    elif offer.asks or (other and not slash and other != offer.parameter):
        number = f"P{_number(state, given)}"
        entries = _defined(state, entries, keys, given)
        body = sampled(body, dict.fromkeys(STAND_INS, number))
        body = re.sub(rf"\b{offer.parameter}\b", in_flow(other), body) if offer.parameter else body
    elif other and offer.parameter:
        body = body.replace(offer.parameter, other)
    body += f", cycle: {cycle}" if cycle else f", trigger: {trigger}" if trigger else ""
    if slash:
        return entries.add(["ppi", line, "jobs"], key, f"{{station: {station}, {body}}}")
    drives = partner if len(keys) == 1 else f"[{', '.join(keys)}]"
    return entries.add(["jobs"], key, f"{{drive: {drives}, {body}}}")


def _number(state: SpecState, given: Given) -> int:
    text = given.get("parameter", "").strip()
    found = parse_reference(text)
    if found is None or found.pnu is None:
        said = f'"{text}" is no number of a parameter' if text else "the profile has no parameter for such a job"
        raise refused(state.document.file, said, "type its number and its type, as the manual of the drive says them")
    return found.pnu


def _defined(state: SpecState, entries: Entries, drives: Iterable[str], given: Given) -> Entries:
    """With the type of the parameter, and its unit, in each drive where that is given and not known."""
    number, type_, unit = _number(state, given), given.get("type", ""), given.get("unit", "").strip()
    body = f"{{type: {type_}, unit: {json.dumps(unit, ensure_ascii=False)}}}" if unit else f"{{type: {type_}}}"
    for drive in drives if type_ else ():
        known = known_drive(state, drive)
        found = None if known is None else known.find(f"P{number}")
        if found is not None and found.type:
            continue
        units = (tuple(map(str, path)) for path, key in state.names("units", "*", "drives") if key == drive)
        home = next(units, ("drives", drive))
        if entries.at(*home) is None:
            help_ = f"define P{number} there, with its type"
            raise refused(state.document.file, f'"{drive}" stands in another file', help_)
        entries = entries.then(entries.add([*home, "parameters"], f"P{number}", body))
    return entries


def define(state: SpecState, drive: str, number: int, type_: str) -> tuple[Edit, ...]:
    """Edits that define a parameter in its drive. Raises DiagnosticError if the drive stands in another file."""
    entries = Entries(state.document.text, state.document.file)
    given = {"parameter": f"P{number}", "type": type_}
    return difference(state.document, _defined(state, entries, [drive], given).text)


def _parameter(state: SpecState, entries: Entries, given: Given) -> str:
    """A parameter read or written by a job, or one of a recipe."""
    path, text = given.get("job", "").split("/"), given.get("parameter", "").strip()
    if given.get("type"):
        entries = _defined(state, entries, [one.key for one in drives_at(state, tuple(path))], given)
    if path[0] != "recipes":
        return add_parameter(entries, path, text, writes=given.get("access") == "write")
    value, records = given.get("value", "").strip(), entries.at(*path, "records")
    counted = records is None or records.kind == "scalar"  # such records have nothing but the value of the column
    column = f"{{parameter: {in_flow(text)}, start: {value}}}" if counted and value else in_flow(text)
    entries = entries.then(entries.append([*path, "parameters"], column))
    for record in () if records is None else records.pairs:
        if not value:
            raise refused(state.document.file, "every record needs a value", "type it above the search")
        entries = entries.then(entries.add([*path, "records", record], in_flow(text), value))
    return entries.text


def _cycle(state: SpecState, given: Given) -> str:
    cycle = given.get("cycle", "").strip()
    if cycle and not _TIME.match(cycle):
        raise refused(state.document.file, f'"{cycle}" is no time', "a whole number with its unit, such as 500ms or 2s")
    return cycle


def _repeated(state: SpecState, entries: Entries, given: Given) -> str:
    """The cycle of a job: put in, another one, or none."""
    job, cycle = given.get("job", "").split("/"), _cycle(state, given)
    if cycle:
        return entries.put(job, "cycle", cycle)
    return entries.text if entries.at(*job, "cycle") is None else entries.drop([*job, "cycle"])


def _recipe(state: SpecState, entries: Entries, given: Given) -> str:
    """A recipe with one parameter and two records, whose values nobody has said yet."""
    known = known_drive(state, given.get("drive", ""))
    found = {} if known is None or given.get("parameter") else samples(known.device)
    if "P" not in found:
        found = {"P": f"P{_number(state, given)}"}
        entries = _defined(state, entries, [given.get("drive", "")], given)
    return entries.add(["recipes"], _key(state, given), sampled(RECIPE_BODY, found))


def _station(state: SpecState, entries: Entries, given: Given) -> str:
    """A station of a line; a line that is not there begins with it and a job that reads."""
    key, line = _key(state, given), given.get("line", "").strip() or "line"
    address = _address(state, given, "2")
    cpu = given.get("cpu", "").strip()
    body = f"{{address: {address}" + (f', cpu: "{cpu}"}}' if cpu else "}")
    if line in {name for _, name in state.names("ppi")}:
        return entries.add(["ppi", line, "stations"], key, body)
    module = ppi_module(_family(state))
    if given.get("port", "").strip():
        module = f"{module.rpartition(':')[0]}: {_address(state, {'address': given['port']}, '')}"
    first = given.get("parameter", "").strip() or "VW100"
    job = f"jobs: {{read_{key}: {{station: {key}, read: [{first}]}}}}"
    return entries.add(["ppi"], line, f"{{{module}, stations: {{{key}: {body}}}, {job}}}")


def _removed(state: SpecState, entries: Entries, given: Given) -> str:
    """Without a drive, station or job, or a parameter of one (``jobs/ramps/write/P1120``, ``jobs/speed/read/0``)."""
    path = given.get("path", "").split("/")
    uses = _uses(state, path) if path[-2:-1] in (["drives"], ["stations"]) else []
    if uses:
        raise refused(state.document.file, f'"{path[-1]}" is used by "{", ".join(uses)}"', "remove these jobs first")
    parent = entries.at(*path[:-1])
    if path[-2:-1] in (["read"], ["write"], ["compare"]) and parent is not None and len(parent.children) == 1:
        raise refused(state.document.file, "the job has no other parameter", "remove the job, or add another one first")
    return entries.drop(path)


def _uses(state: SpecState, path: Sequence[str]) -> list[str]:
    """The jobs that name a drive, or a station of its line."""
    jobs, key = (("ppi", path[1], "jobs"), "station") if path[0] == "ppi" else (("jobs",), "drive")
    deep = len(jobs)
    named = (one for one in state.sketch.entries if one.value == path[-1] and one.path[:deep] == jobs)
    return list(dict.fromkeys(str(one.path[deep]) for one in named if one.path[deep + 1 : deep + 2] == (key,)))


_PUTS: Mapping[str, Callable[[SpecState, Entries, Given], str]] = {
    "drive": _drive, "job": _job, "parameter": _parameter, "cycle": _repeated, "recipe": _recipe, "station": _station,
    "remove": _removed,
}  # fmt: skip


# --- what an editor offers where a new entry would begin -------------------------------------------------------------

_SHOWN = 4
"""Drives and stations for which jobs are offered."""


class Begun(NamedTuple):
    """A whole entry: what it is, in a few words, its key and its body in one line of YAML."""

    label: str
    detail: str
    key: str
    body: str


def begun(state: SpecState, path: Sequence[str | int]) -> Iterator[Begun]:
    """Entries to begin with in a section whose keys are the user's own; nothing in others."""
    taken = {str(one.path[-1]) for one in state.sketch.below(tuple(path))}
    for one in _begun(state, tuple(path)):
        yield one._replace(key=_free(one.key, taken))


def _free(key: str, taken: Collection[str]) -> str:
    key = re.sub(r"\W", "_", key)[:22]
    return key if key not in taken else next(each for n in count(2) if (each := f"{key}{n}") not in taken)


def _begun(state: SpecState, path: tuple[str | int, ...]) -> Iterator[Begun]:
    drives = [key for _, key in [*state.names("drives"), *state.names("units", "*", "drives")]][:_SHOWN]
    if path == ("drives",):
        for name in device_names():
            device = find_device(name)
            body = _drive_body(state, {"device": name}, str(device.drive_object))
            yield Begun(name, f"a drive: {device.title}", "drive1", body)
    elif path == ("jobs",):
        for drive in drives:
            yield from _jobs_of(state, drive, f"drive: {drive}", "")
    elif path == ("recipes",):
        for drive in drives:
            known = known_drive(state, drive)
            if known is not None and "P" in samples(known.device):
                body = sampled(RECIPE_BODY, samples(known.device))
                yield Begun(f"recipe of {drive}", "parameters and records with their values", RECIPE, body)
    elif path == ("ppi",):
        job = "jobs: {read_s7_200: {station: s7_200, read: [VW100]}}"
        body = f"{{{ppi_module(_family(state))}, stations: {{s7_200: {{address: 2}}}}, {job}}}"
        yield Begun("a line", "a module with a station and a job", "line", body)
    elif len(path) == 3 and path[0] == "ppi" and path[2] == "stations":
        yield Begun("a station", "an S7-200 with its address on the line", "s7_200", "{address: 2}")
    elif len(path) == 3 and path[0] == "ppi" and path[2] == "jobs":
        for _, station in state.names("ppi", str(path[1]), "stations")[:_SHOWN]:
            yield from _jobs_of(state, f"{path[1]}/{station}", f"station: {station}", station)


def _jobs_of(state: SpecState, partner: str, said: str, station: str) -> Iterator[Begun]:
    """Every kind of job that a partner can have without anything else being said."""
    recipe = next((name for _, name in state.names("recipes")), "")
    for one in job_offers(state, partner):
        recorded = f": {RECIPE}" in one.text
        if not one.lacks and (recipe if recorded else not one.asks):
            text = one.text.replace(RECIPE, recipe) if recorded else one.text
            name = station or partner
            yield Begun(f"{one.kind} {name}", f"a job: {one.title}", f"{one.kind}_{name}", f"{{{said}, {text}}}")
