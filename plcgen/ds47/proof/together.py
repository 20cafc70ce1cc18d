"""What all instances do together, through OB1."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import permutations, zip_longest

from plcgen.ds47.plan.nouns import DriveCaller, DriveJob, DrivePlan, PlannedUnit
from plcgen.ds47.proof.instances import ThreeInstances
from plcgen.ds47.proof.pace import Pace
from plcgen.ds47.proof.partner import ScriptedDrive
from plcgen.ds47.proof.plant import Plant
from plcgen.ds47.proof.points import soon_out_of_retries
from plcgen.ds47.proof.restoration import OUTCOMES
from plcgen.ds47.proof.scenario import DriveScenario
from plcgen.ds47.proof.sections import LARGE, PlantSection, plant_sections
from plcgen.ds47.proof.stimulus import own_dbs, pair_fb
from plcgen.ds47.proof.words import DONE, STEP_MS, WORDS
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.sim.faults import Fault, FaultKind
from plcgen.proof.rig import Members, Source, layout_of
from plcgen.proof.scenario import IDLE, ScenarioError
from plcgen.proof.suite import Procedure, Reads
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.system.record import PLACES, RecordPlaces
from plcgen.s7.layout.layout import locate
from plcgen.s7.types.blocks import BlockKind

STRIDE = 61
"""Points of OB1 between interrupts of one scan and the next."""
ROUNDS = 3
"""So often every job must have ended when all are started again and again."""
POINTS = (1, 2, 4, 7, 11, 16)
"""Scans behind the start at which something happens to all jobs."""
OFFSETS = range(28)
"""Scans between the starts of two instances on one unit."""
FEW = 4
"""Of so many job blocks two instances start at all of the offsets, of the others at so many of them."""
SOME, MANY = 12, 60
"""Of more instances less points are tried; of even more no two OBs and masters."""
PAIRED = 8
"""So many jobs of a unit follow each other in every order."""
AWAY_MS = 10_000
LOADED = frozenset({DONE, *(WORDS[name] for name in ("LOST", "SLOT_TAKEN", "STILL_DRAINING", "UNKNOWN"))})
"""How a job may end while something of the engine is loaded again."""
REFUSED = frozenset({WORDS["PARAMETER_ERROR"]})
"""How a change may end besides, where a drive saves for a job that is not there any more: the drive takes none then."""
GONE = frozenset({DONE, *(WORDS[name] for name in ("WRITE_ERROR", "READ_ERROR"))})
"""How a job may end whose drive goes away."""


def procedures(plan: DrivePlan, plant: Callable[[str, PlantSection], Plant]) -> Iterator[Procedure]:
    """What the jobs do to each other; ``plant`` gives a plant, everything in it fresh, with values by a name."""
    whole = PlantSection(plan)
    for number, job in enumerate(plan.shapes, 1):
        for near in OFFSETS if number <= FEW else OFFSETS[:: len(OFFSETS) // FEW]:
            name = f"{job.shape}: other instances on the same and on another unit, {near} scans later"
            caller = pair_fb(number)
            reads = Reads((caller, f"{caller}_DB", *own_dbs(number), job.block.name), (plan.target, job))
            yield Procedure(name, partial(plant, name, whole), _instances(job, number, near), reads)
    name = "what the caller passes"
    yield Procedure(name, partial(plant, name, whole), _arguments, None)
    for section in plant_sections(plan):
        for what, run in (*_ORDINARY, *(_disturbed(section.plan, plan) if section.outer else ())):
            name = f"{section.name}{what}"
            yield Procedure(name, partial(plant, name, section), run, None)


def _disturbed(plan: DrivePlan, whole: DrivePlan) -> Iterator[tuple[str, Callable[[Plant], None]]]:
    """What happens to all jobs at the same time."""
    few = len(whole.jobs) <= MANY
    yield "all jobs again and again", _again_and_again
    if few:
        yield "every job takes its unit over from every other", _take_over
    yield "all jobs while other programs take half of the record jobs of the CPU", _crowded
    if few:
        if _twice(plan):
            yield "another caller in OB35 interrupts OB1", _two_obs
        yield "two masters have the same units", _two_masters
    for scans in points(whole):
        for kind in ("cold", "warm"):
            yield f"{kind} restart {scans} scans behind the start of all jobs", _restart(kind, scans)
        yield f"all drives go away {scans} scans behind the start and come back", _away(scans)
        yield f"all drives are switched off and on {scans} scans behind the start", _off(scans)
        yield f"OB1 is not called for 10 s, {scans} scans behind the start", _not_called(scans)
        calls, gate = [caller.instance.name for caller in plan.callers], plan.engine.gate_db.name
        units = [unit.db.name for unit in plan.units]
        several = [(name, [name]) for name in dict.fromkeys((calls[0], calls[-1]))]
        for what, names in (*several, ("units", units), (gate, [gate]), ("everything", [*calls, gate, *units])):
            yield f"{what} loaded again {scans} scans behind the start of all jobs", _loaded(names, scans)


def points(plan: DrivePlan) -> tuple[int, ...]:
    """When something happens to all jobs: the more there are, the less often."""
    return POINTS if len(plan.jobs) <= SOME else POINTS[1::2] if len(plan.jobs) <= MANY else POINTS[2:3]


def left_out_together(plan: DrivePlan) -> list[str]:
    """What is not run in a large plan."""
    tried, blocks = points(plan), len(plan.shapes)
    found = []
    if tried != POINTS:
        shown = ", ".join(map(str, tried))
        found.append(f"restarts, downloads and lost drives only {shown} scans after the start of all jobs")
    if blocks > FEW:
        found.append(f"other instances of {blocks - FEW} job blocks at {FEW} of {len(OFFSETS)} start offsets")
    if len(plan.jobs) > LARGE:
        found.append("jobs of several callers at a time; of all callers but two anything but single runs of their jobs")
    if len(plan.jobs) > MANY:
        found.append("another caller in OB35; two masters; jobs of a unit in every order")
    elif any(len(jobs) > PAIRED for jobs in _by_unit(plan)):
        found.append(f"more than {PAIRED} jobs of a unit in every order")
    return found


def may_be_unknown(job: DriveJob, status: int) -> bool:
    """Well, or a trigger of which nobody knows whether the drive took it."""
    return status == DONE or (job.once and status == WORDS["UNKNOWN"])


def tried_to_restore(job: DriveJob, status: int) -> bool:
    """A job that restores has failed behind its write, or while it saved."""
    return job.restores and (status in OUTCOMES or (job.guarded and status == WORDS["NOT_SAVED"]))


# --- arguments --------------------------------------------------------------------------------------------


def _arguments(plant: Plant) -> None:
    """Behind one call every instance has the inputs that the spec wants."""
    plan = plant.plan
    plant.step()
    _access(plan, plant.program)
    slots: dict[str, set[int]] = {}
    for caller, unit in ((one, unit) for one in plan.callers for unit in plan.channels(one)):
        index = unit.record_index
        wanted = {"slots": plan.slots(unit), "waitLimit": unit.wait, "recordIndex": index}
        if plan.target.classic:
            wanted["recordIndex"] = (index & 0x7FFF) - (index & 0x8000)
            wanted["unitDb"] = plant.cpu.db(unit.db.name).number
        _passed(plant, caller, unit.member, wanted, unit.key)
        slots[unit.key] = set()
    for job in plan.jobs:
        drive = job.drive
        own = {"hardwareId" if plan.target.t15 else "driveAddress": drive.id_value}
        _passed(plant, job.caller, job.member, {**own, "driveObject": drive.drive_object, "slot": job.slot}, job.key)
        if job.slot in slots[drive.unit.key] or not 1 <= job.slot <= plan.slots(drive.unit):
            raise ScenarioError(f"slot {job.slot} of {drive.unit.key} is not for {job.key} alone")
        slots[drive.unit.key].add(job.slot)
        for name, buffer in (("requestDb", job.telegrams[0].request), ("responseDb", job.telegrams[0].response)):
            if buffer.db is not None:
                _passed(plant, job.caller, job.member, {name: plant.cpu.db(buffer.db.name).number}, job.key)
    _gate(plant)


def _passed(plant: Plant, caller: DriveCaller, member: str, wanted: dict[str, int], key: str) -> None:
    """Inputs of an instance in its caller."""
    try:
        found = Members(plant.cpu, plant.program, caller.instance.name, [f"{member}.{name}" for name in wanted])
    except KeyError as problem:
        raise ScenarioError(f"{key}: {problem.args[0]}") from None
    for name, right in wanted.items():
        signed = name in {"waitLimit", "recordIndex"} and right < 0
        value = found.get(f"{member}.{name}", signed=signed)
        if value != right:
            raise ScenarioError(f"{name} of {key} is {value} instead of {right}")


def _gate(plant: Plant) -> None:
    """The gate has a place for every channel, and gives no more places than the CPU has record jobs."""
    first = plant.plan.callers[0]
    calls, name = first.instance.name, plant.plan.channels(first)[0].member
    layout = layout_of(plant.program, calls)
    channel = locate(layout, name)
    gate = next(e for e in layout.entries if e.depth == 0 and e.path != name)
    assert channel.byte > gate.byte  # the gate is called first
    found = Members(plant.cpu, plant.program, calls, [f"{gate.path}.places", f"{gate.path}.channels"])
    places, channels = found.get(f"{gate.path}.places"), found.get(f"{gate.path}.channels")
    limit = PLACES[plant.cpu.family]
    most = limit.total or limit.each or 0
    if channels != len(plant.plan.units) or not 1 <= places <= most:
        raise ScenarioError(
            f"the gate has {channels} channels and {places} places, not {len(plant.plan.units)}, {most}"
        )
    data = plant.plan.engine.gate_db
    beats = [f"gate.channels[{number}].beat" for number in range(1, channels + 1)]
    alive = Members(plant.cpu, plant.program, data.name, beats)
    for number, beat in enumerate(beats, 1):
        if not alive.get(beat):
            raise ScenarioError(f"no channel has place {number} of the gate")


def _access(plan: DrivePlan, program: Program) -> None:
    """All blocks that share data have one kind of access: else an IN_OUT is a copy."""
    if not plan.target.t15:
        return
    names = {ref.name.upper() for ref in plan.blocks}
    for name, entry in program.link.blocks.items():
        if name in names and entry.block.kind in {BlockKind.FB, BlockKind.DB} and entry.block.optimized is not False:
            raise ScenarioError(f'"{entry.name}" has optimized access: an IN_OUT to it would be a copy')


# --- more than the caller ---------------------------------------------------------------------------------


def _instances(job: DriveJob, number: int, near: int) -> Callable[[Plant], None]:
    def run(plant: Plant) -> None:
        source = Source(plant.program, job.block.name)
        plant.place = source.file, source.line
        for _ in ThreeInstances(plant.plan, plant.program, plant.cpu, job, number).run(near, near // 2):
            plant.scans += 1

    return run


def _twice(plan: DrivePlan) -> list[tuple[int, DriveJob]]:
    """Jobs that another caller may have too, with their numbers: not what puts inputs into a data block of its own."""
    return [(number, job) for number, job in enumerate(plan.shapes, 1) if not job.pinned or not job.inputs]


def _two_obs(plant: Plant) -> None:
    """A caller by hand in an OB that interrupts, at another point of OB1 in every scan: each has units of its own."""
    main = plant.program.main()
    if main is None:
        raise ScenarioError("there is no cyclic OB")
    number, job = _twice(plant.plan)[0]
    trio = ThreeInstances(plant.plan, plant.program, plant.cpu, job, number)
    plant.launch()
    passed = len(plant.cpu.run(main.name, 0, interrupt={}).points)
    waiting = set(plant.plan.jobs)
    for scan in range(plant.patience + trio.patience):
        plant.scans += 1
        trio.begin(scan)
        plant.hold()
        chosen = {
            scan * STRIDE % max(passed, 1): trio.block,
            (scan * STRIDE + passed // 2) % max(passed, 1): trio.block,
        }
        passed = len(plant.cpu.run(main.name, 10, interrupt=chosen).points)
        if plant.cpu.misuses or plant.cpu.faulted:
            raise ScenarioError("misuse")
        waiting = {job for job in waiting if not plant.ended_well(job)}
        if not waiting and trio.over:
            break
    else:
        raise ScenarioError("not every job came to its end")
    trio.check()
    plant.check()


def _two_masters(plant: Plant) -> None:
    """Each master has a channel of its own in a device: both CPUs run all jobs at the same time."""
    other = Plant(plant.plan, plant.program)
    for key, unit in plant.units.items():
        mirror = ScriptedDrive(Drive(unit.own, unit.objects.values()))
        other.units[key], mirror.asked = mirror, other.units[key].asked
    other.fresh(plant.name)
    both = (plant, other)
    for one in both:
        one.begin()
        one.start()
    waiting = {(one, job) for one in both for job in plant.plan.jobs}
    for _ in range(plant.patience):
        for one in both:
            one.step()
        waiting = {(one, job) for one, job in waiting if not _ended_with_another(one, job)}
        if not waiting:
            break
    else:
        raise ScenarioError("not every job came to its end")
    for one in both:
        one.check()


def _ended_with_another(plant: Plant, job: DriveJob) -> bool:
    """Whether a job has ended beside another master, whose values it may read back. Raises ScenarioError."""
    over, status = plant.result(job)
    disturbed = job.verified and status == WORDS["DEVIATES"]
    disturbed |= tried_to_restore(job, status)
    disturbed |= job.waits and status == WORDS["NOT_REACHED"]
    return (over and disturbed) or plant.ended_well(job)


# --- all jobs ---------------------------------------------------------------------------------------------


def _as_delivered(plant: Plant) -> None:
    """No job starts on its own but those with a cycle; started, they send what the start values say."""
    plant.begin(delivered=True)
    plant.step(ROUNDS)
    alone = {job.key for job in plant.plan.jobs if job.cycle and job.trigger.execute is None}
    for job in plant.plan.jobs:
        if (plant.result(job) == (False, IDLE)) == (job.key in alone):
            raise ScenarioError(f"{job.key} {'does not start' if job.key in alone else 'starts'} on its own")
    if not alone and any(drive.journal for drive in plant.units.values()):
        raise ScenarioError("something is sent although no job was started")
    plant.start()
    plant.until(lambda _, status: status == DONE, plant.patience)
    plant.check()
    plant.fall()


def _one_by_one(plant: Plant) -> None:
    """Commands, inputs and results of every job travel through OB1, with good answers and with errors."""
    plant.all_done()
    fault = Fault(FaultKind.ERROR, times=None, number=0x11, position=1, words=1)
    plant.begin(DriveScenario(name="OB1", faults=(fault,)))
    plant.start()
    plant.until(lambda _, status: status == WORDS["PARAMETER_ERROR"], plant.patience)
    for job in plant.plan.jobs:
        plant.check_failed(job)
    plant.fall()


def _again_and_again(plant: Plant) -> None:
    """Every job is started again as soon as it has ended: each gets its turn, one request at a time."""
    jobs = plant.plan.jobs
    ended = dict.fromkeys((job.key for job in jobs), 0)
    plant.launch()
    pace = Pace(plant.cpu, plant.units.values())
    for _ in range(plant.patience * (ROUNDS + 1)):
        plant.step(1, pace.length())
        for job in jobs:
            over, status = plant.result(job)
            if over and status != DONE:
                raise ScenarioError(f"{job.key} ends with 16#{status:04X}")
            ended[job.key] += over
            plant.execute(job, value=not over)
        if min(ended.values()) >= ROUNDS:
            break
    else:
        last = min(ended, key=ended.__getitem__)
        raise ScenarioError(f"{last} has ended {ended[last]} times only")
    for unit in plant.plan.units:
        plant.exchanges(unit)
        _fair(unit, [ended[job.key] for job in jobs if job.drive.unit is unit and not job.waits])


def _fair(unit: PlannedUnit, counts: list[int]) -> None:
    if counts and max(counts) - min(counts) > 1 and len(counts) > 1:
        raise ScenarioError(f"the jobs of {unit.key} have ended {counts} times: they do not take turns")


def _by_unit(plan: DrivePlan) -> list[list[DriveJob]]:
    return [[job for job in plan.jobs if job.drive.unit is unit] for unit in plan.units]


def _take_over(plant: Plant) -> None:
    """The second of each pair asks while the first has the unit; all units do this at the same time."""
    pairs = [list(permutations(jobs[:PAIRED], 2)) for jobs in _by_unit(plant.plan) if len(jobs) > 1]
    for turn in zip_longest(*pairs):
        chosen = [pair for pair in turn if pair is not None]
        plant.begin()
        for behind in (0, 1):
            for pair in chosen:
                plant.execute(pair[behind])
            plant.step()
        jobs = [job for pair in chosen for job in pair]
        plant.until(lambda _, status: status == DONE, plant.patience, jobs)
        for unit in plant.plan.units:
            exchanges = plant.exchanges(unit)
            for job in jobs:
                if job.drive.unit is unit:
                    plant.check_job(job, exchanges)
        plant.fall()


def _crowded(plant: Plant) -> None:
    """Refused record calls (80C3) are repeated and use up no retries."""
    limit = PLACES[plant.cpu.family]
    half = max(1, (limit.total or limit.each or 2) // 2)
    plant.cpu.records.places = RecordPlaces(total=half)
    plant.launch()
    few = len(plant.plan.units) <= 2 * half
    late = frozenset() if few else frozenset(WORDS[name] for name in ("TIMEOUT", "NO_PLACE", "OCCUPIED"))
    longest = max(job.timeout for job in plant.plan.jobs) // 10
    plant.until(
        lambda job, status: status == DONE or status in late or (bool(late) and tried_to_restore(job, status)),
        plant.patience * 8 + (0 if few else 8 * longest),
    )
    plant.fall()
    plant.fresh(f"{plant.name}, once more").all_done()


def _then_all_is_well(plant: Plant) -> None:
    """Whatever happened: behind it every job works."""
    for job in plant.plan.jobs:
        plant.execute(job, value=False)
    pace = Pace(plant.cpu, plant.units.values())
    for _ in range(plant.patience * 4):
        plant.step(1, pace.length())
        if not any(plant.get(job, "busy") for job in plant.plan.jobs):
            break
    plant.fall()
    plant.all_done()


def _restart(kind: str, scans: int) -> Callable[[Plant], None]:
    def run(plant: Plant) -> None:
        plant.launch(scans)
        plant.cpu.restart("cold" if kind == "cold" else "warm")
        _then_all_is_well(plant)

    return run


def _away(scans: int) -> Callable[[Plant], None]:
    def run(plant: Plant) -> None:
        plant.launch(scans)
        plant.cpu.bus.drives.clear()
        for drive in plant.units.values():
            drive.switch_off()
        plant.until(lambda job, status: status in GONE or tried_to_restore(job, status), plant.patience * 4)
        plant.connect()
        _then_all_is_well(plant)

    return run


def _off(scans: int) -> Callable[[Plant], None]:
    """The requests are lost: built and sent again."""

    def run(plant: Plant) -> None:
        plant.launch(scans)
        for drive in plant.units.values():
            drive.switch_off()
        longest = max(job.timeout for job in plant.plan.jobs) // 10
        late = frozenset(WORDS[name] for name in ("RETRIES", "TIMEOUT", "NO_PLACE"))
        few = {job.key for job in plant.plan.jobs if soon_out_of_retries(job)}
        few |= {job.key for job in plant.plan.jobs if job.timeout // 3 + 2 * (job.retry_pause + 100) >= job.timeout}
        # a job whose request is lost may keep the unit for its timeout: others wait for it no longer than waitLimit
        behind = {
            job.key
            for jobs in _by_unit(plant.plan)
            for job in jobs
            if any(other is not job and other.timeout > job.drive.unit.wait for other in jobs)
        }
        plant.until(
            lambda job, status: (
                may_be_unknown(job, status)
                or (job.key in few and (status in late or tried_to_restore(job, status)))
                or (job.key in behind and status == WORDS["OCCUPIED"])
            ),
            plant.patience + longest,
        )
        _then_all_is_well(plant)

    return run


def _not_called(scans: int) -> Callable[[Plant], None]:
    """Time passes, record jobs end, and nobody looks."""

    def run(plant: Plant) -> None:
        plant.launch(scans)
        plant.cpu.clock += AWAY_MS
        plant.cpu.bus.advance(AWAY_MS)
        for _ in range(ROUNDS):
            plant.cpu.records.advance()
        short = {job.key for job in plant.plan.jobs if job.timeout < 2 * STEP_MS}
        late = {WORDS["TIMEOUT"], WORDS["NO_PLACE"]}
        plant.until(
            lambda job, found: (
                may_be_unknown(job, found) or (job.key in short and (found in late or tried_to_restore(job, found)))
            ),
            plant.patience,
        )
        if not short:
            plant.check()
        _then_all_is_well(plant)

    return run


def _loaded(names: list[str], scans: int) -> Callable[[Plant], None]:
    """Data blocks have their start values again; record jobs go on in the CPU.

    On an S7-300/400 the bytes that WRREC sends lie in the unit: that they change is the download's doing.
    """

    def run(plant: Plant) -> None:
        plant.launch(scans)
        for name in names:
            entry, memory = plant.program.link.find(name), plant.cpu.db(name)
            if entry is None:
                raise ScenarioError(f'"{name}" is missing')
            plant.cpu.records.abandon(memory)
            memory[:] = plant.program.images[entry.index]
        plant.forgiven = frozenset({"PG830"}) if plant.plan.target.classic else frozenset()
        longest = max(job.timeout for job in plant.plan.jobs) // 10
        allowed = LOADED | (REFUSED if any(job.poll is not None for job in plant.plan.jobs) else frozenset())
        plant.until(
            lambda job, status: status in allowed or tried_to_restore(job, status), plant.patience * 2 + longest
        )
        plant.forgiven = frozenset()
        _then_all_is_well(plant)

    return run


_ORDINARY = (
    ("every job through OB1", _one_by_one),
    ("every job with the values as delivered", _as_delivered),
)
"""What every job goes through."""
