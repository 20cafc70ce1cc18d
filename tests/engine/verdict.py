"""What an answer means, worked out a second time from the tables of data set 47."""

from __future__ import annotations

from dataclasses import dataclass, field

from plcgen.ds47.proof.words import NO_ANSWER
from plcgen.ds47.wire.formats import (
    BYTE,
    DOUBLE_WORD,
    ERROR,
    TIME_DIFFERENCES,
    WORD,
    ZERO,
    FormatKind,
    find,
    integer_range,
    padded,
)
from tests.engine.errands import Letter, Wanted

FOREIGN = "FOREIGN"
"""The answer to something else: it is read past."""
OLDER = range(0x21, 0x2D)
"""The normalised formats as they were numbered before 71h to 7Ch (Danfoss MCA 120, p. 42)."""
NARROW = (FormatKind.SIGNED, FormatKind.UNSIGNED)


@dataclass(slots=True)
class Verdict:
    """Status by its name; per parameter error, info, and the block that may be taken (None if none)."""

    word: str
    errors: list[int]
    infos: list[int]
    taken: list[bytes | None]
    failed: int = field(default=0)


def silence(letter: Letter, word: str) -> Verdict:
    """There was no answer, or none of which anything can be used."""
    count = len(letter.parts)
    return Verdict(word, [NO_ANSWER] * count, [0] * count, [None] * count)


def judge(letter: Letter, request: bytes, answer: bytes) -> Verdict:
    """Header first, then one error block for all, then block by block."""
    word = _header(letter, request, answer)
    if word:
        return silence(letter, word)
    count, negative = len(letter.parts), answer[1] >= 0x80
    whole = answer[4:]
    if negative and count > 1 and whole[:2] in {b"\x44\x01", b"\x44\x02"} and len(whole) == 2 + 2 * whole[1]:
        verdict = silence(letter, "REFUSED")
        verdict.errors = [0x8000 | whole[3]] * count
        verdict.infos = [int.from_bytes(whole[4:6])] * count
        verdict.failed = 1
        return verdict
    if letter.writes and not negative:
        verdict = silence(letter, "RESPONSE_FORMAT" if whole else "DONE")
        verdict.errors = verdict.errors if whole else [0] * count
        return verdict
    return _blocks(letter, answer, negative=negative)


def _header(letter: Letter, request: bytes, answer: bytes) -> str:
    """Status of an answer that is given up for its header, or ``FOREIGN``; "" for a good one."""
    if len(answer) < 4:
        return "RESPONSE_LENGTH"
    if answer[0] != request[0]:
        return FOREIGN
    if answer[1] == 0x80:
        return "NOT_SUPPORTED"
    if answer[2] != request[2]:
        return FOREIGN
    if answer[1] not in {letter.service, 0x80 | letter.service}:
        return "RESPONSE_ID"
    return "" if answer[3] == len(letter.parts) else "PARAMETER_COUNT"


def _blocks(letter: Letter, answer: bytes, *, negative: bool) -> Verdict:
    """Every block must lie in the answer, and the answer must end with the last one."""
    verdict = silence(letter, "DONE")
    at, broken = 4, False
    for number, part in enumerate(letter.parts):
        unknown = at + 2 <= len(answer) and not broken and find(answer[at]) is None
        if unknown:  # where the next block begins nobody knows: the rest of the answer is this one
            verdict.errors[number], verdict.infos[number] = 0x8100 | answer[at], answer[at + 1]
            verdict.failed = verdict.failed or number + 1
            broken, at = len(answer) % 2 == 1, len(answer)
            break
        block = None if broken else _block(answer, at)
        if block is None:
            broken = True
        else:
            broken = block[0] == ERROR and (not negative or block[1] not in {1, 2})
            at += len(block) + len(block) % 2
            _one(verdict, number, part, block, writes=letter.writes)
        if not verdict.failed and verdict.errors[number]:
            verdict.failed = number + 1
    if broken or at != len(answer) or (negative and not verdict.failed):
        failed = verdict.failed
        verdict = silence(letter, "RESPONSE_FORMAT")
        verdict.failed = failed
    elif verdict.failed:
        verdict.word = "PARAMETER_ERROR" if negative else "RESPONSE_FORMAT"
    return verdict


def _block(answer: bytes, at: int) -> bytes | None:
    """The block that begins there; None if it does not end in the answer or nobody knows where."""
    head = answer[at : at + 2]
    fmt = find(head[0]) if len(head) == 2 else None
    if fmt is None:
        return None
    size = head[1] * fmt.size
    return answer[at : at + 2 + size] if at + 2 + padded(size) <= len(answer) else None


def _one(verdict: Verdict, number: int, part: Wanted, block: bytes, *, writes: bool) -> None:
    """Judge one block that lies in the answer."""
    code, count, values = block[0], block[1], block[2:]
    if code == ERROR:
        verdict.errors[number] = 0x8000 | (values[1] if len(values) > 1 else 0)
        verdict.infos[number] = int.from_bytes(values[2:4]) if count == 2 else 0
        return
    wanted = (ZERO, 0, 0) if writes else (part.format.code, part.count, part.size)
    same = {wanted[0]} | (set(TIME_DIFFERENCES) if wanted[0] in TIME_DIFFERENCES else set())
    older = code + 0x50 if code in OLDER else code
    narrow: bytes | None = (
        None if writes or count != part.count or code not in {WORD, DOUBLE_WORD} else _narrow(part, values)
    )
    fits = (count, len(values)) == wanted[1:] and (older in same or (not writes and BYTE <= code <= DOUBLE_WORD))
    if part.most:  # the type is the one that came
        fits, narrow = code != ZERO and count == part.count and len(values) <= part.most, None
    if fits:
        verdict.errors[number], verdict.taken[number] = 0, block
    elif narrow is not None:
        verdict.errors[number], verdict.taken[number] = 0, block[:2] + narrow
    else:
        verdict.errors[number], verdict.infos[number] = 0x8100 | code, count


def _narrow(part: Wanted, values: bytes) -> bytes | None:
    """The values of an integer that came wider than it is, if all of them fit."""
    bounds, width = integer_range(part.format), len(values) // max(part.count, 1)
    if part.format.code > 0x07 or part.format.kind not in NARROW or bounds is None or width <= part.format.size:
        return None
    signed = part.format.kind is FormatKind.SIGNED
    numbers = [int.from_bytes(values[at : at + width], signed=signed) for at in range(0, len(values), width)]
    if not all(bounds[0] <= number <= bounds[1] for number in numbers):
        return None
    return b"".join(number.to_bytes(part.format.size, signed=signed) for number in numbers)
