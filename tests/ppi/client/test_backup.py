"""Backup, compare and restore of memory: the file, the CPU type, what is said when a restore stops half way."""

import pytest

from plcgen.base.diagnostics import DiagnosticError, Severity
from plcgen.ppi.backup import back_up, compare, load_backup, other_cpu, restore
from plcgen.ppi.wire.address import parse_item
from plcgen.ppi.wire.model import WriteRequest
from tests.ppi.client.support import connect
from tests.ppi.client.test_client import requests

TIME = "2026-11-27T10:00:00.000+01:00"


def quiet(*_):
    """Show no progress."""


def taken(*addresses, **station):
    """A backup of a station and its client."""
    client, plc, bus, _ = connect(**station)
    return back_up(client, [parse_item(each) for each in addresses], TIME, quiet), client, plc, bus


def test_the_file_comes_back_as_it_was(tmp_path):
    """10240 bytes of a CPU 226, the pattern n mod 251, in a file and out of it; 320 lines of 32 bytes."""
    client, plc, _, _ = connect(cpu="226")
    for number in range(10240):
        plc.cpu.memory._bytes[0x84][number] = number % 251
    found = back_up(client, [parse_item("VB0[10240]")], TIME, quiet)
    assert found.pieces[0].data == bytes(number % 251 for number in range(10240))
    assert (found.station, found.cpu, found.firmware, found.time) == (2, "CPU 226", "02.01", TIME)
    path = tmp_path / "a.backup"
    path.write_text(found.text(), encoding="utf-8")
    assert load_backup(path) == found
    assert sum(line.startswith('      - "') for line in found.text().splitlines()) == 320


def test_compare_names_the_bytes():
    """VB3..VB4 and VB9 were changed: two places with what was and what is."""
    stored, client, plc, _ = taken("VB0[10]")
    plc["VW3"], plc["VB9"] = 0x0102, 7
    found = compare(client, stored, quiet)
    assert [(each.backup.address, each.backup.data.hex(), each.now.hex()) for each in found] == [
        ("VB3[2]", "0000", "0102"), ("VB9", "00", "07"),
    ]  # fmt: skip


def test_restore_writes_telegram_by_telegram_and_reads_back():
    """1000 bytes need 5 telegrams of at most 212; afterwards nothing differs."""
    stored, client, plc, bus = taken("VB0[1000]", "MB0[4]", values={"VB999": 5, "MB3": 9})
    plc["VB999"], plc["MB3"] = 0, 0
    assert restore(client, stored, quiet) == ()
    assert (plc["VB999"], plc["MB3"]) == (5, 9)
    writes = [pdu.items[0].item.count for pdu in requests(bus) if isinstance(pdu, WriteRequest)]
    assert writes == [212, 212, 212, 212, 152, 4]


def test_what_the_program_overwrites_is_told():
    """A byte that the CPU keeps at 1 (its program does) differs after the restore."""
    stored, client, plc, _ = taken("VB0[4]")
    plc.cpu.memory.forced[parse_item("VB2")] = b"\x01"
    assert [each.backup.address for each in restore(client, stored, quiet)] == ["VB2"]


def test_another_cpu_is_refused():
    """A backup of a CPU 226 is not written into a CPU 224: PG726, no write was sent; compare only warns."""
    stored, *_ = taken("VB0[10]", cpu="226")
    client, _, bus, _ = connect(cpu="224")
    with pytest.raises(DiagnosticError) as caught:
        restore(client, stored, quiet)
    assert caught.value.diagnostics[0].code == "PG726"
    assert not any(isinstance(pdu, WriteRequest) for pdu in requests(bus))
    (warning,) = other_cpu(client.info(), stored, "bus", Severity.WARNING)
    assert "CPU 226, the station is a CPU 224" in warning.message


def test_a_refused_item_ends_the_restore():
    """The third telegram is refused: the two before it are written, which the note says, none comes after it."""
    stored, client, plc, bus = taken("MB0[2]", "VB0[1000]", values={"VB999": 5, "VB211": 6})
    plc["VB999"], plc["VB211"] = 0, 0
    plc.cpu.memory.write, write = None, plc.cpu.memory.write
    plc.cpu.memory.write = lambda item, data: 3 if item.byte == 212 else write(item, data)
    with pytest.raises(DiagnosticError) as caught:
        restore(client, stored, quiet)
    (found,) = caught.value.diagnostics
    assert (found.code, found.message) == ("PG719", "VB212[212]: 03h, access denied")
    assert found.notes[0].message == "restoring stopped at VB212[212]; written already: MB0[2], VB0[212]"
    assert (plc["VB211"], plc["VB999"]) == (6, 0)
    assert len([pdu for pdu in requests(bus) if isinstance(pdu, WriteRequest)]) == 3


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ("VB0[10]", "VB0[11]", "PG107"), ("VB0[10]", "VW0[5]", "PG107"), ("VB0[10]", "T5", "PG107"),
        ("VB0[10]", "hello", "PG711"), ("VB0[10]", "SYS", "PG107"), ("00 00", "00 0G", "PG107"),
        ("station: 2", "station: 127", "PG107"), ("memory:", "memories:", "PG104"),
        ("VB0[10]", "VB9999999[10]", "PG713"),
    ],
)  # fmt: skip
def test_a_wrong_file_is_told(tmp_path, old, new, code):
    """Whatever is wrong in it has a place and a code."""
    stored, *_ = taken("VB0[10]")
    path = tmp_path / "a.backup"
    path.write_text(stored.text().replace(old, new, 1), encoding="utf-8")
    with pytest.raises(DiagnosticError) as caught:
        load_backup(path)
    assert code in {each.code for each in caught.value.diagnostics}
    assert all(each.span.line for each in caught.value.diagnostics)


def test_hostile_text_of_a_station_stays_in_its_line():
    """A station that calls itself quotes and line breaks does not write other keys into the file."""
    client, *_ = connect(type_='a"\nmemory: []\n')
    lines = back_up(client, [parse_item("VB0[2]")], TIME, quiet).text().splitlines()
    assert sum(line.startswith("memory:") for line in lines) == 1
