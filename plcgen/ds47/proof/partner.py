"""The drive behind a job block: it follows the script of a scenario."""

from __future__ import annotations

from dataclasses import replace

from plcgen.ds47.proof.scenario import DriveScenario
from plcgen.ds47.sim.drive import Drive, RecordExchange
from plcgen.ds47.sim.parameters import SimulatedParameter
from plcgen.ds47.wire.model import RequestId


class ScriptedDrive(Drive):
    """A drive that follows the script of a scenario; ``reads`` and ``writes`` count the calls of this run."""

    def __init__(self, plain: Drive) -> None:
        super().__init__(plain.behaviour, plain.objects.values())
        self.own = plain.behaviour
        self.begin(DriveScenario(name="idle"))

    def begin(self, scenario: DriveScenario) -> None:
        """Start a run: forget the script before, keep the state of the channel."""
        self.scenario = scenario
        self.journal.clear()
        self.reads = self.writes = 0
        self.faults = [replace(fault) for fault in scenario.faults]
        self._clearing.clear()
        self.disturbed = not scenario.meanwhile
        for item in self.objects.values():
            for pnu, parameter in item.parameters.items():
                parameter.keeps = scenario.keeps.get(pnu)
        for parameter in self.saving_parameters():
            parameter.clears_after, parameter.saved, parameter.remaining = scenario.saving, (), scenario.remaining
        form = self.own.answer_format if scenario.generic is None else "size" if scenario.generic else "exact"
        if self.behaviour.answer_format != form:
            self.behaviour = self._server.behaviour = replace(self.own, answer_format=form)

    def saving_parameters(self) -> list[SimulatedParameter]:
        """Those that start saving, or acknowledge."""
        every = (one for item in self.objects.values() for one in item.parameters.values())
        return [one for one in every if one.saves or one.acknowledges]

    def switch_off(self) -> None:
        """Off and on again: the request and its answer are lost, the values are not."""
        self._request = self._response = self._previous = None

    def write_record(self, index: int, data: bytes) -> int:
        """Take a request, unless the script has a STATUS for this call."""
        self.writes += 1
        script = self.scenario.writes
        event = self.scenario.events.get(self.writes)
        if event is not None:
            event(self)
        status = script.get(self.writes) or script.get(0, 0)
        if not self.disturbed and data[1] == RequestId.READ and self.changed:
            self.disturb()
        if status:
            self.journal.append(RecordExchange(self.time, "write", index, status, bytes(data)))
            return status
        return super().write_record(index, data)

    @property
    def changed(self) -> bool:
        """Whether a change was sent in this run."""
        return any(one.direction == "write" and one.data[1] == RequestId.CHANGE for one in self.journal)

    def disturb(self) -> None:
        """Somebody else changes what was written, once in a run."""
        self.disturbed = True
        for item in self.objects.values():
            for pnu, keeps in self.scenario.meanwhile.items():
                values = item.parameters[pnu].values
                values[:] = [keeps(index, value) for index, value in enumerate(values)]

    def read_record(self, index: int, max_length: int) -> tuple[int, bytes]:
        """Hand out an answer, unless the script has something else for this call."""
        self.reads += 1
        act = self.scenario.reads.get(self.reads) or self.scenario.reads.get(0)
        if isinstance(act, int):
            self.journal.append(RecordExchange(self.time, "read", index, act, b""))
            return act, b""
        if act is not None and self._response is not None:
            self._response = act(self._response)
        return super().read_record(index, max_length)
