"""The audit of PPI jobs: telegrams that sources state, and the calls of serial modules, as checks and findings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from plcgen.base.diagnostics import Diagnostic
from plcgen.ppi.audit.frames import telegrams
from plcgen.ppi.audit.jobs import match_jobs
from plcgen.ppi.audit.loads import loaded
from plcgen.ppi.audit.memory import assigned, stated
from plcgen.ppi.audit.model import FoundTelegram, ModuleCall
from plcgen.ppi.audit.modules import answer_size, check_receiving, check_sending, module_calls, shown
from plcgen.ppi.plan.nouns import PpiPlan
from plcgen.ppi.wire.dissect import title
from plcgen.ppi.wire.telegram import examine
from plcgen.proof.audited import Audited, audited
from plcgen.proof.checks import Check, CheckGroup, Outcome
from plcgen.s7.read.blocks import Sources
from plcgen.s7.read.buffers import find_buffers

_SHOWN = 24


def audit(plan: PpiPlan, sources: Sources) -> Audited:
    """Find telegrams and calls; their bytes, lengths and rooms are checked, the jobs of the spec are looked for."""
    problems: list[Diagnostic] = []
    buffers = find_buffers(sources, problems)
    memories = [memory for buffer in buffers if (memory := stated(buffer)) is not None]
    found = [
        telegram
        for memory in (*memories, *assigned(sources), *loaded(sources, buffers))
        for telegram in telegrams(memory)
    ]
    match_jobs(plan, found)
    calls = list(module_calls(sources, buffers))
    needed, whose = _longest(plan, found)
    for call in calls:
        if _ours(plan, call):
            check_sending(call, found)
            check_receiving(call, needed, whose)
    for findings in (*(one.findings for one in found), *(call.findings for call in calls)):
        problems += findings.found
    groups = [CheckGroup("ppi", "PPI telegrams", (*map(_telegram, found), *_without(plan, found)))]
    if calls:
        checks = tuple(_call(number, call) for number, call in enumerate(calls, 1))
        groups.append(CheckGroup("modules", "Serial modules", checks))
    return Audited(tuple(groups), tuple(problems))


def _longest(plan: PpiPlan, found: Sequence[FoundTelegram]) -> tuple[int, str]:
    """The longest answer that is to be received: to the telegrams that were found, else to those of the spec."""
    sizes = [(answer_size(one.pdu), f"the answer to {one.title}") for one in found if one.job is not None]
    if not sizes:
        for job in plan.jobs:
            requests = [examine(telegram.request.data).pdu for telegram in job.telegrams]
            sizes += [(answer_size(pdu), f"the answer to {job.key}") for pdu in requests if pdu is not None]
    return max(sizes, default=(0, ""))


def _ours(plan: PpiPlan, call: ModuleCall) -> bool:
    """Whether the module may be that of a master: its address is not a constant, or one of the spec."""
    argument = call.call.arguments.get("PORT") or call.call.arguments.get("LADDR")
    ports = {master.port for master in plan.masters}
    if argument is None or argument.value is None or argument.value in ports:
        return True
    call.findings.notes.append(f"module {argument.text} is not that of a master")
    return False


def _telegram(found: FoundTelegram) -> Check:
    kind = title(found.data) if found.data else ""
    data = found.data.hex(" ").upper() if len(found.data) <= _SHOWN else f"{len(found.data)} B"
    good = "a right telegram" if found.job is None else f"a right telegram of {found.job.key}"
    findings, id_ = found.findings, f"ppi.{found.memory.title}.{found.start}"
    return audited(id_, found.title, f"{data}  {kind}".strip(), findings, good)


def _without(plan: PpiPlan, found: Sequence[FoundTelegram]) -> Iterator[Check]:
    """Jobs whose telegrams nothing states: the program may put them together at run time."""
    seen = {id(one.job) for one in found}
    for job in plan.jobs:
        if id(job) not in seen:
            yield Check(f"ppi.{job.key}", f"job {job.key}", "", Outcome.NOT_RUN, "no telegram in the sources")


def _call(number: int, found: ModuleCall) -> Check:
    id_, text = f"modules.{number}.{found.call.block}", shown(found.call)
    if found.room is None and not found.findings.found:
        return Check(id_, found.title, text, Outcome.NOT_RUN, "; ".join(found.findings.notes))
    good = "fits" if found.telegram is None else f"sends {found.telegram.title}"
    return audited(id_, found.title, text, found.findings, good)
