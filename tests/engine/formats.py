"""Nominal runs of every format, telegrams in data blocks of their own, many jobs in a row, wrong numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import permutations

from plcgen.ds47.proof.words import COUNTERS, WORDS
from plcgen.proof.rig import Members
from plcgen.proof.runner import Runner
from plcgen.proof.scenario import ScenarioError, Statistics
from tests.engine.answer_faults import AnswerForm, types_of_a_size, wider_integers
from tests.engine.conduct import EngineConduct
from tests.engine.end import following
from tests.engine.errands import (
    READ_ONE,
    READ_OPEN,
    READ_PINNED,
    WRITE_ONE,
    WRITE_PINNED,
    Errand,
    Letter,
    every_format,
    full,
)
from tests.engine.field import JobField
from tests.engine.open_answers import open_answers
from tests.engine.partner import STATE_CONFLICT
from tests.engine.scenario import CALLS, EngineScenario
from tests.engine.stimulus import WRONG_UNIT_DB

ROW = 600
MANY = 70_000
Run = Callable[[JobField], None]


def formats(*, classic: bool, many: bool = False) -> Iterator[tuple[str, Run]]:
    """Names and procedures; ``many`` runs 70,000 jobs in a row."""
    yield "reads and writes of every format", _every_format
    yield "every type instead of every other of its size", _other_types
    yield "integers in wider formats", _wider
    yield "types that come from the answer", _open
    yield "full records, all parameters, the last slot", _full
    yield "telegrams in data blocks of their own", _pinned
    yield f"{ROW} jobs in a row", _row
    if many:
        yield f"{MANY:,} jobs in a row on one instance", _many
    if classic:
        yield "unitDb is another data block", _wrong_db


def _run(field: JobField, errand: Errand, *scenarios: EngineScenario) -> None:
    """Scenarios of one job on the CPU of a field. Raises ScenarioError."""
    _attempt(field, EngineConduct(field.rig, errand), *scenarios)


def _attempt(field: JobField, conduct: EngineConduct, *scenarios: EngineScenario) -> None:
    """Scenarios of a job that was set up. Raises ScenarioError."""
    runner = Runner(conduct, Statistics())
    for scenario in scenarios:
        failure = runner.try_run(scenario)
        field.rig.scans += failure.scan if failure is not None else 1
        if failure is not None:
            raise ScenarioError(str(failure))


def _every_format(field: JobField) -> None:
    """Two telegrams each, in three orders of calls; answers in the types themselves and in 41h to 43h."""
    for errand in every_format(field.rig.engine.sizes.last + 1):
        orders = [EngineScenario(name=f"called {order}", order=order, follow=False) for order in permutations(CALLS)]
        _run(field, errand, *orders[::2], EngineScenario(name="by size", generic=True))


def _other_types(field: JobField) -> None:
    """What is taken for what: the type of one value is exchanged in a good answer."""
    room = field.rig.engine.sizes.last + 1
    for reads in every_format(room)[::2]:
        part = reads.letters[0].parts[0]
        if not part.format.is_string:
            letter = Letter(writes=False, parts=(part,))
            errand = Errand(reads.key, (letter,))
            _run(field, errand, *types_of_a_size(AnswerForm(errand, 1, letter, room)))


def _wider(field: JobField) -> None:
    """Single values, and arrays of which the first or the last one decides."""
    room = field.rig.engine.sizes.last + 1
    for reads in every_format(room)[::2]:
        if reads.letters[0].parts[0].format.name in {"Integer8", "Integer16", "Unsigned8", "Unsigned16"}:
            letter = reads.letters[0]
            errand = Errand(reads.key, (letter,))
            _run(field, errand, *wider_integers(AnswerForm(errand, 1, letter, room)))


def _open(field: JobField) -> None:
    """What is asked for without a type."""
    _run(field, READ_OPEN, EngineScenario(name="as it is"), EngineScenario(name="by size", generic=True))
    _run(field, READ_OPEN, *open_answers())


def _full(field: JobField) -> None:
    """As many bytes and parameters as there is room for, from the last slot of the unit."""
    sizes = field.rig.engine.sizes
    field.rig.plan.set("slots", sizes.slots)
    field.rig.plan.set("channels", sizes.channels)
    for errand in full(sizes.last + 1, sizes.blocks):
        conduct = EngineConduct(field.rig, errand)
        conduct.job.db.set("slot", sizes.slots)
        _attempt(field, conduct, EngineScenario(name="first run"), EngineScenario(name="by size", generic=True))


def _pinned(field: JobField) -> None:
    """The request goes out with its reference in its first byte, the answer lies in its data block as it came."""
    rig = field.rig
    request, response = rig.cpu.db("PinnedRequest"), rig.cpu.db("PinnedResponse")
    for errand in (READ_PINNED, WRITE_PINNED):
        for room in (rig.engine.sizes.last + 1, errand.letters[0].answer, 4, 1):
            for reads in ({}, {1: STATE_CONFLICT}, {1: lambda a: a[:2]}):
                conduct = EngineConduct(rig, errand)
                rig.jobs[0].db.set("order.responseSize", room)
                response[:] = b"\x5a" * len(response)
                cut = 1 in reads and callable(reads[1])
                status = (WORDS["RESPONSE_LENGTH" if cut else "DONE"],)
                scenario = EngineScenario(
                    name=f"room for {room}", reads=reads, status=status, calls=None, retries=None, follow=False
                )
                _attempt(field, conduct, scenario)
                sent = next(e.data for e in reversed(rig.drives[0].journal) if e.direction == "write")
                came = rig.drives[0].journal[-1].data[:room]
                if bytes(request[: len(sent)]) != sent:
                    raise ScenarioError("the request's data block does not hold what was sent")
                if bytes(response) != came + b"\x5a" * (len(response) - len(came)):
                    raise ScenarioError(f"the response's data block of {room} bytes does not hold the answer")


def _row(field: JobField) -> None:
    """The reference begins again at 1 behind 255 jobs."""
    for errand in (READ_ONE, WRITE_ONE):
        scenarios = (EngineScenario(name=f"job {n} in a row", busy=(0, 0), follow=False) for n in range(ROW // 2))
        _run(field, errand, *scenarios)


def _many(field: JobField) -> None:
    """On one instance: the numbers of orders and places begin again behind 30,000, twice, signs of life 20 times."""
    job, unit, drive = field.give(1, WRITE_ONE), field.rig.units[0], field.rig.drives[0]
    field.rig.bus.write_busy = field.rig.bus.read_busy = 0
    field.step()
    began = dict.fromkeys(("asks[1].want", "asks[1].mark", "turn.beat"), 0)
    before, reference = dict.fromkeys(began, 0), 0
    for number in range(MANY):
        field.start(1)
        field.done(1)
        field.drop(1)
        field.step()
        if job.signals() != (False, False, False, 0x7000):
            raise ScenarioError(f"job {number} is not idle after its end")
        for name, last in before.items():
            before[name] = abs(unit.get(name, signed=True))
            began[name] += before[name] < last
        sent = [exchange.data[0] for exchange in drive.journal]
        if len(sent) != 2 or (number and sent[0] != following(reference)):
            raise ScenarioError(f"request references {sent} follow {reference}")
        reference = sent[0]
        drive.journal.clear()
        field.sent.clear()
    if min(began.values()) < 2 or before["asks[1].want"] != (MANY - 1) % COUNTERS + 1:
        raise ScenarioError(f"counters began {began} times again")


def _wrong_db(field: JobField) -> None:
    """Nothing is sent, nothing is written into the other block, whatever lies in it: once the reference that comes."""
    other = field.rig.cpu.db("Unit2")
    channel = Members(field.cpu, field.rig.program, "Channel1", ("statReference",))
    for errand in (READ_ONE, WRITE_PINNED):
        for number in range(257):
            byte = number if number < 256 else channel.get("statReference") % 255 + 1
            other[0] = byte
            scenario = EngineScenario(
                name=f"a byte {byte:02X}h there", status=(WORDS["WRONG_DB"],), order=(1, 5, WRONG_UNIT_DB),
                telegram=1, calls=None, again=None, follow=False,
            )  # fmt: skip
            _run(field, errand, scenario)
            if field.rig.drives[0].journal:
                raise ScenarioError("a request was sent")
