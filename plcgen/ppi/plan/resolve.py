"""The ``ppi`` part of a spec -> planned masters. What cannot be resolved is a diagnostic; the rest is planned."""

from __future__ import annotations

import errno
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Report
from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.base.files.files import below, refusal
from plcgen.ppi.plan.jobs import JobPlanner
from plcgen.ppi.plan.nouns import (
    ACK_LEAST,
    ACK_STATION,
    E5,
    REPLY_LEAST,
    REPLY_STATION,
    PlannedMaster,
    PlannedStation,
    PpiPlan,
    chosen,
    heard_ms,
    longest_reply,
)
from plcgen.ppi.schema import PpiMaster, PpiSection, PpiStation
from plcgen.ppi.symbols import PpiSymbol, SymbolTable, load_symbols
from plcgen.ppi.wire.address import PpiAddressError, parse_item
from plcgen.ppi.wire.profiles import CpuProfile, profiles
from plcgen.project.numbering import Numbering
from plcgen.project.spec import LoadedSpec
from plcgen.protocol.base import Protocol
from plcgen.s7.types.names import pascal_case

BAUD_RATES = (9600, 19200)
CLASSIC_MODULES = frozenset({"cp341"})
BY_THE_CPU = {"cm1241": "CM 1241", "cb1241": "CB 1241"}
"""Modules that sit beside or in an S7-1200."""
LEAST_FIRMWARE = {"cm1241": (2, 1)}
"""From here on a module knows Send_P2P and the like (TIA Portal information system, "Use with CM1241")."""


def pinned(spec: PpiSection) -> Iterator[tuple[str, int]]:
    """Block numbers that the masters of a spec pin."""
    for master in spec.ppi.values():
        numbers = [("FB", master.block.number), ("DB", master.instance.number)]
        for job in master.jobs.values():
            numbers += [("DB", job.request.db), ("DB", job.response.db)]
        yield from ((kind, number) for kind, number in numbers if number is not None)


def plan_masters(protocol: Protocol, loaded: LoadedSpec, numbering: Numbering, report: Report) -> PpiPlan:
    """Plan every master of a spec."""
    spec = loaded.sections(PpiSection)
    diagnostics_type = numbering.fixed("UDT", "typePpiDiag")
    control_db = numbering.fixed("DB", "PpiJobs")
    planned = tuple(_master(key, master, loaded, numbering, report) for key, master in spec.ppi.items())
    return PpiPlan(
        protocol=protocol,
        loaded=loaded,
        name=loaded.spec.plc.name,
        target=numbering.where,
        languages=loaded.spec.plc.languages,
        jobs=tuple(job for master in planned for job in master.jobs),
        blocks=(diagnostics_type, *(block for master in planned for block in master.blocks), control_db),
        masters=planned,
        diagnostics_type=diagnostics_type,
        control_db=control_db,
    )


def _master(key: str, master: PpiMaster, loaded: LoadedSpec, numbering: Numbering, report: Report) -> PlannedMaster:
    path = ("ppi", key)
    stations = _stations(key, master, loaded, report)
    symbols = {name: _symbols(key, name, station, loaded, report) for name, station in master.stations.items()}
    name = pascal_case(key)
    planner = JobPlanner(loaded, numbering, report, key, name, master, stations, symbols)
    jobs = planner.jobs()
    syncs = planner.syncs(jobs)
    own = master.block.name
    block = numbering.block("FB", own or f"{name}PpiMaster", (*path, "block"), master.block.number, given=bool(own))
    own = master.instance.name
    number = master.instance.number

    instance = numbering.block(
        "DB", own or f"{block.name}_DB", (*path, "instance"), number, given=bool(own), derived=True
    )
    classic = numbering.where.classic
    extra = None
    if classic:
        extra = (numbering.block("DB", f"{name}Ppi_Send", path), numbering.block("DB", f"{name}Ppi_Receive", path))
    baud = _baud(key, master, loaded, report)
    heard = partial(heard_ms, baud=baud, ob1=master.ob1_cycle, classic=classic)
    longest = longest_reply(jobs)
    return PlannedMaster(
        key=key,
        module=_module(key, master, loaded, report, classic=classic),
        port=_port(key, master, loaded, report, classic=classic),
        own_address=master.own_address,
        baud=baud,
        ob1_cycle=master.ob1_cycle,
        ack_timeout=master.ack_timeout or chosen(ACK_LEAST, heard(E5), ACK_STATION),
        reply_timeout=master.reply_timeout or chosen(REPLY_LEAST, heard(longest), REPLY_STATION),
        retry_pause=master.retry_pause,
        poll_pause=master.poll_pause,
        retries=master.retries,
        polls=master.polls,
        stations=tuple(stations.values()),
        jobs=jobs,
        syncs=syncs,
        block=block,
        instance=instance,
        module_instances=extra,
        buffer=numbering.block("DB", f"{name}Ppi_Buffer", path) if classic else None,
        comment=master.comment or {},
        path=path,
    )


def _module(key: str, master: PpiMaster, loaded: LoadedSpec, report: Report, *, classic: bool) -> str:
    if (master.module in CLASSIC_MODULES) != classic:
        family = loaded.spec.plc.family.upper()
        fitting = "cp341" if classic else "cm1241, cb1241 or cm-ptp"
        message = f"an {family} cannot use {master.module}"
        report.add(
            Diagnostic("PG233", message, loaded.span(("ppi", key, "module")), help=f"module: {fitting} for an {family}")
        )
    elif loaded.spec.plc.family == "s7-1500" and master.module in BY_THE_CPU:
        message = f"the {BY_THE_CPU[master.module]} belongs to an S7-1200"
        report.add(Diagnostic("PG233", message, loaded.span(("ppi", key, "module")), help="module: cm-ptp"))
    elif loaded.spec.plc.family == "s7-400":
        message = "the CP 341 belongs to an S7-300"
        help_ = "an S7-400 reaches it only through an ET 200M, which this generator does not support"
        report.add(Diagnostic("PG233", message, loaded.span(("ppi", key, "module")), help=help_))
    _firmware(key, master, loaded, report)
    return master.module


def _firmware(key: str, master: PpiMaster, loaded: LoadedSpec, report: Report) -> None:
    """PG233: the module is too old for the blocks."""
    least = LEAST_FIRMWARE.get(master.module)
    if least is None or master.firmware is None:
        return
    found = tuple(int(part) for part in master.firmware.lstrip("Vv").split("."))
    if found < least:
        name, wanted = BY_THE_CPU[master.module], ".".join(map(str, least))
        message = f"a {name} with firmware {master.firmware} does not support Send_P2P, Receive_P2P and Port_Config"
        help_ = f"they need firmware {wanted} or later: update the module"
        report.add(Diagnostic("PG233", message, loaded.span(("ppi", key, "firmware")), help=help_))


def _port(key: str, master: PpiMaster, loaded: LoadedSpec, report: Report, *, classic: bool) -> int:
    value = master.address if classic else master.port
    if value is None and (master.module in CLASSIC_MODULES) == classic:
        wanted, why = ("address", "logical address") if classic else ("port", "hardware identifier")
        message = f"an {loaded.spec.plc.family.upper()} needs the {why} of the module"
        report.add(Diagnostic("PG215", message, loaded.key_span(("ppi", key)), help=f"add {wanted}: to this master"))
    return value or 0


def _baud(key: str, master: PpiMaster, loaded: LoadedSpec, report: Report) -> int:
    if master.baud in BAUD_RATES:
        return master.baud
    message = f"{master.baud} bit/s is not possible"
    help_ = "an S7-200 uses PPI at 9600 or 19200 bit/s with serial modules"
    if master.baud in {187500, 187}:
        message = "187.5 kbit/s is not possible: CM 1241, CM PtP and CP 341 have no such baud rate"
        help_ = "set the port of the S7-200 to 9600 or 19200 bit/s in its system block"
    report.add(Diagnostic("PG234", message, loaded.span(("ppi", key, "baud")), help=help_))
    return BAUD_RATES[0]


def _stations(key: str, master: PpiMaster, loaded: LoadedSpec, report: Report) -> dict[str, PlannedStation]:
    found: dict[str, PlannedStation] = {}
    for index, (name, station) in enumerate(master.stations.items(), 1):
        path = ("ppi", key, "stations", name)
        profile = _profile(station, loaded, (*path, "cpu"), report)
        found[name] = PlannedStation(name, station.comment or {}, path, index, station.address, profile)
    return found


def _profile(station: PpiStation, loaded: LoadedSpec, path: tuple[str, ...], report: Report) -> CpuProfile:
    known = profiles()
    name = station.cpu.upper().removeprefix("CPU").strip()
    if name not in known:
        hint = did_you_mean(name, list(known))
        message = f'"{station.cpu}" is not an S7-200 CPU'
        help_ = f"{hint} known CPUs: {', '.join(known)}".strip()
        report.add(Diagnostic("PG241", message, loaded.span(path), help=help_))
        return max(known.values(), key=lambda profile: sum(profile.sizes.values()))
    return known[name]


def _symbols(key: str, name: str, station: PpiStation, loaded: LoadedSpec, report: Report) -> SymbolTable:
    """The station's symbol table; its own problems stand at their lines of the table."""
    if station.symbols is None:
        return SymbolTable(())
    if not isinstance(station.symbols, str):
        return _own_symbols(station.symbols, ("ppi", key, "stations", name, "symbols"), loaded, report)
    try:
        path = below(Path(loaded.file).parent, station.symbols)
        if path is None:
            raise PermissionError(errno.EACCES, f"it {refusal(station.symbols)}")
        return load_symbols(path)
    except DiagnosticError as problem:
        report.extend(problem.diagnostics)
    except OSError as problem:
        why = problem.strerror or str(problem)
        message = f"the symbol table {station.symbols} cannot be read: {why}"
        place = loaded.span(("ppi", key, "stations", name, "symbols"))
        help_ = "export it from STEP 7-Micro/WIN; the path is relative to the spec"
        report.add(Diagnostic("PG236", message, place, help=help_))
    return SymbolTable(())


def _own_symbols(symbols: Mapping[str, str], path: tuple[str, ...], loaded: LoadedSpec, report: Report) -> SymbolTable:
    found = []
    for name, address in symbols.items():
        span = loaded.span((*path, name))
        try:
            found.append(PpiSymbol(name, parse_item(address), "", span.line))
        except PpiAddressError as problem:
            report.add(Diagnostic("PG230", problem.message, span, help=problem.help))
    return SymbolTable(tuple(found))
