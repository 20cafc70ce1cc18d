"""Mutants that no test can notice, with the reason."""

from __future__ import annotations

import re
from pathlib import PurePath

from tests.mutation.cases import Case, classic

EQUIVALENT = {
    r"^\w+: \d+ -> \d+: (CALL|EVENT|PHASE)_[A-Z]+ : I(nt|NT) :=": (
        "a number that only the block compares; if another constant had it already, the block would go wrong"
    ),
    r"^\w+: < -> <=: IF tempFailed = 0 OR tempIndex < tempFailed": (
        "no two items of a telegram have the same first address"
    ),
    r"^DriveChannel: (dropped: statTimer := 0|0 -> 1: statTimer := 0;) \(1\)$": (
        "after a good answer no record call is active"
    ),
    r"^DriveChannel: (<= -> <|0 -> 1): tempGone := tempAsk.want <= 0 OR tempAsk.want <> statTic": (
        "the number of the job that holds the unit is above 0: one that is not is another one"
    ),
    r"^Drive(Channel|Ticket): > -> >=: (IF temp|ELSIF seen.)(W|w)ant > 0 AND (temp|seen.)(W|w)ant <>": (
        "0 stands in a slot until something asks there, and so long 0 is the number that has ended, too"
    ),
    r"^DriveChannel: \d -> \d: tempSlot := LIMIT\(MN := 1, IN := DINT_TO_INT\(tempGrant / 1": (
        "the channel itself wrote a slot of the unit there"
    ),
    r"^DriveChannel: 1 -> 2: temp(Other)?Pointer.count := 1; ": "BLKMOV copies what the shorter area has: a byte",
    r"^DriveChannel: NOT -> nothing: statProbe := NOT tempProbe": (
        "only a copy that fails could leave it: every data block has the byte that is copied"
    ),
    r"^DriveChannel: dropped: tempPointer\.address := DW#16#84\w+ \(3\)$": "RDREC has it from the same call",
    r"^DriveChannel: (dropped|FALSE -> TRUE): statAsks := FALSE": (
        "who asks again in the next turn has no place any more: the gate was called meanwhile, as it is in the same OB"
    ),
    r"^DriveChannel: exchanged: FOR tempByte := 0 TO tempMore - 1 DO": "the bytes in front of a value, and the value",
    r"^DriveChannel: OR -> AND: IF tempSlot = statSlot OR tempWant <= 0 OR .*\(1\)$": (
        "who holds the unit looks at the grant, not at what has ended"
    ),
    r"^DriveChannel: > -> >=: IF statState > STATE_HOLD AND": (
        "between two telegrams nobody looks at the status, and with the next one the time is over, too"
    ),
    r"^DriveChannel: 44 -> 45: IF tempKind >= 33 AND tempKind <= 44": "7Dh is no format, as 2Dh is none",
    r"^DriveChannel: - -> \+: FOR tempByte := 0 TO tempOwn - 1 DO": (
        "two bytes more: what fills up, and the head of the next block, which is written later or never read"
    ),
    r"^DriveChannel: dropped: tempGrant := 0": "what it keeps from being done would do once more what was just done",
    r"^DriveChannel: 0 -> 1: statCount := LIMIT\(MN := 0": "a request has one parameter at least",
    r"^DriveChannel: (0 -> 1|3 -> 4): FOR tempByte := 0 TO 3 DO unit.telegram\[tempByte\] := tem": (
        "the answer has the reference of the request; its type is the same as in the block, if that is taken"
    ),
    r"^DriveChannel: (30000 -> 30001|1 -> 2): statAsk := statAsk MOD 30000 \+ 1": (
        "only that it is another number counts"
    ),
    r"^DriveChannel: \d*[02468] -> \d+: SIZE( : Int)? :=": "an answer has an even number of bytes",
    r"^DriveChannel: W#16#8105 -> W#16#8104: STATUS_LOST :": (
        "nobody hears it: the job is gone, and the ticket says 8105 by itself; only that it is not 0000 counts"
    ),
    r"^DriveChannel: 0 -> 1: statElapsed := 0; statStill := 0; \(2\)$": (
        "the next call sees another sign of life and sets it to 0; with the same number a job that is gone has 2999 ms"
    ),
    r"^DriveChannel: OR -> AND: tempGone := .*\([12]\)$": (
        "who asks a second time in a slot is refused in the same call: the next call sees a negative number"
    ),
    r"^DriveChannel: <= -> <: IF tempSlot = statSlot OR tempWant <= 0 OR": "0 is the number that has ended, too",
    r"^DriveChannel: 0 -> 1: tempCode := 0;": "1 is no code of STATUS, and not temporary either",
    r"^DriveChannel: B#16#02 -> B#16#03: temp(Other)?Pointer\.id := ": (
        "CHAR has the size of BYTE; no document says what SFB 52 does with it (SFC 59 takes BYTE only)"
    ),
    r"^DriveChannel: (OR -> AND|\+ -> -): ELSIF NOT tempUnknown AND \(tempFault OR tempFrom \+ 2 > statLength": (
        "the place stays where the fault was, and behind the end of the answer the check of the size finds one"
    ),
    r"^DriveGate: 1 -> 2: tempUsed := tempUsed \+ 1; \(2\)$": "who would have a place now has it in the next call",
    r"^DriveChannel: 0 -> 1: FOR tempByte := 0 TO statOrder\.length - 1 DO": (
        "the first byte is the reference, which the channel puts there"
    ),
    r"^DriveChannel: 0 -> 1: FOR tempByte := 0 TO LIMIT\(.*\(2\)$": (
        "an answer without a byte does not occur; of one, BLKMOV on S7-300/400 moves a byte into the data block as well"
    ),
    r"^\w+: (3 -> 4: tempSize := 3;|1 -> 2: tempSize := 1; \(3\)$)": (
        "a value of one or three bytes has a pad behind it: it is not the last one"
    ),
    r"^\w+: 0 -> 1: FOR temp(Index|Byte) := 0 TO \d+ DO unit\.telegram\[temp(Index|Byte)\] :=": (
        "the first byte is the reference, which the channel puts there"
    ),
    r"^DriveChannel: dropped: statProbe := NOT tempProbe": (
        "a copy that fails leaves what was there, which cannot be the opposite of the reference and the reference, too"
    ),
    r"^WriteRecipe: dropped: statOrder\.length := 240 \(2\)$": "the telegram before it is as long",
    r"^\w+: - -> \+: CASE \((tempSeen|statTicket\.ask)\.telegram - 1\) MOD 2 \+ 1 OF": (
        "of two telegrams, the one before and the one behind are the same"
    ),
    r"^\w+: 0 -> 1: IF statLast > 0 AND NOT statChanged THEN": "a buffer is read in two telegrams at least",
    r"^\w+: (0|7|13|17|25|93|213) -> \d+: FOR tempIndex := 0 TO \d+ DO statResponseBytes\d*\[tempIndex\] :=": (
        "of an answer in an instance only the values are read: neither its reference nor a byte behind it"
    ),
    r"^\w+: 2 -> 3: tempApart := LIMIT\(MN := -2, IN := 256 \* tempApart": (
        "2 stands for more: 256 times as much, whatever the next byte is, is more than 3, too"
    ),
    r"^\w+: > -> >=: IF statRest > L#0 THEN statRest :=": "what is left is compared with 0 only: 0 and less are alike",
    r"^Set(Recipe|Mop): 0 -> 1: IF statLast = 0 AND statPause < SAVE_INTERVAL THEN tempT.* \(2\)$": (
        "what saves is not telegram 1: that one is as well not served as telegram 0"
    ),
    r"^(TakeOut|BringBack|Release|SetUp): > -> >=: ELSIF busy AND statTicket\.ask\.telegram > 0": (
        "in front of the telegram with which a turn begins is none that waits"
    ),
    r"^Release: (dropped: statOrder\.length := 1[06] \(2\)$|dropped: unit\.expected\[2\] := DW#16#07010004 \(2\)$)": (
        "the telegram before it, in the same turn, is as long and expects the same there"
    ),
    r"^Release: (dropped: unit\.expected\[1\] := DW#16#07010004 \(3\)$|\d -> \d: unit\.expected\[\d\] := .*  // r46)": (
        "the telegram before it, in the same turn, expects the same there; a place behind the last one is not looked at"
    ),
    r"^LoadWinding: 5 -> 6: FOR tempIndex := 1 TO 5 DO \(1\)$": (
        "the channel says of a place behind the last one what stands there already: no answer"
    ),
    r"^Set(Limits|Filter|Mop): > -> >=: IF statTicket\.ask\.telegram > 1 AND cause = W#16#0000": (
        "a good telegram 1 is no cause, and if it fails, its status becomes the cause in the same call"
    ),
    r"^SetFilter: (\+ -> -|1 -> 2): statReturning := statReturning \+ 1": "of one parameter: only 0 counts",
    r"^Set(Limits|Filter|Mop): (< -> <=|2 -> 3): IF statTicket\.error AND \(cause = ": (
        "with a cause, telegram 2 ends well unless another job takes the slot in the same call: either is why"
    ),
    r"^Set(Limits|Mop): exchanged: FOR tempByte := 0 TO 1 DO unit\.telegra": (
        "the type of a value and the value, side by side"
    ),
    r"^Set(Limits|Mop): (1 -> 2|2 -> 3|5 -> 6): FOR tempByte := 0 TO [125] DO unit\.telegram\[": (
        "the next byte is written behind it: number of parameters, next address or first value"
    ),
    r"^(SetLimits: 3 -> 4: FOR tempIndex := 1 TO 3 DO \(2\)|SetMop: 3 -> 4: FOR tempIndex := 1 TO 3 DO \([12]\))$": (
        "the channel says of a place behind the last one what stands there already: no answer"
    ),
    r"^SetMop: - -> \+: FOR tempByte := 0 TO statSizes\[tempIndex\] - 1 DO unit\.te": (
        "what is behind a value is written next, or behind the telegram"
    ),
    r"^SetMop: (B#16#04 -> B#16#05: IF rounding|B#16#FA -> B#16#FB: statRequestBytes2)": (
        "bit 0 is always written, as 1"
    ),
    r"^CheckAxis: (\* -> \+|6 -> 7): deviations\[tempOthers\]\.index := .* \(1\)$": (
        "no parameter has an index: the bytes are 0"
    ),
    r"^Check(Axis|Winding): (\+ -> -: deviations.*index := .* \(1\)$|(8 -> 9|OR -> AND): deviations.*index :=)": (
        "no parameter has an index: the bytes are 0"
    ),
    r"^CheckRamps: dropped: deviations\[temp(Others|Index)\]\.index := ": "no parameter has an index: it stays 0",
    r"^CheckRamps: dropped: tempOther := \(\(tempWanted OR tempFound\) AND": (
        "what is wanted is not 0: a number with the other sign is another one"
    ),
    r"^SetUp: dropped: (statLimit := L#5000|statInterval := L#500) \(2\)$": (
        "another step that waits comes before it in every run, and has the same times"
    ),
    r"^ReadHistory: dropped: statOrder\.length := 10 \(2\)$": "the telegram before it is as long",
    r"^ReadHistory: 8 -> 9: FOR tempIndex := tempPlace \+ 1 TO 8 DO": (
        "place 9 is the first one of the next group, which fills or clears it in the same call"
    ),
    r"^CheckRecipe: dropped: statOrder\.length := 16 \(2\)$": "the telegram before it is as long",
    r"^CheckRecipe: 6 -> 7: statDeviations.*index := .*\(3\)$": "the last parameter has no index: its bytes are all 0",
    r"^CheckRecipe: exchanged: FOR tempIndex := 300": "two pieces of one input, whichever is copied first",
    r"^Check(Drive|Axis): \d+ -> \d+: FOR tempPart := 0 TO": "behind the wanted answer are zeros: no value",
    r"^Check(Drive|Axis): DW#16#0000FFFF -> \S+: .*\.wanted :=": (
        "a source has more digits than a REAL: the last bit is lost"
    ),
    r"^ppi_cp341: (< -> <=|0 -> 1): IF tempElapsed < 0 THEN": (
        "0 and 2147483648 are -2147483648 in a DINT, which is before the end of every time, as 0 is"
    ),
    r"^ppi_\w+: (dropped: statResume := STATE_POLL \(1\)|(dropped|L#0 -> L#1|0 -> 1): statPause := L?#?0;? \(1\))$": (
        "a message takes two calls at least: one that comes in the first scan of POLL follows a pause, which is over"
    ),
    r"^\w+: 1 -> 2: statReference := 1;": "any reference will do that is neither 0 nor the one before",
    r"^\w+: \+ -> -: (statSend\[4\]|\"MPpi_Buffer\"\.send\[5\]) := WORD_TO_BYTE\(.* \(1\)$": (
        "the own address is 0 here, and so is what is added; with another one the poll is damaged"
    ),
    r"^ppi_(cm1241(?!.*\(2)|cp341(?!.*\(1)): \S+ -> \S+: FOR tempIndex := 0 TO tempLength - 1 DO": (
        "no sum that is used begins with the first byte, or ends with the last two; behind a message is room for more"
    ),
    r"^\w+: 1 -> 2: tempCount := WORD_TO_INT\(BYTE_TO_WORD\(statReceive\[tempPos": (
        "both lengths of a head are the same, or it is none"
    ),
    r'^\w+: 8 -> 9: "M(All|Long2)_Response"\.valueLength\d? := SHL': (
        "the length was compared before, and is less than 256: its first byte is 0"
    ),
    r"^\w+: 0 -> 1: tempCount := 0;": "fewer than three bytes are no frame of PPI, whether none or one",
}
"""Reasons by block or spec, description of a mutant without the # of the TIA Portal, and its turn among those alike."""


def reason(case: Case) -> str:
    """Why a mutant behaves like the original; empty if it should be noticed."""
    texts = [f"{name}: {classic(case.mutant.what)} ({case.turn})" for name in (PurePath(case.file).stem, case.spec)]
    return next((why for pattern, why in EQUIVALENT.items() if any(re.search(pattern, text) for text in texts)), "")
