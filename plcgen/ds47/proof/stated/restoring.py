"""What a job does with the old values when it fails after its write (docs/generated-code.md, "A job that restores")."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from plcgen.ds47.proof.stated.nominal import RUNS_BITS, STATE
from plcgen.ds47.proof.stated.rig import StatedRun
from plcgen.ds47.proof.stated.scene import Scene
from plcgen.oracles.spec.ds47.boundaries import nearest
from plcgen.oracles.spec.ds47.recorder import HeardTelegram, Key
from plcgen.oracles.spec.ds47.statement import StatedAccess
from plcgen.oracles.spec.ds47.types import is_float, packed, unpacked

REFUSED, DEVIATES, RESTORED, NOT_RESTORED, RUNS, LEFT = 0x8401, 0x8503, 0x8530, 0x8531, 0x8532, 0x8533
"""Status words (docs/generated-code.md, "status")."""
STATE_ERROR = 0x11
OPERATION, PULSES = 1 << 2, 1 << 11
WORD = 0xFFFF


@dataclass
class Failing:
    """One run that fails: what the drive does, and how the job must end.

    ``refuse`` refuses the last parameter, otherwise its last value is another one; ``state`` is r0899, ``other``
    somebody else changes the first value once it was read back, ``stubborn`` refuses the old values.
    """

    scene: Scene
    status: int
    refuse: bool = False
    state: int = WORD & ~RUNS_BITS
    other: bool = False
    stubborn: bool = False
    old: dict[Key, bytes] = field(default_factory=dict)
    left: dict[Key, bytes] = field(default_factory=dict)
    taken: dict[Key, bytes] = field(default_factory=dict)
    """What the drive had when it had answered the write."""
    writes: list[HeardTelegram] = field(default_factory=list)
    reads: int = 0

    @property
    def written(self) -> Sequence[StatedAccess]:
        """What the job writes."""
        return self.scene.job.steps[1].accesses

    def keys(self, access: StatedAccess) -> list[Key]:
        """The values of a parameter."""
        return [self.scene.key(access.number, access.index + at) for at in range(access.count)]

    def run(self) -> StatedRun:
        """The run."""
        run = self.scene.run(self.ends, before=self.before)
        run.course, run.hears = None, self.hears
        return run

    def before(self) -> None:
        """The old values are there; the drive will do something else with the last one."""
        values = self.scene.device.values
        values[self.scene.key(STATE, 0)] = self.state.to_bytes(2)
        self.old = {key: values[key] for access in self.written for key in self.keys(access)}

    def hears(self, telegram: HeardTelegram) -> dict[Key, bytes]:
        """The first write goes wrong; what comes afterwards is the restoring."""
        device, last = self.scene.device, self.written[-1]
        owner = self.scene.job.drive.drive_object
        device.turns, device.refuses = {}, {}
        if telegram.write:
            self.writes.append(telegram)
            if self.stubborn and len(self.writes) > 1:
                device.refuses = {(True, owner, access.number): STATE_ERROR for access in self.written}
            elif len(self.writes) == 1 and self.refuse:
                device.refuses = {(True, owner, last.number): STATE_ERROR}
            elif len(self.writes) == 1:
                device.turns = {self.keys(last)[-1]: lambda data: turned(last, data)}
        elif self.writes:
            self.taken = self.taken or dict(device.values)
            self.reads += 1
            if self.other and self.reads == (1 if self.refuse else 2):
                key = self.keys(self.written[0])[0]
                self.left[key] = device.values[key] = turned(self.written[0], device.values[key], 3)
        return {}

    def ends(self, run: StatedRun) -> None:
        """Status, cause, what was written back, what the drive has."""
        scene = self.scene
        when = f"when {'a refusal' if self.refuse else 'a value'} makes it restore with r0899 = 16#{self.state:04X}"
        scene.found += scene.complaints(run)
        if self.status == NOT_RESTORED and not self.to_restore():
            self.status = RESTORED  # the drive has the old values anyway
        if not scene.status(run, self.status, when=when):
            return
        cause = scene.rig.cpu[f"{scene.rig.member(scene.job)}.cause"]
        wanted = REFUSED if self.refuse else DEVIATES
        scene.demand(scene.job.place, f"cause 16#{wanted:04X} {when}", f"16#{cause:04X}", good=cause == wanted)
        self.check_values()
        self.check_telegrams(run)

    def check_values(self) -> None:
        """Old values, but what somebody else has changed; all of them new while it runs or refuses."""
        if self.status in {RUNS, NOT_RESTORED}:
            return
        values = self.scene.device.values
        for access in self.written:
            if any(key in self.left for key in self.keys(access)):
                continue  # of which somebody else has changed a value: all of it is left alone
            for key in self.keys(access):
                expected = self.old[key]
                good = values[key] == expected
                found = values[key].hex(" ").upper()
                said = f"{access.number} = {expected.hex(' ').upper()} again"
                self.scene.demand(access.place, said, found, good=good)

    def check_telegrams(self, run: StatedRun) -> None:
        """Nothing but old values is written back, just after the drive was asked, and then it is asked again."""
        place = self.scene.job.place
        back = self.writes[1:]
        nothing = self.status == RUNS or not self.to_restore()
        self.scene.demand(place, "no write back", f"{len(back)} writes", good=not (nothing and back))
        if nothing or not back:
            self.scene.demand(place, "the old values written back", "no write", good=nothing)
            return
        position = run.heard.index(back[0])
        asked = {access.number for access in run.heard[position - 1].accesses}
        state = self.scene.job.restore == "stopped"
        good = not run.heard[position - 1].write and (STATE in asked or not state)
        self.scene.demand(place, "r0899 asked for just before the old values are written", "it was not", good=good)
        sent = {(one.number, one.index) for one in back[0].accesses}
        wanted = self.to_restore()
        self.scene.demand(place, f"{sorted(wanted)} written back", f"{sorted(sent)}", good=sent == wanted)

    def to_restore(self) -> set[tuple[int, int]]:
        """Parameters that the drive took from this job, and that nobody else has changed."""
        found = set()
        for access in self.written:
            keys = self.keys(access)
            if not any(key in self.left for key in keys) and any(self.taken.get(k) != self.old[k] for k in keys):
                found.add((access.number, access.index))
        return found


def turned(access: StatedAccess, data: bytes, units: int = 0) -> bytes:
    """Another value than the one that was written; ``units`` on, yet another one."""
    if access.bits:
        own = [bit for bit, _ in access.bits]
        other = next(bit for bit in range(8 * len(data)) if bit not in own)
        return (int.from_bytes(data) ^ 1 << (other if units else own[0])).to_bytes(len(data))
    if access.string:
        return bytes((data[0] ^ (2 if units else 1),))
    step = units or (2 if is_float(access.type) else 1)
    return packed(access.type, nearest(access.type, unpacked(access.type, data), step))


def restoring_runs(scene: Scene) -> Iterator[Sequence[StatedRun]]:
    """Refused, deviating, running, changed by somebody else, refused again."""
    stopped = scene.job.restore == "stopped"
    several = len(scene.job.steps[1].accesses) > 1
    yield [Failing(scene, RESTORED, refuse=True).run()]
    yield [Failing(scene, RESTORED).run()]
    for state in (OPERATION, PULSES, WORD):
        yield [Failing(scene, RUNS if stopped else RESTORED, state=state).run()]
    yield [Failing(scene, LEFT, other=True).run()]
    if several:
        yield [Failing(scene, NOT_RESTORED, refuse=True, stubborn=True).run()]
    yield [Failing(scene, NOT_RESTORED, stubborn=True).run()]
