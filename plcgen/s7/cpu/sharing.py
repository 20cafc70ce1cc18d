"""What two parts of a program must not share: an instance with record jobs, the unit of a channel, a slot, a drive.

A channel is known by what it is: an FB that calls WRREC or RDREC and has an IN_OUT ``unit``; a job is an FB with an
IN_OUT of the same type. What depends on a variable, and code that is no SCL text, is not judged.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from plcgen.base.diagnostics import Diagnostic, Note, Severity, Span
from plcgen.s7.cpu.call_sites import CallSite, CallSites, DataPath, Reached, absolute_path
from plcgen.s7.cpu.error_obs import missing_obs
from plcgen.s7.cpu.linkage import Linkage, ProgramBlock
from plcgen.s7.scl import ast
from plcgen.s7.types.blocks import BlockKind, SectionKind
from plcgen.s7.types.data_types import NamedType

_RECORD_BLOCKS = {"RDREC": "SFB52", "WRREC": "SFB53"}
_UNIT, _PLACE, _SLOT = "UNIT", "PLACE", "SLOT"
_DRIVE_INPUTS = frozenset({"HARDWAREID", "DRIVEADDRESS"})
_PARAMETER_RECORDS = frozenset({47, 0xB02E, 0xB02F})
"""Data records of the parameter channel (PROFIdrive profile, parameter access points)."""
_SINA = {"SINA_PARA": "HARDWAREID", "SINA_PARA_S": "HARDWAREID"}
"""Blocks of Siemens' DriveLib for parameters, with the input that names the drive."""
_START_UP = frozenset({100, 101, 102})
"""OBs that have ended before another one begins."""


def sharing(link: Linkage, documented: Iterable[int] = ()) -> list[Diagnostic]:
    """PG840 to PG845 for a program that is laid out; ``documented`` are numbers of OBs that only documents have."""
    records = {*_RECORD_BLOCKS, *_RECORD_BLOCKS.values()}
    records |= {link.aliases[number] for number in _RECORD_BLOCKS.values() if number in link.aliases}
    records -= link.blocks.keys()
    sites = CallSites.of(link)
    found = _Sharing(link, sites, records)
    if not found.talking:
        return []
    shared = [*found.two_obs(), *found.two_channels(), *found.two_jobs(), *found.two_units(), *found.foreign_calls()]
    return [*shared, *missing_obs(link, documented)]


@dataclass(slots=True)
class _Sharing:
    """One program: which of its blocks talk to devices, and as what."""

    link: Linkage
    sites: CallSites
    records: set[str]
    talking: set[str] = field(init=False)
    channels: set[str] = field(init=False)
    jobs: set[str] = field(init=False)
    calls: list[tuple[ProgramBlock, Reached]] = field(init=False)
    spelled: dict[str, str] = field(default_factory=dict)
    """Members as declared by their upper-case names, for messages."""

    def __post_init__(self) -> None:
        direct = {site.caller.name.upper() for site in self.sites if site.called in self.records}
        self.channels = {name for name in direct if _UNIT in self.lent(name)}
        units = {self.lent(name)[_UNIT] for name in self.channels}
        blocks = self.link.blocks.keys() - self.channels
        self.jobs = {name for name in blocks if not units.isdisjoint(self.lent(name).values())}
        self.talking = direct | self.sites.callers_of(direct | self.jobs) | self.jobs
        wanted = {name for name in self.talking if self.link.blocks[name].block.kind is BlockKind.FB} | self.records
        self.calls = self.sites.reached(wanted)

    def lent(self, name: str) -> dict[str, str]:
        """IN_OUT parameters of an FB that have a named type, both in upper case."""
        block = self.link.blocks[name].block
        members = block.section(SectionKind.IN_OUT) if block.kind is BlockKind.FB else ()
        return {m.name.upper(): m.type.name.upper() for m in members if isinstance(m.type, NamedType)}

    # --- one instance, two OBs ------------------------------------------------------------------------

    def two_obs(self) -> Iterator[Diagnostic]:
        """PG840 for an instance that two OBs call, at the call in the second; not for what lies in such an instance."""
        first: dict[DataPath, tuple[ProgramBlock, Reached]] = {}
        reported: set[tuple[DataPath, str]] = set()
        for root, call in self.calls:
            if root.block.kind is not BlockKind.OB or call.instance is None:
                continue
            if self.link.ob_number(root) in _START_UP:
                continue
            before, known = first.setdefault(call.instance, (root, call))
            if before is root or any((path, root.name) in reported for path in call.instance.around):
                continue
            reported.add((call.instance, root.name))
            yield self._two_obs(call.instance, known, call)

    def _two_obs(self, instance: DataPath, known: Reached, call: Reached) -> Diagnostic:
        ways = [self._way(step) for step in (known, call)]
        message = f"{self._title(instance)} is called from two OBs: {ways[0]}, and {ways[1]}"
        notes = [Note(f"the path from {known.chain[0].caller.name}", known.chain[0].span)]
        if call.site is not call.chain[0]:
            notes.append(Note("the call of the instance", call.site.span))
        help_ = "call it in one of them; use a separate instance in the other OB, but a device has only one channel"
        return Diagnostic("PG840", message, call.chain[0].span, Severity.WARNING, help=help_, notes=tuple(notes))

    def _way(self, call: Reached) -> str:
        return " -> ".join([*(site.caller.name for site in call.chain), call.site.called_as])

    def _title(self, instance: DataPath) -> str:
        """The instance as one reads it in the sources."""
        entry = self.link.blocks.get(instance.root)
        name = entry.name if entry is not None else instance.root
        if not self.spelled:
            blocks = (known.block for known in self.link.blocks.values())
            self.spelled.update((m.name.upper(), m.name) for b in blocks for m in b.members)
        steps = (step if step.startswith("[") else f".{self.spelled.get(step, step)}" for step in instance.steps)
        return f'"{name}"' + "".join(steps)

    # --- two channels, one unit -----------------------------------------------------------------------

    def two_channels(self) -> Iterator[Diagnostic]:
        """PG841 for a channel whose unit or place another channel has; a warning if no OB is seen to call both."""
        first: dict[tuple[str, DataPath], tuple[ProgramBlock, Reached]] = {}
        pairs: set[tuple[DataPath, DataPath]] = set()
        for root, call in self.calls:
            if call.site.called not in self.channels or call.instance is None:
                continue
            for parameter in (_UNIT, _PLACE):
                actual = self._actual(call, parameter)
                if actual is None:
                    continue
                other, known = first.setdefault((parameter, actual), (root, call))
                if known.instance is None or known.instance == call.instance:
                    continue
                pair = (known.instance, call.instance)
                if pair in pairs:
                    continue
                pairs.add(pair)
                sure = other.block.kind is root.block.kind is BlockKind.OB
                severity = Severity.ERROR if sure else Severity.WARNING
                names = f"{self._title(known.instance)} and {self._title(call.instance)}"
                yield self._two_channels(names, parameter, (known, call), severity)

    def _actual(self, call: Reached, parameter: str) -> DataPath | None:
        """Where the actual parameter lies."""
        argument = call.site.argument(parameter)
        if argument is None or argument.operator == "=>":
            return None
        place = self.sites.names[call.site.caller.index].place(argument.value)
        return absolute_path(place, call.within)

    def _two_channels(
        self, names: str, parameter: str, calls: tuple[Reached, Reached], severity: Severity
    ) -> Diagnostic:
        known, call = calls
        message = f"two channels, {names}, have the same {parameter.lower()}: {call.site.text(parameter)}"
        help_ = "give each channel its own unit and its own place; if both are for the same device, leave one out"
        notes = (Note("the other channel", known.site.span),)
        return Diagnostic("PG841", message, self._span(call.site, parameter), severity, help=help_, notes=notes)

    # --- two jobs, one slot; one drive, two units -------------------------------------------------------

    def two_jobs(self) -> Iterator[Diagnostic]:
        """PG843 for a job in whose slot of the unit another one is."""
        first: dict[tuple[DataPath, int | str], Reached] = {}
        pairs: set[tuple[DataPath, DataPath]] = set()
        for call, unit in self._jobs():
            slot = self._constant(call.site, _SLOT)
            if slot is None or call.instance is None:
                continue
            known = first.setdefault((unit, slot), call)
            if known.instance is None or known.instance == call.instance or (known.instance, call.instance) in pairs:
                continue
            pairs.add((known.instance, call.instance))
            names = f"{self._title(known.instance)} and {self._title(call.instance)}"
            message = f"two jobs of {self._title(unit)}, {names}, have the same slot: {call.site.text(_SLOT)}"
            help_ = "give each job of a unit its own slot, counted from 1, and set the channel's slots to their number"
            span, notes = self._span(call.site, _SLOT), (Note("the other job", known.site.span),)
            yield Diagnostic("PG843", message, span, Severity.WARNING, help=help_, notes=notes)

    def two_units(self) -> Iterator[Diagnostic]:
        """PG844 for a job whose drive another job reaches through another unit."""
        first: dict[int | str, tuple[DataPath, Reached]] = {}
        reported: set[tuple[int | str, DataPath]] = set()
        for call, unit in self._jobs():
            for parameter in _DRIVE_INPUTS:
                drive = self._constant(call.site, parameter)
                if drive is None:
                    continue
                before, known = first.setdefault(drive, (unit, call))
                if before == unit or (drive, unit) in reported:
                    continue
                reported.add((drive, unit))
                units = f"{self._title(before)} and {self._title(unit)}"
                message = f"the drive {call.site.text(parameter)} is reached through two units, {units}"
                help_ = "one device has one unit and one channel, even with several drive objects"
                span, notes = self._span(call.site, parameter), (Note("the other job", known.site.span),)
                yield Diagnostic("PG844", message, span, Severity.WARNING, help=help_, notes=notes)

    def _jobs(self) -> Iterator[tuple[Reached, DataPath]]:
        """Calls of jobs with the unit that each is given."""
        for _, call in self.calls:
            unit = self._actual(call, _UNIT) if call.site.called in self.jobs else None
            if unit is not None:
                yield call, unit

    def _span(self, site: CallSite, parameter: str) -> Span:
        """Where an argument stands."""
        argument = site.argument(parameter)
        return site.caller.result.span(argument if argument is not None else site.node)

    # --- another record call on the drive of a job ------------------------------------------------------

    def foreign_calls(self) -> Iterator[Diagnostic]:
        """PG842 for a record call outside of a channel, or a block around one, on the drive of a job."""
        drives: dict[int | str, CallSite] = {}
        for site in self.sites:
            if site.called in self.jobs:
                for parameter in _DRIVE_INPUTS:
                    drive = self._constant(site, parameter)
                    if drive is not None:
                        drives.setdefault(drive, site)
        hand_on = self._hand_on()
        for site in self.sites:
            if site.called not in hand_on or site.caller.name.upper() in self.channels:
                continue
            parameter = hand_on[site.called]
            drive = self._constant(site, parameter)
            job = drives.get(drive) if drive is not None else None
            if job is None or self._of_other_records(site):
                continue
            own = self.link.blocks.get(site.called)
            who, where = site.called if own is None else own.name, site.text(parameter)
            message = f"{who} talks to {where}, the drive of the job {job.called_as}, bypassing its channel"
            help_ = "read and write it with a job; an answer goes to whoever fetches it first"
            notes = (Note("the job", job.span),)
            yield Diagnostic("PG842", message, site.span, Severity.WARNING, help=help_, notes=notes)

    def _hand_on(self) -> dict[str, str]:
        """Blocks that talk to the device an input of theirs names: record blocks, what hands it on, SINA_PARA."""
        found = dict.fromkeys(self.records, "ID") | {
            sina: by for sina, by in _SINA.items() if sina not in self.link.blocks
        }
        sites: dict[str, list[CallSite]] = {}
        for site in self.sites:
            sites.setdefault(site.called, []).append(site)
        pending = list(found)
        while pending:
            called = pending.pop()
            for site in sites.get(called, ()):
                name, argument = site.caller.name.upper(), site.argument(found[called])
                if argument is None or name in found or name in self.channels or self._of_other_records(site):
                    continue
                given = argument.value
                inputs = {member.name.upper() for member in site.caller.block.section(SectionKind.INPUT)}
                if isinstance(given, ast.Name) and given.name.upper() in inputs:
                    found[name] = given.name.upper()
                    pending.append(name)
        return found

    def _of_other_records(self, site: CallSite) -> bool:
        """Whether a record block is called for a record that is no parameter channel."""
        index = self._constant(site, "INDEX") if site.called in self.records else None
        return isinstance(index, int) and index not in _PARAMETER_RECORDS

    def _constant(self, site: CallSite, parameter: str) -> int | str | None:
        argument = site.argument(parameter)
        return None if argument is None else self.sites.names[site.caller.index].constant(argument.value)
