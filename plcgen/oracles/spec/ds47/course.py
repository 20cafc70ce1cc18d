"""Follow the conversation of one run of a job, value by value, and say where it is not what the spec demands."""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from plcgen.oracles.profidrive import SUBSTITUTES, VALUE_ATTRIBUTE
from plcgen.oracles.spec.ds47.recorder import HeardAccess, HeardTelegram, Key
from plcgen.oracles.spec.ds47.statement import Number, Source, StatedAccess, StatedJob, StatedStep
from plcgen.oracles.spec.ds47.types import base, code_of, is_signed, packed, unpacked
from plcgen.oracles.spec.ds47.values import octets
from plcgen.oracles.spec.place import SpecPlace

OUTPUTS_ONLY = 0x8000
"""Bit 15 of the ID on S7-300/400: an address of outputs (docs/hardware-id.md)."""
Supplied = Mapping[Source, Number | bytes]
"""What inputs, records and the clock stand at."""


@dataclass(frozen=True, slots=True)
class Difference:
    """The files do not do what the spec demands; ``place`` is where it demands it."""

    place: SpecPlace
    expected: str
    found: str

    def __str__(self) -> str:
        return f"{self.found} instead of {self.expected}"


@dataclass(frozen=True, slots=True)
class _Value:
    """One value that is to come: the ``at``-th of an access."""

    access: StatedAccess
    at: int

    @property
    def index(self) -> int:
        return self.access.index + self.at

    def is_of(self, heard: HeardAccess, index: int) -> bool:
        return (heard.number, index) == (self.access.number, self.index)

    def __str__(self) -> str:
        access = self.access
        place = f"[{self.index}]" if access.indexed or access.count > 1 else ""
        return f"a {'write' if access.write else 'read'} of {access.number}{place} ({access.written})"


Answers = Callable[[int, int], Mapping[tuple[int, int], Number] | None]
"""Number of a step and of the question in it, both from 0: values of the answer by number and subindex, or None."""


def no_answers(_step: int, _question: int) -> None:
    """The device answers with what it holds."""


@dataclass
class StatedCourse:
    """One run: ``identifier`` is what stands in the ID, ``held`` what the device has, ``answers`` what it says.

    ``done`` of a question tells whether the answer is the one that is waited for.
    """

    job: StatedJob
    steps: Sequence[StatedStep]
    identifier: int
    supplied: Supplied
    held: Callable[[Key], bytes]
    answers: Answers = no_answers
    met: Callable[[int, int], bool] = lambda _step, _question: True
    differences: list[Difference] = field(default_factory=list)
    asked: dict[int, list[HeardTelegram]] = field(default_factory=dict)
    """Telegrams by the number of their step."""
    brought: dict[tuple[int, int, int], HeardTelegram] = field(default_factory=dict)
    """The last answer to a value, by numbers of its step, of its access, and in that."""
    step: int = 0
    question: int = 0
    _left: list[_Value] = field(default_factory=list)
    _telegram: HeardTelegram | None = None

    def __post_init__(self) -> None:
        self._begin(0)

    @property
    def over(self) -> bool:
        """Whether everything has come."""
        return self.step >= len(self.steps)

    def _begin(self, step: int) -> None:
        self.step, self.question = step, 0
        self._left = [] if self.over else list(self._values(self.steps[step]))

    @staticmethod
    def _values(step: StatedStep) -> list[_Value]:
        return [_Value(access, at) for access in step.accesses for at in range(access.count)]

    def differ(self, place: SpecPlace, expected: str, found: str) -> None:
        """Note a difference; after the first few nothing is to be learnt from more."""
        self.differences.append(Difference(place, expected, found))

    def hear(self, telegram: HeardTelegram) -> Mapping[Key, bytes]:
        """A request; what it is answered with instead of what the device holds."""
        self._check_drive(telegram)
        if self.over:
            self.differ(self.job.place, "no more request", heard_text(telegram))
            return {}
        self._telegram = telegram
        step = self.steps[self.step]
        self.asked.setdefault(self.step, []).append(telegram)
        return self._ask(step, telegram) if step.until else self._take(telegram)

    def _check_drive(self, telegram: HeardTelegram) -> None:
        drive = self.job.drive
        if telegram.identifier != self.identifier:
            self.differ(drive.place, f"identifier {self.identifier}", f"a request to identifier {telegram.identifier}")
        if telegram.record != drive.record:
            self.differ(drive.place, f"record {drive.record:04X}h", f"a request to record {telegram.record:04X}h")
        if telegram.drive_object != drive.drive_object:
            found = f"a request to drive object {telegram.drive_object}"
            self.differ(drive.place, f"drive object {drive.drive_object}", found)
        self._check_room(telegram)

    def _check_room(self, telegram: HeardTelegram) -> None:
        """How telegrams are packed is free, but the drive must take them."""
        drive = self.job.drive
        if max(len(telegram.data), answer_length(telegram, self.job)) > drive.longest:
            self.differ(self.job.place, f"telegrams of at most {drive.longest} bytes", heard_text(telegram))
        if len(telegram.accesses) > drive.most_parameters:
            expected = f"at most {drive.most_parameters} parameters in a telegram"
            self.differ(self.job.place, expected, heard_text(telegram))
        if max(access.elements for access in telegram.accesses) > drive.most_elements:
            expected = f"at most {drive.most_elements} elements of a parameter in a telegram"
            self.differ(self.job.place, expected, heard_text(telegram))

    # --- accesses that come once ----------------------------------------------------------------------

    def _take(self, telegram: HeardTelegram) -> Mapping[Key, bytes]:
        first = self.step
        instead: dict[Key, bytes] = {}
        for heard in telegram.accesses:
            for at, index in enumerate(heard.indexes):
                if self.over or (self.steps[self.step].number and self.step != first):
                    self.differ(self.job.place, "a telegram of its own for each step", heard_text(telegram))
                    return instead
                step, here = self.steps[self.step], self.step
                value = self._next(heard, index, step, telegram)
                if value is None:
                    return instead
                self._check(value, heard, at, telegram)
                instead |= self._answer(here, value)
                if not self._left:
                    self._end(step, telegram, first)
        return instead

    def _end(self, step: StatedStep, telegram: HeardTelegram, first: int) -> None:
        if step.together and len(self.asked[self.step]) > 1:
            self.differ(step.accesses[0].place, "all of it in one telegram", heard_text(telegram))
        self._begin(self.step + 1)
        if not self.over and self.step > first:
            self.asked.setdefault(self.step, [])

    def _next(self, heard: HeardAccess, index: int, step: StatedStep, telegram: HeardTelegram) -> _Value | None:
        for value in self._left if not step.ordered else self._left[:1]:
            if value.is_of(heard, index) and value.access.write == telegram.write:
                self._left.remove(value)
                return value
        wanted = self._left[0]
        found = f"a {'write' if telegram.write else 'read'} of {heard.number}[{index}]"
        self.differ(wanted.access.place, str(wanted), found)
        return None

    def _check(self, value: _Value, heard: HeardAccess, at: int, telegram: HeardTelegram) -> None:
        access = value.access
        self._check_address(access, heard)
        if telegram.write:
            self._check_value(value, heard, heard.data[at * access.size : (at + 1) * access.size])
        else:
            self.brought[self.step, access_number(self.steps[self.step], access), value.at] = telegram

    def _check_address(self, access: StatedAccess, heard: HeardAccess) -> None:
        if heard.attribute != VALUE_ATTRIBUTE:
            self.differ(access.place, "attribute 10h", f"attribute {heard.attribute:02X}h")
        scalar = not access.indexed and access.count == 1
        if scalar and heard.elements != access.elements:
            found = f"{heard.elements} elements of {access.number}"
            self.differ(access.place, f"{access.elements} for a parameter without an index", found)
        if not scalar and not heard.elements:
            self.differ(access.place, "a number of elements", f"none for {access.number}")

    def _check_value(self, value: _Value, heard: HeardAccess, data: bytes) -> None:
        access = value.access
        if heard.code not in {code_of(access.type), SUBSTITUTES.get(access.size)} or len(data) != access.size:
            found = f"{access.number} with format {heard.code:02X}h"
            self.differ(access.place, f"{access.type}: format {code_of(access.type):02X}h", found)
        wanted = self.wanted(access, value.at)
        if data != wanted and not padding(access, wanted, data):
            name = f"{access.number}[{value.index}]" if access.indexed else f"{access.number}"
            said = said_of(access, value.at)
            self.differ(
                access.place,
                f"{name} = {number_shown(access.type, wanted)} ({said})",
                f"{name} = {number_shown(access.type, data)}",
            )

    def wanted(self, access: StatedAccess, at: int) -> bytes:
        """What must be written: octets of a text, the word with its bits, or the value."""
        if access.bits:
            key = (self.job.drive.drive_object, access.number, access.index)
            return word_with_bits(access, self.held(key), self.supplied)
        return value_bytes(access, at, self.supplied)

    def _answer(self, step: int, value: _Value) -> Mapping[Key, bytes]:
        said = self.answers(step, 0)
        if said is None or value.access.write or (value.access.number, value.index) not in said:
            return {}
        key = (self.job.drive.drive_object, value.access.number, value.index)
        return {key: packed(value.access.type, said[value.access.number, value.index])}

    # --- questions ------------------------------------------------------------------------------------

    def _ask(self, step: StatedStep, telegram: HeardTelegram) -> Mapping[Key, bytes]:
        """One question: all of it in one telegram, nothing else in it."""
        wanted = {(value.access.number, value.index): value for value in self._values(step)}
        heard = {(access.number, index): access for access in telegram.accesses for index in access.indexes}
        if telegram.write or set(heard) != set(wanted):
            self.differ(
                step.accesses[0].place, f"a question for {'; '.join(map(str, step.accesses))}", heard_text(telegram)
            )
            return {}
        for place, value in wanted.items():
            self._check_address(value.access, heard[place])
        for number, access in enumerate(step.accesses):
            self.brought |= dict.fromkeys(((self.step, number, at) for at in range(access.count)), telegram)
        said = self.answers(self.step, self.question) or {}
        types = {value.access.number: value.access.type for value in wanted.values()}
        owner = self.job.drive.drive_object
        instead = {(owner, number, index): packed(types[number], value) for (number, index), value in said.items()}
        if self.met(self.step, self.question):
            self._begin(self.step + 1)
        else:
            self.question += 1
        return instead

    def answer(self, step: int, number: int) -> list[bytes]:
        """What the device last answered to an access, value by value; empty where nothing came."""
        access = self.steps[step].accesses[number]
        found = []
        for at in range(access.count):
            telegram = self.brought.get((step, number, at))
            found.append(answer_to(telegram, access, at) if telegram is not None else b"")
        return found

    def missing(self) -> None:
        """The job has ended: what has not come is missing."""
        if not self.over and not self.differences:
            step = self.steps[self.step]
            expected = str(self._left[0]) if self._left and not step.until else str(step)
            self.differ(step.accesses[0].place, expected, "no request")


def answer_to(telegram: HeardTelegram, access: StatedAccess, at: int) -> bytes:
    """The answer to one value."""
    for heard, data in zip(telegram.accesses, telegram.answered, strict=False):
        place = access.index + at - heard.index
        if heard.number == access.number and 0 <= place < len(heard.indexes):
            return data[place * access.size : (place + 1) * access.size]
    return b""


def answer_length(telegram: HeardTelegram, job: StatedJob) -> int:
    """Bytes of the good answer: header, then format, count and values padded to words for each parameter."""
    if telegram.write:
        return 4
    sizes = {access.number: access.size for step in job.steps for access in step.accesses}
    octets = (sizes.get(access.number, 0) * len(access.indexes) for access in telegram.accesses)
    return 4 + sum(2 + length + length % 2 for length in octets)


def access_number(step: StatedStep, access: StatedAccess) -> int:
    """Which access of a step it is."""
    return next(number for number, one in enumerate(step.accesses) if one is access)


def padding(access: StatedAccess, wanted: bytes, data: bytes) -> bool:
    """Whether it is an octet behind the end of a text: what stands there nobody says."""
    return access.string and not wanted and data in {b"\0", b" "}


def value_bytes(access: StatedAccess, at: int, supplied: Supplied) -> bytes:
    """One value as it must stand in a telegram; empty behind the end of a text."""
    if access.string and len(access.values) == 1 and isinstance(access.values[0], str):
        text = octets(access.type, access.values[0])
        return bytes(text[at : at + 1])
    number = number_of_source(access.values[at], supplied)
    return number if isinstance(number, bytes) else packed(access.type, number)


def number_of_source(source: Source, supplied: Supplied) -> Number | bytes:
    """A constant, or what its source stands at."""
    if isinstance(source, int | float):
        return source
    if isinstance(source, str):
        return source.encode("latin-1")
    return supplied[source]


def word_with_bits(access: StatedAccess, word: bytes, supplied: Supplied) -> bytes:
    """The word with the bits of an access, counted from 0 at the right."""
    number = int.from_bytes(word)
    for bit, source in access.bits:
        value = number_of_source(source, supplied)
        number = number & ~(1 << bit) | (1 << bit if value else 0)
    return number.to_bytes(len(word))


def said_of(access: StatedAccess, at: int) -> str:
    """What the spec says of one value."""
    if access.bits:
        return ", ".join(f"bit {bit} = {source}" for bit, source in access.bits)
    return f"{access.written}: {access.values[at] if at < len(access.values) else access.values[0]}"


def number_shown(type_: str, data: bytes) -> str:
    """A value for a reader: number, and bytes if that says more."""
    if not data or base(type_) in {"VisibleString", "OctetString"}:
        return data.hex(" ").upper() or "nothing"
    try:
        number = unpacked(type_, data)
    except struct.error:
        return data.hex(" ").upper()
    return f"{number}" if is_signed(type_) or isinstance(number, float) else f"{number} (16#{number:X})"


def heard_text(telegram: HeardTelegram) -> str:
    """A request in words."""
    service = "writes" if telegram.write else "reads"
    names = ", ".join(f"{a.number}[{a.index}]{f' x{a.elements}' if a.elements > 1 else ''}" for a in telegram.accesses)
    return f"a request that {service} {names}"
