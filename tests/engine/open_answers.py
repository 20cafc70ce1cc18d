"""Answers to a telegram that names no types: three parameters of one, three and two values, room for 8 bytes each."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.ds47.proof.words import NO_ANSWER, WORDS
from tests.engine.scenario import Edit, EngineScenario

FIRST, SECOND, THIRD = (bytes.fromhex(text) for text in ("0801 41200000", "0503 010203 00", "0302 0001 0002"))
"""10.0 as FloatingPoint; 1, 2, 3 as Unsigned8; 1, 2 as Integer16."""
TAKEN = (
    "0101 01 00", "0201 FF 00", "0301 8000", "0401 80000000", "0501 07 00", "0601 FFFF", "0701 FFFFFFFF",
    "0901 41 00", "0A01 09 00", "0C01 010203040506", "0D01 00000064", "0F01 3FF0000000000000",
    "3201 01020304050607 00", "3401 00000001", "3501 010203040506", "3601 00000064", "3701 FFFFFFFFFFFFFFFF",
    "3801 8000000000000000", "4101 80 00", "4201 8000", "4301 80000000",
    "7101 4000", "7201 40000000", "7301 8001", "7401 4000", "7501 0001", "7601 0064", "7701 00000064", "7801 0064",
    "7901 0080", "7A01 00000001", "7B01 0003", "7C01 00000003",
    "2101 4000", "2201 40000000", "2301 8001", "2401 4000", "2501 0001", "2601 0064", "2701 00000064", "2801 0064",
    "2901 0080", "2A01 00000001", "2B01 0003", "2C01 00000003",
)  # fmt: skip
"""One value in every type there is, as the tables of data set 47 have it."""
GOOD = (0, 0)
NOTHING = (NO_ANSWER, 0)


def _blocks(*blocks: bytes, negative: bool = False) -> Edit:
    """An answer with these blocks."""
    return lambda answer: bytes((answer[0], 0x81 if negative else 0x01, *answer[2:4])) + b"".join(blocks)


def open_answers() -> Iterator[EngineScenario]:
    """What comes is taken as it came if its number is right and it fits; everything else as with a known type."""
    for text in TAKEN:
        block = bytes.fromhex(text)
        edit = _blocks(block, SECOND, THIRD)
        yield EngineScenario(name=f"{text} is taken", reads={1: edit}, errors=dict.fromkeys((1, 2, 3), GOOD))
    for text in ("0303 0001 0002 0003", "0A03 010203 00", "4203 0001 0002 0003"):
        edit = _blocks(FIRST, bytes.fromhex(text), THIRD)
        yield EngineScenario(name=f"{text} is taken", reads={1: edit}, errors=dict.fromkeys((1, 2, 3), GOOD))
    for place, text, error, behind in (
        (1, "4001", (0x8140, 1), GOOD),  # no value
        (1, "4000", (0x8140, 0), GOOD),
        (1, "0800", (0x8108, 0), GOOD),
        (1, "0802 41200000 41200000", (0x8108, 2), GOOD),
        (2, "0403 00000001 00000002 00000003", (0x8104, 3), GOOD),  # 12 bytes
        (2, "4303 00000001 00000002 00000003", (0x8143, 3), GOOD),  # and no narrower type that they would fit
        (3, "0F02 3FF0000000000000 3FF0000000000000", (0x810F, 2), GOOD),
        (3, "3502 010203040506 010203040506", (0x8135, 2), GOOD),
        (3, "0E02 0001 0002", (0x810E, 2), NOTHING),
        (3, "0002 0102030405060708", (0x8100, 2), NOTHING),
        (3, "0002 00010002", (0x8100, 2), NOTHING),
        (1, "0001 41200000", (0x8100, 1), NOTHING),
    ):
        given = [FIRST, SECOND, THIRD]
        given[place - 1] = bytes.fromhex(text)
        errors = {n: GOOD if n < place else error if n == place else behind for n in (1, 2, 3)}
        yield EngineScenario(
            name=f"parameter {place} comes as {text}", reads={1: _blocks(*given)}, errors=errors,
            status=(WORDS["RESPONSE_FORMAT"],), follow=False,
        )  # fmt: skip
    refused = bytes.fromhex("4402 0011 0007")
    yield EngineScenario(
        name="one of them is refused", reads={1: _blocks(FIRST, refused, THIRD, negative=True)},
        errors={1: GOOD, 2: (0x8011, 7), 3: GOOD}, status=(WORDS["PARAMETER_ERROR"],),
    )  # fmt: skip
    yield EngineScenario(
        name="all of it is refused", reads={1: _blocks(refused, negative=True)},
        errors=dict.fromkeys((1, 2, 3), (0x8011, 7)), status=(WORDS["REFUSED"],),
    )  # fmt: skip
    yield EngineScenario(
        name="an error under a positive id", reads={1: _blocks(FIRST, refused, THIRD)},
        errors=dict.fromkeys((1, 2, 3), NOTHING), status=(WORDS["RESPONSE_FORMAT"],),
    )  # fmt: skip
