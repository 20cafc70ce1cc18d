"""A master for tests: requests as values, answers as values, over ``bytes in -> bytes out``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from plcgen.ppi.sim import Bus
from plcgen.ppi.wire.address import parse_item
from plcgen.ppi.wire.model import (
    FrameCount,
    Item,
    ItemWrite,
    Pdu,
    ReadReply,
    ReadRequest,
    Request,
    VariableFrame,
    WriteReply,
    WriteRequest,
)
from plcgen.ppi.wire.telegram import decode_telegram, encode_poll, encode_request

E5 = b"\xe5"


@dataclass
class Talk:
    """Speaks to one station of a bus as a well-behaved master does; ``now`` is the time of every frame."""

    bus: Bus
    station: int = 2
    source: int = 0
    now: int = 0
    count: FrameCount = field(default_factory=FrameCount)

    def send(self, data: bytes) -> bytes:
        """Raw bytes, answered at once or not at all."""
        return self.bus.exchange(data, self.now)

    def request(self, pdu: Request, function: int | None = None) -> bytes:
        """Send a request and return what comes back, E5 if all is well."""
        function = self.count.following() if function is None else function
        return self.send(encode_request(pdu, destination=self.station, source=self.source, function=function))

    def poll(self, function: int | None = None) -> bytes:
        """Ask for the answer."""
        function = self.count.following() if function is None else function
        return self.send(encode_poll(destination=self.station, source=self.source, function=function))

    def ask(self, pdu: Request) -> Pdu:
        """Exchange a whole job and return the decoded answer."""
        assert self.request(pdu) == E5
        telegram = decode_telegram(self.poll())
        assert isinstance(telegram.frame, VariableFrame)
        assert (telegram.frame.destination, telegram.frame.source) == (self.source, self.station)
        assert telegram.frame.function == 0x08
        assert telegram.pdu is not None
        return telegram.pdu

    def read(self, *addresses: str | Item) -> list[tuple[int, bytes]]:
        """Return code and bytes of every item."""
        reply = self.ask(ReadRequest(7, tuple(items(addresses))))
        assert isinstance(reply, ReadReply), reply
        assert reply.reference == 7
        return [(result.code, result.data) for result in reply.results]

    def write(self, *pairs: tuple[str | Item, bytes]) -> list[int]:
        """Return codes of a write."""
        entries = (
            ItemWrite(item, data)
            for item, data in zip(items([p[0] for p in pairs]), [p[1] for p in pairs], strict=True)
        )
        reply = self.ask(WriteRequest(8, tuple(entries)))
        assert isinstance(reply, WriteReply), reply
        return [int(code) for code in reply.codes]


def items(addresses: Sequence[str | Item]) -> list[Item]:
    """Addresses as items."""
    return [parse_item(entry) if isinstance(entry, str) else entry for entry in addresses]
