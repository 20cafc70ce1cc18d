"""The drive behind the engine: it follows the script of a scenario."""

from __future__ import annotations

from dataclasses import replace

from plcgen.ds47.sim.drive import Drive, RecordExchange
from plcgen.ds47.wire.status import Direction
from tests.engine.scenario import EngineScenario

STATE_CONFLICT = 0xDE80B500


class DirectedDrive(Drive):
    """A drive that follows the script of a scenario; ``reads`` and ``writes`` count the calls of this run."""

    def __init__(self, plain: Drive) -> None:
        super().__init__(plain.behaviour, plain.objects.values())
        self.begin(EngineScenario(name="idle"))

    def begin(self, scenario: EngineScenario) -> None:
        """Start a run: forget the script before, keep the state of the channel."""
        self.scenario = scenario
        self.journal.clear()
        self.reads = self.writes = self.taken = 0
        self.faults = [replace(fault) for fault in scenario.faults]
        form = "size" if scenario.generic else "exact"
        if (self.behaviour.answer_format, self.behaviour.processing) != (form, scenario.processing):
            self.behaviour = replace(
                self.behaviour, answer_format="size" if scenario.generic else "exact", processing=scenario.processing
            )
            self._server.behaviour = self.behaviour

    def write_record(self, index: int, data: bytes) -> int:
        """Take a request, unless the script has a STATUS for this call."""
        self.writes += 1
        script = self.scenario.writes
        status = script.get(self.writes) or script.get(0, 0)
        if status:
            return self._note("write", index, status, bytes(data))
        status = super().write_record(index, data)
        if not status:
            self.taken += 1
            if self.taken in self.scenario.swallowed:
                self._request = self._response = None
        return status

    def read_record(self, index: int, max_length: int) -> tuple[int, bytes]:
        """Hand out an answer, unless the script has something else for this call."""
        self.reads += 1
        if self.reads in self.scenario.away:
            self._request = self._response = None
        act = self.scenario.reads.get(self.reads) or self.scenario.reads.get(0)
        if isinstance(act, int):
            return self._note("read", index, act, b""), b""
        if self.reads in self.scenario.stale:
            sent = next(exchange.data for exchange in reversed(self.journal) if exchange.direction == "write")
            old = bytes((sent[0] - 1 or 255,)) + bytes((self._response or b"\0\0\0\0")[1:])
            return self._note("read", index, 0, old), old
        if act is not None and self._response is not None:
            self._response = act(self._response)
        return super().read_record(index, max_length)

    def _note(self, direction: Direction, index: int, status: int, data: bytes) -> int:
        self.journal.append(RecordExchange(self.time, direction, index, status, data))
        return status
