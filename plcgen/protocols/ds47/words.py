"""The status words and states of a job block: one table for the templates, the manual pages and ``explain``.

The 16#7000 words follow the custom of Siemens' system blocks; 16#8xxx are this product's own.
"""

from __future__ import annotations

STATES: tuple[tuple[str, int, str], ...] = (
    ("STATE_IDLE", 0, "waiting for execute"),
    ("STATE_ACQUIRE", 1, "waiting until no other job uses the drive"),
    ("STATE_BUILD", 2, "completing the request"),
    ("STATE_WRITE", 3, "WRREC sends the request"),
    ("STATE_READ", 4, "RDREC fetches the response"),
    ("STATE_CHECK", 5, "checking the response"),
    ("STATE_WAIT", 6, "pause before a retry"),
    ("STATE_DRAIN", 7, "ending: no report before the record calls have ended"),
)

STATUS_WORDS: tuple[tuple[str, int, str], ...] = (
    ("STATUS_DONE", 0x0000, "job done, no error"),
    ("STATUS_IDLE", 0x7000, "no job active"),
    ("STATUS_STARTED", 0x7001, "job started"),
    ("STATUS_RUNNING", 0x7002, "job running"),
    ("STATUS_TIMEOUT", 0x8101, "not finished within TIMEOUT"),
    ("STATUS_DRAIN_TIMEOUT", 0x8102, "a record call still active after DRAIN_LIMIT"),
    ("STATUS_STILL_DRAINING", 0x8103, "start refused: a record call of an earlier job is still active"),
    ("STATUS_DRIVE_OCCUPIED", 0x8104, "another job kept the drive for the whole TIMEOUT"),
    ("STATUS_DRIVE_LOST", 0x8105, "another job took the drive over: this block was not called for LEASE"),
    ("STATUS_WRITE_ERROR", 0x8201, "WRREC failed for good, see diagnostics.recordStatus"),
    ("STATUS_READ_ERROR", 0x8202, "RDREC failed for good, see diagnostics.recordStatus"),
    ("STATUS_RETRIES", 0x8203, "still not successful after MAX_RETRIES"),
    ("STATUS_WRONG_DB", 0x8204, "a buffer DB has another number than the block expects"),
    ("STATUS_RESPONSE_LENGTH", 0x8301, "response shorter than its header"),
    ("STATUS_RESPONSE_ID", 0x8302, "response id does not belong to the request"),
    ("STATUS_DRIVE_OBJECT", 0x8303, "response comes from another drive object"),
    ("STATUS_PARAMETER_COUNT", 0x8304, "response has another number of parameters"),
    ("STATUS_RESPONSE_FORMAT", 0x8305, "a value block has the wrong format, number of values or length"),
    ("STATUS_PARAMETER_ERROR", 0x8401, "the drive refused at least one parameter, see errors"),
    ("STATUS_REFUSED", 0x8402, "the drive refused the whole request, see errors"),
    ("STATUS_NOT_SUPPORTED", 0x8403, "the drive does not support the request"),
)

DRAIN_MS = 5000
"""DRAIN_LIMIT of every job block in milliseconds."""

LEASE_MS = 3000
"""LEASE of every job block in milliseconds."""

HEARTBEATS = 30_000
"""The heartbeat of a drive's owner counts 1, 2, .. up to this number and begins again, one step in every call."""
