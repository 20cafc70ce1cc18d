"""The client's API on a simulated station: values, packing, errors of single items, the CPU."""

import math

import pytest

from plcgen.base.diagnostics import DiagnosticError
from plcgen.ppi.client import RefusedError
from plcgen.ppi.symbols import parse_symbols
from plcgen.ppi.wire.model import ReadRequest, VariableFrame
from plcgen.ppi.wire.pdu import decode_pdu
from tests.ppi.client.support import connect


def requests(bus):
    """Return the PDUs of the requests on the bus."""
    return [
        decode_pdu(entry.frame.pdu)
        for entry in bus.journal
        if entry.direction == ">" and isinstance(entry.frame, VariableFrame)
    ]


def test_values_of_every_type():
    """Bits, bytes, words, double words, signed ones, reals, texts; memory is big-endian."""
    client, plc, _, _ = connect()
    for address, byte in enumerate(bytes.fromhex("FF FE 80 00 00 00 C0 20 00 00 03 61 62 63 00 00")):
        plc[f"VB{100 + address}"] = byte
    names = "VB100 VW100 VW100:INT VD102 VD102:DINT VD106:REAL VB110[6]:STRING VB111[3]:CHAR V101.0 V101.1 VB100[3]"
    readings = client.read(*names.split())
    assert [reading.value for reading in readings] == [
        255, 0xFFFE, -2, 0x80000000, -(2**31), -2.5, "abc", "abc", False, True, (255, 254, 128),
    ]  # fmt: skip
    assert readings[1].text == "65534"
    assert readings[5].text == "-2.5"
    assert readings[6].text == "'abc'"
    assert readings[9].text == "1"


def test_writing_every_type():
    """What is written is what the memory holds."""
    client, plc, _, _ = connect()
    written = client.write(
        {
            "VB0": 200, "VW2": 1234, "VW4:INT": -2, "VD6": 70000, "VD10:DINT": -1, "VD14:REAL": 1.5, "M0.3": True,
            "QB0": 0x5A, "VB20[6]:STRING": "abc", "VB30[5]:CHAR": "xy", "VW40[3]": (1, 2, 3), "AQW0": 100, "S0.1": 1,
        }
    )  # fmt: skip
    assert all(entry.ok for entry in written)
    memory = bytes(plc[f"VB{number}"] for number in range(46))
    assert memory[:18].hex() == "c80004d2fffe00011170ffffffff3fc00000"
    assert memory[20:26] == b"\x03abc\x00\x00"
    assert memory[30:35] == b"xy   "
    assert memory[40:46].hex() == "000100020003"
    assert (plc["M0.3"], plc["QB0"], plc["AQW0"], plc["S0.1"]) == (True, 0x5A, 100, True)


def test_timers_and_counters():
    """The value of a timer and a counter, without their status byte."""
    client, _, _, _ = connect(values={"T32": 70000, "C5": 300})
    assert [reading.value for reading in client.read("T32", "C5", "T0")] == [70000, 300, 0]


def test_a_hundred_values_in_few_telegrams():
    """100 words that lie together are one telegram; as single telegrams they would be 100."""
    client, plc, bus, _ = connect()
    plc["VW18"] = 99
    names = [f"VW{2 * number}" for number in range(100)]
    assert client.read(*names)[9].value == 99
    (request,) = requests(bus)
    assert isinstance(request, ReadRequest)
    assert [item.octets for item in request.items] == [200]


def test_one_bad_item_does_not_spoil_its_neighbours():
    """An item beyond the memory, read together with good ones, makes only itself fail."""
    client, _, _, _ = connect(values={"VB8190": 7, "VB8191": 8})
    readings = client.read("VB8190", "VB8191", "VB8192", "M0.0")
    assert [(reading.code, reading.value) for reading in readings] == [(255, 7), (255, 8), (5, None), (255, False)]
    assert readings[2].error == "05h address out of range"
    assert readings[2].text == readings[2].error
    first, second = client.write({"VB8191": 1, "VB9000": 1})
    assert (first.ok, second.ok, second.error) == (True, False, "05h address out of range")


def test_the_same_read_again_and_again():
    """Items that are asked for as they travel: values and errors stay at their places, reading after reading."""
    client, plc, _, _ = connect(values={"VB0": 1, "VW100": 2})
    for number in range(3):
        plc["VB0"] = number
        readings = client.read("VB0", "VW100", "VW9000", "M0.0")
        assert [(reading.code, reading.value) for reading in readings] == [(255, number), (255, 2), (5, None), (255, 0)]
        assert [reading.value for reading in client.read("VW100", "VB0")] == [2, number]


def test_a_smaller_pdu_counts_for_what_was_read_before():
    """222 bytes are one telegram at 240 bytes; at 112 the telegram carries 112 - 18 = 94 bytes, so there are three."""
    client, _, bus, _ = connect(pdu_limit=112)
    with pytest.raises(RefusedError):
        client.read("VB0[222]")
    client.negotiate(240)
    bus.journal.clear()
    assert len(client.read("VB0[222]")[0].value) == 222
    assert [request.items[0].octets for request in requests(bus)] == [94, 94, 34]


def test_references_differ():
    """Every job has a reference of its own, 1 to 65535, never 0."""
    client, _, bus, _ = connect()
    client._reference = 0xFFFE
    for _ in range(3):
        client.read("VB0")
    assert [request.reference for request in requests(bus)] == [0xFFFF, 1, 2]


def test_symbols():
    """Symbols of Micro/WIN's table, in any letter case, with a type where the address has none."""
    symbols = parse_symbols("Symbol,Address,Comment\nLevel,VD200,tank\nPump,Q0.1,\n")
    client, plc, _, _ = connect(values={"VD200": 0}, symbols=symbols)
    client.write({"level:REAL": 2.25, "PUMP": 1})
    assert plc["Q0.1"]
    (reading,) = client.read("Level:REAL")
    assert (reading.name, reading.place.address, reading.value) == ("Level:REAL", "VD200", 2.25)


def test_the_cpu():
    """CPU type, RUN, STOP, negotiation."""
    client, plc, _, _ = connect(cpu="226", type_="CPU 226         0201")
    info = client.info()
    assert (info.type, info.firmware, info.text) == ("CPU 226", "02.01", "CPU 226         0201")
    client.stop()
    assert plc.mode.name == "STOP"
    client.run()
    assert plc.mode.name == "RUN"
    assert client.negotiate().pdu_size == 240


def test_a_smaller_pdu_is_kept_to():
    """After a negotiation of 120 bytes no answer is longer; the values are the same."""
    client, plc, bus, _ = connect(pdu_limit=120)
    plc["VB150"] = 9
    assert client.negotiate().pdu_size == 120
    (reading,) = client.read("VB0[200]")
    assert reading.value[150] == 9
    assert max(len(entry.data) for entry in bus.journal) <= 120 + 9
    assert client.write({"VB0[200]": tuple(range(200))})[0].ok
    assert plc["VB199"] == 199


def test_run_refused_by_the_selector():
    """With the mode selector at STOP the CPU refuses: 8001h."""
    from plcgen.ppi.sim.station import Switch

    client, _, _, _ = connect(switch=Switch.STOP)
    with pytest.raises(RefusedError) as caught:
        client.run()
    assert caught.value.error == 0x8001


@pytest.mark.parametrize(
    ("values", "code"),
    [
        ({"VB0": 256}, "PG716"),
        ({"VB0": 1.5}, "PG716"),
        ({"VD0:REAL": 1e39}, "PG716"),
        ({"M0.0": 2}, "PG716"),
        ({"VW0[2]": (1,)}, "PG716"),
        ({"VB0": 1, "VW0": 2}, "PG716"),
        ({"VB0[2]:STRING": "abc"}, "PG716"),
        ({"VW0": "abc"}, "PG716"),
        ({"M0.9": 1}, "PG712"),
    ],
)
def test_nothing_is_sent_if_a_value_does_not_fit(values, code):
    """All values are checked before the first telegram."""
    client, _, bus, _ = connect()
    with pytest.raises(DiagnosticError) as caught:
        client.write({"MB5": 1, **values})
    assert {diagnostic.code for diagnostic in caught.value.diagnostics} == {code}
    assert not bus.journal


def test_a_timer_is_written():
    """No capture shows it, but the telegram is that of any other item; the station decides."""
    client, _, bus, _ = connect()
    (written,) = client.write({"T32": 5})
    assert written.place.name == "T32"
    assert len(requests(bus)) == 2  # behind the read that begins a session


def test_what_is_not_finite():
    """Infinity and NaN of a PLC's REAL are values as well."""
    client, plc, _, _ = connect()
    for number, byte in enumerate((0x7F, 0x80, 0, 0)):
        plc[f"VB{number}"] = byte
    (reading,) = client.read("VD0:REAL")
    assert reading.value == math.inf
    assert reading.text == "inf"


def test_reading_nothing():
    """No places, no telegram."""
    client, _, bus, _ = connect()
    assert client.read() == ()
    assert not bus.journal
