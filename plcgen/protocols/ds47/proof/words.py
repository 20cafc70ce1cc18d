"""Status words, states and times of a job block, stated by hand after docs/generated-code.md: nothing is imported from
the generator, so that a wrong word there shows here.
"""

from __future__ import annotations

STATES = ("IDLE", "ACQUIRE", "BUILD", "WRITE", "READ", "CHECK", "WAIT", "DRAIN")
"""The states of the block: their numbers count from 0."""
IDLE, ACQUIRE, BUILD, WRITE, READ, CHECK, WAIT, DRAIN = range(8)


def state_name(state: int) -> str:
    """Name of a state; a number that is none as it is."""
    return STATES[state] if state < len(STATES) else str(state)


MEANINGS = {
    0x0000: ("DONE", "job done, no error"),
    0x7000: ("IDLE", "no job active"),
    0x7001: ("STARTED", "job started"),
    0x7002: ("RUNNING", "job running"),
    0x8101: ("TIMEOUT", "not finished within TIMEOUT"),
    0x8102: ("DRAIN_TIMEOUT", "a record call still active after DRAIN_LIMIT"),
    0x8103: ("STILL_DRAINING", "start refused: a record call of an earlier job is still active"),
    0x8104: ("DRIVE_OCCUPIED", "another job kept the drive for the whole TIMEOUT"),
    0x8105: ("DRIVE_LOST", "another job took the drive over: this block was not called for LEASE"),
    0x8201: ("WRITE_ERROR", "WRREC failed for good, see diagnostics.recordStatus"),
    0x8202: ("READ_ERROR", "RDREC failed for good, see diagnostics.recordStatus"),
    0x8203: ("RETRIES", "still not successful after MAX_RETRIES"),
    0x8204: ("WRONG_DB", "a buffer DB has another number than the block expects"),
    0x8301: ("RESPONSE_LENGTH", "response shorter than its header"),
    0x8302: ("RESPONSE_ID", "response id does not belong to the request"),
    0x8303: ("DRIVE_OBJECT", "response comes from another drive object"),
    0x8304: ("PARAMETER_COUNT", "response has another number of parameters"),
    0x8305: ("RESPONSE_FORMAT", "a value block has the wrong format, number of values or length"),
    0x8401: ("PARAMETER_ERROR", "the drive refused at least one parameter, see errors"),
    0x8402: ("REFUSED", "the drive refused the whole request, see errors"),
    0x8403: ("NOT_SUPPORTED", "the drive does not support the request"),
}
WORDS = {name: word for word, (name, _) in MEANINGS.items()}
"""Status words by name: ``WORDS["TIMEOUT"]``."""

DONE = WORDS["DONE"]
DRAIN_MS = 5000
"""DRAIN_LIMIT: that long a record call may stay active behind the end of a job."""
LEASE_MS = 3000
"""LEASE: a job whose heartbeat stands still that long has lost the drive."""
HEARTBEATS = 30_000
"""The heartbeat counts 1, 2, .. up to this number and begins again."""
FOREIGN = 99
"""Owner number of the job of somebody else."""
