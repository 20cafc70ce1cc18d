"""How long a module takes to hand an answer over: characters on the line, the gap behind them, and cycles of OB1.

Sources: manual "CP 341, Installation and Parameter Assignment", A5E02191071-01, table 6-15 (32 bytes in a program
cycle, at least three calls); TIA Portal information system, "Overview of Freeport communication" (acyclic data
exchange takes several cycles).
"""

from __future__ import annotations

from collections.abc import Iterable

from plcgen.ppi.plan.nouns import PpiJob, PpiTelegram

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
POLL = 6
SYNC = 33, 28
"""Characters of the read of SMB0 and of its reply."""
START_CALLS, BLOCK_CALLS = 1, 3
"""Calls before the first telegram; of a block that sets or resets a port, and the one behind its end."""
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


def lengths(telegram: PpiTelegram) -> tuple[int, int]:
    """Characters of a request and of its reply, if all items are good."""
    return len(telegram.request.data), REPLY_FRAME + (telegram.response.size if telegram.response else 0)


def characters(telegram: PpiTelegram) -> int:
    """Characters of a whole exchange: request, E5, poll, reply."""
    return sum(lengths(telegram)) + E5 + POLL


def job_ms(job: PpiJob, baud: int, ob1: int, *, classic: bool) -> int:
    """Milliseconds that a job takes whose station answers at once, as the first one after power-up.

    A frame is sent in as many calls as it is received in. A CM is configured by two blocks first and reset before each
    telegram, three calls each; what is not a read follows the read of SMB0.
    """
    exchanges = [lengths(telegram) for telegram in job.telegrams] + ([SYNC] if job.kind != "read" else [])
    calls = START_CALLS + (0 if classic else 2 * BLOCK_CALLS)
    frames = 0
    for request, reply in exchanges:
        calls += 1 + (0 if classic else BLOCK_CALLS)
        frames += sum(heard_ms(octets, baud, ob1, classic=classic) for octets in (request, E5, POLL, reply))
        frames -= 2 * line_ms(GAP_BITS, baud)  # nobody waits for one behind what is sent
    return frames + calls * ob1


def longest_reply(jobs: Iterable[PpiJob]) -> int:
    """Characters of the longest reply, 23 if none has data."""
    sizes = (t.response.size for job in jobs for t in job.telegrams if t.response is not None)
    return REPLY_FRAME + max(sizes, default=0)


def chosen(least: int, needed: int, station: int) -> int:
    """A timeout that leaves so much to the station, in tens of milliseconds."""
    return max(least, -(-(needed + station) // 10) * 10)
