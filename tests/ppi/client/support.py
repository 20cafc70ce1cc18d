"""A client on a simulated bus in virtual time, and on a line that says what a test wants."""

from dataclasses import dataclass, field

from plcgen.base.line.endpoint import EndpointLine
from plcgen.ppi.client import Client, Settings
from plcgen.ppi.sim import Bus, Station


def connect(faults=(), *, values=None, symbols=None, settings=None, **station):
    """Return a client, its station, the bus and the line (whose clock is the time of everything)."""
    plc = Station(values=values or {}, **station)
    bus = Bus([plc], faults=list(faults))
    line = EndpointLine(bus, name="bus")
    client = Client(line, settings or Settings(), symbols=symbols, now=lambda: line.clock.now / 1000)
    return client, plc, bus, line


@dataclass
class Script:
    """A partner that answers the n-th write with the n-th entry of ``answers`` (bytes, or None for silence)."""

    answers: list
    heard: list = field(default_factory=list)
    waiting: bytes = b""

    def receive(self, data, _now):
        """Note what is sent and get the answer ready."""
        self.heard.append(bytes(data))
        answer = self.answers.pop(0) if self.answers else None
        self.waiting += answer(data) if callable(answer) else answer or b""

    def transmit(self, _now):
        """Hand the answer out."""
        found, self.waiting = self.waiting, b""
        return found

    def due(self):
        """Nothing comes later."""
        return 0 if self.waiting else None


def scripted(answers, **settings):
    """Return a client that talks to a script, and the script."""
    script = Script(list(answers))
    line = EndpointLine(script, name="script")
    return Client(line, Settings(**settings), now=lambda: line.clock.now / 1000), script, line
