"""Status words, states and times of the engine and the jobs, stated by hand after docs/generated-code.md: nothing is
imported from the generator, so that a wrong word there shows here.
"""

from __future__ import annotations

STATES = ("IDLE", "HOLD", "BUILD", "GATE", "WRITE", "READ", "PAUSE", "DRAIN")
"""The states of a channel: their numbers count from 0."""
IDLE, HOLD, BUILD, GATE, WRITE, READ, PAUSE, DRAIN = range(8)


def state_name(state: int) -> str:
    """Name of a state; a number that is none as it is."""
    return STATES[state] if 0 <= state < len(STATES) else str(state)


TRANSITIONS = frozenset(
    {
        (IDLE, HOLD), (HOLD, IDLE), (HOLD, GATE), (HOLD, WRITE), (HOLD, READ), (HOLD, PAUSE),
        (GATE, WRITE), (GATE, READ), (GATE, PAUSE), (GATE, HOLD), (WRITE, READ), (WRITE, PAUSE), (WRITE, DRAIN),
        (WRITE, HOLD), (READ, PAUSE), (READ, DRAIN), (READ, HOLD), (PAUSE, GATE), (PAUSE, HOLD), (DRAIN, HOLD),
    }
)  # fmt: skip
"""From one call of a channel to the next. BUILD is passed within a call, DRAIN with no record call active too."""
SHORT_PAUSES = (0, 20, 50, 100)
"""ms before the first retries of a telegram without an answer (B5), none of them longer than the pause of the job."""

MEANINGS = {
    0x0000: ("DONE", "job done, no error"),
    0x7000: ("IDLE", "no job active"),
    0x7001: ("STARTED", "job started"),
    0x7002: ("RUNNING", "job running"),
    0x8101: ("TIMEOUT", "not finished within its timeout"),
    0x8102: ("DRAIN_TIMEOUT", "a record call still active after DRAIN_LIMIT"),
    0x8103: ("STILL_DRAINING", "refused: a record call of an earlier job is still active"),
    0x8104: ("OCCUPIED", "waited for the unit for waitLimit"),
    0x8105: ("LOST", "not called for LEASE, or channel or unit loaded again: what the drive did is not known"),
    0x8106: ("NOT_CALLED", "the channel gives no sign of life"),
    0x8107: ("NO_PLACE", "no place for a record job within the timeout"),
    0x8108: ("NO_SLOT", "the unit has no such slot"),
    0x8109: ("SLOT_TAKEN", "another job uses the slot"),
    0x8201: ("WRITE_ERROR", "WRREC failed for good, see recordStatus"),
    0x8202: ("READ_ERROR", "RDREC failed for good, see recordStatus"),
    0x8203: ("RETRIES", "still not successful after all retries"),
    0x8204: ("WRONG_DB", "the number at unitDb is not that of the unit's data block"),
    0x8205: ("UNKNOWN", "the request got lost; a trigger is not sent again"),
    0x8301: ("RESPONSE_LENGTH", "response shorter than its header"),
    0x8302: ("RESPONSE_ID", "response id does not belong to the request"),
    0x8303: ("DRIVE_OBJECT", "responses come from another drive object"),
    0x8304: ("PARAMETER_COUNT", "response has another number of parameters"),
    0x8305: ("RESPONSE_FORMAT", "a value block has the wrong format, number of values or length"),
    0x8401: ("PARAMETER_ERROR", "the drive refused at least one parameter, see errors"),
    0x8402: ("REFUSED", "the drive refused the whole request, see errors"),
    0x8403: ("NOT_SUPPORTED", "the drive does not support the request"),
    0x8501: ("NOT_SAVED", "the parameter that saves has not returned to 0 within the limit"),
    0x8502: ("TOO_SOON", "refused: the last save is less than the distance ago"),
    0x8503: ("DEVIATES", "the drive has another value than was written, see errors"),
    0x8504: ("CHANGED", "the buffer of the drive changed while it was read, in every try"),
    0x8505: ("NOT_ACKNOWLEDGED", "the parameter that acknowledges has not returned to 0 within the limit"),
    0x8506: ("FAULTS_REMAIN", "it has, but the drive has faults after the limit"),
    0x8510: ("NOT_REACHED", "what a step waits for is not there within its timeout"),
    0x8550: ("NO_REQUEST", "refused: what the inputs ask for does not fit a request"),
    0x8551: ("NOT_ENABLED", "refused: a write without enableWrite"),
    0x8552: ("NOT_PERMITTED", "refused: a number that may not be written, or another drive object"),
    0x8553: ("NOT_WRITABLE", "refused: a type of which values are not written"),
    0x8554: ("NO_VALUE", "refused: a value that its type does not hold, NaN, infinity"),
    0x8520: ("NO_TIME", "refused: the time at the input does not exist, or not between 2000 and 2089"),
    0x8530: ("RESTORED", "failed; every parameter has its old value"),
    0x8531: ("NOT_RESTORED", "failed; restoring failed as well"),
    0x8532: ("RUNS", "failed; the drive runs, so that nothing was written back"),
    0x8533: ("LEFT", "failed; values that are neither the old ones nor the job's were left alone"),
    0x8540: ("NO_RECORD", "refused: there is no record with this number"),
    0x8541: ("OUTSIDE", "refused: a value of the record is outside its limits, see failedParameter"),
}
WORDS = {name: word for word, (name, _) in MEANINGS.items()}
"""Status words by name: ``WORDS["TIMEOUT"]``."""

DONE = WORDS["DONE"]
DRAIN_MS = 5000
"""DRAIN_LIMIT: that long a record call may stay active behind the end of a telegram."""
LEASE_MS = 3000
"""LEASE: a job or a channel without a sign of life for that long has lost its unit or place."""
STEP_MS = 1000
"""STEP_LIMIT: the longest time between two calls that counts."""
CALLS_LIMIT = 1000
"""Calls of a job without a call of its channel."""
COUNTERS = 30_000
"""Numbers of orders, signs of life and requests for places count 1, 2, .. up to this number and begin again."""
GRANT = 100_000
"""The grant is the slot times this, plus the number of the order."""
DEVIATES = 0x8200
"""errors[i] of a value that is not the one that was written."""
NO_ANSWER = 0xFFFF
"""errors[i] of a parameter that has no answer."""
