"""Damaged packets for both ends: 2,000 each, or as many as PLCGEN_FUZZ says (``make fuzz``: 100,000)."""

from __future__ import annotations

import os
import random
import uuid

import pytest

from plcgen.base.diagnostics import DiagnosticError
from plcgen.ds47.device import Parameter
from plcgen.ds47.live.channel import PnParameters
from plcgen.ds47.live.profinet import PnConnection
from plcgen.ds47.sim.pn_device import PnDevice
from plcgen.ds47.wire import formats, rpc
from plcgen.ds47.wire.model import ParameterAddress, ValueBlock
from tests.ds47.live.pn_bench import PLACE, S120, Wire, drive

MANY = int(os.environ.get("PLCGEN_FUZZ", "2000"))
_NUMBERS = (0, 1, 0x7F, 0x80, 0xFF)


def damaged(chance: random.Random, data: bytes) -> bytes:
    """One to four changes: a bit, a byte, a cut, something in between, something behind, two octets of the length."""
    out = bytearray(data)
    for _ in range(chance.randint(1, 4)):
        at = chance.randrange(len(out)) if out else 0
        match chance.randrange(6) if out else 4:
            case 0:
                out[at] ^= 1 << chance.randrange(8)
            case 1:
                out[at] = chance.choice(_NUMBERS)
            case 2:
                del out[at:]
            case 3:
                out[at:at] = chance.randbytes(chance.randint(1, 8))
            case 4:
                out += chance.randbytes(chance.randint(1, 200))
            case 5:
                out[74:76] = chance.randbytes(2)
    return bytes(out)


def _talk(wire: Wire, order: str) -> None:
    real = formats.by_name("FloatingPoint")
    with PnConnection(PLACE, 0xB02F, 1.0, wire, order) as connection:  # type: ignore[arg-type]
        reader = PnParameters(connection, S120)
        list(reader.read([(Parameter(1120, "FloatingPoint"), range(2)), (Parameter(59900, ""), range(100))], 2))
        reader.change([(ParameterAddress(1120, 0, 1), ValueBlock.of(real, [12.0]))], 2)


def test_the_client(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever a device answers, the client has values or a message with a code, and an end."""
    chance, count = random.Random(1), 0  # a sample, no secret
    # the same identifiers in every run: they are in the packets that are damaged
    monkeypatch.setattr("uuid.uuid4", lambda: uuid.UUID(int=chance.getrandbits(128)))
    monkeypatch.setattr("secrets.randbelow", chance.randrange)
    codes: set[str] = set()
    while count < MANY:
        struck = 0

        def back(_at: int, data: bytes) -> list[bytes]:
            nonlocal struck
            if chance.random() < 0.3:
                struck += 1
                return [damaged(chance, data)]
            return [data]

        wire = Wire(PnDevice(drive(), fragment=chance.choice((rpc.BODY, 64))), back=back)
        try:
            _talk(wire, chance.choice(("little", "big")))
        except DiagnosticError as found:
            codes |= {one.code for one in found.diagnostics}
        count += struck
        assert wire.time < 3600
    assert codes == {"PG705", "PG708"}


def test_the_device() -> None:
    """Whatever comes, the device answers or is silent; it goes on, and forgets who has gone."""
    wire = Wire(PnDevice(drive()))
    _talk(wire, "little")
    _talk(wire, "big")
    requests = [data for way, data in wire.seen if way == "there"]
    chance, device = random.Random(2), PnDevice(drive(), room=3)  # a sample, no secret
    for _ in range(MANY):
        for answer in device.receive(damaged(chance, chance.choice(requests))):
            rpc.decode_packet(answer)
        device.advance(chance.choice((0, 1, 500)))
    assert len(device.relations) <= 3
    device.advance(1_000_000)
    assert not device.relations
    _talk(Wire(device), "little")


def test_the_device_serves_in_the_midst() -> None:
    """Damaged packets of others between those of a good client do not disturb it."""
    chance = random.Random(3)  # a sample, no secret
    device = PnDevice(drive(), room=4)
    sent: list[bytes] = []
    others: list[bytes] = []

    def there(_at: int, data: bytes) -> list[bytes]:
        sent.append(data)
        strange = [damaged(chance, chance.choice(sent)) for _ in range(3)]
        others.extend(one for one in strange if one[40:56] != data[40:56])
        return [*(one for one in strange if one[40:56] != data[40:56]), data]

    _talk(Wire(device, there=there), "little")  # ends with an error if an answer is missing or wrong
    assert others
    assert len(sent) >= 4, "connection, a read, a change, release"
