"""Scenarios of the answer: error numbers, wrong headers, lengths, formats and error blocks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Literal

from plcgen.ds47.proof.words import DONE, NO_ANSWER, WORDS
from plcgen.ds47.sim.faults import Fault, FaultKind
from plcgen.ds47.wire.errors import known_numbers
from plcgen.ds47.wire.formats import DOUBLE_WORD, FORMATS, OLDER, WORD, Format, generic_of
from tests.engine.errands import Errand, Letter
from tests.engine.record_faults import outer_telegrams
from tests.engine.scenario import Edit, EngineScenario

INFO = 0x1234
_FIRMWARE = {0x0D: 0x36, 0x36: 0x0D}
"""Codes of a time difference in older and newer firmware."""
NOT_SUPPORTED = bytes.fromhex("44010021")


def error_matrix(errand: Errand) -> Iterator[EngineScenario]:
    """Every error number at every position with one and two error words."""
    for number in known_numbers():
        for telegram, letter in enumerate(errand.letters, 1):
            for position in range(1, len(letter.parts) + 1):
                for words in (1, 2):
                    yield _error(errand, telegram, number, position, 2 if words == 2 else 1)


def _error(errand: Errand, telegram: int, number: int, position: int, words: Literal[1, 2]) -> EngineScenario:
    before = sum(len(other.parts) >= position for other in errand.letters[: telegram - 1])
    info = INFO + position
    fault = Fault(FaultKind.ERROR, number=number, position=position, words=words, info=info, after=before)
    return EngineScenario(
        name=f"error {number:02X}h at parameter {position} of telegram {telegram}, {words} error words",
        status=(WORDS["PARAMETER_ERROR"],),
        faults=(fault,),
        errors={position: (0x8000 | number, info if words == 2 else 0)},
        telegram=telegram,
        follow=False,
    )


@dataclass(frozen=True, slots=True)
class AnswerForm:
    """What one answer looks like: positive and negative id, offsets of the value blocks. RDREC takes ``room`` bytes."""

    errand: Errand
    number: int
    letter: Letter
    room: int

    @property
    def good(self) -> int:
        """Response id of a positive answer."""
        return self.letter.service

    @property
    def nothing(self) -> dict[int, tuple[int, int]]:
        """Errors and infos if nothing of the answer can be used."""
        return dict.fromkeys(range(1, len(self.letter.parts) + 1), (NO_ANSWER, 0))

    def up_to(self, index: int, code: int, count: int) -> dict[int, tuple[int, int]]:
        """Errors and infos if block ``index`` has an unknown format: what comes before it is good."""
        before = dict.fromkeys(range(1, index), (0, 0))
        return self.nothing | before | {index: (0x8100 | code, count)}

    def content(self, answer: bytes) -> list[bytes]:
        """The blocks as a partly negative answer carries them."""
        if self.letter.writes:
            return [b"\x40\x00"] * len(self.letter.parts)
        return [answer[at : at + size] for at, size in self.letter.blocks]

    def negative(self, change: Callable[[list[bytes]], object], tail: bytes = b"") -> Edit:
        """A negative answer with changed blocks."""

        def edit(answer: bytes) -> bytes:
            blocks = self.content(answer)
            change(blocks)
            return bytes((answer[0], 0x80 | self.good, *answer[2:4])) + b"".join(blocks) + tail

        return edit

    def scenario(self, name: str, word: str, edit: Edit, length: int = 0, **more: Any) -> EngineScenario:
        """A scenario with one edited answer; beyond the buffer RDREC itself fails."""
        status = WORDS["READ_ERROR" if length > self.room else word]
        return EngineScenario(
            name=f"telegram {self.number}: {name}",
            status=(status,),
            reads={self.number: edit},
            telegram=0 if status == DONE else self.number,
            **more,
        )

    def broken(self, name: str, edit: Edit, length: int = 0, **more: Any) -> EngineScenario:
        """An answer of which nothing can be used."""
        errors = {} if length > self.room else self.nothing
        return self.scenario(name, "RESPONSE_FORMAT", edit, length, errors=errors, **more)


def answer_faults(errand: Errand, room: int) -> Iterator[EngineScenario]:
    """Everything an answer may be."""
    for number in outer_telegrams(errand):
        form = AnswerForm(errand, number, errand.letters[number - 1], room)
        yield from _header(form)
        yield from _foreign(form)
        yield from _length(form)
        yield from _negative(form)
        yield from _refused(form)
        yield from _leftovers(form)
        if not form.letter.writes:
            yield from _formats(form)
    for generic in (False, True):
        yield EngineScenario(name=f"answers in {'41h to 43h' if generic else 'the types themselves'}", generic=generic)


def _put(at: int, value: int) -> Edit:
    """Replace one byte."""
    return lambda answer: answer[:at] + bytes((value,)) + answer[at + 1 :]


def off(step: int) -> Edit:
    """Another reference."""
    return lambda answer: bytes(((answer[0] + step) % 256,)) + answer[1:]


def _behind(first: Edit, second: Edit) -> Edit:
    """Two edits, one behind the other."""
    return lambda answer: second(first(answer))


def _cut(kept: int) -> Edit:
    """Keep the first bytes only."""
    return lambda answer: answer[:kept]


def longer(more: int) -> Edit:
    """Append zeros."""
    return lambda answer: answer + bytes(more)


def instead(at: int, size: int, block: bytes) -> Edit:
    """Put another block in the place of one."""
    return lambda answer: answer[:at] + block + answer[at + size :]


def without(at: int, size: int) -> Edit:
    """Leave some bytes out."""
    return lambda answer: answer[:at] + answer[at + size :]


def _header(form: AnswerForm) -> Iterator[EngineScenario]:
    good, other = form.good, 3 - form.good
    for value in (0, other, 3, 0x7F, 0x80 | other, 0x83, 0xFF):
        yield form.scenario(f"response id {value:02X}h", "RESPONSE_ID", _put(1, value), errors=form.nothing)
    yield form.scenario(
        "service not supported (80h)", "NOT_SUPPORTED", lambda a: bytes((a[0], 0x80, *a[2:4])) + NOT_SUPPORTED,
        errors=form.nothing,
    )  # fmt: skip
    yield form.broken("negative id on a good answer", _put(1, 0x80 | good))
    count = len(form.letter.parts)
    for value in {0, count + 1, count - 1, count ^ 0x80}:
        yield form.scenario(f"{value} parameters", "PARAMETER_COUNT", _put(3, value), errors=form.nothing)


def _foreign(form: AnswerForm) -> Iterator[EngineScenario]:
    """Answers with another reference or drive object are read past; then all but a trigger is sent again."""
    last, once = form.number == len(form.errand.letters), form.errand.once
    negative = form.negative(lambda blocks: blocks.__setitem__(0, bytes.fromhex("44020011 0007")))
    cases: list[tuple[str, Edit]] = [(f"drive object {value}", _put(2, value)) for value in (3, 2 ^ 0x80, 255, 0)]
    cases += [(f"reference off by {step}", off(step)) for step in (1, 128, 255)]
    cases += [("reference 0", _put(0, 0))]
    cases += [(f"negative, {name}", _behind(negative, edit)) for name, edit in list(cases)]
    for name, edit in cases:
        again: dict[str, Any] = {"retries": 2 if last else 0, "calls": (1, 2), "again": 1}
        if once:
            again = {"retries": 1, "calls": (0, 1), "status": (WORDS["UNKNOWN"],)}
        yield EngineScenario(name=f"telegram {form.number}: {name}", reads={form.number: edit}, **again)
    if form.number > 1:
        return
    # foreign (200 ms), B5 (20, 100, then 200 ms), built again: 200, 220, 420, 520, 720, .. 1920, 2120 ms in 12 retries
    word = "UNKNOWN" if once else "DRIVE_OBJECT"
    for name, edit in (("always another drive object", _put(2, 7)),):
        yield EngineScenario(
            name=name, status=(WORDS[word],), reads={0: edit}, retries=1 if once else 12, telegram=1,
            calls=(0, 1) if once else (6, 12), again=0 if once else 6,
        )  # fmt: skip


def _length(form: AnswerForm) -> Iterator[EngineScenario]:
    length = form.letter.answer
    blocks = [] if form.letter.writes else form.letter.blocks
    marks = {0, 1, 2, 3, 4, 5, length - 2, length - 1} | {at + step for at, _ in blocks for step in (0, 1, 2, 3)}
    for kept in sorted(marks):
        if 0 <= kept < length:
            word = "RESPONSE_LENGTH" if kept < 4 else "RESPONSE_FORMAT"
            yield form.scenario(f"answer cut to {kept} bytes", word, _cut(kept), errors=form.nothing)
    for more in sorted({1, 2, 6, form.room - length, 240}):
        yield form.broken(f"answer {more} bytes too long", longer(more), length + more)


def _negative(form: AnswerForm) -> Iterator[EngineScenario]:
    parts = form.letter.parts
    sizes = [2] * len(parts) if form.letter.writes else [size for _, size in form.letter.blocks]
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

            yield form.broken(f"parameter {index + 1} with {name}", form.negative(change), rest + len(block))
    yield from _failed(form, sizes)
    yield from _missing(form)
    yield from _positive_error(form)
    yield from _at_the_edge(form)
    yield form.broken("negative without any error", form.negative(lambda _: None))
    if form.letter.writes:
        yield from _written(form)


def _at_the_edge(form: AnswerForm) -> Iterator[EngineScenario]:
    """The head of an error block is all that is left of a full buffer."""
    if len(form.letter.parts) < 2:
        return
    for tail in (b"\x44\x00", b"\x44\x01", b"\x44\x02"):
        filler = bytes((0x0A, form.room - 4 - 2 - 2 - 2 * (len(form.letter.parts) - 2)))
        zeros = b"\x40\x00" * (len(form.letter.parts) - 2)

        def edit(answer: bytes, tail: bytes = tail, filler: bytes = filler, zeros: bytes = zeros) -> bytes:
            return bytes((answer[0], 0x80 | form.good, *answer[2:4])) + zeros + filler + bytes(filler[1]) + tail

        yield form.broken(f"a full buffer ends with {tail.hex()}", edit)


def _positive_error(form: AnswerForm) -> Iterator[EngineScenario]:
    """An error block under the id of a positive answer."""
    for words in (1, 2):
        block = bytes((0x44, words, 0, 0x11, 0, 7)[: 2 + 2 * words])

        def edit(answer: bytes, block: bytes = block) -> bytes:
            blocks = [block, *form.content(answer)[1:]]
            return answer[:4] + b"".join(blocks)

        yield form.broken(f"error block of {words} words in a good answer", edit)


def _missing(form: AnswerForm) -> Iterator[EngineScenario]:
    """An answer that lacks the block of one parameter."""
    count = len(form.letter.parts)
    for index in range(count) if count > 1 else ():

        def change(blocks: list[bytes], index: int = index) -> None:
            blocks[0 if index else count - 1] = bytes.fromhex("44020011 0007")
            blocks[index] = b""

        if count > 2:
            yield form.broken(f"failed without block {index + 1}", form.negative(change))
        if not form.letter.writes:
            at, size = form.letter.blocks[index]
            yield form.broken(f"good without block {index + 1}", without(at, size))


def _leftovers(form: AnswerForm) -> Iterator[EngineScenario]:
    """What stands in the buffer behind a short answer does not count, nor what a block before the wrong one was."""
    if form.letter.writes:
        if len(form.letter.parts) > 2:

            def change(blocks: list[bytes]) -> None:
                blocks[0], blocks[-1] = bytes.fromhex("440200110007"), b""

            name = "last block missing, 41 00 left over"
            yield form.broken(name, form.negative(change), litter=b"\x41\x00")
        return
    before, total = 0, form.letter.answer
    for index, (at, size) in enumerate(form.letter.blocks, 1):
        name = f"block {index} missing, format 0Eh left over"
        yield form.broken(name, _cut(at), litter=b"\x0e\x01")
        if before:
            wrong = bytes((0x0E, 1)) + bytes(before - 2)
            name = f"block {index} in format 0Eh, as long as the one before"
            edit = instead(at, size, wrong)
            yield form.scenario(name, "RESPONSE_FORMAT", edit, total - size + before, errors=form.up_to(index, 0x0E, 1))
        before = size


def _failed(form: AnswerForm, sizes: list[int]) -> Iterator[EngineScenario]:
    parts = form.letter.parts
    two = bytes.fromhex("440200110007")
    chosen: Iterable[int]
    for name, chosen in (
        ("all parameters fail", range(len(parts))),
        ("first and last fail", {0, len(parts) - 1}),
        *(
            (f"all but parameter {n + 1} fail", set(range(len(parts))) - {n})
            for n in range(len(parts) if len(parts) > 2 else 0)
        ),
    ):

        def change(blocks: list[bytes], chosen: Iterable[int] = chosen) -> None:
            for index in chosen:
                blocks[index] = two

        errors = {index + 1: (0x8011, 7) if index in chosen else (0, 0) for index in range(len(parts))}
        yield form.scenario(name, "PARAMETER_ERROR", form.negative(change), errors=errors)
        length = 4 + sum(6 if index in chosen else size for index, size in enumerate(sizes))
        for more in (1, 2):
            yield form.broken(f"{name}, {more} bytes after it", form.negative(change, bytes(more)), length + more)


def _written(form: AnswerForm) -> Iterator[EngineScenario]:
    """Blocks of good parameters in a partly refused change are 40 00, nothing else."""
    count = len(form.letter.parts)
    two = bytes.fromhex("440200110007")
    for wrong, error in (
        (b"\x40\x01", 0x8140), (b"\x41\x00", 0x8141), (b"\x00\x00", 0x8100), (b"\x43\x01\1\2\3\4", 0x8143),
    ):  # fmt: skip
        for index in sorted({0, count - 1}):

            def change(blocks: list[bytes], index: int = index, wrong: bytes = wrong) -> None:
                blocks[index] = wrong
                if count > 1:
                    blocks[0 if index else count - 1] = two

            # under a negative id a block that is neither 40 00 nor an error is one that failed
            errors = {index + 1: (error, wrong[1])} | ({1 if index else count: (0x8011, 7)} if count > 1 else {})
            if error == 0x8100:  # nobody knows where the next block begins
                errors |= dict.fromkeys(range(index + 2, count + 1), (NO_ANSWER, 0))
            name = f"good parameter {index + 1} answered {wrong.hex(' ')}"
            yield form.scenario(name, "PARAMETER_ERROR", form.negative(change), errors=errors)


def _instead(form: AnswerForm, block: bytes) -> Edit:
    """A negative answer with one block for the whole request."""
    return lambda answer: bytes((answer[0], 0x80 | form.good, *answer[2:4])) + block


def _refused(form: AnswerForm) -> Iterator[EngineScenario]:
    count = len(form.letter.parts)
    for number in (0x00, 0x11, 0x19, 0x21, 0x23, 0xFF):
        for words in (1, 2):
            block = bytes((0x44, words, 0, number)) + (INFO.to_bytes(2) if words == 2 else b"")
            edit = _instead(form, block)
            name = f"one error block {number:02X}h for the whole request, {words} error words"
            errors = dict.fromkeys(range(1, count + 1), (32768 | number, INFO if words == 2 else 0))
            yield form.scenario(name, "PARAMETER_ERROR" if count == 1 else "REFUSED", edit, errors=errors)
    for more in (1, 2):
        block = bytes.fromhex("44020011 0007") + bytes(more)
        edit = _instead(form, block)
        name = f"one error block and {more} bytes after it"
        if more == 2 and count > 1:  # 00 00 is the second block, in a format that is not known
            errors = form.up_to(2, 0, 0) | {1: (0x8011, 7)}
            yield form.scenario(name, "PARAMETER_ERROR", edit, errors=errors)
        else:
            yield form.broken(name, edit)
    for block in (bytes.fromhex("4201 0011"), bytes.fromhex("4403 0011 0001 0002")) if count > 1 else ():
        edit = _instead(form, block)
        yield form.broken(f"one block {block[:2].hex(' ')} for the whole request", edit)


def _formats(form: AnswerForm) -> Iterator[EngineScenario]:
    sizes = {fmt.code: fmt.size for fmt in FORMATS}
    sizes |= {code: sizes[code + 0x50] for code in range(0x21, 0x2D)}  # N2 to X4 as they were numbered once
    for index, (at, _) in enumerate(form.letter.blocks, 1):
        part = form.letter.parts[index - 1]
        generic = None if part.format.is_string else generic_of(part.format.size)
        code = part.format.code
        accepted = {code, _FIRMWARE.get(code, code)} | ({generic.code} if generic is not None else set())
        if generic is not None:
            yield form.scenario(f"block {index} in format {generic.code:02X}h", "DONE", _put(at, generic.code))
        for wrong in range(256):
            if wrong in accepted or wrong == 0x44:
                continue
            # same size: the walk goes on, this parameter is named; else the next block is not where it should be
            same = sizes.get(wrong) == part.format.size
            name = f"block {index} in format {wrong:02X}h"
            if same:
                errors = dict.fromkeys(range(1, len(form.letter.parts) + 1), (0, 0)) | {
                    index: (0x8100 | wrong, part.count)
                }
                yield form.scenario(name, "RESPONSE_FORMAT", _put(at, wrong), errors=errors, follow=False)
            elif wrong not in sizes:
                errors = form.up_to(index, wrong, part.count)
                yield form.scenario(name, "RESPONSE_FORMAT", _put(at, wrong), errors=errors, follow=False)
            else:
                yield form.scenario(name, "RESPONSE_FORMAT", _put(at, wrong), follow=False)
        yield form.scenario(f"block {index} in format 44h", "RESPONSE_FORMAT", _put(at, 0x44))
        for count in {0, part.count - 1, (part.count + 1) % 256, part.count ^ 0x80} - {part.count}:
            yield form.scenario(f"block {index} with {count} values", "RESPONSE_FORMAT", _put(at + 1, count))
        yield from _another(form, index)


def types_of_a_size(form: AnswerForm) -> Iterator[EngineScenario]:
    """The first value in every other type of its size: 41h to 43h, one TimeDifference for the other, old numbers."""
    (at, _), part = form.letter.blocks[0], form.letter.parts[0]
    generic = generic_of(part.format.size)
    taken = {_FIRMWARE.get(part.format.code)} | ({generic.code} if generic is not None else set())
    taken |= {part.format.code - 0x50} if 0x71 <= part.format.code <= 0x7C else set()
    for other in (*FORMATS, *OLDER):
        if other.size != part.format.size or not other.writable or other.code == part.format.code:
            continue
        name = f"{part.format.name} comes as {other.name}"
        if other.code in taken:
            yield form.scenario(name, "DONE", _put(at, other.code), follow=False)
        else:
            errors = {1: (0x8100 | other.code, part.count)}
            yield form.scenario(name, "RESPONSE_FORMAT", _put(at, other.code), errors=errors, follow=False)


def wider_integers(form: AnswerForm) -> Iterator[EngineScenario]:
    """Integers of one or two bytes that come as 42h or 43h are taken if all of them fit, whatever their number."""
    for index, (at, size) in enumerate(form.letter.blocks, 1):
        part = form.letter.parts[index - 1]
        for code, width in ((WORD, 2), (DOUBLE_WORD, 4)):
            for value, good in _around(part.format):
                if width <= part.format.size or not -(1 << 8 * width - 1) <= value < 1 << 8 * width - 1:
                    continue
                for place in sorted({0, part.count - 1}):
                    numbers = [0] * part.count
                    numbers[place] = value
                    values = b"".join(number.to_bytes(width, signed=True) for number in numbers)
                    edit = instead(at, size, bytes((code, part.count)) + values)
                    errors = {} if good else {index: (0x8100 | code, part.count)}
                    name = f"{part.format.name}: value {place + 1} of {part.count} comes as {value} in {code:02X}h"
                    word = "DONE" if good else "RESPONSE_FORMAT"
                    yield form.scenario(name, word, edit, errors=errors, follow=False)
        block = bytes((DOUBLE_WORD, part.count + 1)) + bytes(4 * (part.count + 1))
        yield form.scenario(
            f"{part.format.name}: one value more in 43h", "RESPONSE_FORMAT", instead(at, size, block),
            errors={index: (0x8143, part.count + 1)}, follow=False,
        )  # fmt: skip


def _around(fmt: Format) -> list[tuple[int, bool]]:
    """Numbers at the ends of what an integer holds and next to them, and whether it holds them."""
    return {
        "Integer8": [(-129, False), (-128, True), (-1, True), (0, True), (127, True), (128, False), (255, False)],
        "Integer16": [(-32769, False), (-32768, True), (-1, True), (32767, True), (32768, False), (65535, False)],
        "Unsigned8": [(-1, False), (0, True), (255, True), (256, False)],
        "Unsigned16": [(-1, False), (0, True), (65535, True), (65536, False)],
    }.get(fmt.name, [])


def _another(form: AnswerForm, index: int) -> Iterator[EngineScenario]:
    """A whole block of another type, length or number: the parameters around it are good."""
    at, size = form.letter.blocks[index - 1]
    part = form.letter.parts[index - 1]
    count = len(form.letter.parts)
    good = dict.fromkeys(range(1, count + 1), (0, 0))
    for code, number, length in (
        (0x41, part.size, part.size), (0x43, 2, 8), (0x06, 1, 2), (0x37, 1, 8), (0x32, 1, 7), (0x0C, 2, 12),
        (0x40, 0, 0), (0x01, 1, 1), (0x08, 0, 0), (0x08, 3, 12),
    ):  # fmt: skip
        if number == part.count and length == part.size:
            continue
        block = bytes((code, number)) + bytes(range(1, length + 1)) + bytes(length % 2)
        stated = {**good, index: (0x8100 | code, number)}
        name = f"block {index} is {number} x {code:02X}h"
        yield form.scenario(name, "RESPONSE_FORMAT", instead(at, size, block), errors=stated)
