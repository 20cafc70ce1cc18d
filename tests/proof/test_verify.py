"""Verification finds what is wrong on disk: every kind of damage is noticed by the check that is meant to."""

from __future__ import annotations

import dataclasses
import shutil
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.diagnostics import Severity
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.proof import exchanges
from plcgen.ds47.sim.bench import build_drive
from plcgen.ds47.sim.drive import Drive
from plcgen.project.nouns import Plan
from plcgen.proof.checks import Check, Outcome, Verification
from plcgen.proof.folder import Folder, read_folder
from plcgen.proof.layouts import check_layout
from tests.projects import MM4, SPECS, generated_example, per_block_spec

FAQ = per_block_spec("s7-300_6ra80_dp_tia")
GOLDEN = FAQ.with_name("out")


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8-sig")
    assert old in text
    path.write_text("\ufeff" + text.replace(old, new, 1), encoding="utf-8")


def verified(tmp_path: Path, damage: Callable[[Path], object], spec: Path = FAQ) -> Verification:
    shutil.copytree(GOLDEN, tmp_path / "out")
    damage(tmp_path / "out")
    return api.verify(spec, tmp_path / "out", faults="none")


def codes(result: Verification) -> set[str]:
    return {c.diagnostic.code for c in result.checks() if c.diagnostic is not None} | {
        d.code for d in result.diagnostics
    }


def test_the_example_is_good() -> None:
    """The generated SCL was executed, but for the engine, which is known; nobody asked Wireshark."""
    result = api.verify(FAQ, GOLDEN)
    assert result.ok
    assert [c.id for c in result.checks() if c.outcome is not Outcome.OK] == ["wireshark", "engine"]
    verdicts = {c.id: f"{c.text} {c.verdict}" for c in result.checks()}
    assert "03 01 02 01 08 01 41 20 00 00  P50303 = 10.0 s at DB4.DBD6" in verdicts["drive.WR_DataBuffer"]
    assert "04 02 02 01  P50304 accepted" in verdicts["drive.WR_DataBuffer_1"]
    assert "positive 4 / negative 10" in verdicts["layout.RD_DataBuffer_1"]
    assert "03 01 02 01 10 01 C4 7F 00 00  LEN 10" in verdicts["telegram.WR_DataBuffer"]


def test_the_example_shows_oracles_and_ledger() -> None:
    """Manuals print both telegrams; of parameters, records, drive objects and limits it says whence they are known."""
    result = api.verify(FAQ, GOLDEN, faults="none")
    oracles = next(group for group in result.groups if group.title == "Independent oracles")
    assert {"read FloatingPoint", "write FloatingPoint", "all layouts"} <= {check.subject for check in oracles.checks}
    ledger = {(one.subject, one.text.partition(":")[0]): (one.grade.value, one.source) for one in result.ledger}
    for subject in (("dcm P50303", "type FloatingPoint"), ("read FloatingPoint", "published telegram")):
        grade, source = ledger[subject]
        assert (grade, "FAQ 109750712 (09/2017), figure" in source) == ("manual", True), subject
    about = {"parameters are reached through record 002Fh (profibus)", "an error is answered with 2 words",
             "drive object 2 by default, of 1, 2, 3, 4, 5, 6", "a value is answered in its own type",
             "a telegram has 240 bytes, 39 parameters, 117 elements"}  # fmt: skip
    assert about <= {text for subject, text in ledger if subject == "sinamics-dcm"}
    assert {"records", "layout"} <= {subject for subject, _ in ledger}


WR, RD, WR_1 = "db/WR_DataBuffer.db", "db/RD_DataBuffer.db", "db/WR_DataBuffer_1.db"
SWAP = "    Para_Format : Byte;  // P50303 data format\n    Num_of_Element : Byte;"
SWAPPED = "    Num_of_Element : Byte;\n    Para_Format : Byte;"
VALUE_XML = 'Name="ParameterValue" Datatype='
ENTITY = '<!DOCTYPE d [<!ENTITY x SYSTEM "file:///etc/passwd">]><Document>'

EDITS = {
    "another parameter number": (WR, "16#C47F", "16#C480", "PG604", "telegram.WR_DataBuffer"),
    "subindex ignored": (WR, "Subindex : Word;", "Subindex : Word := 1;", "PG604", "telegram.WR_DataBuffer"),
    "member too narrow": (WR, "Para_No : Word := 16#C47F", "Para_No : Byte", "PG603", "layout.WR_DataBuffer"),
    "members swapped": (RD, SWAP, SWAPPED, "PG603", "layout.RD_DataBuffer"),
    "value as another type": (RD, "ParameterValue : Real", "ParameterValue : DWord", "PG603", "layout.RD_DataBuffer"),
    "gap": ("udt/typeWR_DataBuffer.udt", "Axis : Byte;", "Axis : Byte; gap : Byte;", "PG603", "layout.WR_DataBuffer"),
    "reference 0": (WR, "Request_Ref : Byte := 16#03", "Request_Ref : Byte", "PG604", "telegram.WR_DataBuffer"),
    "value": (WR_1, "Value : Real := 100.0", "Value : Real := 10.0", "PG604", "telegram.WR_DataBuffer_1"),
    "syntax": ("scl/ReadRampUp.scl", "  END_IF;\n  IF #statT", "  END_IFS;\n  IF #statT", "PG801", "files.syntax"),
    "type in XML": (
        "xml/RD_DataBuffer.xml", f'{VALUE_XML}"Real"', f'{VALUE_XML}"Int"', "PG603", "layout.RD_DataBuffer",
    ),
    "start value in XML": (
        "xml/WR_DataBuffer.xml", "<StartValue>16#C47F", "<StartValue>16#C47E", "PG604", "telegram.WR_DataBuffer",
    ),
    "XML broken": ("xml/WR_DataBuffer.xml", "</Document>", "", "PG811", "files.syntax"),
    "XML hostile": ("xml/WR_DataBuffer.xml", "<Document>", ENTITY, "PG810", "files.syntax"),
}  # fmt: skip
"""Text edits of one file: (file, old, new, expected code, check that must find it)."""


def strip_bom(path: Path) -> None:
    path.write_bytes(path.read_bytes()[3:])


DAMAGE: dict[str, tuple[Callable[[Path], object], str, str]] = {
    "DB missing": (lambda out: (out / WR).unlink(), "PG608", "layout.WR_DataBuffer"),
    "no byte order mark": (lambda out: strip_bom(out / "scl/Main.scl"), "PG610", "files.encoding"),
    "changed by hand": (lambda out: (out / "IMPORT.md").write_text("x"), "PG602", "files.manifest"),
    "manifest gone": (lambda out: (out / "manifest.json").unlink(), "PG507", "files.manifest"),
    "manifest broken": (lambda out: (out / "manifest.json").write_text("{}"), "PG611", "files.manifest"),
}
for title, (file, old, new, code, check) in EDITS.items():
    DAMAGE[title] = (
        partial(lambda out, file, old, new: edit(out / file, old, new), file=file, old=old, new=new),
        code,
        check,
    )


@pytest.mark.parametrize("name", DAMAGE)
def test_damage_is_noticed(name: str, tmp_path: Path) -> None:
    """Each damage is found by the check that is responsible for it, with its own code."""
    damage, code, check = DAMAGE[name]
    result = verified(tmp_path, damage)
    found = {c.id: c for c in result.checks()}
    assert found[check].outcome in {Outcome.ERROR, Outcome.WARNING}
    diagnostic = found[check].diagnostic
    assert diagnostic is not None
    assert diagnostic.code == code, f"{diagnostic.code} {diagnostic.message}"


def test_a_pinned_faq_db6_is_reported(tmp_path: Path) -> None:
    """DB6 with the four bytes of the FAQ's figure 4-10: the negative answer needs ten."""
    spec = tmp_path / "job.yaml"
    text = FAQ.read_text(encoding="utf-8")
    spec.write_text(text.replace("name: RD_DataBuffer_1}", "name: RD_DataBuffer_1, size: 4}"), encoding="utf-8")
    result = api.check(spec)
    (found,) = [d for d in result.diagnostics if d.severity.label == "error"]
    assert found.code == "PG303"
    assert "6 bytes too small" in found.message
    assert "10" in found.message


def test_a_drive_file_replaces_the_profile(tmp_path: Path) -> None:
    """The drive of a file answers with its own values, and one that lacks the parameter is noticed."""
    drive = tmp_path / "drive.yaml"
    entry = "{pnu: 50303, type: FloatingPoint, value: 12.5}, {pnu: 50304, type: FloatingPoint, value: 1.0}"
    drive.write_text(f"objects:\n  - number: 2\n    parameters: [{entry}]\n")
    verdicts = {c.id: c.verdict for c in api.verify(FAQ, GOLDEN, drive=drive, faults="none").checks()}
    assert "P50303 = 12.5 s" in verdicts["drive.WR_DataBuffer"]
    assert verdicts["own.read_ramp_up"] == "ok, values agree"
    assert verdicts["own.write_ramp_down"] == "ok, values agree"
    drive.write_text("objects:\n  - number: 2\n    parameters: [{pnu: 1, type: FloatingPoint, value: 12.5}]\n")
    result = api.verify(FAQ, GOLDEN, drive=drive, faults="none")
    assert {c.id: c.outcome for c in result.checks()}["drive.WR_DataBuffer"] is Outcome.ERROR
    assert "error 00h" in {c.id: c.verdict for c in result.checks()}["drive.WR_DataBuffer"]
    own = {c.id: c for c in result.checks()}["own.read_ramp_up"]
    assert own.outcome is Outcome.ERROR
    assert "16#8401" in own.verdict
    assert "P50303: error 00h" in own.verdict


def test_a_missing_folder_or_spec_is_a_diagnostic(tmp_path: Path) -> None:
    """No traceback for a wrong path."""
    assert codes(api.verify(FAQ, tmp_path / "none")) == {"PG507"}
    assert codes(api.verify(tmp_path / "none.yaml", GOLDEN)) == {"PG110"}


def test_a_copy_in_a_subfolder_is_not_looked_at(tmp_path: Path) -> None:
    """A backup below the folder cannot hide a damaged file; both are files that plcgen did not make."""
    shutil.copytree(GOLDEN, tmp_path / "out")
    shutil.copytree(GOLDEN, tmp_path / "out" / "zz")
    (tmp_path / "out" / "scl" / "Mine.scl").write_text("not SCL at all {")
    assert codes(api.verify(FAQ, tmp_path / "out", faults="none")) == {"PG613"}
    edit(tmp_path / "out" / WR, "16#C47F", "16#C47E")
    result = api.verify(FAQ, tmp_path / "out", faults="none")
    assert {c.id: c.outcome for c in result.checks()}["telegram.WR_DataBuffer"] is Outcome.ERROR


def test_an_interrupted_generation_is_an_error(tmp_path: Path) -> None:
    """A pending journal means that old and new files are mixed."""
    result = verified(tmp_path, lambda out: (out / ".plcgen-journal.json").write_text("{}"))
    assert {c.id: c.outcome for c in result.checks()}["files.manifest"] is Outcome.ERROR


class Liar(Drive):
    """A drive whose answers are changed on their way."""

    def __init__(self, honest: Drive, change: Callable[[bytes], bytes]) -> None:
        super().__init__(honest.behaviour, honest.objects.values(), honest.faults)
        self.change = change

    def read_record(self, index: int, max_length: int) -> tuple[int, bytes]:
        """Hand out the changed answer."""
        status, data = super().read_record(index, max_length)
        return status, self.change(data)


LIES: dict[str, tuple[Callable[[bytes], bytes], str, str]] = {
    "another value": (lambda d: d[:-1] + bytes([d[-1] ^ 1]), "drive.WR_DataBuffer", "PG607"),
    "one byte more": (lambda d: d + b"\0", "drive.WR_DataBuffer", "PG606"),
    "no negative answer": (lambda d: bytes([d[0], d[1] & 0x7F]) + d[2:], "negative.RD_DataBuffer", "PG606"),
    "an answer that does not fit": (lambda d: d + bytes(20), "negative.RD_DataBuffer", "PG605"),
}


@pytest.mark.parametrize("lie", LIES)
def test_a_lying_drive_is_noticed(lie: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Wrong values, lengths and missing errors are found by the check that looks at them."""
    change, check, code = LIES[lie]
    monkeypatch.setattr(exchanges, "build_drive", lambda *a, **k: Liar(build_drive(*a, **k), change))
    found = {c.id: c.diagnostic for c in api.verify(FAQ, GOLDEN, faults="none").checks()}[check]
    assert found is not None
    assert found.code == code


def test_a_write_that_the_drive_forgets_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The value is read from the drive after the write, not believed."""

    def forgetful(*arguments: object, **options: bool) -> Drive:
        drive = build_drive(*arguments, **options)  # type: ignore[arg-type]
        before = {number: list(p.values) for number, p in drive.objects[2].parameters.items()}
        real = drive.read_record

        def read_record(index: int, max_length: int) -> tuple[int, bytes]:
            for number, values in before.items():
                drive.objects[2].parameters[number].values[:] = values
            return real(index, max_length)

        drive.read_record = read_record  # type: ignore[method-assign]
        return drive

    monkeypatch.setattr(exchanges, "build_drive", forgetful)
    found = {c.id: c.diagnostic for c in api.verify(FAQ, GOLDEN).checks()}["drive.WR_DataBuffer_1"]
    assert found is not None
    assert found.code == "PG607"


def test_the_refused_parameter_is_named(tmp_path: Path) -> None:
    """A drive without P2155: the report names it with error 00h, not the byte of another parameter's value."""
    drive = tmp_path / "drive.yaml"
    drive.write_text("objects: [{number: 0, parameters: [{pnu: 1120, type: FloatingPoint, value: 1.0}]}]\n")
    golden = generated_example(MM4.stem)
    verdicts = {c.id: c.verdict for c in api.verify(MM4, golden, drive=drive).checks()}
    assert "P2155[1..2]: error 00h" in verdicts["drive.typeReadParams_Request"]
    assert "P1121: error 00h" in verdicts["drive.typeWriteParams_Request"]


def shifted(project: DrivePlan) -> DrivePlan:
    """The same plan, whose first request has its third field one byte later."""
    job = project.jobs[0]
    telegram = job.telegrams[0]
    fields = list(telegram.request.fields)
    fields[2] = dataclasses.replace(fields[2], offset=fields[2].offset + 1)
    moved = dataclasses.replace(telegram, request=dataclasses.replace(telegram.request, fields=tuple(fields)))
    return dataclasses.replace(project, jobs=(dataclasses.replace(job, telegrams=(moved,)), *project.jobs[1:]))


def layouts(plan: Plan, files: Folder) -> list[Check]:
    """The checks of the group ``layout``."""
    return [check_layout(plan, files, laid) for laid in plan.protocol.proof(plan).layouts()]


SHIFTS = {
    "the telegram": ("", "", ""),
    "the text source": ("db/WR_DataBuffer.db", "    Axis : Byte", "    gap : Word;\n    Axis : Byte"),
    "the SimaticML": ("xml/WR_DataBuffer.xml", 'Name="Axis" Datatype="Byte"', 'Name="Axis" Datatype="Word"'),
}


@pytest.mark.parametrize("alone", SHIFTS)
def test_a_shift_in_one_of_three_sources_is_named(alone: str, tmp_path: Path) -> None:
    """Any source that differs is an error, whatever the two others say; the message has all three."""
    shutil.copytree(GOLDEN, tmp_path / "out")
    file, old, new = SHIFTS[alone]
    if file:
        edit(tmp_path / "out" / file, old, new)
    plan = api.check(FAQ).project.plan(DrivePlan)
    if not file:
        plan = shifted(plan)
    checks = {c.id: c for c in layouts(plan, read_folder(tmp_path / "out", plan.target))}
    others = " and ".join(name for name in SHIFTS if name != alone)
    verdict = checks["layout.WR_DataBuffer"].verdict
    assert verdict.startswith('DB "WR_DataBuffer": the telegram ')
    assert f"{others} have Axis@2 (1 B, BYTE)" in verdict
    assert f"{alone} has " in verdict
    assert {c.outcome for name, c in checks.items() if name != "layout.WR_DataBuffer"} == {Outcome.OK}


def test_two_sources_outvote_none(tmp_path: Path) -> None:
    """Text and SimaticML shifted alike, as one engine would: the telegram is not outvoted, and who is wrong is open."""
    shutil.copytree(GOLDEN, tmp_path / "out")
    for name in ("the text source", "the SimaticML"):
        file, old, new = SHIFTS[name]
        edit(tmp_path / "out" / file, old, new.replace("gap : Word;\n    Axis : Byte", "Axis : Word"))
    plan = api.check(FAQ).project.plan(DrivePlan)
    checks = {c.id: c for c in layouts(plan, read_folder(tmp_path / "out", plan.target))}
    assert checks["layout.WR_DataBuffer"].verdict == (
        'DB "WR_DataBuffer": the telegram has Axis@2 (1 B, BYTE), '
        "the text source and the SimaticML have Axis@2 (2 B, WORD)"
    )


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: spec.stem)
def test_every_buffer_is_in_all_sources(spec: Path) -> None:
    """One line per request and response; where there is no SimaticML it says which sources there are."""
    folder = generated_example(spec.stem)
    project = api.check(spec).project
    assert project is not None
    files = read_folder(folder, project.target)
    checks = [check for plan in project.plans for check in layouts(plan, files)]
    buffers = [buffer.home.name for plan in project.plans for buffer, _ in plan.protocol.buffers(plan)]
    assert [c.id for c in checks] == [f"layout.{name}" for name in buffers]
    expected = "3 sources agree"
    if project.target.xml_version is None:
        expected = "2 sources agree: telegram, text source; no SimaticML"
    assert {c.verdict for c in checks} == {expected}


def test_a_value_may_be_called_as_a_member_of_the_diagnostics_is(tmp_path: Path) -> None:
    """An output ``state`` and an input ``telegram`` are pins of their own beside diagnostics.state and .telegram."""
    spec = tmp_path / "job.yaml"
    spec.write_text(
        "plc: {name: T, family: s7-1500, toolchain: tia-v19}\n"
        "drives: {axis: {device: sinamics-s120, hardware_id: 256, drive_object: 3}}\n"
        "jobs:\n"
        "  read_it: {drive: axis, read: [{parameter: r21, as: state}]}\n"
        "  write_it: {drive: axis, write: {P1120: {as: telegram, start: 5.0}}}\n",
        "utf-8",
    )
    assert api.generate(spec).ok
    result = api.verify(spec, faults="none")
    assert codes(result) == set()
    assert result.ok


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("read: [P50303]", "read: [P50305]"),
        ("read: [P50303]", "read: [P50303, P50304]"),
        ("P50304: 100.0", "P50304: null"),
    ],
)
def test_the_folder_of_another_state_of_the_spec(tmp_path: Path, old: str, new: str) -> None:
    """Whoever forgets generate gets failed checks, also of what all jobs do together, and no internal error."""
    text = FAQ.read_text("utf-8")
    assert old in text
    (tmp_path / "job.yaml").write_text(text.replace(old, new), "utf-8")
    result = api.verify(tmp_path / "job.yaml", GOLDEN)
    assert not result.ok
    failed = {check.id for check in result.checks() if check.outcome is Outcome.ERROR}
    assert "together" in failed
    first = result.problems[0]
    assert (first.code, first.severity, first.help) == ("PG504", Severity.WARNING, "run plcgen generate")
    assert all(one.span.column for one in result.problems if one.span.line)
