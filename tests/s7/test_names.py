"""Identifier rules of the two tool chains, file names, shortening."""

from __future__ import annotations

import zlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from plcgen.s7.types.names import RESERVED, camel_case, check_name, pascal_case, shorten


@pytest.mark.parametrize(
    ("name", "v5", "role", "reason"),
    [
        ("SpeedLimit", True, "identifier", None),
        ("Speed Limit", False, "identifier", None),
        ("Größe", False, "symbol", None),
        ("参数", False, "identifier", None),
        ("a" * 24, True, "symbol", None),
        ("a" * 25, True, "symbol", "at most 24"),
        ("a" * 125, False, "symbol", None),
        ("a" * 126, False, "identifier", "at most 125"),
        ("", False, "symbol", "empty"),
        ('a"b', False, "identifier", 'character "'),
        ("a.b", False, "symbol", "character ."),
        ("a\tb", False, "symbol", "U+0009"),
        ("a\u200bb", False, "identifier", "U+200B"),
        (" a", False, "symbol", "space"),
        ("begin", False, "identifier", "BEGIN is a reserved"),
        ("Größe", True, "identifier", "A-Z"),
        ("1st", True, "identifier", "no digit first"),
        ("a__b", True, "identifier", "two underscores"),
        ("a_", True, "identifier", "trailing"),
        ("DB12", True, "identifier", "absolute"),
        ("a/b", False, "symbol", "character /"),
        ("a\\b", True, "symbol", "character \\"),
        ("..", False, "file", "folder"),
        ("con", False, "file", "device"),
        ("CON.txt", False, "file", "device"),
        ("a.", False, "file", "dot"),
        ("a.scl", False, "file", None),
        ("LPT1", False, "symbol", "device"),
        ("COM10", False, "file", None),
        ("a:b", False, "file", "character :"),
    ],
)
def test_names(name, v5, role, reason):
    found = check_name(name, v5, role)
    assert (reason is None) == (found is None), found
    assert reason is None or reason in found


def test_unknown_roles_are_a_programming_error():
    with pytest.raises(ValueError):
        check_name("a", False, "thing")


def test_reserved_words_are_upper_case_and_refused_in_any_case():
    for word in RESERVED:
        assert word == word.upper()
        assert check_name(word.lower(), True, "identifier")


def test_shortened_names_keep_their_beginning_and_a_checksum():
    name = "ReadActualSpeedOfTheMainDrive"
    assert f"ReadActualSpeedOfThe_{zlib.crc32(name.encode()) & 0xFFF:03x}" == shorten(name, 24)
    assert shorten("short", 24) == "short"
    with pytest.raises(ValueError):
        shorten("abcdef", 4)


@given(st.text("abc_Z9", min_size=1, max_size=60), st.integers(5, 40))
def test_shortening_is_stable_and_never_longer(name, limit):
    assert len(shorten(name, limit)) <= limit
    assert shorten(name, limit) == shorten(shorten(name, limit), limit)
    assert "__" not in shorten(name, limit)[-5:] or name == shorten(name, limit)


@pytest.mark.parametrize(
    ("name", "pascal", "camel"),
    [
        ("read_speed_limit", "ReadSpeedLimit", "readSpeedLimit"),
        ("p2_x", "P2X", "p2X"),
        ("_a__b_", "AB", "aB"),
        ("", "", ""),
        ("motorRPM", "MotorRPM", "motorRPM"),
    ],
)
def test_cases(name, pascal, camel):
    assert (pascal, camel) == (pascal_case(name), camel_case(name))
