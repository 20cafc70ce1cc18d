"""Against a drive that nobody here wrote: the parameter manager of Siemens' PROFIdrive application example."""

from __future__ import annotations

import ctypes
from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.proof.rig import JobRig
from plcgen.ds47.proof.scenario import Contents
from plcgen.ds47.proof.words import DONE
from plcgen.ds47.sim.behaviour import Behaviour
from plcgen.ds47.sim.bench import build_drive
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.sim.parameters import DriveObject, SimulatedParameter, ValueLimits
from plcgen.ds47.wire.formats import FORMATS, Format, FormatKind, Value
from plcgen.project.opening import open_spec
from plcgen.proof.rig import ProgramBench
from plcgen.s7.cpu.cpu import Cpu
from tests.oracles.reference import ReferenceDrive, build
from tests.projects import TARGETS

BY_NAME = {fmt.name: fmt for fmt in FORMATS}
NOT_THERE = {"BinaryDate", "TimeDifference"}
"""BinaryDate has 8 bytes there, the last one 0; for TimeDifference, 0Dh, profile V4.2 has 36h."""
SHIFTED = {"Float64", "Integer64", "Unsigned64"}
"""The example answers the first byte of 8 shifted by two bits too few (``>> 54``): its mistake."""
KINDS = [fmt for fmt in FORMATS if fmt.writable and not fmt.generic and fmt.name not in NOT_THERE]
REAL_100 = 0x42C8_0000
"""Bits of 100.0."""
VALUES: tuple[Contents, ...] = ("next", "low", "high")
"""Any, and the ends of every type."""


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    """The manager, compiled once."""
    return build(tmp_path_factory.mktemp("reference"))


def limits(fmt: Format) -> tuple[int, int]:
    """All values of a format, as bits of the database."""
    if fmt.kind is FormatKind.FLOAT:
        return 0xFF80_0000, 0x7F80_0000  # minus and plus infinity
    if fmt.kind is FormatKind.SIGNED and fmt.size <= 4:
        top = 1 << 8 * fmt.size - 1
        return 2**32 - top, top - 1
    return 0, 2**32 - 1


def spec(target: str) -> str:
    """A job that writes and one that reads for every type the example knows; one parameter each: it takes no more."""
    family, toolchain = TARGETS[target]
    place = "hardware_id" if family in {"s7-1200", "s7-1500"} else "address"
    rows, jobs = [], []
    for number, fmt in enumerate(KINDS, 2900):
        text = f'"{fmt.name}[5]"' if fmt.is_string else f"{fmt.name}, array: 3"
        rows.append(f"      P{number}: {{type: {text}}}\n")
        item = f"P{number}" if fmt.is_string else f'"P{number}[0..2]"'
        jobs.append(
            f"  set_{number}: {{drive: d, write: {{{item}: null}}}}\n  get_{number}: {{drive: d, read: [{item}]}}\n"
        )
    head = f"plc: {{name: Types, family: {family}, toolchain: {toolchain}}}\n"
    drive = f"drives:\n  d:\n    device: profidrive\n    {place}: 256\n    drive_object: 1\n    parameters:\n"
    return f"{head}{drive}{''.join(rows)}jobs:\n{''.join(jobs)}"


@pytest.mark.slow
@pytest.mark.parametrize("target", ["v5", "t3", "t15"])
def test_generated_blocks_write_and_read_every_type(library: ctypes.CDLL, target: str, tmp_path: Path) -> None:
    """The blocks in the soft CPU end with "done", get back what they wrote, and our drive gives the same answers."""
    (tmp_path / "types.yaml").write_text(spec(target), encoding="utf-8")
    assert api.generate(tmp_path / "types.yaml", tmp_path / "out").ok
    project = open_spec(tmp_path / "types.yaml").sound()
    plan = project.plan(DrivePlan)
    assert plan is not None
    program = ProgramBench(project, tmp_path / "out").program
    cpu, theirs, ours = Cpu(program), ReferenceDrive(library), build_drive(plan, plan.drives[0])
    for number, fmt in enumerate(KINDS, 2900):
        theirs.define(number, fmt, 5 if fmt.is_string else 3, *limits(fmt))
    for kind in VALUES:
        for number, job in enumerate(plan.shapes, 1):
            rig = JobRig(plan, program, job, number, cpu)
            rig.next_values(kind)
            rig.bus.attach(job.drive.id_value, theirs)
            rig.db.set("execute", 1)
            while rig.cpu.call(rig.db.block, 10) is None and rig.db.flag("busy"):
                assert rig.cpu.bus.find(job.drive.id_value) is theirs
            assert (rig.db.get("status"), rig.cpu.misuses) == (DONE, []), job.key
            (use,) = job.uses
            size = use.format.size * use.count
            if use.writes:
                written = theirs.wire[-1][0][12 : 12 + size]
                assert rig.values.given[use.position] == written
            elif use.format.name not in SHIFTED:
                assert rig.db.bytes(use.member, size) == theirs.wire[-1][1][6 : 6 + size] == written
    assert len(theirs.wire) == len(VALUES) * 2 * len(KINDS)
    for request, answer in theirs.wire:
        assert ours.write_record(47, request) == 0
        ours.advance(1)
        status, own = ours.read_record(47, 240)
        shifted = request[1] == 1 and answer[4] in {BY_NAME[name].code for name in SHIFTED}
        assert (status, own if not shifted else own[:6]) == (0, answer if not shifted else answer[:6])


REQUESTS = {
    "a read": "01 01 01 01 10 01 0460 0000",
    "a read of no elements": "01 01 01 01 10 00 0460 0000",
    "a change": "02 02 01 01 10 01 0460 0000 08 01 41200000",
    "a change of no elements": "02 02 01 01 10 00 0460 0000 08 01 41200000",
    "a double word for a number": "02 02 01 01 10 01 0460 0000 43 01 41200000",
    "a double integer for a number": "02 02 01 01 10 01 0460 0000 04 01 41200000",
    "an unknown number": "01 01 01 01 10 01 0461 0000",
    "a change of an unknown number": "02 02 01 01 10 01 0461 0000 08 01 41200000",
    "an index of a simple parameter": "01 01 01 01 10 01 0460 0001",
    "a change at an index of a simple parameter": "02 02 01 01 10 01 0460 0001 08 01 41200000",
    "two elements of a simple parameter": "01 01 01 01 10 02 0460 0000",
    "an array": "01 01 01 01 10 08 03B1 0000",
    "more than an array has": "01 01 01 01 10 09 03B1 0000",
    "an index behind an array": "01 01 01 01 10 01 03B1 0008",
    "a change behind an array": "02 02 01 01 10 01 0B54 0064 07 01 00000001",
    "the last element of an array": "01 01 01 01 10 01 0B54 0063",
    "a change of what is read-only": "02 02 01 01 10 01 03B1 0000 06 01 0001",
    "a value above the limit": "02 02 01 01 10 01 0460 0000 08 01 49200000",
    "a value below the limit": "02 02 01 01 10 01 0460 0000 08 01 C1200000",
    "a byte above the limit": "02 02 01 01 10 01 0B59 0000 05 01 6500",
    "another drive object": "01 01 02 01 10 01 0460 0000",
    "an unknown request": "01 03 01 01 10 01 0460 0000",
    "two parameters": "01 01 01 02 10 01 0460 0000 10 01 03B1 0000",
    "an unknown attribute": "01 01 01 01 40 01 0460 0000",
    "number 0": "01 01 01 01 10 01 0000 0000",
    "index FFFFh": "01 01 01 01 10 01 03B1 FFFF",
    "the longest answer": "01 01 01 01 10 3A 0B54 0000",
    "an answer that is too long": "01 01 01 01 10 3B 0B54 0000",
    "a value that is too short": "02 02 01 01 10 01 0460 0000 08 01 4120",
    "bytes behind the value": "02 02 01 01 10 01 0460 0000 08 01 41200000 0000",
    "another number of values than of elements": "02 02 01 01 10 02 0B54 0000 07 01 00000001",
    "true": "02 02 01 01 10 01 0B4A 0000 01 01 0100",
    "true as a byte": "02 02 01 01 10 01 0B4A 0000 41 01 0100",
    "neither true nor false": "02 02 01 01 10 01 0B4A 0000 01 01 0200",
    "a byte without the one that pads it": "02 02 01 01 10 01 0B4A 0000 01 01 01",
    "octets, no number of them": "01 01 01 01 10 00 03C5 0000",
    "octets": "01 01 01 01 10 02 03C5 0000",
    "one octet": "01 01 01 01 10 01 03C5 0000",
    "the second octet": "01 01 01 01 10 01 03C5 0001",
    "more octets than there are": "01 01 01 01 10 03 03C5 0000",
    "one character, no number of them": "01 01 01 01 10 00 0B5A 0000",
    "a change of characters": "02 02 01 01 10 05 0B5A 0000 09 05 6162636465 00",
    "a change of the third character": "02 02 01 01 10 01 0B5A 0002 09 01 78 00",
    "characters": "01 01 01 01 10 05 0B5A 0000",
    "a change of too many characters": "02 02 01 01 10 06 0B5A 0000 09 06 616263646566",
    "three bytes": "01 01 01",
    "241 bytes": "01 01 01 01 10 01 0460 0000" + "00" * 231,
}
"""The tables 24, 25 and 31 of profile V4.2, one field after the other: right, at its limit, and wrong."""
NUMBERS_DIFFER = {
    "a word for a number": ("02 02 01 01 10 01 0460 0000 42 01 4120", 0x05, 0x18),
    "an unknown format": ("02 02 01 01 10 01 0460 0000 44 01 41200000", 0x17, 0x05),
    "a number that is none": ("02 02 01 01 10 01 0460 0000 08 01 7FC00000", 0x02, None),
}
"""Request, our error number and theirs: length before type, 05h for every wrong format, comparisons that NaN passes."""


def pair(library: ctypes.CDLL) -> tuple[Drive, ReferenceDrive]:
    """Our drive and theirs with the same parameters, one error word or two as ours has them."""
    theirs = ReferenceDrive(library)
    own: list[SimulatedParameter] = []

    def both(
        pnu: int, name: str, value: Value, count: int = 0, high: float | None = None, *, fixed: bool = False
    ) -> None:
        fmt = BY_NAME[name]
        bits = {None: 2**32 - 1, 100.0: REAL_100 if name == "FloatingPoint" else 100}[high]
        theirs.define(pnu, fmt, count, 0, bits, fixed=fixed)
        values = [value] * (1 if fmt.is_string else count or 1)
        array = bool(count) and not fmt.is_string
        bounds = ValueLimits(0, high) if high is not None else ValueLimits()
        own.append(SimulatedParameter(pnu, fmt, values, array=array, read_only=fixed, limits=bounds))

    both(1120, "FloatingPoint", 0.0, high=100.0)
    both(945, "Unsigned16", 0, 8, fixed=True)
    both(2900, "Unsigned32", 0, 100)
    both(2890, "Boolean", value=False)
    both(965, "OctetString", b"\0\0", 2, fixed=True)
    both(2905, "Unsigned8", 0, high=100.0)
    both(2906, "VisibleString", "\0" * 5, 5)
    behaviour = Behaviour(multi_supported=False)
    return Drive(behaviour, [DriveObject(1, {each.pnu: each for each in own})]), theirs


def ask(drive: Drive | ReferenceDrive, text: str) -> tuple[int, bytes]:
    """STATUS of what failed and the answer, which is handed out once."""
    status = drive.write_record(47, bytes.fromhex(text))
    if status:
        return status, b""
    drive.advance(1)
    status, answer = drive.read_record(47, 240)
    assert drive.read_record(47, 240) == (0xDE80B500, b"")
    return status, answer


def meaning(answer: bytes) -> tuple[bytes, int | None]:
    """Head and error number: with two words the second one is what the profile gives to some numbers only."""
    negative = len(answer) > 7 and answer[1] & 0x80 and answer[4] == 0x44
    return (answer[:4], int.from_bytes(answer[6:8], "big")) if negative else (answer, None)


def test_right_and_wrong_requests(library: ctypes.CDLL) -> None:
    """Both give the same answer, byte for byte if it is good, with the same error number if not, or the same STATUS."""
    ours, theirs = pair(library)
    found = {name: (ask(ours, text), ask(theirs, text)) for name, text in REQUESTS.items()}
    assert {name: both for name, both in found.items() if both[0][0] != both[1][0]} == {}
    assert {n: (a, b) for n, ((_, a), (_, b)) in found.items() if meaning(a) != meaning(b)} == {}
    assert sum(meaning(b)[1] is not None for _, (_, b) in found.values()) > 20


def test_what_is_known_to_differ(library: ctypes.CDLL) -> None:
    """Three error numbers, in both directions; none of them can come from generated blocks."""
    for name, (text, own, other) in NUMBERS_DIFFER.items():
        ours, theirs = pair(library)
        found = meaning(ask(ours, text)[1])[1], meaning(ask(theirs, text)[1])[1]
        assert found == (own, other), name


def test_another_request_before_the_answer_is_fetched(library: ctypes.CDLL) -> None:
    """A request that waits to be processed refuses the next one (B5h); an answer that nobody fetched is replaced."""
    read = bytes.fromhex("01 01 01 01 10 01 0460 0000")
    for drive in pair(library):
        if isinstance(drive, Drive):
            drive.behaviour = Behaviour(multi_supported=False, processing=1)
        assert drive.write_record(47, read) == 0
        assert drive.read_record(47, 240) == (0xDE80B500, b"")
        assert drive.write_record(47, read) == 0xDF80B500
        drive.advance(1)
        assert drive.write_record(47, b"\x02" + read[1:]) == 0
        drive.advance(1)
        status, answer = drive.read_record(47, 240)
        assert (status, answer[0]) == (0, 2)
