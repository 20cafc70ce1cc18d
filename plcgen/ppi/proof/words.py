"""Status words, states and times of a PPI master, stated by hand after docs/ppi-master.md: nothing is imported from the
generator, so that a wrong word there shows here.
"""

from __future__ import annotations

from enum import IntEnum


class State(IntEnum):
    """States of the block, in the order of the drawing but for the last one."""

    IDLE = 0
    CONFIGURE = 1
    BUILD = 2
    RESET = 3
    SEND = 4
    ACK = 5
    POLL = 6
    REPLY = 7
    WAIT = 8
    DRAIN = 9
    CONDITIONS = 10


STATES_OF = {"CM": frozenset(State), "CP 341": frozenset(State) - {State.CONFIGURE, State.CONDITIONS, State.RESET}}
"""States by the kind of module: a CP 341 needs no settings, and nothing that it received is thrown away."""
WORDS = {
    "DONE": 0x0000, "IDLE": 0x7000, "STARTED": 0x7001, "RUNNING": 0x7002,
    "TIMEOUT": 0x8101, "DRAIN_TIMEOUT": 0x8102, "PORT_OCCUPIED": 0x8104,
    "SEND_ERROR": 0x8201, "CONFIG_ERROR": 0x8202, "NO_ANSWER": 0x8203, "WRONG_DB": 0x8204, "NOT_READY": 0x8205,
    "REPLY_FORMAT": 0x8301, "LINE_REFUSED": 0x8302, "ITEM_ERROR": 0x8401, "REFUSED": 0x8402,
}  # fmt: skip
"""Status words by name: ``WORDS["TIMEOUT"]``."""

LEAD = 1
"""Bytes of a table in front of its telegram: the length (docs/ppi-master.md)."""
DONE = WORDS["DONE"]
DRAIN_MS = 5000
"""DRAIN_LIMIT: that long a job may last beyond its timeout if the module hangs."""
GAP_BITS, LONGEST = 35, 512
"""A gap of so many bit times ends a message of a CM, or so many bytes."""
CLOCK_END = 864_000_000
"""Time in ms after which the clock of a master on S7-1200/1500 starts again: ten days."""
CP_RESET_CALLS = 4
"""Calls that a RESET of P_SND_RK takes at least (manual of the CP 341, A5E02191071-01, table 6-15)."""
