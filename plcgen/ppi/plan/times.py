"""How long a module takes to hand an answer over: characters on the line, the gap behind them, and cycles of OB1.

Sources: manual "CP 341, Installation and Parameter Assignment", A5E02191071-01, table 6-15 (32 bytes in a program
cycle, at least three calls); TIA Portal information system, "Overview of Freeport communication" (acyclic data
exchange takes several cycles).
"""

from __future__ import annotations

from collections.abc import Iterable

from plcgen.ppi.plan.nouns import PpiJob

CHARACTER_BITS = 11
GAP_BITS = 35
"""Bit times without a character that end a message: more than the 33 that EN 50170 keeps between two frames."""
PIECE, MORE_CALLS = 32, 2
"""Bytes that P_RCV_RK takes from a CP 341 in a program cycle, and its calls beside those."""
CM_CALLS = 2
"""Calls of Receive_P2P from the one that finds a message to the one with NDR."""
E5 = 1
REPLY_FRAME = 23
"""Bytes of a reply around its data: 7 of the frame, 12 of the header, 2 parameters, FCS and end."""
ACK_LEAST, ACK_STATION = 250, 50
REPLY_LEAST, REPLY_STATION = 600, 150
"""What a timeout is at least unless the spec says otherwise, and what it leaves to the station."""


def line_ms(bits: int, baud: int) -> int:
    """Milliseconds of bits on the line, rounded up."""
    return -(-bits * 1000 // baud)


def heard_ms(characters: int, baud: int, ob1: int, *, classic: bool) -> int:
    """Milliseconds from the end of sending until a block has an answer of so many characters that comes at once.

    One cycle more than the calls: behind its end the sending block is called once more.
    """
    calls = MORE_CALLS + -(-characters // PIECE) if classic else CM_CALLS
    return line_ms(characters * CHARACTER_BITS, baud) + line_ms(GAP_BITS, baud) + (calls + 1) * ob1


def longest_reply(jobs: Iterable[PpiJob]) -> int:
    """Characters of the longest reply, 23 if none has data."""
    sizes = (t.response.size for job in jobs for t in job.telegrams if t.response is not None)
    return REPLY_FRAME + max(sizes, default=0)


def chosen(least: int, needed: int, station: int) -> int:
    """A timeout that leaves so much to the station, in tens of milliseconds."""
    return max(least, -(-(needed + station) // 10) * 10)
