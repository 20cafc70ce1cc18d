"""Frames in a stream: behind runs of start bytes, in pieces, and beside bytes that only look like frames."""

from __future__ import annotations

import random

import pytest

from plcgen.ppi.wire.stream import Splitter, split

POLL = bytes.fromhex("10 02 00 5C 5E 16")
READ = bytes.fromhex(
    "68 1B 1B 68 02 00 6C 32 01 00 00 00 00 00 0E 00 00 04 01 12 0A 10 02 00 01 00 01 84 00 03 20 8B 16"
)
ANSWER = bytes.fromhex("68 16 16 68 00 02 08 32 03 00 00 00 00 00 02 00 05 00 00 04 01 FF 04 00 08 22 78 16")
"""Telegrams of the seed document: poll, read of VB100, its answer."""


@pytest.mark.parametrize("pools", [(b"\x68\x10\xdc\xa2",), (b"\x68", b"\x10", b"\xdc", b"\xa2")])
@pytest.mark.parametrize("size", [0, 7])
def test_frames_behind_runs_of_start_bytes(pools: tuple[bytes, ...], size: int) -> None:
    """Of 3,600 frames at least 95 % are found, and less than 1 % of others are reported; in pieces as well."""
    draw, data, real = random.Random(15), b"", set()  # test values
    for _ in range(3600):
        pool = draw.choice(pools)
        data += bytes(draw.choice(pool) for _ in range(draw.randrange(1, 12)))
        frame = draw.choice((POLL, READ, ANSWER))
        real.add((len(data), frame))
        data += frame
    splitter = Splitter()
    pieces = [data[at : at + size] for at in range(0, len(data), size)] if size else [data]
    chunks = [chunk for piece in pieces for chunk in splitter.feed(piece)] + splitter.finish()
    assert b"".join(chunk.data for chunk in chunks) == data
    found = {(chunk.offset, chunk.data) for chunk in chunks if chunk.frame}
    assert len(found & real) >= 0.95 * 3600
    assert len(found - real) < 0.01 * 3600


@pytest.mark.parametrize("data", [b"\xe5", POLL, READ])
def test_a_whole_frame_is_taken_only_if_nothing_waits(data: bytes) -> None:
    """Behind bytes that wait for more, or with a byte more or less, it is not one whole frame."""
    splitter = Splitter()
    assert splitter.whole(data)
    assert not splitter.whole(data + b"\x16")
    assert not splitter.whole(data[:-1])
    assert not splitter.feed(READ[:5])
    assert not splitter.whole(data)
    assert [chunk.data for chunk in splitter.feed(READ[5:])] == [READ]
    assert splitter.feed(POLL)[0].offset == len(data) + len(READ)


def frames(text: str) -> list[str]:
    return [chunk.data.hex(" ").upper() for chunk in split(bytes.fromhex(text)) if chunk.frame]


def test_a_token_gives_way_to_a_frame_that_begins_in_it() -> None:
    """DC 10 02 is no token from 2 to 16 if 10 02 00 5C 5E 16 is a good poll."""
    assert frames("DC 10 02 00 5C 5E 16") == ["10 02 00 5C 5E 16"]


def test_tokens_are_found() -> None:
    """Between frames, in a row, and alone."""
    assert frames("DC 01 03 DC 03 01 E5 DC 01 03") == ["DC 01 03", "DC 03 01", "E5", "DC 01 03"]


def test_a_token_of_station_16_is_believed_if_it_has_spoken() -> None:
    """10h is a start byte, too: only behind a frame from station 16 the token from there is one."""
    spoken = "10 02 10 49 5B 16"  # FDL status request of station 16
    assert frames("DC 02 10") == []
    assert frames(f"{spoken} DC 02 10") == [spoken, "DC 02 10"]


def test_a_damaged_frame_does_not_hide_the_poll_at_its_end() -> None:
    """A2 and 13 bytes, the last one 16: no SD3 frame by its checksum, and the end of a good poll."""
    assert frames("A2 01 02 03 04 05 06 07 10 02 00 5C 5E 16") == ["10 02 00 5C 5E 16"]


def test_what_is_inside_a_damaged_frame_is_no_frame() -> None:
    """An answer whose checksum is wrong and whose data look like a poll: one piece of garbage."""
    body = bytes.fromhex("00 02 08") + POLL + b"\x01"
    damaged = bytes((0x68, len(body), len(body), 0x68)) + body + bytes((sum(body) + 1 & 0xFF, 0x16))
    assert frames(damaged.hex()) == []
