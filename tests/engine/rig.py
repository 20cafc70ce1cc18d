"""What the engine runs on in its proof: a soft CPU with the stimulus around it, three drives, places in memory."""

from __future__ import annotations

import random
from collections.abc import Iterable, Sequence

from plcgen.proof.rig import Members, Source, layout_of
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.memory import Memory
from plcgen.s7.cpu.system.port import Periphery
from plcgen.s7.layout.layout import locate
from tests.engine.errands import Errand, drive_for, parameter_bytes, random_values, store
from tests.engine.partner import DirectedDrive
from tests.engine.scenario import CALLS, EngineScenario
from tests.engine.sources import DriveEngine
from tests.engine.stimulus import LEVELS, UNIT_OF_JOB

ADDRESSES = (256, 260, 264)
OBJECTS = ((2, 3, 4), (2,), (2,))
"""Drive objects behind the address of each unit."""
SIGNALS = ("execute", "slot", "telegrams", "busy", "done", "error", "status", "started")
COUNTS = ("length", "answer", "blocks", "built", "taken", "failed", "recordStatus")
ARRAYS = ("request", "response", "expected", "errors", "infos")
ORDER = ("retries", "timeout", "pause", "once", "pinned", "requestDb", "responseDb", "responseSize")
LITTER = b"\xa5"


class JobPlace:
    """One job of the stimulus: its instance, its unit, what it does; ``values`` are the bytes it writes."""

    def __init__(self, rig: EngineRig, number: int) -> None:
        self.rig, self.number = rig, number
        self.unit = UNIT_OF_JOB[number - 1]
        letters = [f"letters[{n}].{name}" for n in (1, 2, 3) for name in (*COUNTS, *ARRAYS)]
        self.id_name = "address" if rig.classic else "hardwareId"
        paths = [*SIGNALS, *letters, *(f"order.{name}" for name in (self.id_name, *ORDER))]
        self.db = Members(rig.cpu, rig.engine.program, f"Job{number}", paths)
        self.drive_object = 2
        self.errand: Errand | None = None
        self.values: list[list[bytes]] = []

    def give(self, errand: Errand, drive_object: int = 2) -> None:
        """Say what the job does."""
        self.errand, self.drive_object = errand, drive_object
        db, rig = self.db, self.rig
        db.set("telegrams", len(errand.letters))
        db.set(f"order.{self.id_name}", ADDRESSES[self.unit - 1])
        db.set("order.once", errand.once)
        db.set("order.pinned", errand.pinned)
        db.set("order.requestDb", rig.cpu.db("PinnedRequest").number if errand.pinned else 0)
        db.set("order.responseDb", rig.cpu.db("PinnedResponse").number if errand.pinned else 0)
        db.set("order.responseSize", rig.engine.sizes.last + 1 if errand.pinned else 0)
        for number, letter in enumerate(errand.letters, 1):
            db.set(f"letters[{number}].length", letter.length)
            db.set(f"letters[{number}].answer", letter.answer)
            db.set(f"letters[{number}].blocks", len(letter.parts))
            expected = b"".join(part.expectation.to_bytes(4) for part in letter.parts)
            db.put(f"letters[{number}].expected", expected)

    def times(self, timeout: int, pause: int, retries: int) -> None:
        """Time-out and pause in ms, and retries of its orders."""
        for name, value in (("timeout", timeout), ("pause", pause), ("retries", retries)):
            self.db.set(f"order.{name}", value)

    def draw(self, values: random.Random) -> None:
        """Give the drive other values, and the job others to write."""
        if self.errand is None:
            raise ValueError("the job has nothing to do")
        parameters = self.rig.drives[self.unit - 1].objects[self.drive_object].parameters
        self.values = []
        for number, letter in enumerate(self.errand.letters, 1):
            for part in letter.parts:
                store(parameters[part.pnu], part, random_values(part, values))
            self.values.append([random_values(part, values) for part in letter.parts])
            request = letter.request(self.drive_object, self.values[-1])
            if self.errand.pinned:
                self.rig.cpu.db("PinnedRequest")[: len(request)] = request
            else:
                self.db.put(f"letters[{number}].request", request)
            spot = self.db.spots[f"letters[{number}].response"]
            self.db.memory[spot.byte : spot.byte + spot.size] = LITTER * spot.size

    def requests(self) -> list[bytes]:
        """The telegrams it must send, with reference 0."""
        letters = self.errand.letters if self.errand is not None else ()
        return [letter.request(self.drive_object, v) for letter, v in zip(letters, self.values, strict=True)]

    def written(self) -> bool:
        """Whether the drive has what the job writes."""
        parameters = self.rig.drives[self.unit - 1].objects[self.drive_object].parameters
        letters = self.errand.letters if self.errand is not None else ()
        last: dict[int, bytes] = {}
        for letter, values in zip(letters, self.values, strict=True):
            last |= {part.pnu: value for part, value in zip(letter.parts, values, strict=True)}
        return all(parameter_bytes(parameters[pnu]) == value for pnu, value in last.items())

    def has_read(self) -> bool:
        """Whether the job has what the drive holds now."""
        parameters = self.rig.drives[self.unit - 1].objects[self.drive_object].parameters
        for number, letter in enumerate(self.errand.letters if self.errand is not None else (), 1):
            response = self.db.bytes(f"letters[{number}].response", letter.answer)
            for part, (at, _) in zip(letter.parts, letter.blocks, strict=True):
                if response[at + 2 : at + 2 + part.size] != parameter_bytes(parameters[part.pnu]):
                    return False
        return True

    def words(self, name: str, letter: int) -> list[int]:
        """``errors`` or ``infos`` of a telegram."""
        return self.db.words(f"letters[{letter}].{name}", self.db.get(f"letters[{letter}].blocks"))

    def signals(self) -> tuple[bool, bool, bool, int]:
        """Busy, done, error, status."""
        db = self.db
        return db.flag("busy"), db.flag("done"), db.flag("error"), db.get("status")


class EngineRig:
    """A CPU with the program, three units and five jobs. ``db`` are the signals of job 1 for the runner."""

    def __init__(self, engine: DriveEngine, errands: Sequence[Errand], job_limit: int | None = None) -> None:
        self.engine, self.program = engine, engine.program
        self.classic = engine.dialect.classic
        self.bus = Periphery()
        self.drives = [DirectedDrive(drive_for(errands, objects)) for objects in OBJECTS]
        for address, drive in zip(ADDRESSES, self.drives, strict=True):
            self.bus.attach(address, drive)
        self.cpu = Cpu(self.program, self.bus, job_limit=job_limit)
        self.cpu.restart("cold")
        self.jobs = [JobPlace(self, number) for number in range(1, len(UNIT_OF_JOB) + 1)]
        self.plan = Members(self.cpu, self.program, "Plan", ("calls", "places", "channels", "slots", "waitLimit"))
        self.units = [self._unit(number) for number in (1, 2, 3)]
        places = [f"gate.channels[{n}].{name}" for n in (1, 2, 3) for name in ("ask", "beat", "grant")]
        self.gate = Members(self.cpu, self.program, "GateData", places, "gate.")
        self.db = Members(self.cpu, self.program, "Job1", SIGNALS)
        self.db.block = "OB1"
        self.source = Source(self.program, engine.names["channel"])
        self.scans = 0
        self.call()

    def _unit(self, number: int) -> Members:
        slots = range(1, self.engine.sizes.slots + 1)
        asks = [f"unit.asks[{n}].{name}" for n in slots for name in ("telegram", "mark", "want")]
        turn = [f"unit.turn.{name}" for name in ("slotCount", "beat", "grant", "served", "status")]
        rest = (
            "telegram",
            *(("record",) if self.classic else ()),
            "errors",
            "infos",
            "expected",
            "order",
            "turn",
            "recordStatus",
            "failed",
        )
        names = [*(f"unit.{name}" for name in (*rest, "state", "retries", "asks", "ended")), *turn, *asks]
        return Members(self.cpu, self.program, f"Unit{number}", [*names, *(f"unit.ended[{n}]" for n in slots)], "unit.")

    @property
    def ticks(self) -> int:
        """What TIME_TCK counts, without its end; a restart of the CPU begins it again."""
        return self.cpu.clock - self.cpu.time.cell[1]

    @property
    def place(self) -> tuple[str, int]:
        """The channel."""
        return self.source.file, 1

    @staticmethod
    def pin(name: str) -> str:
        """The runner looks at job 1."""
        return name

    def call(self, ob1: Iterable[int] = CALLS, ob35: Iterable[int] = (), ob82: Iterable[int] = ()) -> None:
        """Say what the organization blocks call, and in which order."""
        spot, memory = self.plan.spots["calls"], self.plan.memory
        for first, calls in zip(LEVELS.values(), (ob1, ob35, ob82), strict=True):
            data = b"".join(number.to_bytes(2) for number in calls).ljust(20, b"\0")
            memory[spot.byte + 2 * first : spot.byte + 2 * first + 20] = data

    def begin(self, scenario: EngineScenario) -> None:
        """A scenario forevery drive and the bus."""
        for drive in self.drives:
            drive.begin(scenario)
        self.bus.write_busy, self.bus.read_busy = scenario.busy

    def scan(self, milliseconds: int = 10, block: str = "OB1") -> None:
        """One scan."""
        self.scans += 1
        self.cpu.call(block, milliseconds)

    def load(self, name: str, part: str = "") -> None:
        """Load a data block, or the part of it with a name, into the CPU again: it has its start values."""
        entry = self.program.link.find(name)
        if entry is None:
            raise KeyError(name)
        image, memory = self.program.images[entry.index], self.cpu.db(name)
        first, size = 0, len(image)
        if part:
            found = locate(layout_of(self.program, name), part)
            first, size = found.byte, (found.size + 7) // 8
        memory[first : first + size] = image[first : first + size]
        if not part:
            self.cpu.records.abandon(memory)

    def bytes_of(self, name: str) -> Memory:
        """A data block."""
        return self.cpu.db(name)
