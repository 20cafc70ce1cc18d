"""The status words and states of a PPI master: one table for the templates and the manual page.

The 16#7000 words follow the custom of Siemens' system blocks; 16#8xxx are this product's own. Some of them mean
something else than those of the drive jobs, so both are explained.
"""

from __future__ import annotations

STATES: tuple[tuple[str, int, str], ...] = (
    ("STATE_IDLE", 0, "waiting for a job"),
    ("STATE_CONFIGURE", 1, "Port_Config sets baud rate and parity"),
    ("STATE_BUILD", 2, "completing the telegram"),
    ("STATE_RESET", 3, "Receive_Reset throws old frames away"),
    ("STATE_SEND", 4, "sending the request"),
    ("STATE_ACK", 5, "waiting for E5"),
    ("STATE_POLL", 6, "sending the poll"),
    ("STATE_REPLY", 7, "waiting for the reply"),
    ("STATE_WAIT", 8, "pause before a retry or the next poll"),
    ("STATE_DRAIN", 9, "ending: no report before the module has finished"),
    ("STATE_CONDITIONS", 10, "Receive_Config sets what begins and ends a message"),
)

STATUS_WORDS: tuple[tuple[str, int, str], ...] = (
    ("STATUS_DONE", 0x0000, "job done, no error"),
    ("STATUS_IDLE", 0x7000, "no job active"),
    ("STATUS_STARTED", 0x7001, "job started"),
    ("STATUS_RUNNING", 0x7002, "job running or waiting for the port"),
    ("STATUS_TIMEOUT", 0x8101, "not finished within its timeout"),
    ("STATUS_DRAIN_TIMEOUT", 0x8102, "a block of the module still active after DRAIN_LIMIT"),
    ("STATUS_PORT_OCCUPIED", 0x8104, "other jobs kept the port for the whole timeout"),
    ("STATUS_SEND_ERROR", 0x8201, "sending failed for good, see diagnostics.moduleStatus"),
    (
        "STATUS_CONFIG_ERROR",
        0x8202,
        "Port_Config, Receive_Config or Receive_Reset failed, see diagnostics.moduleStatus",
    ),
    ("STATUS_NO_ANSWER", 0x8203, "the station did not answer MAX_RETRIES repetitions"),
    ("STATUS_WRONG_DB", 0x8204, "the buffer DB has another number than the block expects"),
    ("STATUS_NOT_READY", 0x8205, "the station was not ready after MAX_POLLS polls"),
    ("STATUS_REPLY_FORMAT", 0x8301, "the reply has the wrong function, number of items or length"),
    ("STATUS_LINE_REFUSED", 0x8302, "the station refused the frame: no resource or service"),
    ("STATUS_ITEM_ERROR", 0x8401, "the station refused at least one address, see the errors of the job"),
    ("STATUS_REFUSED", 0x8402, "the station refused the whole job, see diagnostics.headerError"),
)
"""Name, value, meaning."""

ONLY_CLASSIC = frozenset({"STATUS_WRONG_DB"})
ONLY_NEW = frozenset({"STATUS_CONFIG_ERROR", "STATE_CONFIGURE", "STATE_CONDITIONS", "STATE_RESET"})
"""What the other targets do not have: a CP 341 is configured in the hardware."""

DRAIN_MS = 5000
"""DRAIN_LIMIT of every master in milliseconds."""

CLOCK_END = 864_000_000
"""Milliseconds after which the clock of an S7-1200/1500 master starts again: ten days."""

DIAGNOSTICS: tuple[tuple[str, str, str], ...] = (
    ("moduleStatus", "WORD", "STATUS of the last send, receive or configuration block that failed"),
    ("headerError", "WORD", "error class and code of the last reply that refused a whole job"),
    ("pduReference", "WORD", "reference of the last request"),
    ("state", "INT", "state of the block, see its STATE constants"),
    ("job", "INT", "number of the last job that used the port"),
    ("telegram", "INT", "number of its telegram"),
    ("retries", "INT", "repetitions of this telegram"),
    ("polls", "INT", "polls of this telegram"),
    ("failedItem", "INT", "first address of the job that the station refused, 0 = none"),
    ("ignoredFrames", "INT", "good frames that were not ours or too old"),
    ("damagedFrames", "INT", "frames with a wrong checksum, length or end, or broken off"),
    ("functionCode", "BYTE", "function code of the last frame sent"),
)
"""Members of the diagnostics structure: name, type, text."""
