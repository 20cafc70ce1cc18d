"""Round trips of the DS47 codec: telegram -> object -> telegram, per second, against struct on the same bytes."""

from __future__ import annotations

import struct
import time
from collections.abc import Callable

GOAL = 20
"""Times as long as struct alone, which neither checks nor names anything."""
TELEGRAMS = tuple(
    bytes.fromhex(text)
    for text in (
        "03 01 02 01 10 01 C4 7F 00 00",
        "04 02 02 01 10 01 C4 80 00 00 08 01 42 C8 00 00",
        "02 02 00 02 10 01 04 60 00 00 10 01 04 61 00 00 08 01 41 30 00 00 08 01 41 B0 00 00",
    )
)


def rates(seconds: float = 1.0) -> tuple[float, float]:
    """Round trips per second of the codec, and of struct.unpack/pack of the same bytes (no checks, no objects)."""
    from plcgen.ds47.wire.codec import decode_request, encode_request

    def codec(data: bytes) -> bytes:
        return encode_request(decode_request(data))

    def bare(data: bytes) -> bytes:
        layout = f">4B{(len(data) - 4) // 2}H"
        return struct.pack(layout, *struct.unpack(layout, data))

    return _rate(codec, seconds), _rate(bare, seconds)


def _rate(run: Callable[[bytes], bytes], seconds: float) -> float:
    count, start = 0, time.perf_counter()
    while time.perf_counter() - start < seconds:
        for _ in range(100):
            for data in TELEGRAMS:
                run(data)
        count += 100 * len(TELEGRAMS)
    return count / (time.perf_counter() - start)
