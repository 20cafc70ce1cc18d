"""What must hold at the end of a run: result, values, telegrams on the wire, errors and diagnostics."""

from __future__ import annotations

from plcgen.proof.scenario import ScenarioError
from plcgen.protocols.ds47.plan.nouns import DriveTelegram
from plcgen.protocols.ds47.proof.rig import JobRig
from plcgen.protocols.ds47.proof.scenario import DriveScenario
from plcgen.protocols.ds47.proof.words import DONE, WORDS

CHECKED = frozenset(
    WORDS[name]
    for name in (
        "RESPONSE_LENGTH",
        "RESPONSE_ID",
        "DRIVE_OBJECT",
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
    return reference + 1 if 0 <= reference < 255 else 1


class End:
    """The checks of a finished run; ``reference`` is the last one before it, None if it is not known."""

    def __init__(self, rig: JobRig, scenario: DriveScenario, reference: int | None) -> None:
        self.rig, self.scenario, self.reference = rig, scenario, reference

    def check(self, status: int) -> None:
        """Values, wire, errors, diagnostics."""
        if status == DONE:
            self.check_values()
        elif status in CHECKED:
            telegram = self.rig.job.telegrams[self.rig.db.get("telegram") - 1]
            self.check_response(telegram, self.rig.drive.journal[-1].data)
        self.check_wire(status)
        self.check_diagnostics(status)

    def check_values(self) -> None:
        """Outputs and response DBs hold what the drive has; the drive holds what was written."""
        rig = self.rig
        for use in rig.job.outputs:
            expected = rig.expected(use)
            found = rig.values.bytes(use.member, len(expected))
            if found != expected:
                raise ScenarioError(f"{use.member} is {found.hex(' ')}, the drive has {expected.hex(' ')}")
        for telegram, answer in zip(rig.job.telegrams, self.answers(), strict=False):
            self.check_response(telegram, answer)

    def check_response(self, telegram: DriveTelegram, answer: bytes) -> None:
        """The response DB holds an answer, good or bad: every member that the answer reaches the end of."""
        memory = self.rig.cpu.db(telegram.response.db.name)
        fields = [f.name for f in telegram.response.fields if self.differs(f.offset, f.size, memory, answer)]
        if fields:
            raise ScenarioError(f'"{telegram.response.db.name}" differs from the answer in {", ".join(fields)}')

    @staticmethod
    def differs(offset: int, size: int, memory: bytearray, answer: bytes) -> bool:
        """Whether a member of the response DB holds something else than the answer."""
        return offset + size <= len(answer) and bytes(memory[offset : offset + size]) != answer[offset : offset + size]

    def answers(self) -> list[bytes]:
        """The answers that belong to the telegrams: those with the reference of the request before them."""
        chosen: list[bytes] = []
        reference = -1
        for exchange in self.rig.drive.journal:
            if exchange.direction == "write":
                reference = exchange.data[0]
            elif exchange.data and exchange.data[0] == reference:
                chosen.append(exchange.data)
        return chosen[-len(self.rig.job.telegrams) :]

    def check_wire(self, status: int) -> None:
        """Every request is a planned telegram of this run, whole and exact, with a new reference."""
        rig, scenario = self.rig, self.scenario
        planned = rig.requests()
        at, before, failed = 0, self.reference or 0, False
        writes = reads = 0
        for exchange in rig.drive.journal:
            if exchange.direction == "read":
                reads += 1
                continue
            writes += 1
            data = exchange.data
            if exchange.index != rig.job.drive.record_index & 0xFFFF:
                raise ScenarioError(f"data record 16#{exchange.index:04X} was written")
            if self.reference is None:
                at = next((i for i, request in enumerate(planned) if request[1:] == data[1:]), at)
            elif at + 1 < len(planned) and data[1:] != planned[at][1:]:
                at += 1
            if not data or data[1:] != planned[at][1:]:
                raise ScenarioError(f"sent {data.hex(' ').upper()} instead of {planned[at].hex(' ').upper()}")
            repeated = failed and data[0] == before
            if not data[0] or (self.reference is not None and not repeated and data[0] != following(before)):
                raise ScenarioError(f"request reference {data[0]} follows {before}")
            before, failed = data[0], exchange.status != 0
        total = len(planned)
        if status == DONE and at != total - 1:
            raise ScenarioError(f"{at + 1} of {total} telegrams were sent")
        if scenario.calls is not None:
            extra_writes, extra_reads = scenario.calls
            count = scenario.telegram or total
            if (writes, reads) != (count + extra_writes, count + extra_reads):
                wanted = f"{count + extra_writes} WRREC and {count + extra_reads} RDREC"
                raise ScenarioError(f"{writes} WRREC and {reads} RDREC reached the drive instead of {wanted}")

    def check_diagnostics(self, status: int) -> None:
        """Errors per parameter and the details for the maintenance engineer."""
        rig, scenario, journal = self.rig, self.scenario, self.rig.drive.journal
        words, infos = rig.words("errors"), rig.words("errorInfos")
        for position in range(1, len(rig.job.uses) + 1):
            word, info = scenario.errors.get(position, (0, 0))
            if (words[position - 1], infos[position - 1]) != (word, info):
                found = f"16#{words[position - 1]:04X}, 16#{infos[position - 1]:04X}"
                raise ScenarioError(
                    f"errors[{position}], errorInfos[{position}] are {found}, not 16#{word:04X}, {info}"
                )
        expected = {"failedParameter": min(scenario.errors, default=0)}
        if journal:
            expected["recordStatus"] = journal[-1].status
            if status not in {WORDS["DRIVE_LOST"], WORDS["WRONG_DB"]}:
                expected["requestReference"] = [e.data[0] for e in journal if e.direction == "write"][-1]
        received = [e.data for e in journal if e.direction == "read" and not e.status]
        expected["responseLength"] = len(received[-1]) if received else 0
        if scenario.retries is not None:
            expected["retries"] = scenario.retries
        if scenario.telegram is not None:
            expected["telegram"] = scenario.telegram or len(rig.job.telegrams)
        restarted = {"cold", "warm", "reset", "lost"} & set(scenario.happens.values())
        for name, value in expected.items():
            if rig.db.get(name) != value and not (restarted and name != "failedParameter"):
                raise ScenarioError(f"diagnostics.{name} is {rig.db.get(name)} instead of {value} (16#{status:04X})")
