"""A simulated drive made of whole lists: what is known to be absent is answered with error 00h."""

from __future__ import annotations

import pytest

from plcgen.ds47.devices import find_device
from plcgen.ds47.sim.listed import listed_drive

ILLEGAL_NUMBER = 0x00
"""Error number of PROFIdrive: there is no such parameter."""


@pytest.mark.parametrize(
    ("key", "object_type", "absent", "there"),
    [("sinamics-s210", "", 3981, 21), ("sinamics-g220", "", 971, 21), ("sinamics-s120", "control_unit", 1120, 977)],
)
def test_a_number_that_the_list_lacks_is_refused(key: str, object_type: str, absent: int, there: int) -> None:
    """S210 has no p3981, G220 no p0971, a control unit of S120 no p1120, by their lists in the TIA Portal help."""
    device = find_device(key)
    number = device.drive_object if not object_type else 1
    drive = listed_drive(device, number, object_type)
    for pnu, good in ((absent, False), (there, True)):
        assert drive.write_record(0xB02F, bytes((1, 1, number, 1, 0x10, 1)) + pnu.to_bytes(2) + bytes(2)) == 0
        status, answer = drive.read_record(0xB02F, 240)
        assert status == 0
        assert answer[1] == (0x01 if good else 0x81)
        assert good or answer[4:8] == bytes((0x44, answer[5], 0, ILLEGAL_NUMBER))
