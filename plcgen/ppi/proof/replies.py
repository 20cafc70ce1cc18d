"""Replies of a station that are changed on their way: PDUs in frames that are right, and frames that are wrong."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from plcgen.ppi.plan.nouns import PpiJob

Edit = Callable[[bytes], bytes]
"""What becomes of the PDU of a reply on its way; its frame is made anew around it."""
Bend = Callable[[bytes], bytes]
"""What becomes of the bytes of a reply on its way."""

TOO_MANY: Mapping[str, Edit] = {
    "an item": lambda pdu: pdu[:13] + bytes((pdu[13] + 1,)) + pdu[14:],
    "a parameter": lambda pdu: pdu[:7] + b"\x03" + pdu[8:14] + b"\0" + pdu[14:],
}


def edits(job: PpiJob) -> Iterator[tuple[str, Edit]]:
    """Replies whose frame and reference are right and whose PDU is not."""
    yield "a parameter length beyond its end", lambda pdu: pdu[:6] + b"\x01" + pdu[7:]
    yield "a data length of 256 more", lambda pdu: pdu[:8] + b"\x01" + pdu[9:]
    yield "a data length of one more", lambda pdu: pdu[:9] + bytes((pdu[9] + 1 & 0xFF,)) + pdu[10:]
    yield "another function", lambda pdu: pdu[:12] + bytes((pdu[12] ^ 0x20,)) + pdu[13:]
    yield "no parameters", lambda pdu: pdu[:6] + b"\0\0" + pdu[8:12] + pdu[14:] + b"\0\0\0"
    if job.kind in {"run", "stop"}:
        yield "a parameter too many", lambda pdu: pdu[:7] + b"\x02" + pdu[8:] + b"\0"
        yield "data", lambda pdu: pdu[:9] + b"\x01" + pdu[10:] + b"\xff"
        return
    yield "a byte too many", lambda pdu: with_data(pdu, pdu[14:] + b"\xff")
    yield "a byte too few", lambda pdu: with_data(pdu, pdu[14:-1])
    yield from ((f"{name} too many", edit) for name, edit in TOO_MANY.items())
    if job.kind == "read":
        yield "all items but the first", lambda pdu: with_data(pdu, b"".join(_items(pdu)[1:]))
        yield "all items but the last", lambda pdu: with_data(pdu, b"".join(_items(pdu)[:-1]))
        yield "half an item", lambda pdu: with_data(pdu, pdu[14:16])
        yield "another size code", lambda pdu: pdu[:15] + bytes((pdu[15] ^ 0x0F,)) + pdu[16:]
        yield "another value length", lambda pdu: pdu[:17] + bytes((pdu[17] ^ 0x08,)) + pdu[18:]


def _items(pdu: bytes) -> list[bytes]:
    """The items of a reply to a read: return code, size code, length in bits (04) or bytes, value, pad between two."""
    found, at = [], 14
    while at < len(pdu):
        length = int.from_bytes(pdu[at + 2 : at + 4])
        size = length // 8 if pdu[at + 1] == 4 else length
        end = min(len(pdu), at + 4 + size + size % 2)
        found.append(pdu[at:end])
        at = end
    return found


def with_data(pdu: bytes, data: bytes) -> bytes:
    """A reply with other data, whose length is right."""
    return pdu[:8] + len(data).to_bytes(2) + pdu[10:14] + data


def bends() -> Iterator[tuple[str, Bend, int]]:
    """Replies whose frame is wrong at one place, or not for this master, and otherwise right to the last bit; whether
    they are frames that are passed over (1) or damaged ones (0).
    """
    yield "another destination", changed(4, 0x40, sums=True), 1
    yield "another protocol", changed(7, 0x01, sums=True), 1
    yield "the code of a request", changed(8, 0x02, sums=True), 1
    yield "another repeated length", changed(2, 0x01), 0
    yield "another second start byte", changed(3, 0x01), 0
    yield "another end byte", changed(-1, 0x01), 0


def changed(at: int, bits: int, *, sums: bool = False) -> Bend:
    """Some bits of a byte are others, with ``sums`` the checksum is right nevertheless."""

    def bend(data: bytes) -> bytes:
        found = bytearray(data)
        found[at] ^= bits
        found[-2] = sum(found[4:-2]) & 0xFF if sums else found[-2]
        return bytes(found)

    return bend
