"""A simulated S7-200 on a PPI line, for tests, for generated masters and for programs that others wrote.

``Bus`` is what stands behind a line: bytes in with ``receive(data, now)``, bytes out with ``transmit(now)``, times in
milliseconds of a clock that the caller owns. ``Station`` is one CPU on it. Everything else serves these two:
``memory`` and ``profiles`` (areas and their sizes), ``cpu`` (PDUs and their answers), ``faults``, ``load`` (YAML),
``serve`` (a bus on a real line).

    from plcgen.base.line.endpoint import EndpointLine
    from plcgen.sim.s7_200 import Bus, Station

    station = Station(values={"VB100": 0x22})           # CPU 224, address 2, RUN
    bus = Bus([station], faults=["not_ready:times=2"])
    line = EndpointLine(bus)                             # for a client: write, read with virtual waiting
    bus.receive(request, now=0); answer = bus.transmit(now=0)        # for a soft CPU: bytes and scan times
    assert station["VB100"] == 0x22 and bus.journal
"""

from plcgen.ppi.sim.bus import Bus, Traffic
from plcgen.ppi.sim.faults import Fault, FaultKind
from plcgen.ppi.sim.station import Station

__all__ = ["Bus", "Fault", "FaultKind", "Station", "Traffic"]
