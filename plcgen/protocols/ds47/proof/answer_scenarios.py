"""Scenarios of the answer: error numbers, wrong headers, lengths, formats and error blocks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

from plcgen.protocols.ds47.plan.nouns import DriveJob, DriveTelegram
from plcgen.protocols.ds47.proof.record_scenarios import ends
from plcgen.protocols.ds47.proof.scenario import DriveScenario, Edit
from plcgen.protocols.ds47.proof.words import DONE, WORDS
from plcgen.protocols.ds47.sim.faults import Fault, FaultKind
from plcgen.protocols.ds47.wire.errors import known_numbers
from plcgen.protocols.ds47.wire.formats import generic_of, padded

INFO = 0x1234
_FIRMWARE = {0x0D: 0x36, 0x36: 0x0D}
"""Codes of a time difference in older and newer firmware."""
NOT_SUPPORTED = bytes.fromhex("44010021")


def error_matrix(job: DriveJob, numbers: Iterable[int] | None = None) -> Iterator[DriveScenario]:
    """Every error number at every position with one and two error words."""
    for number in known_numbers() if numbers is None else numbers:
        for telegram in job.telegrams:
            for position in range(1, len(telegram.parts) + 1):
                for words in (1, 2):
                    yield _error(job, telegram, number, position, 2 if words == 2 else 1)


def _error(job: DriveJob, telegram: DriveTelegram, number: int, position: int, words: Literal[1, 2]) -> DriveScenario:
    before = sum(len(other.parts) >= position for other in job.telegrams[: telegram.number - 1])
    info = INFO + position
    fault = Fault(FaultKind.ERROR, number=number, position=position, words=words, info=info, after=before)
    use = telegram.parts[position - 1].use
    return DriveScenario(
        name=f"error {number:02X}h at parameter {position} of telegram {telegram.number}, {words} error words",
        status=(WORDS["PARAMETER_ERROR"],),
        faults=(fault,),
        errors={use.position: (0x8000 | number, info if words == 2 else 0)},
        telegram=telegram.number,
        follow=False,
    )


@dataclass(frozen=True, slots=True)
class AnswerShape:
    """What one answer looks like: positive and negative id, offsets of the value blocks, room in the buffer."""

    job: DriveJob
    telegram: DriveTelegram
    room: int

    @property
    def good(self) -> int:
        """Response id of a positive answer."""
        return 2 if self.job.writes else 1

    @property
    def blocks(self) -> list[tuple[int, int]]:
        """First byte and length of every value block of a positive read answer."""
        found, at = [], 4
        for part in self.telegram.parts:
            size = 2 + padded(part.size)
            found.append((at, size))
            at += size
        return found

    def content(self, answer: bytes) -> list[bytes]:
        """The blocks as a partly negative answer carries them."""
        if self.job.writes:
            return [b"\x40\x00"] * len(self.telegram.parts)
        return [answer[at : at + size] for at, size in self.blocks]

    def negative(self, change: Callable[[list[bytes]], object], tail: bytes = b"") -> Edit:
        """A negative answer with changed blocks."""

        def edit(answer: bytes) -> bytes:
            blocks = self.content(answer)
            change(blocks)
            return bytes((answer[0], 0x80 | self.good, *answer[2:4])) + b"".join(blocks) + tail

        return edit

    def scenario(self, name: str, word: str, edit: Edit, length: int | None = None, **more: object) -> DriveScenario:
        """A scenario with one edited answer; beyond the buffer RDREC itself fails."""
        if length is not None and length > self.telegram.response.size:
            word = "READ_ERROR" if length > self.room else "RESPONSE_FORMAT"
        status = WORDS[word]
        return DriveScenario(
            name=f"telegram {self.telegram.number}: {name}",
            status=(status,),
            reads={self.telegram.number: edit},
            generic=False,
            telegram=0 if status == DONE else self.telegram.number,
            calls=(0, 0),
            **more,  # type: ignore[arg-type]
        )


def answer_scenarios(job: DriveJob, *, classic: bool) -> Iterator[DriveScenario]:
    """Everything an answer may be."""
    largest = max(telegram.response.size for telegram in job.telegrams)
    for number in ends(job):
        telegram = job.telegrams[number - 1]
        shape = AnswerShape(job, telegram, telegram.response.size if classic else largest)
        yield from _header(shape)
        yield from _length(shape)
        yield from _negative(shape)
        yield from _refused(shape)
        yield from _leftovers(shape)
        if not job.writes:
            yield from _formats(shape)
    for generic in (False, True):
        yield DriveScenario(name=f"answers in {'41h to 43h' if generic else 'the types themselves'}", generic=generic)


def put(at: int, value: int) -> Edit:
    """Replace one byte."""
    return lambda answer: answer[:at] + bytes((value,)) + answer[at + 1 :]


def cut(kept: int) -> Edit:
    """Keep the first bytes only."""
    return lambda answer: answer[:kept]


def longer(more: int) -> Edit:
    """Append zeros."""
    return lambda answer: answer + bytes(more)


def _header(shape: AnswerShape) -> Iterator[DriveScenario]:
    good, other = shape.good, 3 - shape.good
    for value in (0, other, 3, 0x7F, 0x80 | other, 0x83, 0xFF):
        yield shape.scenario(f"response id {value:02X}h", "RESPONSE_ID", put(1, value))
    yield shape.scenario(
        "service not supported (80h)", "NOT_SUPPORTED", lambda a: bytes((a[0], 0x80, *a[2:4])) + NOT_SUPPORTED
    )
    yield shape.scenario("negative id on a good answer", "RESPONSE_FORMAT", put(1, 0x80 | good))
    own = shape.job.drive.drive_object
    for value in {(own + 1) % 256, own ^ 0x80, 255 - own}:
        yield shape.scenario(f"drive object {value}", "DRIVE_OBJECT", put(2, value))
    count = len(shape.telegram.parts)
    for value in {0, count + 1, count - 1, count ^ 0x80}:
        yield shape.scenario(f"{value} parameters", "PARAMETER_COUNT", put(3, value))


def _length(shape: AnswerShape) -> Iterator[DriveScenario]:
    length = shape.telegram.positive_length
    marks = {0, 1, 2, 3, 4, 5, length - 2, length - 1} | {at + step for at, _ in shape.blocks for step in (0, 1, 2, 3)}
    for kept in sorted(marks):
        if 0 <= kept < length:
            word = "RESPONSE_LENGTH" if kept < 4 else "RESPONSE_FORMAT"
            yield shape.scenario(f"answer cut to {kept} bytes", word, cut(kept))
    for more in (1, 2, 6, 240):
        yield shape.scenario(
            f"answer {more} bytes too long",
            "RESPONSE_FORMAT",
            longer(more),
            length + more,
        )


def _negative(shape: AnswerShape) -> Iterator[DriveScenario]:
    parts = shape.telegram.parts
    sizes = [2] * len(parts) if shape.job.writes else [size for _, size in shape.blocks]
    total = 4 + sum(sizes)
    for index in sorted({0, len(parts) // 2, len(parts) - 1}):
        rest = total - sizes[index]
        for name, block in (
            ("no error word", b"\x44\x00"),
            ("three error words", bytes.fromhex("440300110001 0002")),
            ("half an error word", bytes.fromhex("4401")),
            ("half a second error word", bytes.fromhex("4402 0011 00")),
            ("half a second error word of two bytes", bytes.fromhex("4402 0011")),
        ):
            last = index == len(parts) - 1
            if block[1] in {1, 2} and (
                not last or (len(parts) > 1 and 4 + sum(sizes[:-1]) + len(block) == 6 + 2 * block[1])
            ):
                continue

            def change(blocks: list[bytes], index: int = index, block: bytes = block) -> None:
                blocks[index] = block

            yield shape.scenario(
                f"parameter {index + 1} with {name}", "RESPONSE_FORMAT", shape.negative(change), rest + len(block)
            )
    yield from _failed(shape, sizes)
    yield from _missing(shape)
    yield from _positive_error(shape)
    yield shape.scenario("negative without any error", "RESPONSE_FORMAT", shape.negative(lambda _: None))
    if shape.job.writes:
        yield from _written(shape)


def _positive_error(shape: AnswerShape) -> Iterator[DriveScenario]:
    """An error block under the id of a positive answer."""
    for words in (1, 2):
        block = bytes((0x44, words, 0, 0x11, 0, 7)[: 2 + 2 * words])

        def edit(answer: bytes, block: bytes = block) -> bytes:
            blocks = [block, *shape.content(answer)[1:]]
            return answer[:4] + b"".join(blocks)

        yield shape.scenario(f"error block of {words} words in a good answer", "RESPONSE_FORMAT", edit)


def _missing(shape: AnswerShape) -> Iterator[DriveScenario]:
    """An answer that lacks the block of one parameter."""
    count = len(shape.telegram.parts)
    for index in range(count) if count > 1 else ():

        def change(blocks: list[bytes], index: int = index) -> None:
            blocks[0 if index else count - 1] = bytes.fromhex("44020011 0007")
            blocks[index] = b""

        if count > 2:
            yield shape.scenario(f"failed without block {index + 1}", "RESPONSE_FORMAT", shape.negative(change))
        if not shape.job.writes:
            at, size = shape.blocks[index]
            yield shape.scenario(f"good without block {index + 1}", "RESPONSE_FORMAT", without(at, size))


def _leftovers(shape: AnswerShape) -> Iterator[DriveScenario]:
    """What stands in the buffer behind a short answer does not count, nor what a block before the wrong one was."""
    if shape.job.writes:
        if len(shape.telegram.parts) > 2:

            def change(blocks: list[bytes]) -> None:
                blocks[0], blocks[-1] = bytes.fromhex("440200110007"), b""

            name = "last block missing, 41 00 left behind"
            yield shape.scenario(name, "RESPONSE_FORMAT", shape.negative(change), litter=b"\x41\x00")
        return
    before, total = 0, shape.telegram.positive_length
    for index, (at, size) in enumerate(shape.blocks, 1):
        name = f"block {index} missing, format 0Eh left behind"
        yield shape.scenario(name, "RESPONSE_FORMAT", cut(at), litter=b"\x0e\x01")
        if before:
            wrong = bytes((0x0E, 1)) + bytes(before - 2)
            name = f"block {index} in format 0Eh, as long as the one before"
            yield shape.scenario(name, "RESPONSE_FORMAT", instead(at, size, wrong), total - size + before)
        before = size


def instead(at: int, size: int, block: bytes) -> Edit:
    """Put another block in the place of one."""
    return lambda answer: answer[:at] + block + answer[at + size :]


def without(at: int, size: int) -> Edit:
    """Leave some bytes out."""
    return lambda answer: answer[:at] + answer[at + size :]


def _failed(shape: AnswerShape, sizes: list[int]) -> Iterator[DriveScenario]:
    parts = shape.telegram.parts
    two = bytes.fromhex("440200110007")
    for name, chosen in (("all parameters fail", range(len(parts))), ("first and last fail", {0, len(parts) - 1})):

        def change(blocks: list[bytes], chosen: Iterable[int] = chosen) -> None:
            for index in chosen:
                blocks[index] = two

        errors = {parts[index].use.position: (0x8011, 7) for index in chosen}
        yield shape.scenario(name, "PARAMETER_ERROR", shape.negative(change), errors=errors)
        length = 4 + sum(6 if index in chosen else size for index, size in enumerate(sizes))
        for more in (1, 2):
            yield shape.scenario(
                f"{name}, {more} bytes behind", "RESPONSE_FORMAT", shape.negative(change, bytes(more)), length + more
            )


def _written(shape: AnswerShape) -> Iterator[DriveScenario]:
    """Blocks of good parameters in a partly refused change are 40 00, nothing else."""
    count = len(shape.telegram.parts)
    for wrong in (b"\x40\x01", b"\x41\x00", b"\x00\x00"):
        for index in sorted({0, count - 1}):

            def change(blocks: list[bytes], index: int = index, wrong: bytes = wrong) -> None:
                blocks[index] = wrong
                if count > 1:
                    blocks[0 if index else count - 1] = bytes.fromhex("440200110007")

            yield shape.scenario(
                f"good parameter {index + 1} answered {wrong.hex(' ')}", "RESPONSE_FORMAT", shape.negative(change)
            )


def _refused(shape: AnswerShape) -> Iterator[DriveScenario]:
    single = len(shape.telegram.parts) == 1
    for number in (0x00, 0x11, 0x19, 0x21, 0x23, 0xFF):
        for words in (1, 2):
            block = bytes((0x44, words, 0, number)) + (INFO.to_bytes(2) if words == 2 else b"")
            edit: Edit = lambda a, block=block: bytes((a[0], 0x80 | shape.good, *a[2:4])) + block  # type: ignore[misc] # noqa: E731
            name = f"one error block {number:02X}h for the whole request, {words} error words"
            uses = {part.use.position for part in shape.telegram.parts}
            errors = dict.fromkeys(uses, (0x8000 | number, INFO if words == 2 else 0))
            yield shape.scenario(name, "PARAMETER_ERROR" if single else "REFUSED", edit, errors=errors)


def _formats(shape: AnswerShape) -> Iterator[DriveScenario]:
    for index, (at, _) in enumerate(shape.blocks):
        part = shape.telegram.parts[index]
        generic = None if part.use.format.is_string else generic_of(part.use.format.size)
        code = part.use.format.code
        accepted = {code, _FIRMWARE.get(code, code)} | ({generic.code} if generic is not None else set())
        if code in _FIRMWARE:
            yield shape.scenario(
                f"block {index + 1} as newer or older firmware answers", "DONE", put(at, _FIRMWARE[code])
            )
        if generic is not None:
            yield shape.scenario(f"block {index + 1} in format {generic.code:02X}h", "DONE", put(at, generic.code))
        for wrong in {0x0E, 0x36, 0x40, 0x44, 0x41, 0x42, 0x43, 0x00, 0xFF} - accepted:
            yield shape.scenario(f"block {index + 1} in format {wrong:02X}h", "RESPONSE_FORMAT", put(at, wrong))
        for count in {0, part.count - 1, (part.count + 1) % 256, part.count ^ 0x80} - {part.count}:
            yield shape.scenario(f"block {index + 1} with {count} values", "RESPONSE_FORMAT", put(at + 1, count))
