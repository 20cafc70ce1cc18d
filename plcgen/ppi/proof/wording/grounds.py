"""What documents of PPI masters are held against, held itself against the spec, as its second reader states it."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

from plcgen.base.diagnostics import Diagnostic
from plcgen.oracles.spec.place import Keys, NotStatedError
from plcgen.oracles.spec.ppi.statement import SERVICES, PpiStatement, StatedAddress, StatedPort
from plcgen.ppi.plan.nouns import PlannedMaster, PpiJob, PpiPlan, PpiValue
from plcgen.ppi.proof.stated.rig import ports_of
from plcgen.ppi.schema import PpiMaster, PpiSection
from plcgen.proof.wording.model import unlike

CODE = "PG614"
Difference = tuple[Keys, str]


def groundless(plan: PpiPlan) -> Iterator[Diagnostic]:
    """Every difference between the plan and the spec that documents would repeat."""
    try:
        ports = ports_of(plan.loaded)
    except (NotStatedError, LookupError, TypeError, ValueError):
        return  # the group Spec says so
    masters = {master.key: master for master in plan.masters}
    for key, port in ports.items():
        found = _of_master(masters[key], port) if key in masters else iter([(port.path, "no document has it")])
        given = plan.loaded.sections(PpiSection).ppi[key]
        found = chain(found, ((port.path, what) for what in _pinned(masters[key], given)) if key in masters else ())
        yield from (Diagnostic(CODE, f"{key}: {what}", plan.loaded.key_span(path)) for path, what in found)


def _pinned(master: PlannedMaster, given: PpiMaster) -> Iterator[str]:
    """What the spec says of blocks and numbers."""
    yield from unlike("function block", given.block.name, given.block.number, master.block)
    yield from unlike("instance", given.instance.name, given.instance.number, master.instance)
    for job in master.jobs:
        entry, telegram = given.jobs[job.key], job.telegrams[0]
        yield from unlike(f"telegram of {job.key}", entry.request.name, entry.request.db, telegram.request.home)
        if telegram.response is not None:
            yield from unlike(f"answer of {job.key}", entry.response.name, entry.response.db, telegram.response.home)


def _of_master(master: PlannedMaster, port: StatedPort) -> Iterator[Difference]:
    for what, found, wanted in (
        ("module", master.module, port.module),
        ("identifier or address", master.port, port.port),
        ("bit/s", master.baud, port.baud),
        ("own address", master.own_address, port.own_address),
        ("comment", {*master.comment.values()}, {*port.comments}),
        ("stations", {one.key: one.address for one in master.stations}, dict(port.stations)),
    ):
        if found != wanted:
            yield port.path, f'documents say "{what}: {found}", the spec says "{what}: {wanted}"'
    jobs, stated = {job.key: job for job in master.jobs}, {job.key: job for job in port.jobs}
    for key in jobs.keys() ^ stated.keys():
        yield port.path, f"job {key}: {'no document has it' if key in stated else 'the spec has no such job'}"
    for key in jobs.keys() & stated.keys():
        yield from _of_job(jobs[key], stated[key])


def _of_job(job: PpiJob, stated: PpiStatement) -> Iterator[Difference]:
    for what, found, wanted in (
        ("station", job.station.address, stated.station),
        ("service", SERVICES.get(job.kind), stated.service),
        ("cycle", job.cycle or None, stated.cycle),
        ("comment", {*job.comment.values()}, {*stated.comments}),
        ("addresses", len(job.values), len(stated.values)),
    ):
        if found != wanted:
            yield stated.path, f'job {job.key}: documents say "{what}: {found}", the spec says "{what}: {wanted}"'
    for value, one in zip(job.values, stated.values, strict=False):
        for what in _of_value(value, one, writes=job.kind == "write"):
            yield one.path, f"job {job.key}, {one.text}: {what}"


def _bare(label: str) -> str:
    """A label without the address behind a symbol; names of members have no points."""
    return label.partition(" (")[0].replace(".", "_").partition("[")[0].casefold()


def _of_value(value: PpiValue, stated: StatedAddress, *, writes: bool) -> Iterator[str]:
    begins = [stated.start if stated.constant is None else stated.constant] * max(1, stated.count)
    wanted = stated.octets(begins) if writes else b""
    for what, found, right in (
        ("called", _bare(value.label), _bare(stated.label)),
        ("lies at", (int(value.item.area), value.item.address), (stated.whole.area, stated.whole.first)),
        ("type", value.element.name, stated.kind),
        ("elements", value.count, max(1, stated.count)),
        ("a constant", value.constant, stated.constant is not None),
        ("value", value.data.hex(" ") if writes else "", wanted.hex(" ")),
        ("comment", {*value.comment.values()}, {*stated.comments}),
    ):
        if found != right:
            yield f'documents say "{what}: {found}", the spec says "{what}: {right}"'
