"""What documents of PPI masters say: every text, number and name, from telegrams on disk and the spec.

A second statement: nothing here is asked of what writes the documents. Whether the accesses that the plan has are those
of the spec is found out first (``grounds``); whether the telegrams are, elsewhere.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from itertools import chain
from types import MappingProxyType

from plcgen.base.diagnostics import Diagnostic
from plcgen.oracles.spec.place import Keys, NotStatedError
from plcgen.oracles.spec.ppi.statement import SERVICES, PpiStatement, StatedAddress, StatedPort
from plcgen.ppi.plan.nouns import PlannedMaster, PpiJob, PpiPlan, PpiTelegram, PpiValue
from plcgen.ppi.proof.stated.rig import ports_of
from plcgen.ppi.proof.wording import guide
from plcgen.ppi.proof.wording.guide import asked_items, called, holds, of_answer, of_table
from plcgen.ppi.schema import PpiMaster, PpiSection
from plcgen.project.nouns import PlannedJob
from plcgen.proof.folder import plain
from plcgen.proof.wording.comments import EMPTY
from plcgen.proof.wording.model import GENERATOR, GuideLine, Shown, agrees, held, unlike, untitled
from plcgen.s7.types.blocks import Block, BlockKind
from plcgen.s7.types.names import shorten

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
        found = _grounds_of_master(masters[key], port) if key in masters else iter([(port.path, "no document has it")])
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


def _grounds_of_master(master: PlannedMaster, port: StatedPort) -> Iterator[Difference]:
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
        yield from _grounds_of_job(jobs[key], stated[key])


def _grounds_of_job(job: PpiJob, stated: PpiStatement) -> Iterator[Difference]:
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


_VERBS = {"read": "Read", "write": "Write", "run": "Switch to RUN", "stop": "Switch to STOP"}
_MOST = 4
"""So many names stand in a title."""
_NUMBERED = re.compile(r"(?P<number>\d+):")
INTEGERS = frozenset({"SINT", "USINT", "INT", "UINT", "DINT", "UDINT"})
_NOTHING: frozenset[str] = frozenset({""})


class PpiWording:
    """All documents of one plan of PPI masters."""

    family, tag_table, jobs_called = "PPI", "PpiJobTags", "jobs"
    system_blocks: Sequence[str] = ()
    symbols: Mapping[str, str] = MappingProxyType({"P_RCV_RK": "CP 341: receive", "P_SND_RK": "CP 341: send"})
    note = "the call form of the blocks for serial modules is inferred; no genuine export was available to compare with"

    def __init__(self, plan: PpiPlan) -> None:
        self.plan = plan
        self.masters = {master.block.name.upper(): master for master in plan.masters}
        self.frames = {master.buffer.name.upper(): master for master in plan.masters if master.buffer is not None}
        own = [block for master in plan.masters for block in (master.instance, *(master.module_instances or ()))]
        self.instances = {block.name.upper() for block in own}
        self.control, self.diagnostics = plan.control_db.name.upper(), plan.diagnostics_type.name.upper()

    @property
    def controls(self) -> tuple[str]:
        """One for all masters."""
        return (self.control,)

    @cached_property
    def buffers(self) -> dict[str, tuple[PlannedMaster, PpiTelegram, bool]]:
        """Master, telegram, and whether it is the answer, of every type and data block of a telegram."""
        return {
            block.name.upper(): (master, telegram, answer > 0)
            for master in self.plan.masters
            for telegram in master.telegrams
            for answer, buffer in enumerate(telegram.buffers)
            for block in (buffer.type, buffer.home)
        }

    # ---- members

    def member(self, block: Block, path: Sequence[str], offset: int | None) -> frozenset[str] | None:
        """What a member may say of itself; None if this protocol has no such block."""
        name = block.name.upper()
        if name in self.buffers:
            alone = block.kind is BlockKind.DB and not self.buffers[name][2]
            return _NOTHING if alone and list(path) == ["telegram"] else self.meanings(name).get(offset or 0)
        if name in self.masters:
            return self._pin(self.masters[name], path[-1])
        if name == self.control:
            return self._command(path)
        for role, names in (("diagnostics", {self.diagnostics}), ("frames", set(self.frames))):
            if name in names:
                return _sentence(role, path[-1])
        return None

    def assigned(self, block: Block, path: str) -> frozenset[str] | None:
        """What stands behind the start value of a place; the offset says which member it is."""
        name = block.name.upper()
        if name not in self.buffers:
            return None
        _, telegram, answer = self.buffers[name]
        own = path.removeprefix("telegram.").partition("[")[0]
        fields = telegram.buffers[answer].fields
        place = next((field.offset for field in fields if field.name == own), None)
        return None if place is None else self.meanings(name).get(place)

    def meanings(self, name: str) -> dict[int, frozenset[str]]:
        """Texts of the bytes of a telegram table or a response DB."""
        _, telegram, answer = self.buffers[name]
        data = telegram.request.data
        labels = [[placed.value.label for placed in wire.values] for wire in telegram.items]
        asked = asked_items(data)
        single = [
            _texts(wire.values[0].value) if len(wire.values) == 1 else frozenset({f"{called(item, labels[at])}: value"})
            for at, (wire, item) in enumerate(zip(telegram.items, asked, strict=True))
        ]
        return (of_answer if answer else of_table)(data, labels, single)

    def _pin(self, master: PlannedMaster, name: str) -> frozenset[str]:
        for job in master.jobs:
            cycle = f", then every {job.cycle} ms while it is TRUE" if job.cycle else ""
            signals = {
                "execute": f"{job.key}: a rising edge starts the job{cycle}",
                "busy": f"{job.key} is running or waits for the port",
                "done": f"{job.key} ended well; stays until execute falls, at least one call",
                "error": f"{job.key} failed; stays until execute falls, at least one call",
                "status": f"result of {job.key}",
                "errors": f"{job.key}, per address: 0 = good, 16#80nn = return code nn of the station",
            }
            for signal, text in signals.items():
                if job.pin(signal) == name:
                    return frozenset({text})
            for value in job.values:
                pin = job.pin(value.member)
                if pin == name:
                    return frozenset(f"{job.key}: {text}" for text in _texts(value))
                if shorten(f"stat{pin[:1].upper()}{pin[1:]}", job.longest_name) == name:
                    return frozenset({f"{pin} when the job started"})
        return _sentence("master", name, baud=master.baud)

    def _command(self, path: Sequence[str]) -> frozenset[str] | None:
        found = next((pair for pair in self.all_jobs if pair[1].member == path[0]), None)
        if found is None:
            return frozenset({EMPTY}) if list(path) == ["unused"] else None
        job = found[1]
        if len(path) == 1:
            return self.called(job)
        if path[1] == "execute" and job.cycle:
            return frozenset({f"TRUE: the job runs every {job.cycle} ms"})
        values = [value for value in job.values if value.member == path[1]]
        return frozenset(text for value in values for text in _texts(value)) or _sentence("command", path[1])

    @cached_property
    def all_jobs(self) -> list[tuple[PlannedMaster, PpiJob]]:
        """Every job with its master."""
        return [(master, job) for master in self.plan.masters for job in master.jobs]

    # ---- titles

    def title(self, block: Block) -> frozenset[str] | None:
        """What the title of a block may be; None if this protocol has no such block."""
        name = block.name.upper()
        if name in self.masters:
            return _of_master(self.masters[name])
        if name in self.frames:
            return frozenset(f"Frames: {title}" for title in _of_master(self.frames[name]))
        if name in self.buffers and block.kind is BlockKind.DB:
            master, telegram, answer = self.buffers[name]
            what = "Response" if answer else "Telegram table"
            return frozenset(f"{what}: {title}" for title in _of_telegram(master, telegram))
        if name == self.control:
            return frozenset({"Commands and results of all PPI jobs"})
        return _NOTHING if name in {*self.buffers, *self.instances, self.diagnostics} else None

    def spoken(self, block: Block) -> dict[str, str] | None:
        """No type or data block has a comment."""
        return None if self.title(block) is None else {}

    def called(self, job: PlannedJob) -> frozenset[str] | None:
        """The title of a job."""
        return _of_job(job) if isinstance(job, PpiJob) else None

    def head(self, block: Block) -> Iterator[str]:
        """What is wrong with the lines at the head of a master; and of labels, with what its telegrams address."""
        master = self.masters.get(block.name.upper())
        said = block.comment.split("\n") if block.comment else []
        if master is None:
            yield from (f'no source for "{text}"' for text in said if text)
            return
        own = master.telegrams[0].request.data[5] if master.telegrams else master.own_address
        module = f"{guide.MODULES[master.module]}, {master.baud} bit/s"
        wanted = [
            frozenset({f"PPI master {master.key}: {module}, 8 data bits, even parity, 1 stop bit, own address {own}"}),
            *(frozenset({f"station {one.address}: {one.key}, {one.profile.title}"}) for one in master.stations),
            *(
                frozenset(
                    f"job {job.number} {job.key}: {title}{f', every {job.cycle} ms' if job.cycle else ''}"
                    for title in _of_job(job)
                )
                for job in master.jobs
            ),
            *(frozenset({text}) for text in guide.sentences()["head"]["lines"]),
        ]
        if len(said) != len(wanted):
            yield f"{len(said)} lines at its head, {len(wanted)} are stated"
        english = self.plan.languages[0].startswith("en")
        for text, texts in zip(said, wanted, strict=False):
            if not agrees(text, texts, english=english):
                yield f'no source for "{text}"; stated: "{min(texts)}"'
        # names of values that lie elsewhere than their telegram asks, stations with another address
        for telegram in master.telegrams:
            data = telegram.request.data
            if data[4] != telegram.station.address:
                station = telegram.station
                yield f"telegram {telegram.number} goes to {data[4]}, {station.key} is {station.address}"
            for item, wire in zip(asked_items(data), telegram.items, strict=True):
                for placed in wire.values:
                    if not holds(item, placed.value.label, placed.start):
                        yield f"telegram {telegram.number} does not address {placed.value.label}"

    def remark(self, block: Block, code: str, text: str) -> bool:
        """Whether a comment in the code is known; behind the number of a branch stands what has the number."""
        master, branch = self.masters.get(block.name.upper()), _NUMBERED.fullmatch(code)
        if master is None or branch is None:
            return text in guide.sentences()["code"]["remarks"]
        number = int(branch["number"])
        jobs = [job.key for job in master.jobs if job.number == number]
        telegrams = [_in_code(master, one) for one in master.telegrams if one.number == number]
        wires = [wire for one in master.telegrams for wire in one.items if wire.number == number]
        labels = [", ".join(placed.value.label for placed in wire.values) for wire in wires]
        return text in {*jobs, *telegrams, *labels}

    def retains(self, block: Block) -> bool:
        """None keeps its values."""
        del block
        return False

    def starts(self, block: Block) -> dict[str, bytes | str] | None:
        """Start values of the pins of a master: its inputs have those of the spec, which are those of the tables."""
        master = self.masters.get(block.name.upper())
        if master is None:
            return None
        found: dict[str, bytes | str] = {"port": str(master.port), "moduleAddress": str(master.port)}
        for job in master.jobs:
            found[job.pin("status")] = "W#16#7000"
            found |= {job.pin(value.member): value.data for value in job.inputs}
        return found

    def instructions(self) -> dict[str, str]:
        """The timer; the blocks for serial modules are declared without a version."""
        return {"TON_TIME": self.plan.loaded.spec.plc.instructions.TON_TIME or "1.0"}

    def version(self, block: Block) -> str | None:
        """That of plcgen of masters, 0.1 of other blocks."""
        if self.title(block) is None:
            return None
        return GENERATOR if block.kind is BlockKind.FB else "0.1"

    # ---- what tables show

    def sheet(self, block: Block) -> list[frozenset[str]] | None:
        """Lines above the tables of a master: its telegrams."""
        master = self.masters.get(block.name.upper())
        return None if master is None else [_listed(master, one) for one in master.telegrams]

    def sheet_title(self, block: Block) -> str:
        """None but that of the block."""
        del block
        return ""

    def shown(self, block: Block, path: Sequence[str], type_: str) -> Shown | None:
        """How a watch table shows a member; nothing of it is offered to be written."""
        del path
        name = block.name.upper()
        number = {"REAL": "FloatingPoint", "BOOL": "Bool", "CHAR": "Character"}.get(type_, "")
        if name == self.control:
            hexadecimal = type_ in {"BYTE", "WORD", "DWORD"}
            return Shown(number or ("Hex" if hexadecimal else "DEC"), "")
        if name in self.buffers:
            return Shown(number or ("DEC" if type_ in INTEGERS else "Hex"))
        return None

    def guide(self) -> tuple[list[GuideLine], list[GuideLine]]:
        """Parts of the import guide before and behind the order, line by line."""
        return guide.guide_before(self.plan), []

    def groundless(self) -> Iterator[Diagnostic]:
        """Where the plan that texts are held against is not what the spec demands."""
        return groundless(self.plan)

    def manifest(self) -> dict[str, object]:
        """What the manifest says of the masters."""
        return {"ppi": [guide.listed_master(master) for master in self.plan.masters]}


def _texts(value: PpiValue) -> frozenset[str]:
    """What is said of a value: its address or symbol, and what the spec or the symbol table says about it."""
    said = {*value.comment.values()}
    said |= set() if any(map(held, said)) else {value.title, ""}
    return frozenset(plain(f"{value.label} {text}") for text in said)


def _said(comment: Mapping[str, str], own: str) -> frozenset[str]:
    """What the spec says of something; its own title if that is nothing, or nothing that Windows-1252 has."""
    return frozenset({*comment.values(), *([] if any(map(held, comment.values())) else [own])})


def _of_master(master: PlannedMaster) -> frozenset[str]:
    names = [station.key for station in master.stations]
    own = f"PPI master of {', '.join(names[:_MOST])}{', ..' if len(names) > _MOST else ''}"
    return _said(master.comment, own)


def _of_job(job: PpiJob) -> frozenset[str]:
    names = [value.label for value in job.values]
    what = f"{', '.join(names[:_MOST])}{', ..' if len(names) > _MOST else ''}"
    own = plain(f"{_VERBS[job.kind]} {what} of {job.station.key}")
    return _said(job.comment, own)


def _of_telegram(master: PlannedMaster, telegram: PpiTelegram) -> frozenset[str]:
    job = next((job for job in master.jobs if telegram in job.telegrams), None)
    return frozenset({f"first frame to {telegram.station.key}"}) if job is None else _of_job(job)


def _in_code(master: PlannedMaster, telegram: PpiTelegram) -> str:
    job = next((job for job in master.jobs if telegram in job.telegrams), None)
    return f"first frame to {telegram.station.key}" if job is None else f"{job.key} of {telegram.station.key}"


def _sentence(role: str, name: str, baud: int = 0) -> frozenset[str]:
    return frozenset({guide.sentences()[role].get(name, "").format(baud=baud)})


def _listed(master: PlannedMaster, telegram: PpiTelegram) -> frozenset[str]:
    data = telegram.request.data
    frame = f"`{data.hex(' ').upper()}` ({len(data)} bytes; function code, reference, FCS and inputs change)"
    return frozenset(
        f"telegram {telegram.number}: {untitled(title)}: {frame}" for title in _of_telegram(master, telegram)
    )
