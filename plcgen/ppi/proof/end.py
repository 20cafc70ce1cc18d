"""What must hold at the end of a run: values, errors, diagnostics, frames on the line, tables."""

from __future__ import annotations

from plcgen.ppi.proof.rig import MasterRig
from plcgen.ppi.proof.scenario import PpiScenario
from plcgen.ppi.proof.tables import check_job_tables
from plcgen.ppi.proof.words import DONE, LEAD, WORDS
from plcgen.ppi.wire.areas import Function
from plcgen.ppi.wire.fdl import examine_frame
from plcgen.ppi.wire.model import FCB, FIRST, FixedFrame, VariableFrame
from plcgen.proof.scenario import ScenarioError

REFERENCE = slice(11, 13)
CODE, CHECK, START = 6, -2, 0x68
WITH_DATA = frozenset({0x08, 0x0A})
"""Function codes of a reply (EN 50170): data, data of high priority."""


class End:
    """The checks of a finished run; ``codes`` are the function codes last sent to each station, kept up to date."""

    def __init__(self, rig: MasterRig, scenario: PpiScenario, codes: dict[int, int]) -> None:
        self.rig, self.scenario, self.codes, self.job = rig, scenario, codes, rig.job

    def check(self, status: int) -> None:
        """Everything, the frames before what is said of the last one."""
        if self.scenario.pace is not None:
            self.check_pace(self.scenario.pace)
        if status == DONE:
            self.check_values()
        self.check_diagnostics(status)
        self.check_frames(status)
        if not self.scenario.restarts and status in {DONE, WORDS["ITEM_ERROR"]}:
            check_job_tables(self.rig, self.job, refused=status != DONE)
        self.check_last(status)
        self.check_heard(status)

    def check_pace(self, pace: tuple[int, int, int]) -> None:
        """The silence after a frame is what the constants say, and a few scans; a CP 341 moves 32 bytes in each."""
        port = self.rig.port
        sent = port.sent
        begins = [*(end - len(data) * port.character for end, data in sent[1:]), port.time]
        scans = 8 + (max(len(data) for _, data in sent) // 32 if self.rig.plan.target.classic else 0)
        slack = scans * self.scenario.scan + 2 * (port.gap + port.character)
        for number, ((end, _), begin) in enumerate(zip(sent, begins, strict=True), 1):
            wanted = pace[2] if number == len(sent) else pace[min(number, 2) - 1]
            if not wanted - 1 <= begin - end <= wanted + slack:
                raise ScenarioError(f"{begin - end:.0f} ms after frame {number} instead of {wanted}")

    def check_heard(self, status: int) -> None:
        """No job says that nothing came, or only E5, if the block has taken the reply to its last request."""
        if status not in {WORDS["NO_ANSWER"], WORDS["NOT_READY"]}:
            return
        asked = next((data[REFERENCE] for _, data in reversed(self.rig.port.sent) if data[0] == START), None)
        for message in self.rig.port.fetched:
            frame, problems = examine_frame(message)
            if problems or not isinstance(frame, VariableFrame) or not self.scenario.intact:
                continue
            way = frame.source, frame.function in WITH_DATA, message[REFERENCE]
            if way == (self.job.station.address, True, asked):
                raise ScenarioError(f"16#{status:04X}, although the reply came: {message.hex(' ').upper()}")

    def check_last(self, status: int) -> None:
        """What the diagnostics say of the last telegram and its last frame."""
        rig, job = self.rig, self.job
        numbers = [telegram.number for telegram in job.telegrams]
        number, code = rig.db.get("telegram"), self.codes.get(job.station.address, 0)
        if number != numbers[-1] if status == DONE else number not in numbers:
            raise ScenarioError(f"diagnostics.telegram is {number} at the end of telegrams {numbers}")
        if rig.db.get("functionCode") != code and not self.scenario.restarts:
            raise ScenarioError(f"diagnostics.functionCode is {rig.db.get('functionCode'):02X}h instead of {code:02X}h")

    def check_values(self) -> None:
        """Outputs hold what the station has; the station holds what was written, and its mode is the one wanted."""
        rig, job = self.rig, self.job
        for value in job.outputs:
            found, expected = rig.shown(job, value), rig.expected(job, value)
            if found != expected:
                raise ScenarioError(f"{value.member} is {found.hex(' ')}, the station has {expected.hex(' ')}")
        for value in job.values if job.kind == "write" else ():
            data = rig.inputs.get(job.pin(value.member), value.data) if not value.constant else value.data
            if rig.memory(job, value.item) != data:
                raise ScenarioError(f"{value.label} was not written")
        mode = rig.station(job).mode.value
        if job.kind in {"run", "stop"} and mode != job.kind:
            raise ScenarioError(f"the CPU is in {mode}, not in {job.kind}")

    def check_diagnostics(self, status: int) -> None:
        """Errors per address and the details for the maintenance engineer."""
        rig, scenario, job = self.rig, self.scenario, self.job
        errors = scenario.errors if status == WORDS["ITEM_ERROR"] else {}
        out_of_time = status == WORDS["TIMEOUT"]
        for position, word in enumerate(rig.errors(), 1):
            wanted = errors.get(position, 0)
            if word != wanted:
                raise ScenarioError(f"errors[{position}] is 16#{word:04X} instead of 16#{wanted:04X}")
        expected = {
            "failedItem": min(errors, default=0),
            "headerError": scenario.header if status == WORDS["REFUSED"] else 0,
            # a job whose time is over may never have got as far as the failure of its module
            "moduleStatus": rig.db.get("moduleStatus") and scenario.module if out_of_time else scenario.module,
            "job": job.number,
            "state": 0,
        }
        seen = len(job.telegrams) == 1 or status != DONE  # the figures are those of the last telegram
        if scenario.retries is not None and seen:
            expected["retries"] = scenario.retries
        if scenario.polls is not None and seen:
            expected["polls"] = scenario.polls
        for name, value in expected.items():
            if rig.db.get(name) != value and not scenario.restarts:
                raise ScenarioError(f"diagnostics.{name} is {rig.db.get(name)} instead of {value} (16#{status:04X})")

    def check_frames(self, status: int) -> None:
        """Requests are the planned telegrams in turn, FCB alternates, a repetition is the same, nothing runs twice."""
        rig, job = self.rig, self.job
        syncs = [sync.request.data for sync in rig.master.syncs if sync.station is job.station]
        planned = [rig.planned(job, telegram) for telegram in job.telegrams]
        if job.kind != "read" and job.station.address not in self.codes:
            planned = [*syncs, *planned]
        requests: list[bytes] = []
        last: bytes | None = None
        repeated = asked = 0
        for data in (data for _, data in rig.port.sent):
            frame, problems = examine_frame(data)
            if problems or not isinstance(frame, FixedFrame | VariableFrame):
                raise ScenarioError(f"sent {data.hex(' ')}: {problems[0].message if problems else 'no frame'}")
            if data == last:
                repeated += 1
                if repeated > rig.master.retries:
                    raise ScenarioError(f"{data.hex(' ')} was repeated {repeated} times")
            else:
                self.check_code(frame)
                repeated = 0
                asked = asked + 1 if isinstance(frame, FixedFrame) else 0
            last = data
            if asked > rig.master.polls:
                raise ScenarioError(f"{asked} polls of one request")
            if isinstance(frame, VariableFrame) and not repeated:
                requests.append(data)
            if repeated and self.scenario.measured:
                raise ScenarioError(f"{data.hex(' ')} was repeated although nothing was lost")
        if self.scenario.restarts:
            _planned(requests, [*syncs, *planned])
        else:
            _in_turn(requests, planned, whole=status == DONE)
        self.check_sync()
        if status not in {DONE, WORDS["ITEM_ERROR"], WORDS["REFUSED"]}:
            self.codes.pop(job.station.address, None)
        self.check_executions(status)

    def check_sync(self) -> None:
        """The table of a harmless read in front of a job is the last one that was sent."""
        for sync in self.rig.master.syncs:
            wanted = sync.request.data
            requests = [data for _, data in self.rig.port.sent if len(data) == len(wanted)]
            sent = [data for data in requests if _neutral(data) == _neutral(wanted)]
            table = bytes(self.rig.cpu.db(sync.request.home.name)[LEAD : LEAD + len(wanted)])
            if sync.station is self.job.station and sent and table != sent[-1]:
                raise ScenarioError(f'"{sync.request.home.name}" holds {table.hex(" ")}, sent was {sent[-1].hex(" ")}')

    def check_code(self, frame: FixedFrame | VariableFrame) -> None:
        """The function code of a new frame: 6Ch first, then the frame count bit alternates."""
        before = self.codes.get(frame.destination)
        wanted = FIRST if before is None else 0x5C | (~before & FCB)
        if frame.function != wanted and not self.scenario.restarts:
            raise ScenarioError(f"function code {frame.function:02X}h follows {before or 0:02X}h")
        self.codes[frame.destination] = frame.function

    def check_executions(self, status: int) -> None:
        """Nothing but a read is executed twice; a job that is done was executed."""
        job = self.job
        seen: set[bytes] = set()
        for pdu in self.rig.executed:
            if pdu in seen and pdu[10] != Function.READ:
                raise ScenarioError(f"{pdu.hex(' ')} was executed twice")
            seen.add(pdu)
        own = [pdu for pdu in seen if job.kind == "read" or pdu[10] != Function.READ]
        runs = sum(happening != "drop" for happening in self.scenario.happens.values()) + 1
        if status == DONE and not len(job.telegrams) <= len(own) <= runs * (len(job.telegrams) + 1):
            raise ScenarioError(f"{len(own)} requests were executed for {len(job.telegrams)} telegrams")


def _in_turn(requests: list[bytes], planned: list[bytes], *, whole: bool) -> None:
    """Every request is the planned telegram whose turn it is; ``whole``: all of them were sent."""
    for sent, wanted in zip(requests, planned, strict=False):
        _planned([sent], [wanted])
    _planned(requests[len(planned) :], [])
    if whole and len(requests) < len(planned):
        raise ScenarioError(f"sent were {len(requests)} requests of {len(planned)}")


def _planned(requests: list[bytes], planned: list[bytes]) -> None:
    known = {_neutral(request) for request in planned}
    for sent in requests:
        if _neutral(sent) not in known:
            raise ScenarioError(f"sent {sent.hex(' ').upper()}, which is not the planned telegram")


def _neutral(frame: bytes) -> bytes:
    """A request without what changes at run time: function code, reference, FCS."""
    image = bytearray(frame)
    image[CODE] = FIRST
    image[REFERENCE] = b"\0\0"
    image[CHECK] = 0
    return bytes(image)
