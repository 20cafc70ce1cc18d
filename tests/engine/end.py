"""What must hold at the end of a job: status, values, results per parameter, telegrams on the wire, foreign bytes."""

from __future__ import annotations

from plcgen.ds47.proof.words import DONE, MEANINGS, WORDS
from plcgen.proof.scenario import ScenarioError
from tests.engine.errands import Letter
from tests.engine.rig import EngineRig, JobPlace
from tests.engine.scenario import EngineScenario
from tests.engine.verdict import FOREIGN, Verdict, judge, silence

ANSWERED = frozenset(
    WORDS[name]
    for name in (
        "DONE",
        "RESPONSE_LENGTH",
        "RESPONSE_ID",
        "PARAMETER_COUNT",
        "RESPONSE_FORMAT",
        "PARAMETER_ERROR",
        "REFUSED",
        "NOT_SUPPORTED",
    )
)
"""Results that come from looking at an answer."""


def following(reference: int) -> int:
    """The request reference after this one: 1 to 255, never 0."""
    return reference % 255 + 1


class Ending:
    """The checks of a finished run; ``reference`` is the last one before it, None if it is not known."""

    def __init__(self, rig: EngineRig, job: JobPlace, scenario: EngineScenario, reference: int | None) -> None:
        if job.errand is None:
            raise ScenarioError("the job has nothing to do")
        self.rig, self.job, self.scenario, self.reference = rig, job, scenario, reference
        self.errand, self.drive = job.errand, rig.drives[job.unit - 1]

    def check(self, status: int) -> None:
        """Everything."""
        last = self.last_letter()
        if status == DONE and last != len(self.errand.letters):
            raise ScenarioError(f"done after telegram {last} of {len(self.errand.letters)}")
        if status == DONE and self.errand.writes and not self.job.written():
            raise ScenarioError("done, and the drive does not have the values")
        if self.scenario.telegram is not None and last != (self.scenario.telegram or len(self.errand.letters)):
            raise ScenarioError(f"ended with telegram {last} (16#{status:04X})")
        self.check_wire()
        if last:
            self.check_results(last, status)
        self.check_details()

    def last_letter(self) -> int:
        """The telegram that the job built last; each was built once and, but for the last, taken once."""
        built = [self.job.db.get(f"letters[{n}].built") for n in range(1, len(self.errand.letters) + 1)]
        taken = [self.job.db.get(f"letters[{n}].taken") for n in range(1, len(self.errand.letters) + 1)]
        last = sum(built)
        if built != [1] * last + [0] * (len(built) - last) or taken not in (
            [1] * n + [0] * (len(built) - n) for n in (last - 1, last)
        ):
            raise ScenarioError(f"telegrams were built {built} and taken {taken} times")
        return last

    # --- results --------------------------------------------------------------------------------------

    def check_results(self, last: int, status: int) -> None:
        """Errors, infos and values of the telegram that ended the job, and of the one before it."""
        if not self.job.db.get(f"letters[{last}].taken"):
            return
        letter = self.errand.letters[last - 1]
        verdict = self.verdict(letter) if status in ANSWERED else silence(letter, "")
        if status in ANSWERED and WORDS.get(verdict.word) != status:
            name = MEANINGS.get(status, ("?", ""))[0]
            raise ScenarioError(f"the answer means {verdict.word}, the status is {name}")
        found = list(zip(self.job.words("errors", last), self.job.words("infos", last), strict=True))
        wanted = list(zip(verdict.errors, verdict.infos, strict=True))
        for position, stated in self.scenario.errors.items():
            if position <= len(wanted) and wanted[position - 1] != stated:
                raise ScenarioError(f"the answer gives {wanted[position - 1]} for parameter {position}, not {stated}")
        if found != wanted:
            raise ScenarioError(f"errors and infos are {_shown(found)}, not {_shown(wanted)}")
        failed = self.job.db.get(f"letters[{last}].failed")
        if failed != verdict.failed:
            raise ScenarioError(f"failed is {failed} instead of {verdict.failed}")
        self.check_values(letter, last, verdict)
        header = self.job.db.bytes(f"letters[{last}].response", 4)
        if status in {DONE, WORDS["PARAMETER_ERROR"]} and header != self.drive.journal[-1].data[:4]:
            raise ScenarioError(f"the header of the answer is {header.hex(' ')} at the job")

    def verdict(self, letter: Letter) -> Verdict:
        """What the last answer to the last request means."""
        request, found = b"", silence(letter, "")
        for exchange in self.drive.journal:
            if exchange.direction == "write" and not exchange.status:
                request = exchange.data
            elif exchange.direction == "read" and not exchange.status:
                judged = judge(letter, request, exchange.data)
                found = found if judged.word == FOREIGN else judged
        return found

    def check_values(self, letter: Letter, number: int, verdict: Verdict) -> None:
        """Blocks that are good lie where they lie if all are; those of a change have no values."""
        response = self.job.db.bytes(f"letters[{number}].response")
        for position, ((at, size), block) in enumerate(zip(letter.blocks, verdict.taken, strict=True), 1):
            head = 0 if letter.parts[position - 1].most else 2  # the format that came is for who asked without a type
            if block is not None and not letter.writes and response[at + head : at + len(block)] != block[head:]:
                found = response[at : at + size].hex(" ")
                raise ScenarioError(f"parameter {position} came as {block.hex(' ')}, the job got {found}")

    def check_details(self) -> None:
        """STATUS of the last record call, and how often it was tried again."""
        unit, journal = self.rig.units[self.job.unit - 1], self.drive.journal
        restarted = {"cold", "warm", "lost"} & set(self.scenario.happens.values())
        if self.scenario.retries is not None and unit.get("retries") != self.scenario.retries:
            raise ScenarioError(f"{unit.get('retries')} retries instead of {self.scenario.retries}")
        if not journal and not restarted and unit.get("recordStatus"):
            raise ScenarioError("recordStatus is that of another job")
        if journal and not restarted and unit.get("recordStatus") != journal[-1].status:
            raise ScenarioError(f"recordStatus is {unit.get('recordStatus'):08X}, not {journal[-1].status:08X}")

    # --- the wire -------------------------------------------------------------------------------------

    def check_wire(self) -> None:
        """Every request is a telegram of this job, whole and exact; each one that is built has a new reference."""
        planned, scenario = self.job.requests(), self.scenario
        at, before, failed, built = 0, self.reference, False, 0
        writes = reads = 0
        restarted = bool(scenario.happens)
        for exchange in self.drive.journal:
            if exchange.direction == "read":
                reads += 1
                continue
            writes += 1
            data = exchange.data
            if exchange.index != 47:
                raise ScenarioError(f"data record {exchange.index} was written")
            if at + 1 < len(planned) and data[1:] != planned[at][1:]:
                at += 1
            if not data or data[1:] != planned[at][1:]:
                raise ScenarioError(f"sent {data.hex(' ').upper()} instead of {planned[at].hex(' ').upper()}")
            repeated = failed and data[0] == before
            wanted = {following(before)} if before is not None else set()
            if restarted and before is not None:  # a request that never reached the drive had one, too
                wanted = set(range(1, 256)) - {before}
            if not data[0] or (wanted and not repeated and data[0] not in wanted):
                raise ScenarioError(f"request reference {data[0]} follows {before}")
            built += not repeated
            before, failed = data[0], exchange.status != 0
        self.check_counts(writes, reads, built)

    def check_counts(self, writes: int, reads: int, built: int) -> None:
        """How many calls reached the drive, how many requests were built; a trigger is sent once."""
        scenario, total = self.scenario, len(self.errand.letters)
        count = scenario.telegram or total
        sent = sum(e.direction == "write" and not e.status for e in self.drive.journal)
        if self.errand.once and sent > total:
            raise ScenarioError(f"a trigger was sent {sent} times")
        if scenario.again is not None and scenario.calls is not None and built != count + scenario.again:
            raise ScenarioError(f"{built} requests were built instead of {count + scenario.again}")
        if scenario.calls is not None:
            wanted = (count + scenario.calls[0], count + scenario.calls[1])
            if (writes, reads) != wanted:
                raise ScenarioError(f"{writes} WRREC and {reads} RDREC reached the drive instead of {wanted}")


def _shown(pairs: list[tuple[int, int]]) -> str:
    return ", ".join(f"{word:04X} {info:04X}" for word, info in pairs[:4])


class Guards:
    """Bytes that a job of unit 1 must not change: of its unit, of the others, of the gate, of other jobs."""

    def __init__(self, rig: EngineRig, job: JobPlace) -> None:
        self.rig, self.job = rig, job
        unit, errand = rig.units[0], job.errand
        slot, pinned = job.db.get("slot"), errand is not None and errand.pinned
        letters = errand.letters if errand is not None else ()
        most = max((max(letter.length, letter.answer) for letter in letters), default=0)
        spots = unit.spots
        own = [
            *((spots[name].byte, spots[name].size) for name in ("errors", "infos", "order", "turn")),
            *((spots[name].byte, spots[name].size) for name in ("recordStatus", "failed", "state", "retries")),
            (spots["telegram"].byte, most), *([(spots["record"].byte, spots["record"].size)] if rig.classic else []),
            (spots["expected"].byte, 4 * max((len(x.parts) for x in errand.letters), default=0) if errand else 0),
            (spots[f"asks[{slot}].telegram"].byte, 6), (spots[f"ended[{slot}]"].byte, 2),
        ]  # fmt: skip
        self.foreign = _outside(own, len(unit.memory))
        names = ["Unit2", "Unit3", "Job2", "Plan", *([] if pinned else ["PinnedRequest", "PinnedResponse"])]
        self.watched = [(name, rig.bytes_of(name)) for name in names]
        gate = rig.gate.spots["channels[2].ask"].byte
        self.before = [bytes(unit.memory[a:b]) for a, b in self.foreign]
        self.others = [bytes(memory) for _, memory in self.watched]
        self.gate = gate, bytes(rig.gate.memory[gate:])

    def check(self) -> None:
        """Raises ScenarioError if one of them changed."""
        memory = self.rig.units[0].memory
        for (first, end), before in zip(self.foreign, self.before, strict=True):
            if memory[first:end] != before:
                at = next(i for i, byte in enumerate(before) if memory[first + i] != byte)
                raise ScenarioError(f"byte {first + at} of the unit changed, which is not the job's")
        for (name, data), before in zip(self.watched, self.others, strict=True):
            if bytes(data) != before:
                raise ScenarioError(f"{name} changed")
        first, before = self.gate
        if self.rig.gate.memory[first:] != before:
            raise ScenarioError("places of other channels changed")


def _outside(own: list[tuple[int, int]], size: int) -> list[tuple[int, int]]:
    """Ranges of bytes that are not in any of some (first, length)."""
    found, at = [], 0
    for first, length in sorted(own):
        if first > at:
            found.append((at, first))
        at = max(at, first + length)
    return [*found, (at, size)] if at < size else found
