"""Packing: few telegrams, and every value back at its place."""

from itertools import combinations, pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcgen.ppi.wire.address import address_text, parse_item
from plcgen.ppi.wire.areas import Area, ReturnCode, TransportSize
from plcgen.ppi.wire.errors import PpiError
from plcgen.ppi.wire.model import Item, ItemResult, ItemWrite, ReadReply, WriteReply
from plcgen.ppi.wire.pack import READING, WRITING, PackingRules, pack_read, pack_write
from plcgen.ppi.wire.pdu import decode_pdu, encode_pdu


def items(text):
    """Return the items of a list of addresses."""
    return [parse_item(word) for word in text.split()]


def spelled(plan):
    """Return the telegrams of a read plan as addresses."""
    return [[address_text(planned.item) for planned in telegram] for telegram in plan.telegrams]


@pytest.mark.parametrize(
    ("asked", "telegrams"),
    [
        ("VB100", [["VB100"]]),
        ("M0.0", [["M0.0"]]),
        ("VW100 VW102", [["VB100[4]"]]),
        ("VB100[20] VW104 V100.3", [["VB100[20]"]]),
        ("M0.0 M0.7", [["MB0"]]),
        ("M0.0 M0.0", [["M0.0"]]),
        ("VW100 VW100", [["VW100"]]),
        ("VB0 VB2", [["VB0[3]"]]),
        ("T32 T33 C5", [["T32", "T33", "C5"]]),
        ("AIW0 AIW2", [["AIW0[2]"]]),
        ("VB0 MB0 QB0", [["VB0", "MB0", "QB0"]]),
        ("VB0 VB1000", [["VB0", "VB1000"]]),
        ("VB0[222]", [["VB0[222]"]]),
        ("VB0[223]", [["VB0[222]" ], ["VB222"]]),
        ("VW0[112]", [["VW0[111]"], ["VW222"]]),
        ("VB0[500] VB1000[140]", [["VB0[222]"], ["VB222[222]"], ["VB444[56]", "VB1000[140]"]]),
    ],
)  # fmt: skip
def test_plans(asked, telegrams):
    """What is read for what is asked: neighbours together, elements alone, long ones cut between elements."""
    assert spelled(pack_read(items(asked))) == telegrams


def test_nineteen_items_and_one_more():
    """19 items far apart are one telegram (10 + 2 + 12 * 19 = 240 bytes), 20 are two; a gap can be worth reading."""
    apart = [Item.memory(Area.V, 250 * number) for number in range(20)]
    assert len(pack_read(apart[:19]).telegrams) == 1
    assert len(pack_read(apart).telegrams) == 2
    nearer = [Item.memory(Area.V, 6 * number) for number in range(20)]
    assert len(pack_read(nearer).telegrams) == 1
    assert len(pack_read(nearer, merge=False).telegrams) == 2


def test_writes():
    """Contiguous values become one item, a gap is never written, and 212 bytes are the most of one item."""
    plan = pack_write([ItemWrite(item, bytes(item.octets)) for item in items("VW100 VB102 VB104 M0.0 M0.1")])
    assert [[address_text(entry.item) for entry in telegram] for telegram in plan.telegrams] == [
        ["VB100[3]", "VB104", "M0.0", "M0.1"]
    ]
    (long,) = items("VB0[213]")
    plan = pack_write([ItemWrite(long, bytes(range(213)))])
    assert [[address_text(entry.item) for entry in telegram] for telegram in plan.telegrams] == [
        ["VB0[212]"], ["VB212"]
    ]  # fmt: skip
    assert plan.telegrams[1][0].data == bytes([212])


@pytest.mark.parametrize("text", ["VB0 VW0", "M0.0 MB0", "M0.3 M0.3", "VB0[20] VD18", "T1 T1"])
def test_nothing_is_written_twice(text):
    """Which value would stay is not defined."""
    with pytest.raises(PpiError, match="written twice"):
        pack_write([ItemWrite(item, bytes(item.octets)) for item in items(text)])


# ---- Minimality, against all distributions and all ways of joining -------------------------------------------


def shortest(spans, rules):
    """Return the shortest PDU for spans (area, start, end) in one telegram, or None: every way of joining is tried."""
    spans = sorted(set(spans))
    best = None
    for cuts in range(len(spans)):
        for places in combinations(range(1, len(spans)), cuts):
            edges = [0, *places, len(spans)]
            groups = [spans[a:b] for a, b in pairwise(edges)]
            if any(len({area for area, _, _ in group}) > 1 for group in groups) or len(groups) > rules.most:
                continue
            if rules is WRITING:
                touching = all(right[1] <= left[2] for group in groups for left, right in pairwise(group))
                if not touching:
                    continue
            sizes = [max(end for _, _, end in group) - group[0][1] for group in groups]
            odd = sum(size % 2 for size in sizes)
            length = rules.header + sum(rules.item + size for size in sizes) + max(odd - 1, 0)
            best = length if best is None else min(best, length)
    return best if best is not None and best <= rules.limit else None


def partitions(values):
    """Every way to distribute values over groups."""
    if not values:
        yield []
        return
    head, *tail = values
    for groups in partitions(tail):
        yield [[head], *groups]
        for index, group in enumerate(groups):
            yield [*groups[:index], [head, *group], *groups[index + 1 :]]


def fewest(spans, rules):
    """Return the least number of telegrams by trying everything."""
    return min(
        len(groups) for groups in partitions(spans) if all(shortest(group, rules) is not None for group in groups)
    )


def spans_of(asked):
    return [(item.area, item.byte, item.byte + item.octets) for item in asked]


lengths = st.sampled_from([1, 2, 3, 50, 73, 75, 100, 109, 110, 111, 112, 113, 150, 217, 218, 222])
blocks = st.builds(
    Item.memory,
    st.sampled_from([Area.V, Area.M]),
    st.integers(0, 40).map(lambda number: 5 * number) | st.integers(0, 700),
    lengths,
)


@pytest.mark.slow
@settings(max_examples=150)
@given(st.lists(blocks, min_size=1, max_size=6))
def test_hardly_a_distribution_reads_with_fewer_telegrams(asked):
    """Brute force over all distributions and all ways of joining: 2 of 1,500 random sets needed one more."""
    best = fewest(spans_of(asked), READING)
    assert best <= len(pack_read(asked).telegrams) <= best + 1


@settings(max_examples=80)
@given(st.lists(blocks, min_size=1, max_size=6))
def test_few_items_a_telegram(asked):
    """The same where the number of items is what limits."""
    rules = PackingRules(READING.header, READING.item, READING.gaps, most=2)
    best = fewest(spans_of(asked), rules)
    assert best <= len(pack_read(asked, rules=rules).telegrams) <= best + 1


@st.composite
def writes(draw):
    """Draw blocks that do not overlap, some of them touching."""
    at, found = 0, []
    for length in draw(
        st.lists(st.sampled_from([1, 2, 49, 50, 70, 98, 99, 106, 107, 150, 212]), min_size=1, max_size=6)
    ):
        at += draw(st.sampled_from([0, 0, 1, 30]))
        found.append(Item.memory(Area.V, at, length))
        at += length
    return draw(st.permutations(found))


@pytest.mark.slow
@settings(max_examples=100)
@given(writes())
def test_hardly_a_distribution_writes_with_fewer_telegrams(asked):
    """Brute force for writes: only touching blocks are joined, which costs one telegram at most."""
    plan = pack_write([ItemWrite(item, bytes(item.octets)) for item in asked])
    best = fewest(spans_of(asked), WRITING)
    assert best <= len(plan.telegrams) <= best + 1


def test_touching_blocks_are_joined_even_if_that_costs_a_telegram():
    """49, 49, 1, 49, 106 and 107 bytes in a row: bytes 49..254 beside 0..49 and 254..361 would be 2 telegrams."""
    blocks = [(0, 49), (49, 49), (98, 1), (99, 49), (148, 106), (254, 107)]
    asked = [Item.memory(Area.V, start, count) for start, count in blocks]
    assert fewest(spans_of(asked), WRITING) == 2
    assert len(pack_write([ItemWrite(item, bytes(item.octets)) for item in asked]).telegrams) == 3


# ---- Values come back -----------------------------------------------------------------------------------------

MEMORY = {area: bytes((7 * area + 13 * n + (n >> 5)) & 0xFF for n in range(2000)) for area in Area}


def stored(item):
    """Value of an item in MEMORY; of elements, bytes made of the number."""
    if item.by_element:
        return bytes((item.area + item.address + n) & 0xFF for n in range(item.octets))
    if item.size == TransportSize.BIT:
        return bytes([MEMORY[item.area][item.byte] >> item.bit_number & 1])
    return MEMORY[item.area][item.byte : item.byte + item.octets]


bits = st.builds(Item.bit, st.sampled_from([Area.V, Area.M]), st.integers(0, 60), st.integers(0, 7))
words = st.builds(
    Item.memory,
    st.sampled_from([Area.V, Area.M, Area.Q]),
    st.integers(0, 400),
    st.integers(1, 30),
    st.sampled_from([TransportSize.BYTE, TransportSize.WORD, TransportSize.DWORD, TransportSize.REAL]),
)
long = st.builds(
    Item.memory, st.just(Area.V), st.integers(0, 400), st.integers(100, 400), st.sampled_from([TransportSize.WORD])
)
elements = st.builds(Item.element, st.sampled_from([Area.T, Area.C]), st.integers(0, 255))
analog = st.builds(
    lambda number, count: Item.memory(Area.AI, 2 * number, count, TransportSize.WORD),
    st.integers(0, 30),
    st.integers(1, 4),
)


@pytest.mark.slow
@settings(max_examples=200)
@given(st.lists(bits | words | long | elements | analog, min_size=1, max_size=30), st.booleans())
def test_every_value_comes_back(asked, merge):
    """Whatever is joined or cut: each asked item gets its own bytes, and every telegram keeps the limits."""
    plan = pack_read(asked, merge=merge)
    replies = []
    for request in plan.requests(7):
        assert decode_pdu(encode_pdu(request)) == request
        reply = ReadReply(request.reference, tuple(ItemResult.of(item, stored(item)) for item in request.items))
        replies.append(decode_pdu(encode_pdu(reply)))
    assert plan.collect(replies) == tuple(ItemResult.of(item, stored(item)) for item in asked)


@pytest.mark.slow
@settings(max_examples=150)
@given(st.lists(bits | words | long | analog, min_size=1, max_size=20), st.data())
def test_every_byte_is_written_once(asked, data):
    """After the telegrams the memory holds each value, and nothing else was touched."""
    apart = []
    for item in asked:
        try:
            pack_write([ItemWrite(entry, bytes(entry.octets)) for entry in [*apart, item]])
        except PpiError:
            continue
        apart.append(item)
    entries = [
        ItemWrite(item, bytes([data.draw(st.integers(0, 1))]) if item.size == 1 else bytes(
            (n * 3 + item.address) & 0xFF for n in range(item.octets)))
        for item in apart
    ]  # fmt: skip
    plan = pack_write(entries)
    memory: dict[tuple[int, int], int] = {}
    for request in plan.requests():
        assert decode_pdu(encode_pdu(request)) == request
        for entry in request.items:
            apply(memory, entry)
    wanted: dict[tuple[int, int], int] = {}
    for entry in entries:
        apply(wanted, entry)
    assert memory == wanted


def apply(memory, entry):
    """Write into a memory of bits; a bit that is written twice is a mistake."""
    item = entry.item
    for n in range(1 if item.size == TransportSize.BIT else 8 * item.octets):
        key = (item.area, item.address + n)
        assert key not in memory
        memory[key] = entry.data[0] & 1 if item.size == TransportSize.BIT else entry.data[n >> 3] >> (n & 7) & 1


def test_a_failed_part_fails_its_items_only():
    """The return code of a telegram's item is that of the asked items it serves."""
    plan = pack_read(items("VB0 VB1 MB0 VB900"))
    assert spelled(plan) == [["VB0[2]", "MB0", "VB900"]]
    reply = ReadReply(0, (ItemResult(5), ItemResult.of(items("MB0")[0], b"\x11"), ItemResult(0x0A)))
    assert [result.code for result in plan.collect([reply])] == [5, 5, ReturnCode.OK, 0x0A]


def test_a_wrong_answer_is_refused():
    """Another number of results or another length is no answer to this plan."""
    plan = pack_read(items("VW0 MB0"))
    good = ItemResult.of(items("MB0")[0], b"\x11")
    with pytest.raises(PpiError, match="1 items are answered, 2 were asked for"):
        plan.collect([ReadReply(0, (good,))])
    with pytest.raises(PpiError, match="VW0 has 1 bytes instead of 2"):
        plan.collect([ReadReply(0, (good, good))])
    written = pack_write([ItemWrite(items("MB0")[0], b"\x01")])
    with pytest.raises(PpiError, match="2 items are answered"):
        written.collect([WriteReply(0, (255, 255))])


def test_a_high_speed_counter_may_lack_its_status():
    """Four or five bytes are an answer, three are none."""
    plan = pack_read(items("HC0"))
    for data in (bytes(4), bytes(5)):
        assert plan.collect([ReadReply(0, (ItemResult(0xFF, data, 9),))])[0].data == data
    with pytest.raises(PpiError, match="HC0 has 3 bytes instead of 5"):
        plan.collect([ReadReply(0, (ItemResult(0xFF, bytes(3), 9),))])
