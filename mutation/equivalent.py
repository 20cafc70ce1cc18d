"""Mutants that no test can notice, with the reason."""

from __future__ import annotations

import re

from mutation.operators import Mutant

ALWAYS = {
    "MAX_RETRIES": "MAX_RETRIES x RETRY_PAUSE is longer than TIMEOUT in this spec: TIMEOUT ends the job first",
    "STATUS_RETRIES": "MAX_RETRIES x RETRY_PAUSE is longer than TIMEOUT in this spec: TIMEOUT ends the job first",
    "dropped: statState := STATE_DRAIN": "stands behind MAX_RETRIES, which TIMEOUT forestalls in this spec",
    ">= -> >: tempPauseOver": "the pause ends one scan later at most",
    ">= -> >: temp": "the limit is reached one scan later at most",
    "0 -> 1: IF": "reference 0 is followed by 1 either way",
    "tempProbe := statReference XOR": "any byte that differs will do",
    "statReference := WORD_TO_BYTE": "any byte that differs will do",
    "tempElapsed + CLOCK_END + 1": "once in 24 days the time is wrong by 1 or 2 ms",
    "CLOCK_END := L#": "once in 24 days the time is wrong by some ms",
    "CLOCK_END : DInt": "once in 24 days the time is wrong by some ms",
    "tempElapsed < 0": "0 ms and a negative time are both far from any limit",
    "tempErrorCode := 0": "any number but 160 does the same",
    "2 * tempWireCount > statLength": "the length does not come out at the end: the same status",
    "statLength > RESPONSE_SIZE": "RDREC never reports more than MLEN",
    "dropped: tempFault := TRUE": "the length does not come out at the end: the same status",
    "tempFault := TRUE;": "the length does not come out at the end: the same status",
}
SINGLE = {
    "statErrors[tempIndex] := W#16#0000": "one parameter: written again before it is shown",
    "tempWireCount := WORD_TO_INT(BYTE_TO_WORD(statResponse[": "one parameter: this byte is always the same",
    "STATUS_REFUSED": "one parameter: the word is never used",
    "tempWireFormat = B#16#40": "one parameter: a negative answer with a good block is wrong anyway",
    "2 -> 3: tempPosition := tempPosition + 2;": "one parameter: a negative answer with a good block is wrong anyway",
    "tempFailed": "one parameter: one error at most",
}


def reason(mutant: Mutant, *, single: bool) -> str:
    """Why a mutant behaves like the original; empty if it should be noticed. ``single``: a job of one parameter."""
    what = re.sub(r"(?<![A-Z0-9])#", "", mutant.what)
    table = {**ALWAYS, **SINGLE} if single else ALWAYS
    return next((why for text, why in table.items() if text in what), "")
