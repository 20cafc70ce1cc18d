"""What documents of drive jobs say: every text, number and name, from telegrams on disk, spec and profile.

A second statement: nothing here is asked of what writes the documents. Whether the accesses that the plan has are those
of the spec is found out first (:mod:`.grounds`); whether the telegrams are, elsewhere.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from types import MappingProxyType

from plcgen.base.diagnostics import Diagnostic
from plcgen.ds47.kind import Poll, Wait
from plcgen.ds47.plan.access import Column, Compare, Form, Mask, Recount, Remember, Use, Verify, Write
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.ds47.proof.wording import guide
from plcgen.ds47.proof.wording.grounds import Stated, groundless, stated_of
from plcgen.ds47.proof.wording.meanings import Meanings, lengths, of_answer, of_request
from plcgen.ds47.proof.wording.naming import (
    bit_label,
    first_labels,
    in_unit,
    labels,
    line,
    telegram_values,
    value_texts,
    waits_for,
)
from plcgen.ds47.registry import kind_called
from plcgen.project.nouns import PlannedJob
from plcgen.proof.wording.comments import EMPTY
from plcgen.proof.wording.model import GENERATOR, GuideLine, Shown, agrees, held, states
from plcgen.s7.types.blocks import Block, BlockKind

_KINDS = {
    "read": "Read", "write": "Write", "compare": "Compare", "save": "Save",
    "read_recipe": "Read", "write_recipe": "Write", "compare_recipe": "Compare",
}  # fmt: skip
_TITLES = {
    "acknowledge": ("Acknowledge the faults of the drive object",),
    "clock": ("Set the clock of the control unit",),
    "service": ("Service: read any parameter",),
    "activate": tuple(f"{word} the drive object" for word in ("Activate", "Deactivate", "Activate or deactivate")),
}
FAMILY = "DS47"
VERSIONS = {"channel": "1.2", "ticket": "1.1", "gate": "1.0"}
"""Of the blocks of the engine."""
_CONDITION = re.compile(r"[rP]\d\S* [=<>]+ [^,，]+")
_EXPECTED = re.compile(r"\S*expected\[(?P<number>\d+)\] :=")
INTEGERS = frozenset({"SINT", "USINT", "INT", "UINT", "DINT", "UDINT", "LINT", "ULINT"})


class DriveWording:
    """All documents of one plan of drive jobs."""

    family, tag_table, jobs_called = FAMILY, "DriveJobTags", "drive jobs"
    symbols: Mapping[str, str] = MappingProxyType({})
    system_blocks = ("SFB52", "SFB53")
    note = "the call form of WRREC and RDREC is inferred; no genuine export was available to compare with"

    def __init__(self, plan: DrivePlan) -> None:
        self.plan = plan
        self.jobs = {job.block.name.upper(): job for job in plan.shapes}
        self.controls = {caller.control.name.upper(): caller for caller in plan.callers}
        self.callers = {caller.block.name.upper(): caller for caller in plan.callers}
        self.instances = {caller.instance.name.upper() for caller in plan.callers}
        self.recipes = {recipe.type.name.upper(): recipe for recipe in plan.recipes}
        self.records = {recipe.db.name.upper(): recipe for recipe in plan.recipes}
        self.numbers = {job.permitted.db.name.upper(): job for job in plan.shapes if job.permitted is not None}
        self.units = {unit.db.name.upper(): unit for unit in plan.units}
        self.diagnoses = {job.diagnosis.name.upper(): job for job in plan.shapes}
        self.entries = {job.listed.type.name.upper(): job for job in plan.shapes if job.listed is not None}

    @cached_property
    def english(self) -> bool:
        """Whether the sources are in English."""
        return self.plan.languages[0].startswith("en")

    @property
    def stated(self) -> Stated:
        """What the spec demands, read a second time."""
        return stated_of(self.plan)

    @cached_property
    def engine(self) -> dict[str, str]:
        """What each block of the engine is, by its name in capitals."""
        roles = ("order", "turn", "ask", "unit", "place", "gate_type", "gate_db", "ticket", "gate", "channel")
        return {getattr(self.plan.engine, role).name.upper(): role for role in roles}

    @cached_property
    def buffers(self) -> dict[str, tuple[DriveJob, int, bool]]:
        """Job, telegram from 0, and whether it is the answer, of every type and data block of a telegram."""
        return {
            block.name.upper(): (job, number, answer)
            for job in self.plan.shapes
            for number, telegram in enumerate(job.telegrams)
            for answer, buffer in ((False, telegram.request), (True, telegram.response))
            for block in (buffer.type, buffer.home)
        }

    # ---- members

    def member(self, block: Block, path: Sequence[str], offset: int | None) -> frozenset[str] | None:
        """What a member may say of itself; None if this protocol has no such block."""
        name = block.name.upper()
        if name in self.buffers and block.kind is not BlockKind.FB:
            return self.meaning(name)[offset] if offset is not None else None
        if name in self.engine:
            return _sentence(self.engine[name], path[-1])
        if name in self.jobs:
            return self._of_job(self.jobs[name], path[-1], "job")
        if name in self.diagnoses:
            return _sentence("diagnosis", path[-1], _features(self.diagnoses[name]))
        if name in self.controls:
            return self._command(path)
        if name in self.callers:
            return self._called(path[-1])
        if name in self.units:
            return _sentence("unit_db", path[-1])
        if name in self.records:
            return _sentence("recipe", path[-1])
        if name in self.numbers:
            return _sentence("numbers", path[-1].partition("[")[0])
        if name in self.recipes:
            uses = [use for use in self.recipes[name].uses if use.member == path[-1]]
            return frozenset(one for use in uses for one in value_texts(use, use.label))
        return self._entry(name, path[-1]) if name in self.entries else None

    def assigned(self, block: Block, path: str) -> frozenset[str] | None:
        """What stands behind the start value of a place: the name of a record; of an element of an array nothing."""
        name = block.name.upper()
        if name in self.records:
            number = int(re.findall(r"\[(\d+)\]", path)[0])
            return frozenset(self.records[name].names[number - 1 : number])
        return frozenset({""}) if name in self.buffers or name in self.numbers else None

    def meaning(self, name: str) -> Meanings:
        """Texts of the bytes of a telegram."""
        job, number, answer = self.buffers[name]
        data = job.telegrams[number].request.data
        return (of_answer if answer else of_request)(data, telegram_values(job, number))

    def _of_job(self, job: DriveJob, name: str, role: str) -> frozenset[str]:
        """A member of a job's block or of its structure."""
        called = labels(job)
        found: set[str] = set()
        for use in job.uses if not job.whole or job.deviations is not None or job.recipe is not None else ():
            if use.member == name:
                found |= value_texts(use, called[use.position])
            for bit in (*use.bits, *use.shown):
                if bit.member == name:
                    label = called[use.position] if bit.as_(Form) else bit_label(use, bit, called[use.position])
                    found |= value_texts(bit, label)
        features, figures = _features(job), {"records": job.recipe.count if job.recipe else 0, "cycle": job.cycle}
        found |= _sentence(role, name, features, figures) | _sentence("delivered", name, features, figures)
        return frozenset(found - {""} or found)

    def _command(self, path: Sequence[str]) -> frozenset[str] | None:
        job = next((job for job in self.plan.jobs if job.member == path[0]), None)
        if job is None:
            return frozenset({EMPTY}) if list(path) == ["unused"] else None
        if len(path) == 1:
            return self.called(job)
        return self._of_job(job, path[1], "control")

    def _called(self, name: str) -> frozenset[str] | None:
        drives = {job.member: job.drive.key for job in self.plan.jobs}
        channels = {unit.member: unit.key for unit in self.plan.units}
        found = drives.get(name, channels.get(name))
        return _sentence("caller", name) if found is None else frozenset({found})

    def _entry(self, name: str, member: str) -> frozenset[str] | None:
        job = self.entries[name]
        if job.deviations is not None:
            return _sentence("entry", member)
        return frozenset(
            line(f"r{use.parameter.pnu:04d} {use.parameter.title}{in_unit(use)}")
            for use in job.uses
            if (column := use.as_(Column))
            and column.name.replace("_", "").lower() == member.lower()
            and column.group == 0
        )

    # ---- titles

    def title(self, block: Block) -> frozenset[str] | None:
        """What the title of a block may be; None if this protocol has no such block."""
        name = block.name.upper()
        if name in self.jobs:
            return self.job_titles(self.jobs[name])
        if name in self.buffers and block.kind is BlockKind.DB:
            job, _, answer = self.buffers[name]
            return frozenset(f"{'Response' if answer else 'Request'}: {one}" for one in self.job_titles(job))
        if name in self.units:
            drives = [drive.key for drive in self.plan.drives if drive.unit is self.units[name]]
            return frozenset({f"Unit {self.units[name].key}: {', '.join(drives[:3])}"})
        if name in self.records:
            return frozenset({f"Records of recipe {self.records[name].key}"})
        if name in self.numbers:
            return frozenset({f"Numbers that {self.numbers[name].block.name} may write"})
        for what, callers in (("Calls", self.callers), ("Commands and results", self.controls)):
            if name in callers:
                part = f"{what} of drive jobs, part {callers[name].number}"
                return frozenset({part if len(self.plan.callers) > 1 else f"{what} of all drive jobs"})
        words = {
            "ticket": "How a job asks for its unit and waits for its turn", "gate_db": "Places for record jobs",
            "gate": "Places for record jobs of this CPU", "channel": "Parameter channel of one drive unit",
        }  # fmt: skip
        untitled = name in {*self.engine, *self.buffers, *self.recipes, *self.entries, *self.diagnoses, *self.instances}
        return frozenset({words.get(self.engine.get(name, ""), "")}) if untitled else None

    def spoken(self, block: Block) -> dict[str, str] | None:
        """What the spec says of the job, the recipe, or the only drive of a unit."""
        name = block.name.upper()
        if name in self.buffers:
            return self.buffers[name][0].comment
        if others := (self.entries | self.diagnoses | self.numbers).get(name):
            return others.comment
        if name in self.recipes:
            return self.recipes[name].comment
        if name in self.units:
            drives = [drive for drive in self.plan.drives if drive.unit is self.units[name]]
            return drives[0].comment if len(drives) == 1 else {}
        if name in self.records:
            return self.records[name].comment
        return None if self.title(block) is None else {}

    def called(self, job: PlannedJob) -> frozenset[str] | None:
        """The title of a job, and the drive if it is one of several."""
        if not isinstance(job, DriveJob):
            return None
        return frozenset(_of_drive(title, job) for title in self.job_titles(job))

    def job_titles(self, job: DriveJob) -> frozenset[str]:
        """What a job may be called: what the spec says of it in any language, or what it does."""
        said = frozenset(line(text) for text in job.comment.values() if text)
        return said if any(map(held, said)) else said | self._own_titles(job)

    def _own_titles(self, job: DriveJob) -> frozenset[str]:
        """What a job may be called of which the spec says nothing that every source can hold."""
        if job.in_steps and job.kind == "sequence":
            return frozenset({f"Sequence of {max(use.step for use in job.uses)} steps"})
        if job.messages is not None:
            history = " and their history" if len(job.messages.settings.latest_last) > 1 else ""
            return frozenset({f"Read the {job.kind} that are present{history}"})
        if job.permitted is not None:
            return frozenset({"Service: read any parameter, write harmless ones"})
        own = None if job.kind in _KINDS or job.kind in _TITLES else kind_called(job.kind).title
        if own is not None:  # a kind of another distribution says itself what it is called
            return frozenset({own(getattr(self.plan.entry(job), job.kind))})
        return frozenset(_TITLES.get(job.kind, (self._what(job),)))

    def _what(self, job: DriveJob) -> str:
        """The kind of a job and the parameters that its telegrams name."""
        called = labels(job)
        uses = [use for use in job.uses if not isinstance(use.role, Poll | Verify | Mask)]
        uses = [use for use in uses if use.writes] if job.restores else uses
        then = ", or restore" if job.restores else ""
        if job.verified and job.poll is not None:
            uses, then = uses[:-1], f", then save{then}"
        what = first_labels([called[use.position] for use in uses])
        if job.recipe is not None:
            what = f"recipe {job.recipe.key}"
        return f"{_KINDS.get(job.kind, job.kind.capitalize())}{' and read back' if job.verified else ''} {what}{then}"

    # ---- lines at the head of a block

    def head(self, block: Block) -> Iterator[str]:
        """What is wrong with the lines at the head of a block: in a job, which number of errors is which parameter."""
        name, said = block.name.upper(), block.comment.split("\n") if block.comment else []
        job = self.jobs.get(name)
        if job is None:
            role = "caller" if name in self.callers else self.engine.get(name, "")
            wanted = guide.sentences()["head"].get(role, [])
            yield from (f'no source for "{text}"' for text in said if not self._known(text, wanted))
            return
        own, numbered = said[: -len(job.uses)], said[-len(job.uses) :]
        known = {line(text) for text in job.comment.values()}
        yield from (f'no source for "{text}"' for text in own if line(text) not in known)
        called = labels(job)
        for use, text in zip(job.uses, numbered, strict=False):
            if not self._numbered(job, use, called[use.position], text):
                yield f'"{text}" is not what the telegrams say of parameter {use.position}, {called[use.position]}'
        if len(numbered) < len(job.uses):
            yield f"{len(job.uses)} parameters, {len(numbered)} of them are named"

    def remark(self, block: Block, code: str, text: str) -> bool:
        """Whether a comment in the code is known; one that names a parameter names one of the telegram."""
        job = self.jobs.get(block.name.upper())
        if text in guide.sentences()["code"]["remarks"] or job is None:
            return text in guide.sentences()["code"]["remarks"]
        called, place = labels(job), _EXPECTED.match(code)
        if place is not None:
            number = int(place["number"]) - 1
            return any(
                text == called[part.use.position] or text == f"{called[part.use.position]} from index {part.subindex}"
                for telegram in job.telegrams
                for part in telegram.parts[number : number + 1]
            )
        if any(waits_for(text, job, use, called[use.position]) for use in job.uses):
            return True
        told = text.removesuffix(": all other bits as they were read").removesuffix(": the answer says the type")
        return told in called.values()

    def retains(self, block: Block) -> bool:
        """The records of a recipe, unless the spec says otherwise."""
        recipe = self.records.get(block.name.upper())
        return recipe is not None and self.plan.spec.recipes[recipe.key].retain

    def starts(self, block: Block) -> dict[str, bytes | str] | None:
        """Start values of the pins of a job: its inputs have those that its telegrams have."""
        job = self.jobs.get(block.name.upper())
        if job is None:
            return None
        record = {"recordNumber": "1"} if job.recipe is not None else {}
        number = "L#964" if self.plan.target.v5 else "964"
        asked = {"number": number, "count": "1", "axis": "-1"} if job.serves else {}
        return {"status": "W#16#7000", **record, **asked, **{use.member: use.data for use in job.inputs}}

    def instructions(self) -> dict[str, str]:
        """Versions as public exports have them (evidence in docs/generated-code.md), or those of the spec."""
        own = self.plan.loaded.spec.plc.instructions.model_dump(exclude_none=True)
        return {"WRREC": "1.1" if self.plan.target.t15 else "1.0", "RDREC": "1.0", "TON_TIME": "1.0", **own}

    def version(self, block: Block) -> str | None:
        """Of the blocks whose code is the same in every project a number of their own, plcgen's of jobs and callers."""
        if self.title(block) is None:
            return None
        return VERSIONS.get(self.engine.get(block.name.upper(), ""), GENERATOR if block.kind is BlockKind.FB else "0.1")

    def _numbered(self, job: DriveJob, use: Use, called: str, text: str) -> bool:
        """Whether a line says which access has a number: what is done with which parameter, or what is waited for."""
        step = f"step {use.step} " if use.step else ""
        if not self.english:
            conditions = _CONDITION.findall(text) if use.as_(Wait) else ()
            waits = not use.as_(Wait) or any(waits_for(c, job, use, called, english=False) for c in conditions)
            front = f"{use.position}: {step}{'' if use.as_(Wait) else called}"
            return waits and states(text, front)
        front = f"{use.position}: {step}"
        if not text.startswith(front):
            return False
        rest, title = text.removeprefix(front), line(use.parameter.title)
        if use.as_(Wait):
            said = rest.removeprefix("waits for ").removesuffix(f", {title}" if title else "")
            return rest.startswith("waits for ") and waits_for(said, job, use, called)
        verb = _VERBS.get(type(use.role), "reads")
        return rest == line(f"{verb} {called} {title}")

    def _known(self, text: str, wanted: Iterable[str]) -> bool:
        return agrees(text, frozenset(wanted), english=self.english)

    # ---- what tables show

    def sheet(self, block: Block) -> list[frozenset[str]] | None:
        """Lines above the tables of a block in the layout sheet: its telegrams; None if it has no part there."""
        job = self.jobs.get(block.name.upper())
        recipe = self.recipes.get(block.name.upper())
        if recipe is not None:
            return [frozenset({f"record n begins at byte (n - 1) x {{size}} of DB{recipe.db.number}"})]
        if job is None:
            return None
        found = []
        for number, telegram in enumerate(job.telegrams):
            data = telegram.request.data
            good, longest = lengths(data, telegram_values(job, number))
            room = max(longest, telegram.pinned or 0)
            asked = f"request `{data.hex(' ').upper()}` (LEN {len(data)}), its reference (byte 0) new in every run"
            found.append(frozenset({f"{asked}, good answer {good} bytes, longest answer {room} bytes"}))
        return found

    def sheet_title(self, block: Block) -> str:
        """What a block is called there if it has no title of its own."""
        return "a record" if block.name.upper() in self.recipes else ""

    def shown(self, block: Block, path: Sequence[str], type_: str) -> Shown | None:
        """How a watch table shows a member, and what it offers to write; None if nobody knows."""
        name = block.name.upper()
        number = {"REAL": "FloatingPoint", "LREAL": "FloatingPoint", "BOOL": "Bool", "TIME": "Time"}.get(type_, "")
        if name in self.controls:
            formats = {
                one.member: "HEX"
                for job in self.plan.jobs if job.member == path[0]
                for _, one in job.shown if one.as_(Form) == Form("format")
            }  # fmt: skip
            formats |= {f"{use.member}Dword": "HEX" for job in self.plan.jobs if job.serves for use in job.uses}
            formats |= {"writeFormat": "HEX", "writeDword": "HEX"}
            own = {"status": "Hex", "cause": "HEX", "diagnosis": "Hex", **formats}.get(path[1])
            return Shown(own or number or "DEC", "")
        if name not in self.buffers or block.kind is not BlockKind.DB:
            return None
        job, at, answer = self.buffers[name]
        telegram, own = job.telegrams[at], path[-1].partition("[")[0]
        fields = telegram.response.fields if answer else telegram.request.fields
        field = next((field for field in fields if field.name == own), None)
        if field is None:
            return None
        shown = "DEC" if field.role == "pnu" or type_ in INTEGERS else number or "Hex"
        given = field.role == "value" and field.part is not None and not field.part.use.constant
        return Shown(shown, None if not answer and not given else "")

    def guide(self) -> tuple[list[GuideLine], list[GuideLine]]:
        """Parts of the import guide before and behind the order, line by line."""
        return guide.guide_before(self.plan), guide.behind(self.plan, self.stated)

    def groundless(self) -> Iterator[Diagnostic]:
        """Where the plan that texts are held against is not what the spec demands."""
        return groundless(self.plan, self.stated)

    def manifest(self) -> dict[str, object]:
        """What the manifest says of the jobs."""
        return {"jobs": [guide.listed_job(job, self.sheet_lengths(job)) for job in self.plan.jobs]}

    def sheet_lengths(self, job: DriveJob) -> list[tuple[int, int]]:
        """Good and longest answer to each telegram."""
        found = [lengths(one.request.data, telegram_values(job, at)) for at, one in enumerate(job.telegrams)]
        return [
            (good, max(longest, one.pinned or 0)) for (good, longest), one in zip(found, job.telegrams, strict=True)
        ]


_VERBS = {
    Write: "writes", Compare: "compares", Verify: "reads back", Remember: "remembers", Recount: "reads again",
}  # fmt: skip


def _features(job: DriveJob) -> frozenset[str]:
    """What a job does besides sending and taking, as the table of sentences calls it."""
    found = {
        "reads back": job.verified,
        "recipe": job.recipe is not None,
        "steps": job.in_steps,
        "cycle": job.cycle > 0,
        "history": job.messages is not None and len(job.messages.settings.latest_last) > 1,
    }
    return frozenset(name for name, has in found.items() if has)


def _sentence(
    role: str, name: str, features: frozenset[str] = frozenset(), figures: Mapping[str, int] = MappingProxyType({})
) -> frozenset[str]:
    """Texts of a member: those for what the block does, else the one for all; none is the empty text."""
    table = guide.sentences()[role]
    stem = name.rstrip("0123456789") if name not in table else name
    special = [text for key, text in table.items() if (parts := key.partition(":"))[0] == stem and parts[2] in features]
    found = special or [table.get(stem, "")]
    said = [one for text in found for one in ([text] if isinstance(text, str) else text)]
    return frozenset(text.format(**figures) for text in said)


def _of_drive(title: str, job: DriveJob) -> str:
    return title if job.key == job.shape else f"{title} ({job.drive.key})"
