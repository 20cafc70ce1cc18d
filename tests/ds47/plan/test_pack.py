"""Packing into telegrams: limits of data set 47, order, and nobody does it in fewer."""

from __future__ import annotations

import itertools
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from plcgen.ds47.device import Parameter
from plcgen.ds47.kind import ReadItem
from plcgen.ds47.plan.access import Use
from plcgen.ds47.plan.pack import longest_response, negative_length, pack, positive_length, request_length
from plcgen.ds47.wire.formats import by_name


def use(type_: str, count: int = 1, position: int = 1) -> Use:
    fmt = by_name(type_)
    return Use(
        position,
        Parameter(position, type_),
        fmt,
        0 if count > 1 else None,
        count,
        count,
        bytes(count * fmt.size),
        False,
        f"m{position}",
        {},
        (),
        ReadItem(parameter=f"P{position}"),
    )


def counts(uses: list[Use], *, write: bool, limit: int = 240, most: int = 39) -> list[int]:
    packed = pack(uses, limit, most, write=write)
    assert packed is not None
    return [sum(part.count for part in parts) for parts in packed]


def test_thirty_nine_single_reads_fill_one_record() -> None:
    """39 parameters: request 4 + 39*6 = 238 bytes, one more makes a second telegram (DS47: n = 1..39)."""
    uses = [use("Integer16", 1, i) for i in range(1, 41)]
    (parts,) = pack(uses[:39], 240, 39, write=False) or []
    assert request_length(parts, write=False) == 238
    assert negative_length(parts) == 238
    assert counts(uses, write=False) == [39, 1]


@pytest.mark.parametrize(
    ("type_", "most"),
    [("FloatingPoint", 19), ("Unsigned32", 19), ("Unsigned16", 23), ("Unsigned8", 23), ("Float64", 14)],
)
def test_single_writes_per_record(type_: str, most: int) -> None:
    """Derived limits of DS47: 19 REAL/DWORD, 23 WORD/BYTE, 14 LREAL in one change request."""
    uses = [use(type_, 1, i) for i in range(1, 41)]
    assert counts(uses, write=True)[0] == most


@pytest.mark.parametrize(
    ("type_", "read", "write"),
    [("Unsigned8", 234, 228), ("Unsigned16", 117, 114), ("Unsigned32", 58, 57), ("FloatingPoint", 58, 57)],
)
def test_one_array_per_record(type_: str, read: int, write: int) -> None:
    """Derived limits of DS47: one array holds 234/117/58 elements when read, 228/114/57 when written."""
    assert counts([use(type_, 234)], write=False)[0] == read
    assert counts([use(type_, 234)], write=True)[0] == write


def test_elements_of_a_parameter_have_a_limit_of_their_own() -> None:
    """S120 and DCM manuals print 1..117: 234 bytes are two telegrams then; the elements of a string are its octets."""
    packed = pack([use("Unsigned8", 234)], 240, 39, 117, write=False)
    assert packed is not None
    assert [[part.count for part in parts] for parts in packed] == [[117], [117]]
    packed = pack([use("Unsigned8", 118), use("Unsigned8", position=2)], 240, 39, 117, write=False)
    assert packed is not None
    assert [[(part.use.position, part.count) for part in parts] for parts in packed] == [[(1, 117)], [(1, 1), (2, 1)]]
    for write in (False, True):
        assert pack([use("OctetString", 117)], 240, 39, 117, write=write) is not None
        assert pack([use("OctetString", 118)], 240, 39, 117, write=write) is None


def test_an_array_stays_whole_if_that_costs_nothing() -> None:
    """20 REALs then 50 REALs: two telegrams either way, so the second array is not torn apart."""
    packed = pack([use("FloatingPoint", 20, 1), use("FloatingPoint", 50, 2)], 240, 39, write=False)
    assert packed is not None
    assert [[(p.use.position, p.start, p.count) for p in parts] for parts in packed] == [[(1, 0, 20)], [(2, 0, 50)]]


def test_an_array_is_split_where_that_saves_a_telegram() -> None:
    """30 + 40 + 40 REALs = 440 bytes of values fit two records only if the middle array is split.

    After 30 REALs 240 - 4 - (2 + 120) = 114 bytes are free: 2 for the header, (114 - 2) / 4 = 28 REALs.
    """
    packed = pack([use("FloatingPoint", n, i) for i, n in enumerate((30, 40, 40), 1)], 240, 39, write=False)
    assert packed is not None
    assert len(packed) == 2
    assert [p.count for p in packed[0] if p.use.position == 2] == [28]


def test_a_value_longer_than_a_record_cannot_be_packed() -> None:
    """A string of 240 octets needs 246 bytes: a diagnostic, not a telegram."""
    long = use("OctetString", 1, 1)
    assert (
        pack(
            [replace(long, count=236, data=bytes(236))],
            240,
            39,
            write=False,
        )
        is None
    )


shapes = st.lists(
    st.tuples(st.sampled_from(["Unsigned8", "Integer16", "FloatingPoint"]), st.integers(1, 5)), min_size=1, max_size=4
)


def fewest(uses: list[Use], limit: int, most: int, *, write: bool) -> int:
    """Fewest telegrams by trying every way to cut the sequence of values (arrays may be cut anywhere)."""
    values = [(u, i) for u in uses for i in range(u.count)]

    def fits(chunk: list[tuple[Use, int]]) -> bool:
        groups = itertools.groupby(chunk, key=lambda v: (v[0].position, v[0].format.size))
        sizes = [len(list(group)) * size for (_, size), group in groups]
        even = [s + s % 2 for s in sizes]
        request = 4 + 6 * len(sizes) + (sum(2 + s for s in even) if write else 0)
        response = 4 + (6 * len(sizes) if write else sum(max(2 + s, 6) for s in even))
        return len(sizes) <= most and request <= limit and response <= limit

    best = [0] + [len(values) + 1] * len(values)
    for end in range(1, len(values) + 1):
        for start in range(end):
            if fits(values[start:end]):
                best[end] = min(best[end], best[start] + 1)
    return best[-1]


@given(shapes, st.sampled_from([22, 26, 30, 40]), st.integers(1, 4), st.booleans())
def test_nobody_needs_fewer_telegrams(shape: list[tuple[str, int]], limit: int, most: int, write: bool) -> None:
    """Every way to cut the values into telegrams is tried: none has fewer; order and limits hold."""
    uses = [use(type_, count, i) for i, (type_, count) in enumerate(shape, 1)]
    packed = pack(uses, limit, most, write=write)
    assert packed is not None
    assert len(packed) == fewest(uses, limit, most, write=write)
    flat = [(p.use.position, p.start + i) for parts in packed for p in parts for i in range(p.count)]
    assert flat == [(u.position, i) for u in uses for i in range(u.count)]
    for parts in packed:
        assert len(parts) <= most
        assert request_length(parts, write=write) <= limit
        assert positive_length(parts, write=write) <= longest_response(parts, write=write) <= limit
