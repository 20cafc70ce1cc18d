"""What the proof adds to a generated program: callers written by hand for every job block, on units of their own.

A job block is executed once, whatever the number of its instances: its caller has the engine as it lies in the folder,
a gate, one channel and the job; a second caller has three instances of it on two units. Inputs that no call passes are
put into the instances directly. With ``jobsOnly`` a call is that of a faster OB, which gate and channels are not in.
TIA SCL; other spellings are made from it.
"""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.s7.scl.classic import Spelling, respell

FILE = "proof of the drive jobs.scl"
UNITS = ("ProofUnit1", "ProofUnit2")
GATE_DB = "ProofGateData"
SLOTS = 3
"""Slots of the units in use."""
_HEAD = "{ S7_Optimized_Access := 'FALSE' }\nVERSION : 0.1"
_DB_HEAD = f"{_HEAD}\nNON_RETAIN"


def shape_fb(number: int) -> str:
    """The caller of one job; its instance DB has ``_DB`` behind the name."""
    return f"ProofShape{number}"


def pair_fb(number: int) -> str:
    """The caller of two jobs on one unit and one on another."""
    return f"ProofPair{number}"


def own_dbs(number: int) -> tuple[str, str]:
    """Request and response DB of the second and third instance of a job with data blocks of its own."""
    return f"ProofRequest{number}", f"ProofResponse{number}"


def stimulus(plan: DrivePlan) -> str:
    """The text for every job block of a plan."""
    spelling = Spelling.STEP7_V5 if plan.target.v5 else Spelling.NO_REGIONS if plan.target.classic else Spelling.TIA
    parts = [
        _data(GATE_DB, "gate", plan.engine.gate_type.name),
        *(_data(u, "unit", plan.engine.unit.name) for u in UNITS),
    ]
    for number, job in enumerate(plan.shapes, 1):
        parts += _own(number, job)
        telegram = job.telegrams[0]
        dbs = telegram.request.home.name, telegram.response.home.name
        one = _caller(plan, job, shape_fb(number), {"job": (0, 1, dbs)})
        extra = own_dbs(number)
        two = _caller(plan, job, pair_fb(number), {"job": (0, 1, dbs), "near": (0, 2, extra), "far": (1, 1, extra)})
        parts += [one, two]
    instances = [
        _instance(name(n), v5=plan.target.v5) for n in range(1, len(plan.shapes) + 1) for name in (shape_fb, pair_fb)
    ]
    return "\n".join((respell("\n".join(parts), spelling), *instances))


def _own(number: int, job: DriveJob) -> Iterator[str]:
    if job.pinned:
        telegram = job.telegrams[0]
        for name, size in zip(own_dbs(number), (len(telegram.request.data), telegram.response.size), strict=True):
            yield _data(name, "bytes", f"Array[0..{size - 1}] of Byte", quoted=False)


def _data(name: str, member: str, type_: str, *, quoted: bool = True) -> str:
    shown = f'"{type_}"' if quoted else type_
    return f'DATA_BLOCK "{name}"\n{_DB_HEAD}\nSTRUCT\n  {member} : {shown};\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'


def _caller(plan: DrivePlan, job: DriveJob, name: str, jobs: dict[str, tuple[int, int, tuple[str, str]]]) -> str:
    """A caller; of every job: its unit, its slot, its data blocks if it has any."""
    engine = plan.engine
    units = sorted({unit for unit, _, _ in jobs.values()})
    declared = ["jobsOnly : Bool;", f'gate : "{engine.gate.name}";']
    declared += [f'channel{unit} : "{engine.channel.name}";' for unit in units]
    declared += [f'{key} : "{job.block.name}";' for key in jobs]
    declared += [f'{key}Diagnosis : "{job.diagnosis.name}";' for key in jobs]
    if job.recipe is not None:
        type_ = f'Array[1..{job.recipe.count}] of "{job.recipe.type.name}"'
        declared += [f"{key}Records : {type_};" for key in jobs]
    gate = f'#gate(places := 4, channels := {len(units)}, gate := "{GATE_DB}".gate);'
    calls = [f"IF NOT #jobsOnly THEN {gate} END_IF;"]
    for key, (unit, _, (request, response)) in jobs.items():
        own = f'requestDb := "{request}", responseDb := "{response}", ' if job.pinned else ""
        own += "" if job.recipe is None else f"records := #{key}Records, "
        own += f'numbers := "{job.permitted.db.name}".numbers, ' if job.permitted is not None else ""
        own += f"diagnosis := #{key}Diagnosis, "
        calls.append(f'#{key}({own}unit := "{UNITS[unit]}".unit);')
    calls.append("IF NOT #jobsOnly THEN")
    for unit in units:
        db = f', unitDb := "{UNITS[unit]}"' if plan.target.classic else ""
        calls.append(
            f"#channel{unit}(slots := {SLOTS}{db}, "
            f'unit := "{UNITS[unit]}".unit, place := "{GATE_DB}".gate.channels[{unit + 1}]);'
        )
    calls.append("END_IF;")
    lines = "\n  ".join(declared)
    body = "\n".join(calls)
    return f'FUNCTION_BLOCK "{name}"\n{_HEAD}\nVAR\n  {lines}\nEND_VAR\nBEGIN\n{body}\nEND_FUNCTION_BLOCK\n'


def _instance(block: str, *, v5: bool) -> str:
    if v5:
        return f'DATA_BLOCK "{block}_DB" "{block}"\nBEGIN\nEND_DATA_BLOCK\n'
    return f'DATA_BLOCK "{block}_DB"\n{_DB_HEAD}\n"{block}"\nBEGIN\nEND_DATA_BLOCK\n'
