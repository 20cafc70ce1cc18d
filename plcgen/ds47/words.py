"""Status words, states and sizes of the drive blocks: one table for the templates, the manual pages and ``explain``.

The 16#7000 words follow the custom of Siemens' system blocks; 16#8xxx are this product's own.
"""

from __future__ import annotations

from typing import NamedTuple

CHANNEL_STATES: tuple[tuple[str, int, str], ...] = (
    ("STATE_IDLE", 0, "no job holds the unit"),
    ("STATE_HOLD", 1, "a job holds the unit: waiting for its next telegram, or until it goes"),
    ("STATE_BUILD", 2, "completing the request, within one call"),
    ("STATE_GATE", 3, "waiting for a place among the record jobs of the CPU"),
    ("STATE_WRITE", 4, "WRREC sends the request"),
    ("STATE_READ", 5, "RDREC fetches the answer"),
    ("STATE_PAUSE", 6, "pause before a retry"),
    ("STATE_DRAIN", 7, "ending: nothing is reported while a record call is active"),
)

STATUS_WORDS: tuple[tuple[str, int, str], ...] = (
    ("STATUS_DONE", 0x0000, "job done, no error"),
    ("STATUS_IDLE", 0x7000, "no job active"),
    ("STATUS_STARTED", 0x7001, "job started"),
    ("STATUS_RUNNING", 0x7002, "job running, or waiting for its turn"),
    ("STATUS_TIMEOUT", 0x8101, "not finished within TIMEOUT, the timeout of the job"),
    ("STATUS_DRAIN_TIMEOUT", 0x8102, "a record call still active after DRAIN_LIMIT"),
    ("STATUS_STILL_DRAINING", 0x8103, "refused: a record call of an earlier job is still active"),
    ("STATUS_OCCUPIED", 0x8104, "other jobs kept the unit for longer than the wait limit"),
    ("STATUS_LOST", 0x8105, "not called for LEASE, or channel loaded again: what the drive did is unknown"),
    ("STATUS_NOT_CALLED", 0x8106, "the channel of the unit is not called"),
    ("STATUS_NO_PLACE", 0x8107, "no place for a record job within the timeout of the job"),
    ("STATUS_NO_SLOT", 0x8108, "the unit has no such slot"),
    ("STATUS_SLOT_TAKEN", 0x8109, "another instance uses the slot, or the unit was loaded again"),
    ("STATUS_WRITE_ERROR", 0x8201, "WRREC failed for good, see recordStatus of the unit"),
    ("STATUS_READ_ERROR", 0x8202, "RDREC failed for good, see recordStatus of the unit"),
    ("STATUS_RETRIES", 0x8203, "still not successful after all retries"),
    ("STATUS_WRONG_DB", 0x8204, "the record does not lie where its number says"),
    ("STATUS_UNKNOWN", 0x8205, "the request was lost; it starts something and is not sent again: look at the drive"),
    ("STATUS_RESPONSE_LENGTH", 0x8301, "answer shorter than its header"),
    ("STATUS_RESPONSE_ID", 0x8302, "response id does not belong to the request"),
    ("STATUS_DRIVE_OBJECT", 0x8303, "answers come from another drive object"),
    ("STATUS_PARAMETER_COUNT", 0x8304, "answer has another number of parameters"),
    ("STATUS_RESPONSE_FORMAT", 0x8305, "a value has another type or number, see errors, or the answer another length"),
    ("STATUS_PARAMETER_ERROR", 0x8401, "the drive refused at least one parameter, see errors"),
    ("STATUS_REFUSED", 0x8402, "the drive refused the whole request, see errors"),
    ("STATUS_NOT_SUPPORTED", 0x8403, "the drive does not support the request"),
    ("STATUS_NOT_SAVED", 0x8501, "the drive has not finished saving within the limit of the job"),
    ("STATUS_TOO_SOON", 0x8502, "refused: the last save is not as long ago as the job demands"),
    ("STATUS_DEVIATES", 0x8503, "read back, a value is not the one that was written, see errors"),
    ("STATUS_CHANGED", 0x8504, "the buffer of the drive changed while it was read, in every try"),
    ("STATUS_NOT_ACKNOWLEDGED", 0x8505, "the drive has not finished acknowledging within the limit of the job"),
    ("STATUS_FAULTS_REMAIN", 0x8506, "acknowledged, but faults remain, see faultCodes"),
    ("STATUS_NOT_REACHED", 0x8510, "what a step waits for did not happen within its timeout, see failedStep"),
    ("STATUS_NO_TIME", 0x8520, "refused: utc is no time between 2000 and 2089"),
    ("STATUS_RESTORED", 0x8530, "failed, see cause; the drive has the old values again"),
    ("STATUS_NOT_RESTORED", 0x8531, "failed, see cause, and so did restoring: look at errors and at the drive"),
    ("STATUS_RUNS", 0x8532, "failed, see cause; not restored, as the drive runs: what was written stays"),
    ("STATUS_LEFT", 0x8533, "failed, see cause; restored but for values that somebody else has changed, see errors"),
    ("STATUS_NO_RECORD", 0x8540, "refused: the recipe has no record with this number"),
    ("STATUS_OUTSIDE", 0x8541, "refused: a value of the record is outside its limits, see failedParameter"),
    ("STATUS_NO_REQUEST", 0x8550, "refused: number, index, count or axis is out of range"),
    ("STATUS_NOT_ENABLED", 0x8551, "refused: a write, and enableWrite is FALSE"),
    ("STATUS_NOT_PERMITTED", 0x8552, "refused: the number may not be written, or axis is another drive object"),
    ("STATUS_NOT_WRITABLE", 0x8553, "refused: values of the type writeFormat are not written"),
    ("STATUS_NO_VALUE", 0x8554, "refused: the value does not fit the type, or is no number"),
)

_TICKET = {"DONE", "IDLE", "STARTED", "RUNNING", "OCCUPIED", "LOST", "NOT_CALLED", "NO_SLOT", "SLOT_TAKEN"}
TICKET_WORDS = tuple(row for row in STATUS_WORDS if row[0].removeprefix("STATUS_") in _TICKET)
"""What a ticket reports of itself."""
SAVE_WORDS = tuple(row for row in STATUS_WORDS if row[1] in {0x8501, 0x8502})
"""What only a job that saves reports."""
ACKNOWLEDGE_WORDS = tuple(row for row in STATUS_WORDS if row[1] in {0x8505, 0x8506})
"""What only a job that acknowledges reports."""
VERIFY_WORDS = tuple(row for row in STATUS_WORDS if row[1] == 0x8503)
"""What only a job that reads back reports."""
MESSAGE_WORDS = tuple(row for row in STATUS_WORDS if row[1] == 0x8504)
"""What only a job that reads a buffer of messages reports."""
SEQUENCE_WORDS = tuple(row for row in STATUS_WORDS if row[1] == 0x8510)
"""What only a sequence reports."""
CLOCK_WORDS = tuple(row for row in STATUS_WORDS if row[1] == 0x8520)
"""What only a job that sets a clock reports."""
RESTORE_WORDS = tuple(row for row in STATUS_WORDS if row[1] in range(0x8530, 0x8534))
"""What only a job that restores reports."""
RECIPE_WORDS = tuple(row for row in STATUS_WORDS if row[1] in {0x8540, 0x8541})
"""What only a job with a recipe reports: the second one if it writes."""
SERVICE_WORDS = tuple(row for row in STATUS_WORDS if row[1] in range(0x8550, 0x8555))
"""What only a service job reports: but for the first one only if it writes."""
ERROR_DEVIATES = 0x8200
"""In ``errors``: another value was read back than was written."""
CHANNEL_WORDS = tuple(
    row
    for row in STATUS_WORDS
    if row[0] in {"STATUS_DONE", "STATUS_LOST"} or (row not in TICKET_WORDS and row[1] >> 8 != 0x85)
)
"""What a channel reports."""

DRAIN_MS = 5000
"""DRAIN_LIMIT of the channel in milliseconds."""

LEASE_MS = 3000
"""LEASE in milliseconds: who gives no sign of life for so long has lost what it holds."""


class Variant(NamedTuple):
    """A size of the engine: bytes of a record, parameters of a telegram, places of a unit, channels of a CPU."""

    name: str
    bytes: int
    parameters: int
    slots: int
    channels: int


VARIANTS = (
    Variant("S", 40, 4, 4, 32),
    Variant("M", 96, 15, 8, 32),
    Variant("L", 240, 39, 16, 128),
    Variant("XL", 240, 39, 64, 512),
)
"""The sizes in which the engine is made, the smallest first. 240 bytes are the longest record of data set 47, and
4 + 39 x 6 the longest list of addresses in it."""

RECORD_JOBS = {"s7-300": 4, "s7-400": 8, "s7-1200": 4, "s7-1500": 10}
"""Record jobs of WRREC and RDREC at once that every CPU of a family has room for (Siemens entry 15364459)."""
