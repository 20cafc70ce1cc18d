"""Error numbers against the table of another program: the PROFINET dissector of Wireshark 4.0 (``tshark -G values``).

Field ``pn_io.profidrive.parameter.error_num``; its words are not ours, so each number has the word that both must
have. 15h is left out, which the dissector calls a timeout and manuals a response that is too long.
"""

from __future__ import annotations

import pytest

from plcgen.ds47.wire.errors import error_text

WIRESHARK = {
    0x00: "parameter number",  # Disallowed parameter number
    0x01: "cannot be changed",  # The parameter value cannot be changed
    0x02: "limit",  # Exceed the upper or lower limit
    0x03: "subindex",  # Sub-index error
    0x04: "no array",  # Non-array
    0x05: "data type",  # Incorrect data type
    0x06: "reset",  # Setting is not allowed (can only be reset)
    0x07: "description",  # The description element cannot be modified
    0x09: "description",  # Descriptive data does not exist
    0x0B: "priority",  # No operation priority
    0x0F: "text",  # The text array does not save right
    0x11: "state",  # The request cannot be executed because of the working status
    0x14: "value",  # Value is not allowed
    0x16: "address",  # Illegal parameter address
    0x17: "format",  # Illegal parameter format
    0x18: "number of values",  # The number of values is inconsistent
    0x19: "axis",  # Axis/DO does not exist
    0x20: "text",  # The parameter text element cannot be changed
    0x21: "service",  # No support service
    0x22: "too many",  # Too many parameter requests
    0x23: "multi",  # Only support single parameter access
}


@pytest.mark.parametrize("number", WIRESHARK, ids=lambda number: f"{number:02X}h")
def test_an_error_number_means_what_others_print(number: int) -> None:
    """The word of the dissector is in the meaning."""
    assert WIRESHARK[number] in error_text(number).meaning.lower()
