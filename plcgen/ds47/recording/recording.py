"""Recorded runs of drive jobs: the drives, the jobs, and every record that a drive saw."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial

from pydantic_core import PydanticCustomError

from plcgen.base.files.options import usage
from plcgen.base.files.yaml import resolve_plain
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.recording.exchange import contact_text
from plcgen.ds47.recording.faults import drive_faults, plan_faults
from plcgen.ds47.recording.jobs import DriveJobWatch, UnitWatch
from plcgen.ds47.recording.partners import Partner, connect
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.sim.faults import KINDS, Fault
from plcgen.ds47.sim.load import value_of
from plcgen.ds47.sim.parameters import SimulatedParameter
from plcgen.ds47.texts import dissect_telegram
from plcgen.ds47.words import DRAIN_MS
from plcgen.report.trace.face import FaultKind, Observed, PartnerOptions, PartnerValue
from plcgen.report.trace.model import Contact
from plcgen.report.trace.recorder import SHAPES, RecordingCpu
from plcgen.s7.cpu.system.port import Periphery
from plcgen.s7.cpu.system.record import RecordJob

_PUT = re.compile(
    r"(?P<drive>\w+)\.[PpRr]?(?P<number>[0-9]{1,5})(?:\[(?P<index>[0-9]{1,5})(?:\.\.[0-9]+)?\])?\s*=(?P<value>.*)",
    re.DOTALL,
)
_LABEL = re.compile(r"([rP])([0-9]+)")


class DriveRecording:
    """What can be recorded of drives and jobs."""

    faults = tuple(kind.value for kind in KINDS)
    fault = "busy:times=2"
    drain = DRAIN_MS
    words = ("record call", "drive")
    calls = tuple(SHAPES.values())

    def __init__(self, plan: DrivePlan) -> None:
        self.plan = plan
        self.jobs = tuple(job.key for job in plan.jobs)
        self.partners = tuple(drive.key for drive in plan.drives)
        self.constants = {drive.id_name: drive.id_value for drive in plan.drives if drive.id_name}
        self.controls = [caller.control.name for caller in plan.callers]
        self._partners: dict[int, Partner] = {}

    def connect(self, bus: Periphery, options: PartnerOptions) -> None:
        """A drive at every address. Raises DiagnosticError."""
        faults = plan_faults(options.faults, options.fault_file, self.partners)
        self._partners = connect(self.plan, options.files, faults)
        for address, partner in self._partners.items():
            bus.attach(address, partner.drive)

    @property
    def kinds(self) -> tuple[FaultKind, ...]:
        """Of all drives, or of one."""
        return drive_faults(self.partners)

    def contents(self) -> Iterator[PartnerValue]:
        """Every parameter that a job accesses: ``drive.P1120``, of an array the element that is accessed first."""
        seen = set[str]()
        for job in self.plan.jobs:
            for use in job.uses:
                at = use.first or 0
                element = "" if use.first is None else f"[{at}]"
                name = f"{job.drive.key}.{use.place.partition('[')[0]}{element}"
                stored = self._stored(job.drive.key, use.parameter.pnu)
                if name in seen or stored is None or at >= len(stored.values):
                    continue
                seen.add(name)
                value = stored.values[at]
                text = value.hex(" ").upper() if isinstance(value, bytes) else str(value)
                yield PartnerValue(name, use.parameter.title, use.parameter.unit, text)

    def put(self, text: str) -> bool:
        """``drive.P1120=5.0``, ``drive.P2900[1]=2``. Raises DiagnosticError."""
        match = _PUT.fullmatch(text.strip())
        stored = self._stored(match["drive"], int(match["number"])) if match else None
        if match is None or stored is None:
            return False
        at = int(match["index"] or 0)
        if at >= len(stored.values):
            raise usage(text, f"the index is outside 0 to {len(stored.values) - 1}")
        try:
            stored.values[at] = value_of(stored.format, resolve_plain(match["value"].strip()))
        except PydanticCustomError as wrong:
            raise usage(text, str((wrong.context or {}).get("message", wrong))) from None
        return True

    def strike(self, fault: str) -> list[Fault]:
        """For all drives, or for ``drive=`` alone. Raises DiagnosticError."""
        planned, struck = plan_faults([fault], None, self.partners), list[Fault]()
        for address, partner in self._partners.items():
            fresh = planned.of(*(one.key for one in self.plan.drives if one.id_value == address))
            partner.drive.faults += fresh
            struck += fresh
        return struck

    def _stored(self, drive: str, pnu: int) -> SimulatedParameter | None:
        """A parameter of the simulated drive behind a drive of the spec."""
        planned = next((one for one in self.plan.drives if one.key == drive), None)
        partner = None if planned is None else self._partners.get(planned.id_value)
        if planned is None or partner is None:
            return None
        objects = partner.drive.objects
        item = objects.get(planned.drive_object) or next(iter(objects.values()))
        return item.parameters.get(pnu)

    def attach(self, cpu: RecordingCpu) -> RecordedDrives:
        """Watch units, jobs and drives."""
        return RecordedDrives(cpu, self.plan, self._partners)


class RecordedDrives:
    """Drives and jobs on a CPU; what a drive writes into its journal when a record job ends is a contact."""

    def __init__(self, cpu: RecordingCpu, plan: DrivePlan, partners: Mapping[int, Partner]) -> None:
        self._cpu, self._plan = cpu, plan
        self._keys = {id(partner.drive): partner.key for partner in partners.values()}
        self._units = UnitWatch(cpu, plan)
        for address, partner in partners.items():
            if not partner.own:  # the user's own says itself what happens
                partner.drive.asked = partial(self._units.let_come, address, partner.drive)
        self._jobs = {job.key: job for job in plan.jobs}
        found = (_LABEL.match(use.label) for job in plan.jobs for use in job.uses)
        self._letters = {int(label[2]): label[1] for label in found if label}
        self._seen: dict[int, int] = {}
        self._requests: dict[int, bytes] = {}
        self._contacts: list[Contact] = []
        cpu.records.ended = self._note

    def job(self, key: str) -> DriveJobWatch:
        """One job."""
        return DriveJobWatch(self._cpu, self._plan, self._jobs[key], self._units)

    def signals(self) -> Iterator[Observed]:
        """Who holds which unit."""
        return self._units.signals()

    def job_of(self, instance: str) -> str | None:
        """The job that holds the unit of a channel."""
        return self._units.job_of(instance)

    def take(self) -> tuple[Contact, ...]:
        """Records since the last time."""
        found = tuple(self._contacts)
        self._contacts.clear()
        return found

    def _note(self, job: RecordJob) -> None:
        group = self._cpu.group(self._cpu.instance(job.memory, job.offset))
        for drive in (unit for unit in self._cpu.bus.drives.values() if isinstance(unit, Drive)):
            seen = self._seen.get(id(drive), 0)
            for found in drive.journal[seen:]:
                if found.direction == "write" and not found.status:
                    self._requests[id(drive)] = found.data
                asked = self._requests.get(id(drive), b"") if found.direction == "read" else b""
                key = self._keys.get(id(drive), "")
                contact = Contact(group, key, found.direction, found.index, found.status, found.data, asked)
                self._contacts.append(self._explained(contact))
            self._seen[id(drive)] = len(drive.journal)

    def _explained(self, contact: Contact) -> Contact:
        telegram = None
        if contact.data and contact.direction == "write":
            telegram = dissect_telegram(contact.data, "request")
        elif contact.data:
            telegram = dissect_telegram(contact.data, "response", contact.request or None)
        return replace(contact, text=contact_text(contact, self._letters), telegram=telegram)
