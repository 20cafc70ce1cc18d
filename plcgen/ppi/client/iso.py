"""S7-200 SMART and CP 243-1 over Ethernet: the client's jobs over ISO-on-TCP instead of PPI.

The PDUs are those of PPI, V memory as data block 1 included; only what carries them differs. So this is our own codec
(``plcgen.ppi.wire.iso``, which the gateway needs anyway) below the same client, and not python-snap7: that knows bits,
timers, counters and several items of an S7-200 less well than our client does, and would be a second way to read.

TSAPs: a CP 243-1 has those of its wizard, usually 10.01 there and 10.00 here; a SMART answers to 03.00 or 03.01
(S7netplus issues 332 and 395; libnodave). They are tried one after the other. No real CPU was available.
"""

from __future__ import annotations

import re
import time
from collections import deque
from collections.abc import Callable

from plcgen.base.line.model import CANNOT_OPEN, Line, LineError, LineLostError
from plcgen.base.line.tcp import TcpLine, parse_endpoint
from plcgen.ppi.client.client import Client
from plcgen.ppi.client.exchange import ClientError, Exchange, NoAnswerError, Settings
from plcgen.ppi.wire.iso import PORT, Connect, IsoError, IsoStream, carry, connect_request
from plcgen.ppi.wire.model import Pdu, SetupReply, SetupRequest, VariableFrame
from plcgen.ppi.wire.telegram import DATA_FUNCTION

SCHEME = "s7://"
TSAPS = (("10.00", "10.01"), ("10.00", "03.00"), ("10.00", "03.01"))
"""Ours and that of the PLC."""
_NAME = re.compile(r"s7://([^?/]+)/?(?:\?tsap=([0-9a-f]{2}\.[0-9a-f]{2})/([0-9a-f]{2}\.[0-9a-f]{2}))?", re.IGNORECASE)


class IsoExchange(Exchange):
    """Exchanges over one connection, which must be greeted first. Repetition and errors are those of PPI."""

    def __init__(self, line: Line, settings: Settings, now: Callable[[], float] = time.monotonic) -> None:
        super().__init__(line, settings, now)
        self._stream = IsoStream()
        self._arrived: deque[Connect | bytes] = deque()
        self._frame_count.following()  # TCP repeats nothing: no read is needed in front of a write

    def greet(self, ours: str, theirs: str) -> int:
        """Ask for the connection and negotiate; the longest PDU. Raises LineError, ClientError."""
        self.line.write(connect_request(_tsap(ours), _tsap(theirs)))
        if not isinstance(self._next(self._now() + self.settings.answer), Connect):
            raise NoAnswerError(
                self.line.name, f"no connection to TSAP {theirs}", "name others: s7://HOST?tsap=10.00/10.01"
            )
        reply = self.run(SetupRequest(1))
        if not isinstance(reply, SetupReply) or reply.pdu_size < 60:
            raise NoAnswerError(self.line.name, "the negotiation is answered with something else")
        return reply.pdu_size

    def _one(self, pdu: bytes, reference: int) -> Pdu:
        """Send a PDU and wait for its answer; older ones are passed over."""
        self.count.exchanges += 1
        self.count.sends += 1
        self._asked, why = False, "no answer"
        self.line.write(carry(pdu))
        end = self._now() + self.settings.answer
        while (found := self._next(end)) is not None:
            if isinstance(found, bytes):
                frame = VariableFrame(self.settings.own, self.settings.station, DATA_FUNCTION, found)
                reply, why = self._reply(pdu, reference, frame)
                if reply is not None:
                    return reply
        raise NoAnswerError(self.line.name, f"the PLC does not answer: {why}", "raise --timeout; is the CPU busy?")

    def _next(self, end: float) -> Connect | bytes | None:
        """What arrives next; None if nothing does in time."""
        while not self._arrived:
            left = end - self._now()
            if left <= 0:
                return None
            try:
                self._arrived += self._stream.feed(self.line.read(timeout=left))
            except IsoError as problem:
                raise LineLostError(self.line.name, str(problem)) from problem
        return self._arrived.popleft()


def open_iso(name: str, settings: Settings) -> Client:
    """A client for ``s7://HOST[:PORT][?tsap=OURS/THEIRS]``. Raises LineError, ClientError as LineError."""
    match = _NAME.fullmatch(name)
    if match is None:
        help_ = "for example s7://192.168.2.1 or s7://192.168.2.1?tsap=10.00/10.01"
        raise LineError(CANNOT_OPEN, name, "an S7 line is s7://HOST[:PORT][?tsap=OURS/THEIRS]", help_)
    host, ours, theirs = match.groups()
    bare = host.rpartition(":")[0].endswith("]") or (":" in host and not host.endswith("]"))
    address, port = parse_endpoint(host if bare else f"{host}:{PORT}")
    endpoint = f"[{address}]:{port}" if ":" in address else f"{address}:{port}"
    tried = [(ours, theirs)] if ours else TSAPS
    for number, (one, other) in enumerate(tried, 1):
        line = TcpLine.connect(endpoint)
        client = Client(line, settings)
        client.exchange = exchange = IsoExchange(line, settings)
        try:
            client.pdu_limit = min(client.pdu_limit, exchange.greet(one, other))
        except (LineLostError, ClientError) as problem:
            line.close()
            if number == len(tried):
                text = ", ".join(f"{mine}/{its}" for mine, its in tried)
                help_ = "the wizard of the CP 243-1 shows its TSAPs: s7://HOST?tsap=OURS/THEIRS"
                message = f"no S7 connection with the TSAPs {text}: {problem.diagnostics[0].message}"
                raise LineError(CANNOT_OPEN, name, message, help_) from problem
        else:
            return client
    raise AssertionError("there are TSAPs")


def _tsap(text: str) -> bytes:
    return bytes.fromhex(text.replace(".", ""))
