"""Bits that a job writes or shows: those of one word are one access; a write changes nothing else in the word."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace

from plcgen.ds47.kind import Items, ReadItem, WriteItem
from plcgen.ds47.plan.access import Bit, Mask, Use, Write
from plcgen.ds47.plan.uses import UseResolver
from plcgen.ds47.references import split_bit
from plcgen.ds47.wire import formats
from plcgen.ds47.wire.formats import FormatKind, integer_range
from plcgen.project.spec import SpecPath
from plcgen.s7.types.names import camel_case, shorten

_BIT = formats.by_name("Boolean")
_LONGEST = 4
"""Bytes of a word, at most."""


def has_bits(items: Items) -> bool:
    """Whether any of the items is a bit."""
    return any(split_bit(item.parameter) is not None for item in items)


@dataclass(slots=True)
class BitResolver:
    """The items of a job of which some are bits; ``uses`` and what is read of each, in the order of the spec."""

    resolver: UseResolver
    uses: list[Use] = field(default_factory=list)
    items: list[ReadItem | WriteItem] = field(default_factory=list)
    complete: bool = True

    def add(self, items: Items, place: SpecPath) -> None:
        """All items of a job; what is wrong is reported and left out."""
        for number, item in enumerate(items):
            path = (*place, number)
            found = split_bit(item.parameter)
            if found is None or not isinstance(item, WriteItem):
                use = self.resolver.resolve(item, len(self.uses) + 1, path, write=True)
                if use is not None:
                    self.uses.append(use)
                    self.items.append(item)
            else:
                whole = ReadItem(parameter=found[0], type=item.type)
                use = self._bit(item, whole, found[1], path)
            self.complete = self.complete and use is not None
        self.uses = [self._complete(use) if use.bits else use for use in self.uses]

    def _bit(self, item: WriteItem, whole: ReadItem, number: int, path: SpecPath) -> Use | None:
        """A bit, added to those of its word; None after a diagnostic."""
        word = self.resolver.resolve(whole, len(self.uses) + 1, path, write=True)
        if word is None or not self.fits(word, number, path):
            return None
        given = item.value if item.value is not None else item.start if item.start is not None else 0
        if isinstance(given, tuple) or given not in {0, 1} or isinstance(given, float):
            where = (*path, "value" if item.value is not None else "start")
            self._problem(f"{word.label}.{number} is 0 or 1, not {given}", where, "write 0 or 1")
            return None
        name = item.as_ or shorten(f"{word.member}Bit{number}", self.resolver.longest_name)
        bit = replace(
            word, format=_BIT, data=bytes((bool(given),)), member=name, comment=item.comment or {}, item=item,
            role=Bit(number, constant=item.value is not None),
        )  # fmt: skip
        at = next((n for n, one in enumerate(self.uses) if one.bits and _same(one, word)), None)
        if at is None:
            bit = replace(bit, position=-_LONGEST * 8 * word.position - number)
            self.uses.append(replace(word, role=Write(constant=True, bits=(bit,)), item=item))
            self.items.append(whole)
            return bit
        there = self.uses[at]
        if any(one.bit == number for one in there.bits):
            message = f"{bit.label} is written twice in this job"
            self.resolver.problem("PG213", message, (*path, "parameter"), "remove one of them")
            return None
        bit = replace(bit, position=-_LONGEST * 8 * there.position - number)
        bits = tuple(sorted((*there.bits, bit), key=lambda one: one.bit or 0))
        self.uses[at] = replace(there, role=Write(constant=True, bits=bits))
        return bit

    def fits(self, word: Use, number: int, path: SpecPath) -> bool:
        """Whether a parameter is one word that has the bit; PG259 if not."""
        fmt, place = word.format, (*path, "parameter")
        top = 8 * fmt.size - 1
        if word.count > 1:
            self._problem(f"{word.label} has several values: a bit belongs to one of them", place, "write one index")
        elif word.sources or word.parameter.bico:
            message = f"{word.label} is a source{word.parameter.doubt('bico')}, not a word with bits"
            self._problem(message, place, "write it as a whole: r722.2")
        elif fmt.kind not in {FormatKind.SIGNED, FormatKind.UNSIGNED} or fmt.size > _LONGEST:
            index = f"write {word.label}[{number}] for an index" if word.first is None else "write it as a whole"
            self._problem(f"{word.label} is {word.type_text}, which has no bits", place, index)
        elif number > top:
            self._problem(f"{word.label} is {word.type_text}: its bits are 0..{top}, not {number}", place, "")
        else:
            return True
        return False

    def _complete(self, word: Use) -> Use:
        """A word with all its bits: where it starts from; PG259 if they lead beyond what it may be."""
        limit = word.parameter.maximum
        set_ = [one for one in word.bits if not one.constant or any(one.data)]
        highest = sum(1 << (one.bit or 0) for one in set_)
        _, most = integer_range(word.format) or (0, 0)
        if limit is not None and limit < highest <= most:
            place, message = (*set_[-1].path, "parameter"), f"{word.label} may be {highest}, and {word.parameter.label}"
            self._problem(f"{message} is {limit:g} at most", place, "the drive would answer error 02h")
            self.complete = False
        low = word.parameter.minimum
        start = int(low) if low is not None and low > 0 else 0
        start = int(limit) if limit is not None and limit < 0 else start
        size = word.format.size
        data = _merged(word, (start % (1 << 8 * size)).to_bytes(size), {one.position: one.data for one in word.bits})
        return replace(word, data=data)

    def _problem(self, message: str, path: SpecPath, help_: str) -> None:
        self.resolver.problem("PG259", message, path, help_)


def shown_bit(word: Use, number: int, item: ReadItem, path: SpecPath, resolver: UseResolver) -> Use | None:
    """A bit of a word that is read; None after a diagnostic. It is called as the lists of the drive call it."""
    indexes = word.parameter.array or word.parameter.doubted.get("array")
    if word.first is None and isinstance(indexes, int):
        help_ = f"write {word.label}[{number}] for an index, {word.label}[0].{number} for a bit"
        message = f"{word.label} has {indexes} indexes{word.parameter.doubt('array')}: a bit belongs to one of them"
        resolver.problem("PG259", message, (*path, "parameter"), help_)
        return None
    if not BitResolver(resolver).fits(word, number, path):
        return None
    text = resolver.device.bit_text(word.parameter.pnu, number, resolver.object_type)
    own = camel_case(re.sub("[^A-Za-z0-9]+", "_", text.partition(" (")[0]).strip("_").lower())
    name = own if re.match("[a-z]", own) else f"{word.member}Bit{number}"
    return replace(
        word, format=_BIT, data=b"\0", member=item.as_ or shorten(name, resolver.longest_name), path=path, item=item,
        comment=item.comment or {}, role=Bit(number, constant=False), position=-_LONGEST * 8 * word.position - number,
        parameter=replace(word.parameter, title=text or word.parameter.title, unit=""),
    )  # fmt: skip


def _merged(word: Use, old: bytes, bits: dict[int, bytes]) -> bytes:
    """Bytes of a word in which only its bits are others; they are given by position."""
    number = int.from_bytes(old)
    for one in word.bits:
        mask = 1 << (one.bit or 0)
        number = number | mask if any(bits[one.position]) else number & ~mask
    return number.to_bytes(len(old))


def _same(one: Use, other: Use) -> bool:
    return (one.parameter.pnu, one.subindex) == (other.parameter.pnu, other.subindex)


def in_front(uses: tuple[Use, ...], items: Items, resolver: UseResolver) -> tuple[tuple[Use, ...], Items]:
    """The uses of a job behind reads of those words of which it writes bits, and what is read of each."""
    olds = [
        (old, item) for use, item in zip(uses, items, strict=True) if (old := _old(use, item, resolver)) is not None
    ]
    moved = [replace(use, position=use.position + len(olds)) for use in uses]
    words = (use for use in moved if use.bits)
    first = [
        replace(old, position=n, role=Mask(word)) for n, ((old, _), word) in enumerate(zip(olds, words, strict=True), 1)
    ]
    return (*first, *moved), (*(item for _, item in olds), *items)


def _old(use: Use, item: ReadItem | WriteItem, resolver: UseResolver) -> Use | None:
    if not use.bits:
        return None
    name = shorten(f"{use.member}Before", resolver.longest_name)
    again = ReadItem.model_validate({"parameter": item.parameter, "type": item.type, "as": name})
    return resolver.resolve(again, use.position, use.path, write=False)
