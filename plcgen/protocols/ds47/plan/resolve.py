"""The sections ``drives`` and ``jobs`` of a spec -> planned drives and jobs."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from plcgen.diagnostics import Diagnostic, Note, Report
from plcgen.diagnostics.suggest import did_you_mean
from plcgen.project.nouns import BlockRef
from plcgen.project.numbering import Numbering
from plcgen.project.spec import LoadedSpec
from plcgen.protocols.ds47 import guards
from plcgen.protocols.ds47.device import Device, Parameter, parameter_from
from plcgen.protocols.ds47.devices import Catalogue
from plcgen.protocols.ds47.plan.jobs import plan_job
from plcgen.protocols.ds47.plan.nouns import DriveJob, DrivePlan, PlannedDrive
from plcgen.protocols.ds47.plan.references import parse_reference
from plcgen.protocols.ds47.plan.uses import UseResolver
from plcgen.protocols.ds47.schema import DriveEntry, DriveSections
from plcgen.s7.names import pascal_case

if TYPE_CHECKING:
    from plcgen.protocols.base import Protocol

OUTPUT_BIT = 0x8000
MAX_TELEGRAMS = 20_000
"""Telegrams of one project."""


def plan_drives(protocol: Protocol, loaded: LoadedSpec, numbering: Numbering, report: Report) -> DrivePlan:
    """Plan the drives of a spec and their jobs."""
    spec = loaded.sections(DriveSections)
    # without jobs these blocks are not made: they take no numbers then
    common = numbering if spec.jobs else numbering.apart()
    diagnostics_type = common.block("UDT", "typeDriveJobDiag", ("plc",), given=True)
    token_type = common.block("UDT", "typeDriveToken", ("plc",), given=True)
    control_db = common.block("DB", "DriveJobs", ("plc",), given=True)
    tokens: dict[int, BlockRef] = {}
    catalogue = Catalogue(Path(loaded.file).parent)
    drives = {
        key: _drive(key, drive, loaded, numbering, tokens, catalogue, report) for key, drive in spec.drives.items()
    }
    planned = {key: found for key, found in drives.items() if found is not None}
    resolvers = {
        key: UseResolver(loaded, drive.device, _own_parameters(loaded, key, drive.device, report), report)
        for key, drive in planned.items()
    }
    for key, resolver in resolvers.items():
        for text in spec.drives[key].parameters:
            reference = parse_reference(text)
            own = resolver.own.get(reference.pnu) if reference and reference.pnu is not None else None
            if own is not None:
                resolver.check_definition(own, ("drives", key, "parameters", text))
    jobs: list[DriveJob] = []
    owners: dict[str, int] = {}
    room = MAX_TELEGRAMS
    for key, job in spec.jobs.items():
        if job.drive not in spec.drives:
            hint = did_you_mean(job.drive, spec.drives) or f"drives of this spec: {', '.join(spec.drives)}"
            report.add(
                Diagnostic("PG202", f'unknown drive "{job.drive}"', loaded.span(("jobs", key, "drive")), help=hint)
            )
            continue
        if job.drive not in planned:
            continue
        channel = planned[job.drive].token.name
        owners[channel] = owners.get(channel, 0) + 1
        found = plan_job(key, loaded, planned[job.drive], owners[channel], resolvers[job.drive], numbering, report)
        if found is not None:
            jobs.append(found)
            room -= len(found.telegrams)
        if room < 0:
            message = f"the drive jobs up to here have more than {MAX_TELEGRAMS} telegrams"
            help_ = "divide the project: every telegram is two data blocks, and no CPU has room for so many"
            report.add(Diagnostic("PG307", message, loaded.key_span(("jobs", key)), help=help_))
            break
    tokens_used = tuple(dict.fromkeys(drive.token for drive in planned.values()))
    blocks = [diagnostics_type, token_type, *tokens_used]
    for one in jobs:
        for telegram in one.telegrams:
            request, response = telegram.request, telegram.response
            blocks += [request.type, response.type, request.db, response.db]
        blocks += [one.block, one.instance, *(one.record_instances or ())]
    return DrivePlan(
        protocol=protocol,
        loaded=loaded,
        name=loaded.spec.plc.name,
        target=numbering.where,
        languages=loaded.spec.plc.languages,
        jobs=tuple(jobs),
        blocks=(*blocks, control_db) if spec.jobs else (),
        drives=tuple(planned.values()),
        diagnostics_type=diagnostics_type,
        token_type=token_type,
        control_db=control_db,
    )


def pinned(spec: DriveSections) -> Iterator[tuple[str, int]]:
    """Block numbers that the jobs of a spec fix."""
    for job in spec.jobs.values():
        for kind, number in (
            ("DB", job.request.db),
            ("DB", job.response.db),
            ("DB", job.instance.number),
            ("FB", job.block.number),
        ):
            if number is not None:
                yield kind, number


def _own_parameters(loaded: LoadedSpec, key: str, device: Device, report: Report) -> dict[int, Parameter]:
    own: dict[int, Parameter] = {}
    definitions = loaded.sections(DriveSections).drives[key].parameters
    for text, definition in definitions.items():
        path = ("drives", key, "parameters", text)
        reference = parse_reference(text)
        if reference is None or reference.pnu is None or reference.first is not None or not 1 <= reference.pnu <= 65535:
            report.add(
                Diagnostic(
                    "PG203",
                    f'"{text}" is not a parameter number',
                    loaded.key_span(path),
                    help="write its number, for example P50303",
                )
            )
            continue
        known = device.parameters.get(reference.pnu)
        reason = guards.why_read_only(text, reference.pnu, catalogued=known.access if known is not None else "")
        if reason and definition.access not in {None, "r"}:
            source = f": {known.source}" if known is not None and known.access == "r" else ""
            message, help_ = f"{text} cannot be written: {reason}{source}", "remove access, or write access: r"
            report.add(Diagnostic("PG207", message, loaded.span((*path, "access")), help=help_))
            continue
        if reference.pnu in own:
            first = next(key for key in definitions if (other := parse_reference(key)) and other.pnu == reference.pnu)
            report.add(
                Diagnostic(
                    "PG103",
                    f'parameter {reference.pnu} is defined twice: "{first}" and "{text}"',
                    loaded.key_span(path),
                    help="remove one of them; letter case and zeros in front make no difference",
                    notes=(Note("first definition", loaded.key_span((*path[:-1], first))),),
                )
            )
            continue
        own[reference.pnu] = parameter_from(reference.pnu, definition.model_dump(), read_only=bool(reason))
    return own


def _drive(
    key: str,
    drive: DriveEntry,
    loaded: LoadedSpec,
    numbering: Numbering,
    tokens: dict[int, BlockRef],
    catalogue: Catalogue,
    report: Report,
) -> PlannedDrive | None:
    """Plan one drive; drive objects at one address share a parameter channel and therefore a token."""
    path = ("drives", key)
    device = catalogue.find(drive.device, loaded.span((*path, "device")), report)
    if device is None:
        return None
    classic = numbering.where.classic
    id_value = drive.address if classic else drive.hardware_id
    if id_value is None:
        wanted = "address" if classic else "hardware_id"
        why = "logical address" if classic else "hardware identifier"
        report.add(
            Diagnostic(
                "PG215",
                f"an {loaded.spec.plc.family.upper()} needs the drive's {why}",
                loaded.key_span(path),
                help=f"add {wanted}: to this drive",
            )
        )
        id_value = 0
    if classic and drive.output_address:
        id_value |= OUTPUT_BIT
    if id_value not in tokens:
        tokens[id_value] = numbering.block("DB", f"{pascal_case(key)}Token", path)
    return PlannedDrive(
        key=key,
        device=device,
        id_value=id_value,
        drive_object=device.drive_object if drive.drive_object is None else drive.drive_object,
        record_index=_record_index(drive, device, loaded, key, report),
        token=tokens[id_value],
        comment=drive.comment or {},
        path=path,
    )


def _record_index(drive: DriveEntry, device: Device, loaded: LoadedSpec, key: str, report: Report) -> int:
    default = device.record_index[device.default_index]
    if drive.record_index is None:
        return default
    value = drive.record_index
    index = device.record_index.get(value) if isinstance(value, str) else value
    if index is None or index not in device.record_index.values():
        known = ", ".join(f"{name} = {number:04X}h" for name, number in device.record_index.items())
        shown = value if isinstance(value, str) else f"{value:04X}h"
        report.add(
            Diagnostic(
                "PG216",
                f"{device.title} has no parameter channel at record index {shown}",
                loaded.span(("drives", key, "record_index")),
                help=f"its indexes: {known}",
            )
        )
        return default
    return index
